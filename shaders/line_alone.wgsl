// Where there are no solid obstacles.

fn is_obstacle(at: vec2<i32>) -> bool {
    return false;
}
