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

/// A bar that swings on its hold until air has stopped it.
const SWINGING: &str = "\
time = { duration = 20, until = 'rest', frames_per_second = 30 }
gravity = [0, -9.8, 0]
mass_damping = { ratio = 0.3, frequency = 2 }
run = [
  { name = 'Shapes', model = { kind = 'shape-based', stiffness = 5e3 } },
  { name = 'Springs', model = { kind = 'mass-spring', stiffness = 5e3 } },
]
body = { lattice = { cells = [1, 4, 1], side = 0.1 }, density = 1000 }
hold = [{ nodes = 'top' }]
";

/// The scene ends with the run that comes to rest last, where a search for rest ends, too.
#[test]
fn a_scene_ends_when_all_runs_are_at_rest() {
    let scene = good(SWINGING);
    let ends: Vec<_> = scene.runs.iter().map(|run| run.comes_to_rest.expect("rest")).collect();
    let last = ends.iter().map(|end| end.frame).max().expect("two runs");
    assert_eq!((scene.last_frame(), scene.duration), (last, last as f64 / 30.0));
    assert!(
        last > 30 && last < 120 && ends.iter().all(|end| end.residual < 1e-3 && end.kinetic_energy < 1e-6),
        "{ends:?}"
    );
    let balanced = good(&SWINGING.replace("until = 'rest'", "start = 'equilibrium'"));
    for run in 0..2 {
        let mut world = scene.world(run);
        world.advance_towards(scene.moment(last), u64::MAX);
        let apart = world.state().position.iter().zip(&balanced.runs[run].initial.position);
        let apart = apart.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
        assert!(apart < 2e-5, "{}: {apart} m", scene.runs[run].name);
    }
    let words = scene.summary().to_string();
    assert!(words.contains("at rest from ") && words.contains("of masses, α = 7.54/s"), "{words}");
}

/// What moves later, or for ever, is waited for.
#[test]
fn rest_begins_after_the_last_change() {
    assert!(good(SWINGING).duration < 3.5);
    let lift = "nodes = 'top', path = { keys = [{ time = 4, shift = [0, 0, 0] }, { time = 5, shift = [0, 0.1, 0] }] }";
    let lifted = SWINGING.replace("hold", "grab").replace("nodes = 'top'", lift);
    assert!(good(&lifted).duration > 5.0);
    let pushed = good(&format!("{SWINGING}load = [{{ force = [1, 0, 0], nodes = 'bottom', from = 3.5 }}]\n"));
    assert!(pushed.duration > 3.5);
}

#[test]
fn a_run_that_never_rests_is_told() {
    let free = SWINGING.replace("hold = [{ nodes = 'top' }]\n", "").replace("duration = 20", "duration = 2");
    let scene = good(&free);
    assert_eq!((scene.duration, scene.runs[0].comes_to_rest), (2.0, None));
    let [warning] = &scene.warnings[..] else { panic!("{:?}", scene.warnings) };
    assert!(warning.message.contains("\"Shapes\" and \"Springs\" are not at rest after 2 s"), "{}", warning.message);
    expect(
        &bad(&SWINGING.replace("until = 'rest'", "until = 3")),
        0,
        "1:33 `time.until` is the whole number 3; expected \"rest\"",
    );
}

#[test]
fn damping_of_masses_is_a_rate_or_a_ratio() {
    let rate = good(&SWINGING.replace("{ ratio = 0.3, frequency = 2 }", "1.5").replace(", until = 'rest'", ""));
    assert_eq!((rate.mass_damping, rate.world(0).surroundings().mass_damping), (1.5, 1.5));
    let scene = good(SWINGING);
    assert!((scene.mass_damping - 4.0 * std::f64::consts::PI * 0.3 * 2.0).abs() < 1e-14 && scene.digest != rate.digest);
    let case = |typed: &str, expected: &str| {
        expect(&bad(&SWINGING.replace("{ ratio = 0.3, frequency = 2 }", typed)), 2, expected);
    };
    case("-1", "1:16 `mass_damping` is -1; expected a number of at least 0");
    case("{ ratio = 0.3 }", "1:16 `mass_damping` has no `frequency`");
    case("{ ratio = 0.3, frequency = 0 }", "1:43 `mass_damping.frequency` is 0; expected a number greater than 0");
    let pefrl = SWINGING.replace("time = {", "time = { integrator = 'pefrl',").replace(", until = 'rest'", "");
    assert!(bad(&pefrl).to_string().contains("has substeps backwards in time"), "{}", bad(&pefrl));
}

/// A body that swings is not at rest beside one that has fallen, however much more that one moved.
#[test]
fn every_body_comes_to_rest() {
    let scene = |leaf: &str| {
        format!(
            "gravity = [0, -9.8, 0]\ntime = {{ duration = 4, until = 'rest', frames_per_second = 30 }}\n\
             obstacle = [{{ kind = 'floor', friction = 0.8 }}]\n\
             [[body]]\nname = 'block'\nlattice = {{ cells = [1, 1, 1], side = 0.4 }}\ndensity = 2000\nlowest = 0.1\noffset = [3, 0, 0]\n\
             {leaf}[[run]]\nname = 'Shapes'\nmodel = {{ kind = 'shape-based', young = 1e6, damping_ratio = 0.5 }}\n"
        )
    };
    let block = good(&scene(""));
    assert!(block.runs[0].comes_to_rest.is_some(), "{:?}", block.warnings);
    let leaf = "[[body]]\nname = 'leaf'\nlattice = { cells = [6, 1, 1], side = 0.05 }\ndensity = 50\noffset = [0, 1, 0]\n\
                [[hold]]\nbody = 'leaf'\nnodes = 'left'\n";
    let both = scene(leaf).replace(
        "model = { kind = 'shape-based', young = 1e6, damping_ratio = 0.5 }",
        "models = { block = { kind = 'shape-based', young = 1e6, damping_ratio = 0.5 }, leaf = { kind = 'shape-based', young = 2e4 } }",
    );
    let both = good(&both);
    assert_eq!(both.runs[0].comes_to_rest, None);
    assert!(both.warnings[0].message.contains("\"Shapes\" is not at rest after 4 s"), "{:?}", both.warnings);
}

/// What starts at rest rests from its first frame on, and what nothing acts on as well.
#[test]
fn rest_from_the_start_is_rest() {
    let balanced = SWINGING.replace("until = 'rest'", "until = 'rest', start = 'equilibrium'");
    let still = SWINGING.replace("gravity = [0, -9.8, 0]\n", "");
    for text in [balanced, still] {
        let scene = good(&text);
        assert!(
            scene
                .runs
                .iter()
                .all(|run| { run.comes_to_rest.is_some_and(|rest| rest.frame == 1 && rest.residual < 1e-3) }),
            "{:?}",
            scene.warnings
        );
    }
}

#[test]
fn a_run_that_diverges_before_rest_is_told() {
    let scene = good(&SWINGING.replace("duration = 20", "duration = 2, step = 0.1"));
    let told: Vec<_> = scene.warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert!(told.contains(&"\"Shapes\" and \"Springs\" diverge before rest"), "{told:?}");
}

/// What is left is told beside the load also where that is smaller than round-off of the forces.
#[test]
fn a_load_as_small_as_round_off_is_told() {
    let scene =
        good(&HANGING.replace("gravity = [0, -9.8, 0]\n", "load = [{ force = [0, 4e-15, 0], nodes = 'bottom' }]\n"));
    let [first, ..] = &scene.warnings[..] else { panic!("no warning") };
    assert!(first.message.contains("of the load is left in the state of rest of \"Shapes\""), "{}", first.message);
    assert!(scene.runs[0].rest.is_some_and(|rest| rest.residual > 0.02));
}

/// Round-off of a body without a load is no share of it.
#[test]
fn no_load_at_the_start_is_no_small_one() {
    let load = "load = [{ force = [0, 4, 0], nodes = 'bottom', ramp = 0.5 }]\n";
    let scene = good(&HANGING.replace("gravity = [0, -9.8, 0]\n", load));
    assert_eq!(scene.warnings.len(), 0, "{}", scene.warnings[0].message);
    assert!(scene.runs[0].rest.is_some_and(|rest| rest.residual < 1e-9));
}

/// The forces that hold a body at rest are known from the start.
#[test]
fn what_starts_at_rest_has_reactions_there() {
    let scene = good(&(HANGING.replace("duration = 1", "duration = 0") + "view.charts = ['hold_force']\n"));
    for run in 0..2 {
        let reactions = scene.world(run).reactions().expect("forces at the start");
        assert!((reactions[0].force.y / 39.2 - 1.0).abs() < 1e-9, "{:?}", reactions[0].force);
    }
    let standing = HANGING
        .replace("hold = [{ nodes = 'top' }]\n", "obstacle = [{ kind = 'floor' }]\nview.charts = ['contact_force']\n");
    let standing = good(&standing.replace("density = 1000", "density = 1000, lowest = 0"));
    for run in 0..2 {
        let reactions = standing.world(run).reactions().expect("forces at the start");
        assert!((reactions[0].force.y / 39.2 - 1.0).abs() < 1e-3, "{:?}", reactions[0].force);
    }
}
