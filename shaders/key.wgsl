// The shadows that bodies and obstacles cast on each other in the key light. Each panel has a map of what is nearest to the light.

@group(0) @binding(2) var key_maps: texture_depth_2d_array;

// The depth within which a surface does not shade itself (texels): of one across the light, and more for each unit of its slope.
const OWN_DEPTH = 1.0;
const OWN_SLOPE = 1.6;
// Surfaces turned away from the light by their cosine, below which they lie in their own shade.
const TURNED = vec2(0.0, 0.25);
// The share of the key light that a shadow takes.
const SHADOW = 0.9;

// The weights of texels at distances from a point: the quadratic B-spline, which blurs borders without steps.
fn weights(off: vec3<f32>) -> vec3<f32> {
    let far = vec3(1.5) - min(abs(off), vec3(1.5));
    return select(0.5 * far * far, 0.75 - off * off, abs(off) < vec3(0.5));
}

// The part of the key light that reaches a point of a surface, with the cosine of its normal to the light.
fn reached(position: vec3<f32>, cosine: f32) -> f32 {
    let layer = i32(panel_data.key_layer);
    let at = (panel_data.key_map * vec4(position, 1.0)).xyz;
    let side = f32(textureDimensions(key_maps).x);
    let place = (at.xy * vec2(0.5, -0.5) + 0.5) * side;
    let is_inside = all(place >= vec2(1.0)) && all(place < vec2(side - 1.0));
    let slope = sqrt(1.0 - min(cosine * cosine, 1.0)) / max(cosine, 0.2);
    let depth = max(at.z + (OWN_DEPTH + OWN_SLOPE * slope) * panel_data.key_texel, 0.0);
    let middle = vec2<i32>(place);
    let off = fract(place) - 0.5;
    let across = weights(vec3(-1.0, 0.0, 1.0) - off.x);
    var taken = 0.0;
    // A loop without rounds ends at once; a software driver would run a branch for each group of pixels.
    let rows = select(-2, 1, layer >= 0 && is_inside && cosine > TURNED.x);
    for (var row = -1; row <= rows; row++) {
        let nearest = vec3(
            textureLoad(key_maps, middle + vec2(-1, row), layer, 0),
            textureLoad(key_maps, middle + vec2(0, row), layer, 0),
            textureLoad(key_maps, middle + vec2(1, row), layer, 0),
        );
        let shaded = select(vec3(0.0), across, nearest > vec3(depth));
        taken += (shaded.x + shaded.y + shaded.z) * weights(vec3(f32(row) - off.y)).x;
    }
    return 1.0 - SHADOW * taken * smoothstep(TURNED.x, TURNED.y, cosine);
}

// Of very large obstacles, corners before the box count at its near side.
@vertex
fn caster_corner(@location(0) position: vec3<f32>) -> @builtin(position) vec4<f32> {
    let at = panel_data.key_map * vec4(position, 1.0);
    return vec4(at.xy, min(at.z, 1.0), 1.0);
}
