// Reading the drawn bodies.

@group(1) @binding(0) var body_colour: texture_2d<f32>;
@group(1) @binding(1) var body_depth: texture_depth_2d;

fn load_depth(at: vec2<i32>) -> f32 {
    return textureLoad(body_depth, at, 0);
}

// A stored colour as linear light, multiplied with alpha.
fn decoded_body(stored: vec4<f32>) -> vec4<f32> {
    return vec4(stored.rgb * stored.rgb, stored.a);
}
