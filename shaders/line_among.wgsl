// Lines in panels with solid obstacles, which are marked by their opacity.

fn is_obstacle(place: vec2<f32>, tap: u32) -> bool {
    let opacity = textureLoad(body_colour, texel_around(place, tap), 0).a;
    return abs(opacity - OBSTACLE) < 0.001;
}
