//! Bodies in balance with a load: by Newton's method, or by the steps of a model that steps itself.

use glam::DVec3;
use localshape::sim::model::{ElasticModel, ForceModel, Report, Scratch};
use localshape::sim::{Body, Dimension, Nodes};
use std::sync::Arc;

/// The forces of a model on a body that does not move, with the memory that goes with them.
pub(crate) struct Forces {
    forces: Box<dyn ForceModel>,
    memory: Vec<f64>,
    next: Vec<f64>,
    scratch: Scratch,
    still: Vec<DVec3>,
}

impl Forces {
    pub(crate) fn new(body: &Arc<Body>, model: &dyn ElasticModel, start: &[DVec3]) -> Self {
        let memory = model.start(body, start);
        let (next, still) = (memory.clone(), vec![DVec3::ZERO; body.len()]);
        Self { forces: model.prepare(body), memory, next, scratch: Scratch::default(), still }
    }

    /// The forces on nodes at these places (N).
    pub(crate) fn at(&mut self, position: &[DVec3]) -> Vec<DVec3> {
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

/// The places (m) at which a model that steps itself is at rest under a load (N) on each node, in steps (s), from a start nearby that is not
/// the rest shape; `None` if it does not come to rest, or exerts forces instead.
///
/// Velocities are damped by twice the frequency of the slowest mode, which Rayleigh's quotient of the start gives. At rest there are none.
pub(super) fn settle(
    body: &Arc<Body>,
    model: &dyn ElasticModel,
    load: &[DVec3],
    held: &[[bool; 3]],
    start: &[DVec3],
    step: f64,
) -> Option<Vec<DVec3>> {
    /// The last change in the time in which damping takes a velocity to `1/e`, relative to the greatest displacement.
    const LAST: f64 = 1e-5;
    let projection = model.projection(body)?;
    let shift: Vec<_> = start.iter().zip(body.rest()).map(|(start, rest)| *start - *rest).collect();
    let work: f64 = shift.iter().zip(load).map(|(shift, load)| shift.dot(*load)).sum();
    let inertia: f64 = shift.iter().zip(body.mass()).map(|(shift, mass)| mass * shift.length_squared()).sum();
    let rate = 2.0 * libm::sqrt(work / inertia);
    let far = shift.iter().map(|shift| shift.length()).fold(0.0, f64::max);
    let light: Vec<_> =
        body.mass().iter().zip(held).map(|(mass, held)| if held[0] { 0.0 } else { 1.0 / mass }).collect();
    let (mut position, mut velocity) = (start.to_vec(), vec![DVec3::ZERO; body.len()]);
    let mut memory = model.start(body, start);
    let mut next = memory.clone();
    for _ in 0..MOST {
        let before = position.clone();
        for _ in 0..libm::ceil(1.0 / (rate * step)) as u64 {
            let from = position.clone();
            for (node, velocity) in velocity.iter_mut().enumerate() {
                *velocity = *velocity / (1.0 + rate * step) + load[node] * (light[node] * step);
                position[node] += *velocity * step;
            }
            projection.project(&mut position, &light, step, &memory, &mut next);
            std::mem::swap(&mut memory, &mut next);
            velocity
                .iter_mut()
                .zip(&position)
                .zip(&from)
                .for_each(|((velocity, to), from)| *velocity = (*to - *from) / step);
        }
        let most = position.iter().zip(&before).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
        if most < LAST * far {
            return Some(position);
        }
    }
    None
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
