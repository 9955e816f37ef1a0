//! The outline of a body that is not drawn: the edges at which it ends or turns away from the viewer.

use super::layout::steps::{CLOSE, TICK};
use super::page::{Path, point};
use super::plane::cut;
use glam::DVec2;
use std::collections::BTreeMap;

/// The lengths of dashes and gaps (px in the reference picture).
pub(super) const DASH: [f64; 2] = [CLOSE, TICK];
/// An edge whose sides are both covered at this distance lies inside the outline (px).
const BESIDE: f64 = 1.6;

/// The outline of triangles, and lines, between pixels of nodes, inside a rectangle, which is given by its four sides.
pub(super) fn outline(pixels: &[DVec2], triangles: &[[u32; 3]], lines: &[[u32; 2]], room: [f64; 4]) -> Path {
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
    let is_covered = covered(triangles.iter().map(|three| three.map(at)), room);
    let is_border = |&(_, [a, b]): &([u32; 2], [DVec2; 2])| {
        let aside = BESIDE * (b - a).perp().normalize_or_zero();
        !(is_covered(a.midpoint(b) + aside) && is_covered(a.midpoint(b) - aside))
    };
    // A long line would have countless dashes outside of the room.
    let seen = |edge: [u32; 2]| Some((edge, cut(edge.map(at), room)?));
    let outer = turning.filter_map(|(edge, _)| seen(edge)).filter(is_border);
    let (mut points, mut pairs) = (pixels.to_vec(), Vec::new());
    for (edge, ends) in outer.chain(lines.iter().filter_map(|&line| seen(line))) {
        let added = points.len() as u32;
        pairs.push(if ends == edge.map(at) { edge } else { [added, added + 1] });
        points.extend(ends);
    }
    Path::joined(&pairs, &points.into_iter().map(point).collect::<Vec<_>>())
}

/// Whether triangles cover a place in a rectangle, to the nearest pixel.
fn covered(triangles: impl Iterator<Item = [DVec2; 3]>, sides: [f64; 4]) -> impl Fn(DVec2) -> bool {
    let [left, top, right, bottom] = sides;
    let corner = DVec2::new(left, top);
    let [columns, rows] = [right - left, bottom - top].map(|length| length.ceil() as usize);
    let first = |at: f64, all: usize| (at - 0.5).ceil().clamp(0.0, all as f64) as usize;
    let mut mask = vec![false; rows * columns];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|at| at - corner);
        for row in first(a.min(b).min(c).y, rows)..first(a.max(b).max(c).y, rows) {
            let y = row as f64 + 0.5;
            let crossed = [[a, b], [b, c], [c, a]].into_iter().filter(|[from, to]| (from.y > y) != (to.y > y));
            let crossed = crossed.map(|[from, to]| from.x + (to.x - from.x) * (y - from.y) / (to.y - from.y));
            let [low, high] = crossed.fold([f64::INFINITY, 0.0], |[low, high], x| [low.min(x), high.max(x)]);
            let [low, high] = [low, high].map(|x| row * columns + first(x, columns));
            mask.get_mut(low..high).into_iter().for_each(|part| part.fill(true));
        }
    }
    move |at| {
        let [column, row] = (at - corner).to_array().map(|length| length as usize);
        at.cmpge(corner).all()
            && column < columns
            && mask.get(row * columns + column).is_some_and(|&is_covered| is_covered)
    }
}

#[cfg(test)]
#[path = "../../tests/inside/ghost.rs"]
mod tests;
