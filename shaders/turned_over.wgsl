// The turned-over elements, drawn alone before: lit colour, brightness of the light in alpha, and depth.

@group(1) @binding(2) var alarm_depth: texture_depth_2d;
@group(1) @binding(3) var alarm_colour: texture_2d<f32>;

fn load_alarm_depth(at: vec2<i32>) -> f32 {
    return textureLoad(alarm_depth, at, 0);
}

fn load_alarm_colour(at: vec2<i32>) -> vec4<f32> {
    return textureLoad(alarm_colour, at, 0);
}
