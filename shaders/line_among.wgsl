// Where there are solid obstacles: they have left a mark of their own in the opacity.

const OBSTACLE = 254.0 / 255.0;

fn is_obstacle(at: vec2<i32>) -> bool {
    let opacity = textureLoad(body_colour, at, 0).a;
    return abs(opacity - OBSTACLE) < 0.001;
}
