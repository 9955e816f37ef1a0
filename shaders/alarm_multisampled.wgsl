// The turned-over elements, drawn beforehand by themselves with four samples a pixel: lit colour, brightness of the light
// in alpha, and depth.

@group(1) @binding(2) var alarm_depth: texture_depth_multisampled_2d;
@group(1) @binding(3) var alarm_colour: texture_multisampled_2d<f32>;

fn load_alarm_depth(at: vec2<i32>, sample: u32) -> f32 {
    return textureLoad(alarm_depth, at, sample);
}

fn load_alarm_colour(at: vec2<i32>, sample: u32) -> vec4<f32> {
    return textureLoad(alarm_colour, at, sample);
}
