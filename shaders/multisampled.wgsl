// Reading what was drawn with four samples a pixel.

@group(1) @binding(0) var body_colour: texture_multisampled_2d<f32>;
@group(1) @binding(1) var body_depth: texture_depth_multisampled_2d;

fn load_sample_depth(at: vec2<i32>, sample: u32) -> f32 {
    return textureLoad(body_depth, at, sample);
}

fn load_sample_opacity(at: vec2<i32>, sample: u32) -> f32 {
    return textureLoad(body_colour, at, sample).a;
}

fn load_depth(at: vec2<i32>) -> f32 {
    return textureLoad(body_depth, at, 0);
}

// The share of samples that hold something farther away than a depth.
fn share_beyond(at: vec2<i32>, depth: f32) -> f32 {
    let here = vec4(
        textureLoad(body_depth, at, 0),
        textureLoad(body_depth, at, 1),
        textureLoad(body_depth, at, 2),
        textureLoad(body_depth, at, 3),
    );
    return dot(vec4(0.25), select(vec4(0.0), vec4(1.0), (here > vec4(0.0)) & (here < vec4(depth))));
}

// Linear, multiplied with alpha: the mean of the samples.
fn load_colour(at: vec2<i32>) -> vec4<f32> {
    let a = textureLoad(body_colour, at, 0);
    let b = textureLoad(body_colour, at, 1);
    let c = textureLoad(body_colour, at, 2);
    let d = textureLoad(body_colour, at, 3);
    let colour = a.rgb * a.rgb + b.rgb * b.rgb + c.rgb * c.rgb + d.rgb * d.rgb;
    return 0.25 * vec4(colour, a.a + b.a + c.a + d.a);
}
