// Reading what was drawn with one sample a pixel.

@group(1) @binding(0) var body_colour: texture_2d<f32>;
@group(1) @binding(1) var body_depth: texture_depth_2d;

fn load_sample_depth(at: vec2<i32>, sample: u32) -> f32 {
    return textureLoad(body_depth, at, 0);
}

fn load_sample_opacity(at: vec2<i32>, sample: u32) -> f32 {
    return textureLoad(body_colour, at, 0).a;
}

fn load_depth(at: vec2<i32>) -> f32 {
    return textureLoad(body_depth, at, 0);
}

// The share of samples that hold something farther away than a depth.
fn share_beyond(at: vec2<i32>, depth: f32) -> f32 {
    let here = load_depth(at);
    return select(0.0, 1.0, here > 0.0 && here < depth);
}

// Linear, multiplied with alpha.
fn load_colour(at: vec2<i32>) -> vec4<f32> {
    let stored = textureLoad(body_colour, at, 0);
    return vec4(stored.rgb * stored.rgb, stored.a);
}
