//! Triangles that close a surface.

use crate::Surface;
use crate::edges::{EdgeUse, net, pieces};
use glam::DVec3;

/// Triangles that close a surface: for each ring of edges that are not passed as often in one direction as in the other, those between
/// the points in which it turns, and those between the points of each of its straight lines, which hide nothing.
pub(super) fn caps(surface: &Surface) -> [Vec<[u32; 3]>; 2] {
    let mut open = Vec::new();
    for edge in EdgeUse::all(&surface.triangles).chunk_by(EdgeUse::same) {
        let (net, [low, high]) = (net(edge), [edge[0].low, edge[0].high]);
        let back = if net > 0 { [high, low] } else { [low, high] };
        open.extend(std::iter::repeat_n(back, net.unsigned_abs() as usize));
    }
    let (mut turning, mut straight) = (Vec::new(), Vec::new());
    for ring in rings(surface.points.len(), open) {
        let (ring, turns) = turns(&surface.points, ring);
        let corners: Vec<u32> = turns[1..].iter().map(|&turn| ring[turn]).collect();
        divide(&corners, &mut turning);
        turns.windows(2).for_each(|ends| divide(&ring[ends[0]..=ends[1]], &mut straight));
    }
    [turning, straight]
}

/// The rings that directed edges make between so many points. As many edges end in each point as start there.
fn rings(points: usize, mut open: Vec<[u32; 2]>) -> Vec<Vec<u32>> {
    open.sort_unstable();
    let mut next = vec![0; points + 1];
    open.iter().for_each(|edge| next[edge[0] as usize + 1] += 1);
    (0..points).for_each(|point| next[point + 1] += next[point]);
    let ends = next[1..].to_vec();
    let (mut rings, mut path, mut place_of) = (Vec::new(), Vec::new(), vec![usize::MAX; points]);
    for &[start, _] in &open {
        let mut at = start as usize;
        loop {
            // A path that meets itself has closed a ring, and goes on from there.
            if place_of[at] != usize::MAX {
                let ring = path.split_off(place_of[at]);
                ring.iter().for_each(|&point: &u32| place_of[point as usize] = usize::MAX);
                rings.push(ring);
            }
            if next[at] == ends[at] {
                break;
            }
            place_of[at] = path.len();
            path.push(at as u32);
            next[at] += 1;
            at = open[next[at] - 1][1] as usize;
        }
    }
    rings
}

/// A ring that starts and ends with the same point, a turn if it has one, and the places in it where straight lines start or end.
fn turns(points: &[DVec3], mut ring: Vec<u32>) -> (Vec<u32>, Vec<usize>) {
    /// How far, as a part of its distance from the start of a line, a point on the line may be beside it.
    const BESIDE: f64 = 1e-4;
    let is_straight = |[start, second, point]: [u32; 3]| {
        let [start, second, point] = [start, second, point].map(|point| points[point as usize]);
        let (along, way) = ((second - start).normalize_or_zero(), point - start);
        way.cross(along).length() <= BESIDE * way.dot(along)
    };
    let count = ring.len();
    let is_turn = |&at: &usize| !is_straight([-1, 0, 1].map(|by| ring[(at + count).wrapping_add_signed(by) % count]));
    let first = (0..count).find(is_turn).unwrap_or(0);
    ring.rotate_left(first);
    ring.push(ring[0]);
    let mut turns = vec![0];
    for at in 2..=count {
        let start = turns[turns.len() - 1];
        if at > start + 1 && !is_straight([start, start + 1, at].map(|at| ring[at])) {
            turns.push(at - 1);
        }
    }
    turns.push(count);
    (ring, turns)
}

/// Divides the polygon between points that follow each other into triangles. Halves of the points are cut off first, so that few
/// triangles are long: these would be near to many points that are asked for, and in the columns of many.
fn divide(points: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let [first, .., last] = *points
        && points.len() > 2
    {
        let half = points.len() / 2;
        triangles.push([first, points[half], last]);
        divide(&points[..=half], triangles);
        divide(&points[half..], triangles);
    }
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
