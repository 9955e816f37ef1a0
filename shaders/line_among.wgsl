// Where there are solid obstacles: they have left a mark of their own in the opacity.

fn is_obstacle(at: vec2<i32>) -> bool {
    let opacity = textureLoad(body_colour, at, 0).a;
    return opacity > 0.5 && opacity < 0.998;
}
