//! Runs that start at rest.

use super::{bad, expect, good};
use localshape::scene::{BodyBuilder, Lattice, Limits, NodeSet, Scene, Side};
use localshape::sim::model::shape_based;

/// A bar that hangs from its top, with two models.
const HANGING: &str = "\
time = { duration = 1, start = 'equilibrium' }
gravity = [0, -9.8, 0]
run = [
  { name = 'Shapes', model = { kind = 'shape-based', stiffness = 5e3 } },
  { name = 'Springs', model = { kind = 'mass-spring', stiffness = 5e3 } },
]
body = { lattice = { cells = [1, 4, 1], side = 0.1 }, density = 1000 }
hold = [{ nodes = 'top' }]
";

/// Each run starts where its own model is at rest, and stays there without damping.
#[test]
fn each_run_starts_where_its_model_is_at_rest() {
    let scene = good(HANGING);
    let placed = &scene.bodies[0].initial.position;
    let lowest = scene.runs.iter().enumerate().map(|(at, run)| {
        assert!(run.rest.is_some_and(|rest| rest.residual < 1e-9), "{:?}", run.rest);
        let mut world = scene.world(at);
        world.advance(500);
        let moved = world.state().position.iter().zip(&run.initial.position).map(|(now, start)| now.distance(*start));
        assert!(moved.fold(0.0, f64::max) < 1e-9, "{}", run.name);
        run.initial.position[0].y - placed[0].y
    });
    let lowest: Vec<_> = lowest.collect();
    assert!(lowest[0] < -0.001 && lowest[1] < -0.001 && lowest[0] != lowest[1], "{lowest:?}");
    let words = scene.summary().to_string();
    assert!(words.contains("starts at rest: ") && words.contains(" of the load is left after "), "{words}");
    let falling = good(&HANGING.replace(", start = 'equilibrium'", ""));
    assert!(falling.runs[0].rest.is_none() && falling.digest != scene.digest);
    assert_eq!(&falling.runs[0].initial.position, placed);
}

/// A scene made in code says the same.
#[test]
fn a_scene_in_code_starts_at_rest() {
    let body = BodyBuilder::lattice(Lattice::new([1, 4, 1], 0.1)).density(1000.0);
    let scene = Scene::builder("test", body)
        .gravity([0.0, -9.8, 0.0])
        .at_rest()
        .run("Shapes", shape_based::Parameters::new(5e3))
        .hold(NodeSet::side(Side::Top), ..)
        .build(&Limits::default())
        .expect("a scene");
    assert_eq!(scene.runs[0].initial.position, good(HANGING).runs[0].initial.position);
}

#[test]
fn what_has_no_rest_is_told_with_the_remedy() {
    let free = HANGING.replace("hold = [{ nodes = 'top' }]\n", "");
    let message = "1:32 \"Shapes\" finds no state of rest: nothing holds the body against 39.2 N hold nodes with [[hold]], or put an obstacle \
                   below it";
    expect(&bad(&free), 0, message);
    let turning = free.replace("gravity = [0, -9.8, 0]\n", "load = [{ torque = [0, 0, 1], nodes = 'top' }]\n");
    expect(&bad(&turning), 0, "1:32 \"Shapes\" finds no state of rest: after ");
    expect(
        &bad(&HANGING.replace("'equilibrium'", "'rest'")),
        0,
        "1:32 `time.start` is \"rest\"; expected \"equilibrium\"",
    );
}

/// Displacements count from where nodes are placed.
#[test]
fn a_deflection_is_the_displacement_at_the_start() {
    let scene = good(&format!("{HANGING}probe = [{{ name = 'end', nodes = 'bottom' }}]\n"));
    let run = &scene.runs[0];
    let [_, down, ..] = scene.displaced(run, &scene.probes[0], None, &run.initial.position);
    let sunk = run.initial.position[0].y - scene.bodies[0].initial.position[0].y;
    assert!((down / sunk - 1.0).abs() < 1e-6 && down < -1e-3, "{down} {sunk}");
}
