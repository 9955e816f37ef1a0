//! Scenes of several bodies: what holds, grabs, summaries and warnings say of each.

use super::{bad, expect, good};

/// Two bars and a cube, 1 m apart.
const WORLD: &str = "\
time = { duration = 1 }
run = [{ name = 'Shape', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = [
    { name = 'bar', lattice = { cells = [2, 1, 1], side = 0.1 }, mass_total = 2 },
    { name = 'cube', lattice = { cells = [1, 1, 1], side = 0.3 }, density = 1e3, offset = [1, 0, 0] },
]
";

const PLANE: &str = "\
time = { duration = 1 }
run = [{ name = 'Shape', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = [
    { name = 'bar', lattice = { cells = [2, 1], side = 0.1 } },
    { name = 'square', lattice = { cells = [1, 1], side = 0.3 }, offset = [1, 0] },
]
";

/// Adds lines to a world and expects exactly these mistakes in the addition.
#[track_caller]
fn case(world: &str, added: &str, expected: &str) {
    expect(&bad(&format!("{world}{added}")), world.lines().count(), expected);
}

#[test]
fn holds_and_grabs_have_nodes_of_all_bodies_or_of_one() {
    // Each body is gripped by itself.
    let nodes = |added: &str| {
        let scene = good(&format!("{WORLD}{added}"));
        scene.runs[0].grips.iter().flat_map(|grip| grip.nodes.clone()).collect::<Vec<_>>()
    };
    assert_eq!(nodes("[[hold]]\nnodes = 'left'"), [0, 3, 6, 9, 12, 14, 16, 18]);
    assert_eq!(nodes("[[hold]]\nbody = 'cube'\nnodes = 'left'"), [12, 14, 16, 18]);
    assert_eq!(nodes("[[hold]]\nbody = 'bar'\nnodes = [4, 1]"), [1, 4]);
    assert_eq!(nodes("[[hold]]\nbody = 'cube'\nnodes = [4, 1]"), [13, 16]);
    let path = "path.keys = [{ time = 0 }, { time = 1 }]";
    assert_eq!(nodes(&format!("[[grab]]\nbody = 'cube'\nnodes = [7]\n{path}")), [19]);
    // A region has nodes of one body even if others start in it.
    let below = "nodes = { low = [-9, -9, -9], high = [9, 0, 9] }";
    assert_eq!(nodes(&format!("[[hold]]\n{below}")).len(), 6 + 4);
    assert_eq!(nodes(&format!("[[hold]]\nbody = 'bar'\n{below}")), [0, 1, 2, 6, 7, 8]);
    // Runs without the body have no such nodes.
    let runs =
        "run = [{ name = 'Bar', bodies = ['bar'], model = { kind = 'shape-based', stiffness = 1 } }, { name = 'Both',";
    let scene =
        good(&format!("{WORLD}[[hold]]\nbody = 'cube'\nnodes = 'top'").replace("run = [{ name = 'Shape',", runs));
    assert_eq!((scene.runs[0].grips.len(), &scene.runs[1].grips[0].nodes[..]), (0, &[14, 15, 18, 19][..]));
}

#[test]
fn nodes_of_no_body() {
    case(
        WORLD,
        "[[hold]]\nnodes = [1]",
        "2:9 `hold[0].nodes` is a list of nodes, but the scene has 2 bodies name their body, such as body = \"bar\"",
    );
    case(WORLD, "[[hold]]\nbody = 'cub'\nnodes = [1]", "2:8 there is no body \"cub\" did you mean \"cube\"?");
    case(
        WORLD,
        "[[hold]]\nbody = 'x'\nnodes = 'top'",
        "2:8 there is no body \"x\" the bodies are \"bar\" and \"cube\"",
    );
    case(WORLD, "[[hold]]\nbody = 1\nnodes = 'top'", "2:8 `hold[0].body` is the whole number 1; expected a string");
    case(WORLD, "[[hold]]\nbody = 'cube'\nnodes = [8]", "3:10 there is no node 8; the body \"cube\" has nodes 0 to 7");
    case(
        WORLD,
        "[[hold]]\nbody = 'cube'\nnodes = { of = [0, 0, 0], within = 0.1 }",
        "3:9 a region without nodes at the start the body \"cube\" starts between [0.85, 0, -0.15] and [1.15, 0.3, 0.15] m",
    );
    case(
        WORLD,
        "[[hold]]\nbody = 'cube'\nnodes = [4]\n[[grab]]\nnodes = 'front'\npath.keys = [{ time = 0 }, { time = 1 }]",
        "5:9 node 4 of the body \"cube\" is held by `hold[0]` and grabbed by `grab[0]` at once",
    );
    case(
        PLANE,
        "[[hold]]\nbody = 'square'\nnodes = 'back'",
        "3:9 is \"back\", but the body \"square\" is in the plane",
    );
    case(PLANE, "[[hold]]\nnodes = 'back'", "2:9 `hold[0].nodes` is \"back\", but the body \"bar\" is in the plane");
    // One body without a name.
    let one = "time = { duration = 1 }\nrun = [{ name = 'a', model = { kind = 'shape-based', stiffness = 1 } }]
body = { fan = { sides = 5, radius = 1 } }\n";
    case(one, "[[hold]]\nbody = 'x'\nnodes = 'top'", "2:8 there is no body \"x\" the body of the scene has no `name`");
}

#[test]
fn masses_name_their_body() {
    let bars = "bars = { count = 2, length = 0.1, direction = [1, 0] }, density = 1";
    let wrong = PLANE.replace("lattice = { cells = [1, 1], side = 0.3 }", bars);
    expect(&bad(&wrong), 0, "5:80 `body[1].density` is a mass per area, but no element of the body has an area");
}

#[test]
fn a_model_that_does_not_take_elements_names_their_body() {
    let fan = PLANE.replace("lattice = { cells = [1, 1], side = 0.3 }", "fan = { sides = 5, radius = 1 }");
    let metric = fan.replace("'shape-based', stiffness", "'metric', young");
    expect(&bad(&metric), 0, "2:43 the body \"square\": element 0 has 3 nodes and is no cell of a lattice");
    let one = metric.replace("name = 'Shape'", "name = 'Shape', bodies = ['square']");
    expect(&bad(&one), 0, "2:64 element 0 has 3 nodes and is no cell of a lattice");
}

#[test]
fn a_summary_has_a_line_for_each_body() {
    let runs = "run = [
        { name = 'Both', step = 'T/40', models = { bar = { kind = 'mass-spring', stiffness = 1e3 },
            cube = { kind = 'shape-based', stiffness = 1e4 } } },
        { name = 'Bar', bodies = ['bar'], model = { kind = 'shape-based', stiffness = 1e3 } },
    ]";
    let first = WORLD.lines().nth(1).unwrap();
    let held =
        "[[hold]]\nnodes = 'left'\n[[grab]]\nbody = 'cube'\nnodes = [7]\npath.keys = [{ time = 0 }, { time = 1 }]";
    let scene = good(&format!("{WORLD}{held}").replace(first, runs));
    assert_eq!(scene.warnings, []);
    let summary = scene.summary();
    let text = summary.to_string();
    let lines: Vec<_> = text.lines().skip(1).filter(|line| !line.contains("time ") && !line.contains("ΔT")).collect();
    let expected = "  body      bar: 12 nodes, 2 cubes, 0.2 × 0.1 × 0.1 m, 2 kg
  start     between (-0.1, 0, -0.05) and (0.1, 0.1, 0.05) m
  body      cube: 8 nodes, 1 cube, 0.3 × 0.3 × 0.3 m, 27 kg
  start     between (0.85, 0, -0.15) and (1.15, 0.3, 0.15) m
  gravity   (0, 0, 0) m/s²";
    assert_eq!(lines[..5].join("\n"), expected);
    let runs = lines[6..].join("\n");
    for words in [
        "\n  run       Both\n            bar: 42 springs, k = 1 kN/m",
        "\n            cube: 1 cube, k = 10 kN/m, rotation",
        "\n  run       Bar\n            bar: 2 cubes, k = 1 kN/m",
        "\n  hold      4 nodes of bar from 0 s on\n  hold      4 nodes of cube from 0 s on\n",
        "\n  grab      node 7 of cube from 0 s until 1 s\n",
    ] {
        assert!(format!("\n{runs}").contains(words), "{words}\n{text}");
    }
    let [both, bar] = &summary.runs[..] else { panic!("two runs") };
    let limits: Vec<_> = [both, bar].map(|run| run.largest_step.unwrap()).to_vec();
    assert_eq!((both.limited_by.as_deref(), bar.limited_by.as_deref()), (Some("bar"), None));
    assert!(text.contains(" % used) of bar, ") && text.contains(" % used) with stretched springs\n"), "{text}");
    assert!(limits.iter().all(|&limit| limit > 0.0));
    let json = serde_json::to_value(&summary).unwrap();
    assert_eq!(json["bodies"][1]["name"], "cube");
    assert_eq!(json["bodies"][1]["mass"].as_f64().unwrap().round(), 27.0);
    assert_eq!(json["runs"][0]["parts"][1]["body"], "cube");
}

/// The warnings of a scene about its bodies at the start.
fn overlaps(text: &str) -> Vec<(usize, String)> {
    good(&format!("{text}contact.rule = 'nodes'"))
        .warnings
        .into_iter()
        .map(|warning| (warning.line, warning.message))
        .collect()
}

#[test]
fn bodies_that_overlap_at_the_start_are_told() {
    assert_eq!(overlaps(WORLD), []);
    let near = WORLD.replace("offset = [1, 0, 0]", "offset = [0.2, 0, 0]");
    let message = "\"bar\" and \"cube\" overlap at the start: bodies go through each other";
    assert_eq!(overlaps(&near), [(5, message.to_owned())]);
    // They stand side by side.
    assert_eq!(overlaps(&WORLD.replace("offset = [1, 0, 0]", "offset = [0.25, 0, 0]")), []);
    // No run has both.
    let model = "model = { kind = 'shape-based', stiffness = 1e4 }";
    let apart = format!("{{ name = 'A', bodies = ['bar'], {model} }}, {{ name = 'B', bodies = ['cube'], {model} }}");
    let first = near.lines().nth(1).unwrap();
    assert_eq!(overlaps(&near.replace(first, &format!("run = [{apart}]"))), []);
    let third = "\n    { name = 'third', lattice = { cells = [1, 1, 1], side = 0.3 } },\n]";
    let all = overlaps(&near.replace("\n]", third));
    let message = "\"bar\" and \"cube\" overlap at the start, and so do 2 other pairs: bodies go through each other";
    assert_eq!(all, [(5, message.to_owned())]);
    let flat = PLANE.replace("offset = [1, 0]", "offset = [0.1, 0.05]");
    assert_eq!(overlaps(&flat).len(), 1);
}

/// Two bodies of different size take as long as both.
#[test]
fn long_computations_are_those_of_all_bodies() {
    let long = |text: &str| {
        let told = good(text).warnings;
        told.into_iter().map(|warning| warning.message).find(|message| message.contains("take about"))
    };
    let slow = WORLD.replace("duration = 1", "duration = 2e7, frames_per_second = 0.1");
    let told = long(&slow).expect("a warning");
    assert!(told.contains("steps of all runs × 3 elements take about "), "{told}");
    let model = "model = { kind = 'shape-based', stiffness = 1e4 }";
    let first = slow.lines().nth(1).unwrap();
    let two = format!("run = [{{ name = 'A', {model} }}, {{ name = 'B', bodies = ['cube'], {model} }}]");
    let told = long(&slow.replace(first, &two)).expect("a warning");
    assert!(told.contains("steps of all runs × 1 to 3 elements take about "), "{told}");
}

#[test]
fn steps_near_the_limit_name_the_body() {
    let text = WORLD.replace("duration = 1", "duration = 1, step = 0.02").replace("frames_per_second", "");
    let told = good(&text).warnings;
    let [warning] = &told[..] else { panic!("{told:?}") };
    assert!(warning.message.contains(" s of \"bar\"; the run may diverge"), "{}", warning.message);
    // Models without a bound are asked for the prediction itself, and those far below it are not told.
    let finite = text.replace("'shape-based', stiffness = 1e4", "'corotational', young = 2e5");
    let warning = &good(&finite).warnings[0].message;
    assert!(
        warning.starts_with("the time step of \"Shape\" is 0.02 s, ") && warning.contains(" s of \"bar\""),
        "{warning}"
    );
    let limit = good(&finite).summary().runs[0].largest_step.expect("a limit");
    for (share, told) in [(0.3, 0), (0.85, 0), (0.95, 1)] {
        let near = finite.replace("step = 0.02", &format!("step = {}", share * limit));
        assert_eq!(good(&near).warnings.len(), told, "{share}");
    }
}
