// Where `OCCLUDERS` obstacles are near a body: they take light away from it, so that one sees where they touch.

// Nothing is taken from this distance on (soft units). A plate takes less: one sees through it.
const TAKEN_REACH = 1.3;
const PLATE_TAKES = 0.37;

// A vector turned by the inverse of a quaternion.
fn turned_back(turn: vec4<f32>, vector: vec3<f32>) -> vec3<f32> {
    return vector + 2.0 * cross(cross(vector, turn.xyz) + turn.w * vector, turn.xyz);
}

// The part of the light that an obstacle leaves to a point of a body with a normal. All kinds go the same way: drawing on
// a processor, pixels beside each other would go all ways together.
fn left_by(occluder: Occluder, position: vec3<f32>, facing: vec3<f32>) -> f32 {
    let local = turned_back(occluder.turn, position - occluder.first.xyz);
    let out = sign(local) * max(abs(local) - occluder.second.xyz, vec3(0.0));
    let size = length(out);
    let apart = saturate((size - occluder.first.w) / (TAKEN_REACH * panel.soft));
    let away = dot(turned_back(occluder.turn, facing), out) / max(size, 1e-9);
    // As at the floor: what faces a plate touches it and is seen through it.
    let turned = mix(0.5 - 0.5 * away, PLATE_TAKES * (1.0 - abs(away)), occluder.second.w);
    return 1.0 - TAKEN * turned * (1.0 - apart) * (1.0 - apart);
}

fn left_by_obstacles(position: vec3<f32>, facing: vec3<f32>) -> f32 {
    var left = 1.0;
    for (var at = 0u; at < OCCLUDERS; at++) {
        left *= left_by(panel.occluders[at], position, facing);
    }
    return left;
}
