// How many samples a pixel has, and where they lie within it.

const SAMPLES = 1u;

fn sample_place(sample: u32) -> vec2<f32> {
    return vec2(0.5);
}
