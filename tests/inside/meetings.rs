//! Tests of `src/runner/meetings.rs`.

use super::*;
use crate::runner::{Frames, Next, Runner};
use crate::scene::Limits;

/// A cube falls on a block that is held, and a small fast one flies through both a little earlier in another run.
fn scene(rate: f64, integrator: &str) -> Scene {
    let text = format!(
        "gravity = [0, -10, 0]
        contact.rule = 'nodes'
        time = {{ duration = 0.4, frames_per_second = {rate}, integrator = '{integrator}' }}
        [[body]]
        name = 'cube'
        lattice = {{ cells = [2, 2, 2], side = 0.1 }}
        lowest = 0.65
        [[body]]
        name = 'block'
        lattice = {{ cells = [2, 2, 2], side = 0.1 }}
        [[body]]
        name = 'bullet'
        lattice = {{ cells = [1, 1, 1], side = 0.02 }}
        offset = [-9, 0.1, 0]
        velocity = [100, 0, 0]
        [[hold]]
        body = 'block'
        nodes = 'bottom'
        [[run]]
        name = 'fall'
        bodies = ['cube', 'block']
        model = {{ kind = 'shape-based', stiffness = 1e5, damping_ratio = 0.1 }}
        [[run]]
        name = 'shot'
        bodies = ['bullet', 'block']
        model = {{ kind = 'shape-based', stiffness = 1e5 }}
        [[run]]
        name = 'alone'
        bodies = ['block']
        model = {{ kind = 'shape-based', stiffness = 1e5 }}"
    );
    Scene::parse(&text, "meetings.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The messages by looking at every step.
fn expected(scene: &Scene) -> Vec<String> {
    let of_run = |number: usize| {
        let (run, mut world) = (&scene.runs[number], scene.world(number));
        let surfaces = Surfaces::new(run.bodies.bodies(), &[], &Contacts::default());
        while overlaps(&surfaces, &world.state().position, |_| true).next().is_none() {
            world.advance(1);
        }
        let [one, other] = [0, 1].map(|place| &scene.bodies[run.of[place]].name);
        let time = short(world.steps() as f64 * run.step);
        format!("“{one}” and “{other}” go through each other from {time} s on in “{}”: bodies do not collide", run.name)
    };
    [0, 1].map(of_run).to_vec()
}

/// Takes frames until the end, or some of them, and returns the messages in the order of the runs.
fn told(frames: &mut Frames<'_>, slice: u64, most: usize) -> Vec<String> {
    let mut told = Vec::new();
    while frames.taken() < most && !matches!(frames.next(slice).unwrap(), Next::Done) {
        told.extend(frames.meetings());
    }
    told.sort_by_key(|message| message.contains("shot"));
    told
}

#[test]
fn the_first_step_of_an_overlap_is_told_for_any_frames() {
    for integrator in ["semi-implicit-euler", "velocity-verlet", "runge-kutta"] {
        let usual = scene(100.0, integrator);
        let expected = expected(&usual);
        for (rate, wanted, slice) in [
            (100.0, None, 1000),
            (100.0, Some([40]), u64::MAX),
            (100.0, None, 1),
            (7.5, None, 33),
            (2.5, None, u64::MAX),
        ] {
            let scene = scene(rate, integrator);
            assert_eq!(scene.runs[0].step, usual.runs[0].step);
            let all: Vec<_> = (0..=scene.last_frame()).collect();
            let runner = Runner::new(&scene, &[0, 1, 2]).watching();
            let mut frames = Frames::new(runner, wanted.as_ref().map_or(&all[..], |wanted| &wanted[..]), None);
            assert_eq!(told(&mut frames, slice, usize::MAX), expected, "{integrator}, {rate}, {wanted:?}, {slice}");
            // The bits of the states are those of runs that nobody watches.
            let end = Runner::new(&scene, &[0, 1, 2]).frame(*all.last().unwrap());
            let states: Vec<_> = frames.states().map(|state| (&state.position, &state.velocity)).collect();
            let plain: Vec<_> = end.runs.iter().map(|run| (&run.snapshot.position, &run.snapshot.velocity)).collect();
            assert!(states == plain, "{integrator}, {rate}");
        }
    }
}

#[test]
fn an_interruption_changes_no_message() {
    let scene = scene(100.0, "semi-implicit-euler");
    let (expected, all) = (expected(&scene), (0..=scene.last_frame()).collect::<Vec<_>>());
    let begin = || Frames::new(Runner::new(&scene, &[0, 1, 2]).watching(), &all, None);
    for taken in [1, 9, 10, 30, 31, 32, 40] {
        let mut first = begin();
        let mut messages = told(&mut first, 1000, taken);
        let progress = first.progress().unwrap().expect("it is not finished");
        messages.extend(first.meetings());
        let mut second = begin();
        second.resume(progress).unwrap();
        messages.extend(told(&mut second, 1000, usize::MAX));
        messages.sort_by_key(|message| message.contains("shot"));
        assert_eq!(messages, expected, "after {taken} frames");
    }
}

/// A single body needs no name, and then has none in the message.
#[test]
fn crossings_of_a_body_without_a_name_are_told() {
    let text = "time = { duration = 0.1, frames_per_second = 10 }
        body = { lattice = { cells = [1, 1, 1], side = 0.1 } }
        run = [{ name = 'mat', model = { kind = 'shape-based', stiffness = 1e4 } }]";
    let scene = Scene::parse(text, "test.toml", &Limits::default()).expect("a scene");
    let mut frame = Runner::new(&scene, &[0]).frame(0).runs.remove(0);
    (frame.snapshot.diagnostics.crossings, frame.snapshot.of_bodies[0].crossings) = (11.0, 11.0);
    let told = crossing(&scene, &frame).expect("a message");
    assert!(
        told.starts_with("surfaces cross or lie in each other at 0 s in “mat” (11 places): take a shorter step"),
        "{told}"
    );
}
