// Where there are solid obstacles: they have left a mark of their own in the opacity.

const OBSTACLE = 254.0 / 255.0;

fn is_obstacle(place: vec2<f32>, sample: u32) -> bool {
    let opacity = load_sample_opacity(texel_around(place, sample), sample);
    return abs(opacity - OBSTACLE) < 0.001;
}
