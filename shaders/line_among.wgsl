// Where there are solid obstacles: they have left a mark of their own in the opacity.

fn is_obstacle(place: vec2<f32>, sample: u32) -> bool {
    let opacity = load_sample_opacity(texel_around(place, sample), sample);
    return opacity > 0.5 && opacity < 0.998;
}
