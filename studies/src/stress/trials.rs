//! The trials.

use super::Promise;
use crate::contact::{self, obstacle};
use crate::random::Random;
use glam::{DMat3, DQuat, DVec3};
use localshape::sim::{
    Body, Dimension, Ease, FrictionOf, IndexLists, Key, Motion, Obstacle, Offset, Shape, Solids, State, Surroundings,
};
use std::sync::Arc;

/// A body and its treatment.
#[derive(Debug)]
pub(super) struct Trial {
    pub(super) group: &'static str,
    pub(super) name: String,
    pub(super) body: Arc<Body>,
    pub(super) start: State,
    pub(super) around: Surroundings,
    /// `k` (N/m) and `D` (N s/m).
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    /// ΔT (s).
    pub(super) step: f64,
    pub(super) steps: u64,
    /// The unit of distances (m).
    pub(super) side: f64,
    pub(super) promise: Promise,
    /// Whether it is to stay where it is.
    pub(super) is_still: bool,
}

impl Trial {
    /// The number of elements of the body.
    pub(super) fn elements(&self) -> usize {
        self.body.elements().len()
    }
}

/// Acceleration of gravity (m/s²).
const GRAVITY: f64 = 9.8;
/// The side of cubes (m), unless it is varied.
const SIDE: f64 = 0.1;
/// `k/m` (1/s²) and ζ, unless they are varied.
const USUAL: Elastic = Elastic { over_mass: 1e4, ratio: 0.1 };

/// `k/m` of the lightest node (1/s²), and the damping ratio.
#[derive(Clone, Copy)]
struct Elastic {
    over_mass: f64,
    ratio: f64,
}

/// All trials, with a number of steps of bodies that rest or spin.
pub(super) fn trials(steps: u64) -> Vec<Trial> {
    let mut all = Vec::new();
    all.extend(falls());
    all.push(pressed());
    all.extend(hits());
    all.extend(starts());
    all.extend(elements());
    all.extend(long(steps));
    all
}

/// A trial of a free body: nothing acts on it from outside.
fn free(group: &'static str, name: String, body: Body, start: State, elastic: Elastic, side: f64) -> Trial {
    let stiffness = elastic.over_mass * body.lightest();
    let omega = elastic.over_mass.sqrt();
    let most = most_elements(&body);
    // Half of the limit of stability, ω_max² ΔT² + 2 c_max ΔT = 4 with ω_max² = n k/m and c_max = n D/m, where at most n
    // elements share a node.
    let c = 2.0 * most * elastic.ratio;
    let step = 0.5 * ((c * c + 4.0 * most).sqrt() - c) / most / omega;
    // Some time constants of the damping: of 1/ζω if it is weak, of ζ/ω if it is strong.
    let slow = (1.0 / elastic.ratio.max(0.01)).max(4.0 * elastic.ratio);
    Trial {
        group,
        name,
        start,
        around: Surroundings::default(),
        stiffness,
        damping: 2.0 * elastic.ratio * (stiffness * body.lightest()).sqrt(),
        step,
        steps: (30.0 * slow / omega / step).ceil() as u64,
        body: Arc::new(body),
        side,
        promise: if elastic.ratio > 0.0 { Promise::Restored(1e-3) } else { Promise::Bounded },
        is_still: false,
    }
}

/// A cube of 27 cubes that meets a floor, turned obliquely, with a speed (m/s).
fn thrown(group: &'static str, name: String, body: Body, at: DVec3, speed: f64, elastic: Elastic, side: f64) -> Trial {
    let turn = DQuat::from_xyzw(0.11, 0.23, -0.17, 1.0).normalize();
    let turned: Vec<_> = body.rest().iter().map(|&rest| turn * rest).collect();
    let lowest = turned.iter().map(|node| node.y).fold(f64::INFINITY, f64::min);
    let position: Vec<_> = turned.into_iter().map(|node| at + node - DVec3::Y * lowest).collect();
    let velocity = vec![DVec3::Y * -speed; position.len()];
    let trial = free(group, name, body, State::new(position, velocity), elastic, side);
    let around = Surroundings { obstacles: vec![floor(at.y, 0.5, 0.3)], ..trial.around };
    Trial { around, ..trial }
}

/// Falls onto a floor.
fn falls() -> impl Iterator<Item = Trial> {
    let cases = [1e4, 1e5].into_iter().flat_map(|over_mass| [5.0, 10.0, 20.0, 40.0].map(|height| (over_mass, height)));
    cases.map(|(over_mass, height)| {
        let elastic = Elastic { over_mass, ..USUAL };
        let speed = f64::sqrt(2.0 * GRAVITY * height);
        let name = format!("{height} m, k/m = {over_mass:e}");
        let trial = thrown("Falls", name, lattice(3, SIDE, 1.0), DVec3::ZERO, speed, elastic, SIDE);
        let around = Surroundings { gravity: DVec3::Y * -GRAVITY, ..trial.around };
        // Several rebounds, then rest.
        let steps = (12.0 / trial.step) as u64;
        Trial { around, steps, promise: Promise::Settled(0.01), ..trial }
    })
}

/// A plate presses a body to a tenth of its height, and leaves it.
fn pressed() -> Trial {
    let (body, height) = (lattice(3, SIDE, 1.0), 3.0 * SIDE);
    let normal = -DVec3::new(0.05, 1.0, 0.03).normalize();
    let mut random = Random(4);
    let start = body.rest().iter().map(|&rest| rest + random.direction() * 1e-3 * SIDE).collect();
    let key = |time, depth: f64| Key { time, offset: Offset { shift: DVec3::Y * -depth, rotation: DVec3::ZERO } };
    // Oblique, it would touch a corner at the body's height.
    let keys = vec![key(0.0, -0.1 * height), key(0.5, 0.9 * height), key(1.0, -0.1 * height)];
    // Above the middle of the body, where the gap has its nominal width.
    let point = DVec3::new(0.5 * height, height, 0.5 * height);
    let plate = Obstacle {
        motion: Motion::Keys { keys, ease: Ease::Smooth, repeat: false },
        friction_of: FrictionOf::Velocity,
        ..obstacle(Shape::Plate { point, normal }, [0.0, 0.5])
    };
    let elastic = Elastic { over_mass: 1e5, ..USUAL };
    let name = "to a tenth of the height".to_owned();
    let trial = free("Pressed", name, body, State::at_rest(start), elastic, SIDE);
    let around = Surroundings { obstacles: vec![floor(0.0, 0.0, 0.5), plate], ..trial.around };
    Trial { around, steps: (3.0 / trial.step) as u64, ..trial }
}

/// Impacts: fast, of every stiffness, damping, distribution of masses, size and place. All but the first differ only in
/// units: the body meets the floor with `ω` sides per second, as after a fall of 5 m with k/m = 1e4.
fn hits() -> Vec<Trial> {
    let mut all = Vec::new();
    let alike = |name: String, body: Body, at: DVec3, elastic: Elastic, side: f64| {
        thrown("Impacts", name, body, at, side * elastic.over_mass.sqrt(), elastic, side)
    };
    for over_mass in [1e4, 1e5] {
        let (name, elastic) = (format!("100 m/s, k/m = {over_mass:e}"), Elastic { over_mass, ..USUAL });
        all.push(thrown("Impacts", name, lattice(3, SIDE, 1.0), DVec3::ZERO, 100.0, elastic, SIDE));
    }
    for over_mass in [1.0, 1e2, 1e6, 1e9] {
        let elastic = Elastic { over_mass, ..USUAL };
        all.push(alike(format!("k/m = {over_mass:e}"), lattice(3, SIDE, 1.0), DVec3::ZERO, elastic, SIDE));
    }
    for ratio in [0.0, 0.01, 1.0, 5.0] {
        let elastic = Elastic { ratio, ..USUAL };
        all.push(alike(format!("ζ = {ratio}"), lattice(3, SIDE, 1.0), DVec3::ZERO, elastic, SIDE));
    }
    let body = lattice(3, SIDE, 1.0);
    let last = body.len() as f64 - 1.0;
    let masses = (0..body.len()).map(|node| libm::exp10(6.0 * node as f64 / last)).collect();
    let body = body.with_masses(masses).expect("masses above 0");
    all.push(Trial {
        // The heaviest nodes oscillate a thousand times slower, and their damping ratio is a thousandth.
        steps: 100_000,
        promise: Promise::Bounded,
        ..alike("masses from 1 to 1e6 in one body".to_owned(), body, DVec3::ZERO, USUAL, SIDE)
    });
    for side in [1e-6, 1e6] {
        all.push(alike(format!("sides of {side:e} m"), lattice(3, side, 1.0), DVec3::ZERO, USUAL, side));
    }
    let far = DVec3::new(1e6, 1e6, -1e6);
    all.push(alike("1e6 m from the origin".to_owned(), lattice(3, SIDE, 1.0), far, USUAL, SIDE));
    all
}

/// Starts from which all shapes have to recover.
fn starts() -> Vec<Trial> {
    type Map = fn(DVec3, &mut Random) -> DVec3;
    let maps: [(&str, Map); 8] = [
        ("a point", |_, _| DVec3::ZERO),
        ("a line", |at, _| DVec3::X * at.x),
        ("a plane", |at, _| at.with_z(0.0)),
        ("a mirror image", |at, _| at * DVec3::new(1.0, 1.0, -1.0)),
        ("an inversion", |at, _| -at),
        ("a tenth of the height", |at, _| at * DVec3::new(1.0, 0.1, 1.0)),
        ("half a turn", |at, _| at * DVec3::new(-1.0, 1.0, -1.0)),
        ("random places", |_, random| random.direction() * (3.0 * SIDE * random.next())),
    ];
    let start = |(name, map): (&str, Map)| {
        let body = lattice(3, SIDE, 1.0);
        let mut random = Random(2);
        let middle = DVec3::splat(1.5 * SIDE);
        // Perfect symmetry would be an equilibrium, though not a stable one.
        let shift = |rest: &DVec3| Random(rest.x.to_bits()).direction() * 1e-3 * SIDE;
        let place = |rest: &DVec3| map(*rest - middle, &mut random) + shift(rest);
        let position = body.rest().iter().map(place).collect();
        let elastic = Elastic { ratio: 0.2, ..USUAL };
        free("Starts", name.to_owned(), body, State::at_rest(position), elastic, SIDE)
    };
    maps.into_iter().map(start).collect()
}

/// Single elements of unusual shapes, stretched and displaced at random.
fn elements() -> Vec<Trial> {
    let corners = |stretch: DVec3| -> Vec<DVec3> {
        (0..8u32).map(|bit| stretch * DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1)))).collect()
    };
    let ball = |count: usize| -> Vec<DVec3> {
        let mut random = Random(7);
        (0..count).map(|_| 0.5 * random.direction()).collect()
    };
    let mut twice = corners(DVec3::ONE);
    twice[7] = twice[6];
    let star = (0..10).map(|corner| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * f64::from(corner) / 10.0);
        DVec3::new(cosine, sine, 0.0) * if corner % 2 == 0 { 0.5 } else { 0.15 }
    });
    let sliver = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.0, 0.9), DVec3::new(0.5, 1e-3, 0.3)];
    let cases = [
        ("a bar of 2 nodes", Dimension::Space, vec![DVec3::ZERO, DVec3::X]),
        ("a triangle in space", Dimension::Space, vec![DVec3::ZERO, DVec3::X, DVec3::Y]),
        ("64 nodes", Dimension::Space, ball(64)),
        ("a sliver, 1 : 1000", Dimension::Space, sliver),
        ("a needle, 100 : 1 : 1", Dimension::Space, corners(DVec3::new(1.0, 0.01, 0.01))),
        ("two nodes at one place", Dimension::Space, twice),
        ("a triangle in the plane", Dimension::Plane, vec![DVec3::ZERO, DVec3::X, DVec3::Y]),
        ("a star in the plane", Dimension::Plane, star.collect()),
    ];
    let trial = |(name, dimension, rest): (&str, Dimension, Vec<DVec3>)| {
        let elements: IndexLists = [(0..rest.len() as u32).collect::<Vec<_>>()].iter().map(Vec::as_slice).collect();
        let mut random = Random(5);
        let stretch = DMat3::from_diagonal(DVec3::new(1.4, 0.7, 1.1));
        let flat = |vector: DVec3| if dimension == Dimension::Plane { vector.with_z(0.0) } else { vector };
        let position = rest.iter().map(|&at| stretch * at + flat(random.direction() * 0.1)).collect();
        let body = Body::builder(rest.clone())
            .dimension(dimension)
            .elements(elements)
            .solids(Solids::Convex)
            .build()
            .expect("a body");
        free("Elements", name.to_owned(), body, State::at_rest(position), USUAL, 1.0)
    };
    cases.into_iter().map(trial).collect()
}

/// Very many steps at rest on a level floor, and spinning.
fn long(steps: u64) -> [Trial; 2] {
    let body = lattice(2, SIDE, 1.0);
    let start = State::at_rest(body.rest().to_vec());
    let name = format!("{steps} steps");
    let rest = free("At rest", name.clone(), body.clone(), start, USUAL, SIDE);
    let around = Surroundings { gravity: DVec3::Y * -GRAVITY, obstacles: vec![floor(0.0, 0.5, 0.3)], ..rest.around };
    let rest = Trial { around, steps, promise: Promise::Settled(0.01), is_still: true, ..rest };
    let (spin, middle) = (DVec3::new(3.0, 10.0, -5.0), DVec3::splat(SIDE));
    let velocity = body.rest().iter().map(|&rest| spin.cross(rest - middle)).collect();
    let start = State::new(body.rest().to_vec(), velocity);
    let spun = free("Spinning", name, body, start, Elastic { ratio: 0.0, ..USUAL }, SIDE);
    // Centrifugal forces stretch it by a part of (spin/ω)², which is 0.013.
    [rest, Trial { steps, promise: Promise::Restored(0.1), ..spun }]
}

/// `cells`³ cubes of a side (m), with nodes of a mass (kg).
fn lattice(cells: u32, side: f64, mass: f64) -> Body {
    let (rest, elements) = contact::lattice([cells; 3], |at| at * side);
    let mass = vec![mass; rest.len()];
    Body::builder(rest).elements(elements).masses(mass).build().expect("a body")
}

fn floor(height: f64, restitution: f64, friction: f64) -> Obstacle {
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height }, [restitution, friction]);
    Obstacle { friction_of: FrictionOf::Velocity, ..floor }
}

/// The most elements that share a node.
fn most_elements(body: &Body) -> f64 {
    let mut count = vec![0u32; body.len()];
    body.elements().indices().iter().for_each(|&node| count[node as usize] += 1);
    f64::from(count.into_iter().max().unwrap_or(1))
}
