//! Points nearer to each other than a distance made one, and the distance that a mesh needs.

use super::edges::EdgeUse;
use super::{Surface, Volume};
use glam::DVec3;
use localshape_sim::geometry::bounds;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;

/// For each point the one that it becomes: the first of `which` that is not nearer than a distance to one before it and is nearer to
/// this, else itself. No point moves farther than the distance.
pub(crate) fn joined(points: &[DVec3], mut which: Vec<u32>, distance: f64) -> Vec<u32> {
    /// So often are points divided along each axis. Those that are still together, as only made for that purpose, take longer.
    const ROUNDS: usize = 12;
    let mut first: Vec<u32> = (0..points.len() as u32).collect();
    let mut keyed: Vec<(f64, u32)> = Vec::new();
    // Points are divided where there is a gap along an axis, until no axis has one: the points, how often they were divided, and how
    // many axes in turn had no gap.
    let mut runs: Vec<(Range<usize>, usize, usize)> = vec![(0..which.len(), 0, 0)];
    while let Some((range, round, whole)) = runs.pop() {
        let run = &mut which[range.clone()];
        let Some(&lowest) = run.iter().min() else { continue };
        if run.iter().all(|&point| points[point as usize].distance(points[lowest as usize]) <= distance) {
            run.iter().for_each(|&point| first[point as usize] = lowest);
            continue;
        }
        if whole == 3 || round == ROUNDS {
            join_in_grid(points, run, distance, &mut first);
            continue;
        }
        keyed.clear();
        keyed.extend(run.iter().map(|&point| (points[point as usize][round % 3], point)));
        keyed.par_sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        run.iter_mut().zip(&keyed).for_each(|(point, keyed)| *point = keyed.1);
        let mut start = range.start;
        for part in keyed.chunk_by(|one, other| other.0 - one.0 <= distance) {
            let whole = if part.len() == range.len() { whole + 1 } else { 0 };
            runs.push((start..start + part.len(), round + 1, whole));
            start += part.len();
        }
    }
    first
}

/// Joins points one after the other. Of those that stay, few are in one cell of a grid with the distance as its side.
fn join_in_grid(points: &[DVec3], run: &mut [u32], distance: f64, first: &mut [u32]) {
    run.sort_unstable();
    let low = run.iter().fold(DVec3::INFINITY, |low, &point| low.min(points[point as usize]));
    let mut kept: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for &point in &*run {
        let at = points[point as usize];
        let cell = ((at - low) / distance).to_array().map(|number| number as i64);
        let around = (0..27).filter_map(|near| {
            let [x, y, z] = [near % 3, near / 3 % 3, near / 9];
            kept.get(&[cell[0].saturating_add(x - 1), cell[1].saturating_add(y - 1), cell[2].saturating_add(z - 1)])
        });
        let near = around.flatten().copied().filter(|&other| at.distance(points[other as usize]) <= distance).min();
        match near {
            Some(other) => first[point as usize] = other,
            None => kept.entry(cell).or_default().push(point),
        }
    }
}

/// The least power of ten, from a part in 10¹⁰ to one in 10⁴ of the extent of some points, with which they are joined so that it helps
/// and no cell loses a corner.
fn least<'c>(
    points: &[DVec3],
    cells: impl Iterator<Item = &'c [u32]> + Clone,
    helps: impl Fn(&[u32]) -> bool,
) -> Option<f64> {
    let (low, high) = bounds(points);
    let size = libm::floor(libm::log10((high - low).max_element())) as i32;
    // Read as typed, so that the nearest number is taken.
    let mut distances = (size - 10..=size - 4).filter_map(|exponent| format!("1e{exponent}").parse().ok());
    distances.find(|&distance| {
        let first = joined(points, (0..points.len() as u32).collect(), distance);
        let keeps = |cell: &[u32]| {
            let mut corners: Vec<u32> = cell.iter().map(|&corner| first[corner as usize]).collect();
            corners.sort_unstable();
            corners.windows(2).all(|pair| pair[0] != pair[1])
        };
        helps(&first) && cells.clone().all(keeps)
    })
}

impl Surface {
    /// The least power of ten, in the unit of the points, with which [`Cells::weld`](crate::Cells::weld) would close half of the open
    /// edges or more, if each triangle keeps its corners.
    pub fn closing_weld(&self) -> Option<f64> {
        let uses = EdgeUse::all(&self.triangles);
        let open: Vec<_> = uses.chunk_by(EdgeUse::same).filter(|edge| edge.len() == 1).flatten().collect();
        let helps = |first: &[u32]| {
            let ends = |edge: &&EdgeUse| [edge.low, edge.high].map(|end| first[end as usize]);
            let mut edges: Vec<_> =
                open.iter().map(ends).map(|[one, other]| [one.min(other), one.max(other)]).collect();
            edges.sort_unstable();
            let left = edges.chunk_by(|one, other| one == other).filter(|edge| edge.len() != 2).flatten().count();
            2 * left <= open.len()
        };
        let triangles = self.triangles.iter().map(|triangle| &triangle[..]);
        if open.is_empty() { None } else { least(&self.points, triangles, helps) }
    }
}

impl Volume {
    /// The least power of ten, in the unit of the points, with which [`Cells::weld`](crate::Cells::weld) would join points of these
    /// cells, if each cell keeps its corners.
    pub fn joining_weld(&self) -> Option<f64> {
        least(&self.points, self.cells.iter(), |first| (0..).zip(first).any(|(point, &first)| point != first))
    }
}
