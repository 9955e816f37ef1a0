//! Groups of neighbouring nodes that move as rigid bodies.
//!
//! Along forces alone, a node learns in each iteration of its neighbours only, and a slender body bends after thousands of them. The groups are
//! a coarse body with some hundred unknowns, whose balance is solved exactly, and which bends at once.
//!
//! V. E. Bulgakov, G. Kuhn, High-performance multilevel iterative aggregation solver for large finite-element structural analysis problems,
//! International Journal for Numerical Methods in Engineering 38, 3529 (1995).

use super::super::body::Body;
use super::super::hull::bounds;
use super::super::model::ElasticModel;
use super::Forces;
use glam::DVec3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Nodes of a group, and the most groups.
const NODES: usize = 64;
const GROUPS: usize = 64;
/// Displacements and rotations of a group.
const MODES: usize = 6;
/// The way of nodes for which forces are compared, as a share of the longest way in an iteration.
const TINY: f64 = 1e-7;
/// What is left of a stiffness that is nothing but error, as a share of it.
const NOTHING: f64 = 1e-7;

/// The groups of all bodies.
pub(super) struct Groups {
    of_node: Vec<usize>,
    /// Groups that share no neighbour have one colour: the forces of all of one colour are found at once.
    colours: Vec<Vec<usize>>,
    /// The groups that share elements with each, and itself.
    near: Vec<BTreeSet<usize>>,
}

impl Groups {
    pub(super) fn new(bodies: &[(Arc<Body>, &dyn ElasticModel)]) -> Self {
        let all: usize = bodies.iter().map(|(body, _)| body.len()).sum();
        let size = NODES.max(all / GROUPS);
        let (mut of_node, mut near) = (Vec::with_capacity(all), Vec::new());
        for (body, _) in bodies {
            let first = of_node.len();
            of_node.resize(first + body.len(), 0);
            halve(body.rest(), &mut Vec::from_iter(0..body.len()), size, &mut |nodes| {
                nodes.iter().for_each(|node| of_node[first + node] = near.len());
                near.push(BTreeSet::new());
            });
            for element in body.elements().iter() {
                let groups: BTreeSet<_> = element.iter().map(|&node| of_node[first + node as usize]).collect();
                groups.iter().for_each(|&group| near[group].extend(&groups));
            }
        }
        let mut colours: Vec<Vec<usize>> = Vec::new();
        for group in 0..near.len() {
            let is_apart = |other: &usize| near[group].is_disjoint(&near[*other]);
            match colours.iter_mut().find(|colour| colour.iter().all(is_apart)) {
                Some(colour) => colour.push(group),
                None => colours.push(vec![group]),
            }
        }
        Self { of_node, colours, near }
    }

    /// The evaluations of forces that [`Coarse::new`] takes.
    pub(super) fn cost(&self) -> u64 {
        (MODES * self.colours.len()) as u64
    }
}

/// Halves nodes across the longest side of the box around them until parts have at most some `size` nodes.
fn halve(rest: &[DVec3], nodes: &mut [usize], size: usize, group: &mut impl FnMut(&[usize])) {
    if nodes.len() <= size {
        return group(nodes);
    }
    let (low, high) = bounds(&nodes.iter().map(|&node| rest[node]).collect::<Vec<_>>());
    let along = (high - low).max_position();
    nodes.sort_by(|&one, &other| rest[one][along].total_cmp(&rest[other][along]));
    let (one, other) = nodes.split_at_mut(nodes.len() / 2);
    halve(rest, one, size, group);
    halve(rest, other, size, group);
}

/// The stiffness of the groups where the bodies are.
pub(super) struct Coarse<'a> {
    groups: &'a Groups,
    /// Where nodes are from the middle of their group, as a share of the size of the largest body.
    arms: Vec<DVec3>,
    /// The triangular factor of the stiffness, by rows.
    factor: Vec<Vec<f64>>,
    /// The square of the shortest period over 2π (s²).
    fast: f64,
}

impl<'a> Coarse<'a> {
    /// Evaluates forces after small ways of the groups from a position (m), at which the accelerations (m/s²) are given.
    pub(super) fn new(
        groups: &'a Groups,
        forces: &mut Forces,
        longest: f64,
        position: &[DVec3],
        here: &[DVec3],
    ) -> Self {
        let count = groups.near.len();
        let mut middles = vec![(DVec3::ZERO, 0.0); count];
        for (&group, &at) in groups.of_node.iter().zip(position) {
            middles[group].0 += at;
            middles[group].1 += 1.0;
        }
        let arm = |(&group, &at): (&usize, &DVec3)| (at - middles[group].0 / middles[group].1) / longest;
        let arms = groups.of_node.iter().zip(position).map(arm).collect();
        let mut coarse =
            Self { groups, arms, factor: vec![vec![0.0; MODES * count]; MODES * count], fast: forces.fast };
        let way = TINY * longest;
        let mut there = Vec::new();
        for colour in &groups.colours {
            for mode in 0..MODES {
                let mut moves = vec![0.0; MODES * count];
                colour.iter().for_each(|group| moves[MODES * group + mode] = way);
                let moved = |node: usize| {
                    position[node] + if forces.is_held[node] { DVec3::ZERO } else { coarse.displacement(&moves, node) }
                };
                let trial: Vec<_> = (0..position.len()).map(moved).collect();
                forces.accelerations(&trial, &mut there);
                let change: Vec<_> = there.iter().zip(here).map(|(&there, &here)| (here - there) / way).collect();
                let change = coarse.sums(&change, &forces.mass);
                for &group in colour {
                    for row in groups.near[group].iter().flat_map(|near| MODES * near..MODES * (near + 1)) {
                        coarse.factor[row][MODES * group + mode] = change[row];
                    }
                }
            }
        }
        coarse.factorise();
        coarse
    }

    /// Way of a node (m) if groups move by shares of their modes.
    fn displacement(&self, moves: &[f64], node: usize) -> DVec3 {
        let of = &moves[MODES * self.groups.of_node[node]..][..MODES];
        DVec3::from_slice(of) + DVec3::from_slice(&of[3..]).cross(self.arms[node])
    }

    /// The force (N) along each mode.
    fn sums(&self, acceleration: &[DVec3], mass: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.factor.len()];
        for (((&group, &arm), &acceleration), &mass) in
            self.groups.of_node.iter().zip(&self.arms).zip(acceleration).zip(mass)
        {
            let force = acceleration * mass;
            let both = force.to_array().into_iter().chain(arm.cross(force).to_array());
            sums[MODES * group..].iter_mut().zip(both).for_each(|(sum, part)| *sum += part);
        }
        sums
    }

    /// Replaces the lower triangle of the stiffness by its factor (A. L. Cholesky). Modes without stiffness get an infinite one, and stay.
    fn factorise(&mut self) {
        for row in 0..self.factor.len() {
            let (above, rest) = self.factor.split_at_mut(row);
            let own = &mut rest[0];
            let whole = own[row];
            for column in 0..row {
                let known: f64 = own[..column].iter().zip(&above[column]).map(|(a, b)| a * b).sum();
                own[column] = (own[column] - known) / above[column][column];
            }
            let left = whole - own[..row].iter().map(|known| known * known).sum::<f64>();
            own[row] = if left > NOTHING * whole { left.sqrt() } else { f64::INFINITY };
        }
    }

    /// Writes where nodes go (m) by forces that are given as accelerations (m/s²): each by itself, as the fastest would, and with its group.
    pub(super) fn lead(&self, acceleration: &[DVec3], forces: &Forces, out: &mut Vec<DVec3>) {
        let Forces { mass, is_held, .. } = forces;
        let mut moves = self.sums(acceleration, mass);
        for row in 0..moves.len() {
            let known: f64 = self.factor[row][..row].iter().zip(&moves).map(|(a, b)| a * b).sum();
            moves[row] = (moves[row] - known) / self.factor[row][row];
        }
        for row in (0..moves.len()).rev() {
            moves[row] /= self.factor[row][row];
            let (own, (below, _)) = (moves[row], moves.split_at_mut(row));
            below.iter_mut().zip(&self.factor[row]).for_each(|(value, factor)| *value -= factor * own);
        }
        out.clear();
        let way = |node: usize| acceleration[node] * self.fast + self.displacement(&moves, node);
        out.extend((0..is_held.len()).map(|node| if is_held[node] { DVec3::ZERO } else { way(node) }));
    }
}
