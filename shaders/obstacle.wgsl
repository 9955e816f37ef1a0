// Solid obstacles, among the bodies: the same light on another material, nothing below the floor.

struct SolidCorner {
    @builtin(position) place: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat) colour: vec3<f32>,
    @location(3) above: f32,
    // The share of ambient light that the body occludes.
    @location(4) near: f32,
    @location(5) @interpolate(flat) shared_0: vec4<f32>,
    @location(6) @interpolate(flat) shared_1: vec4<f32>,
    @location(7) @interpolate(flat) shared_2: vec4<f32>,
    @location(8) @interpolate(flat) shared_3: vec4<f32>,
}

fn unpack_solid(corner: SolidCorner) {
    panel.sound = unpack_shared(array(corner.shared_0, corner.shared_1, corner.shared_2, corner.shared_3));
}

@vertex
fn solid_corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
    @location(3) near: f32,
) -> SolidCorner {
    panel = panel_data;
    let same = pack_shared(panel.sound);
    let above = dot(position, panel.up) - panel.floor;
    let place = panel.clip * vec4(position, 1.0);
    return SolidCorner(place, position, normal, colour, above, near, same[0], same[1], same[2], same[3]);
}

@fragment
fn solid_surface(corner: SolidCorner) -> @location(0) vec4<f32> {
    unpack_solid(corner);
    let rise = length(vec2(dpdx(corner.above), dpdy(corner.above)));
    let light = light_left(corner.position, facing_normal(corner.position, corner.normal), 1.0 - TAKEN * corner.near);
    let colour = corner.colour * light.diffuse + light.gloss;
    // Nothing is drawn below the floor.
    let inside = saturate(corner.above / max(rise, 1e-9) + 0.5);
    if inside <= 0.0 {
        discard;
    }
    return vec4(sqrt(saturate(colour) * inside), OBSTACLE * inside);
}
