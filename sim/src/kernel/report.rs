//! Elastic energy, residuals and strains in lanes, tested against [`ForceModel::report`](crate::model::ForceModel::report) and
//! [`Field::Strain`](crate::field::Field::Strain).
//!
//! Lanes are consecutive elements with the same number of corners, or consecutive springs. Nothing is stored from one
//! report to the next. Sums run within chunks and then over chunks, in order, so that their bits do not depend on the width or on
//! the number of threads.

use super::Rotation;
use super::rotation::{self, Matrix, Solver, axial, matrix, turned_back};
use crate::body::Body;
use crate::crew::Crew;
use crate::element::Dimension;
use crate::gather::Group;
use crate::lanes::{Lanes, MOST, Set, Work, each};
use crate::model::{Report, Share};
use glam::{DMat3, DQuat, DVec3};
use std::ops::Range;
use std::sync::Arc;

/// Elements or springs in one task of a thread.
const CHUNK: usize = 1024;

/// The parts of a body that have elastic energy.
pub(crate) enum Elastic {
    /// The elements, with Eq. (4). In the plane the rotation follows Eq. (9).
    Elements(Rotation),
    /// These springs, with Eq. (1).
    Springs(Arc<[[u32; 2]]>),
}

/// The energy of a body.
pub(crate) struct Energy {
    pub(crate) set: Set,
    pub(crate) body: Arc<Body>,
    /// `k` (N/m).
    pub(crate) stiffness: f64,
    pub(crate) of: Elastic,
}

impl Energy {
    /// Energy and residuals with the nodes at `position` (m) and this memory of the model. Calls `share`, if given, for
    /// each element or spring, in order.
    pub(crate) fn report(
        &self,
        position: &[DVec3],
        memory: &[f64],
        share: Option<&mut Share<'_>>,
        crew: &Crew,
    ) -> Report {
        let count = match &self.of {
            Elastic::Elements(_) => self.body.elements.len(),
            Elastic::Springs(springs) => springs.len(),
        };
        let range = |chunk: usize| chunk * CHUNK..count.min((chunk + 1) * CHUNK);
        let with_shares = share.is_some();
        let measure = |chunk: usize| {
            let chunk = Chunk { energy: self, position, memory, range: range(chunk), with_shares };
            self.set.run(chunk)
        };
        let found: Vec<Found> = crew.map(count.div_ceil(CHUNK), measure);
        if let Some(share) = share {
            for (chunk, Found { shares, .. }) in found.iter().enumerate() {
                let mut rest = &shares[..];
                for at in range(chunk) {
                    let nodes = self.nodes_of(at);
                    let (own, others) = rest.split_at(nodes.len());
                    share(at, nodes, own);
                    rest = others;
                }
            }
        }
        let energy = found.iter().map(|chunk| chunk.energy).sum();
        let residual = found.iter().fold(0.0, |most: f64, chunk| most.max(chunk.residual));
        let residuals = match self.of {
            Elastic::Elements(_) => vec![(Report::ROTATION, residual)],
            Elastic::Springs(_) => Vec::new(),
        };
        Report { energy: Some(energy), residuals }
    }

    #[inline(always)]
    fn nodes_of(&self, at: usize) -> &[u32] {
        match &self.of {
            Elastic::Elements(_) => &self.body.elements[at],
            Elastic::Springs(springs) => &springs[at],
        }
    }
}

/// Consecutive elements or springs.
struct Chunk<'a> {
    energy: &'a Energy,
    position: &'a [DVec3],
    memory: &'a [f64],
    range: Range<usize>,
    with_shares: bool,
}

/// The results of a chunk.
#[derive(Default)]
struct Found {
    /// (J)
    energy: f64,
    /// The largest α of Eq. (18) (rad/s²).
    residual: f64,
    /// The energy of each corner (J), if requested.
    shares: Vec<f64>,
}

impl Work for Chunk<'_> {
    type Output = Found;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Found {
        match self.energy.of {
            Elastic::Elements(rotation) => self.elements::<L>(rotation),
            Elastic::Springs(_) => self.springs::<L>(),
        }
    }
}

impl Chunk<'_> {
    #[inline(always)]
    fn elements<L: Lanes>(self, rotation: Rotation) -> Found {
        let Self { energy: Energy { body, stiffness, .. }, position, memory, range, with_shares } = self;
        let (zero, k, half_k) = (L::splat(0.0), L::splat(*stiffness), L::splat(0.5 * stiffness));
        // The energy of each corner.
        let (mut shapes, mut shares) = (Shapes::<L>::default(), Vec::new());
        let mut found = Found::default();
        let mut at = range.start;
        while at < range.end {
            let (group, count) = take::<L>(body, at..range.end);
            shapes.read(&group, body, position);
            let width = if body.dimension == Dimension::Plane { 2 } else { 4 };
            let mut last = [[0.0; MOST]; 4];
            for (entry, last) in last[..width].iter_mut().enumerate() {
                for lane in 0..L::WIDTH {
                    last[lane] = memory[(at + lane.min(count - 1)) * width + entry];
                }
            }
            let m = shapes.rotation(body.dimension, rotation, &last);
            let (mut energy, mut inertia) = (zero, zero);
            shares.clear();
            for corner in 0..group.corners() {
                let share = half_k * square(shapes.displacement(corner, &m));
                energy = energy + share;
                inertia = group.number::<L>(corner, &body.mass).mul_add(square(shapes.rest[corner]), inertia);
                if with_shares {
                    shares.push(share.to_array());
                }
            }
            let torque = axial(&turned_back(&shapes.a, &m));
            let alpha = (k * square(torque).sqrt()).div(inertia).to_array();
            let energy = energy.to_array();
            for lane in 0..count {
                found.energy += energy[lane];
                found.residual = found.residual.max(alpha[lane]);
                found.shares.extend(shares.iter().map(|share| share[lane]));
            }
            at += count;
        }
        found
    }

    #[inline(always)]
    fn springs<L: Lanes>(self) -> Found {
        let Self { energy, position, range, with_shares, .. } = self;
        let half_k = L::splat(0.5 * energy.stiffness);
        let mut found = Found::default();
        let mut at = range.start;
        while at < range.end {
            let (group, count) = Group::take::<L>(at..range.end, |spring| energy.nodes_of(spring), |_| true);
            let stretch = length::<L>(&group, position) - length::<L>(&group, &energy.body.rest);
            let whole = (half_k * stretch * stretch).to_array();
            for &whole in &whole[..count] {
                found.energy += whole;
                if with_shares {
                    found.shares.extend([0.5 * whole; 2]);
                }
            }
            at += count;
        }
        found
    }
}

/// The [strain](crate::field::Field::Strain) of each element with the nodes at `position` (m). Rotations are sought
/// from `near` on: the nearer it is, the faster they are found.
pub(crate) fn strains(set: Set, body: &Body, position: &[DVec3], near: DMat3, crew: &Crew) -> Vec<f64> {
    let count = body.elements.len();
    let near = match body.dimension {
        // Eq. (9) keeps the last angle only where all are equally good.
        Dimension::Plane => [1.0, 0.0, 0.0, 0.0],
        Dimension::Space => DQuat::from_mat3(&near).to_array(),
    };
    let of_chunk =
        |chunk: usize| set.run(Strains { body, position, near, range: chunk * CHUNK..count.min((chunk + 1) * CHUNK) });
    crew.map(count.div_ceil(CHUNK), of_chunk).concat()
}

/// Computes the strains of consecutive elements.
struct Strains<'a> {
    body: &'a Body,
    position: &'a [DVec3],
    near: [f64; 4],
    range: Range<usize>,
}

impl Work for Strains<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<f64> {
        let Self { body, position, near, range } = self;
        let near = each!(4, entry => [near[entry]; MOST]);
        let mut shapes = Shapes::<L>::default();
        let mut strains = Vec::with_capacity(range.len());
        let mut at = range.start;
        while at < range.end {
            let (group, count) = take::<L>(body, at..range.end);
            shapes.read(&group, body, position);
            let m = shapes.rotation(body.dimension, Rotation::Optimum, &near);
            let mut off = L::splat(0.0);
            for corner in 0..group.corners() {
                off = off + square(shapes.displacement(corner, &m));
            }
            strains.extend_from_slice(&off.div(shapes.squares).sqrt().to_array()[..count]);
            at += count;
        }
        strains
    }
}

/// The first elements of a range with the same number of corners, and their number.
#[inline(always)]
fn take<L: Lanes>(body: &Body, range: Range<usize>) -> (Group<'_>, usize) {
    let corners = body.elements[range.start].len();
    Group::take::<L>(range, |element| &body.elements[element], |element| body.elements[element].len() == corners)
}

/// The corners of elements relative to their means, and sums over them.
struct Shapes<L> {
    /// `R0` (m).
    rest: Vec<[L; 3]>,
    /// `r` (m).
    now: Vec<[L; 3]>,
    /// `Σ r R0ᵀ` (m²).
    a: Matrix<L>,
    /// `Σ |R0|²` (m²).
    squares: L,
}

impl<L: Lanes> Default for Shapes<L> {
    #[inline(always)]
    fn default() -> Self {
        let zero = L::splat(0.0);
        Self { rest: Vec::new(), now: Vec::new(), a: [[zero; 3]; 3], squares: zero }
    }
}

impl<L: Lanes> Shapes<L> {
    /// Reads elements with the nodes at `position` (m).
    #[inline(always)]
    fn read(&mut self, group: &Group<'_>, body: &Body, position: &[DVec3]) {
        group.centred::<L>(&body.rest, &mut self.rest);
        group.centred::<L>(position, &mut self.now);
        let zero = L::splat(0.0);
        let (mut a, mut squares) = ([[zero; 3]; 3], zero);
        for corner in 0..group.corners() {
            let (rest, r) = (self.rest[corner], self.now[corner]);
            a = each!(3, column => each!(3, row => r[row].mul_add(rest[column], a[column][row])));
            squares = squares + square(rest);
        }
        (self.a, self.squares) = (a, squares);
    }

    /// The rotations `M` from the last ones: quaternions, or (cos, sin) in the plane.
    #[inline(always)]
    fn rotation(&self, dimension: Dimension, rotation: Rotation, last: &[[f64; MOST]; 4]) -> Matrix<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        match dimension {
            Dimension::Plane => in_plane(&self.a, each!(2, entry => L::from_array(last[entry]))),
            Dimension::Space => {
                let last = each!(4, entry => L::from_array(last[entry]));
                let scale = one.div(self.squares).select(zero.lt(self.squares), one);
                let of = rotation::Moments { a: &self.a, scale, tally: None };
                let turn = match rotation {
                    Rotation::Arctangent { passes } => rotation::Arctangent { passes }.follow(of, last, L::ALL),
                    Rotation::Optimum => rotation::Optimum.follow(of, last, L::ALL),
                };
                matrix(turn, one)
            }
        }
    }

    /// `r − M R0` of a corner (m).
    #[inline(always)]
    fn displacement(&self, corner: usize, m: &Matrix<L>) -> [L; 3] {
        let ([x, y, z], r) = (self.rest[corner], self.now[corner]);
        each!(3, row => r[row] - z.mul_add(m[2][row], y.mul_add(m[1][row], x * m[0][row])))
    }
}

#[inline(always)]
fn square<L: Lanes>([x, y, z]: [L; 3]) -> L {
    z.mul_add(z, y.mul_add(y, x * x))
}

/// The distance of the two nodes of each spring.
#[inline(always)]
fn length<L: Lanes>(group: &Group<'_>, values: &[DVec3]) -> L {
    let (from, to) = (group.vector::<L>(0, values), group.vector::<L>(1, values));
    square(each!(3, axis => to[axis] - from[axis])).sqrt()
}

/// Eq. (8) with the angle of Eq. (9).
#[inline(always)]
fn in_plane<L: Lanes>(a: &Matrix<L>, last: [L; 2]) -> Matrix<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let [cosine, sine] = rotation::in_plane([a[0][0] + a[1][1], a[0][1] - a[1][0]], last);
    [[cosine, sine, zero], [-sine, cosine, zero], [zero, zero, one]]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Random, TWICE, pieces, rotations, shape_based, start, whole};
    use super::*;
    use crate::model::ElasticModel;
    use crate::model::mass_spring::MassSpring;
    use crate::rotation::{best, moment};
    use crate::state::Nodes;
    use crate::topology::Springs;

    /// What was shared: the nodes of each element or spring, with their energies (J).
    type Shares = Vec<(Vec<u32>, Vec<f64>)>;

    fn with_shares(report: impl FnOnce(&mut Share<'_>) -> Report) -> (Report, Shares) {
        let mut shares = Shares::new();
        let report = report(&mut |at, nodes, own| {
            assert_eq!(at, shares.len());
            shares.push((nodes.to_vec(), own.to_vec()));
        });
        (report, shares)
    }

    /// The reports of the vectorised code, with the same bits for every set and number of threads, and of the
    /// reference.
    fn reports(
        energy: &mut Energy,
        model: &dyn ElasticModel,
        position: &[DVec3],
        memory: &[f64],
    ) -> [(Report, Shares); 2] {
        let mut found = None;
        for (set, threads) in Set::all().flat_map(|set| [1, 2, 3].map(|threads| (set, threads))) {
            energy.set = set;
            let crew = Crew::new(threads);
            let here = with_shares(|share| energy.report(position, memory, Some(share), &crew));
            assert_eq!(here.0, energy.report(position, memory, None, &crew));
            assert!(found.as_ref().is_none_or(|found| *found == here), "{set:?} on {threads} threads has other bits");
            found = Some(here);
        }
        let still = vec![DVec3::ZERO; position.len()];
        let at = Nodes { position, velocity: &still };
        [found.expect("some set"), with_shares(|share| model.prepare(&energy.body).report(at, memory, share))]
    }

    fn assert_near(name: &str, [found, expected]: [(Report, Shares); 2], largest_alpha: f64, is_unique: bool) {
        let [energy, reference] = [&found, &expected].map(|all| all.0.energy.expect("an energy"));
        assert!((energy - reference).abs() <= 1e-12 * reference, "{name}: {energy} instead of {reference}");
        assert_eq!(found.0.residuals.len(), expected.0.residuals.len());
        for (found, expected) in found.0.residuals.iter().zip(&expected.0.residuals) {
            assert_eq!(found.0, expected.0);
            assert!((found.1 - expected.1).abs() <= 1e-12 * largest_alpha, "{name}: {found:?} instead of {expected:?}");
        }
        assert_eq!(found.1.len(), expected.1.len());
        let whole: f64 = found.1.iter().flat_map(|(_, shares)| shares).sum();
        assert!((whole - energy).abs() <= 1e-12 * energy, "{name}");
        let largest = expected.1.iter().flat_map(|(_, shares)| shares).fold(0.0, |most: f64, share| most.max(*share));
        for ((nodes, shares), (own, expected)) in found.1.iter().zip(&expected.1) {
            assert_eq!(nodes, own);
            let far = shares.iter().zip(expected).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            // Where several rotations are optimal, round-off may select another one.
            assert!(far <= 1e-12 * largest || !is_unique, "{name}: {shares:?} instead of {expected:?}");
        }
    }

    /// The angular acceleration (rad/s²) that the largest possible torque would cause.
    fn largest_alpha(body: &Body, stiffness: f64, position: &[DVec3]) -> f64 {
        let largest = |nodes: &[u32]| {
            let arms = |places: &[DVec3]| -> Vec<f64> {
                let mean = nodes.iter().map(|&node| places[node as usize]).sum::<DVec3>() / nodes.len() as f64;
                nodes.iter().map(|&node| places[node as usize].distance(mean)).collect()
            };
            let (rest, now) = (arms(&body.rest), arms(position));
            let inertia: f64 = nodes.iter().zip(&rest).map(|(&node, r)| body.mass[node as usize] * r * r).sum();
            stiffness * rest.iter().zip(&now).map(|(rest, now)| rest * now).sum::<f64>() / inertia
        };
        body.elements.iter().map(largest).fold(0.0, f64::max)
    }

    /// The strain of an element by its definition.
    fn strain(body: &Body, nodes: &[u32], position: &[DVec3]) -> f64 {
        let centred = |points: &[DVec3]| {
            let corners = nodes.iter().map(|&node| points[node as usize]);
            let mean = corners.clone().sum::<DVec3>() / nodes.len() as f64;
            corners.map(|corner| corner - mean).collect::<Vec<_>>()
        };
        let (rest, now) = (centred(&body.rest), centred(position));
        let best = best(body.dimension, moment(&rest, now.iter().copied()));
        let off: f64 = rest.iter().zip(&now).map(|(&rest, &now)| (now - best * rest).length_squared()).sum();
        (off / rest.iter().map(|rest| rest.length_squared()).sum::<f64>()).sqrt()
    }

    /// From the identity, and from a rotation that is far from all.
    fn assert_strains(name: &str, body: &Body, position: &[DVec3]) {
        let expected: Vec<_> = body.elements.iter().map(|nodes| strain(body, nodes, position)).collect();
        for near in [DMat3::IDENTITY, DMat3::from_quat(DQuat::from_xyzw(0.7, -0.1, 0.1, 0.7).normalize())] {
            let mut found = None;
            for (set, threads) in Set::all().flat_map(|set| [1, 3].map(|threads| (set, threads))) {
                let here = strains(set, body, position, near, &Crew::new(threads));
                assert!(
                    found.as_ref().is_none_or(|found| *found == here),
                    "{name}: {set:?}, {threads} threads: other bits"
                );
                found = Some(here);
            }
            for (found, &expected) in found.expect("some set").iter().zip(&expected) {
                assert!((found - expected).abs() <= 1e-14 * (1.0 + expected), "{name}: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn energies_residuals_and_strains_are_those_of_the_reference() {
        let crushes = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 0.0), DVec3::ZERO];
        let mut bodies = vec![("a block", whole([11, 12, 10], 0.1, 1)), ("squares", whole([9, 3, 0], 0.1, 2))];
        for corners in 2..9 {
            bodies.push(("one kind", pieces([4, 3, 3], &[corners], corners as u64)));
        }
        bodies.push(("anything", pieces([5, 4, 4], &[2, 3, 4, 5, 6, 7, 8], 9)));
        bodies.push(("anything flat", pieces([7, 5, 0], &[3, 4], 10)));
        bodies.push(("one tetrahedron", pieces([1, 1, 1], &[4], 11)));
        for (name, body) in &bodies {
            let springs: Arc<[[u32; 2]]> = body.topology().springs(Springs::All).into();
            for crush in [None].into_iter().chain(crushes.map(Some)) {
                let mut state = start(body, 3);
                let memory = rotations(body, &state);
                let random = &mut Random(4);
                state.position.iter_mut().for_each(|place| *place += random.vector(body.dimension) * 0.002);
                // Some elements among others are turned inside out, flattened or collapsed to a line or a point.
                for nodes in crush.into_iter().flat_map(|_| body.elements.iter().step_by(5)) {
                    let middle = state.position[nodes[0] as usize];
                    for &node in nodes {
                        let place = &mut state.position[node as usize];
                        *place = middle + (*place - middle) * crush.unwrap_or(DVec3::ONE);
                    }
                }
                let position = &state.position;
                let name = format!("{name}, {} corners, {crush:?}", body.elements[0].len());
                assert_strains(&name, body, position);
                for rotation in [Rotation::Optimum, TWICE] {
                    let (model, of) = (shape_based(rotation, 0.0), Elastic::Elements(rotation));
                    let stiffness = model.stiffness();
                    let mut energy = Energy { set: Set::best(), body: Arc::clone(body), stiffness, of };
                    let both = reports(&mut energy, &model, position, &memory);
                    let name = format!("{name}, {rotation:?}");
                    assert_near(&name, both, largest_alpha(body, stiffness, position), crush.is_none());
                }
                let model = MassSpring { stiffness: 1e4, damping: 0.0, springs: Arc::clone(&springs) };
                let of = Elastic::Springs(Arc::clone(&springs));
                let mut energy = Energy { set: Set::best(), body: Arc::clone(body), stiffness: 1e4, of };
                assert_near(&name, reports(&mut energy, &model, position, &[]), 0.0, true);
            }
        }
    }
}
