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
    let told = |unit: f64| {
        let square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0].map(|at| at * unit);
        let arrays = [doubles("time", "(2,)", &[0.0, 1.0]), doubles("position", "(2, 4, 2)", &square.repeat(2))];
        let (_folder, scene) = load(scene, &stored(&arrays));
        let warnings = scene.unwrap_or_else(|error| panic!("{error}")).warnings;
        warnings.into_iter().map(|told| (told.line, told.message, told.help.unwrap_or_default())).collect::<Vec<_>>()
    };
    assert_eq!([1.0, 50.0, 0.02].map(|unit| told(unit).len()), [0; 3]);
    let message = "the recording of \"Played\" is 1000 times as long as the simulated bodies: 1000 m beside 1 m";
    let help = "lengths are in metres: write scale = 0.001 in this run if its unit is another one";
    assert_eq!(told(1000.0), [(8, message.to_owned(), help.to_owned())]);
    let message = "the recording of \"Played\" is 0.001 times as long as the simulated bodies: 0.001 m beside 1 m";
    assert_eq!(told(0.001)[0].1, message);
    assert!(told(0.001)[0].2.contains("scale = 1000 "));
}
