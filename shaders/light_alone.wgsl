// Ambient light without obstacles near the body.

fn left_by_obstacles(position: vec3<f32>, facing: vec3<f32>) -> f32 {
    return 1.0;
}
