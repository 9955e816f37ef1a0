// A straight line in space as a strip of pixels: what all passes that draw lines share.

// The ends of a line in clip space, without what lies behind the eye.
struct Ends {
    a: vec4<f32>,
    b: vec4<f32>,
    seen: bool,
}

fn ends_of(start: vec3<f32>, end: vec3<f32>) -> Ends {
    var a = panel.clip * vec4(start, 1.0);
    var b = panel.clip * vec4(end, 1.0);
    let near = panel.near;
    let seen = a.w >= near || b.w >= near;
    if seen && a.w < near {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    } else if seen && b.w < near {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    return Ends(a, b, seen);
}

const FLIP = vec2<f32>(0.5, -0.5);

// Where a point in clip space lies in a target of a size (px).
fn pixel_of(at: vec4<f32>, size: vec2<f32>) -> vec2<f32> {
    return (at.xy / at.w * FLIP + 0.5) * size;
}

// A corner of the strip that reaches so far (px) around a line between two pixels.
fn strip_corner(corner: u32, from_pixel: vec2<f32>, to_pixel: vec2<f32>, reach: f32, size: vec2<f32>) -> vec4<f32> {
    let difference = to_pixel - from_pixel;
    let extent = length(difference);
    let along = select(vec2(1.0, 0.0), difference / extent, extent > 1e-6);
    let across = vec2(-along.y, along.x);
    let pixel = select(from_pixel - along * reach, to_pixel + along * reach, corner >= 2u)
        + across * select(-reach, reach, (corner & 1u) == 1u);
    return vec4((pixel / size - 0.5) / FLIP, 0.5, 1.0);
}

// Outside the target.
const NOWHERE = vec4<f32>(0.0, 0.0, -1.0, 1.0);

// The texel of a pixel in the textures that hold the bodies, and the depth of the bodies there.
fn texel_of(place: vec2<f32>) -> vec2<i32> {
    let low = panel.region.xy;
    let high = low + panel.region.zw - 1.0;
    return vec2<i32>(clamp(floor(place), low, high));
}

// The texel at one of the taps around a point (px). All taps together stand for the pixel around that point.
fn texel_around(place: vec2<f32>, tap: u32) -> vec2<i32> {
    return texel_of(place - tap_place(tap) + 0.5);
}

// The depth of the bodies at one of the taps around a point.
fn tap_depth(place: vec2<f32>, tap: u32) -> f32 {
    return load_depth(texel_around(place, tap));
}

// Lines fade over this range of depths before and behind the surface, as a part of the distance, so that none appears or
// disappears suddenly.
const FADED_DEPTH = 0.0008;

// The visibility of a line at one depth behind or before a surface at another.
fn visible_share(line: f32, surface: f32) -> f32 {
    return saturate(0.5 + 0.5 * (line - surface) / (FADED_DEPTH * max(surface, 1e-9)));
}
