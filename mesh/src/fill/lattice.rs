//! The lattice of cubes about a surface, and how large it may be.

use super::{Fill, FillError};
use crate::{Measures, Surface};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Points nearer than this to a plane of the lattice, in units of its side, are moved onto it. Single precision and typed
/// decimals would otherwise leave layers of cells with hardly any filling.
const SNAP: f64 = 4e-6;

/// Lengths of surfaces, and sides of elements up to them. Fourth powers of others and of their parts are too large or too small for
/// numbers.
const SIZES: RangeInclusive<f64> = 1e-50..=1e50;

/// The number of cubes along each axis about a surface.
fn counts(measures: &Measures, side: f64) -> [f64; 3] {
    (measures.high - measures.low).to_array().map(|extent| (extent / side - SNAP).ceil().max(1.0))
}

/// Refuses a surface without triangles, and a side with which far more elements than allowed, or very many cubes outside, would be
/// needed.
pub(super) fn check(surface: &Surface, fill: Fill, side: f64, most: usize) -> Result<(), FillError> {
    let measures = surface.measures();
    if surface.triangles.is_empty() {
        return Err(FillError::new("has no face with an area", "use a file with faces"));
    }
    if !(side > 0.0 && side.is_finite()) {
        return Err(FillError::new(format!("cannot be filled with elements of side {side}"), "use a positive side"));
    }
    let longest = (measures.high - measures.low).max_element();
    if !(SIZES.contains(&longest) && side <= *SIZES.end()) {
        let [least, most] = [SIZES.start(), SIZES.end()];
        let message =
            format!("is {longest:e} long; expected {least:e} to {most:e}, and elements of no larger side than that");
        return Err(FillError::new(message, "use another unit of length"));
    }
    let counts = counts(&measures, side);
    // The elements in a cube of the lattice.
    let each = match fill {
        Fill::Cubes { .. } | Fill::Polyhedra { .. } => 1.0,
        Fill::Graded { .. } => 1.0 / JOINED as f64,
        Fill::Tetrahedra { .. } => 12.0,
    };
    // Only a closed surface tells its volume. Walls thinner than elements count with both sides.
    let slack = if measures.closed { 2.0 } else { 4.0 };
    // Each place is visited, whether or not something is in it.
    let rows = counts[1] * counts[2];
    let places = rows * counts[0];
    let needed = each * estimate(&measures, side).min(places);
    let is_sane = rows <= 16.0 * most as f64 + 65536.0 && places <= 1024.0 * most as f64 + 1e8 && counts[0] < 1e6;
    if !(needed <= slack * most as f64 && is_sane) {
        // For all it is known yet, no cubes may be joined at a larger side.
        return Err(refused(&measures, side, needed.max(rows / 16.0), most, "about ", each.max(1.0)));
    }
    if let Fill::Tetrahedra { .. } | Fill::Polyhedra { .. } = fill {
        // All points of the lattice are listed, with a layer of cubes outside.
        let boxed: f64 = counts.into_iter().map(|count| count + 2.0).product();
        if boxed > 8.0 * most as f64 + 1e6 {
            return Err(too_many(&measures, side, boxed / 8.0, most, "about "));
        }
        // Cubes are numbered by 32 bits.
        if boxed > f64::from(i32::MAX) {
            let message = format!("has a box of {boxed:.0e} cubes of side {side}, and at most 2e9 can be cut");
            return Err(FillError::new(message, "use a larger side, or fill it with cubes"));
        }
    }
    Ok(())
}

/// About how many cubes are joined on average if they are graded.
pub(super) const JOINED: usize = 4;

/// Cubes of a lattice about a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// The lowest corner.
    pub(super) origin: DVec3,
    /// The side of a cube.
    pub(super) side: f64,
    /// The number of cubes along each axis.
    pub(super) counts: [usize; 3],
}

impl Lattice {
    /// The lowest corner of a lattice about the middle of a surface's box.
    pub(super) fn origin(measures: &Measures, side: f64) -> DVec3 {
        let size = DVec3::from_array(counts(measures, side));
        0.5 * (measures.low + measures.high) - 0.5 * side * size
    }

    /// The cubes about a surface that is checked, and the surface in units of them from their lowest corner. Points that are almost on a
    /// plane of the lattice are on it in both. The lattice is about the middle of the surface, or has a given corner.
    ///
    /// # Errors
    /// If its triangles lie over each other by thousands.
    pub(super) fn about(
        surface: &mut Surface,
        side: f64,
        corner: Option<DVec3>,
        most: usize,
    ) -> Result<(Self, Surface), FillError> {
        let measures = surface.measures();
        let (mut origin, mut size) = (Self::origin(&measures, side), DVec3::from_array(counts(&measures, side)));
        if let Some(corner) = corner {
            let first = ((measures.low - corner) / side + SNAP).floor();
            size = (((measures.high - corner) / side - SNAP).ceil() - first).max(DVec3::ONE);
            origin = corner + side * first;
        }
        // Triangles that lie over each other by thousands are no surface.
        let overlaps: f64 = surface.triangles.iter().map(|&triangle| pieces(surface.corners(triangle), side)).sum();
        if overlaps > 64.0 * most as f64 + 16.0 * surface.triangles.len() as f64 + 1e6 {
            let message = format!(
                "has {} triangles that lie over each other: they reach into elements of side {side} some {overlaps:.0} times",
                surface.triangles.len()
            );
            return Err(FillError::new(message, format!("use a larger side, or more than {most} elements")));
        }
        let counts = size.to_array().map(|count| count as usize);
        let lattice = Self { origin, side, counts };
        let mut points = Vec::with_capacity(surface.points.len());
        for point in &mut surface.points {
            let at = (*point - lattice.origin) / side;
            let near = at.round();
            let is_near = (at - near).abs().cmple(DVec3::splat(SNAP));
            *point = DVec3::select(is_near, lattice.place(near), *point);
            points.push(DVec3::select(is_near, near, at).clamp(DVec3::ZERO, size));
        }
        Ok((lattice, Surface { points, triangles: surface.triangles.clone(), ..Surface::default() }))
    }

    /// The place of a point in units of the lattice.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        self.origin + self.side * at
    }
}

/// About how many cubes hold a part of the inside.
fn estimate(measures: &Measures, side: f64) -> f64 {
    let (volume, area) = (measures.volume.abs() / side / side / side, measures.area / side / side);
    // A plane in any direction meets up to 1.7 cubes for each square, and half of each is counted with the volume.
    volume + 0.75 * area + 1.0
}

/// About how many cubes a triangle reaches into, or more.
fn pieces([a, b, c]: [DVec3; 3], side: f64) -> f64 {
    let [x, y, z] = ((a.max(b).max(c) - a.min(b).min(c)) / side).to_array();
    1.0 + x + y + z + 0.5 * (x * y + y * z + z * x)
}

/// About how many cubes hold a part of the inside, or more: all of the box, if less is not certain.
fn boxed(measures: &Measures, side: f64) -> f64 {
    let counts = (measures.high - measures.low).max(DVec3::splat(f64::MIN_POSITIVE)) / side;
    let whole = (counts - SNAP).ceil().max(DVec3::ONE);
    // What fills its box needs as many more as the box is rounded up to whole cubes.
    whole.element_product().min(estimate(measures, side) * (whole / counts).element_product().min(1e9))
}

/// The error for a fill that would need so many elements.
pub(super) fn too_many(measures: &Measures, side: f64, needed: f64, most: usize, about: &str) -> FillError {
    // The estimate, scaled to what is known, tells how the number falls with the side.
    refused(measures, side, needed, most, about, needed / boxed(measures, side))
}

/// The error for a fill that would need so many elements, with so many for each cube at other sides.
fn refused(measures: &Measures, side: f64, needed: f64, most: usize, about: &str, each: f64) -> FillError {
    let start = side.max(1e-9 * (measures.high - measures.low).max_element());
    let tries = std::iter::successors(Some(start), |side| Some(1.02 * side)).skip(1).take(2000).map(rounded_up);
    let mut fitting = tries.filter(|&side| each * boxed(measures, side) <= 0.95 * most as f64);
    let fitting = fitting.next();
    let remedy = match fitting {
        Some(side) => format!("use a side of {side} or more, or allow more elements"),
        None => "allow more elements".to_owned(),
    };
    let side = format!("{side:.3e}").parse().unwrap_or(side);
    let [needed, most] = [needed, most as f64].map(in_words);
    let message = format!("needs {about}{needed} elements of side {side}, and at most {most} are allowed");
    FillError { fitting: Some(fitting.unwrap_or(f64::INFINITY)), ..FillError::new(message, remedy) }
}

/// A number of elements.
fn in_words(number: f64) -> String {
    match number {
        ..1e5 => format!("{number:.0}"),
        ..1e7 => format!("{:.1} million", number / 1e6),
        ..1e9 => format!("{:.0} million", number / 1e6),
        _ => format!("{number:.0e}"),
    }
}

/// A number with two digits that is not smaller.
fn rounded_up(number: f64) -> f64 {
    let text = format!("{number:.1e}");
    let rounded = text.parse().unwrap_or(number);
    if rounded >= number {
        return rounded;
    }
    let digit = text.split_once('e').and_then(|(_, exponent)| format!("0.1e{exponent}").parse::<f64>().ok());
    // Written and read again, lest 0.1 + 0.2 show its error.
    digit.and_then(|digit| format!("{:.1e}", rounded + digit).parse().ok()).unwrap_or(number)
}

/// The cube of each place, in units of the lattice.
pub(super) type Cell = [u32; 3];

impl Lattice {
    /// A number for each cube, with x fastest, then y, then z.
    pub(super) fn key(&self, [x, y, z]: Cell) -> u64 {
        (u64::from(z) * self.counts[1] as u64 + u64::from(y)) * self.counts[0] as u64 + u64::from(x)
    }

    /// The cube with a number.
    pub(super) fn cell(&self, key: u64) -> Cell {
        let [x, y] = [self.counts[0] as u64, self.counts[1] as u64];
        [(key % x) as u32, (key / x % y) as u32, (key / x / y) as u32]
    }
}

/// The lowest corner of a cell.
pub(super) fn corner(cell: Cell) -> DVec3 {
    DVec3::from_array(cell.map(f64::from))
}

/// The corners of a cube, with x fastest, then y, then z.
pub(super) const CORNERS: [Cell; 8] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

/// A cell with a part of the inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Full {
    pub(super) cell: u64,
    /// The part of it that is inside.
    pub(super) filled: f64,
}
