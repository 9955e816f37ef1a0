// Reading around a point: four places in the pixel around it, no two of them in one row or column.

const TAPS = 4u;

fn tap_place(tap: u32) -> vec2<f32> {
    let upper = select(vec2(0.875, 0.375), vec2(0.375, 0.125), tap == 0u);
    let lower = select(vec2(0.625, 0.875), vec2(0.125, 0.625), tap == 2u);
    return select(lower, upper, tap < 2u);
}
