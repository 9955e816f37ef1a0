//! The outline of a body that is not drawn: the edges at which it ends or turns away from the viewer.

use super::layout::steps::{CLOSE, TICK};
use super::page::{Path, point};
use super::plane::is_inside;
use glam::DVec2;
use std::collections::BTreeMap;

/// The lengths of dashes and gaps (px in the reference picture).
pub(super) const DASH: [f64; 2] = [CLOSE, TICK];
/// An edge whose sides are both covered at this distance lies inside the outline (px).
const BESIDE: f64 = 1.6;

/// The outline of triangles, and lines, between pixels of nodes.
pub(super) fn outline(pixels: &[DVec2], triangles: &[[u32; 3]], lines: &[[u32; 2]]) -> Path {
    let at = |node: u32| pixels[node as usize];
    // For each edge, the number of triangles that face the viewer, and that face away.
    let mut edges: BTreeMap<[u32; 2], [u32; 2]> = BTreeMap::new();
    for &[a, b, c] in triangles {
        let faces_away = usize::from((at(b) - at(a)).perp_dot(at(c) - at(a)) > 0.0);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([from.min(to), from.max(to)]).or_default()[faces_away] += 1;
        }
    }
    let turning = edges.into_iter().filter(|(_, [towards, away])| towards + away == 1 || towards * away > 0);
    let covered = |at_pixel: DVec2| triangles.iter().any(|three| is_inside(&three.map(at), at_pixel));
    let is_border = |&[a, b]: &[u32; 2]| {
        let aside = BESIDE * (at(b) - at(a)).perp().normalize_or_zero();
        let middle = at(a).midpoint(at(b));
        !(covered(middle + aside) && covered(middle - aside))
    };
    let outer: Vec<_> = turning.map(|(edge, _)| edge).filter(is_border).chain(lines.iter().copied()).collect();
    Path::joined(&outer, &pixels.iter().copied().map(point).collect::<Vec<_>>())
}

#[cfg(test)]
#[path = "../../tests/inside/ghost.rs"]
mod tests;
