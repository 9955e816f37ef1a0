// A straight line in space as a strip of pixels, for all passes that draw lines.

// The ends of a line in clip space, without the part behind the eye.
struct Ends {
    a: vec4<f32>,
    b: vec4<f32>,
    seen: bool,
}

fn ends_of(start: vec3<f32>, end: vec3<f32>) -> Ends {
    var a = panel.clip * vec4(start, 1.0);
    var b = panel.clip * vec4(end, 1.0);
    let near = panel.near;
    let seen = a.w >= near || b.w >= near;
    if seen && a.w < near {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    } else if seen && b.w < near {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    return Ends(a, b, seen);
}

const FLIP = vec2<f32>(0.5, -0.5);

// The place in a target of a size (px) of a point in clip space.
fn pixel_of(at: vec4<f32>, size: vec2<f32>) -> vec2<f32> {
    return (at.xy / at.w * FLIP + 0.5) * size;
}

// A corner of the strip of this half width (px) around a line between two pixels.
fn strip_corner(corner: u32, from_pixel: vec2<f32>, to_pixel: vec2<f32>, reach: f32, size: vec2<f32>) -> vec4<f32> {
    let difference = to_pixel - from_pixel;
    let extent = length(difference);
    let along = select(vec2(1.0, 0.0), difference / extent, extent > 1e-6);
    let across = vec2(-along.y, along.x);
    let pixel = select(from_pixel - along * reach, to_pixel + along * reach, corner >= 2u)
        + across * select(-reach, reach, (corner & 1u) == 1u);
    return vec4((pixel / size - 0.5) / FLIP, 0.5, 1.0);
}

// A corner of one triangle around that strip, for lines that are empty outside it. It halves the work for short lines,
// whose triangles cost more than their pixels.
fn triangle_corner(corner: u32, from_pixel: vec2<f32>, to_pixel: vec2<f32>, reach: f32, size: vec2<f32>) -> vec4<f32> {
    let difference = to_pixel - from_pixel;
    let extent = length(difference);
    let along = select(vec2(1.0, 0.0), difference / extent, extent > 1e-6);
    let across = vec2(-along.y, along.x);
    // The base lies along the strip, twice as long. The triangle is twice as high as the strip, whose corners lie on
    // its sides.
    let half = 0.5 * extent + reach;
    let base = select(-2.0, 2.0, corner == 1u) * half * along - reach * across;
    let pixel = 0.5 * (from_pixel + to_pixel) + select(base, 3.0 * reach * across, corner == 2u);
    return vec4((pixel / size - 0.5) / FLIP, 0.5, 1.0);
}

// Outside the target.
const NOWHERE = vec4<f32>(0.0, 0.0, -1.0, 1.0);
