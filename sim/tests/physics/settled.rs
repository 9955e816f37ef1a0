//! Balance of loads and elastic forces, found apart from the library.

use super::support::Remembering;
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::{Body, State};
use std::sync::Arc;

/// The positions (m) at which a load (N) on each node balances the forces of a model, by Newton's method from a start nearby. `held` tells
/// which coordinates of a node do not change. Nodes of an element have near numbers.
pub(crate) fn settled(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    load: &[DVec3],
    held: &[[bool; 3]],
    start: &[DVec3],
) -> Vec<DVec3> {
    /// Relative to the extent of the body: of the differences, and of the last change.
    const SMALL: [f64; 2] = [1e-6, 1e-11];
    let mut worker = Remembering::new(body, model, &State::at_rest(start.to_vec()));
    let (count, extent) = (3 * body.len(), body.extent());
    let reach = |nodes: &[u32]| nodes.iter().max().expect("nodes") - nodes.iter().min().expect("nodes");
    let reach = body.elements().iter().map(reach).max().expect("elements") as usize;
    let is_held = |at: usize| held[at / 3][at % 3];
    let mut position = start.to_vec();
    for _ in 0..60 {
        let forces = worker.follow(&State::at_rest(position.clone()));
        let mut right: Vec<_> =
            (0..count).map(|at| if is_held(at) { 0.0 } else { (forces[at / 3] + load[at / 3])[at % 3] }).collect();
        // Nodes that are so far apart have no element in common with any third one.
        let (apart, width) = (2 * reach + 1, 3 * reach + 3);
        let mut rows = vec![vec![0.0; width]; count];
        for (first, axis) in (0..apart).flat_map(|first| (0..3).map(move |axis| (first, axis))) {
            let [there, back] = [SMALL[0] * extent, -SMALL[0] * extent].map(|change| {
                let mut moved = State::at_rest(position.clone());
                moved.position.iter_mut().skip(first).step_by(apart).for_each(|node| node[axis] += change);
                worker.evaluate(&moved).0
            });
            for node in (first..body.len()).step_by(apart) {
                let column = 3 * node + axis;
                for row in column..count.min(3 * (node + reach + 1)) {
                    let slope = (back[row / 3] - there[row / 3])[row % 3] / (2.0 * SMALL[0] * extent);
                    rows[row][row - column] = if is_held(row) || is_held(column) { 0.0 } else { slope };
                }
                rows[column][0] = if is_held(column) { 1.0 } else { rows[column][0] };
            }
        }
        solve_banded(&mut rows, &mut right);
        position.iter_mut().zip(right.chunks_exact(3)).for_each(|(node, change)| *node += DVec3::from_slice(change));
        if right.iter().all(|change| change.abs() < SMALL[1] * extent) {
            return position;
        }
    }
    panic!("no balance")
}

/// Solves a symmetric system; `rows[i][d]` is its entry in row `i` and column `i − d`. By `L D Lᵀ`.
fn solve_banded(rows: &mut [Vec<f64>], right: &mut [f64]) {
    let (count, width) = (rows.len(), rows[0].len());
    for row in 0..count {
        let (done, rest) = rows.split_at_mut(row);
        let here = &mut rest[0];
        let first = row.saturating_sub(width - 1);
        // First L D, column by column, then L.
        for column in first..row {
            let from = first.max((column + 1).saturating_sub(width));
            let sum: f64 = (from..column).map(|k| here[row - k] * done[column][column - k]).sum();
            here[row - column] -= sum;
        }
        for column in first..row {
            let scaled = here[row - column] / done[column][0];
            here[0] -= scaled * here[row - column];
            here[row - column] = scaled;
        }
        let sum: f64 = (first..row).map(|k| here[row - k] * right[k]).sum();
        right[row] -= sum;
    }
    right.iter_mut().zip(rows.iter()).for_each(|(right, row)| *right /= row[0]);
    for row in (0..count).rev() {
        for column in row.saturating_sub(width - 1)..row {
            right[column] -= rows[row][row - column] * right[row];
        }
    }
}
