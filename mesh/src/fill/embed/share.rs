//! How much of each element is filled.

use super::super::cuts::Lattice;
use super::fan::Fan;
use super::{CLOSE, LEAST};

impl Fan {
    /// The part of each element that is filled. What is inside a cube of the lattice, less the elements there that are not wide, fills
    /// its wide ones evenly.
    pub(super) fn filled(&self, is_wide: &[bool], lattice: &Lattice, inside: &[f64]) -> Option<Vec<f64>> {
        if !is_wide.contains(&true) {
            return None;
        }
        let cube = lattice.side * lattice.side * lattice.side;
        // The cubes in which an element lies, and the volume there, in cubes.
        let shares = |element: usize| {
            let of = self.of(element);
            of.iter().flat_map(move |simplex| {
                let corners = self.corners(simplex);
                let [a, b, c, d] = corners;
                let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0 / cube;
                let mean = 0.25 * (a + b + c + d);
                // Single tetrahedra may lie in several cubes.
                let pull = if of.len() == 1 { 0.4 } else { 0.0 };
                corners.map(|corner| (lattice.cube_at(mean.lerp(corner, pull)), 0.25 * volume))
            })
        };
        let [mut full, mut wide] = [vec![0.0; inside.len()], vec![0.0; inside.len()]];
        for (element, &is_wide) in is_wide.iter().enumerate() {
            let sum = if is_wide { &mut wide } else { &mut full };
            shares(element).for_each(|(cube, volume)| sum[cube] += volume);
        }
        let of_wide = |element: usize| {
            let (mut filled, mut all) = (0.0, 0.0);
            for (cube, volume) in shares(element) {
                filled += volume * ((inside[cube] - full[cube]) / wide[cube]).clamp(0.0, 1.0);
                all += volume;
            }
            [filled, all]
        };
        let parts: Vec<_> =
            is_wide.iter().enumerate().map(|(element, is_wide)| is_wide.then(|| of_wide(element))).collect();
        // What has no room in wide elements of its cube, or no element there, fills the others as well.
        let [filled, room] =
            parts.iter().flatten().fold([0.0; 2], |[filled, room], of| [filled + of[0], room + (of[1] - of[0])]);
        let thin = (0..inside.len()).filter(|&cube| wide[cube] > 0.0 || full[cube] == 0.0);
        let missing = thin.map(|cube| inside[cube] - full[cube]).sum::<f64>() - filled;
        let more = if missing > CLOSE { (missing / room).min(1.0) } else { 0.0 };
        let part = |[filled, all]: [f64; 2]| ((filled + more * (all - filled)) / all).clamp(LEAST, 1.0);
        Some(parts.into_iter().map(|of| of.map_or(1.0, part)).collect())
    }
}
