//! Loads: mistakes in them, and on which nodes and faces they act.

use super::{bad, expect, good};
use glam::DVec3;
use localshape::scene::{BodyBuilder, Lattice, Limits, LoadBuilder, NodeSet, Scene, Side};
use localshape::sim::Load;
use localshape::sim::model::shape_based;

/// A bar of two cubes with sides of 0.1 m.
const WORLD: &str = "\
time = { duration = 1 }
run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = { lattice = { cells = [2, 1, 1], side = 0.1 }, density = 1000 }
";

/// Two squares.
const PLANE: &str = "\
time = { duration = 1 }
run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = { lattice = { cells = [2, 1], side = 0.1 }, density = 10 }
";

/// Adds a load to a world and expects exactly these mistakes in it.
#[track_caller]
fn case(world: &str, load: &str, expected: &str) {
    expect(&bad(&format!("{world}load = [{{ {load} }}]")), 3, expected);
}

#[test]
fn a_load_has_one_kind() {
    case(
        WORLD,
        "nodes = 'left'",
        "1:9 `load[0]` has no load; expected one of `force`, `traction`, `pressure`, `acceleration`, `torque` or `centrifugal`",
    );
    case(
        WORLD,
        "force = [0, 0, 1], pressure = 2",
        "1:9 `load[0]` has `force` and `pressure`; expected one load write another",
    );
    case(WORLD, "form = 1, force = [0, 0, 1]", "1:11 unknown key `form` in `load[0]`");
    case(WORLD, "force = [0, 1]", "1:19 `load[0].force` has 2 coordinates; expected 3");
    case(WORLD, "torque = 1", "1:20 `load[0].torque` is a number, but the body is in space such as torque = [0, 0, 5]");
    case(
        PLANE,
        "torque = [0, 0, 1]",
        "1:20 `load[0].torque` is a vector, but the body is in the plane such as torque = 5",
    );
}

#[test]
fn loads_act_somewhere() {
    case(
        WORLD,
        "pressure = 5, nodes = 'top'",
        "1:25 `load[0]` has a `pressure`, which acts on faces, with `nodes` write `faces`",
    );
    case(WORLD, "force = [0, 0, 1], nodes = 'top', faces = 'top'", "1:45 has both `nodes` and `faces`");
    case(WORLD, "force = [0, 0, 1], nodes = 'tpo'", "1:38 `load[0].nodes` is \"tpo\"; expected");
    case(
        WORLD,
        "force = [0, 0, 1], faces = [0, 1]",
        "1:38 `load[0].faces` takes 2 nodes of the body, but no face has all corners among them",
    );
    case(WORLD, "force = [0, 0, 1], body = 'x'", "1:37 there is no body \"x\"");
    case(
        WORLD,
        "torque = [0, 0, 1], nodes = [0]",
        "1:20 `load[0].torque` has no arm: all its nodes of the body lie on its axis",
    );
    case(WORLD, "torque = [1, 0, 0], nodes = [0, 1, 2]", "1:20 has no arm");
    let bars = "time = { duration = 1 }\nrun = [{ name = 'one', model = { kind = 'mass-spring', stiffness = 1e4 } }]\n\
                body = { bars = { count = 3, length = 0.1, direction = [1, 0, 0] }, mass = 1 }\n";
    case(
        bars,
        "pressure = 5",
        "1:9 `load[0]` acts on faces, but the body has none: it is made of bars write a `force` on `nodes`",
    );
}

#[test]
fn loads_act_some_time() {
    case(
        WORLD,
        "force = [0, 0, 1], from = 1, until = 1",
        "1:48 `load[0]` ends at 1 s, not later than it begins at 1 s",
    );
    case(WORLD, "force = [0, 0, 1], from = 0.5, until = 0.50001", "1:50 lasts 1.000e-5 s, but a time step takes");
    case(WORLD, "force = [0, 0, 1], ramp = 0", "1:37 is 0; expected a number greater than 0");
    case(
        WORLD,
        "force = [0, 0, 1], ramp = 1, keys = [{ time = 0, share = 1 }]",
        "1:30 `load[0]` has `ramp` and `keys`, which both say how it rises remove one",
    );
    case(
        WORLD,
        "force = [0, 0, 1], keys = [{ time = 1, share = 1 }, { time = 1, share = 2 }]",
        "1:72 `load[0].keys[1]` is at 1 s, not later than the key before it at 1 s list the keys in rising order of time",
    );
}

/// The forces of the loads of a scene on its nodes at the start and at rest.
fn forces(scene: &Scene) -> Vec<DVec3> {
    let run = &scene.runs[0];
    let mut forces = vec![DVec3::ZERO; run.initial.position.len()];
    run.loads.iter().for_each(|load| load.add(0.0, &run.initial.position, &mut forces));
    forces
}

/// Nodes share a force equally, faces by their areas: a corner of the long side of a bar of two cubes has less of it than a node between them.
#[test]
fn nodes_and_faces_share_a_force() {
    let of = |world: &str, load: &str| {
        let scene = good(&format!("{world}load = [{{ {load} }}]"));
        (forces(&scene), scene)
    };
    let (shared, _) = of(WORLD, "force = [0, 6, 0], nodes = 'top'");
    assert_eq!(shared.iter().filter(|force| **force == DVec3::Y).count(), 6);
    let (shared, scene) = of(WORLD, "force = [0, 8, 0], faces = 'top'");
    for (force, at) in shared.iter().zip(&scene.runs[0].initial.position) {
        let expected = if at.y < 0.05 {
            0.0
        } else if at.x.abs() < 0.01 {
            2.0
        } else {
            1.0
        };
        assert!(force.distance(DVec3::Y * expected) < 1e-12, "{force} at {at}");
    }
    let (stressed, _) = of(WORLD, "traction = [0, 400, 0], faces = 'top'");
    assert!(stressed.iter().sum::<DVec3>().distance(DVec3::Y * 8.0) < 1e-12);
    let (pressed, _) = of(WORLD, "pressure = 400, faces = 'top'");
    assert!(pressed.iter().zip(&stressed).all(|(one, other)| (*one + *other).length() < 1e-12));
    let (blown, _) = of(WORLD, "acceleration = [3, 0, 0]");
    assert!(blown.iter().sum::<DVec3>().distance(DVec3::X * 6.0) < 1e-12, "2 kg");
    let (whole, _) = of(WORLD, "pressure = -400");
    assert!(whole.iter().sum::<DVec3>().length() < 1e-12 && whole.iter().all(|force| force.length() > 0.1));
    let (flat, scene) = of(PLANE, "pressure = 40");
    for (force, at) in flat.iter().zip(&scene.runs[0].initial.position) {
        let middle = DVec3::new(0.0, 0.05, 0.0);
        assert!(force.dot(middle - *at) > 0.0, "inwards: {force} at {at}");
    }
    assert!((flat.iter().map(|force| force.y.abs()).sum::<f64>() - 16.0).abs() < 1e-12, "two sides of 0.2 m");
}

/// A scene made in code has the loads of the file that says the same, and its digest.
#[test]
fn loads_in_code_are_those_of_files() {
    let file = good(&format!(
        "{WORLD}load = [{{ faces = 'right', force = [0, -1, 0], from = 0.25, ramp = 0.5 }}, {{ nodes = 'all', torque = [1, 0, 0], until = 0.5 }},\n\
         {{ faces = 'all', pressure = 5 }}, {{ faces = 'top', traction = [0, 2, 0] }}, {{ nodes = 'left', acceleration = [1, 0, 0] }}]"
    ));
    let body = BodyBuilder::lattice(Lattice::new([2, 1, 1], 0.1)).density(1000.0);
    let scene = Scene::builder("", body).run("one", shape_based::Parameters::new(1e4));

    let scene = scene
        .load(LoadBuilder::force_on_faces(NodeSet::side(Side::Right), [0.0, -1.0, 0.0]).during(0.25..).ramp(0.5))
        .load(LoadBuilder::torque(NodeSet::all(), [1.0, 0.0, 0.0]).during(..0.5))
        .load(LoadBuilder::pressure(NodeSet::all(), 5.0))
        .load(LoadBuilder::traction(NodeSet::side(Side::Top), [0.0, 2.0, 0.0]))
        .load(LoadBuilder::acceleration(NodeSet::side(Side::Left), [1.0, 0.0, 0.0]))
        .build(&Limits::default())
        .expect("a scene");
    assert_eq!(scene.runs[0].loads, file.runs[0].loads);
}

#[test]
fn a_summary_tells_of_loads() {
    let text = good(&format!(
        "{WORLD}load = [{{ faces = 'right', force = [0, -1, 0] }}, {{ pressure = 5, from = 0.5, until = 2 }}, {{ torque = [1, 0, 0], nodes = 'left' }}]"
    ))
    .summary()
    .to_string();
    for line in [
        "load      force (0, -1, 0) N on 4 nodes from 0 s on",
        "load      pressure 5 Pa on 10 faces with 12 nodes from 0.5 s until 2 s",
        "load      torque (1, 0, 0) N m on 4 nodes from 0 s on",
    ] {
        assert!(text.contains(line), "{line} in {text}");
    }
}

/// A frame that turns stretches a bar from its axis outwards: the end of a thin one moves by `ρ ω² L³ / 3 E`.
#[test]
fn a_bar_that_turns_is_stretched() {
    let scene = good(
        "gravity = [0, 0, 0]
        time = { duration = 0, start = 'equilibrium' }
        run = [{ name = 'one', model = { kind = 'shape-based', young = 1e6 } }]
        body = { lattice = { cells = [64, 1, 1], side = 0.01 }, density = 1000 }
        hold = [{ nodes = 'left' }]
        load = [{ centrifugal = [0, 0, 2], about = [-0.32, 0.005, 0] }]
        probe = [{ name = 'end', nodes = 'right' }]",
    );
    let [along, ..] = scene.displaced(&scene.runs[0], &scene.probes[0], None, &scene.runs[0].initial.position);
    let expected = 1000.0 * 4.0 * 0.64_f64.powi(3) / 3e6;
    // The bar is longer then, which adds its strain; cells add the square of their share.
    assert!((along / expected - 1.0).abs() < 2e-3, "{along} {expected}");
    let words = scene.summary().to_string();
    assert!(words.contains("centrifugal at 2 rad/s about (-0.32, 0.005, 0) m on"), "{words}");
}

#[test]
fn axes_of_frames_are_told_apart() {
    case(
        WORLD,
        "centrifugal = 2",
        "1:25 `load[0].centrifugal` is a number, but the body is in space such as centrifugal = [0, 0, 5]",
    );
    case(PLANE, "centrifugal = [0, 0, 2]", "1:25 `load[0].centrifugal` is a vector, but the body is in the plane");
    case(
        WORLD,
        "force = [0, 0, 1], about = [0, 0, 0]",
        "1:30 `load[0]` has `about`, which is the axis of `centrifugal`, with `force`",
    );
    case(WORLD, "centrifugal = [0, 0, 2], about = [0, 0]", "1:44 `load[0].about` has 2 coordinates; expected 3");
}

/// A surface that elements fill bears loads itself: with its own area, to the outside in all places, and with no sum of a pressure.
#[test]
fn a_filled_surface_is_loaded_itself() {
    let hare = |with: &str, load: &str| {
        good(&format!(
            "gravity = [0, -9.8, 0]\ntime = {{ duration = 0.2 }}\nhold = [{{ nodes = 'bottom' }}]\nload = [{{ {load} }}]\n\
             body = {{ mesh = 'scenes/hare.ply', density = 300, fill = {{ with = '{with}', cells = 12 }} }}\n\
             run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 800, damping_ratio = 0.1 }} }}]\n"
        ))
    };
    for with in ["cubes", "graded", "tetrahedra", "polyhedra"] {
        let stressed = hare(with, "faces = 'all', traction = [0, 0, 100]");
        let fine = stressed.bodies[0].body.carried().expect("a surface");
        let area = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(|point| fine.rest[point as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        let whole: f64 = fine.triangles.iter().map(area).sum();
        let sum: DVec3 = forces(&stressed).iter().sum();
        assert!(sum.distance(DVec3::Z * (100.0 * whole)) < 1e-9 * sum.length(), "{with}: {sum} on {whole} m²");
        let pressed = forces(&hare(with, "pressure = 100"));
        assert!(pressed.iter().sum::<DVec3>().length() < 1e-9 * 100.0 * whole, "{with}: a closed surface");
        // The upper part of the surface: faces are chosen by its own points.
        let at = fine.positions(&stressed.bodies[0].initial.position);
        let [low, high] = at.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], at| [a.min(at.y), b.max(at.y)]);
        let middle = low.midpoint(high);
        let upper = fine.triangles.iter().filter(|face| face.iter().all(|&point| at[point as usize].y >= middle));
        let upper: f64 = upper.map(area).sum();
        let place = format!("faces = {{ low = [-9, {middle}, -9], high = [9, 9, 9] }}, traction = [0, 0, 100]");
        let top: DVec3 = forces(&hare(with, &place)).iter().sum();
        assert!(
            (top.z / (100.0 * upper) - 1.0).abs() < 1e-9 && upper > 0.1 * whole && upper < 0.9 * whole,
            "{with}: {top}"
        );
    }
    // Nodes of elements that are hardly filled do not fly off.
    for load in ["force = [0, 1, 0]", "torque = [0, 0.1, 0]", "faces = 'all', force = [0, 1, 0]", "pressure = 100"] {
        let scene = hare("cubes", load);
        let mut world = scene.world(0);
        world.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
        let moved = world.state().position.iter().zip(&scene.runs[0].initial.position);
        let farthest = moved.map(|(now, start)| now.distance(*start)).fold(0.0, f64::max);
        assert!(farthest < 0.1, "{load}: {farthest} m");
    }
}
