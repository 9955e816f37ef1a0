//! Tests of `src/runner/last_fit.rs`.

use super::*;
use crate::runner::Runner;
use crate::scene::Limits;

fn scene() -> Scene {
    let text = include_str!("../../scenes/explicit-euler.toml");
    Scene::parse(text, "explicit-euler.toml", &Limits::default()).expect("the shipped scene is sound")
}

#[test]
fn from_the_last_state_that_fits_on_all_frames_show_it() {
    let scene = scene();
    let mut runner = Runner::new(&scene, &[0, 2]);
    let frames: Vec<_> = (0..=scene.last_frame()).map(|frame| runner.frame(frame)).collect();
    assert!(frames.iter().all(|frame| frame.runs[0].last_fit.is_none()), "a run that does not diverge shows itself");
    let alone = Runner::new(&scene, &[2]).frame(scene.last_frame());
    let last_fit = alone.runs[0].last_fit.as_deref().expect("it diverged");
    assert!(
        fits(&scene.runs[2], &last_fit.position)
            && radius(&last_fit.position) > 1.1 * radius(scene.runs[2].body().rest())
    );
    for frame in &frames {
        let run = &frame.runs[1];
        let expected = (run.snapshot.step > last_fit.step).then_some(last_fit);
        assert_eq!(run.last_fit.as_deref(), expected, "frame {}", frame.index);
    }
    // No later state fits.
    let mut world = scene.world(2);
    world.advance(last_fit.step);
    assert_eq!(world.state().position, last_fit.position);
    while world.status() == Status::Ok {
        world.advance(1);
        assert!(!fits(&scene.runs[2], &world.state().position), "step {}", world.steps());
    }
    assert_eq!(last_fit.status, world.status());
}

#[test]
fn the_search_finds_the_same_in_any_slices() {
    let scene = scene();
    let found = |slice: u64| {
        let mut search = Search::new(&scene, 2, 1);
        let mut slices = 0;
        loop {
            slices += 1;
            if let Some(found) = search.advance(&scene, slice) {
                let found = found.expect("it diverges");
                return (slices, (found.state, found.shown));
            }
        }
    };
    let (slices, whole) = found(u64::MAX);
    assert_eq!(slices, 1);
    for slice in [7, 100] {
        let (slices, found) = found(slice);
        assert!(slices > 2 && found == whole, "{slice}");
    }
}

#[test]
fn where_nothing_is_drawn_it_is_not_looked_for() {
    let scene = scene();
    let frame = Runner::new(&scene, &[2]).without_pictures().frame(119);
    assert!(matches!(frame.runs[0].snapshot.status, Status::Diverged(_)) && frame.runs[0].last_fit.is_none());
}

#[test]
fn a_body_that_is_stretched_and_does_not_diverge_shows_itself() {
    let scene = scene();
    let mut stretched = scene.clone();
    // A body that grows without end, by its initial speed.
    stretched.runs[0]
        .initial
        .velocity
        .iter_mut()
        .zip(&scene.runs[0].initial.position)
        .for_each(|(speed, at)| *speed = *at * 60.0);
    let mut runner = Runner::new(&stretched, &[0]);
    let wide = (1..40)
        .map(|frame| runner.frame(frame))
        .filter(|frame| !fits(&stretched.runs[0], &frame.runs[0].snapshot.position));
    let shown: Vec<_> = wide.map(|frame| frame.runs[0].last_fit.is_none()).collect();
    assert!(!shown.is_empty() && shown.iter().all(|&itself| itself), "{shown:?}");
}

/// Bodies far apart are together wider than any of them grows.
#[test]
fn each_body_is_judged_by_its_own_size() {
    let found = |bodies: &[&str]| {
        let body = |x: &&str| {
            format!(
                "[[body]]
                name = 'at {x}'
                lattice = {{ cells = [1, 1, 1], side = 0.1 }}
                spin = {{ axis = [0, 0, 1], rate = 3 }}
                offset = [{x}, 0, 0]
                "
            )
        };
        let text = format!(
            "time = {{ duration = 60, frames_per_second = 1 }}
            {}
            [[run]]
            name = 'run'
            model = {{ kind = 'shape-based', stiffness = 1e4 }}
            integrator = 'explicit-euler'
            step = 'T/10'",
            bodies.iter().map(body).collect::<String>()
        );
        let scene = Scene::parse(&text, "far.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        Search::new(&scene, 0, 1).advance(&scene, u64::MAX).flatten().expect("it diverges")
    };
    let (alone, both) = (found(&["0"]), found(&["0", "100"]));
    assert_eq!(alone.state.steps, both.state.steps);
    assert_eq!(alone.state.position, both.state.position[..8]);
}

#[test]
fn a_radius_does_not_change_as_a_body_turns() {
    let corners = |turn: glam::DQuat| {
        (0..8).map(move |at| {
            turn * DVec3::new(f64::from(at & 1), f64::from(at >> 1 & 1), f64::from(at >> 2)) + DVec3::X * 7.0
        })
    };
    for turn in [glam::DQuat::IDENTITY, glam::DQuat::from_rotation_z(0.7), glam::DQuat::from_rotation_x(2.0)] {
        let radius = radius(&corners(turn).collect::<Vec<_>>());
        assert!((radius - 0.75_f64.sqrt()).abs() < 1e-12, "{radius}");
    }
    assert_eq!(radius(&[]), 0.0);
}

#[test]
fn a_body_that_starts_wide_fits() {
    let mut run = scene().runs.swap_remove(0);
    let rest = run.body().rest().to_vec();
    let wider = |times: f64| rest.iter().map(|&at| at * times).collect::<Vec<_>>();
    assert!(!fits(&run, &wider(2.0)));
    run.initial.position = wider(2.0);
    assert_eq!([2.0, 2.9, 3.1].map(|times| fits(&run, &wider(times))), [true, true, false]);
}
