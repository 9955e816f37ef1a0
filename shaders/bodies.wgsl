// Reading the drawn bodies, and the turned-over elements, drawn alone before.

@group(1) @binding(0) var body_colour: texture_2d<f32>;
@group(1) @binding(1) var body_depth: texture_depth_2d;
@group(1) @binding(2) var alarm_depth: texture_depth_2d;
// Lit colour, with the brightness of the light in alpha.
@group(1) @binding(3) var alarm_colour: texture_2d<f32>;
// Opacities of lines over the bodies, and the light that borders add to pixels.
@group(2) @binding(4) var line_opacity: texture_2d<f32>;
@group(2) @binding(5) var borders: texture_2d<f32>;

fn load_depth(at: vec2<i32>) -> f32 {
    return textureLoad(body_depth, at, 0);
}

fn load_alarm_depth(at: vec2<i32>) -> f32 {
    return textureLoad(alarm_depth, at, 0);
}

// A stored colour as linear light, multiplied with alpha.
fn decoded_body(stored: vec4<f32>) -> vec4<f32> {
    return vec4(stored.rgb * stored.rgb, stored.a);
}
