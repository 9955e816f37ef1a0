//! Surfaces of bodies that meet: nothing goes through, and momentum, angular momentum and energy stay.

use super::support::shape_based;
use glam::{DQuat, DVec3};
use localshape_sim::model::ElasticModel;
use localshape_sim::{
    Body, Contacts, Crew, IndexLists, Integrator, Kernel, State, Status, Stepping, Surroundings, World,
};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The side of a cell (m).
const SIDE: f64 = 0.1;

/// A block of cubes of 1 kg, around the origin.
pub(crate) fn block(cells: [u32; 3]) -> Arc<Body> {
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
pub(crate) struct Placed {
    pub(crate) at: DVec3,
    pub(crate) turned: DQuat,
    pub(crate) speed: DVec3,
}

/// Numbers from −1 to 1 that look random.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        let [x, y, z] = [(); 3].map(|()| self.number());
        DVec3::new(x, y, z)
    }

    pub(crate) fn turn(&mut self) -> DQuat {
        let [x, y, z, w] = [(); 4].map(|()| self.number());
        DQuat::from_xyzw(x, y, z, w).normalize()
    }
}

/// Bodies of a stiffness (N/m) in free space, with a step that is a share of the period of one element.
pub(crate) fn together(bodies: &[(Arc<Body>, Placed)], stiffness: f64, share: f64, around: Surroundings) -> World {
    let model = shape_based(stiffness, 0.0);
    let step = share * TAU / stiffness.sqrt();
    let mut all = State::default();
    for (body, Placed { at, turned, speed }) in bodies {
        all.position.extend(body.rest().iter().map(|&rest| *at + *turned * rest));
        all.velocity.extend(vec![*speed; body.len()]);
    }
    let parts: Vec<_> = bodies.iter().map(|(body, _)| (Arc::clone(body), &model as &dyn ElasticModel)).collect();
    World::of_parts(&parts, all, around, Stepping::new(Integrator::SemiImplicitEuler, step))
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
pub(crate) fn crossings(bodies: [&Body; 2], at: [&[DVec3]; 2]) -> usize {
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
pub(crate) fn moments(world: &World, mass: &[f64]) -> (DVec3, DVec3, f64) {
    let State { position, velocity, .. } = world.state();
    let mut sums = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for ((&at, &speed), &mass) in position.iter().zip(velocity).zip(mass) {
        sums.0 += speed * mass;
        sums.1 += at.cross(speed) * mass;
        sums.2 += 0.5 * mass * speed.length_squared();
    }
    sums
}

fn with_contacts(restitution: f64, friction: f64) -> Surroundings {
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

/// Momentum in every step, and angular momentum without friction and at restitution 1, to round-off.
#[test]
fn momenta_stay() {
    for (round, [restitution, friction]) in
        [[1.0, 0.0], [0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [1.0, 1.0]].into_iter().enumerate()
    {
        let mut noise = Noise(7 + round as u64);
        let (bodies, mut world) = impact(&mut noise, 1e4, restitution, friction);
        let mass: Vec<_> = bodies.iter().flat_map(|body| body.mass().to_vec()).collect();
        let (momentum, spin, _) = moments(&world, &mass);
        let scale = 27.0 * 10.0;
        let mut worst = [0.0f64; 2];
        for _ in 0..400 {
            world.advance(1);
            let (now, turning, _) = moments(&world, &mass);
            worst[0] = worst[0].max((now - momentum).length() / scale);
            worst[1] = worst[1].max((turning - spin).length() / (scale * SIDE));
        }
        assert_eq!(world.status(), Status::Ok);
        eprintln!("e {restitution} mu {friction}: momentum {:e} angular {:e}", worst[0], worst[1]);
    }
}

#[test]
fn impacts_do_not_entangle() {
    for stiffness in [1e3, 1e4] {
        for restitution in [0.0, 0.5, 1.0] {
            let mut entangled = 0;
            let mut ever = 0;
            for round in 0..12 {
                let mut noise = Noise(100 + round);
                let (bodies, mut world) = impact(&mut noise, stiffness, restitution, 0.0);
                let mass: Vec<_> = bodies.iter().flat_map(|body| body.mass().to_vec()).collect();
                let start = moments(&world, &mass).2;
                let mut most = 0;
                let count = |world: &World| {
                    let (one, other) = world.state().position.split_at(64);
                    crossings([&bodies[0], &bodies[1]], [one, other])
                };
                for _ in 0..200 {
                    world.advance(2);
                    most = most.max(count(&world));
                }
                let last = count(&world);
                assert_eq!(world.status(), Status::Ok);
                ever += usize::from(most > 0);
                entangled += usize::from(last > 0);
                let end = moments(&world, &mass).2;
                eprintln!(
                    "k {stiffness} e {restitution} round {round}: most {most} last {last} energy {:.4}",
                    end / start
                );
            }
            eprintln!("k {stiffness} e {restitution}: entangled {entangled} ever {ever}");
        }
    }
}

#[test]
fn kernels_and_threads_agree() {
    let _ = (Crew::new(1), Kernel::Fast);
}
