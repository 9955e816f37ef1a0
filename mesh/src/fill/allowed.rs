//! How many elements may fill a surface.

use super::ends::Ends;
use super::lattice::{SNAP, counts};
use super::{Fill, FillError};
use crate::{Measures, Surface};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Lengths of surfaces, and sides of elements up to them. Fourth powers of others and of their parts are too large or too small for
/// numbers.
const SIZES: RangeInclusive<f64> = 1e-50..=1e50;

/// About how many cubes are joined on average if they are graded.
pub(super) const JOINED: usize = 4;

/// Tetrahedra of a part thinner than this, in sides, are mostly shorter.
const LEAST: f64 = 0.6;

/// How many elements are allowed for the parts of a surface, and what tells how many they need.
pub(super) struct Allowed {
    pub(super) most: usize,
    pub(super) parts: Vec<Ends>,
    fill: Fill,
}

/// Refuses a side with which far more elements than allowed, or very many cubes outside, would be needed for a surface, stretched as it
/// is filled.
pub(super) fn check(measures: &Measures, fill: Fill, allowed: &Allowed) -> Result<(), FillError> {
    let (side, most) = (fill.side(), allowed.most);
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
    let counts = counts(measures, side);
    // Only a closed surface tells its volume. Walls thinner than elements count with both sides.
    let slack = if measures.closed { 2.0 } else { 4.0 };
    // Each place is visited, whether or not something is in it.
    let rows = counts[1] * counts[2];
    let places = rows * counts[0];
    let needed = fill.each() * estimate(measures, side).min(places);
    let is_sane = rows <= 16.0 * most as f64 + 65536.0 && places <= 1024.0 * most as f64 + 1e8 && counts[0] < 1e6;
    if !(needed <= slack * most as f64 && is_sane) {
        let visited = (rows / 16.0).max(places / 1024.0).max(1e-6 * counts[0] * most as f64);
        let times = (visited / allowed.needed(side)).max(1.0);
        return Err(allowed.refused(side, needed.max(visited), "about ", times));
    }
    if fill.is_cut() {
        // All points of the lattice are listed, with a layer of cubes outside.
        let listed: f64 = counts.into_iter().map(|count| count + 2.0).product();
        if listed > 8.0 * most as f64 + 1e6 {
            return Err(allowed.too_many(side, listed / 8.0, "about "));
        }
        // Cubes are numbered by 32 bits.
        if listed > f64::from(i32::MAX) {
            let message = format!("has a box of {listed:.0e} cubes of side {side}, and at most 2e9 can be cut");
            return Err(FillError::new(message, "use a larger side, or fill it with cubes"));
        }
    }
    Ok(())
}

/// About how many cubes hold a part of the inside.
fn estimate(measures: &Measures, side: f64) -> f64 {
    let (volume, area) = (measures.volume.abs() / side / side / side, measures.area / side / side);
    // A plane in any direction meets up to 1.7 cubes for each square, and half of each is counted with the volume.
    volume + 0.75 * area + 1.0
}

/// About how many cubes hold a part of the inside, or more: all of the box, if less is not certain.
fn boxed(measures: &Measures, side: f64) -> f64 {
    let counts = (measures.high - measures.low).max(DVec3::splat(f64::MIN_POSITIVE)) / side;
    let whole = (counts - SNAP).ceil().max(DVec3::ONE);
    // What fills its box needs as many more as the box is rounded up to whole cubes.
    whole.element_product().min(estimate(measures, side) * (whole / counts).element_product().min(1e9))
}

impl Allowed {
    pub(super) fn new(parts: &[Surface], fill: Fill, most: usize) -> Self {
        Self { most, parts: parts.iter().map(|part| Ends::new(part, fill)).collect(), fill }
    }

    /// About how many elements of a side (m) are needed, or more. For all it is known, no cubes may be joined.
    fn needed(&self, side: f64) -> f64 {
        let of = |part: &Ends| match self.fill {
            // In a part so thin they are tried with half of the side, and all of a cube stand out of it.
            Fill::Tetrahedra { .. } if part.size().min_element() < LEAST * side => 192.0 * boxed(&part.measures, side),
            Fill::Tetrahedra { .. } => {
                let measures = part.stretched(side);
                // Four stand about each face between two cubes, and about each one at the surface.
                12.0 * boxed(&measures, side) + 2.0 * measures.area / side / side
            }
            _ => boxed(&part.stretched(side), side),
        };
        self.parts.iter().map(of).sum()
    }

    /// Refuses parts that together need far more elements.
    pub(super) fn check(&self) -> Result<(), FillError> {
        let needed = self.needed(self.fill.side());
        if needed > 4.0 * JOINED as f64 * self.most as f64 {
            return Err(self.refused(self.fill.side(), needed, "about ", 1.0));
        }
        Ok(())
    }

    /// The error for a fill that would need so many elements.
    pub(super) fn too_many(&self, side: f64, needed: f64, about: &str) -> FillError {
        // The estimate, scaled to what is known, tells how the number falls with the side.
        self.refused(side, needed, about, needed / self.needed(side))
    }

    /// The error for a fill that would need so many elements, and so many times as many as are thought at other sides.
    fn refused(&self, side: f64, needed: f64, about: &str, times: f64) -> FillError {
        let longest = self.parts.iter().map(|part| part.size().max_element()).fold(0.0, f64::max);
        let tries = std::iter::successors(Some(side.max(1e-9 * longest)), |side| Some(1.02 * side));
        let most = self.most as f64;
        let fits = |&side: &f64| times * self.needed(side) <= 0.95 * most;
        let fitting = tries.skip(1).take(2000).map(rounded_up).find(fits);
        let remedy = match fitting {
            Some(side) => format!("use a side of {side} or more, or allow more elements"),
            None => "allow more elements".to_owned(),
        };
        let side = format!("{side:.3e}").parse().unwrap_or(side);
        let [needed, most] = [needed, most].map(in_words);
        let message = format!("needs {about}{needed} elements of side {side}, and at most {most} are allowed");
        FillError { fitting: Some(fitting.unwrap_or(f64::INFINITY)), ..FillError::new(message, remedy) }
    }
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
