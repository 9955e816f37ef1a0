// Surfaces of bodies: lit, with a hatch on turned-over elements, which show through the others. Colours are stored as
// their square roots, which keeps eight bits fine in the dark and is quick to undo.

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hatch: f32,
    @location(4) @interpolate(flat) shared_0: vec4<f32>,
    @location(5) @interpolate(flat) shared_1: vec4<f32>,
    @location(6) @interpolate(flat) shared_2: vec4<f32>,
    @location(7) @interpolate(flat) shared_3: vec4<f32>,
}

// Values of a panel that all its pixels use: packed into varyings, and unpacked again. More of them would take longer
// to set up for small triangles than they save.
fn pack_shared(own: vec3<f32>) -> array<vec4<f32>, 4> {
    return array(
        vec4(panel.eye, panel.soft),
        vec4(panel.key, 0.0),
        vec4(panel.up, panel.floor),
        vec4(own, 0.0),
    );
}

// Returns the colour of the set.
fn unpack_shared(same: array<vec4<f32>, 4>) -> vec3<f32> {
    panel = panel_data;
    panel.eye = same[0].xyz;
    panel.soft = same[0].w;
    panel.key = same[1].xyz;
    panel.up = same[2].xyz;
    panel.floor = same[2].w;
    return same[3].xyz;
}

fn unpack_sound(corner: Corner) {
    panel.sound = unpack_shared(array(corner.shared_0, corner.shared_1, corner.shared_2, corner.shared_3));
}

fn unpack_alarm(corner: Corner) {
    panel.alarm = unpack_shared(array(corner.shared_0, corner.shared_1, corner.shared_2, corner.shared_3));
}

const KEY = vec3<f32>(0.66, 0.635, 0.595);
const SKY = vec3<f32>(0.60, 0.635, 0.68);
const GROUND = vec3<f32>(0.27, 0.262, 0.25);
// Light that bends around edges into the shade.
const WRAP = 0.12;
// Below this height above the floor (soft units) side faces get less light, down to this part of it.
const CONTACT_HEIGHT = 0.9;
const CONTACT_LIGHT = 0.72;
// At a face-to-face contact, a body and an obstacle take this part of the ambient light from each other, and less of
// the key light.
const TAKEN = 0.75;
const KEY_TAKEN = 0.8;
// The turned-over set is drawn this much nearer (sides), so that it wins where it shares faces with the other one.
const NEARER = 0.02;
// A face turned away is this much farther back, relative to the distance.
const BACK_FACE = 1e-5;
// The dark share of a stripe's period.
const STRIPE = 0.2;
// From this depth (soft units) behind the visible surface on, a turned-over element is equally visible.
const THROUGH_DEPTH = 0.6;
// The brightness of a surface without lighting.
const UNLIT = 0.86;

// The drawn position of a face's corner. Of two faces at the same place, as in a body pressed flat, the one towards the
// viewer is always visible: the other is moved back by a few times the round-off of depths.
fn corner_place(position: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    var place = panel.clip * vec4(position, 1.0);
    if dot(normal, panel.eye - position) < 0.0 {
        place.z *= 1.0 - BACK_FACE;
    }
    return place;
}

@vertex
fn sound_corner(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) hatch: f32) -> Corner {
    panel = panel_data;
    let same = pack_shared(panel.sound);
    let place = corner_place(position, normal);
    return Corner(place, position, normal, hatch, same[0], same[1], same[2], same[3]);
}

// The drawn position of a corner of the turned-over set.
fn moved_nearer(position: vec3<f32>, normal: vec3<f32>) -> vec4<f32> {
    var place = corner_place(position, normal);
    place.z *= place.w / max(place.w - NEARER, panel.near);
    place.z = min(place.z, place.w);
    return place;
}

@vertex
fn alarm_corner(@location(0) position: vec3<f32>, @location(1) normal: vec3<f32>, @location(2) hatch: f32) -> Corner {
    panel = panel_data;
    let same = pack_shared(panel.alarm);
    let place = moved_nearer(position, normal);
    return Corner(place, position, normal, hatch, same[0], same[1], same[2], same[3]);
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
    return light_left(position, facing, left_by_obstacles(position, facing));
}

// The light on a point with a unit normal, reduced by near objects.
fn light_left(position: vec3<f32>, facing: vec3<f32>, left: f32) -> Light {
    let view = normalize(panel.eye - position);
    let key = mix(1.0, left, KEY_TAKEN) * max(0.0, dot(facing, panel.key) + WRAP) / (1.0 + WRAP);
    let upward = dot(facing, panel.up);
    let height = dot(position, panel.up) - panel.floor;
    let contact = mix(CONTACT_LIGHT, 1.0, smoothstep(0.0, CONTACT_HEIGHT * panel.soft, height));
    let around = left * mix(GROUND, SKY, 0.5 + 0.5 * upward) * mix(contact, 1.0, abs(upward));
    let shine = max(0.0, dot(facing, normalize(view + panel.key)));
    let shine4 = shine * shine * shine * shine;
    let shine16 = shine4 * shine4 * shine4 * shine4;
    let rim = 1.0 - max(0.0, dot(facing, view));
    let gloss = 0.05 * shine16 * shine4 * shine4 * shine4 + 0.06 * rim * rim * rim * rim;
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

struct AlarmColour {
    lit: vec3<f32>,
    brightness: f32,
}

fn alarm(corner: Corner) -> AlarmColour {
    let light = light(corner.position, corner.normal);
    let dark = STRIPE_ALPHA * stripes(corner.hatch);
    let colour = mix(panel.alarm, panel.alarm_line, dark);
    return AlarmColour(colour * light.diffuse + light.gloss, dot(light.diffuse, LUMINANCE));
}

// The turned-over set, as seen through the body, and as a surface of the body.
struct TurnedOver {
    @location(0) behind: vec4<f32>,
    @location(1) surface: vec4<f32>,
}

@fragment
fn alarm_surface(corner: Corner) -> TurnedOver {
    unpack_alarm(corner);
    let alarm = alarm(corner);
    let colour = sqrt(saturate(alarm.lit));
    return TurnedOver(vec4(colour, saturate(0.5 * alarm.brightness)), vec4(colour, 1.0));
}

fn opaque(colour: vec3<f32>) -> vec4<f32> {
    return vec4(sqrt(saturate(colour)), 1.0);
}

// The stored colour of a surface over the colour behind it.
fn over_behind(colour: vec3<f32>, corner: Corner) -> vec4<f32> {
    let at = vec2<i32>(corner.place.xy);
    let behind = load_alarm_depth(at);
    let stored = load_alarm_colour(at);
    if behind <= 0.0 {
        return opaque(colour);
    }
    let depth = panel.near / behind - 1.0 / corner.place.w;
    let deep = smoothstep(0.0, THROUGH_DEPTH * panel.soft, depth);
    let lit = stored.rgb * stored.rgb;
    let unlit = lit * (UNLIT / max(2.0 * stored.a, 0.05));
    let alarm = mix(lit, unlit, 0.65 * deep);
    // Blue-grey under vermilion would turn pink, so the surface is desaturated first.
    let grey = mix(colour, vec3(dot(colour, LUMINANCE)), 0.7);
    return opaque(mix(grey, alarm, 1.0 - 0.4 * deep));
}

// The part of a pixel that the dots of a flat element cover.
fn dots(place: vec2<f32>) -> f32 {
    let scale = panel.line_scale;
    let from_body = (place + panel.place.xy - panel.place.zw) / (DOTS_APART * scale);
    // Rows at 45°.
    let at = vec2(from_body.x + from_body.y, from_body.y - from_body.x) * 0.70710678;
    let off = length(fract(at) - 0.5) * DOTS_APART * scale;
    return DOT_ALPHA * saturate(DOT * scale + 0.5 - off);
}

// The colour of a surface that is not inverted.
fn sound(corner: Corner, own: vec3<f32>) -> vec3<f32> {
    let light = light(corner.position, corner.normal);
    return own * light.diffuse + light.gloss;
}

@fragment
fn sound_surface(corner: Corner) -> @location(0) vec4<f32> {
    unpack_sound(corner);
    return opaque(sound(corner, panel.sound));
}

// For panels with turned-over elements behind such surfaces, or with flat elements. A software driver would run all of
// it for every surface.
@fragment
fn sound_before(corner: Corner) -> @location(0) vec4<f32> {
    unpack_sound(corner);
    var own = panel.sound;
    if corner.hatch > 0.5 {
        // Flat: grey with dots.
        own = mix(vec3(dot(own, LUMINANCE)), panel.edge, dots(corner.place.xy));
    }
    return over_behind(sound(corner, own), corner);
}
