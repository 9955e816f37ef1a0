// Surfaces of bodies and obstacles: lit, with a hatch on turned-over elements, which show through the others. With a
// scalar field, light is mild and keeps the colours of its scale.
//
// `OCCLUDERS` is the number of obstacles near a body, `TINTED` tells whether a field colours surfaces, and `EDGED` whether
// surfaces draw the edges of their elements. `SHADOWED` tells whether surfaces cast shadows on each other.

// The colours of the scale, linear.
@group(0) @binding(1) var<uniform> ramp: array<vec4<f32>, SHADES>;
const SHADES = 64;

// The turned-over elements alone: their depth, and their colour with the brightness of the light.
@group(1) @binding(0) var alarm_depth: texture_depth_2d;
@group(1) @binding(1) var alarm_colour: texture_2d<f32>;
// For obstacles: the depths of bodies.
@group(1) @binding(0) var body_depth: texture_depth_2d;

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    // On turned-over elements the place in the hatch; on others 1 if they are flat; on obstacles the share of ambient
    // light that the body takes.
    @location(2) hatch: f32,
    @location(3) shade: f32,
    @location(4) edge: vec3<f32>,
    // Values that all pixels of a panel use. More of them would take longer to set up for small triangles than they save.
    @location(5) @interpolate(flat) eye_and_soft: vec4<f32>,
    @location(6) @interpolate(flat) key: vec3<f32>,
    @location(7) @interpolate(flat) up_and_floor: vec4<f32>,
    @location(8) @interpolate(flat) own: vec3<f32>,
}

struct Vertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hatch: f32,
    @location(3) shade: f32,
    @location(4) edge: vec4<f32>,
}

// A corner drawn at a place, of a set of a colour.
fn corner_at(place: vec4<f32>, at: Vertex, own: vec3<f32>) -> Corner {
    return Corner(place, at.position, at.normal, at.hatch, at.shade, at.edge.xyz, vec4(panel.eye, panel.soft), panel.key,
        vec4(panel.up, panel.floor), own);
}

fn unpack(corner: Corner) {
    panel = panel_data;
    panel.eye = corner.eye_and_soft.xyz;
    panel.soft = corner.eye_and_soft.w;
    panel.key = corner.key;
    panel.up = corner.up_and_floor.xyz;
    panel.floor = corner.up_and_floor.w;
}

const KEY = vec3<f32>(0.66, 0.635, 0.595);
const SKY = vec3<f32>(0.60, 0.635, 0.68);
const GROUND = vec3<f32>(0.27, 0.262, 0.25);
// Light that bends around edges into the shade.
const WRAP = 0.12;
// Below this height above the floor (soft units) side faces get less light, down to this part of it.
const CONTACT_HEIGHT = 0.9;
const CONTACT_LIGHT = 0.72;
// At a face-to-face contact, a body and an obstacle take this part of the ambient light from each other.
const TAKEN = 0.75;
// A face turned away is this much farther back, relative to the distance.
const BACK_FACE = 1e-5;
// From this depth (soft units) behind the visible surface on, a turned-over element is equally visible.
const THROUGH_DEPTH = 0.6;
// The brightness of a surface without lighting.
const UNLIT = 0.86;

// There is no occlusion from this distance on (soft units). A plate, which is transparent, occludes less.
const TAKEN_REACH = 1.3;
const PLATE_TAKES = 0.37;
// Light changes the lightness of a field's colour by at most this part, up and down, and never its hue. The darkest and
// the brightest light have these brightnesses.
const LIGHTNESS = 0.06;
const BRIGHTNESS = vec2<f32>(0.40, 1.15);
// The strength of stripes that are seen through a field.
const THROUGH = 0.75;
// Up to this depth (soft units) behind a field the colours of turned-over elements are visible, fading with depth. So
// there is no jagged border where they cut the surface or lie close to it, and nothing appears suddenly.
const NEAR_DEPTH = 0.3;

// The drawn position of a face's corner. Of two faces at the same place, as in a body pressed flat, the one towards the
// viewer is always visible: the other is moved back by a few times the round-off of depths.
fn corner_place(position: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    var place = panel.clip * vec4(position, 1.0);
    if dot(normal, panel.eye - position) < 0.0 {
        place.z *= 1.0 - BACK_FACE;
    }
    return place;
}

// The drawn position of a corner of the turned-over set.
fn moved_nearer(position: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    var place = corner_place(position, normal);
    place.z *= place.w / max(place.w - NEARER, panel.near);
    place.z = min(place.z, place.w);
    return place;
}

@vertex
fn sound_corner(at: Vertex) -> Corner {
    panel = panel_data;
    // Without a field, the shade of a body is −1 minus its number.
    let body = u32(max(-at.shade, 1.0)) - 1u;
    return corner_at(corner_place(at.position, at.normal), at, panel_data.bodies[body].rgb);
}

@vertex
fn alarm_corner(at: Vertex) -> Corner {
    panel = panel_data;
    return corner_at(moved_nearer(at.position, at.normal), at, panel.alarm);
}

@vertex
fn obstacle_corner(at: Vertex) -> Corner {
    panel = panel_data;
    return corner_at(panel.clip * vec4(at.position, 1.0), at, panel.obstacle.rgb);
}

// A vector rotated by the inverse of a quaternion.
fn rotated_back(rotation: vec4<f32>, vector: vec3<f32>) -> vec3<f32> {
    return vector + 2.0 * cross(cross(vector, rotation.xyz) + rotation.w * vector, rotation.xyz);
}

// The part of the ambient light that an obstacle leaves to a point of a body with a normal. All kinds of obstacles share
// one path: a software driver would run every branch for each group of pixels.
fn left_by(occluder: Occluder, position: vec3<f32>, facing: vec3<f32>) -> f32 {
    let local = rotated_back(occluder.rotation, position - occluder.first.xyz);
    let out = sign(local) * max(abs(local) - occluder.second.xyz, vec3(0.0));
    let size = length(out);
    let apart = saturate((size - occluder.first.w) / (TAKEN_REACH * panel.soft));
    let away = dot(rotated_back(occluder.rotation, facing), out) / max(size, 1e-9);
    // As at the floor: a face at a plate is visible through it and stays light.
    let turned = mix(0.5 - 0.5 * away, PLATE_TAKES * (1.0 - abs(away)), occluder.second.w);
    return 1.0 - TAKEN * turned * (1.0 - apart) * (1.0 - apart);
}

fn left_by_obstacles(position: vec3<f32>, facing: vec3<f32>) -> f32 {
    var left = 1.0;
    for (var at = 0u; at < OCCLUDERS; at++) {
        left *= left_by(panel_data.occluders[at], position, facing);
    }
    return left;
}

struct Light {
    diffuse: vec3<f32>,
    gloss: f32,
}

// A unit normal turned towards the viewer.
fn facing_normal(position: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let view = normalize(panel.eye - position);
    // A corner of a collapsed face has no normal; it is lit as if it faced the viewer.
    let size = length(normal);
    let facing = select(view, normal / size, size > 1e-12);
    return select(-facing, facing, dot(facing, view) >= 0.0);
}

fn light(position: vec3<f32>, normal: vec3<f32>) -> Light {
    let facing = facing_normal(position, normal);
    return light_left(position, facing, left_by_obstacles(position, facing), 1.0);
}

// The light on a surface that others may shade.
fn shaded_light(position: vec3<f32>, normal: vec3<f32>) -> Light {
    let facing = facing_normal(position, normal);
    return light_left(position, facing, left_by_obstacles(position, facing), key_left(position, facing));
}

// The part of the key light that surfaces leave to a point with a unit normal.
fn key_left(position: vec3<f32>, facing: vec3<f32>) -> f32 {
    if SHADOWED {
        return reached(position, dot(facing, panel.key));
    }
    return 1.0;
}

// The light on a point with a unit normal, with the parts of ambient and key light that others leave.
fn light_left(position: vec3<f32>, facing: vec3<f32>, left: f32, key_left: f32) -> Light {
    let view = normalize(panel.eye - position);
    let key = key_left * max(0.0, dot(facing, panel.key) + WRAP) / (1.0 + WRAP);
    let upward = dot(facing, panel.up);
    let height = dot(position, panel.up) - panel.floor;
    let contact = mix(CONTACT_LIGHT, 1.0, smoothstep(0.0, CONTACT_HEIGHT * panel.soft, height));
    let around = left * mix(GROUND, SKY, 0.5 + 0.5 * upward) * mix(contact, 1.0, abs(upward));
    let shine = max(0.0, dot(facing, normalize(view + panel.key)));
    let shine4 = shine * shine * shine * shine;
    let shine16 = shine4 * shine4 * shine4 * shine4;
    let rim = 1.0 - max(0.0, dot(facing, view));
    let gloss = 0.05 * key_left * shine16 * shine4 * shine4 * shine4 + 0.06 * rim * rim * rim * rim;
    return Light(KEY * key + around, gloss);
}

// The part of a pixel that the stripes of the hatch cover.
fn stripes(hatch: f32) -> f32 {
    // Periods per pixel; the width of the filter.
    let width = max(length(vec2(dpdx(hatch), dpdy(hatch))), 1e-5);
    let off = abs(fract(hatch) - 0.5);
    let covered = clamp((0.5 * STRIPE - off) / width + 0.5, 0.0, 1.0);
    // Stripes finer than three pixels per period would only flicker.
    return mix(covered, STRIPE, smoothstep(0.2, 0.45, width));
}

// The dots of flat elements: distance, radius (px in the reference picture) and opacity.
const DOTS_APART = 7.0;
const DOT = 1.3;
const DOT_ALPHA = 0.6;

// The part of a pixel that the dots of a flat element cover.
fn dots(place: vec2<f32>) -> f32 {
    let scale = panel.line_scale;
    let from_body = (place - panel.middle) / (DOTS_APART * scale);
    // Rows at 45°.
    let at = vec2(from_body.x + from_body.y, from_body.y - from_body.x) * 0.70710678;
    let off = length(fract(at) - 0.5) * DOTS_APART * scale;
    return DOT_ALPHA * saturate(DOT * scale + 0.5 - off);
}

// The colour with the edges of its element over it: their colour, opacity and width (px).
fn edged(colour: vec3<f32>, corner: Corner, edge: vec4<f32>, width: f32) -> vec3<f32> {
    if !EDGED {
        return colour;
    }
    let at = corner.edge;
    let across = vec3(
        length(vec2(dpdx(at.x), dpdy(at.x))),
        length(vec2(dpdx(at.y), dpdy(at.y))),
        length(vec2(dpdx(at.z), dpdy(at.z))),
    );
    let off = (0.5 - abs(at - 0.5)) / max(across, vec3(1e-5));
    let drawn = max(width, 1.0);
    let covered = saturate(0.5 * drawn + 0.5 - min(off.x, min(off.y, off.z))) * (width / drawn);
    return mix(colour, edge.rgb, panel.edging * edge.a * covered);
}

fn sound_edged(colour: vec3<f32>, corner: Corner) -> vec3<f32> {
    return edged(colour, corner, vec4(panel.edge, EDGE_ALPHA), EDGE_WIDTH * panel.line_scale);
}

fn alarm_edged(colour: vec3<f32>, corner: Corner) -> vec3<f32> {
    let width = ALARM_EDGE_WIDTH * panel.line_scale * panel.contour_share;
    return edged(colour, corner, vec4(panel.alarm_line, ALARM_EDGE_ALPHA), width);
}

// The colour of a field at a place of its scale; the colour of the set below zero, where there is no value.
fn tinted(corner: Corner, light: Light) -> vec3<f32> {
    let at = saturate(corner.shade) * f32(SHADES - 1);
    let cell = min(u32(at), u32(SHADES - 2));
    let shade = mix(ramp[cell].rgb, ramp[cell + 1u].rgb, at - f32(cell));
    let colour = select(corner.own, shade, corner.shade > -0.5);
    let brightness = dot(light.diffuse, LUMINANCE);
    let lightness = 1.0 + LIGHTNESS * (2.0 * smoothstep(BRIGHTNESS.x, BRIGHTNESS.y, brightness) - 1.0);
    // Lightness follows the cube root of light (Oklab). Colours too bright for the screen would change their hue there.
    let most = 1.0 / max(max(colour.r, colour.g), max(colour.b, 1e-3));
    return colour * min(lightness * lightness * lightness, most);
}

// The turned-over set, as seen through the body, and as a surface of the body. Alpha of the first is the brightness of
// the light or, with a field, the part of a pixel that the hatch covers.
struct TurnedOver {
    @location(0) behind: vec4<f32>,
    @location(1) surface: vec4<f32>,
}

@fragment
fn alarm_surface(corner: Corner) -> TurnedOver {
    unpack(corner);
    let light = light(corner.position, corner.normal);
    let covered = stripes(corner.hatch);
    var colour = mix(corner.own, panel.alarm_line, STRIPE_ALPHA * covered) * light.diffuse + light.gloss;
    var alpha = saturate(0.5 * dot(light.diffuse, LUMINANCE));
    if TINTED {
        colour = mix(tinted(corner, light), corner.own, covered);
        alpha = covered;
    }
    let drawn = alarm_edged(colour, corner);
    return TurnedOver(vec4(drawn, alpha), vec4(drawn, 1.0));
}

// The colour of a surface over the colour behind it.
fn over_behind(colour: vec3<f32>, corner: Corner) -> vec3<f32> {
    let at = vec2<i32>(corner.place.xy);
    let behind = textureLoad(alarm_depth, at, 0);
    let stored = textureLoad(alarm_colour, at, 0);
    if behind <= 0.0 {
        return colour;
    }
    let depth = panel.near / behind - 1.0 / corner.place.w;
    let deep = smoothstep(0.0, THROUGH_DEPTH * panel.soft, depth);
    let lit = stored.rgb;
    if TINTED {
        // Of a hatch only the stripes are visible, not the colours between them.
        let through = mix(colour, panel.alarm, THROUGH * (1.0 - 0.4 * deep) * stored.a);
        return mix(lit, through, smoothstep(0.0, NEAR_DEPTH * panel.soft, depth));
    }
    let unlit = lit * (UNLIT / max(2.0 * stored.a, 0.05));
    let alarm = mix(lit, unlit, 0.65 * deep);
    // Blue-grey under vermilion would turn pink, so the surface is desaturated first.
    let grey = mix(colour, vec3(dot(colour, LUMINANCE)), 0.7);
    return mix(grey, alarm, 1.0 - 0.4 * deep);
}

@fragment
fn sound_surface(corner: Corner) -> @location(0) vec4<f32> {
    unpack(corner);
    let light = shaded_light(corner.position, corner.normal);
    var colour = corner.own * light.diffuse + light.gloss;
    if TINTED {
        colour = tinted(corner, light);
    }
    return vec4(sound_edged(colour, corner), 1.0);
}

// For panels with turned-over elements behind such surfaces, or with flat elements. A software driver would run all of
// it for every surface.
@fragment
fn sound_before(corner: Corner) -> @location(0) vec4<f32> {
    unpack(corner);
    let light = shaded_light(corner.position, corner.normal);
    let is_flat = corner.hatch > 0.5;
    let dotted = select(0.0, dots(corner.place.xy), is_flat);
    // Flat elements are grey with dots.
    let own = select(corner.own, vec3(dot(corner.own, LUMINANCE)), is_flat);
    var colour = mix(own, panel.edge, dotted) * light.diffuse + light.gloss;
    if TINTED {
        colour = mix(tinted(corner, light), panel.edge, dotted);
    }
    return vec4(over_behind(sound_edged(colour, corner), corner), 1.0);
}

// The same light on another material, nothing below the floor, fading at the sides of its room, and less where bodies lie behind it.
@fragment
fn obstacle_surface(corner: Corner) -> @location(0) vec4<f32> {
    unpack(corner);
    let facing = facing_normal(corner.position, corner.normal);
    let light = light_left(corner.position, facing, 1.0 - TAKEN * corner.hatch, key_left(corner.position, facing));
    let above = dot(corner.position, panel.up) - panel.floor;
    let rise = length(vec2(dpdx(above), dpdy(above)));
    let inside = saturate(above / max(rise, 1e-9) + 0.5);
    let room = panel.fade_room;
    let within = vec4(corner.place.xy - room.xy, room.zw - corner.place.xy);
    let left = 1.0 - panel.fade_strength * (1.0 - smoothstep(vec4(0.0), panel.fade_distance, within));
    let opacity = inside * left.x * left.y * left.z * left.w;
    if opacity <= 0.0 {
        discard;
    }
    let behind = textureLoad(body_depth, vec2<i32>(corner.place.xy), 0);
    let over = select(1.0, SOLID_OVER_BODIES, behind > 0.0);
    return vec4(corner.own * light.diffuse + light.gloss, opacity * over);
}
