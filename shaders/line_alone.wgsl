// Lines in panels without solid obstacles.

fn is_obstacle(place: vec2<f32>, tap: u32) -> bool {
    return false;
}
