//! Mistakes in obstacles, paths and grips, and the meaning of correct ones.

use super::{bad, expect, good};
use glam::DVec3;
use localshape::scene::description;

/// The nodes of two cubes, with their middle over the origin, 0.1 m above it.
const WORLD: &str = "\
time = { duration = 1 }
run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = { lattice = { cells = [2, 1, 1], side = 0.1 }, offset = [0, 0.1, 0] }
";

/// A world in the plane.
const PLANE: &str = "\
time = { duration = 1 }
run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]
body = { lattice = { cells = [2, 1], side = 0.1 }, offset = [0, 0.1] }
";

/// Adds lines to a world and expects exactly these mistakes in the addition.
#[track_caller]
fn case(world: &str, added: &str, expected: &str) {
    expect(&bad(&format!("{world}{added}")), 3, expected);
}

fn sphere(more: &str) -> String {
    format!("[[obstacle]]\nkind = 'sphere'\ncentre = [1, 1, 1]\nradius = 0.1\n{more}")
}

#[test]
fn keys_out_of_order() {
    let path = |keys: &str| sphere(&format!("path.keys = [{keys}]"));
    case(
        WORLD,
        &path("{ time = 1 }, { time = 0.5, shift = [0, 0, 1] }"),
        "5:37 `obstacle[0].path.keys[1]` is at 0.5 s, not later than the key before it at 1 s list the keys in rising",
    );
    case(WORLD, &path("{ time = 1 }, { time = 1 }"), "5:37 not later than the key before it");
    case(WORLD, &path("{ time = -1 }"), "5:23 is -1; expected a number of at least 0");
    case(WORLD, &path(""), "5:13 `obstacle[0].path.keys` is empty");
    case(WORLD, &path("{ shift = [0, 0, 1] }"), "5:14 `obstacle[0].path.keys[0]` has no `time`");
    case(WORLD, &path("{ time = 0, shift = [0, 1] }"), "5:34 has 2 coordinates; expected 3");
    case(WORLD, &path("{ time = 0, rotation = { angle = 1 } }"), "5:37 has no `axis`");
    case(
        WORLD,
        &path("{ time = 0, rotation = { axis = [0, 0, 0], angle = 1 } }"),
        "5:46 is zero, so it has no direction",
    );
}

#[test]
fn paths_that_would_jump_or_go_nowhere() {
    case(
        WORLD,
        &sphere("path = { repeat = true, keys = [{ time = 0 }, { time = 1, shift = [0, 0, 1] }] }"),
        "5:47 repeats, but does not end where it begins, so the motion would jump",
    );
    case(WORLD, &sphere("path = { repeat = true, keys = [{ time = 0 }] }"), "5:8 repeats, but has a single key");
    case(WORLD, &sphere("swing = { period = 1 }"), "5:9 has neither `shift` nor `rotation`");
    case(
        WORLD,
        &sphere("swing = { period = 1, shift = [1, 0, 0] }\npath.keys = [{ time = 0 }]"),
        "6:1 has both `path` and `swing`, which exclude each other keep one",
    );
    // A full rotation ends where it begins.
    good(&format!(
        "{WORLD}{}",
        sphere(
            "path = { repeat = true, keys = [{ time = 0 }, { time = 1, rotation = { axis = [0, 1, 0], angle = 6.283185307 } }] }"
        )
    ));
}

#[test]
fn motions_that_a_step_cannot_follow() {
    // T/50 is 0.00126 s.
    case(
        WORLD,
        &sphere("swing = { period = 1e-3, shift = [1, 0, 0] }"),
        "5:20 one oscillation takes 0.001 s, but a time step takes 1.257e-3 s use a period of at least 4 steps",
    );
    case(
        WORLD,
        &sphere("path.keys = [{ time = 0 }, { time = 1e-9, shift = [1, 0, 0] }]"),
        "5:37 `obstacle[0].path.keys[1]` is 1.000e-9 s after the key before it, but a time step takes 1.257e-3 s",
    );
    case(
        WORLD,
        "[[hold]]\nnodes = [1]\nfrom = 0.5\nuntil = 0.5005",
        "4:9 `hold[0]` lasts 5.000e-4 s, but a time step takes 1.257e-3 s make it longer",
    );
    case(WORLD, "[[grab]]\nnodes = [1]\npath.keys = [{ time = 0.5 }, { time = 0.5001 }]", "3:39 the motion would jump");
}

/// All runs must be able to follow a path: the longest time step counts.
#[test]
fn motions_that_the_longest_of_several_steps_cannot_follow() {
    let run = |name: &str, step: &str| {
        format!("{{ name = '{name}', step = {step}, model = {{ kind = 'shape-based', stiffness = 1e4 }} }}")
    };
    let world = |steps: [&str; 2]| {
        let runs = format!("run = [{}, {}]", run("one", steps[0]), run("other", steps[1]));
        WORLD
            .lines()
            .map(|line| if line.starts_with("run") { format!("{runs}\n") } else { format!("{line}\n") })
            .collect::<String>()
    };
    let path = sphere("path.keys = [{ time = 0 }, { time = 0.005, shift = [1, 0, 0] }]");
    let hold = "[[hold]]\nnodes = [1]\nfrom = 0.5\nuntil = 0.505";
    let grab = "[[grab]]\nnodes = [1]\npath.keys = [{ time = 0.5 }, { time = 0.505 }]";
    let swing = sphere("swing = { period = 0.03, shift = [1, 0, 0] }");
    for steps in [["1e-3", "1e-2"], ["1e-2", "1e-3"]] {
        let world = world(steps);
        case(&world, &path, "5:37 is 5.000e-3 s after the key before it, but a time step takes 1.000e-2 s");
        case(&world, hold, "4:9 lasts 5.000e-3 s, but a time step takes 1.000e-2 s");
        case(&world, grab, "3:39 is 5.000e-3 s after the key before it, but a time step takes 1.000e-2 s");
        case(&world, &swing, "5:20 one oscillation takes 0.03 s, but a time step takes 1.000e-2 s");
    }
    let short = world(["1e-3", "2e-3"]);
    [path.as_str(), hold, grab, &swing].iter().for_each(|added| drop(good(&format!("{short}{added}"))));
}

#[test]
fn an_obstacle_turns_about_its_middle_or_another_point() {
    let pendulum = sphere(
        "about = [1, 2, 1]\nswing = { period = 1, rotation = { axis = [0, 0, 1], angle = 1.5707963267948966 } }",
    );
    let scene = good(&format!("{WORLD}{pendulum}"));
    let obstacle = &scene.obstacles[0];
    let middle = obstacle.pose(0.25).apply(obstacle.pivot, DVec3::ONE);
    assert!(middle.distance(DVec3::new(2.0, 2.0, 1.0)) < 1e-12, "{middle}");
    case(WORLD, &sphere("about = [1, 2]"), "5:9 `obstacle[0].about` has 2 coordinates; expected 3");
}

#[test]
fn convex_elements_may_list_their_nodes_in_any_order() {
    let head = "time = { duration = 1 }\nrun = [{ name = 'one', model = { kind = 'mass-spring', stiffness = 1, springs = 'edges' } }]\n";
    let octahedron =
        "[body]\nnodes = [[1,0,0],[0,-1,0],[0,0,1],[-1,0,0],[0,1,0],[0,0,-1]]\nelements = [[0,1,2,3,4,5]]\n";
    let scene = good(&format!("{head}{octahedron}convex = true"));
    assert!(description(scene.runs[0].models[0].as_ref(), &scene.bodies[0].body).starts_with("12 springs"));
    assert_eq!(scene.bodies[0].body.faces().nodes.len(), 8);
    let cloth = "[body]\nnodes = [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]\nelements = [[0,1,2,3]]\n";
    assert_eq!(good(&format!("{head}{cloth}convex = true")).bodies[0].body.faces().nodes.len(), 1);
    let error = bad(&format!("{head}{cloth}")).to_string();
    assert!(error.contains("no volume: its nodes are in a plane, or not in their order"), "{error}");
    assert!(error.contains("write convex = true in [body]"), "{error}");
}

#[test]
fn polygons_whose_sides_cross() {
    let head = "time = { duration = 1 }\nrun = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1 } }]\n";
    let error = bad(&format!("{head}[body]\nnodes = [[0,0],[2,0],[0,1],[1,1.5]]\nelements = [[0,1,2,3]]")).to_string();
    assert!(error.contains("the sides 1–2 and 3–0 of `body.elements[0]` cross"), "{error}");
}

#[test]
fn obstacles_without_extent_or_direction() {
    case(
        WORLD,
        "[[obstacle]]\nkind = 'sphere'\ncentre = [1, 1, 1]\nradius = 0",
        "4:10 expected a number greater than 0",
    );
    case(WORLD, "[[obstacle]]\nkind = 'box'\ncentre = [1, 1, 1]\nsize = [1, 0, 1]", "4:12 `obstacle[0].size[1]` is 0");
    case(
        WORLD,
        "[[obstacle]]\nkind = 'plate'\npoint = [0, 1, 0]\nnormal = [0, 0, 0]",
        "4:10 is zero, so it has no direction",
    );
    case(WORLD, "[[obstacle]]\nkind = 'plate'\npoint = [0, 1, 0]", "1:1 `obstacle[0]` has no `normal`");
    case(WORLD, "[[obstacle]]\nkind = 'ball'", "2:8 \"sphere\"");
    case(
        WORLD,
        "[[obstacle]]\nkind = 'capsule'\nfrom = [1, 1, 1]\nto = [1, 1]\nradius = 1e-3",
        "4:6 has 2 coordinates",
    );
    case(
        PLANE,
        "[[obstacle]]\nkind = 'box'\ncentre = [1, 1]\nsize = [1, 1]\nrotation = { axis = [0, 0, 1], angle = 1 }",
        "5:14 has an `axis`, but the body is in the plane",
    );
}

#[test]
fn obstacles_that_start_inside_the_body() {
    let touching = "[[obstacle]]\nkind = 'sphere'\ncentre = [0, 0.1, 0]\nradius = 0.08";
    case(WORLD, touching, "1:1 the body reaches 80 mm into this sphere at the start, at node 1 move one");
    let hidden = "[[obstacle]]\nkind = 'sphere'\ncentre = [0.05, 0.15, 0]\nradius = 0.01";
    case(WORLD, hidden, "1:1 the body reaches 60 mm into this sphere at the start, at node 1 move one");
    let hidden = "[[obstacle]]\nkind = 'box'\ncentre = [0.05, 0.15]\nsize = [0.01, 0.01]";
    case(PLANE, hidden, "1:1 the body reaches 45 mm into this box at the start, at node");
    let floor = "[[obstacle]]\nkind = 'floor'\nheight = 0.15";
    case(WORLD, floor, "1:1 the body starts inside this floor: node 0 lies 50 mm below its surface move the floor");
    // Straight through it, between all nodes.
    let rod = "[[obstacle]]\nkind = 'capsule'\nfrom = [0.05, 0.15, -1]\nto = [0.05, 0.15, 1]\nradius = 0.01";
    case(WORLD, rod, "1:1 the body reaches 10 mm into this capsule at the start, at node");
    // A path that starts elsewhere is accepted, and so is contact with a floor.
    let away = "path.keys = [{ time = 0, shift = [0, 9, 0] }]";
    good(&format!("{WORLD}{touching}\n{away}"));
    good(&format!("{WORLD}[[obstacle]]\nkind = 'floor'\nheight = 0.1"));
}

#[test]
fn nodes_in_two_hands_at_once() {
    let grab = "path.keys = [{ time = 0.2 }, { time = 0.5, shift = [0, 1, 0] }]\n";
    let both = format!("[[hold]]\nnodes = [1, 2]\n[[grab]]\nnodes = [2, 3]\n{grab}");
    case(
        WORLD,
        &both,
        "4:9 node 2 is held by `hold[0]` and grabbed by `grab[0]` at once, from 0.2 s until 0.5 s assign each node",
    );
    let twice = "[[hold]]\nnodes = [1]\n[[hold]]\nnodes = { low = [-1, -1, -1], high = [1, 1, 1] }\n";
    case(WORLD, twice, "4:9 node 1 is held by `hold[0]` and held by `hold[1]` at once, from 0 s on");
    // Consecutive holds are correct.
    let scene = good(&format!("{WORLD}{}", both.replace("nodes = [1, 2]", "nodes = [1, 2]\nuntil = 0.2")));
    assert_eq!(
        scene.runs[0].grips.iter().map(|grip| (grip.from, grip.until)).collect::<Vec<_>>(),
        [(0.0, 0.2), (0.2, 0.5)]
    );
}

#[test]
fn nodes_that_are_none() {
    case(WORLD, "[[hold]]\nnodes = [1, 12]", "2:13 there is no node 12; the body has nodes 0 to 11");
    case(WORLD, "[[hold]]\nnodes = [1, 1]", "2:13 node 1 occurs twice in `hold[0].nodes`");
    case(WORLD, "[[hold]]\nnodes = []", "2:9 is empty");
    case(WORLD, "[[hold]]\nnodes = 1", "2:9 is the whole number 1; expected an array, a string or a table");
    case(WORLD, "[[hold]]\nnodes = 'bak'", "2:9 \"front\" or \"back\" did you mean \"back\"?");
    case(
        PLANE,
        "[[hold]]\nnodes = 'front'",
        "2:9 `hold[0].nodes` is \"front\", but the body is in the plane expected \"left\", \"right\", \"bottom\" or \"top\"",
    );
    case(
        WORLD,
        "[[hold]]\nnodes = { of = [9, 9, 9], within = 1 }",
        "2:9 is a region without nodes at the start the body starts between [-0.1, 0.1, -0.05] and [0.1, 0.2, 0.05] m",
    );
    case(
        PLANE,
        "[[grab]]\nnodes = { low = [-1, -1], high = [1, 0] }\npath.keys = [{ time = 0 }, { time = 1 }]",
        "2:9 without nodes at the start the body starts between [-0.1, 0.1] and [0.1, 0.2] m",
    );
    case(WORLD, "[[hold]]\nnodes = { of = [9, 9, 9] }", "2:9 has `of` but no `within`");
    case(WORLD, "[[hold]]\nnodes = [1]\nfrom = 2\nuntil = 1", "4:9 ends at 1 s, not later than it begins at 2 s");
    case(WORLD, "[[grab]]\nnodes = [1]\npath.keys = [{ time = 1 }]", "3:1 has a single key");
    let backwards = "[[grab]]\nnodes = [1]\npath.keys = [{ time = 1 }, { time = 0.5 }]";
    case(WORLD, backwards, "3:37 `grab[0].path.keys[1]` is at 0.5 s, not later than the key before it at 1 s");
    case(
        WORLD,
        "[[grab]]\nnodes = [1]\npath = { repeat = true, keys = [{ time = 1 }, { time = 2 }] }",
        "3:10 repeats, so the nodes would never be released",
    );
    case(WORLD, "[[grab]]\nnodes = [1]", "1:1 `grab[0]` has no `path`");
}

#[test]
fn regions_hold_the_nodes_that_start_in_them() {
    let scene = good(&format!(
        "{WORLD}[[hold]]\nnodes = {{ of = [0.1, 0.2, 0.05], within = 0.11 }}\n\
         [[hold]]\nnodes = {{ low = [-0.1, 0.1, -0.05], high = [-0.1, 0.1, 0.05] }}"
    ));
    assert_eq!(scene.runs[0].grips[0].nodes, [5, 8, 10, 11]);
    assert_eq!(scene.runs[0].grips[1].nodes, [0, 6]);
}

/// Sides are those of the rest shape, wherever the body starts.
#[test]
fn sides_are_those_of_the_rest_shape() {
    let held = |world: &str, side: &str| {
        let turned = world.replace("offset", "rotation = { TURN }, start.shape = 'cloud', offset");
        let turn = if world.contains("cells = [2, 1, 1]") { "axis = [1, 2, 3], angle = 1" } else { "angle = 1" };
        let scene = good(&format!("{}[[hold]]\nnodes = '{side}'", turned.replace("TURN", turn)));
        assert_eq!(scene.warnings, []);
        scene.runs[0].grips[0].nodes.clone()
    };
    assert_eq!(held(WORLD, "left"), [0, 3, 6, 9]);
    assert_eq!(held(WORLD, "right"), [2, 5, 8, 11]);
    assert_eq!(held(WORLD, "bottom"), [0, 1, 2, 6, 7, 8]);
    assert_eq!(held(WORLD, "top"), [3, 4, 5, 9, 10, 11]);
    assert_eq!(held(WORLD, "back"), [0, 1, 2, 3, 4, 5]);
    assert_eq!(held(WORLD, "front"), [6, 7, 8, 9, 10, 11]);
    let sides = ["left", "right", "bottom", "top"].map(|side| held(PLANE, side));
    assert_eq!(sides, [vec![0, 3], vec![2, 5], vec![0, 1, 2], vec![3, 4, 5]]);
    // Nodes of a side are at one height to round-off; a corner is a side of one node.
    let polygon = |sides| {
        PLANE.replace(
            "lattice = { cells = [2, 1], side = 0.1 }",
            &format!("polygon = {{ sides = {sides}, radius = 1 }}"),
        )
    };
    assert_eq!(held(&polygon(10), "top"), [5, 6]);
    assert_eq!(held(&polygon(5), "top"), [3]);
}

/// Coordinates of a lattice are sums, such as ±0.30000000000000004 m, and thirds, which are not typed in full.
#[test]
fn nodes_on_the_border_of_a_region_are_in_it() {
    let held = |body: &str, region: &str| {
        let world = WORLD.replace("[2, 1, 1], side = 0.1 }, offset = [0, 0.1, 0]", body);
        let scene = good(&format!("{world}[[hold]]\nnodes = {{ {region} }}"));
        (scene.runs[0].grips[0].nodes.len(), scene.summary().to_string(), scene.warnings)
    };
    let bar = "[6, 2, 2], side = 0.1 }";
    assert_eq!(held(bar, "low = [-0.3, 0, -0.1], high = [-0.3, 0.2, 0.1]").0, 9);
    assert_eq!(held(bar, "low = [-0.31, 0, -0.1], high = [-0.2, 0.2, 0.1]").0, 18);
    assert_eq!(held(bar, "of = [0, 0.1, 0], within = 0.3").0, 7 + 4 * 5 + 4 * 5);
    // The selection that `check` prints is that of the whole body.
    let thirds = "[2, 2, 2], side = [0.3333333333333333, 0.7071067811865476, 1e-3] }, offset = [1e-3, 2, 3]";
    let (_, summary, _) = held(thirds, "of = [0, 2, 3], within = 9");
    let start = summary.lines().find_map(|line| line.trim().strip_prefix("start")).expect("where it starts");
    let [low, high] = start
        .trim()
        .strip_prefix("between (")
        .unwrap()
        .strip_suffix(") m")
        .unwrap()
        .split(") and (")
        .collect::<Vec<_>>()[..]
    else {
        panic!("{start}")
    };
    assert_eq!(held(thirds, &format!("low = [{low}], high = [{high}]")).0, 27);
}

/// Any number of consecutive grips, and one that begins too early.
#[test]
fn many_hands_in_turn() {
    let turns = 20_000;
    let hold = |at: usize| format!("[[hold]]\nnodes = [1]\nfrom = {at}\nuntil = {}\n", at + 1);
    let mut holds: Vec<String> = (0..turns).map(hold).collect();
    assert_eq!(good(&format!("{WORLD}{}", holds.concat())).runs[0].grips.len(), turns);
    holds[7] = hold(7).replace("until = 8", "until = 9.5");
    let told = "node 1 is held by `hold[7]` and held by `hold[8]` at once, from 8 s until 9 s";
    let later = "node 1 is held by `hold[7]` and held by `hold[9]` at once, from 9 s until 9.5 s";
    case(WORLD, &holds[..12].concat(), &format!("34:9 {told}\n38:9 {later}"));
}

/// A bar of 2 × 2 cells, which stands on y = 0.
#[test]
fn a_box_that_takes_a_part_of_a_layer_is_told() {
    let world = WORLD.replace("[2, 1, 1]", "[6, 2, 2]").replace(", offset = [0, 0.1, 0]", "");
    let warnings = |region: &str| good(&format!("{world}[[hold]]\nnodes = {{ {region} }}")).warnings;
    let told = warnings("low = [-0.31, -0.15, -0.15], high = [-0.29, 0.15, 0.15]");
    let [warning] = &told[..] else { panic!("{told:?}") };
    assert_eq!((warning.line, warning.column), (5, 9));
    assert_eq!(warning.message, "`hold[0].nodes` takes 6 of the 9 nodes of a layer of the body");
    let help = "this layer starts between [-0.3, 0, -0.1] and [-0.3, 0.2, 0.1] m";
    assert_eq!(warning.help.as_deref(), Some(help));
    let told = warnings("low = [-0.31, -0.15, -0.15], high = [-0.15, 0.15, 0.15]");
    assert_eq!(told[0].message, "`hold[0].nodes` takes 12 of the 18 nodes of 2 layers of the body");
    let help = "these layers start between [-0.3, 0, -0.1] and [-0.2, 0.2, 0.1] m";
    assert_eq!(told[0].help.as_deref(), Some(help));
    for whole in [
        "low = [-0.31, -1, -1], high = [-0.29, 1, 1]",
        "low = [-0.31, -1, -1], high = [-0.15, 1, 1]",
        // The lower part of the whole bar and of most of it; an edge; a row; corners.
        "low = [-1, -1, -1], high = [1, 0.15, 1]",
        "low = [-1, -1, -1], high = [0.01, 0.15, 1]",
        "low = [-0.31, -0.01, -1], high = [-0.29, 0.01, 1]",
        "low = [-0.31, 0.09, -0.05], high = [1, 0.11, 0.05]",
        "low = [-0.31, -0.01, -0.15], high = [-0.29, 0.01, -0.05]",
        "low = [-0.31, -0.01, -0.15], high = [-0.15, 0.01, -0.05]",
        "of = [-0.3, 0, 0], within = 0.12",
    ] {
        assert_eq!(warnings(whole), [], "{whole}");
    }
    // Exactly half of the layers are not thin.
    let six = world.replace("[6, 2, 2]", "[5, 2, 2]");
    let half = "low = [-1, -1, -1], high = [-0.04, 0.15, 0.05]";
    assert_eq!(good(&format!("{six}[[hold]]\nnodes = {{ {half} }}")).warnings, []);
    let less = half.replace("-0.04", "-0.14");
    assert_eq!(good(&format!("{six}[[hold]]\nnodes = {{ {less} }}")).warnings.len(), 1);
    let plane = "[[grab]]\nnodes = { low = [-0.2, 0.1], high = [0.01, 0.1] }\npath.keys = [{ time = 0 }, { time = 1 }]";
    let told = good(&format!("{PLANE}{plane}")).warnings;
    assert_eq!(told[0].message, "`grab[0].nodes` takes 2 of the 3 nodes of a layer of the body");
    // Layers rotate with the body: here an upright one, whose lower end is cut.
    let upright =
        world.replace("side = 0.1 }", "side = 0.1 }, rotation = { axis = [0, 0, 1], angle = 1.5707963267948966 }");
    let told =
        good(&format!("{upright}[[hold]]\nnodes = {{ low = [-0.15, -0.21, -1], high = [0.05, -0.19, 1] }}")).warnings;
    assert_eq!(told[0].message, "`hold[0].nodes` takes 6 of the 9 nodes of a layer of the body");
    let help = "this layer starts between [-0.1, -0.2, -0.1] and [0.1, -0.2, 0.1] m";
    assert_eq!(told[0].help.as_deref(), Some(help));
    // An oblique cut is not a layer.
    let turned = PLANE.replace("offset", "rotation = { angle = 0.3 }, offset");
    assert_eq!(good(&format!("{turned}[[hold]]\nnodes = {{ low = [-1, 0], high = [0, 1] }}")).warnings, []);
}

#[test]
fn a_summary_tells_of_obstacles_and_grips() {
    let scene = good(&format!(
        "{WORLD}{}[[obstacle]]\nkind = 'floor'\n[[hold]]\nnodes = [0]\n[[grab]]\nnodes = [3, 4]\n\
         path.keys = [{{ time = 0.5 }}, {{ time = 0.7, shift = [0, 1, 0] }}]",
        sphere("swing = { period = 2, shift = [0.1, 0, 0] }\n")
    ));
    let text = scene.summary().to_string();
    for line in [
        "obstacle  sphere at (1, 1, 1) m, radius 0.1 m, e = 0, μ = 0, swinging once in 2 s",
        "obstacle  floor at 0 m along (0, 1, 0), e = 0, μ = 0",
        "hold      node 0 from 0 s on",
        "grab      2 nodes from 0.5 s until 0.7 s",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
}

#[test]
fn a_spin_turns_about_the_middle() {
    let spin = |world: &str, spin: &str| good(&world.replace("offset", &format!("spin = {spin}, offset")));
    let scene = spin(WORLD, "{ axis = [0, 2, 0], rate = 3 }");
    for (position, velocity) in scene.runs[0].initial.position.iter().zip(&scene.runs[0].initial.velocity) {
        assert!((*velocity - DVec3::new(3.0 * position.z, 0.0, -3.0 * position.x)).length() < 1e-15);
    }
    let scene = spin(PLANE, "{ rate = -2 }");
    assert!((scene.runs[0].initial.velocity[0] - DVec3::new(-0.1, 0.2, 0.0)).length() < 1e-15);
    case(&WORLD.replace("offset", "spin = { rate = 1 }, offset"), "", "0:62 `body.spin` has no `axis`");
}
