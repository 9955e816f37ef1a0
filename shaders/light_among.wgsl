// Occlusion of ambient light by `OCCLUDERS` obstacles near a body, which shows where they touch.

// There is no occlusion from this distance on (soft units). A plate, which is transparent, occludes less.
const TAKEN_REACH = 1.3;
const PLATE_TAKES = 0.37;

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
