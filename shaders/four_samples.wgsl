// How many samples a pixel has, and where they lie within it.

const SAMPLES = 4u;

fn sample_place(sample: u32) -> vec2<f32> {
    let upper = select(vec2(0.875, 0.375), vec2(0.375, 0.125), sample == 0u);
    let lower = select(vec2(0.625, 0.875), vec2(0.125, 0.625), sample == 2u);
    return select(lower, upper, sample < 2u);
}
