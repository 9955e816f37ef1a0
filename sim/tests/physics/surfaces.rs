//! Surfaces of bodies that meet: nothing goes through, and momentum, angular momentum and energy stay.

use glam::{DQuat, DVec3};
use localshape_sim::model::ElasticModel;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{
    Body, BodyContact, Contacts, Crew, Dimension, Ease, IndexLists, Integrator, Kernel, Key, Motion, Obstacle, Offset,
    PairContact, Shape, Side, State, Status, Stepping, Surroundings, World,
};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The side of a cell (m).
pub(super) const SIDE: f64 = 0.1;

/// A block of cubes of 1 kg, around the origin.
pub(super) fn block(cells: [u32; 3]) -> Arc<Body> {
    let nodes = cells.map(|cells| cells + 1);
    let number = |at: [u32; 3]| at[0] + nodes[0] * (at[1] + nodes[1] * at[2]);
    let grid =
        |[nx, ny, nz]: [u32; 3]| (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let half = DVec3::from_array(cells.map(f64::from)) * 0.5;
    let rest: Vec<_> = grid(nodes).map(|at| (DVec3::from_array(at.map(f64::from)) - half) * SIDE).collect();
    let mut elements = IndexLists::default();
    let mut mass = vec![0.0; rest.len()];
    for cell in grid(cells) {
        let corners =
            [0u32, 1, 2, 3, 4, 5, 6, 7].map(|bit| number([0, 1, 2].map(|axis| cell[axis] + (bit >> axis & 1))));
        corners.iter().for_each(|&node| mass[node as usize] += 0.125);
        elements.push(&corners);
    }
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a block"))
}

/// Where a body is, how it is turned, and how it moves.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub(super) at: DVec3,
    pub(super) turned: DQuat,
    pub(super) speed: DVec3,
}

/// Numbers from −1 to 1 that look random.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(super) fn turn(&mut self) -> DQuat {
        let [x, y, z, w] = [(); 4].map(|()| self.number());
        DQuat::from_xyzw(x, y, z, w).normalize()
    }
}

/// Bodies of a stiffness (N/m), with a step that is a share of the period of one element.
fn together(bodies: &[(Arc<Body>, Placed)], stiffness: f64, share: f64, around: Surroundings) -> World {
    by(Integrator::SemiImplicitEuler, Kernel::Fast, bodies, stiffness, share, around)
}

/// The same by any integrator and code. Rotations are exact, so that forces within elements have no torque.
pub(super) fn by(
    integrator: Integrator,
    kernel: Kernel,
    bodies: &[(Arc<Body>, Placed)],
    stiffness: f64,
    share: f64,
    around: Surroundings,
) -> World {
    let model = ShapeBased::new(stiffness);
    let mut all = State::default();
    for (body, Placed { at, turned, speed }) in bodies {
        all.position.extend(body.rest().iter().map(|&rest| *at + *turned * rest));
        all.velocity.extend(vec![*speed; body.len()]);
    }
    let parts: Vec<_> = bodies.iter().map(|(body, _)| (Arc::clone(body), &model as &dyn ElasticModel)).collect();
    let stepping = Stepping { kernel, ..Stepping::new(integrator, share * TAU / stiffness.sqrt()) };
    World::of_parts(&parts, all, around, stepping)
}

/// The triangles of the outer faces of a body, with faces of four corners as fans around their middles.
fn triangles(body: &Body, at: &[DVec3]) -> Vec<[DVec3; 3]> {
    let faces = body.faces();
    let mut all = Vec::new();
    for face in (0..faces.nodes.len()).filter(|&face| faces.outer[face].is_none()) {
        let corners: Vec<_> = faces.nodes[face].iter().map(|&node| at[node as usize]).collect();
        if let &[a, b, c] = &corners[..] {
            all.push([a, b, c]);
            continue;
        }
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        all.extend((0..corners.len()).map(|at| [corners[at], corners[(at + 1) % corners.len()], middle]));
    }
    all
}

fn pierces([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    if normal.dot(from - a) * normal.dot(to - a) >= 0.0 {
        return false;
    }
    let along = to - from;
    let [a, b, c] = [a, b, c].map(|corner| corner - from);
    let hands = [a.cross(b), b.cross(c), c.cross(a)].map(|side| along.dot(side));
    hands.iter().all(|&hand| hand > 0.0) || hands.iter().all(|&hand| hand < 0.0)
}

/// The pairs of triangles of two surfaces that cross.
fn crossings(bodies: [&Body; 2], at: [&[DVec3]; 2]) -> usize {
    let [one, other] = [0, 1].map(|side| triangles(bodies[side], at[side]));
    let extent = |t: &[DVec3; 3]| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let others: Vec<_> = other.iter().map(|t| (t, extent(t))).collect();
    let sides = |t: &[DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let mut count = 0;
    for mine in &one {
        let (low, high) = extent(mine);
        for (theirs, (least, most)) in &others {
            if low.cmple(*most).all() && least.cmple(high).all() {
                let cross = sides(mine).into_iter().any(|side| pierces(side, **theirs))
                    || sides(theirs).into_iter().any(|side| pierces(side, *mine));
                count += usize::from(cross);
            }
        }
    }
    count
}

/// The momentum (kg m/s), angular momentum (kg m²/s) and kinetic energy (J) of all nodes.
pub(super) fn moments(world: &World, mass: &[f64]) -> (DVec3, DVec3, f64) {
    let State { position, velocity, .. } = world.state();
    let mut sums = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for ((&at, &speed), &mass) in position.iter().zip(velocity).zip(mass) {
        sums.0 += speed * mass;
        sums.1 += at.cross(speed) * mass;
        sums.2 += 0.5 * mass * speed.length_squared();
    }
    sums
}

pub(super) fn with_contacts(restitution: f64, friction: f64) -> Surroundings {
    let contacts = Contacts { restitution, friction, ..Contacts::default() };
    Surroundings { contacts: Some(contacts), ..Surroundings::default() }
}

/// Two bodies of 27 cells that fly at each other with 10 m/s each, turned and offset at random.
fn impact(noise: &mut Noise, stiffness: f64, restitution: f64, friction: f64) -> ([Arc<Body>; 2], World) {
    let body = block([3; 3]);
    let placed = [-1.0, 1.0].map(|side| {
        let at = DVec3::new(side * 0.3, 0.1 * noise.number(), 0.1 * noise.number());
        Placed { at, turned: noise.turn(), speed: DVec3::X * (-10.0 * side) }
    });
    let bodies = placed.map(|placed| (Arc::clone(&body), placed));
    let world = together(&bodies, stiffness, 1.0 / 50.0, with_contacts(restitution, friction));
    ([Arc::clone(&body), body], world)
}

pub(super) fn still(at: DVec3) -> Placed {
    Placed { at, turned: DQuat::IDENTITY, speed: DVec3::ZERO }
}

/// Momentum and angular momentum in every step, for any restitution and friction, to round-off.
#[test]
fn momenta_stay() {
    for (round, [restitution, friction]) in (7..).zip([[1.0, 0.0], [0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [1.0, 1.0]]) {
        let (bodies, mut world) = impact(&mut Noise(round), 1e4, restitution, friction);
        let mass: Vec<_> = bodies.iter().flat_map(|body| body.mass().to_vec()).collect();
        let (momentum, spin, energy) = moments(&world, &mass);
        let scale = 27.0 * 10.0;
        for step in 0..400 {
            world.advance(1);
            let (now, turning, _) = moments(&world, &mass);
            let off = [(now - momentum).length() / scale, (turning - spin).length() / (scale * SIDE)];
            assert!(off.iter().all(|&off| off < 1e-12), "{restitution} {friction}: {off:?} in step {step}");
        }
        assert!(moments(&world, &mass).2 < 0.9 * energy, "they met");
    }
}

/// Two columns that fly at each other and part again.
#[test]
fn the_energy_of_a_rebound_stays() {
    let body = block([1, 6, 1]);
    let turns = [0.0, 0.3].map(DQuat::from_rotation_y);
    for (integrator, within) in [
        (Integrator::SemiImplicitEuler, 0.004),
        (Integrator::VelocityVerlet, 0.002),
        // Their forces do not know of the impulse within the step.
        (Integrator::Pefrl, 0.06),
        (Integrator::RungeKutta, 0.06),
    ] {
        for turned in turns {
            let bodies = [-1.0, 1.0].map(|side| {
                let turned = if side > 0.0 { turned } else { DQuat::IDENTITY };
                (Arc::clone(&body), Placed { at: DVec3::Y * (side * 0.35), speed: DVec3::Y * -side, turned })
            });
            let mut world = by(integrator, Kernel::Fast, &bodies, 1e4, 0.01, with_contacts(1.0, 0.0));
            let start = world.diagnostics().energy;
            world.advance(800);
            let off = world.diagnostics().energy / start - 1.0;
            assert!(off.abs() < within, "{integrator:?} {turned}: {off}");
            assert_eq!(world.status(), Status::Ok);
            let (one, other) = world.state().position.split_at(body.len());
            assert_eq!(crossings([&body, &body], [one, other]), 0);
        }
    }
}

/// No pair of triangles crosses in any of these frames, and without restitution no energy comes in but for the ripple of the integrator.
#[test]
fn edges_and_corners_do_not_cross() {
    let body = block([3; 3]);
    let around = |axis: DVec3| DQuat::from_axis_angle(axis, TAU / 8.0);
    let to = |from: DVec3| DQuat::from_rotation_arc(from.normalize(), DVec3::X);
    for (name, turned, far) in [
        ("crossed edges", [around(DVec3::Z), around(DVec3::X)], 0.5),
        ("edge on edge", [around(DVec3::Z), around(DVec3::Y)], 0.5),
        ("corner on corner", [to(DVec3::ONE), to(-DVec3::ONE)], 0.6),
    ] {
        for (restitution, stiffness) in [0.0, 0.5, 1.0].into_iter().flat_map(|e| [(e, 1e3), (e, 1e4)]) {
            let placed = |side: usize| {
                let sign = [-1.0, 1.0][side];
                let at = DVec3::X * (0.5 * sign * far);
                (Arc::clone(&body), Placed { at, turned: turned[side], speed: DVec3::X * (-5.0 * sign) })
            };
            let mut world = together(&[placed(0), placed(1)], stiffness, 0.02, with_contacts(restitution, 0.0));
            let start = world.diagnostics().energy;
            for _ in 0..150 {
                world.advance(2);
                let (one, other) = world.state().position.split_at(body.len());
                let text = format!("{name}, {restitution}, {stiffness} at step {}", world.steps());
                assert_eq!(crossings([&body, &body], [one, other]), 0, "{text}");
                let gained = world.diagnostics().energy / start - 1.0;
                assert!(gained < if restitution == 1.0 { 0.05 } else { 0.02 }, "{text}: {gained}");
            }
            assert_eq!(world.status(), Status::Ok);
        }
    }
}

/// The distance of a point from a shape (m), negative inside.
fn distance(shape: &Shape, point: DVec3) -> f64 {
    match *shape {
        Shape::Capsule { from, to, radius } => {
            let share = ((point - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
            point.distance(from.lerp(to, share)) - radius
        }
        Shape::Sphere { centre, radius } => point.distance(centre) - radius,
        Shape::Box { centre, half, rotation } => {
            let beyond = (rotation.conjugate() * (point - centre)).abs() - half;
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        }
        Shape::Floor { .. } | Shape::Plate { .. } => unreachable!("shapes with an extent"),
    }
}

/// Thin things are pressed down into a block on a floor, between its nodes, and go nowhere into it.
#[test]
fn what_is_pressed_into_a_block_stays_outside() {
    let body = block([6, 3, 6]);
    let thin = SIDE / 4.0;
    let corner = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Y);
    let rod = |[from, to]: [f64; 2]| Shape::Capsule {
        from: DVec3::new(-0.5, 0.2, from),
        to: DVec3::new(0.5, 0.2, to),
        radius: thin,
    };
    let shapes = [
        rod([0.02, 0.02]),
        rod([-0.33, 0.41]),
        Shape::Sphere { centre: DVec3::new(0.05, 0.2, 0.05), radius: thin },
        Shape::Box {
            centre: DVec3::new(0.03, 0.3, 0.01),
            half: DVec3::new(0.5, 0.1, 0.1),
            rotation: DQuat::from_rotation_x(TAU / 8.0),
        },
        Shape::Box { centre: DVec3::new(0.03, 0.35, 0.01), half: DVec3::splat(0.1), rotation: corner },
    ];
    for shape in shapes {
        let key =
            |time: f64, down: f64| Key { time, offset: Offset { shift: DVec3::Y * -down, rotation: DVec3::ZERO } };
        let motion = Motion::Keys { keys: vec![key(0.0, 0.0), key(1.0, 0.12)], ease: Ease::Smooth, repeat: false };
        let floor = Shape::Floor { normal: DVec3::Y, height: -0.15 };
        let obstacles = [(floor, Motion::Still), (shape.clone(), motion)].map(|(shape, motion)| Obstacle {
            shape,
            motion,
            pivot: DVec3::ZERO,
            restitution: 0.5,
            friction: 0.3,
            friction_of: Default::default(),
        });
        let around = Surroundings { obstacles: obstacles.to_vec(), ..with_contacts(0.5, 0.3) };
        let mut world = together(&[(Arc::clone(&body), still(DVec3::ZERO))], 1e4, 0.02, around);
        let mut least = f64::INFINITY;
        while world.steps() < 1000 {
            world.advance(4);
            let pose = obstacles[1].pose(world.steps() as f64 * 0.02 * TAU / 100.0);
            for [a, b, c] in triangles(&body, &world.state().position) {
                for (i, j) in (0..=4).flat_map(|i| (0..=4 - i).map(move |j| (i, j))) {
                    let [v, w] = [i, j].map(|k| f64::from(k) / 4.0);
                    let point = pose.undo(DVec3::ZERO, a + (b - a) * v + (c - a) * w);
                    least = least.min(distance(&shape, point));
                }
            }
        }
        // The distance that is kept is a fortieth of the mean length of edges, some .85 cells.
        assert!((0.019..0.025).contains(&(least / SIDE)), "{shape:?}: {least}");
    }
}

/// A U whose legs fly at each other.
#[test]
fn a_body_meets_itself() {
    let (wide, high) = (5u32, 6u32);
    let cells = (0..2).flat_map(|z| (0..high).flat_map(move |y| (0..wide).map(move |x| [x, y, z])));
    let mut numbers = BTreeMap::new();
    let (mut rest, mut elements) = (Vec::new(), IndexLists::default());
    for cell in cells.filter(|&[x, y, _]| y == 0 || x == 0 || x == wide - 1) {
        let corners = [0u32, 1, 2, 3, 4, 5, 6, 7].map(|bit| {
            let corner = [0, 1, 2].map(|axis| cell[axis] + (bit >> axis & 1));
            *numbers.entry(corner).or_insert_with(|| {
                rest.push(DVec3::from_array(corner.map(f64::from)) * SIDE);
                rest.len() as u32 - 1
            })
        });
        elements.push(&corners);
    }
    let mass = vec![1.0; rest.len()];
    let body = Arc::new(Body::builder(rest.clone()).elements(elements).masses(mass).build().expect("a U"));
    let towards = |at: &DVec3| if at.x < 0.25 { 3.0 } else { -3.0 };
    let velocity: Vec<_> = rest.iter().map(|at| DVec3::X * if at.y > 0.15 { towards(at) } else { 0.0 }).collect();
    for restitution in [0.0, 1.0] {
        let run = |itself: bool| {
            let mut around = with_contacts(restitution, 0.0);
            around.contacts.as_mut().expect("contacts").bodies = vec![BodyContact { itself, thickness: None }];
            let start = State::new(rest.clone(), velocity.clone());
            let stepping = Stepping::new(Integrator::SemiImplicitEuler, 0.02 * TAU / 100.0);
            let mut world = World::new(&body, start, &ShapeBased::new(1e4), around, stepping);
            let mut most = 0;
            for _ in 0..150 {
                world.advance(2);
                most = most.max(self_crossings(&body, &world.state().position));
            }
            most
        };
        assert_eq!(run(true), 0, "{restitution}");
        assert!(run(false) > 50, "without contact it goes through itself");
    }
}

fn self_crossings(body: &Body, at: &[DVec3]) -> usize {
    let all = triangles(body, at);
    let sides = |t: &[DVec3; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let cross = |one: &[DVec3; 3], other: &[DVec3; 3]| sides(one).into_iter().any(|side| pierces(side, *other));
    let pairs = all.iter().enumerate().flat_map(|(at, one)| all[at + 1..].iter().map(move |other| (one, other)));
    let apart = pairs.filter(|(one, other)| !one.iter().any(|a| other.contains(a)));
    apart.filter(|(one, other)| cross(one, other) || cross(other, one)).count()
}

/// Random impacts with 20 m/s, in which nodes move by up to most of a cell in a step, leave no bodies entangled.
#[test]
fn impacts_do_not_entangle() {
    for (stiffness, restitution) in [1e3, 1e4].into_iter().flat_map(|k| [0.0, 0.5, 1.0].map(|e| (k, e))) {
        for round in 100..106 {
            let (bodies, mut world) = impact(&mut Noise(round), stiffness, restitution, 0.0);
            let start = world.diagnostics().energy;
            world.advance(300);
            assert_eq!(world.status(), Status::Ok);
            let (one, other) = world.state().position.split_at(64);
            assert_eq!(crossings([&bodies[0], &bodies[1]], [one, other]), 0, "{stiffness} {restitution} {round}");
            let gained = world.diagnostics().energy / start - 1.0;
            assert!(
                gained < if restitution == 1.0 { 0.04 } else { 0.006 },
                "{stiffness} {restitution} {round}: {gained}"
            );
        }
    }
}

/// Squares in the plane stop at each other and at obstacles, corner on side.
#[test]
fn bodies_in_the_plane_stop_at_each_other() {
    /// The nodes around a square of four cells.
    const AROUND: [usize; 8] = [0, 1, 2, 5, 8, 7, 6, 3];
    let square = |cells: u32| {
        let across = cells + 1;
        let place = |at: u32| DVec3::new(f64::from(at % across), f64::from(at / across), 0.0);
        let rest = (0..across * across).map(|at| (place(at) - DVec3::new(1.0, 1.0, 0.0)) * SIDE).collect();
        let cell = |at: u32| {
            let low = at % cells + across * (at / cells);
            [low, low + 1, low + across + 1, low + across]
        };
        let all: Vec<_> = (0..cells * cells).map(cell).collect();
        let elements = all.iter().map(|cell| &cell[..]).collect();
        Arc::new(Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a square"))
    };
    let obstacle = |shape| Obstacle {
        shape,
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.0,
        friction_of: Default::default(),
    };
    let shapes = [
        Shape::Sphere { centre: DVec3::new(0.3, 0.02, 0.0), radius: 0.03 },
        Shape::Capsule { from: DVec3::new(0.3, 0.02, 0.0), to: DVec3::new(0.5, 0.02, 0.0), radius: 0.03 },
        Shape::Box {
            centre: DVec3::new(0.34, 0.02, 0.0),
            half: DVec3::new(0.1, 0.005, f64::INFINITY),
            rotation: DQuat::IDENTITY,
        },
    ];
    for (at, speed) in [0.0, 0.3].into_iter().enumerate() {
        let turned = [DQuat::from_rotation_z(speed), DQuat::from_rotation_z(TAU / 8.0)];
        let bodies = [-1.0, 1.0].map(|side| {
            let turned = turned[usize::from(side > 0.0)];
            (square(2), Placed { at: DVec3::X * (side * 0.2), turned, speed: DVec3::X * -side })
        });
        let mut world = together(&bodies, 1e4, 0.02, with_contacts(0.0, 0.3));
        for _ in 0..200 {
            world.advance(1);
            let (one, other) = world.state().position.split_at(9);
            let side = |of: &[DVec3], at: usize| [of[AROUND[at]], of[AROUND[(at + 1) % 8]]];
            let is_crossed = |[from, to]: [DVec3; 2], [a, b]: [DVec3; 2]| {
                let turn = |point: DVec3| (b - a).cross(point - a).z;
                turn(from) * turn(to) < 0.0
            };
            for (a, b) in (0..8).flat_map(|a| (0..8).map(move |b| (side(one, a), side(other, b)))) {
                assert!(!(is_crossed(a, b) && is_crossed(b, a)), "{at}: {a:?} {b:?} after {} steps", world.steps());
            }
        }
        assert!(world.state().velocity[..9].iter().map(|speed| speed.x).sum::<f64>() < 4.5, "they stopped each other");
    }
    for shape in shapes {
        let around = Surroundings { obstacles: vec![obstacle(shape.clone())], ..with_contacts(0.0, 0.0) };
        let body = (square(2), Placed { at: DVec3::X * 0.1, turned: DQuat::IDENTITY, speed: DVec3::X });
        let mut world = together(&[body], 1e4, 0.02, around);
        let mut least = f64::INFINITY;
        for _ in 0..200 {
            world.advance(1);
            // The right side, whose nodes are not where the obstacle is.
            let right = [2, 5, 8].map(|node| world.state().position[node]);
            for pair in right.windows(2) {
                let shares = (0..=20).map(|at| f64::from(at) / 20.0);
                least = shares.map(|share| distance(&shape, pair[0].lerp(pair[1], share))).fold(least, f64::min);
            }
        }
        assert!((0.0..0.05 * SIDE).contains(&least), "{shape:?}: {least}");
    }
}

/// Any number of threads, calls and codes gives the same, also where bodies run alone until they meet.
#[test]
fn steps_with_contact_have_the_same_bits_however_they_are_taken() {
    for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet, Integrator::Pefrl] {
        let body = block([3; 3]);
        let bodies = [-1.0, 1.0].map(|side| {
            let at = DVec3::new(side * 0.6, side * 0.02, 0.03);
            (Arc::clone(&body), Placed { at, turned: DQuat::from_rotation_z(side), speed: DVec3::X * (-5.0 * side) })
        });
        let run = |kernel: Kernel, threads: usize, calls: &[u64]| {
            let mut world = by(integrator, kernel, &bodies, 1e4, 0.02, with_contacts(0.5, 0.3));
            world.set_crew(Crew::new(threads));
            for &steps in calls {
                world.advance(steps);
                // What is known of the way so far is lost.
                let state = world.state().clone();
                world = world.clone();
                world.set_state(state);
            }
            world.state().clone()
        };
        let once = run(Kernel::Fast, 1, &[200]);
        for (threads, calls) in [(2, vec![200]), (8, vec![77, 123]), (1, vec![5; 40]), (2, vec![1; 200])] {
            assert!(run(Kernel::Fast, threads, &calls) == once, "{integrator:?} {threads} {calls:?}");
        }
        let plain = run(Kernel::Reference, 1, &[120]);
        let fast = run(Kernel::Fast, 1, &[120]);
        let far = plain.position.iter().zip(&fast.position).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(far < 1e-9, "{integrator:?}: {far:e}");
        let met = once.velocity[..64].iter().map(|speed| speed.x).sum::<f64>() / 64.0;
        assert!(met < 4.0, "they met: {met}");
    }
}

/// Blocks that fall on each other on a floor come to rest there.
#[test]
fn a_tower_rests() {
    let body = block([2; 3]);
    let floor = Obstacle {
        shape: Shape::Floor { normal: DVec3::Y, height: 0.0 },
        motion: Motion::Still,
        pivot: DVec3::ZERO,
        restitution: 0.0,
        friction: 0.5,
        friction_of: Default::default(),
    };
    let bodies = [0.0, 1.0, 2.0].map(|level| (Arc::clone(&body), still(DVec3::Y * (0.11 + 0.21 * level))));
    let around = Surroundings { gravity: DVec3::Y * -9.81, obstacles: vec![floor], ..with_contacts(0.0, 0.5) };
    let model = ShapeBased { damping: 30.0, ..ShapeBased::new(1e5) };
    let parts = bodies.clone().map(|(body, _)| (body, &model as &dyn ElasticModel));
    let places = bodies.iter().flat_map(|(body, placed)| body.rest().iter().map(|rest| placed.at + *rest));
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, 0.02 * TAU / 1e5f64.sqrt());
    let mut world = World::of_parts(&parts, State::at_rest(places.collect()), around, stepping);
    let step = 0.02 * TAU / 1e5f64.sqrt();
    world.advance((2.0 / step) as u64);
    let heights = |world: &World| {
        let means = world.state().position.chunks(27).map(|own| own.iter().map(|at| at.y).sum::<f64>() / 27.0);
        means.collect::<Vec<_>>()
    };
    let first = heights(&world);
    world.advance((1.0 / step) as u64);
    for (level, (before, after)) in first.iter().zip(heights(&world)).enumerate() {
        assert!((after - before).abs() < 0.01 * SIDE, "{level}: {before} {after}");
        // Each keeps its distance from the next.
        assert!((after - (0.1 + 0.2 * level as f64)).abs() < 0.1 * SIDE, "{level}: {after}");
    }
    let aside = world.state().position.iter().sum::<DVec3>() / 81.0;
    assert!(aside.x.abs().max(aside.z.abs()) < 0.001 * SIDE, "{aside}");
}

/// What a world does not take tells what is wrong.
#[test]
fn wrong_contacts_are_told() {
    let told = |contacts: Contacts| {
        let around = Surroundings { contacts: Some(contacts), ..Surroundings::default() };
        around.check(8).expect_err("a mistake").to_string()
    };
    let usual = Contacts::default;
    assert_eq!(
        told(Contacts { restitution: 1.5, ..usual() }),
        "the restitution of contact 0 is 1.5; expected a number from 0 to 1"
    );
    assert!(told(Contacts { friction: f64::NAN, ..usual() }).starts_with("the friction of contact 0 is NaN"));
    let thin = BodyContact { thickness: Some(-0.1), itself: false };
    let bodies = vec![BodyContact::default(), thin];
    assert_eq!(
        told(Contacts { bodies, ..usual() }),
        "the thickness of contact 1 is -0.1; expected a finite number above 0 (m)"
    );
    let of = [Side::Body(0), Side::Obstacle(2)];
    let pair = PairContact { of, restitution: None, friction: None, thickness: None };
    assert!(told(Contacts { pairs: vec![pair], ..usual() }).contains("Obstacle(2)"));
    let fine = Surroundings { contacts: Some(usual()), ..Surroundings::default() };
    assert_eq!(fine.check(8), Ok(()));
}

/// A block on two rollers that turn moves along with their surfaces.
#[test]
fn rollers_carry_a_block() {
    let body = block([3, 1, 2]);
    let roller = |x: f64| Obstacle {
        shape: Shape::Capsule { from: DVec3::new(x, -0.1, -0.3), to: DVec3::new(x, -0.1, 0.3), radius: 0.045 },
        motion: Motion::Keys {
            keys: [(0.0, 0.0), (1.0, -10.0)]
                .map(|(time, turn)| Key { time, offset: Offset { shift: DVec3::ZERO, rotation: DVec3::Z * turn } })
                .to_vec(),
            ease: Ease::Linear,
            repeat: false,
        },
        pivot: DVec3::new(x, -0.1, 0.0),
        restitution: 0.0,
        friction: 1.0,
        friction_of: Default::default(),
    };
    let obstacles = (-2..6).map(|at| roller(0.11 * f64::from(at))).collect();
    let around = Surroundings { gravity: DVec3::Y * -9.81, obstacles, ..with_contacts(0.0, 0.0) };
    let mut world = together(&[(Arc::clone(&body), still(DVec3::ZERO))], 1e4, 0.02, around);
    world.advance((0.5 / (0.02 * TAU / 100.0)) as u64);
    let speed = world.state().velocity.iter().map(|speed| speed.x).sum::<f64>() / body.len() as f64;
    // The surface moves at 10 /s × .045 m; the bumps between the rollers change that a little.
    assert!((0.42..0.48).contains(&speed), "{speed}");
}
