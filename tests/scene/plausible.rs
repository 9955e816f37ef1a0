//! Warnings of sizes and stiffnesses that are hardly meant.

use super::archives::doubles;
use super::recordings::{load, stored};
use super::{WORLD, good};

/// The messages and remedies of a scene's warnings.
fn warnings(text: &str) -> Vec<(String, String)> {
    good(text).warnings.into_iter().map(|warning| (warning.message, warning.help.unwrap_or_default())).collect()
}

#[test]
fn a_body_that_is_far_longer_than_bodies_are() {
    for (body, large, usual, length) in [
        ("lattice = { cells = [10, 1, 1], side = SIDE }", 15, 4, "150"),
        ("polygon = { sides = 4, radius = SIDE }", 60, 20, "84.85"),
        ("nodes = [[0, 0], [SIDE, 0], [0, SIDE]]\nelements = [[0, 1, 2]]", 60, 49, "60"),
    ] {
        let scene = |side: u32| format!("{WORLD}[body]\n{}\n", body.replace("SIDE", &side.to_string()));
        assert_eq!(warnings(&scene(usual)), [], "{body}");
        let told = warnings(&scene(large));
        assert_eq!(told.len(), 1, "{told:?}");
        assert_eq!(told[0].0, format!("the body is {length} m long"));
        assert!(told[0].1.starts_with("lengths are in metres: divide"), "{told:?}");
    }
    let body = |at: u32| {
        let name = format!("[[body]]\nname = '{at}'\noffset = [0, {}, 0]\n", 100 * at);
        name + "lattice = { cells = [1, 1, 1], side = 60 }\n"
    };
    let told = warnings(&format!("{WORLD}{}", (0..3).map(body).collect::<String>()));
    assert_eq!(told.len(), 1, "{told:?}");
    assert_eq!(told[0].0, "the body \"0\" is 60 m long, as are others");
}

/// A cube of 1 m and 1000 kg/m³ has ρ g h = 10 kPa at its lower side.
const CUBE: &str = "\
gravity = [0, -10, 0]
[time]
duration = 1
[body]
lattice = { cells = [4, 4, 4], side = 0.25 }
density = 1000
[[obstacle]]
kind = 'floor'
[[run]]
name = 'Cube'
";

#[test]
fn a_body_that_its_own_weight_flattens_or_draws_out() {
    let of_model = |model: &str| warnings(&format!("{CUBE}model = {{ kind = {model} }}"));
    // Half of ρ g h / E is the mean strain: up to a third of the height it is not told.
    let (young, remedy) = ("'shape-based', young = ", "with young = 5e4 the weight changes its height by a tenth");
    let told = of_model(&format!("{young}1e3"));
    let words = "the body is too soft to carry its own weight in \"Cube\": ρ g h / E = 10, with a height h of 1 m and E = 1 kPa";
    assert_eq!(told, [(words.to_owned(), remedy.to_owned())]);
    assert_eq!(of_model(&format!("{young}1.45e4")).len(), 1);
    assert_eq!(of_model(&format!("{young}1.55e4")), []);
    assert_eq!(of_model(&format!("{young}5e4")), []);
    // k = E a / 2 for cubes of side a.
    let told = of_model("'shape-based', stiffness = 125");
    assert!(told[0].0.ends_with("E = 1 kPa") && told[0].1.starts_with("with stiffness = 6.2e3 "), "{told:?}");
    // The remedy helps with every model.
    for model in ["'mass-spring', stiffness = ", "'neo-hookean', young = ", "'xpbd', stiffness = "] {
        let told = of_model(&format!("{model}100"));
        assert_eq!(told.len(), 1, "{model}: {told:?}");
        let value = told[0].1.split_whitespace().nth(3).expect("a number");
        assert_eq!(of_model(&format!("{model}{value}")), [], "{told:?}");
    }
}

#[test]
fn a_body_that_nothing_carries_is_not_told() {
    let scene = |from: &str, to: &str| {
        warnings(&format!("{CUBE}model = {{ kind = 'shape-based', young = 1e3 }}\n").replace(from, to)).len()
    };
    assert_eq!(scene("gravity = [0, -10, 0]\n", ""), 0);
    assert_eq!(scene("[[obstacle]]\nkind = 'floor'\n", ""), 0);
    assert_eq!(scene("[[obstacle]]\nkind = 'floor'\n", "[[hold]]\nnodes = 'top'\n"), 1);
    assert_eq!(scene("[0, -10, 0]", "[0, -0.1, 0]"), 0);
    // Runs are told together.
    let two = "name = 'Two'\nmodel = { kind = 'shape-based', young = 1e3 }\n[[run]]\nname = 'Cube'";
    let told =
        warnings(&format!("{CUBE}model = {{ kind = 'shape-based', young = 2e3 }}\n").replace("name = 'Cube'", two));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0.contains("in \"Two\" and \"Cube\": ρ g h / E = 10, "), "{told:?}");
}

/// A square that moves in another unit than the simulated one.
#[test]
fn a_recording_in_another_unit() {
    let scene = "\
[time]
duration = 1
[body]
nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]
elements = [[0, 1, 2], [0, 2, 3]]
[[run]]
name = 'Played'
states = 'played.npz'
[[run]]
name = 'Simulated'
model = { kind = 'shape-based', stiffness = 1e4 }
";
    let played = |scene: &str, unit: f64| {
        let square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0].map(|at| at * unit);
        let arrays = [doubles("time", "(2,)", &[0.0, 1.0]), doubles("position", "(2, 4, 2)", &square.repeat(2))];
        let (_folder, scene) = load(scene, &stored(&arrays));
        let warnings = scene.unwrap_or_else(|error| panic!("{error}")).warnings;
        warnings.into_iter().map(|told| (told.line, told.message, told.help.unwrap_or_default())).collect::<Vec<_>>()
    };
    let told = |unit: f64| played(scene, unit);
    assert_eq!([1.0, 50.0, 0.02].map(|unit| told(unit).len()), [0; 3]);
    let message = "the recording of \"Played\" is 1000 times as long as the simulated bodies: 1000 m beside 1 m";
    let help = "lengths are in metres: write scale = 0.001 in this run if its unit is another one";
    assert_eq!(told(1000.0), [(8, message.to_owned(), help.to_owned())]);
    let message = "the recording of \"Played\" is 0.001 times as long as the simulated bodies: 0.001 m beside 1 m";
    assert_eq!(told(0.001)[0].1, message);
    assert!(told(0.001)[0].2.contains("scale = 1000 "));
    // Nothing is simulated.
    let alone = scene.split("[[run]]\nname = 'Simulated'").next().unwrap_or_default();
    assert_eq!([1.0, 0.02].map(|unit| played(alone, unit).len()), [0; 2]);
    let message = "the recording of \"Played\" is 1000 times as long as its body at rest: 1000 m beside 1 m";
    assert_eq!(played(alone, 1000.0), [(8, message.to_owned(), help.to_owned())]);
}

#[test]
fn what_begins_after_the_end() {
    let of = |text: &str| {
        let told = warnings(&format!("{CUBE}model = {{ kind = 'shape-based', young = 1e5 }}\n{text}"));
        told.into_iter().map(|(message, _)| message).collect::<Vec<_>>()
    };
    let late =
        |key: &str, time: &str| vec![format!("`{key}` does nothing: it begins at {time} s, and the scene ends at 1 s")];
    let load = |times: &str| of(&format!("[[load]]\nforce = [1, 0, 0]\n{times}\n"));
    let rising = "`load[0]` is never whole: it rises until 5.9 s, and the scene ends at 1 s";
    assert_eq!(load("from = 0.9\nramp = 5"), [rising]);
    assert_eq!(load("from = 0.5\nramp = 0.5"), [""; 0]);
    let ends = "`load[0]` is never whole: it rises until 0.5 s, and it ends at 0.2 s";
    assert_eq!(load("ramp = 0.5\nuntil = 0.2"), [ends]);
    assert_eq!(load("from = 1\nramp = 5"), late("load[0]", "1"));
    assert_eq!(load("keys = [{ time = 2, share = 0 }, { time = 3, share = 1 }]"), late("load[0]", "2"));
    assert_eq!(load("keys = [{ time = 2, share = 1 }, { time = 3, share = 0 }]"), [""; 0]);
    assert_eq!(of("[[hold]]\nnodes = 'top'\nfrom = 1.5\n"), late("hold[0]", "1.5"));
    let path = |from: u32| format!("path = {{ keys = [{{ time = {from} }}, {{ time = 8, shift = [0, 1, 0] }}] }}\n");
    assert_eq!(of(&format!("[[grab]]\nnodes = 'top'\n{}", path(4))), late("grab[0]", "4"));
    let ball = "[[obstacle]]\nkind = 'sphere'\ncentre = [0, 9, 0]\nradius = 1\n";
    assert_eq!(of(&format!("{ball}{}", path(0))), [""; 0]);
    assert_eq!(of(&format!("{ball}{}", path(4))), late("obstacle[1].path", "4"));
}

/// Of a load that begins later, rest at the start knows nothing.
#[test]
fn loads_that_rise_in_a_scene_without_duration() {
    let of = |times: &str| {
        let text = CUBE.replace("duration = 1", "duration = 0\nstart = 'equilibrium'");
        let load = format!("[[hold]]\nnodes = 'top'\n[[load]]\nforce = [1, 0, 0]\n{times}\n");
        warnings(&format!("{text}model = {{ kind = 'shape-based', young = 1e5 }}\n{load}"))
    };
    let told = vec![(
        "`load[0]` does nothing: it is 0 at the start, and the scene has no duration".to_owned(),
        "leave out `from`, `ramp` and `keys`".to_owned(),
    )];
    for times in ["ramp = 1", "from = 0.1", "keys = [{ time = 0, share = 0 }, { time = 1, share = 1 }]"] {
        assert_eq!(of(times), told, "{times}");
    }
    assert_eq!(of(""), []);
    assert_eq!(of("keys = [{ time = 0, share = 0.5 }, { time = 1, share = 1 }]"), []);
}

#[test]
fn loads_on_nodes_that_are_all_held() {
    let of = |hold: &str, load: &str| {
        let text = format!("{CUBE}model = {{ kind = 'shape-based', young = 1e5 }}\n");
        warnings(&format!("{text}[[hold]]\nnodes = 'top'\n{hold}\n[[load]]\nforce = [1, 0, 0]\n{load}\n"))
    };
    let told = vec![(
        "`load[0]` moves nothing: all nodes on which it acts are held or grabbed".to_owned(),
        "choose other nodes or faces, or remove it".to_owned(),
    )];
    assert_eq!(of("", "nodes = 'top'"), told);
    assert_eq!(of("", "faces = 'top'"), told);
    assert_eq!(of("until = 0.5", "nodes = 'top'\nuntil = 0.5"), told);
    // What is let go, grabbed later, or held in part moves.
    assert_eq!(of("until = 0.5", "nodes = 'top'"), []);
    assert_eq!(of("from = 0.5", "nodes = 'top'"), []);
    assert_eq!(of("", ""), []);
}

#[test]
fn rows_of_frames_that_end_no_interval() {
    let of = |every: &str, charts: &str| {
        let text = CUBE.replace("duration = 1", &format!("duration = 1\nframes_per_second = 60\nevery = {every}"));
        warnings(&format!("{text}model = {{ kind = 'shape-based', young = 1e5 }}\n[view]\ncharts = ['{charts}']"))
    };
    let told = of("0.0133", "contact_force");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].0.starts_with("`time.every` does not divide the time between frames"), "{told:?}");
    assert_eq!(told[0].1, "write every = 0.0166666666667");
    assert_eq!(of("0.0166666666667", "contact_force"), []);
    assert_eq!(of("0.0041666666666667", "contact_force"), []);
    assert_eq!(of("0.0133", "energy"), []);
}

#[test]
fn angles_in_degrees() {
    let of = |text: &str| warnings(&format!("{CUBE}model = {{ kind = 'shape-based', young = 1e5 }}\n{text}"));
    let slope = |angle: &str| {
        let place = "kind = 'box'\ncentre = [0, -9, 0]\nsize = [1, 1, 1]";
        of(&format!("[[obstacle]]\n{place}\nrotation = {{ axis = [0, 0, 1], angle = {angle} }}"))
    };
    assert_eq!(slope("-6.28"), []);
    let told = |key: &str, angle: &str, right: &str| {
        let message = format!("`{key}` is {angle} rad, more than a whole turn");
        vec![(message, format!("angles are in radians: {angle}° are {right}"))]
    };
    assert_eq!(slope("-45"), told("obstacle[1].rotation.angle", "-45", "-0.7854"));
    assert_eq!(of("[view.camera]\nazimuth = 30"), told("view.camera.azimuth", "30", "0.5236"));
    let turned = CUBE.replace("density", "lowest = 0\nrotation = { axis = [0, 0, 1], angle = 90 }\ndensity");
    let turned = warnings(&format!("{turned}model = {{ kind = 'shape-based', young = 1e5 }}"));
    assert_eq!(turned, told("body.rotation.angle", "90", "1.571"));
}
