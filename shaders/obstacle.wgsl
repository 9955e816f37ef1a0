// Solid obstacles, among the bodies: the same light on another material, nothing below the floor.

struct SolidCorner {
    @builtin(position) place: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat) colour: vec3<f32>,
}

// What is stored as opacity where an obstacle is seen: the passes that follow know it by that, and no eye does.
const OBSTACLE = 254.0 / 255.0;

@vertex
fn solid_corner(
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
) -> SolidCorner {
    return SolidCorner(panel.clip * vec4(position, 1.0), position, normal, colour);
}

fn solid(corner: SolidCorner, opacity: f32) -> vec4<f32> {
    if dot(corner.position, panel.up) < panel.floor {
        discard;
    }
    let light = light(corner.position, corner.normal);
    let colour = corner.colour * light.diffuse + light.gloss;
    return vec4(sqrt(saturate(colour)), opacity);
}

@fragment
fn solid_surface(corner: SolidCorner) -> @location(0) vec4<f32> {
    return solid(corner, OBSTACLE);
}

// Among the turned-over elements, to be seen through clear surfaces.
@fragment
fn solid_behind(corner: SolidCorner) -> @location(0) vec4<f32> {
    return solid(corner, 1.0);
}
