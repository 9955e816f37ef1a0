//! Forces of contact and of constraints: what they add up to, and that asking for them changes nothing.

use super::INTEGRATORS;
use super::support::{lattice, shape_based};
use super::surfaces::{Noise, Placed, SIDE, block, by, moments, still, with_contacts};
use glam::{DQuat, DVec3};
use localshape_sim::model::ElasticModel;
use localshape_sim::model::xpbd::Xpbd;
use localshape_sim::{
    Body, BodyContact, ContactPoint, Contacts, Course, Crew, Diagnostic, Ease, Grip, Integrator, Kernel, Key, Load,
    Loading, Moment, Motion, Obstacle, Offset, Reaction, Shape, Side, Source, State, Status, Stepping, Surroundings,
    World,
};
use std::sync::Arc;

const GRAVITY: DVec3 = DVec3::new(0.3, -9.8, 0.1);

/// A load on the first node of each of the blocks below (N).
const PUSH: DVec3 = DVec3::new(4.0, -2.0, 1.0);

fn obstacle(shape: Shape) -> Obstacle {
    let motion = Motion::Still;
    Obstacle { shape, motion, pivot: DVec3::ZERO, restitution: 0.2, friction: 0.4, friction_of: Default::default() }
}

/// What holds a corner of the first of the blocks below and drags one of the third.
fn grips(bodies: &[Arc<Body>]) -> Vec<Grip> {
    let last = (bodies[0].len() + bodies[1].len()) as u32;
    let shift = DVec3::new(0.02, 0.05, -0.01);
    let key = |time: f64, shift: DVec3| Key { time, offset: Offset { shift, ..Offset::default() } };
    let keys = vec![key(0.01, DVec3::ZERO), key(0.4, shift)];
    vec![
        Grip { nodes: vec![0, 1, 3], from: 0.0, until: f64::INFINITY, motion: Motion::Still },
        Grip {
            nodes: vec![last, last + 2],
            from: 0.01,
            until: 0.4,
            motion: Motion::Keys { keys, ease: Ease::Smooth, repeat: false },
        },
    ]
}

/// Three blocks that are pushed and fall on each other, on a floor, a plate and a ball, gripped or free.
fn heap(integrator: Integrator, kernel: Kernel, has_surfaces: bool, is_gripped: bool) -> (Vec<Arc<Body>>, World) {
    let mut noise = Noise(5);
    let bodies: Vec<_> = (0..3u32)
        .map(|at| {
            let place = DVec3::new(0.12 * f64::from(at % 2), 0.16 + 0.34 * f64::from(at), 0.05 * noise.number());
            let placed = Placed { at: place, turned: noise.turn(), speed: DVec3::Y * -2.0 };
            (block([2, 1 + at, 2]), if at == 0 { still(DVec3::Y * 0.06) } else { placed })
        })
        .collect();
    let obstacles = vec![
        obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 }),
        obstacle(Shape::Plate { point: DVec3::X * 0.3, normal: -DVec3::X }),
        obstacle(Shape::Sphere { centre: DVec3::new(-0.15, 0.1, 0.0), radius: 0.04 }),
    ];
    let all: Vec<_> = bodies.iter().map(|(body, _)| Arc::clone(body)).collect();
    let grips = if is_gripped { grips(&all) } else { Vec::new() };
    let first = |at: usize| all[..at].iter().map(|body| body.len() as u32).sum();
    let push = Loading::dead((0..all.len()).map(first).collect(), vec![PUSH; all.len()], Course::ALWAYS);
    let loads: Vec<Arc<dyn Load>> = vec![Arc::new(push)];
    let around = Surroundings { gravity: GRAVITY, obstacles, grips, loads, ..with_contacts(0.3, 0.4) };
    let around = if has_surfaces { around } else { Surroundings { contacts: None, ..around } };
    let world = by(integrator, kernel, &bodies, 2e3, 0.02, around);
    (all, world)
}

fn is_fast(integrator: Integrator) -> bool {
    !matches!(integrator, Integrator::RungeKutta | Integrator::DormandPrince | Integrator::BackwardEuler)
}

/// Nodes that one grip lets go while another holds on feel obstacles from then on, however many steps are taken at once.
#[test]
fn released_nodes_feel_obstacles_at_once() {
    const STEPS: u64 = 200;
    const STEP: f64 = 1e-3;
    let body = lattice(1, 0.1);
    let [top, bottom] = [0.1, 0.0]
        .map(|y| -> Vec<u32> { (0..8).filter(|&node| (body.rest()[node as usize].y - y).abs() < 1e-9).collect() });
    let lift = |nodes: &[u32], until| Grip { nodes: nodes.to_vec(), from: 0.0, until, motion: Motion::Still };
    let grips = vec![lift(&top, f64::INFINITY), lift(&bottom, 10.5 * STEP)];
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 });
    let around = Surroundings { gravity: GRAVITY, grips, obstacles: vec![floor], ..Surroundings::default() };
    // Stretched upwards, so that the elements pull the lower nodes to the floor.
    let stretched = body.rest().iter().map(|&at| at + DVec3::Y * if at.y < 0.05 { 0.04 } else { 0.0 }).collect();
    for kernel in [Kernel::Fast, Kernel::Reference] {
        let stepping = Stepping { kernel, ..Stepping::new(Integrator::default(), STEP) };
        let start = State::at_rest(Vec::clone(&stretched));
        let mut world = World::new(&body, start, &shape_based(1e3, 1.0), around.clone(), stepping);
        world.keep_reactions(Moment::at(STEPS as f64 * STEP));
        world.advance(STEPS);
        let forces = world.reactions().expect("an interval has ended");
        let momentum: DVec3 = world.state().velocity.iter().zip(body.mass()).map(|(&speed, &mass)| speed * mass).sum();
        let (mass, time) = (body.mass().iter().sum::<f64>(), STEPS as f64 * STEP);
        let force: DVec3 = forces.iter().map(|one| one.force).sum();
        let off = momentum - (GRAVITY * mass + force) * time;
        assert!(off.length() < 1e-12 * mass, "{kernel:?}: {off}");
        assert!(forces.iter().any(|one| matches!(one.from, Source::Obstacle(0)) && one.force.y > 0.0), "{forces:?}");
    }
}

/// Of each body, gravity, loads, contact and constraints change the momentum to round-off, with every integrator, code and rule; a pair pushes itself
/// nowhere.
#[test]
fn forces_are_the_change_of_momentum() {
    let all = INTEGRATORS.into_iter().flat_map(|one| [(one, true, true), (one, false, true)]);
    let free = [true, false].map(|has_surfaces| (Integrator::SemiImplicitEuler, has_surfaces, false));
    for (integrator, has_surfaces, is_gripped) in all.chain(free) {
        for kernel in [Kernel::Fast, Kernel::Reference] {
            if kernel == Kernel::Fast && !is_fast(integrator) {
                continue;
            }
            let (bodies, mut world) = heap(integrator, kernel, has_surfaces, is_gripped);
            let step = 0.02 * std::f64::consts::TAU / 2e3f64.sqrt();
            world.keep_reactions(Moment::at(7.0 * step));
            let count = match integrator {
                Integrator::ExplicitEuler => 5,
                // Hundreds of steps of its own in each.
                Integrator::DormandPrince => 12,
                _ => 40,
            };
            let momenta = |world: &World| {
                let State { position, velocity, .. } = world.state();
                let mut first = 0;
                let of = |body: &Arc<Body>| {
                    let own = first..first + body.len();
                    first = own.end;
                    let part = State::new(position[own.clone()].to_vec(), velocity[own].to_vec());
                    part.velocity.iter().zip(body.mass()).map(|(&speed, &mass)| speed * mass).sum::<DVec3>()
                };
                bodies.iter().map(of).collect::<Vec<_>>()
            };
            let mut before = momenta(&world);
            assert_eq!(world.reactions(), None);
            let mut most: f64 = 0.0;
            for _ in 0..count {
                world.advance(7);
                let (now, forces) = (momenta(&world), world.reactions().expect("an interval has ended"));
                let about = format!("{integrator:?} {kernel:?} {has_surfaces} at step {}", world.steps());
                for (at, body) in bodies.iter().enumerate() {
                    let mass: f64 = body.mass().iter().sum();
                    let force: DVec3 = forces.iter().filter(|one| one.on == at).map(|one| one.force).sum();
                    let off = now[at] - before[at] - (GRAVITY * mass + PUSH + force) * (7.0 * step);
                    assert!(off.length() < 1e-12 * mass * 3.0, "{about}: {off} of body {at}");
                    most = most.max(force.length());
                }
                for Reaction { from, on, force, torque } in &forces {
                    let Source::Body(from) = *from else { continue };
                    let back = forces.iter().find(|one| (one.from, one.on) == (Source::Body(*on), from)).expect("both");
                    assert!((back.force + *force).length() <= 1e-12 * (1.0 + force.length()), "{about}");
                    let is_turned_back = integrator == Integrator::SemiImplicitEuler && !is_gripped;
                    let off = (back.torque + *torque).length();
                    assert!(!is_turned_back || off <= 1e-12 * (1.0 + force.length()), "{about}: {off}");
                    assert!(has_surfaces || *force == DVec3::ZERO);
                }
                before = now;
            }
            assert!(most > 20.0 && world.status() == Status::Ok, "{integrator:?} {kernel:?} {has_surfaces}: {most}");
        }
    }
}

/// A body that is moved by constraints in place of forces, between a hold and a node that is dragged: their forces, gravity and a load are the
/// change of momentum. Two holds at its ends share its weight.
#[test]
fn constraints_of_a_model_push_what_holds_its_nodes() {
    const STEP: f64 = 1e-3;
    let (body, model) = (lattice(2, 0.1), Xpbd::new(shape_based(2e4, 0.0)));
    let mass: f64 = body.mass().iter().sum();
    let side = |x: f64| (0..27).filter(|&node| (body.rest()[node as usize].x - x).abs() < 1e-9).collect::<Vec<u32>>();
    let still = |nodes: Vec<u32>| Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still };
    let [_, dragged] = grips(&[0; 3].map(|_| lattice(2, 0.1))).try_into().expect("two");
    let push = Arc::new(Loading::dead(vec![13], vec![PUSH], Course::ALWAYS)) as Arc<dyn Load>;
    for (other, loads) in [(Grip { nodes: side(0.2), ..dragged }, vec![push]), (still(side(0.2)), Vec::new())] {
        let around = Surroundings { gravity: GRAVITY, grips: vec![still(side(0.0)), other], ..Surroundings::default() };
        let pushed = if loads.is_empty() { DVec3::ZERO } else { PUSH };
        let start = State::at_rest(body.rest().to_vec());
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, STEP);
        let mut world = World::new(&body, start, &model, Surroundings { loads, ..around }, stepping);
        world.keep_reactions(Moment::at(50.0 * STEP));
        let momentum = |world: &World| moments(world, body.mass()).0;
        let mut before = momentum(&world);
        for _ in 0..60 {
            world.advance(50);
            let force: DVec3 = world.reactions().expect("an interval has ended").iter().map(|one| one.force).sum();
            let off = momentum(&world) - before - (GRAVITY * mass + pushed + force) * (50.0 * STEP);
            assert!(off.length() < 1e-12 * mass, "{off} at step {}", world.steps());
            before = momentum(&world);
        }
        let [one, other] = world.reactions().expect("both")[..] else { panic!("two grips") };
        let half = -0.5 * GRAVITY.y * mass;
        let share = [one.force.y, other.force.y].map(|force| (force - half).abs() / half);
        // It has no damping but that of its steps, and still trembles.
        assert!(pushed != DVec3::ZERO || share.iter().all(|&off| off < 1e-3), "{share:?}");
    }
}

/// Torques are the change of angular momentum of two bodies that hit each other, with friction.
#[test]
fn torques_are_the_change_of_angular_momentum() {
    let body = block([3, 2, 3]);
    let mut noise = Noise(3);
    let placed = [-1.0, 1.0].map(|side| {
        let at = DVec3::new(0.3 * side, 0.1 * noise.number(), 0.1 * noise.number());
        (Arc::clone(&body), Placed { at, turned: noise.turn(), speed: DVec3::X * (-3.0 * side) })
    });
    let mut world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &placed, 1e4, 0.02, with_contacts(0.8, 0.4));
    let time = 300.0 * 0.02 * std::f64::consts::TAU / 100.0;
    world.keep_reactions(Moment::at(time));
    let of_one = |world: &World| {
        let State { position, velocity, .. } = world.state();
        let nodes = position.iter().zip(velocity).zip(body.mass());
        nodes.map(|((at, &speed), &mass)| at.cross(speed * mass)).sum::<DVec3>()
    };
    let start = of_one(&world);
    world.advance(300);
    let forces = world.reactions().expect("an interval has ended");
    let torque = forces.iter().find(|one| one.on == 0).expect("a pair").torque;
    let (gained, told) = (of_one(&world) - start, torque * time);
    assert!(gained.length() > 0.5 && (gained - told).length() < 1e-10, "{gained} {told}");
    assert!((world.diagnostics_by_body(&[Diagnostic::ContactTorque]).1[0].contact_torque - torque).length() < 1e-12);
}

/// States have the same bits with and without, however steps and threads are divided; and so have the forces.
#[test]
fn asking_changes_no_bit() {
    for integrator in INTEGRATORS {
        // More than an interval. The method with steps of its own takes hundreds of them in each of these.
        let all = if integrator == Integrator::DormandPrince { 24 } else { 90 };
        for (kernel, has_surfaces) in [(Kernel::Fast, true), (Kernel::Fast, false), (Kernel::Reference, true)] {
            let (_, mut plain) = heap(integrator, kernel, has_surfaces, true);
            plain.advance(all);
            let told = |threads: usize, ways: &[u64], is_cut: bool| {
                let (_, mut world) = heap(integrator, kernel, has_surfaces, true);
                world.set_crew(Crew::new(threads));
                world.keep_reactions(Moment { count: 1.0, rate: 20.0 });
                for &way in ways {
                    world.advance(way);
                    if is_cut {
                        let state = State::from_bytes(&world.state().to_bytes()).expect("what was written");
                        world = heap(integrator, kernel, has_surfaces, true).1;
                        world.keep_reactions(Moment { count: 1.0, rate: 20.0 });
                        world.set_state(state);
                    }
                }
                (world.state().clone(), world.reactions())
            };
            let first = told(1, &[all], false);
            assert_eq!(first.0.position, plain.state().position, "{integrator:?} {kernel:?} {has_surfaces}");
            assert_eq!(first.0.velocity, plain.state().velocity, "{integrator:?} {kernel:?} {has_surfaces}");
            assert!(first.1.is_some());
            assert_eq!(
                told(3, &[1, all / 2, 3, all / 2 - 4], false),
                first,
                "{integrator:?} {kernel:?} {has_surfaces}"
            );
            assert_eq!(told(2, &[all / 6, all / 3, all / 2], true), first, "{integrator:?} {kernel:?} {has_surfaces}");
        }
    }
}

/// At rest the floor carries the weight; nodes that are held feel nothing.
#[test]
fn the_floor_carries_the_weight() {
    let body = block([3, 2, 3]);
    for (has_surfaces, is_held) in [(true, false), (false, false), (false, true)] {
        let around = Surroundings {
            gravity: DVec3::Y * -9.8,
            obstacles: vec![obstacle(Shape::Floor { normal: DVec3::Y, height: -0.5 * 2.0 * SIDE })],
            contacts: has_surfaces.then(Contacts::default),
            ..Surroundings::default()
        };
        let nodes = (0..body.len() as u32).collect();
        let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::at(Offset::default()) };
        let grips = if is_held { vec![grip] } else { Vec::new() };
        let placed = Placed { at: DVec3::ZERO, turned: DQuat::IDENTITY, speed: DVec3::ZERO };
        let around = Surroundings { grips, ..around };
        let mut world = by(Integrator::VelocityVerlet, Kernel::Fast, &[(Arc::clone(&body), placed)], 3e4, 0.02, around);
        world.keep_reactions(Moment::at(2.0));
        world.advance((4.0 / (0.02 * std::f64::consts::TAU / 3e4f64.sqrt())) as u64 + 2);
        let points = world.contact_points();
        let is_below =
            |point: &ContactPoint| (point.from, point.on) == (Side::Obstacle(0), 0) && point.at.y < -SIDE * 0.98;
        assert!(points.len() == 16 && points.iter().all(is_below), "{points:?}");
        let mass: f64 = body.mass().iter().sum();
        let (force, momentum) = (world.diagnostics().contact_force, moments(&world, body.mass()).0);
        let expected = if is_held { DVec3::ZERO } else { DVec3::Y * (9.8 * mass) };
        assert!(
            (force - expected).length() <= 1e-2 * expected.length(),
            "{has_surfaces} {is_held}: {force} {momentum}"
        );
    }
}

/// What holds a beam carries its weight and its load, and their torque.
#[test]
fn a_hold_carries_weight_and_load() {
    let (body, load) = (lattice(2, 0.1), DVec3::new(3.0, -2.0, 1.0));
    for (model, integrator) in [
        (Arc::new(shape_based(2e4, 60.0)) as Arc<dyn ElasticModel>, Integrator::SemiImplicitEuler),
        (Arc::new(shape_based(2e4, 60.0)), Integrator::RungeKutta),
        (Arc::new(shape_based(2e4, 60.0)), Integrator::BackwardEuler),
    ] {
        let nodes: Vec<u32> = (0..body.len() as u32).filter(|node| node % 3 == 0).collect();
        let grip = Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still };
        let pull = Loading::dead(vec![26], vec![load], Course::ALWAYS);
        let loads = vec![Arc::new(pull) as Arc<dyn Load>];
        let around = Surroundings { gravity: DVec3::Y * -9.8, grips: vec![grip], loads, ..Surroundings::default() };
        let start = State::at_rest(body.rest().to_vec());
        let mut world = World::new(&body, start, &*model, around, Stepping::new(integrator, 1e-3));
        world.keep_reactions(Moment::at(0.1));
        world.advance(3000);
        let diagnostics = world.diagnostics();
        assert!(diagnostics.contact_force.is_nan());
        let weights =
            || world.state().position.iter().zip(body.mass()).map(|(&at, &mass)| (at, DVec3::Y * (-9.8 * mass)));
        let (force, torque) = weights()
            .chain([(world.state().position[26], load)])
            .fold((DVec3::ZERO, DVec3::ZERO), |(sum, turn), (at, force)| (sum - force, turn - at.cross(force)));
        let off = [diagnostics.hold_force - force, diagnostics.hold_torque - torque].map(DVec3::length);
        // Backward Euler ends its search before the last digits.
        let small = if integrator == Integrator::BackwardEuler { 3e-5 } else { 1e-7 };
        assert!(off[0] < small * force.length() && off[1] < small * torque.length(), "{integrator:?}: {off:?}");
    }
}

/// Two equal faces above each other touch at their 16 nodes and 9 middles, up to 1.1 times the distance that is kept.
#[test]
fn points_of_contact_are_where_surfaces_touch() {
    const GAP: f64 = 0.002;
    for (times, count) in [(1.0, 25), (1.09, 25), (1.11, 0)] {
        let body = block([3, 2, 3]);
        let placed = [0.0, 2.0 * SIDE + GAP * times].map(|height| (Arc::clone(&body), still(DVec3::Y * height)));
        let thin = BodyContact { thickness: Some(GAP / 2.0), ..BodyContact::default() };
        let contacts = Contacts { bodies: vec![thin; 2], ..Contacts::default() };
        let around = Surroundings { contacts: Some(contacts), ..Surroundings::default() };
        let world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &placed, 1e3, 0.02, around);
        let points = world.contact_points();
        let is_between =
            |point: &ContactPoint| (point.from, point.on) == (Side::Body(1), 0) && (point.at.y - SIDE).abs() < 1e-9;
        assert!(points.len() == count && points.iter().all(is_between), "{times}: {points:?}");
    }
}

/// Two bodies that cross share the same crossings, and each has them among its own diagnostics.
#[test]
fn crossings_belong_to_both_bodies() {
    let body = block([1; 3]);
    let placed = [DVec3::ZERO, DVec3::new(0.5, 0.3, 0.2) * SIDE].map(|at| (Arc::clone(&body), still(at)));
    let world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &placed, 1e3, 0.02, with_contacts(0.0, 0.0));
    let [(sides, count)] = &world.crossings().expect("surfaces")[..] else { panic!("one pair") };
    assert!(*sides == [Side::Body(0), Side::Body(1)] && *count > 4);
    let (all, of_each) = world.diagnostics_by_body(&[Diagnostic::Crossings]);
    assert_eq!([all.crossings, of_each[0].crossings, of_each[1].crossings], [*count as f64; 3]);
}

/// A body that lies inside another one crosses none of its facets, and yet is told.
#[test]
fn a_body_inside_another_is_told() {
    let (small, large) = (block([1; 3]), block([4; 3]));
    for (at, expected) in [(0.0, 24), (1.0, 24), (6.0, 0)] {
        let placed = [(Arc::clone(&large), still(DVec3::ZERO)), (Arc::clone(&small), still(DVec3::X * (at * SIDE)))];
        let mut bodies = placed.to_vec();
        for _ in 0..2 {
            let world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &bodies, 1e3, 0.02, with_contacts(0.0, 0.0));
            let count: usize = world.crossings().expect("surfaces").iter().map(|(_, count)| count).sum();
            assert_eq!(count, expected, "{at}");
            bodies.reverse();
        }
    }
    let half = DVec3::splat(3.0 * SIDE);
    let shape = Shape::Box { centre: DVec3::ZERO, half, rotation: DQuat::IDENTITY };
    for (at, expected) in [(0.0, 24), (6.0, 0)] {
        let around = Surroundings { obstacles: vec![obstacle(shape.clone())], ..with_contacts(0.0, 0.0) };
        let placed = [(Arc::clone(&small), still(DVec3::X * (at * SIDE)))];
        let world = by(Integrator::SemiImplicitEuler, Kernel::Fast, &placed, 1e3, 0.02, around);
        let count: usize = world.crossings().expect("surfaces").iter().map(|(_, count)| count).sum();
        assert_eq!(count, expected, "{at} from a box");
    }
}

/// A state that is taken brings its sums, and one without sums begins anew.
#[test]
fn forces_go_on_with_the_state_that_has_them() {
    let begin = || heap(Integrator::SemiImplicitEuler, Kernel::Fast, true, true).1;
    let every = Moment { count: 1.0, rate: 20.0 };
    let mut whole = begin();
    whole.keep_reactions(every);
    whole.advance(130);
    let state = whole.state().clone();
    let mut late = begin();
    late.set_state(state);
    late.keep_reactions(every);
    assert!(late.reactions().is_some() && late.reactions() == whole.reactions());
    [&mut whole, &mut late].into_iter().for_each(|world| world.advance(30));
    assert_eq!(late.reactions(), whole.reactions());
    whole.set_state(begin().state().clone());
    whole.advance(1);
    assert_eq!(whole.reactions(), None);
}
