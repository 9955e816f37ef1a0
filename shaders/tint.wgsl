// Surfaces coloured by a scalar field, with mild lighting that keeps the colours of its scale. Turned-over elements are
// coloured, too, and keep their hatch, in vermilion; deep in the body only the hatch is visible.

// The colours of the scale, linear.
@group(1) @binding(4) var<uniform> ramp: array<vec4<f32>, SHADES>;

const SHADES = 64;
// Light changes the lightness of a colour by at most this part, up and down, and never its hue. The darkest and the
// brightest light have these brightnesses.
const LIGHTNESS = 0.06;
const BRIGHTNESS = vec2<f32>(0.40, 1.15);
// The strength of stripes that are seen through the body.
const THROUGH = 0.75;
// Up to this depth (soft units) behind the surface the colours of turned-over elements are visible, fading with depth.
// So there is no jagged border where they cut the surface or lie close to it, and nothing appears suddenly.
const NEAR_DEPTH = 0.3;

struct TintedCorner {
    @builtin(position) place: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hatch: f32,
    @location(3) shade: f32,
    @location(4) @interpolate(flat) shared_0: vec4<f32>,
    @location(5) @interpolate(flat) shared_1: vec4<f32>,
    @location(6) @interpolate(flat) shared_2: vec4<f32>,
    @location(7) @interpolate(flat) shared_3: vec4<f32>,
}

fn unpack_tinted(corner: TintedCorner) -> vec3<f32> {
    return unpack_shared(array(corner.shared_0, corner.shared_1, corner.shared_2, corner.shared_3));
}

@vertex
fn tinted_corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hatch: f32,
    @location(3) shade: f32,
) -> TintedCorner {
    panel = panel_data;
    let same = pack_shared(panel.sound);
    let place = corner_place(position, normal);
    return TintedCorner(place, position, normal, hatch, shade, same[0], same[1], same[2], same[3]);
}

@vertex
fn tinted_alarm_corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) hatch: f32,
    @location(3) shade: f32,
) -> TintedCorner {
    panel = panel_data;
    let same = pack_shared(panel.alarm);
    let place = moved_nearer(position, normal);
    return TintedCorner(place, position, normal, hatch, shade, same[0], same[1], same[2], same[3]);
}

fn tint(corner: TintedCorner) -> vec3<f32> {
    let at = saturate(corner.shade) * f32(SHADES - 1);
    let cell = min(u32(at), u32(SHADES - 2));
    let shade = mix(ramp[cell].rgb, ramp[cell + 1u].rgb, at - f32(cell));
    // Below zero there is no value.
    let colour = select(panel.sound, shade, corner.shade > -0.5);
    let brightness = dot(light(corner.position, corner.normal).diffuse, LUMINANCE);
    let lightness = 1.0 + LIGHTNESS * (2.0 * smoothstep(BRIGHTNESS.x, BRIGHTNESS.y, brightness) - 1.0);
    // Lightness follows the cube root of light (Oklab). Colours too bright for the screen would change their hue there.
    let most = 1.0 / max(max(colour.r, colour.g), max(colour.b, 1e-3));
    return colour * min(lightness * lightness * lightness, most);
}

// The colour of a turned-over element, and the share of the stripes of its hatch.
fn alarm_tint(corner: TintedCorner) -> vec4<f32> {
    let covered = stripes(corner.hatch);
    return vec4(mix(tint(corner), panel.alarm, covered), covered);
}

// Behind the body, the part of a pixel that its hatch covers.
@fragment
fn tinted_alarm(corner: TintedCorner) -> TurnedOver {
    panel.alarm = unpack_tinted(corner);
    let alarm = alarm_tint(corner);
    let colour = sqrt(saturate(alarm.rgb));
    return TurnedOver(vec4(colour, alarm.a), vec4(colour, 1.0));
}

// As for plain surfaces.
fn tinted_over(colour: vec3<f32>, corner: TintedCorner) -> vec4<f32> {
    let at = vec2<i32>(corner.place.xy);
    let behind = load_alarm_depth(at);
    let stored = load_alarm_colour(at);
    if behind <= 0.0 {
        return opaque(colour);
    }
    let depth = panel.near / behind - 1.0 / corner.place.w;
    let deep = smoothstep(0.0, THROUGH_DEPTH * panel.soft, depth);
    // Of a hatch only the stripes are visible, not the colours between them.
    let through = mix(colour, panel.alarm, THROUGH * (1.0 - 0.4 * deep) * stored.a);
    return opaque(mix(stored.rgb * stored.rgb, through, smoothstep(0.0, NEAR_DEPTH * panel.soft, depth)));
}

@fragment
fn tinted_sound(corner: TintedCorner) -> @location(0) vec4<f32> {
    panel.sound = unpack_tinted(corner);
    return opaque(tint(corner));
}

@fragment
fn tinted_before(corner: TintedCorner) -> @location(0) vec4<f32> {
    panel.sound = unpack_tinted(corner);
    // Flat elements are dotted.
    let dotted = select(0.0, dots(corner.place.xy), corner.hatch > 0.5);
    return tinted_over(mix(tint(corner), panel.edge, dotted), corner);
}
