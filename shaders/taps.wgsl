// Reading around a point: four places in the pixel around it, in different rows and columns.

const TAPS = 4u;

fn tap_place(tap: u32) -> vec2<f32> {
    let upper = select(vec2(0.875, 0.375), vec2(0.375, 0.125), tap == 0u);
    let lower = select(vec2(0.625, 0.875), vec2(0.125, 0.625), tap == 2u);
    return select(lower, upper, tap < 2u);
}

// The texel of a pixel in the textures of bodies, and the depth of the bodies there.
fn texel_of(place: vec2<f32>) -> vec2<i32> {
    let low = panel.region.xy;
    let high = low + panel.region.zw - 1.0;
    return vec2<i32>(clamp(floor(place), low, high));
}

// The texel at one of the taps around a point (px). All taps together represent the pixel around that point.
fn texel_around(place: vec2<f32>, tap: u32) -> vec2<i32> {
    return texel_of(place - tap_place(tap) + 0.5);
}

// The depth of the bodies at one of the taps around a point.
fn tap_depth(place: vec2<f32>, tap: u32) -> f32 {
    return load_depth(texel_around(place, tap));
}

// Lines fade over this range of depths in front of the surface and behind it, relative to the distance, so that they do
// not appear suddenly.
const FADED_DEPTH = 0.0008;

// The visibility of a line at one depth near a surface at another.
fn visible_share(line: f32, surface: f32) -> f32 {
    return saturate(0.5 + 0.5 * (line - surface) / (FADED_DEPTH * max(surface, 1e-9)));
}
