//! Bodies in balance with a load: slender ones by Newton's method, and any by the search of the simulation.

use glam::DVec3;
use localshape::sim::model::{ElasticModel, ForceModel, Report, Scratch};
use localshape::sim::{Body, Crew, Dimension, Equilibrium, Grip, Motion, Nodes, State, Surroundings, equilibrium};
use std::sync::Arc;

/// The forces of a model on a body that does not move, with the memory that goes with them.
pub(super) struct Forces {
    forces: Box<dyn ForceModel>,
    memory: Vec<f64>,
    next: Vec<f64>,
    scratch: Scratch,
    still: Vec<DVec3>,
}

impl Forces {
    pub(super) fn new(body: &Arc<Body>, model: &dyn ElasticModel, start: &[DVec3]) -> Self {
        let memory = model.start(body, start);
        let (next, still) = (memory.clone(), vec![DVec3::ZERO; body.len()]);
        Self { forces: model.prepare(body), memory, next, scratch: Scratch::default(), still }
    }

    /// The forces on nodes at these places (N).
    fn at(&mut self, position: &[DVec3]) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; position.len()];
        let at = Nodes { position, velocity: &self.still };
        self.forces.add_forces(at, &self.memory, &mut self.next, &mut self.scratch, &mut forces);
        forces
    }

    /// As [`Self::at`]; later evaluations start from these rotations.
    fn follow(&mut self, position: &[DVec3]) -> Vec<DVec3> {
        let forces = self.at(position);
        std::mem::swap(&mut self.memory, &mut self.next);
        forces
    }

    /// The elastic energy (J), of models that have one.
    pub(super) fn energy(&mut self, position: &[DVec3]) -> Option<f64> {
        self.follow(position);
        let Report { energy, .. } =
            self.forces.report(Nodes { position, velocity: &self.still }, &self.memory, &mut |_, _, _| ());
        energy
    }

    /// The forces of small displacements over their amplitude (N/m): the part that is linear in them. Of two differences, so that what is
    /// cubic cancels, too.
    pub(super) fn linear(&mut self, body: &Body, shape: &[DVec3], amplitude: f64) -> Vec<DVec3> {
        let mut by = |amplitude: f64| {
            let moved: Vec<_> = body.rest().iter().zip(shape).map(|(&rest, &shape)| rest + shape * amplitude).collect();
            self.at(&moved)
        };
        let [near, far] = [amplitude, 2.0 * amplitude].map(|amplitude| {
            let there_and_back = by(amplitude).into_iter().zip(by(-amplitude));
            there_and_back.map(|(there, back)| (there - back) / (2.0 * amplitude)).collect::<Vec<_>>()
        });
        near.into_iter().zip(far).map(|(near, far)| (near * 4.0 - far) / 3.0).collect()
    }
}

/// Relative to the extent of the body: displacements in differences of forces, and the last change of a balance.
const SMALL: f64 = 1e-6;
const LAST: f64 = 1e-11;
/// The most steps of Newton's method.
const MOST: usize = 60;

/// The places (m) at which a load (N) on each node balances the forces of a model, from a start nearby; `None` if there are none.
/// `held` tells which coordinates of a node do not change. Nodes of an element should have near numbers.
///
/// The matrix is that of central differences of the forces. Nodes that have no element in common with any third one are moved at once.
pub(crate) fn balance(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    load: &[DVec3],
    held: &[[bool; 3]],
    start: &[DVec3],
) -> Option<Vec<DVec3>> {
    let axes = if body.dimension() == Dimension::Plane { 2 } else { 3 };
    let (count, small) = (axes * body.len(), SMALL * body.extent());
    let reach = |nodes: &[u32]| nodes.iter().max().zip(nodes.iter().min()).map_or(0, |(high, low)| high - low);
    let reach = body.elements().iter().map(reach).max()? as usize;
    let (apart, width) = (2 * reach + 1, axes * (reach + 1));
    let is_held = |at: usize| held[at / axes][at % axes];
    let (mut forces, mut position) = (Forces::new(body, model, start), start.to_vec());
    let mut before = f64::INFINITY;
    for _ in 0..MOST {
        let here = forces.follow(&position);
        let off = |at: usize| if is_held(at) { 0.0 } else { (here[at / axes] + load[at / axes])[at % axes] };
        let mut right: Vec<_> = (0..count).map(off).collect();
        let mut rows = vec![vec![0.0; width]; count];
        for (first, axis) in (0..apart).flat_map(|first| (0..axes).map(move |axis| (first, axis))) {
            let [there, back] = [small, -small].map(|change| {
                let mut moved = position.clone();
                moved.iter_mut().skip(first).step_by(apart).for_each(|node| node[axis] += change);
                forces.at(&moved)
            });
            for node in (first..body.len()).step_by(apart) {
                let column = axes * node + axis;
                for row in column..count.min(axes * (node + reach + 1)) {
                    if !is_held(row) && !is_held(column) {
                        rows[row][row - column] = (back[row / axes] - there[row / axes])[row % axes] / (2.0 * small);
                    }
                }
                if is_held(column) {
                    rows[column][0] = 1.0;
                }
            }
        }
        solve_banded(&mut rows, &mut right);
        let changes = right.chunks_exact(axes);
        position
            .iter_mut()
            .zip(changes)
            .for_each(|(node, change)| (0..axes).for_each(|axis| node[axis] += change[axis]));
        let most = right.iter().fold(0.0, |most, change| if change.abs() <= most { most } else { change.abs() });
        // Round-off may keep changes of slender bodies from being as small.
        if most < LAST * body.extent() || most < SMALL * body.extent() && most > 0.5 * before {
            return Some(position);
        }
        before = most;
        if !most.is_finite() {
            return None;
        }
    }
    None
}

/// Nodes that do not move.
pub(crate) fn hold(nodes: &[usize]) -> Grip {
    let nodes = nodes.iter().map(|&node| node as u32).collect();
    Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still }
}

/// Bodies, each with its model.
pub(crate) type Parts<'a> = [(Arc<Body>, &'a dyn ElasticModel)];

/// Where bodies are at rest, from a start (m), by the search of the simulation: with contact, and with models that step themselves, in steps (s).
/// `None` if they do not come to rest.
pub(crate) fn rest_of(parts: &Parts<'_>, start: Vec<DVec3>, around: &Surroundings, step: f64) -> Option<Vec<DVec3>> {
    let found = equilibrium(parts, &State::at_rest(start), around, step, Crew::default());
    found.ok().map(|Equilibrium { position, .. }| position)
}

/// Solves a symmetric system by `L D Lᵀ`; `rows[i][d]` is its entry in row `i` and column `i − d`.
fn solve_banded(rows: &mut [Vec<f64>], right: &mut [f64]) {
    let width = rows.first().map_or(0, Vec::len);
    let last = |row: usize| row.min(width - 1);
    for row in 0..rows.len() {
        let (done, rest) = rows.split_at_mut(row);
        let here = &mut rest[0];
        // First L D, column by column, then L.
        for away in (1..=last(row)).rev() {
            let other = &done[row - away];
            let common = (last(row) - away).min(width - 1);
            let sum: f64 =
                here[away + 1..=away + common].iter().zip(&other[1..=common]).map(|(one, other)| one * other).sum();
            here[away] -= sum;
        }
        for away in 1..=last(row) {
            let scaled = here[away] / done[row - away][0];
            here[0] -= scaled * here[away];
            here[away] = scaled;
        }
        let sum: f64 = (1..=last(row)).map(|away| here[away] * right[row - away]).sum();
        right[row] -= sum;
    }
    right.iter_mut().zip(rows.iter()).for_each(|(right, row)| *right /= row[0]);
    for row in (0..rows.len()).rev() {
        for away in 1..=last(row) {
            right[row - away] -= rows[row][away] * right[row];
        }
    }
}
