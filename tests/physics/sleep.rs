//! Bodies that have come to rest sleep until something touches them.

use super::example_model::Rods;
use glam::DVec3;
use localshape::scene::{Limits, RunBuilder, Scene};
use localshape::sim::model::{ElasticModel, ForceModel, Report, Scratch, Share};
use localshape::sim::{Body, Nodes, State, World};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

const DISTANCE: f64 = 1e-4;

/// Eight cubes, with each kernel and model and with several integrators, asleep after half a second.
fn scene(more: &str) -> Scene {
    let model = |kind: &str| format!("model = {{ kind = '{kind}', stiffness = 1e4, damping_ratio = 0.1 }}");
    let (shape, springs) = (model("shape-based"), model("mass-spring"));
    let text = format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = 6, sleep = {{ distance = {DISTANCE}, after = 0.5 }} }}
        body.lattice = {{ cells = [2, 2, 2], side = 0.1 }}
        {more}
        [[run]]
        name = 'shape'
        {shape}
        [[run]]
        name = 'reference'
        kernel = 'reference'
        {shape}
        [[run]]
        name = 'springs'
        integrator = 'velocity-verlet'
        {springs}
        [[run]]
        name = 'runge-kutta'
        integrator = 'runge-kutta'
        {springs}"
    );
    Scene::parse(&text, "sleep.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

const FALL: &str = "body.velocity = [0, -1, 0]
    body.rotation = { axis = [1, 0, 1], angle = 0.1 }
    body.lowest = 0.01
    obstacle = [{ kind = 'floor', restitution = 0.3, friction = 0.5 }]";

fn farthest(one: &World, other: &World) -> f64 {
    let pairs = one.state().position.iter().zip(&other.state().position);
    pairs.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max)
}

/// From when it sleeps (steps), it does not move, and it is never farther from where it would be than documented.
#[test]
fn a_body_at_rest_sleeps_within_the_bound_of_one_that_is_awake() {
    let scene = scene(FALL);
    let awake = Scene { sleep: None, ..scene.clone() };
    for run in 0..scene.runs.len() {
        let name = &scene.runs[run].name;
        let [mut asleep, mut awake] = [&scene, &awake].map(|scene| scene.world(run));
        let mut begun = None;
        for _ in 0..600 {
            let before = asleep.state().clone();
            [&mut asleep, &mut awake].into_iter().for_each(|world| world.advance(20));
            if before.asleep_since().is_some() {
                assert!(asleep.state().position == before.position, "{name}");
                assert!(asleep.state().velocity.iter().all(|&velocity| velocity == DVec3::ZERO), "{name}");
            }
            begun = begun.or(asleep.state().asleep_since());
            assert!(farthest(&asleep, &awake) <= 2.0 * DISTANCE, "{name}: {}", farthest(&asleep, &awake));
            assert!(begun.is_some() || farthest(&asleep, &awake) == 0.0, "{name}: looking changes nothing");
        }
        let time = begun.map(|step| step as f64 * scene.runs[run].step);
        assert!(time.is_some_and(|time| time < 6.0), "{name}: {time:?}");
        // No computer takes so many steps.
        asleep.advance(1 << 52);
        assert!(asleep.steps() > 1 << 52 && asleep.state().asleep_since() == begun);
    }
}

/// A vibration without end, within the distance and beyond it.
#[test]
fn what_vibrates_far_does_not_sleep() {
    for (share, sleeps) in [(0.2, true), (3.0, false)] {
        let mut scene = Scene { gravity: DVec3::ZERO, ..scene("") };
        let stretch = 1.0 + share * DISTANCE / 0.1;
        scene.initial.position.iter_mut().for_each(|position| *position *= stretch);
        scene.runs.truncate(1);
        scene.runs[0].model = scene.runs[0].model.scaled(1.0, 0.0).expect("a model of the program");
        let mut awake = Scene { sleep: None, ..scene.clone() }.world(0);
        let mut world = scene.world(0);
        for _ in 0..200 {
            [&mut world, &mut awake].into_iter().for_each(|world| world.advance(20));
            assert!(farthest(&world, &awake) <= 2.0 * DISTANCE);
        }
        assert_eq!(world.state().asleep_since().is_some(), sleeps, "{share}");
    }
}

/// Obstacles that come, obstacles that leave, and grips that take, drag and release wake a body; what moves elsewhere does not.
#[test]
fn what_touches_a_body_wakes_it() {
    let cases = [
        (
            "a plate comes down",
            "obstacle = [{ kind = 'floor' }, { kind = 'plate', point = [0, 0.5, 0], normal = [0, -1, 0], \
            path = { keys = [{ time = 3, shift = [0, 0, 0] }, { time = 4, shift = [0, -0.4, 0] }] } }]",
            Some(3.5),
        ),
        (
            "the floor sinks",
            "obstacle = [{ kind = 'floor', path = { keys = [{ time = 3, shift = [0, 0, 0] }, \
            { time = 4, shift = [0, -0.4, 0] }] } }]",
            Some(3.0),
        ),
        (
            "a ball swings far away",
            "obstacle = [{ kind = 'floor' }, { kind = 'sphere', centre = [2, 1, 0], radius = 0.3, \
            swing = { period = 1, shift = [0, 0.3, 0] } }]",
            None,
        ),
        (
            "a corner is lifted",
            "obstacle = [{ kind = 'floor' }]
            grab = [{ nodes = [0], path = { keys = [{ time = 3, shift = [0, 0, 0] }, { time = 4, shift = [0, 0.3, 0] }] } }]",
            Some(3.0),
        ),
        ("held nodes are let go", "hold = [{ nodes = [6, 7, 8, 15, 16, 17, 24, 25, 26], until = 4.5 }]", Some(4.5)),
    ];
    for (name, more, wakes) in cases {
        let scene = scene(more);
        for run in [0, 1] {
            let step = scene.runs[run].step;
            let mut world = scene.world(run);
            let mut woken = None;
            let mut slept = false;
            while (world.steps() as f64) * step < 5.5 {
                world.advance(1);
                let sleeps = world.state().asleep_since().is_some();
                if slept && !sleeps && woken.is_none() {
                    assert_eq!(world.state().woken + 1, world.steps(), "{name}");
                    woken = Some(world.steps() as f64 * step);
                }
                slept |= sleeps;
            }
            assert!(slept, "{name}");
            match (wakes, woken) {
                (None, None) => {}
                (Some(expected), Some(found)) => assert!((expected - found).abs() < 0.25, "{name}: {found}"),
                _ => panic!("{name}: {woken:?}, expected {wakes:?}"),
            }
        }
    }
}

/// However steps are divided into calls, and after the state was written and read.
#[test]
fn sleep_does_not_depend_on_how_steps_are_divided() {
    let scene = scene(
        "body.velocity = [0, -1, 0]
        obstacle = [{ kind = 'floor', restitution = 0.3, friction = 0.5, path = { keys = [{ time = 4, shift = [0, 0, 0] }, \
            { time = 4.1, shift = [0, 0.1, 0] }] } }]",
    );
    for run in 0..scene.runs.len() {
        let steps = (5.0 / scene.runs[run].step) as u64;
        let mut whole = scene.world(run);
        whole.advance(steps);
        for stretch in [7, 97, 400] {
            let (mut cut, mut slept) = (scene.world(run), false);
            while cut.steps() < steps {
                cut.advance(stretch.min(steps - cut.steps()));
                slept |= cut.state().asleep_since().is_some();
                let state = State::from_bytes(&cut.state().to_bytes()).expect("what was written");
                cut = scene.world(run);
                cut.set_state(state);
            }
            assert!(slept && cut.state().asleep_since().is_none(), "{}", scene.runs[run].name);
            assert!(cut.state().to_bytes() == whole.state().to_bytes(), "{}: {stretch}", scene.runs[run].name);
        }
    }
}

/// A model that counts how often its forces are evaluated.
#[derive(Clone, Debug)]
struct Counted(Rods, Arc<AtomicU64>);

impl ElasticModel for Counted {
    fn stiffness(&self) -> f64 {
        self.0.stiffness
    }

    fn describe(&self, body: &Body) -> String {
        self.0.describe(body)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(CountedForces(self.0.prepare(body), Arc::clone(&self.1)))
    }
}

struct CountedForces(Box<dyn ForceModel>, Arc<AtomicU64>);

impl ForceModel for CountedForces {
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

#[test]
fn forces_are_not_evaluated_in_sleep() {
    let count = Arc::new(AtomicU64::new(0));
    let rest = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let body = localshape::scene::BodyBuilder::arrays(rest, [[0, 1, 2, 3]]);
    let rods = RunBuilder::own(Arc::new(Counted(Rods { stiffness: 100.0 }, Arc::clone(&count))));
    let scene = Scene::builder("tetrahedron", body).step(1e-3).sleep(1e-6, 0.1).run("Rods", rods);
    let mut world = scene.build(&Limits::default()).unwrap_or_else(|error| panic!("{error}")).world(0);
    let evaluations = |world: &mut World, steps: u64| {
        let before = count.load(Ordering::Relaxed);
        world.advance(steps);
        count.load(Ordering::Relaxed) - before
    };
    assert_eq!(evaluations(&mut world, 100), 100);
    assert_eq!(world.state().asleep_since(), Some(100));
    assert_eq!(evaluations(&mut world, 1_000_000), 0);
}
