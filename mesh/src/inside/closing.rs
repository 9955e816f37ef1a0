//! Triangles that close a surface.

use crate::Surface;
use crate::edges::{EdgeUse, Sets, net, pieces};
use glam::DVec3;
use std::collections::HashMap;

/// Triangles that close a surface: for each group of edges that meet and are not passed as often in one direction as in
/// the other, a fan over the middle of their points. Returns the surface's points with the middles, and the triangles.
pub(super) fn caps(surface: &Surface) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let uses = EdgeUse::all(&surface.triangles);
    let open =
        || uses.chunk_by(EdgeUse::same).map(|edge| (edge[0].low, edge[0].high, net(edge))).filter(|edge| edge.2 != 0);
    let mut points = surface.points.clone();
    if open().next().is_none() {
        return (points, Vec::new());
    }
    let mut groups = Sets::new(points.len());
    open().for_each(|(low, high, _)| groups.join(low, high));
    let (group_of, count) = groups.numbered();
    let mut middles = vec![(DVec3::ZERO, 0u32); count];
    for (low, high, _) in open() {
        let (sum, number) = &mut middles[group_of[low as usize] as usize];
        *sum += points[low as usize] + points[high as usize];
        *number += 2;
    }
    let mut middle_of = vec![0; count];
    for (middle, &(sum, number)) in middle_of.iter_mut().zip(&middles) {
        if number > 0 {
            *middle = points.len() as u32;
            points.push(sum / f64::from(number));
        }
    }
    let mut caps = Vec::new();
    for (low, high, net) in open() {
        let middle = middle_of[group_of[low as usize] as usize];
        let cap = if net > 0 { [middle, high, low] } else { [middle, low, high] };
        caps.extend(std::iter::repeat_n(cap, net.unsigned_abs() as usize));
    }
    (points, caps)
}

/// The triangles of those pieces of a closed surface that are not flat. A line crosses a flat one twice at one place, or not at all.
pub(super) fn without_sheets(points: &[DVec3], all: &[[u32; 3]]) -> Vec<[u32; 3]> {
    /// Flat means so flat, as a part of the area.
    const FLAT: f64 = 1e-12;
    let (piece_of, count) = pieces(points.len(), all);
    let piece = |of: &[u32; 3]| piece_of[of[0] as usize] as usize;
    let area = |of: &[u32; 3]| {
        let [a, b, c] = of.map(|point| points[point as usize]);
        (b - a).cross(c - a)
    };
    // The area of the largest triangle of each piece, and that of all, whole and seen along the normal of the largest.
    let mut largest = vec![DVec3::ZERO; count];
    for (piece, area) in all.iter().map(|of| (piece(of), area(of))) {
        if area.length_squared() > largest[piece].length_squared() {
            largest[piece] = area;
        }
    }
    let mut areas = vec![[0.0; 2]; count];
    for (piece, area) in all.iter().map(|of| (piece(of), area(of))) {
        areas[piece][0] += area.length();
        areas[piece][1] += area.dot(largest[piece].normalize_or_zero()).abs();
    }
    let is_kept = |of: &&[u32; 3]| areas[piece(of)][1] < (1.0 - FLAT) * areas[piece(of)][0];
    all.iter().filter(is_kept).copied().collect()
}

/// Fans with one triangle in place of those whose open edges are a straight line, as the parts of an edge are that was divided, and in
/// place of three that are a triangle.
pub(super) fn simple(points: &[DVec3], caps: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut fans = straightened(points, caps);
    // What began in the midst of a line is now before what begins at its start.
    fans.reverse();
    fans = straightened(points, &fans);
    fans.sort_by_key(|fan| fan[0]);
    let whole = |fan: &[[u32; 3]]| match *fan {
        [[_, a, b], [_, c, d], [_, e, f]] if b == c && d == e && f == a => vec![[a, c, e]],
        [[_, a, b], [_, c, d], [_, e, f]] if b == e && f == c && d == a => vec![[a, e, c]],
        _ => fan.to_vec(),
    };
    fans.chunk_by(|one, other| one[0] == other[0]).flat_map(whole).collect()
}

/// Fans in which open edges that go on straight are one.
fn straightened(points: &[DVec3], caps: &[[u32; 3]]) -> Vec<[u32; 3]> {
    /// How far, as a part of its distance from the start of a line, a point on the line may be beside it.
    const BESIDE: f64 = 1e-4;
    let mut next = HashMap::new();
    for (at, &[middle, from, _]) in caps.iter().enumerate() {
        // A point from which several edges start ends lines.
        next.entry((middle, from)).and_modify(|next| *next = None).or_insert(Some(at));
    }
    let mut is_done = vec![false; caps.len()];
    let mut fewer = Vec::new();
    for (at, &[middle, from, mut to]) in caps.iter().enumerate() {
        if std::mem::replace(&mut is_done[at], true) {
            continue;
        }
        let start = points[from as usize];
        let along = (points[to as usize] - start).normalize_or_zero();
        while let Some(&Some(beyond)) = next.get(&(middle, to)) {
            let way = points[caps[beyond][2] as usize] - start;
            let is_straight = way.cross(along).length() <= BESIDE * way.dot(along);
            if !is_straight || std::mem::replace(&mut is_done[beyond], true) {
                break;
            }
            to = caps[beyond][2];
        }
        fewer.push([middle, from, to]);
    }
    fewer
}
