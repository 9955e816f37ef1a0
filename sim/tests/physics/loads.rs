//! Loads: their forces, their work with every method, and the same bits however steps are divided.

use super::INTEGRATORS;
use super::support::{bricks, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::{ElasticModel, linear};
use localshape_sim::{
    Body, Course, Diagnostic, Diagnostics, Ease, Grip, Integrator, Kernel, Load, Loading, Material, Moment, Motion,
    Springs, State, Stepping, Surroundings, World, for_each_area,
};
use std::sync::Arc;

const STEP: f64 = 1e-3;

/// The sides of the surface of a body.
fn surface(body: &Body) -> Vec<Vec<u32>> {
    let faces = body.faces();
    let outside = (0..faces.nodes.len()).filter(|&face| faces.outer[face].is_none());
    outside.map(|face| faces.nodes[face].to_vec()).collect()
}

/// The nodes moved somewhere else, each differently.
fn bent(body: &Body) -> Vec<DVec3> {
    let wave = |at: DVec3| DVec3::new((9.0 * at.y).sin(), (7.0 * at.z + 1.0).cos(), (5.0 * at.x - 2.0).sin());
    body.rest().iter().map(|&at| at + wave(at) * 0.02 + DVec3::new(3.0, -2.0, 1.0)).collect()
}

fn forces(load: &Loading, time: f64, position: &[DVec3]) -> Vec<DVec3> {
    let mut forces = vec![DVec3::ZERO; position.len()];
    load.add(time, position, &mut forces);
    forces
}

fn torque(forces: &[DVec3], position: &[DVec3]) -> DVec3 {
    forces.iter().zip(position).map(|(force, at)| at.cross(*force)).sum()
}

/// A torque has its size about any point and no sum, for nodes that lie in space, in a plane and on a line.
#[test]
fn torques_have_no_sum_and_their_size() {
    let body = lattice(3, 0.1);
    let position = bent(&body);
    let asked = DVec3::new(2.0, -3.0, 0.5);
    let all: Vec<u32> = (0..body.len() as u32).collect();
    let weights: Vec<f64> = all.iter().map(|&node| f64::from(1 + node % 3)).collect();
    let whole: f64 = weights.iter().sum();
    let weights = weights.into_iter().map(|weight| weight / whole).collect();
    let found = forces(&Loading::torque(all, weights, asked, Course::ALWAYS), 0.0, &position);
    assert!(found.iter().sum::<DVec3>().length() < 1e-12 && torque(&found, &position).distance(asked) < 1e-12);
    let on_a_line: Vec<_> = (0..4).map(|at| DVec3::X * f64::from(at)).collect();
    let line = Loading::torque(vec![0, 1, 2, 3], vec![0.25; 4], DVec3::Z * 5.0, Course::ALWAYS);
    let found = forces(&line, 0.0, &on_a_line);
    assert!(torque(&found, &on_a_line).distance(DVec3::Z * 5.0) < 1e-12, "{found:?}");
    assert!(found.iter().sum::<DVec3>().length() < 1e-14);
}

/// A pressure on a closed surface pushes and turns it nowhere. Its force on a node is the pressure times the change of the volume.
#[test]
fn pressures_are_the_gradient_of_the_volume() {
    let body = lattice(2, 0.1);
    let (mut position, faces) = (bent(&body), surface(&body));
    let load = Loading::pressure(faces.clone(), -300.0, Course::ALWAYS);
    let found = forces(&load, 0.0, &position);
    let size: f64 = found.iter().map(|force| force.length()).sum();
    assert!(found.iter().sum::<DVec3>().length() < 1e-13 * size);
    let middle = DVec3::new(3.0, -2.0, 1.0);
    let about: Vec<_> = position.iter().map(|at| *at - middle).collect();
    assert!(torque(&found, &about).length() < 1e-13 * size);
    // Of each fan about the mean of its corners.
    let volume = |position: &[DVec3]| -> f64 {
        let of_face = |face: &Vec<u32>| {
            let at = |corner: usize| position[face[corner % face.len()] as usize] - middle;
            let mean = (0..face.len()).map(at).sum::<DVec3>() / face.len() as f64;
            (0..face.len()).map(|corner| mean.dot(at(corner).cross(at(corner + 1))) / 6.0).sum::<f64>()
        };
        faces.iter().map(of_face).sum()
    };
    for (node, axis) in (0..body.len()).flat_map(|node| [0, 1, 2].map(|axis| (node, axis))) {
        let at = position[node][axis];
        let [more, less] = [1e-5, -1e-5].map(|step| {
            position[node][axis] = at + step;
            volume(&position)
        });
        position[node][axis] = at;
        let expected = 300.0 * (more - less) / 2e-5;
        assert!((found[node][axis] - expected).abs() < 1e-7, "{node} {axis}: {} {expected}", found[node][axis]);
    }
}

/// In the plane a pressure acts at right angles to sides, towards the body at their left.
#[test]
fn pressures_push_sides_of_the_plane() {
    let position = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y];
    let load = Loading::pressure(vec![vec![0, 1]], 10.0, Course::ALWAYS);
    assert_eq!(forces(&load, 0.0, &position), [DVec3::Y * 10.0, DVec3::Y * 10.0, DVec3::ZERO]);
}

#[test]
fn courses_begin_rise_and_end() {
    let ramp = Course { during: 1.0..3.0, keys: vec![[1.0, 0.0], [2.0, 1.0]], ease: Ease::Linear };
    let times = [0.9, 1.0, 1.25, 2.0, 2.9, 3.0];
    assert_eq!(times.map(|time| ramp.share(time)), [0.0, 0.0, 0.25, 1.0, 1.0, 0.0]);
    let smooth = Course { ease: Ease::Smooth, ..ramp };
    assert!((smooth.share(1.25) - 0.146_446_609_406_726_24).abs() < 1e-15);
    assert_eq!(Course::ALWAYS.share(1e9), 1.0);
}

/// A push that begins and ends, a torque that rises, a pressure on all sides, and a pull for ever.
fn loads(body: &Body) -> Vec<Arc<dyn Load>> {
    let all: Vec<u32> = (0..body.len() as u32).collect();
    let count = all.len() as f64;
    let rise = Course { during: 0.0..f64::INFINITY, keys: vec![[0.0, 0.0], [0.05, 1.0]], ease: Ease::Smooth };
    let keys = vec![[0.011, 0.0], [0.02, 1.0], [0.029, 0.0]];
    let push = Course { during: 0.011..0.0305, keys, ease: Ease::Linear };
    vec![
        Arc::new(Loading::dead(vec![0, 5], vec![DVec3::new(30.0, -20.0, 10.0); 2], push)),
        Arc::new(Loading::torque(all.clone(), vec![1.0 / count; all.len()], DVec3::new(4.0, 1.0, -2.0), rise.clone())),
        Arc::new(Loading::pressure(surface(body), 2e3, rise)),
        Arc::new(Loading::dead(vec![7, 20], vec![DVec3::Y * 9.0, DVec3::Z * 4.0], Course::ALWAYS)),
    ]
}

/// Worlds of every method and code, with loads.
fn worlds(step: f64) -> Vec<(String, Integrator, World)> {
    let body = lattice(3, 0.1);
    let springs = mass_spring(&body, 1e3, 0.0, Springs::All);
    let models: [Arc<dyn ElasticModel>; 2] = [Arc::new(shape_based(1e3, 0.0)), Arc::new(springs)];
    let mut all = Vec::new();
    for (model, integrator) in models.iter().flat_map(|model| INTEGRATORS.map(|one| (model, one))) {
        for kernel in [Kernel::Fast, Kernel::Reference] {
            let around = Surroundings { loads: loads(&body), gravity: DVec3::Y * -0.3, ..Surroundings::default() };
            let stepping = Stepping { kernel, ..Stepping::new(integrator, step) };
            let world = World::new(&body, State::at_rest(body.rest().to_vec()), &**model, around, stepping);
            all.push((format!("{integrator:?} {kernel:?} {model:?}"), integrator, world));
        }
    }
    all
}

/// The energy that loads have brought is their work, to the order of the method.
#[test]
fn work_is_the_energy_that_loads_bring() {
    let error = |world: &mut World, step: f64| {
        let start = world.some_diagnostics(&[Diagnostic::Energy]).energy;
        world.advance((0.08 / step).round() as u64);
        let now = world.diagnostics();
        ((now.energy - start - now.work) / now.work, now.work)
    };
    for ((text, integrator, mut coarse), (_, _, mut fine)) in worlds(STEP).into_iter().zip(worlds(STEP / 2.0)) {
        let ([one, work], [other, _]) = (error(&mut coarse, STEP).into(), error(&mut fine, STEP / 2.0).into());
        assert!(work > 3.0, "{text}: {work}");
        let is_first =
            matches!(integrator, Integrator::SemiImplicitEuler | Integrator::ExplicitEuler | Integrator::BackwardEuler);
        let (most, less) = match integrator {
            _ if is_first => (0.1, 0.3..0.6),
            Integrator::VelocityVerlet => (2e-4, 0.24..0.26),
            _ => (1e-7, 0.04..0.08),
        };
        // Dormand and Prince's method chooses its substeps.
        let is_less = integrator == Integrator::DormandPrince || less.contains(&(other / one));
        assert!(one.abs() < most && other.abs() < most && is_less, "{text}: {one:e} {other:e}");
    }
}

/// Bits do not depend on the division into calls, on copies, nor on a state that was written and read.
#[test]
fn work_and_states_do_not_depend_on_the_division_into_calls() {
    for (text, _, mut whole) in worlds(STEP) {
        let mut parts = whole.clone();
        whole.advance(60);
        for count in [1, 9, 3, 20, 17, 2, 8] {
            parts.advance(count);
            let mut copy = parts.clone();
            let state = State::from_bytes(&parts.state().to_bytes()).expect("a state");
            copy.set_state(state);
            parts = copy;
        }
        assert_eq!(parts.state(), whole.state(), "{text}");
        assert_eq!(parts.diagnostics().work.to_bits(), whole.diagnostics().work.to_bits(), "{text}");
    }
}

/// A state goes on in a world of another method with the work that was done.
#[test]
fn work_goes_on_with_another_method() {
    let all = worlds(STEP);
    for (text, _, first) in &all {
        let mut first = first.clone();
        first.advance(40);
        let mut numbers = Vec::new();
        for (_, _, mut other) in all.iter().filter(|(_, _, other)| other.takes(first.state())).cloned() {
            other.set_state(first.state().clone());
            numbers.push(other.diagnostics().work);
        }
        let work = first.diagnostics().work;
        assert!(work > 1.0 && numbers.len() >= 7, "{text}: {work}, {numbers:?}");
        assert!(numbers.iter().all(|one| (one / work - 1.0).abs() < 1e-3), "{text}: {work}, {numbers:?}");
    }
}

/// Fast code, which divides a body and moves nodes in an order of its own, gives each node the force on it.
#[test]
fn every_node_feels_its_own_force() {
    let own = |node: usize| DVec3::new(1.0, 0.1, 0.01) * (1.0 + node as f64);
    for layers in 1..10 {
        for cells in [[2, 2, layers], [layers, 2, 2], [3, layers, 3]] {
            let body = bricks(cells, DVec3::splat(0.1));
            let steady =
                Loading::dead((0..body.len() as u32).collect(), (0..body.len()).map(own).collect(), Course::ALWAYS);
            let changing = move |_: f64, _: &[DVec3], forces: &mut [DVec3]| {
                forces.iter_mut().enumerate().for_each(|(node, force)| *force += own(node));
            };
            let loads: [Arc<dyn Load>; 2] = [Arc::new(steady), Arc::new(changing)];
            for load in loads {
                let model = linear::model(&body, Material { young: 1e5, poisson: 0.3 }, 0.0).expect("bricks");
                let around = Surroundings { loads: vec![load], ..Surroundings::default() };
                let stepping = Stepping::new(Integrator::SemiImplicitEuler, STEP);
                let mut world = World::new(&body, State::at_rest(body.rest().to_vec()), &*model, around, stepping);
                world.advance(1);
                for (node, velocity) in world.state().velocity.iter().enumerate() {
                    let force = *velocity * (body.mass()[node] / STEP);
                    assert!((force - own(node)).length() < 1e-6, "{cells:?}, node {node}: {force} N");
                }
            }
        }
    }
}

/// A load that tells that it is steady moves a body as one that does not, to the bit.
#[test]
fn steady_loads_are_those_that_are_evaluated_each_time() {
    let body = lattice(3, 0.1);
    let model = shape_based(1e3, 0.0);
    for integrator in [Integrator::SemiImplicitEuler, Integrator::VelocityVerlet] {
        let stepping = Stepping::new(integrator, STEP);
        let free =
            || World::new(&body, State::at_rest(body.rest().to_vec()), &model, Surroundings::default(), stepping);
        let (mut loaded, mut pushed) = (free(), free());
        assert!(free().diagnostics().work.is_nan(), "without loads");
        let pull = DVec3::new(3.0, -2.0, 1.0);
        let evaluated =
            move |_: f64, _: &[DVec3], forces: &mut [DVec3]| [1, 4].iter().for_each(|&at| forces[at] += pull);
        let steady = |pull| Arc::new(Loading::dead(vec![1, 4], vec![pull; 2], Course::ALWAYS));
        loaded.set_loads(vec![steady(pull)]).expect("nodes");
        pushed.set_loads(vec![Arc::new(evaluated)]).expect("nodes");
        for world in [&mut loaded, &mut pushed] {
            world.advance(50);
        }
        let [one, other] = [&loaded, &pushed].map(World::state);
        assert_eq!((&one.position, &one.velocity), (&other.position, &other.velocity));
        let works = [&loaded, &pushed].map(|world| world.diagnostics().work);
        assert!((works[0] - works[1]).abs() < 1e-12 * works[0], "{works:?}");
        // What has been done stays where loads change.
        let before = works[0];
        loaded.set_loads(vec![steady(DVec3::ZERO)]).expect("nodes");
        loaded.advance(10);
        assert!(before > 0.0 && (loaded.diagnostics().work - before).abs() < 1e-12 * before);
    }
}

/// A bar of the shape model with E = 2 k/a is stretched by σ L/E under a traction σ, and its hold carries the force, also when pressed.
#[test]
fn a_bar_is_stretched_by_its_traction() {
    const SIDE: f64 = 0.1;
    let body = bricks([6, 2, 2], DVec3::splat(SIDE));
    let model = shape_based(5e3, 20.0);
    let at = |x: f64| -> Vec<u32> {
        (0..).zip(body.rest()).filter(|(_, node)| (node.x - x).abs() < 1e-9).map(|(node, _)| node).collect()
    };
    let right = at(6.0 * SIDE);
    let faces: Vec<_> =
        surface(&body).into_iter().filter(|face| face.iter().all(|node| right.contains(node))).collect();
    for traction in [1500.0, -1500.0] {
        let mut shares = vec![DVec3::ZERO; body.len()];
        faces.iter().for_each(|face| {
            for_each_area(face, body.rest(), |node, area| shares[node as usize] += area * traction);
        });
        let forces = right.iter().map(|&node| shares[node as usize]).collect();
        let load = Arc::new(Loading::dead(right.clone(), forces, Course::ALWAYS)) as Arc<dyn Load>;
        let grip = Grip { nodes: at(0.0), from: 0.0, until: f64::INFINITY, motion: Motion::Still };
        let around = Surroundings { loads: vec![load], grips: vec![grip], ..Surroundings::default() };
        let start = State::at_rest(body.rest().to_vec());
        let mut world = World::new(&body, start, &model, around, Stepping::new(Integrator::SemiImplicitEuler, 2e-3));
        world.keep_reactions(Moment::at(1.0));
        world.advance(40_000);
        let expected = traction * 6.0 * SIDE / (2.0 * 5e3 / SIDE);
        for &node in &right {
            let moved = world.state().position[node as usize] - body.rest()[node as usize];
            assert!(moved.distance(DVec3::X * expected) < 1e-9, "{moved} {expected}");
        }
        let held = world.diagnostics().hold_force;
        assert!(held.distance(DVec3::X * (-traction * 4.0 * SIDE * SIDE)) < 1e-7, "{held}");
        assert!((world.diagnostics().work - traction * 4.0 * SIDE * SIDE * expected).abs() < 1e-8);
    }
}

/// The angular momentum of a free body is its torque times the time, to round-off.
#[test]
fn a_torque_turns_a_free_body() {
    let body = lattice(3, 0.1);
    let asked = DVec3::new(0.5, -2.0, 1.0);
    let nodes: Vec<u32> = (0..body.len() as u32).step_by(3).collect();
    let weights = vec![1.0 / nodes.len() as f64; nodes.len()];
    let load = Arc::new(Loading::torque(nodes, weights, asked, Course::ALWAYS)) as Arc<dyn Load>;
    let around = Surroundings { loads: vec![load], ..Surroundings::default() };
    let model = shape_based(2e3, 0.0);
    let start = State::at_rest(body.rest().to_vec());
    let mut world = World::new(&body, start, &model, around, Stepping::new(Integrator::SemiImplicitEuler, STEP));
    world.advance(1500);
    let Diagnostics { momentum, angular_momentum, .. } = world.diagnostics();
    assert!(angular_momentum.distance(asked * 1.5) < 1e-10 && momentum.length() < 1e-11, "{angular_momentum}");
}
