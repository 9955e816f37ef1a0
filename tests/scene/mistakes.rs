//! Every possible mistake in a scene: its position and its message.

use super::{bad, expect};
use localshape::scene::{Limits, Scene, SceneError};

/// A correct scene with a listed body in the plane; each case changes some of its lines.
pub(crate) const PLANE: &str = "\
gravity = [0, -9.8]
[time]
duration = 3
step = 'T/50'
[body]
nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]
elements = [[0, 1, 2], [0, 2, 3]]
springs = [[0, 1]]
mass = 1
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
[[run]]
name = 'Mass-spring'
model = { kind = 'mass-spring', stiffness = 1e4 }
[[obstacle]]
kind = 'floor'
restitution = 0.5
[view]
size = [640, 360]
";

/// The scene with one cube in space.
const SPACE: &str = "\
gravity = [0, -9.8, 0]
[time]
duration = 3
[body]
lattice = { cells = [1, 1, 1], side = 0.1 }
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
";

/// Replaces `from` in a scene, and expects exactly these mistakes.
#[track_caller]
pub(crate) fn case(scene: &str, from: &str, to: &str, expected: &str) {
    assert!(scene.contains(from), "the scene has no {from:?}");
    expect(&bad(&scene.replacen(from, to, 1)), 0, expected);
}

/// The limit is reported before pairs are compared, for any number of elements.
#[test]
fn more_runs_than_there_may_be() {
    let run = "[[run]]\nname = 'Local shape'\nmodel = { kind = 'shape-based', stiffness = 1e4 }\n";
    let error = bad(&format!("{SPACE}{}", run.repeat(100_000)));
    let [limit, rest @ ..] = error.mistakes() else { panic!("{error}") };
    assert_eq!((limit.line, limit.message.as_str()), (6, "`run` has 100001 entries; expected 1 to 256"));
    // Elements within the limit are checked.
    assert_eq!(rest.len(), 255, "{error}");
    assert!(rest[254].message.starts_with("two runs are called"), "{error}");
    let error = bad(&format!("{SPACE}{}", run.replace("name", "nam").repeat(100_000)));
    assert_eq!(error.mistakes().len(), 1 + 255, "{error}");
}

/// Unknown keys would each be compared with all known ones, for minutes; only a thousand are kept.
#[test]
fn very_many_unknown_keys_are_counted() {
    let keys = |from: usize| (from..from + 300_000).map(|at| format!("key{at} = 1\n")).collect::<String>();
    let error = bad(&format!("{}{SPACE}{}", keys(0), keys(300_000)));
    let SceneError::Mistakes(mistakes) = &error else { panic!("{error}") };
    assert_eq!((mistakes.found.len(), mistakes.total), (1000, 600_000));
    assert!(error.to_string().ends_with("and 599980 more"));
}

#[test]
fn unknown_keys() {
    // A misspelt key is not reported as missing as well.
    case(PLANE, "stiffness", "stifness", "12:33 unknown key `stifness` in `run[0].model` did you mean `stiffness`?");
    case(PLANE, "step", "Step", "4:1 unknown key `Step` in `time` did you mean `step`?");
    case(PLANE, "nodes =", "node =", "6:1 did you mean `nodes`?");
    case(PLANE, "[view]", "[viev]", "19:2 unknown key `viev` did you mean `view`?");
    case(PLANE, "[time]", "[tiem]", "2:2 did you mean `time`?");
    case(
        PLANE,
        "mass = 1",
        "hue = 1",
        "9:1 unknown key `hue` in `body` known here: name, lattice, polygon, fan, disc, bars,",
    );
    case(PLANE, "mass = 1", "colour = 1", "9:1 `colour` belongs to `run` or `view`; known");
    case(PLANE, "mass = 1", "friction = 1", "9:1 `friction` belongs to `obstacle`");
    // Another kind of the same table takes precedence over similar keys and other tables.
    let (shape, springs) = ("kind = 'shape-based', ", "kind = 'mass-spring', ");
    let words = "`springs` belongs to kind = \"mass-spring\", ";
    case(PLANE, shape, &format!("{shape}springs = 'all', "), &format!("12:33 {words}"));
    let words = "`damping_of` belongs to kind = \"shape-based\"; known here: kind, stiffness";
    case(PLANE, springs, &format!("{springs}damping_of = 'deformation', "), &format!("15:33 {words}"));
    case(PLANE, "step = 'T/50'", "step = 0", "4:8 expected a number greater than 0 A time step in seconds, or a");
    case(PLANE, "duration = 3", "duration = 3\nfps = 30", "4:1 did you mean `frames_per_second`?");
    case(PLANE, "mass = 1", "azimuth = 1", "9:1 `azimuth` belongs to `view.camera`");
    case(SPACE, "side = 0.1", "side = 0.1, rotation = 1", "5:44 `rotation` belongs to `body`");
    case(PLANE, "mass = 1", "\"\" = 1", "9:1 unknown key `` in `body`");
    case(PLANE, "mass = 1", "\"a\\u0007\" = 1", "9:1 unknown key `a\u{fffd}`");
}

#[test]
fn missing_keys() {
    case(PLANE, "duration = 3\n", "", "2:1 `time` has no `duration` `duration`: Simulated time (s)");
    case(PLANE, "[time]\nduration = 3\nstep = 'T/50'\n", "", "1:1 there is no table [time]");
    case(PLANE, "stiffness = 1e4", "damping = 1", "12:9 has neither `stiffness` nor `young`; one is needed");
    case(PLANE, "name = 'Local shape'\n", "", "10:1 `run[0]` has no `name`");
    case(
        PLANE,
        "kind = 'floor'\n",
        "",
        "16:1 `obstacle[0]` has no `kind`; expected \"floor\", \"plate\", \"sphere\", \"capsule\" or \"box\" such as kind = \"floor\"",
    );
    case(PLANE, "kind = 'mass-spring', ", "", "15:9 has no `kind`; expected \"shape-based\", \"mass-spring\", ");
    case(SPACE, ", side = 0.1", "", "5:11 `body.lattice` has no `side` `side`: Length of a cell's edges (m)");
    case(
        SPACE,
        "lattice = { cells = [1, 1, 1], side = 0.1 }",
        "mass = 1",
        "4:1 `body` has neither `lattice`, `polygon`, `fan`, `disc`, `bars`, `nodes` and `elements`, `mesh` nor `file`; one",
    );
    case(PLANE, "elements = [[0, 1, 2], [0, 2, 3]]\n", "", "5:1 `body` has `nodes` but no `elements`");
    let nothing = bad("title = 'nothing'");
    let words: Vec<_> = nothing.mistakes().iter().map(|mistake| mistake.message.as_str()).collect();
    assert_eq!(words, ["there is no table [time]", "there is no table [body]", "there is no table [[run]]"]);
}

#[test]
fn wrong_types() {
    case(PLANE, "= 3", "= 'x'", "3:12 `time.duration` is the string \"x\"; expected a number Simulated time (s)");
    case(PLANE, "= 3", "= [3]", "3:12 is an array of 1; expected a number");
    case(PLANE, "= 3", "= 1979-05-27", "3:12 is the date 1979-05-27; expected a number");
    case(PLANE, "'T/50'", "true", "4:8 `time.step` is true; expected a number or a string");
    case(PLANE, "'floor'", "3", "17:8 `obstacle[0].kind` is the whole number 3; expected \"floor\"");
    case(PLANE, "[0, -9.8]", "-9.8", "1:11 `gravity` is the number -9.8; expected an array");
    case(PLANE, "[0, -9.8]", "[0, '-9.8']", "1:15 `gravity[1]` is the string \"-9.8\"; expected a number");
    case(PLANE, "[0, 2, 3]", "[0, 2, 3.0]", "7:31 is the number 3.0; expected a whole number");
    case(PLANE, "[0, 2, 3]", "3", "7:24 `body.elements[1]` is the whole number 3; expected an array");
    case(
        PLANE,
        "model = { kind = 'shape-based', stiffness = 1e4 }",
        "model = 'shape-based'",
        "12:9 `run[0].model` is the string \"shape-based\"; expected a table",
    );
    case(PLANE, "[640, 360]", "[640, 360]\nshadow = 1", "21:10 is the whole number 1; expected true or false");
    case(SPACE, "[[run]]", "[run]", "6:1 `run` is a table; expected an array write [[run]], with double brackets");
    case(PLANE, "[view]", "[[view]]", "19:1 expected a table write [view], with single brackets");
}

#[test]
fn numbers_out_of_range() {
    case(PLANE, "= 3", "= -1", "3:12 `time.duration` is -1; expected a number of at least 0");
    case(PLANE, "= 3", "= nan", "3:12 `time.duration` is nan; expected a finite number");
    case(PLANE, "= 3", "= -inf", "3:12 `time.duration` is -inf; expected a finite number");
    case(PLANE, "-9.8", "+inf", "1:15 `gravity[1]` is +inf; expected a finite number");
    case(PLANE, "= 3", "= 1e400", "3:12 is 1e400; expected a magnitude up to 1e30");
    case(PLANE, "-9.8", "-9e31", "1:15 `gravity[1]` is -9e31; expected a magnitude up to 1e30");
    case(PLANE, "1e4", "0", "12:45 `run[0].model.stiffness` is 0; expected a number greater than 0");
    case(PLANE, "0.5\n", "1.5\n", "18:15 `obstacle[0].restitution` is 1.5; expected a number from 0 to 1");
    case(PLANE, "mass = 1", "mass = 0", "9:8 `body.mass` is 0; expected a number greater than 0");
    case(
        PLANE,
        "mass = 1",
        "masses = [1, 0, 1, -2]",
        "9:14 `body.masses[1]` is 0; expected a number greater than 0\n9:20 `body.masses[3]` is -2; expected a number greater than 0",
    );
    case(PLANE, "[0, 2, 3]", "[0, 2, -3]", "7:31 `body.elements[1][2]` is -3; expected a whole number of at least 0");
    case(PLANE, "[0, 2, 3]", "[0, 2, 5000000000]", "7:31 is 5000000000; expected a whole number");
    case(
        PLANE,
        "[640, 360]",
        "[640, 36000]",
        "20:14 `view.size[1]` is 36000; expected a whole number from 16 to 16384",
    );
    case(PLANE, "[640, 360]", "[8, 360]", "20:9 `view.size[0]` is 8; expected a whole number from 16 to 16384");
    case(
        SPACE,
        "[1, 1, 1]",
        "[1, 0, 1]",
        "5:25 `body.lattice.cells[1]` is 0; expected a whole number from 1 to 4000000000",
    );
    case(SPACE, "[1, 1, 1]", "[1, 99999999999999999999999999, 1]", "5:25 expected a whole number");
    case(SPACE, "[[run]]", "[view.camera]\nelevation = 1.6\n[[run]]", "7:13 expected a number between -1.57");
    case(SPACE, "1e4 }", "1e4, passes = 0 }", "8:59 is 0; expected a whole number from 1 to 100");
}

#[test]
fn wrong_choices() {
    case(
        PLANE,
        "'mass-spring'",
        "'mas-spring'",
        "15:18 `run[1].model.kind` is \"mas-spring\"; expected \"shape-based\", \"mass-spring\", ",
    );
    case(PLANE, "'floor'", "'wall'", "17:8 `obstacle[0].kind` is \"wall\"; expected \"floor\"");
    case(
        PLANE,
        "[640, 360]",
        "[640, 360]\ntheme = 'Dark'",
        "21:9 expected \"light\" or \"dark\" did you mean \"dark\"?",
    );
    case(
        PLANE,
        "1e4 }\n[[o",
        "1e4, springs = 'edge' }\n[[o",
        "15:60 is \"edge\"; expected \"edges\", \"edges+one-diagonal\",",
    );
    case(
        SPACE,
        "1e4 }",
        "1e4, rotation = 'robst' }",
        "8:61 `run[0].model.rotation` is \"robst\"; expected \"arctangent\", \"vector-length\", \"linear-update\" or \"robust\" did you mean \"robust\"?",
    );
    case(
        PLANE,
        "step",
        "integrator = 'euler'\nstep",
        "4:14 `time.integrator` is \"euler\"; expected \"semi-implicit-euler\", \"explicit-euler\", ",
    );
}

#[test]
fn wrong_lengths_and_texts() {
    case(PLANE, "[640, 360]", "[640]", "20:8 `view.size` has 1 entry; expected 2");
    case(SPACE, "[1, 1, 1]", "[1, 1, 1, 1]", "5:21 `body.lattice.cells` has 4 entries; expected 2 or 3");
    case(PLANE, "[0, 2, 3]", "[0]", "7:24 `body.elements[1]` has 1 entry; expected at least 2");
    case(PLANE, "[[0, 1, 2], [0, 2, 3]]", "[]", "7:12 `body.elements` is empty; expected at least 1");
    case(PLANE, "[[0, 1]]", "[[0, 1, 2]]", "8:12 `body.springs[0]` has 3 entries; expected 2");
    case(PLANE, "'Local shape'", "''", "11:8 `run[0].name` is empty; expected 1 to 80");
    case(PLANE, "'Local shape'", "\"a\\tb\"", "11:8 contains the control character '\\t'");
    case(PLANE, "'T/50'", "'T/0'", "4:8 `time.step` is \"T/0\"; expected a fraction of the cycle T such as \"T/50\"");
    case(PLANE, "Local shape'\n", "Local shape'\nstep = '50'\n", "12:8 `run[0].step` is \"50\"; expected a fraction");
    let empty = "[time]\nduration = 1\n[body]\nnodes = []\nelements = []\n[[run]]\n\
                 name = 'a'\nmodel = { kind = 'shape-based', stiffness = 1 }\n";
    case(empty, "[time]", "[time]", "4:9 `body.nodes` is empty\n5:12 `body.elements` is empty");
    case(
        "run = []\n[time]\nduration = 1\n[body]\nlattice = { cells = [1, 1], side = 1 }",
        "run",
        "run",
        "1:7 `run` is empty; expected 1 to 256",
    );
}

#[test]
fn keys_that_exclude_or_need_each_other() {
    case(
        PLANE,
        "mass = 1",
        "lattice = { cells = [1, 1], side = 1 }",
        "9:1 `body` has both `lattice` and `nodes`, which exclude each other keep one",
    );
    case(PLANE, "mass = 1", "mass = 1\nmasses = [1, 1, 1, 1]", "10:1 both `mass` and `masses`");
    case(SPACE, "1e4 }", "1e4, damping = 1, damping_ratio = 1 }", "8:63 both `damping` and `damping_ratio`");
    let method = |to: &str| format!("duration = 3\nintegrator = '{to}'");
    let damped = SPACE.replace("1e4 }", "1e4, damping = 1 }");
    let words = "9:9 \"pefrl\", which is `time.integrator`, has substeps backwards in time";
    case(&damped, "duration = 3", &method("pefrl"), words);
    case(
        SPACE,
        "duration = 3",
        "duration = 3\ntolerance = 1e-6",
        "4:13 \"semi-implicit-euler\" has fixed steps and no tolerance give `step` in its place, or write",
    );
    case(
        SPACE,
        "duration = 3",
        "duration = 3\nstep = 0.01\ntolerance = 1e-6",
        "5:13 \"semi-implicit-euler\" has fixed steps and no tolerance remove `tolerance`, or write",
    );
    case(
        SPACE,
        "duration = 3",
        &format!("{}\nstep = 'T/50'", method("dormand-prince")),
        "5:8 \"dormand-prince\" chooses its own steps give `tolerance` in place of `step`",
    );
    for (method, words) in [
        (
            "explicit-euler",
            "`step = \"auto\"` finds no step for \"Local shape\": \"explicit-euler\" is never stable without damping give a step",
        ),
        ("backward-euler", "\"backward-euler\" is stable with any step give a step"),
        ("dormand-prince", "\"dormand-prince\" chooses its own steps"),
    ] {
        let text = format!("duration = 3\nstep = 'auto'\nintegrator = '{method}'");
        case(SPACE, "duration = 3", &text, &format!("4:8 {words}"));
    }
    let passes = SPACE.replace("1e4 }", "1e4, passes = 2 }");
    case(&passes, "duration = 3", &method("runge-kutta"), "9:9 a fixed number of passes gives forces that depend");
    let projected = SPACE.replace("shape-based", "xpbd");
    case(
        &projected,
        "duration = 3",
        &method("velocity-verlet"),
        "9:9 \"velocity-verlet\", which is `time.integrator`, cannot step a model such as `xpbd`, which moves its nodes itself, by constraints",
    );
    case(
        &projected,
        "[[run]]",
        "[[run]]\nintegrator = 'velocity-verlet'",
        "7:14 \"velocity-verlet\" cannot step a model such as `xpbd`, which",
    );
    let tetrahedron = "nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\nelements = [[0, 1, 2, 3]]\nmass = 1";
    let lattice = SPACE.replace("'shape-based', stiffness", "'metric', young");
    case(
        &lattice,
        "lattice = { cells = [1, 1, 1], side = 0.1 }",
        tetrahedron,
        "10:18 element 0 has 4 nodes and is no cell of a lattice",
    );
    case(SPACE, "1e4 }", "1e4, passes = 2, rotation = 'robust' }", "8:59 without; take it out");
    case(SPACE, "[[run]]", "masses = [1, 2]\n[[run]]", "6:1 `body.masses` needs `nodes`");
    case(
        PLANE,
        "mass = 1",
        "velocity = [0, 0]\nvelocities = [[0, 0], [0, 0], [0, 0], [0, 0]]",
        "10:1 both `velocity` and `velocities`",
    );
}

#[test]
fn elements_that_are_none() {
    case(PLANE, "[0, 2, 3]", "[0, 2, 4]", "7:31 there is no node 4; the body has nodes 0 to 3");
    case(PLANE, "[0, 2, 3]", "[0, 2, 2, 3]", "7:31 node 2 occurs twice in `body.elements[1]`");
    case(
        PLANE,
        "[0, 2, 3]",
        "[0, 2, 3], [2, 3, 0]",
        "7:35 `body.elements[2]` has the same nodes as `body.elements[1]`",
    );
    case(
        PLANE,
        "[0, 2, 3]",
        "[0, 3, 2]",
        "7:24 `body.elements[1]` is clockwise; expected counter-clockwise write [2, 3, 0]",
    );
    case(PLANE, "[1, 1], [0, 1]]", "[1, 1], [2, 2]]", "7:24 `body.elements[1]` has no area: its nodes are on a line");
    case(
        PLANE,
        "[[0, 0], [1, 0], [1, 1], [0, 1]]",
        "[[5, 5], [5, 5], [5, 5], [5, 5]]",
        "7:13 `body.elements[0]` has no extent: all its nodes are at [5, 5]\n7:24 `body.elements[1]` has no extent: all its nodes are at [5, 5]",
    );
    case(PLANE, "[0, 2, 3]]", "[0, 2]]", "6:34 node 3 belongs to no element and no spring");
    case(
        PLANE,
        "[[0, 1]]",
        "[[0, 1], [1, 0], [2, 2], [3, 9]]",
        "8:20 `body.springs[1]` has the same nodes as `body.springs[0]`\n8:32 node 2 occurs twice in `body.springs[2]`\n8:40 there is no node 9",
    );
    case(PLANE, "mass = 1", "faces = [[0, 1, 7]]", "9:17 there is no node 7");
}

#[test]
fn solids_turned_inside_out_or_flat() {
    let solid = |elements: &str| {
        let nodes = "[[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]";
        SPACE.replace(
            "lattice = { cells = [1, 1, 1], side = 0.1 }",
            &format!("nodes = {nodes}\nsprings = [[0, 1], [2, 3], [4, 5], [6, 7]]\nelements = {elements}"),
        )
    };
    let case = |elements: &str, words: &str| {
        let text = solid(elements);
        case(&text, "[body]", "[body]", &format!("7:13 {words}"));
    };
    case("[[4, 5, 6, 7, 0, 1, 2, 3]]", "turned inside out at rest write [0, 1, 2, 3, 4, 5, 6, 7]");
    // The order of many mesh formats, around each square.
    case(
        "[[0, 1, 3, 2, 4, 5, 7, 6]]",
        "`body.elements[0]` lists its corners around its sides; expected x fastest, then y, then z \
         write [0, 1, 2, 3, 4, 5, 6, 7]",
    );
    case(
        "[[0, 1, 2, 3, 4, 6, 5, 7]]",
        "has no volume: its nodes are in a plane, or not in their order list the corners with x fastest",
    );
    case("[[0, 2, 1, 4]]", "turned inside out at rest write [0, 1, 2, 4]");
    case("[[0, 1, 2, 3]]", "has no volume");
    case("[[0, 2, 3, 1, 4]]", "turned inside out at rest write [0, 1, 3, 2, 4]");
    case("[[0, 2, 1, 4, 6, 5]]", "turned inside out at rest write [4, 6, 5, 0, 2, 1]");
}

#[test]
fn lists_and_vectors_that_do_not_fit_the_body() {
    case(
        PLANE,
        "mass = 1",
        "masses = [1, 2, 3]",
        "9:1 `body.masses` has 3 entries, and the body has 4 nodes; expected one for each",
    );
    case(PLANE, "mass = 1", "positions = [[0, 0]]", "9:1 `body.positions` has 1 entry, and the body has 4 nodes");
    case(
        PLANE,
        "mass = 1",
        "velocities = [[0, 0], [0, 0, 0], [0, 0], [0, 0]]",
        "9:23 `body.velocities[1]` has 3 coordinates; expected 2",
    );
    case(
        PLANE,
        "[0, 1]]\ne",
        "[0, 1, 2]]\ne",
        "6:34 `body.nodes[3]` has 3 coordinates; expected 2, because the body is in the plane",
    );
    case(PLANE, "[0, -9.8]", "[0, -9.8, 0]", "1:11 `gravity` has 3 coordinates; expected 2");
    case(
        SPACE,
        "[0, -9.8, 0]",
        "[0, -9.8]",
        "1:11 `gravity` has 2 coordinates; expected 3, because the body is in space",
    );
    case(
        SPACE,
        "[[run]]",
        "velocity = [1, 2]\noffset = [1, 2]\n[[run]]",
        "6:12 `body.velocity` has 2\n7:10 `body.offset` has 2",
    );
    case(SPACE, "[[run]]", "rotation = { axis = [0, 0, 0], angle = 1 }\n[[run]]", "6:21 `body.rotation.axis` is zero");
    case(SPACE, "[[run]]", "rotation = { angle = 1 }\n[[run]]", "6:12 `body.rotation` has no `axis`");
    case(
        PLANE,
        "mass = 1",
        "rotation = { axis = [0, 1], angle = 1 }",
        "9:14 `body.rotation` has an `axis`, but the body is in the plane",
    );
    case(PLANE, "'floor'", "'floor'\nnormal = [0, 0]", "18:10 `obstacle[0].normal` is zero");
    case(PLANE, "'floor'", "'floor'\nnormal = [0, 1, 0]", "18:10 `obstacle[0].normal` has 3 coordinates");
    case(
        PLANE,
        "[640, 360]",
        "[640, 360]\ncamera = { azimuth = 1, target = [0, 0, 0] }",
        "21:12 `view.camera.azimuth` is given, but a body in the plane\n21:34 `view.camera.target` has 3 coordinates",
    );
}

#[test]
fn runs_and_times_that_cannot_be() {
    case(PLANE, "'Mass-spring'", "'Local shape'", "14:8 two runs are called \"Local shape\": `run[0]` and `run[1]`");
    case(PLANE, "'Mass-spring'", "'a/b'", "14:8 the name \"a/b\" cannot be used in files write \"a-b\": no slash");
    case(PLANE, "'Mass-spring'", "' a'", "14:8 the name \" a\" cannot be used in files write \"a\": no slash");
    case(PLANE, "'T/50'", "10", "4:8 the time step of \"Local shape\" is 10 s, longer than the whole scene of 3 s");
    case(PLANE, "'T/50'", "1e-300", "4:8 the time step is 1e-300 s");
    case(PLANE, "= 3\n", "= 1e9\n", "3:12 make 6.000e10 frames; the most is 10 000 000");
}

#[test]
fn all_mistakes_are_found_in_one_pass() {
    let text = PLANE
        .replace("[0, -9.8]", "[0, nan]")
        .replace("duration", "durtion")
        .replace("[0, 2, 3]", "[0, 2, 9]")
        .replace("mass = 1", "mass = -1")
        .replace("'Mass-spring'", "'Local shape'")
        .replace("restitution = 0.5", "restitution = 2")
        .replace("[640, 360]", "[640, 1]");
    let error = bad(&text);
    let lines: Vec<_> = error.mistakes().iter().map(|mistake| mistake.line).collect();
    assert_eq!(lines, [1, 3, 7, 9, 14, 18, 20], "{error}");
}

#[test]
fn a_mistake_in_one_key_of_the_body_does_not_hide_those_in_the_others() {
    let text = PLANE
        .replace("[0, 2, 3]", "[0, 2, 9]")
        .replace("mass = 1", "mass = -1\nrotation = { axis = [0, 1], angle = nan }\nvelocity = [0, 0, 0]")
        .replace("0.5\n", "0.5\nnormal = [0, 0]\n");
    let error = bad(&text);
    let lines: Vec<_> = error.mistakes().iter().map(|mistake| mistake.line).collect();
    assert_eq!(lines, [7, 9, 10, 11, 21], "{error}");
}

#[test]
fn a_body_beyond_the_limits_is_refused_before_it_is_built() {
    case(
        SPACE,
        "[1, 1, 1]",
        "[1000, 1000, 1000]",
        "5:21 this makes 1 003 003 001 nodes and 1 000 000 000 elements, at least",
    );
    let text = SPACE.replace("[1, 1, 1]", "[300, 300, 300]");
    let error = bad(&text).to_string();
    assert!(error.contains("27 270 901 nodes") && error.contains("GiB of memory"), "{error}");
    assert!(error.contains("of memory; the limit is 8 200 000 nodes"), "{error}");
    assert!(error.contains("--allow-large"), "{error}");
    case(
        SPACE,
        "[1, 1, 1]",
        "[4000000000, 4000000000, 4000000000]",
        "5:21 more nodes or elements than 32-bit indices can count use fewer cells",
    );
    let none = Limits { nodes: 7, ..Limits::default() };
    assert!(matches!(Scene::parse(SPACE, "a", &none), Err(SceneError::Mistakes(_))));
    assert!(Scene::parse(SPACE, "a", &Limits { nodes: 8, ..none }).is_ok());
    assert!(Scene::parse(PLANE, "a", &Limits { nodes: 3, ..none }).is_err());
    assert!(Scene::parse(SPACE, "a", &Limits { corners: 7, ..Limits::default() }).is_err());
}

/// A polygon with many corners, which has too many diagonals although its file is small.
#[test]
fn springs_beyond_the_limits_are_refused_before_they_are_made() {
    let corner = |at: u32| {
        let (sine, cosine) = (f64::from(at) * std::f64::consts::TAU / 60_000.0).sin_cos();
        format!("[{cosine:.9}, {sine:.9}]")
    };
    let nodes: Vec<_> = (0..60_000).map(corner).collect();
    let element: Vec<_> = (0..60_000).map(|at| at.to_string()).collect();
    let scene = |model: &str| {
        let (nodes, element) = (nodes.join(","), element.join(","));
        let soft = "[[run]]\nname = 'soft'\nmodel = { kind = 'shape-based', stiffness = 1 }";
        let body = format!("[body]\nnodes = [{nodes}]\nelements = [[{element}]]");
        format!("time = {{ duration = 1 }}\n{soft}\n[[run]]\nname = 'springs'\n{model}\n{body}\n")
    };
    for (model, column) in [
        ("model = { kind = 'mass-spring', stiffness = 1, springs = 'all' }", 58),
        ("model = { kind = 'mass-spring', stiffness = 1 }", 9),
    ] {
        let error = bad(&scene(model));
        let [mistake] = error.mistakes() else { panic!("{error}") };
        assert_eq!((mistake.line, mistake.column), (7, column), "{error}");
        assert!(mistake.message.starts_with("this makes 60 000 nodes, 1 element and up to 1 7"), "{error}");
        assert!(mistake.help.as_ref().unwrap().contains("fewer springs on each element"), "{error}");
    }
    super::good(&scene("model = { kind = 'mass-spring', stiffness = 1, springs = 'edges' }"));
}

#[test]
fn syntax_errors_have_their_place() {
    let error = bad(&PLANE.replace("duration = 3", "duration = = 3"));
    assert!(matches!(error, SceneError::Syntax(_)));
    for (value, column) in [("", 8), ("    # a comment", 12)] {
        let empty = format!("mass = {value}");
        case(
            PLANE,
            "mass = 1",
            &empty,
            &format!("9:{column} `mass` has no value write one after `=`, or remove the key"),
        );
    }
    case(SPACE, "side = 0.1", "side = ", "5:40 `side` has no value");
    case(PLANE, "duration = 3", "duration = = 3", "3:12 this is not TOML: extra `=`");
    case(
        PLANE,
        "duration = 3",
        "duration = 3,5",
        "3:13 `3,5` has a decimal comma a number has a decimal point, not a comma: 3.5",
    );
    case(
        SPACE,
        "side = 0.1",
        "side = 0,1",
        "5:40 `0,1` has a decimal comma a number has a decimal point, not a comma: 0.1",
    );
    for (text, help) in [
        ("'0,5'", "write 0.5: a number without quotation marks, with a decimal point"),
        ("'2'", "write 2: a number without quotation marks"),
    ] {
        let found = format!("`time.duration` is the string {}; expected a number {help}", text.replace('\'', "\""));
        case(PLANE, "duration = 3", &format!("duration = {text}"), &format!("3:12 {found}"));
    }
    let whole = "12:59 `run[0].model.passes` is the string \"2.5\"; expected a whole number Number of";
    case(PLANE, "stiffness = 1e4", "stiffness = 1e4, passes = '2.5'", whole);
    // Not in an unclosed text.
    let mistakes = bad(&PLANE.replacen("name = 'Local shape'", "name = \"e = 0,5", 1)).to_string();
    assert!(!mistakes.contains("decimal comma"), "{mistakes}");
    case(PLANE, "duration = 3", "duration = 3\nduration = 4", "4:1 `duration` is given a second time");
    case(PLANE, "[0, -9.8]", "[0, -9.8", "2:1 is an array before this not closed with `]`?");
    case(
        PLANE,
        "'T/50'",
        "T/50",
        "4:8 this is not TOML: invalid boolean, expected `true` a text needs quotation marks: \"T/50\"",
    );
    case(PLANE, "'T/50'", "'T/50", "4:13 invalid literal string");
    case(PLANE, "gravity", "é", "1:1 invalid unquoted key");
    let deep = format!("a = {}", "[".repeat(100_000));
    assert!(matches!(bad(&deep), SceneError::Syntax(_)));
}

#[test]
fn a_mistake_is_shown_with_its_line_and_a_mark() {
    let error = bad(&SPACE.replace("stiffness", "stifness"));
    assert_eq!(
        error.to_string(),
        "test.toml:8:33: unknown key `stifness` in `run[0].model`\n  \
           8 | model = { kind = 'shape-based', stifness = 1e4 }\n    \
             |                                 ^^^^^^^^ did you mean `stiffness`?"
    );
    let many = format!("nodes = [{}]", "[nan, 0], ".repeat(51));
    let error = bad(&SPACE.replace("lattice = { cells = [1, 1, 1], side = 0.1 }", &many));
    let text = error.to_string();
    assert_eq!(error.mistakes().len(), 52, "{text}");
    assert_eq!(text.matches("expected a finite number").count() + text.matches("no `elements`").count(), 20);
    assert!(text.ends_with("test.toml: and 32 more"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() < 130), "{text}");
}

#[test]
fn bodies_that_no_rule_makes() {
    let lattice = "lattice = { cells = [1, 1, 1], side = 0.1 }";
    let body = |to: &str, expected: &str| case(SPACE, lattice, to, expected);
    let plane = |to: &str, expected: &str| {
        case(&SPACE.replace("[0, -9.8, 0]", "[0, -9.8]"), lattice, to, expected);
    };
    // Exactly one of the generators.
    body(
        "polygon = { sides = 6, radius = 1 }\nlattice = { cells = [1, 1, 1], side = 0.1 }",
        "6:1 `body` has both `lattice` and `polygon`, which exclude each other keep one",
    );
    plane(
        "fan = { sides = 6, radius = 1 }\nfile = 'body.npz'",
        "6:1 `body` has both `fan` and `file`, which exclude each other keep one",
    );
    plane("polygons = { sides = 6, radius = 1 }", "5:1 unknown key `polygons` in `body` did you mean `polygon`?");
    plane("fan = { sides = 6, radius = 1 }\nmasses = [1, 2]", "6:1 `body.masses` needs `nodes`");
    // Blocks.
    body(
        "lattice = { cells = [1, 1, 1], side = 0.1, elements = 'triangles' }",
        "5:55 `body.lattice.elements` is \"triangles\", but the lattice is in space: it has 3 `cells` use \"tetrahedra\"",
    );
    plane(
        "lattice = { cells = [1, 1], side = 0.1, elements = 'tetrahedra' }",
        "5:52 is \"tetrahedra\", but the lattice is in the plane: it has 2 `cells` use \"triangles\"",
    );
    body(
        "lattice = { cells = [1, 1, 1], side = 0.1, elements = 'tetraeder' }",
        "5:55 expected \"cells\", \"triangles\", \"tetrahedra\" or \"mixed\" did you mean \"tetrahedra\"?",
    );
    body(
        "lattice = { cells = [1, 1, 1], side = [0.1, 0.1] }",
        "5:39 `body.lattice.side` has 2 entries, and `cells` has 3; expected one for each axis or one number for all",
    );
    body("lattice = { cells = [1, 1, 1], side = [0.1] }", "5:39 `body.lattice.side` has 1 entry; expected 2 or 3");
    body(
        "lattice = { cells = [1, 1, 1], side = [0.1, 0, 0.1] }",
        "5:45 `body.lattice.side[1]` is 0; expected a number greater than 0",
    );
    body("lattice = { cells = [1, 1, 1], side = -1 }", "5:39 `body.lattice.side` is -1; expected a number greater");
    body("lattice = { cells = [1, 1, 1], side = '1' }", "5:39 the string \"1\"; expected a number or an array");
    body(
        "lattice = { cells = [1, 1, 1], side = 1, irregular = 0.5 }",
        "5:54 `body.lattice.irregular` is 0.5; expected a number from 0 to 0.4",
    );
    body("lattice = { cells = [1, 1, 1], side = 1, seed = -1 }", "5:49 `body.lattice.seed` is -1; expected a whole");
    // Polygons and discs.
    plane("polygon = { sides = 2, radius = 1 }", "5:21 `body.polygon.sides` is 2; expected a whole number");
    plane("polygon = { sides = 5, radius = 0 }", "5:33 `body.polygon.radius` is 0; expected a number greater");
    plane("fan = { sides = 5 }", "5:7 `body.fan` has no `radius`");
    plane(
        "disc = { radius = 1, rings = 0, sectors = 2 }",
        "5:30 `body.disc.rings` is 0\n5:43 `body.disc.sectors` is 2",
    );
    // They are in the plane, so the other coordinates must be, too.
    body(
        "polygon = { sides = 6, radius = 1 }",
        "1:11 `gravity` has 3 coordinates; expected 2, because the body is in the plane",
    );
    // Bars.
    body(
        "bars = { count = 3, length = 1, direction = [0, 0, 0] }",
        "5:45 `body.bars.direction` is zero, so it has no direction",
    );
    body("bars = { count = 0, length = 1, direction = [0, 1, 0] }", "5:18 `body.bars.count` is 0; expected a whole");
    body(
        "bars = { count = 3, length = 1, direction = [1] }",
        "5:45 `body.bars.direction` has 1 entry; expected 2 or 3",
    );
    body("file = ''", "5:8 `body.file` is empty; expected at least 1");
}

#[test]
fn mistakes_of_what_is_shown() {
    let view = |to: &str, expected: &str| {
        case(PLANE, "size = [640, 360]", to, expected);
    };
    view("colour = { by = 'sped' }", "20:17 is \"sped\"; expected \"strain\"");
    view("colour = { by = 'sped' }", "20:17 did you mean \"speed\"?");
    view("colour = { range = [0, 1] }", "20:10 `view.colour` has no `by`");
    view("colour = { by = 'speed', range = [3, 1] }", "20:34 runs from 3 to 1; expected a rising range");
    view("colour = { by = 'speed', range = [0, inf] }", "20:38 is inf; expected a finite number");
    view("colour = { by = 'distance' }", "20:10 `view.colour` has no `to`, the run to which the distance is measured");
    view("colour = { by = 'distance', to = 'Mass' }", "20:34 there is no run \"Mass\" did you mean \"Mass-spring\"?");
    view("colour = { by = 'speed', to = 'Mass-spring' }", "20:26 only `by = \"distance\"` compares runs remove `to`");
    view("title = \"a\\nb\"", "20:9 contains the control character");
    view("caption = \"a\\tb\"", "20:11 contains the control character '\\t'; it is lines of text");
    view("charts = ['turned over']", "20:11 did you mean \"turned_over\"?");
    view("labels = ['title']", "20:11 expected \"letters\", \"name\", \"model\", \"clock\", \"count\", \"number\"");
    view("floor = 'tiles'", "20:9 expected \"grid\", \"plain\" or \"none\"");
    view("edges = 'none'", "20:9 expected \"all\", \"visible\" or \"outline\"");
    view("show = []", "20:8 `view.show` is empty; expected at least 1");
    view("show = ['spring']", "20:9 did you mean \"springs\"?");
    view("arrow_scale = 0", "20:15 expected a number greater than 0");
    view("panels = 'rows'", "20:10 did you mean \"row\"?");
    view("panels = 0", "20:10 `view.panels` is 0; expected a whole number from 1 to 64");
}

#[test]
fn cameras_that_see_nothing() {
    let camera = |to: &str, expected: &str| {
        case(SPACE, "stiffness = 1e4 }", &format!("stiffness = 1e4 }}\n[view]\ncamera = {{ {to} }}"), expected);
    };
    camera(
        "target = [0, 0.01, 0], distance = 0.02",
        "10:10 inside the body at its start move it out with a larger `view.camera.distance`",
    );
    camera("elevation = 1.5708", "10:24 is 1.5708; expected a number between -1.57 and 1.57");
    camera("elevation = -1.6", "10:24 does not look along its up-axis");
}
