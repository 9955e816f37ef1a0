// Lines in panels with solid obstacles, which are marked by their opacity.

const OBSTACLE = 254.0 / 255.0;

fn is_obstacle(place: vec2<f32>, sample: u32) -> bool {
    let opacity = load_sample_opacity(texel_around(place, sample), sample);
    return abs(opacity - OBSTACLE) < 0.001;
}
