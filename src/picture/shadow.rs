//! Soft shadows on the floor, of the key light and of the sky. They are computed on the processor, so that they are the
//! same with any graphics device.
//!
//! The body is projected along many directions onto a grid of cells. One direction fills one bit of each cell, a row of
//! cells is one machine word, and so a projected triangle costs one operation for each row it touches.

use super::camera::{Framing, Lens};
use super::narrow::narrow;
use crate::look::Light;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Cells of a shadow in each direction.
pub(crate) const CELLS: usize = 128;
/// Half the angle of the cone from which the key light comes (rad).
const KEY_CONE: f64 = 0.12;
/// How much steeper the key light falls for each distance of the camera that bodies have risen: the shadow stays in the
/// panel.
const KEY_STEEPENING: f64 = 8.0;
/// How many directions stand for the key light and for the sky.
const DIRECTIONS: [usize; 2] = [48, 96];
/// Bodies of more triangles than this get fewer directions, or the shadow would take longer than everything else.
const MANY_TRIANGLES: usize = 6000;
/// How far the edges of both shadows are blurred (sides).
const BLUR: [f64; 2] = [0.06, 0.14];
/// The golden angle (rad): steps by it spread directions evenly.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// A square of the floor with a value for each cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shade {
    /// The corner of the first cell on the floor (sides from the panel's origin along the floor's two axes).
    pub corner: [f32; 2],
    /// Length of the whole square (sides).
    pub length: f32,
    /// How much light is missing: 0 none, 255 all; row after row along the second axis. Empty for no shadow at all.
    pub cells: Vec<u8>,
}

/// The floor's plane with axes in it; lengths in sides from the panel's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) axes: [DVec3; 2],
    pub(super) height: f64,
}

impl Plane {
    /// The plane with a normal through the points `normal · x = height`.
    pub(super) fn new(normal: DVec3, height: f64) -> Self {
        // For a level floor the axes are those of the world, and so is the grid.
        let first = (DVec3::X - normal.x * normal).try_normalize().unwrap_or(DVec3::Z);
        Self { normal, axes: [first, first.cross(normal)], height }
    }

    /// The foot of a point on the plane, and its height. Points below the plane get height 0.
    fn foot(&self, point: DVec3) -> Foot {
        let above = (self.normal.dot(point) - self.height).max(0.0);
        Foot { at: DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1])), above }
    }

    /// Where the shadow of a point falls in light from a direction, along both axes. From light that is level with the
    /// plane it falls nowhere, and from there on it stays below the point.
    pub(super) fn shadow(&self, point: DVec3, towards_light: DVec3) -> DVec2 {
        let foot = self.foot(point);
        if self.normal.dot(towards_light) > 0.05 { foot.shadow(self.slant(towards_light)) } else { foot.at }
    }

    /// How far light from a direction moves the shadow of what is one unit above the plane.
    fn slant(&self, towards_light: DVec3) -> DVec2 {
        let along = DVec2::new(towards_light.dot(self.axes[0]), towards_light.dot(self.axes[1]));
        -along / self.normal.dot(towards_light)
    }
}

/// Unit vector towards the key light, which goes with a camera.
pub(super) fn key_light(lens: &Lens, framing: &Framing, light: Light) -> DVec3 {
    let towards_viewer = lens.right.cross(DVec3::Y);
    let (left, towards) = libm::sincos(light.azimuth);
    let level = towards * towards_viewer - left * lens.right;
    let slope = libm::tan(light.elevation) + KEY_STEEPENING * framing.rise / framing.distance;
    (level + slope * DVec3::Y).normalize()
}

/// A point by its place over a plane and its height above it.
#[derive(Clone, Copy)]
struct Foot {
    at: DVec2,
    above: f64,
}

impl Foot {
    fn shadow(self, slant: DVec2) -> DVec2 {
        self.at + self.above * slant
    }
}

/// The shadows of key light and sky that closed surfaces throw on a plane, within `reach` of `middle` on it, with
/// `soft` as unit of blur.
pub(super) fn shades(
    points: &[DVec3],
    triangles: &[[u32; 3]],
    plane: &Plane,
    key: DVec3,
    middle: DVec2,
    reach: f64,
    soft: f64,
) -> [Shade; 2] {
    let blur = BLUR.map(|blur| blur * soft);
    let feet: Vec<_> = points.iter().map(|&point| plane.foot(point)).collect();
    let thinning = (triangles.len() / MANY_TRIANGLES + 1).min(6);
    let [of_key, of_sky] = DIRECTIONS.map(|count| count / thinning);
    let frame = Plane::new(key, 0.0);
    let key_directions: Vec<_> = (0..of_key)
        .map(|at| {
            let radius = KEY_CONE * ((at as f64 + 0.5) / of_key as f64).sqrt();
            let (sine, cosine) = libm::sincos(at as f64 * GOLDEN_ANGLE);
            (key + radius * (cosine * frame.axes[0] + sine * frame.axes[1])).normalize()
        })
        .collect();
    let sky_directions: Vec<_> = (0..of_sky)
        .map(|at| {
            let outward = ((at as f64 + 0.5) / of_sky as f64).sqrt();
            let (sine, cosine) = libm::sincos(at as f64 * GOLDEN_ANGLE);
            let [first, second] = plane.axes;
            outward * (cosine * first + sine * second) + (1.0 - outward * outward).sqrt() * plane.normal
        })
        .collect();
    let shade = |directions: &[DVec3], blur: f64, low: DVec2, length: f64| {
        let mut counts = Counts::new();
        let scale = CELLS as f64 / length;
        let mut projected = Vec::with_capacity(feet.len());
        for &direction in directions {
            let slant = plane.slant(direction);
            projected.clear();
            projected.extend(feet.iter().map(|foot| (foot.shadow(slant) - low) * scale));
            let mut mask = Mask::new();
            for triangle in triangles {
                mask.fill(triangle.map(|at| projected[at as usize]));
            }
            counts.add(&mask);
        }
        let cells = counts.blurred(directions.len(), blur * scale);
        Shade { corner: [narrow(low.x), narrow(low.y)], length: narrow(length), cells }
    };
    // The key light's shadow has sharp ends: its grid holds the shadow and no more.
    let (low, high) = bounds(&feet, &key_directions, plane, middle, reach);
    let [key_low, key_length] = snapped(low, (high - low).max_element() + 6.0 * blur[0]);
    let (sky_low, sky_length) = (middle - reach, 2.0 * reach);
    [
        shade(&key_directions, blur[0], DVec2::new(key_low[0], key_low[1]), key_length[0]),
        shade(&sky_directions, blur[1], sky_low, sky_length),
    ]
}

/// The box around all shadows, within reach.
fn bounds(feet: &[Foot], directions: &[DVec3], plane: &Plane, middle: DVec2, reach: f64) -> (DVec2, DVec2) {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    // The last directions are the outermost.
    for &direction in directions.iter().rev().take(12) {
        let slant = plane.slant(direction);
        for at in feet.iter().map(|foot| foot.shadow(slant)) {
            (low, high) = (low.min(at), high.max(at));
        }
    }
    let within = |corner: DVec2| corner.clamp(middle - reach, middle + reach);
    (within(low), within(high))
}

/// A square around a box, with one of few cell sizes and its corner on the cells' own lattice, so that the cells do not
/// creep under a body that moves.
fn snapped(low: DVec2, length: f64) -> [[f64; 2]; 2] {
    let steps = (libm::log2(length.max(1.0) * CELLS as f64 / (CELLS - 8) as f64) * 4.0).ceil();
    let length = libm::exp2(steps / 4.0);
    let cell = length / CELLS as f64;
    let corner = (low / cell).floor() * cell - 4.0 * cell;
    [[corner.x, corner.y], [length, cell]]
}

/// Which cells one projection covers: a word for each row.
struct Mask([u128; CELLS]);

impl Mask {
    fn new() -> Self {
        Self([0; CELLS])
    }

    /// Covers the cells whose middles lie in a triangle that is turned counter-clockwise. The others bound the same
    /// closed surface from behind and cover nothing more.
    fn fill(&mut self, [a, b, c]: [DVec2; 3]) {
        if (b - a).perp_dot(c - a) <= 0.0 {
            return;
        }
        let by_height = |a: DVec2, b: DVec2| if b.y < a.y { (b, a) } else { (a, b) };
        let (a, b) = by_height(a, b);
        let (b, c) = by_height(b, c);
        let (a, b) = by_height(a, b);
        let rows = [a, b, c].map(|corner| first_middle(corner.y));
        // The long side and one of the short ones bound each row.
        self.fill_between([a, c], [a, b], rows[0]..rows[1]);
        self.fill_between([a, c], [b, c], rows[1]..rows[2]);
    }

    fn fill_between(&mut self, one: [DVec2; 2], other: [DVec2; 2], rows: Range<usize>) {
        if rows.is_empty() {
            return;
        }
        let slope = |[from, to]: [DVec2; 2]| (to.x - from.x) / (to.y - from.y);
        let slopes = [slope(one), slope(other)];
        for row in rows {
            let y = row as f64 + 0.5;
            let x = one[0].x + (y - one[0].y) * slopes[0];
            let end = other[0].x + (y - other[0].y) * slopes[1];
            self.0[row] |= below(first_middle(x.max(end))) & !below(first_middle(x.min(end)));
        }
    }
}

/// The first cell whose middle is not below a coordinate: that rounded, and kept within the grid.
fn first_middle(at: f64) -> usize {
    // Truncation is many times faster than `round` without SSE 4.1.
    (at + 0.5).clamp(0.0, CELLS as f64) as usize
}

/// A word whose lowest `count` bits are set.
fn below(count: usize) -> u128 {
    u128::MAX.checked_shr((CELLS - count) as u32).unwrap_or(0)
}

/// How many bits count to the largest number of directions.
const COUNTER_BITS: usize = 7;

/// How often each cell was covered: binary digits, the lowest first, each for all cells of a row at once.
struct Counts(Vec<[u128; COUNTER_BITS]>);

impl Counts {
    fn new() -> Self {
        Self(vec![[0; COUNTER_BITS]; CELLS])
    }

    /// Adds one wherever a mask is set.
    fn add(&mut self, mask: &Mask) {
        for (digits, &word) in self.0.iter_mut().zip(&mask.0) {
            let mut carry = word;
            for digit in digits {
                if carry == 0 {
                    break;
                }
                (*digit, carry) = (*digit ^ carry, *digit & carry);
            }
        }
    }

    fn share(&self, directions: usize) -> Vec<f32> {
        let mut share = Vec::with_capacity(CELLS * CELLS);
        for digits in &self.0 {
            for cell in 0..CELLS {
                let count: u8 = (0..COUNTER_BITS).map(|bit| ((digits[bit] >> cell & 1) as u8) << bit).sum();
                share.push(narrow(f64::from(count) / directions as f64));
            }
        }
        share
    }

    /// The share of directions that are covered, 255 for all, blurred by a standard deviation (cells).
    fn blurred(&self, directions: usize, deviation: f64) -> Vec<u8> {
        if self.0.iter().flatten().all(|&digit| digit == 0) {
            return Vec::new();
        }
        let radius = ((2.5 * deviation).ceil() as usize).clamp(1, CELLS / 8);
        let weight = |at: usize| libm::exp(-0.5 * (at as f64 / deviation.max(0.3)).powi(2));
        let total: f64 = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f64>();
        let kernel: Vec<f32> = (0..=radius).map(|at| narrow(weight(at) / total)).collect();
        let share = self.share(directions);
        let across = blur_rows(&share, &kernel);
        let both = transposed(&blur_rows(&transposed(&across), &kernel));
        both.iter().map(|&share| (share * 255.0 + 0.5) as u8).collect()
    }
}

fn blur_rows(cells: &[f32], kernel: &[f32]) -> Vec<f32> {
    let mut out = Vec::with_capacity(cells.len());
    let radius = kernel.len() - 1;
    let mut padded = vec![0.0; CELLS + 2 * radius];
    for row in cells.chunks_exact(CELLS) {
        padded[radius..radius + CELLS].copy_from_slice(row);
        let start = out.len();
        out.extend(row.iter().map(|cell| cell * kernel[0]));
        for (at, weight) in kernel.iter().enumerate().skip(1) {
            let (before, after) = (&padded[radius - at..], &padded[radius + at..]);
            for (cell, (a, b)) in out[start..].iter_mut().zip(before.iter().zip(after)) {
                *cell += weight * (a + b);
            }
        }
    }
    out
}

fn transposed(cells: &[f32]) -> Vec<f32> {
    (0..CELLS * CELLS).map(|at| cells[at % CELLS * CELLS + at / CELLS]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box standing on the floor, its triangles counter-clockwise from outside.
    fn block() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let points =
            (0..8).map(|at: u32| DVec3::new(f64::from(at & 1) - 0.5, f64::from(at >> 1 & 1), f64::from(at >> 2) - 0.5));
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]: &[u32; 4]| [[a, b, c], [a, c, d]]).collect();
        (points.collect(), triangles)
    }

    fn value(shade: &Shade, at: DVec2) -> u8 {
        let corner = DVec2::new(f64::from(shade.corner[0]), f64::from(shade.corner[1]));
        let cell = ((at - corner) * CELLS as f64 / f64::from(shade.length)).floor();
        if cell.min_element() < 0.0 || cell.max_element() >= CELLS as f64 {
            return 0;
        }
        shade.cells[cell.y as usize * CELLS + cell.x as usize]
    }

    #[test]
    fn a_block_shades_what_lies_behind_it_and_nothing_before_it() {
        let (points, triangles) = block();
        let plane = Plane::new(DVec3::Y, 0.0);
        let key = DVec3::new(-1.0, 1.0, 0.0).normalize();
        let [of_key, of_sky] = shades(&points, &triangles, &plane, key, DVec2::ZERO, 4.0, 1.0);
        let on_floor = |x: f64, z: f64| DVec2::new(x * plane.axes[0].x + z * plane.axes[0].z, z * plane.axes[1].z);
        assert_eq!(value(&of_key, on_floor(0.0, 0.0)), 255);
        assert!(value(&of_key, on_floor(1.0, 0.0)) > 250);
        assert_eq!(value(&of_key, on_floor(-1.0, 0.0)), 0);
        assert_eq!(value(&of_key, on_floor(2.5, 0.0)), 0);
        let near = value(&of_sky, on_floor(0.7, 0.0));
        let far = value(&of_sky, on_floor(2.0, 0.0));
        assert!(near > 60 && far < near / 3, "{near} {far}");
    }

    #[test]
    fn floors_at_any_slope_have_right_angled_axes() {
        for normal in [DVec3::Y, DVec3::X, DVec3::new(1.0, 2.0, 3.0).normalize()] {
            let plane = Plane::new(normal, 0.0);
            let [a, b] = plane.axes;
            assert!(a.dot(b).abs() + a.dot(normal).abs() + b.dot(normal).abs() < 1e-12);
            assert!((a.length() - 1.0).abs() + (b.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn wild_coordinates_do_no_harm() {
        let (mut points, triangles) = block();
        points[3] = DVec3::new(1e300, -1e300, 1e6);
        points[5] = DVec3::splat(f64::MAX);
        let plane = Plane::new(DVec3::Y, 0.0);
        let [a, b] = shades(&points, &triangles, &plane, DVec3::new(-0.3, 0.9, 0.1).normalize(), DVec2::ZERO, 4.0, 1.0);
        assert!(a.length.is_finite() && b.length.is_finite() && a.corner.iter().all(|at| at.is_finite()));
    }
}
