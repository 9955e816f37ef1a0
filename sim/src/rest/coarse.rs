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
use std::ops::Range;
use std::sync::Arc;

/// Nodes of a group, and the most groups.
const NODES: usize = 64;
const GROUPS: usize = 64;
/// Displacements and rotations of a group.
const MODES: usize = 6;
/// The way of nodes, there and back, for which forces are compared, as a share of the longest way in an iteration.
const TINY: f64 = 2e-6;
/// A stiffness that is nothing but error, as a share of that with which the modes would be as fast as the fastest node. Slender bodies have
/// soft modes.
const NOTHING: f64 = 1e-9;

/// The groups of all bodies.
pub(super) struct Groups {
    of_node: Vec<usize>,
    /// Groups that share no neighbour have one colour: the forces of all of one colour are found at once.
    colours: Vec<Vec<usize>>,
    /// The groups that share elements with each, and itself.
    near: Vec<BTreeSet<usize>>,
    /// The nodes and the groups of each body.
    bodies: Vec<(Range<usize>, Range<usize>)>,
    /// The first group of the body of each.
    first: Vec<usize>,
}

impl Groups {
    pub(super) fn new(bodies: &[(Arc<Body>, &dyn ElasticModel)]) -> Self {
        let all: usize = bodies.iter().map(|(body, _)| body.len()).sum();
        let size = NODES.max(all / GROUPS);
        let (mut of_node, mut near, mut parts) = (Vec::with_capacity(all), Vec::new(), Vec::new());
        let mut first_of = Vec::new();
        for (body, _) in bodies {
            let (first, first_group) = (of_node.len(), near.len());
            of_node.resize(first + body.len(), 0);
            halve(body.rest(), &mut Vec::from_iter(0..body.len()), size, &mut |nodes| {
                nodes.iter().for_each(|node| of_node[first + node] = near.len());
                near.push(BTreeSet::new());
            });
            first_of.resize(near.len(), first_group);
            parts.push((first..of_node.len(), first_group..near.len()));
            for element in body.elements().iter() {
                let groups: BTreeSet<_> = element.iter().map(|&node| of_node[first + node as usize]).collect();
                groups.iter().for_each(|&group| near[group].extend(&groups));
            }
        }
        let mut colours: Vec<Vec<usize>> = Vec::new();
        for group in 0..near.len() {
            // Groups of other bodies share nothing with it.
            let is_apart = |colour: &Vec<usize>| {
                let of_body = colour.iter().rev().take_while(|&&other| other >= first_of[group]);
                of_body.into_iter().all(|&other| near[group].is_disjoint(&near[other]))
            };
            match colours.iter_mut().find(|colour| is_apart(colour)) {
                Some(colour) => colour.push(group),
                None => colours.push(vec![group]),
            }
        }
        Self { of_node, colours, near, bodies: parts, first: first_of }
    }

    /// The first row of the body of a row of the stiffness.
    fn first(&self, row: usize) -> usize {
        MODES * self.first[row / MODES]
    }

    /// The evaluations of forces that [`Coarse::new`] takes.
    pub(super) fn cost(&self) -> u64 {
        (2 * MODES * self.colours.len()) as u64
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
    /// The triangular factor of the stiffness, by rows, each from the first row of its body on: no body stiffens another.
    factor: Vec<Vec<f64>>,
    /// The square of the shortest period over 2π (s²).
    fast: f64,
}

impl<'a> Coarse<'a> {
    /// Evaluates forces after small ways of the groups from a position (m), there and back.
    pub(super) fn new(groups: &'a Groups, forces: &mut Forces, longest: f64, position: &[DVec3]) -> Self {
        let count = groups.near.len();
        let mut middles = vec![(DVec3::ZERO, 0.0); count];
        for (&group, &at) in groups.of_node.iter().zip(position) {
            middles[group].0 += at;
            middles[group].1 += 1.0;
        }
        let arm = |(&group, &at): (&usize, &DVec3)| (at - middles[group].0 / middles[group].1) / longest;
        let arms = groups.of_node.iter().zip(position).map(arm).collect();
        let rows = groups.bodies.iter().flat_map(|(_, of)| std::iter::repeat_n(MODES * of.len(), MODES * of.len()));
        let factor = rows.map(|length| vec![0.0; length]).collect();
        let mut coarse = Self { groups, arms, factor, fast: forces.fast };
        for colour in &groups.colours {
            for mode in 0..MODES {
                let mut moves = vec![0.0; MODES * count];
                colour.iter().for_each(|group| moves[MODES * group + mode] = TINY * longest);
                let change = coarse.change(forces, position, &moves);
                for &group in colour {
                    for row in groups.near[group].iter().flat_map(|near| MODES * near..MODES * (near + 1)) {
                        coarse.factor[row][MODES * group + mode - groups.first(row)] = change[row] / (TINY * longest);
                    }
                }
            }
        }
        coarse.factorise(forces);
        coarse
    }

    /// By how much the force along each mode (N) falls when groups move by shares of their modes: half of the difference there and back, without
    /// what is square.
    fn change(&self, forces: &mut Forces, position: &[DVec3], moves: &[f64]) -> Vec<f64> {
        let [there, back] = [1.0, -1.0].map(|sign| {
            let place = |node: usize| position[node] + self.displacement(moves, node) * sign;
            let is_held = |node: usize| forces.is_held[node];
            let trial: Vec<_> =
                (0..position.len()).map(|node| if is_held(node) { position[node] } else { place(node) }).collect();
            let mut accelerations = Vec::new();
            forces.accelerations(&trial, &mut accelerations);
            self.sums(&accelerations, &forces.mass)
        });
        back.into_iter().zip(there).map(|(back, there)| 0.5 * (back - there)).collect()
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

    /// Replaces the lower triangle of the stiffness, made symmetric where loads follow the body, by its factor (A. L. Cholesky). Modes without
    /// stiffness get an infinite one, and stay.
    fn factorise(&mut self, forces: &Forces) {
        let mut fastest = vec![0.0; self.factor.len()];
        for ((&group, &arm), &mass) in self.groups.of_node.iter().zip(&self.arms).zip(&forces.mass) {
            let turns = DVec3::AXES.map(|axis| axis.cross(arm).length_squared());
            let both = [1.0; 3].into_iter().chain(turns).map(|square| mass * square / self.fast);
            fastest[MODES * group..].iter_mut().zip(both).for_each(|(sum, part)| *sum += part);
        }
        // Springs on one group keep a body in place that nothing holds.
        let free = self.groups.bodies.iter().filter(|(nodes, _)| !forces.is_held[nodes.clone()].contains(&true));
        for row in free.flat_map(|(_, groups)| MODES * groups.start..MODES * (groups.start + 1)) {
            self.factor[row][row - self.groups.first(row)] += fastest[row];
        }
        for row in 0..self.factor.len() {
            let (above, rest) = self.factor.split_at_mut(row);
            // The rows above of the same body.
            let (above, own) = (&above[self.groups.first(row)..], &mut rest[0]);
            let last = above.len();
            for column in 0..last {
                own[column] = 0.5 * (own[column] + above[column][last]);
            }
            for column in 0..last {
                let known: f64 = own[..column].iter().zip(&above[column]).map(|(a, b)| a * b).sum();
                own[column] = (own[column] - known) / above[column][column];
            }
            let left = own[last] - own[..last].iter().map(|known| known * known).sum::<f64>();
            own[last] = if left > NOTHING * fastest[row] { left.sqrt() } else { f64::INFINITY };
        }
    }

    /// Writes where nodes go (m) by forces that are given as accelerations (m/s²): each by itself, as the fastest would, and with its group.
    pub(super) fn lead(&self, acceleration: &[DVec3], forces: &Forces, out: &mut Vec<DVec3>) {
        let Forces { mass, is_held, .. } = forces;
        let mut moves = self.sums(acceleration, mass);
        for (row, factor) in self.factor.iter().enumerate() {
            let first = self.groups.first(row);
            let known: f64 = factor.iter().zip(&moves[first..row]).map(|(a, b)| a * b).sum();
            moves[row] = (moves[row] - known) / factor[row - first];
        }
        for (row, factor) in self.factor.iter().enumerate().rev() {
            let first = self.groups.first(row);
            moves[row] /= factor[row - first];
            let own = moves[row];
            moves[first..row].iter_mut().zip(factor).for_each(|(value, factor)| *value -= factor * own);
        }
        out.clear();
        let way = |node: usize| acceleration[node] * self.fast + self.displacement(&moves, node);
        out.extend((0..is_held.len()).map(|node| if is_held[node] { DVec3::ZERO } else { way(node) }));
    }
}
