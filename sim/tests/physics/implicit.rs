//! The equation of backward Euler is solved in each step, or the step is told.

use super::support::{Noise, body, bricks, lattice, mass_spring};
use glam::DVec3;
use localshape_sim::model::{ElasticModel, ForceModel, ModelParameters, Properties, Report, Scratch, Share};
use localshape_sim::{
    Body, Dimension, Grip, Integrator, Motion, Nodes, Springs, State, Stepping, Surroundings, Unsolved, World,
};
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn model(body: &Body, parameters: serde_json::Value) -> Arc<dyn ElasticModel> {
    let parameters: ModelParameters = serde_json::from_value(parameters).expect("a model");
    parameters.resolve(body, None).expect("it fits")
}

fn world(body: &Arc<Body>, start: State, model: &dyn ElasticModel, around: &Surroundings, step: f64) -> World {
    World::new(body, start, model, around.clone(), Stepping::new(Integrator::BackwardEuler, step))
}

/// Takes a step, and returns the largest residual of a node that is not held (m/s).
fn residual(world: &mut World, body: &Body, gravity: DVec3, step: f64, held: &[u32]) -> f64 {
    let before = world.state().velocity.clone();
    world.advance(1);
    let (now, forces) = (&world.state().velocity, world.forces());
    let free = (0..now.len()).filter(|&node| !held.contains(&(node as u32)));
    let off = |node: usize| (now[node] - before[node] - (gravity + forces[node] / body.mass()[node]) * step).length();
    free.map(off).fold(0.0, f64::max)
}

/// Eight cubes at rest shape that spin, in one step of 2.2 T. The least of the potential, by L-BFGS elsewhere, is 0.002537 J.
#[test]
fn a_step_of_a_body_that_spins_ends_in_the_least_of_the_potential() {
    const STEP: f64 = 0.05;
    let cubes = lattice(2, 0.1);
    let body = Arc::new(Body::clone(&cubes).with_masses(vec![0.01; 27]).expect("masses"));
    let model = model(&body, json!({ "kind": "corotational", "young": 2e4, "poisson": 0.3 }));
    let velocity: Vec<_> = body.rest().iter().map(|&rest| (DVec3::Z * 7.0).cross(rest - DVec3::splat(0.1))).collect();
    let start = State::new(body.rest().to_vec(), velocity.clone());
    let mut world = world(&body, start, &*model, &Surroundings::default(), STEP);
    let off = residual(&mut world, &body, DVec3::ZERO, STEP, &[]);
    assert!(off * STEP < 1e-10 * 0.2, "{off:e}");
    let changes = world.state().velocity.iter().zip(&velocity);
    let potential = changes.map(|(now, before)| 0.005 * (*now - *before).length_squared()).sum::<f64>()
        + world.diagnostics().elastic;
    assert!((potential - 0.002537).abs() < 1e-6, "{potential}");
    assert_eq!(world.snapshot().unsolved, None);
}

/// Deformed bodies that tumble, and cantilevers that bend under their weight, with steps of many periods.
#[test]
fn every_step_is_solved_however_long() {
    let free = lattice(2, 0.1);
    let bar = bricks([12, 1, 1], DVec3::splat(0.1));
    let held: Vec<u32> = (0..bar.len() as u32).filter(|&node| bar.rest()[node as usize].x == 0.0).collect();
    let grips = vec![Grip { nodes: held.clone(), from: 0.0, until: f64::INFINITY, motion: Motion::Still }];
    let gravity = DVec3::NEG_Y * 9.8;
    let hangs = Surroundings { gravity, grips, ..Surroundings::default() };
    let step = 0.05;
    for (kind, poisson) in [("corotational", 0.3), ("neo-hookean", 0.4), ("shape-based", 0.0), ("linear", 0.0)] {
        for periods in [2.2, 4.4, 13.0] {
            // k = E a/2 of a cube, and 1 kg at each node.
            let young = 20.0 * (std::f64::consts::TAU * periods / step).powi(2);
            let model = model(&free, json!({ "kind": kind, "young": young, "poisson": poisson }));
            let mut noise = Noise(5);
            let start = State::new(
                free.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect(),
                free.rest().iter().map(|&rest| DVec3::new(0.0, 9.0, 4.0).cross(rest) + noise.vector()).collect(),
            );
            let mut tumbles = world(&free, start, &*model, &Surroundings::default(), step);
            let mut bends = world(&bar, State::at_rest(bar.rest().to_vec()), &*model, &hangs, step);
            for number in 0..10 {
                let off = residual(&mut tumbles, &free, DVec3::ZERO, step, &[])
                    .max(residual(&mut bends, &bar, gravity, step, &held));
                assert!(off * step < 1e-9, "{kind}, {periods} T, step {number}: {off:e}");
            }
            assert_eq!((tumbles.snapshot().unsolved, bends.snapshot().unsolved), (None, None), "{kind}, {periods} T");
        }
    }
}

/// Also where damping is so strong that conjugate gradients take long. A first step of three cells, in which the springs turn far, is told if it
/// is not solved.
#[test]
fn the_implicit_method_solves_its_equation_with_strong_damping() {
    const STEP: f64 = 0.02;
    let body = bricks([24, 1, 1], DVec3::splat(0.05));
    let model = mass_spring(&body, 2e6, 2.4e5, Springs::EdgesFaceDiagonals);
    for (speed, steps) in [(1.0, 10), (5.2, 1)] {
        let velocity = body.rest().iter().map(|rest| DVec3::Y * (speed * rest.x * rest.x)).collect();
        let start = State::new(body.rest().to_vec(), velocity);
        let mut world = world(&body, start, &model, &Surroundings::default(), STEP);
        for step in 0..steps {
            let off = residual(&mut world, &body, DVec3::ZERO, STEP, &[]) * STEP;
            let told = world.snapshot().unsolved.is_some();
            assert!(off < 2e-4 && (off < 1e-9) != told, "speed {speed}, step {step}: {off:e} m, {told}");
        }
        assert!(speed > 1.0 || world.snapshot().unsolved.is_none());
    }
}

/// Counts how often forces are evaluated.
#[derive(Debug)]
struct Counted<M>(M, Arc<AtomicUsize>);

impl ElasticModel for Counted<Arc<dyn ElasticModel>> {
    fn properties(&self, body: &Body) -> Properties {
        self.0.properties(body)
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        self.0.start(body, position)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(Counted(self.0.prepare(body), Arc::clone(&self.1)))
    }
}

impl ForceModel for Counted<Box<dyn ForceModel>> {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.add_forces(at, memory, next, scratch, forces);
    }

    fn is_damped(&self) -> bool {
        self.0.is_damped()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        self.0.report(at, memory, share)
    }
}

/// The most evaluations of a step of many periods, as `docs/accuracy.md` tells them: of a deformed body that tumbles, and of a cantilever.
#[test]
fn steps_of_more_periods_take_more_evaluations() {
    const STEP: f64 = 0.05;
    let (free, bar) = (lattice(2, 0.1), bricks([12, 1, 1], DVec3::splat(0.1)));
    let held: Vec<u32> = (0..bar.len() as u32).filter(|&node| bar.rest()[node as usize].x == 0.0).collect();
    let grips = vec![Grip { nodes: held, from: 0.0, until: f64::INFINITY, motion: Motion::Still }];
    let hangs = Surroundings { gravity: DVec3::NEG_Y * 9.8, grips, ..Surroundings::default() };
    let mut noise = Noise(5);
    let start = State::new(
        free.rest().iter().map(|&rest| rest + noise.vector() * 0.02).collect(),
        free.rest().iter().map(|&rest| DVec3::new(0.0, 9.0, 4.0).cross(rest) + noise.vector()).collect(),
    );
    for (periods, most) in [(0.02, 60), (0.1, 60), (0.5, 230), (1.0, 400), (4.4, 800), (13.0, 1400)] {
        for (kind, poisson) in [("shape-based", 0.0), ("corotational", 0.3), ("neo-hookean", 0.4)] {
            let young = 20.0 * (std::f64::consts::TAU * periods / STEP).powi(2);
            let rests = Surroundings::default();
            for (body, start, around) in
                [(&free, start.clone(), &rests), (&bar, State::at_rest(bar.rest().to_vec()), &hangs)]
            {
                let count = Arc::new(AtomicUsize::new(0));
                let model = model(body, json!({ "kind": kind, "young": young, "poisson": poisson }));
                let mut world = world(body, start, &Counted(model, Arc::clone(&count)), around, STEP);
                for step in 0..10 {
                    world.advance(1);
                    let found = count.swap(0, Ordering::Relaxed);
                    assert!((5..=most).contains(&found), "{kind}, {periods} T, step {step}: {found}");
                }
            }
        }
    }
}

/// A force of 1 N towards the plane x = 0, with a jump there and no energy: there is no velocity that solves a step across it.
#[derive(Debug)]
struct Jump;

impl ElasticModel for Jump {
    fn properties(&self, _: &Body) -> Properties {
        Properties::new("jump", 1.0)
    }

    fn prepare(&self, _: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(Self)
    }
}

impl ForceModel for Jump {
    fn add_forces(&self, at: Nodes<'_>, _: &[f64], _: &mut [f64], _: &mut Scratch, forces: &mut [DVec3]) {
        at.position.iter().zip(forces).for_each(|(at, force)| force.x -= at.x.signum());
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn report(&self, _: Nodes<'_>, _: &[f64], _: &mut Share<'_>) -> Report {
        Report::default()
    }
}

/// The number, the first time and the residual are part of the state, so that they outlive an interruption.
#[test]
fn a_step_that_is_not_solved_is_told() {
    let body = body(Dimension::Space, &[[0.5, 0.0, 0.0], [10.0, 0.0, 0.0]], &[&[0, 1]]);
    let start = State::new(body.rest().to_vec(), vec![DVec3::X * -0.4, DVec3::ZERO]);
    let new = || world(&body, start.clone(), &Jump, &Surroundings::default(), 0.5);
    let mut whole = new();
    // With the force of either side, node 0 goes to 0.05, −0.15 and −0.1 m. Then it would end in the force of the other one.
    let off: Vec<f64> = (0..8).map(|_| residual(&mut whole, &body, DVec3::ZERO, 0.5, &[])).collect();
    let wrong: Vec<usize> = (0..8).filter(|&step| off[step] > 1e-9).collect();
    assert_eq!(wrong.first(), Some(&3), "{off:?}");
    let Some(Unsolved { steps, residual, first }) = whole.snapshot().unsolved else { panic!("it cannot be solved") };
    let most = off.iter().copied().fold(0.0, f64::max);
    assert!(
        steps as usize == wrong.len() && (residual - most).abs() < 1e-9 && first == 2.0,
        "{steps} {residual} {off:?}"
    );
    let mut cut = new();
    cut.advance(5);
    let state = State::from_bytes(&cut.state().to_bytes()).expect("a state");
    let mut goes_on = new();
    goes_on.set_state(state);
    goes_on.advance(3);
    assert_eq!((goes_on.state(), goes_on.snapshot().unsolved), (whole.state(), whole.snapshot().unsolved));
}
