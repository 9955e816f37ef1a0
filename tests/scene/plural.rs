//! Several bodies, and runs of some of them: their meaning, and every mistake in them.

use super::{bad, good, mistakes::case};
use localshape::scene::{Limits, Scene};
use localshape::sim::Snapshot;
use std::sync::Arc;

/// Two bodies in space, and runs of both with one model, of both with a model each, and of each alone.
const TWO: &str = "\
gravity = [0, -9.8, 0]
time = { duration = 1, step = 1e-3 }
[[body]]
name = 'cube'
lattice = { cells = [2, 2, 2], side = 0.1 }
lowest = 0.1
[[body]]
name = 'block'
lattice = { cells = [2, 1, 1], side = 0.2, elements = 'tetrahedra' }
offset = [1, 0, 0]
lowest = 0.05
[[run]]
name = 'Both'
model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }
[[run]]
name = 'Each its own'
models = { cube = { kind = 'shape-based', stiffness = 1e4 }, block = { kind = 'mass-spring', stiffness = 2e4 } }
[[run]]
name = 'Cube alone'
bodies = ['cube']
model = { kind = 'shape-based', stiffness = 1e4 }
[[run]]
name = 'Block alone'
bodies = ['block']
model = { kind = 'mass-spring', stiffness = 2e4 }
[[obstacle]]
kind = 'floor'
restitution = 0.5
friction = 0.3
[[hold]]
nodes = { low = [-1, 0.25, -1], high = [2, 0.3, 1] }
until = 0.2
";

/// The snapshot of a run after some steps.
fn after(scene: &Scene, run: usize, steps: u64) -> Snapshot {
    let mut world = scene.world(run);
    world.advance(steps);
    world.snapshot()
}

/// The positions and velocities of a body of a run after some steps, as bits.
fn motion(scene: &Scene, run: &str, body: &str, steps: u64) -> Vec<[u64; 6]> {
    let at = scene.runs.iter().position(|known| known.name == run).expect("a run");
    let place = scene.runs[at].of.iter().position(|&of| scene.bodies[of].name == body).expect("a body of the run");
    let nodes = scene.runs[at].bodies.nodes(place);
    let Snapshot { position: positions, velocity: velocities, .. } = after(scene, at, steps);
    let bits = |node: usize| {
        let (position, velocity) = (positions[node].to_array(), velocities[node].to_array());
        [0, 1, 2, 3, 4, 5].map(|axis| [position, velocity].as_flattened()[axis].to_bits())
    };
    nodes.map(bits).collect()
}

#[test]
fn runs_have_the_bodies_and_models_that_they_name() {
    let scene = good(TWO);
    let names: Vec<_> = scene.bodies.iter().map(|body| &*body.name).collect();
    assert_eq!(names, ["cube", "block"]);
    let of: Vec<_> = scene.runs.iter().map(|run| run.of.clone()).collect();
    assert_eq!(of, [vec![0, 1], vec![0, 1], vec![0], vec![1]]);
    assert!(Arc::ptr_eq(&scene.runs[0].bodies, &scene.runs[1].bodies), "runs of the same bodies share them");
    let stiffness = |run: usize| {
        scene.runs[run].models_and_bodies().map(|(model, body)| model.properties(body).stiffness).collect::<Vec<_>>()
    };
    assert_eq!([0, 1, 2, 3].map(stiffness), [vec![1e4, 1e4], vec![1e4, 2e4], vec![1e4], vec![2e4]]);
    assert_eq!(scene.runs[0].initial.position.len(), 27 + 12);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // The order of names does not matter.
    let both = TWO.replace("bodies = ['cube']\nmodel = { kind", "bodies = ['block', 'cube']\nmodel = { kind");
    let scene = good(&both);
    assert_eq!(scene.runs[2].of, [0, 1]);
    assert!(Arc::ptr_eq(&scene.runs[0].bodies, &scene.runs[2].bodies));
}

/// A grip holds the nodes of its region in every run that has them.
#[test]
fn grips_count_nodes_over_the_bodies_of_each_run() {
    let scene = good(TWO);
    let nodes = |run: usize| scene.runs[run].grips.iter().map(|grip| grip.nodes.clone()).collect::<Vec<_>>();
    // The upper layers start at 0.3 m (the cube) and at 0.25 m (the block).
    let (cube, block) = (vec![6, 7, 8, 15, 16, 17, 24, 25, 26], vec![3, 4, 5, 9, 10, 11]);
    let both = vec![cube.clone(), block.iter().map(|node| node + 27).collect()];
    assert_eq!([0, 1, 2, 3].map(nodes), [both.clone(), both, vec![cube], vec![block]]);
    let only_block = good(&TWO.replace("low = [-1, ", "low = [0.5, "));
    assert_eq!(only_block.runs.iter().map(|run| run.grips.len()).collect::<Vec<_>>(), [1, 1, 0, 1]);
}

#[test]
fn bodies_together_move_like_each_alone() {
    let scene = good(TWO);
    for steps in [0, 1, 150, 700] {
        for (body, alone) in [("cube", "Cube alone"), ("block", "Block alone")] {
            let [together, alone] = ["Each its own", alone].map(|run| motion(&scene, run, body, steps));
            assert!(together == alone, "{body} after {steps} steps");
        }
    }
}

#[test]
fn the_order_of_bodies_changes_nothing_but_the_order_of_rows() {
    let bodies = &TWO[TWO.find("[[body]]").expect("bodies")..TWO.find("[[run]]").expect("runs")];
    let second = bodies.rfind("[[body]]").expect("two bodies");
    let text = TWO.replace("step = 1e-3", "step = 'auto'");
    let scene = good(&text);
    let turned = good(&text.replace(bodies, &[&bodies[second..], &bodies[..second]].concat()));
    assert_eq!(turned.bodies[0].name, "block");
    assert_ne!(scene.digest, turned.digest);
    for (run, other) in scene.runs.iter().zip(&turned.runs) {
        assert_eq!(run.step.to_bits(), other.step.to_bits(), "{}", run.name);
        for body in run.of.iter().map(|&body| &*scene.bodies[body].name) {
            let [one, two] = [&scene, &turned].map(|scene| motion(scene, &run.name, body, 300));
            assert!(one == two, "{body} in {}", run.name);
        }
    }
}

#[test]
fn one_body_may_be_a_list_of_one() {
    let table = "body = { lattice = { cells = [1, 1, 1], side = 0.1 }, mass = 2 }\n";
    let rest = "time.duration = 1\nrun = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]\n";
    let list = "body = [{ lattice = { cells = [1, 1, 1], side = 0.1 }, mass = 2 }]\n";
    let [one, other] = [table, list].map(|body| Scene { title: String::new(), ..good(&format!("{body}{rest}")) });
    assert_eq!(format!("{one:#?}"), format!("{other:#?}"));
    let named = good(&format!("{}{rest}", table.replace("body = {", "body = { name = 'cube',")));
    assert_eq!(named.bodies[0].name, "cube");
    assert_ne!(named.digest, one.digest);
}

#[test]
fn whatever_changes_a_body_or_its_runs_changes_the_digest() {
    let mut digests = vec![good(TWO).digest];
    for (from, to) in [
        ("'cube'\n", "'Cube'\n"),
        ("side = 0.2", "side = 0.21"),
        ("offset = [1,", "offset = [2,"),
        ("bodies = ['cube']\n", "bodies = ['block']\n"),
        ("bodies = ['cube']\n", ""),
        ("stiffness = 2e4 }", "stiffness = 3e4 }"),
        ("block = { kind = 'mass-spring',", "block = { kind = 'shape-based',"),
    ] {
        assert!(TWO.contains(from), "{from}");
        let mut text = TWO.replacen(from, to, 1);
        if to == "'Cube'\n" {
            text = text.replace("['cube']", "['Cube']").replace("cube =", "Cube =");
        }
        digests.push(good(&text).digest);
    }
    let all = digests.len();
    digests.sort();
    digests.dedup();
    assert_eq!(digests.len(), all);
    // A default may be typed or not, also in a list of bodies.
    let typed = TWO.replacen("side = 0.1 }", "side = 0.1, elements = 'cells', seed = 1 }", 1);
    assert_eq!(good(&typed).digest, good(TWO).digest);
}

#[test]
fn cycles_and_steps_follow_from_all_bodies() {
    let cycle = |text: &str| good(text).cycle();
    let stiffest = std::f64::consts::TAU / 2e4_f64.sqrt();
    assert!((cycle(TWO) / stiffest - 1.0).abs() < 1e-12);
    let light = TWO.replace("lowest = 0.1\n", "lowest = 0.1\nmass = 0.25\n");
    // Of the cube, with half of the other's stiffness.
    assert!((cycle(&light) / (stiffest * 0.5_f64.sqrt()) - 1.0).abs() < 1e-12);
    let auto = good(&TWO.replace("step = 1e-3", "step = 'auto'"));
    assert_eq!(auto.runs[0].step, auto.runs[3].step, "the scene's step is the least");
}

#[test]
fn names_that_cannot_be() {
    case(TWO, "name = 'block'", "name = 'cube'", "8:8 two bodies are called \"cube\": `body[0]` and `body[1]`");
    case(TWO, "name = 'block'\n", "", "7:1 `body[1]` has no `name`, which each of several bodies needs such as name");
    case(TWO, "name = 'block'", "name = 'a/b'", "8:8 the name \"a/b\" cannot be used in files");
    case(TWO, "name = 'block'", "name = ''", "8:8 `body[1].name` is empty; expected 1 to 80");
    case(TWO, "name = 'block'", "nam = 'block'", "8:1 unknown key `nam` in `body[1]` did you mean `name`?");
    let error = bad(&TWO.replace("[[body]]", "[body]"));
    let first = &error.mistakes()[0];
    assert_eq!((first.line, first.column, &*first.message), (7, 2, "`body` is given a second time"), "{error}");
    assert_eq!(first.help.as_deref(), Some("write `[[body]]` before each of several"));
}

#[test]
fn bodies_that_a_run_cannot_have() {
    case(TWO, "['cube']", "['cub']", "20:11 there is no body \"cub\" did you mean \"cube\"?");
    case(
        TWO,
        "['cube']",
        "['x', 'y']",
        "20:11 there is no body \"x\" the bodies are \"cube\" and \"block\"\n20:16 there is no body \"y\"",
    );
    case(TWO, "['cube']", "[]", "20:10 `run[2].bodies` is empty; expected at least 1");
    let twice = "20:19 `run[2].bodies[1]` is \"cube\", as is `run[2].bodies[0]` expected each body once";
    case(TWO, "['cube']", "['cube', 'cube']", twice);
    case(TWO, "['cube']", "'cube'", "20:10 `run[2].bodies` is the string \"cube\"; expected an array");
    let one = "body.lattice = { cells = [1, 1, 1], side = 1 }\ntime.duration = 1\n[[run]]\nname = 'a'\n\
               model = { kind = 'shape-based', stiffness = 1 }\nbodies = ['cube']\n";
    case(one, "[[run]]", "[[run]]", "6:11 there is no body \"cube\" the body of the scene has no `name`; give it one");
    let none = one.replace("bodies = ['cube']\n", "");
    case(
        &none,
        "body.lattice = { cells = [1, 1, 1], side = 1 }",
        "body = []",
        "1:8 `body` is empty; expected 1 to 1000",
    );
    let named = one.replace("body.lattice", "body.name = 'brick'\nbody.lattice");
    case(&named, "[[run]]", "[[run]]", "7:11 there is no body \"cube\" the body of the scene is \"brick\"");
}

#[test]
fn models_that_bodies_cannot_have() {
    let words = "17:59 there is no body \"blok\" did you mean \"block\"?";
    let at = TWO.lines().nth(16).and_then(|line| line.find("block =")).expect("a model") + 1;
    case(TWO, "block = { kind", "blok = { kind", &words.replace("17:59", &format!("17:{}", at + 7)));
    case(
        TWO,
        ", block = { kind = 'mass-spring', stiffness = 2e4 }",
        "",
        "17:10 `run[1].models` has no model for the body \"block\" it has models for \"cube\"",
    );
    case(
        TWO,
        "models = {",
        "bodies = ['cube']\nmodels = {",
        &format!("18:{at} `run[1].models` has a model for \"block\", which the run does not have remove it"),
    );
    let both = "model = { kind = 'shape-based', stiffness = 1 }\nmodels = {";
    case(TWO, "models = {", both, "18:1 `run[1]` has both `model` and `models`, which exclude each other");
    case(TWO, "models = {", "moels = {", "17:1 unknown key `moels` in `run[1]` did you mean `models`?");
    case(
        TWO,
        "stiffness = 2e4",
        "stifness = 2e4",
        &format!("17:{} unknown key `stifness` in `run[1].models.block`", at + 32),
    );
    let none = TWO.lines().filter(|line| !line.starts_with("models")).collect::<Vec<_>>().join("\n");
    case(&none, "[[run]]", "[[run]]", "15:1 `run[1]` has neither `model`, `models` nor `states`; one is needed");
}

#[test]
fn mistakes_in_one_of_several_bodies() {
    case(TWO, "side = 0.2", "side = -0.2", "9:39 `body[1].lattice.side` is -0.2; expected a number greater than 0");
    case(TWO, "'tetrahedra'", "'triangles'", "9:55 `body[1].lattice.elements` is \"triangles\"");
    case(TWO, "offset = [1, 0, 0]", "offset = [1, 0]", "10:10 `body[1].offset` has 2 coordinates; expected 3");
    let plane = "7:1 `body[1]` is in the plane, but `body[0]` is in space expected all bodies of a scene in the plane,";
    let flat = TWO.replace("offset = [1, 0, 0]\n", "");
    case(&flat, "cells = [2, 1, 1], side = 0.2, elements = 'tetrahedra'", "cells = [2, 1], side = 0.2", plane);
    let listed = "nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\nelements = [[0, 1, 2, 3], [0, 1, 2, 7]]";
    let lattice = "lattice = { cells = [2, 1, 1], side = 0.2, elements = 'tetrahedra' }";
    case(TWO, lattice, listed, "10:37 there is no node 7; the body has nodes 0 to 3");
    case(
        TWO,
        "kind = 'floor'",
        "kind = 'floor'\nheight = 0.07",
        "26:1 the body \"block\" starts inside this floor: node 0 lies 20",
    );
    case(
        TWO,
        "nodes = { low = [-1, 0.25, -1], high = [2, 0.3, 1] }",
        "nodes = [1, 2]",
        "31:9 `hold[0].nodes` is a list of nodes, but the scene has 2 bodies",
    );
    case(
        TWO,
        "high = [2, 0.3, 1]",
        "high = [2, 0.25, -0.9]",
        "31:9 is a region without nodes at the start the bodies start between",
    );
    let warned = good(
        &TWO.replace("name = 'Both'", "name = 'Both'\nbodies = ['cube']")
            .replace("models = {", "bodies = ['cube']\nmodel = { kind = 'shape-based', stiffness = 1e4 }\n#")
            .replace("bodies = ['block']", "bodies = ['cube']"),
    );
    let [warning] = &warned.warnings[..] else { panic!("{:?}", warned.warnings) };
    assert_eq!((warning.line, &*warning.message), (7, "no run has the body \"block\""));
}

#[test]
fn bodies_together_beyond_the_limits() {
    let few = Limits { nodes: 38, ..Limits::default() };
    let error = Scene::parse(TWO, "a", &few).expect_err("27 + 12 nodes").to_string();
    assert!(error.contains("a:5:21: all bodies together make 39 nodes, 18 elements"), "{error}");
    assert!(error.contains("the limit is 38 nodes"), "{error}");
    assert!(Scene::parse(TWO, "a", &Limits { nodes: 39, ..few }).is_ok());
    // The corners of all runs: 8 cubes in three of them, 10 tetrahedra in three.
    let corners = 3 * (8 * 8 + 10 * 4);
    assert!(Scene::parse(TWO, "a", &Limits { corners, ..Limits::default() }).is_ok());
    assert!(Scene::parse(TWO, "a", &Limits { corners: corners - 1, ..Limits::default() }).is_err());
    let error = bad(&TWO.replace("[2, 1, 1]", "[1000, 1000, 1000]"));
    assert_eq!(error.mistakes()[0].place, "body[1].lattice.cells");
}
