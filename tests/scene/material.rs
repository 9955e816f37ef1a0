//! Materials in place of elastic constants, bending, and damping that brakes rotation.

use super::{good, mistakes::case};
use localshape::scene::Scene;

const BAR: &str = "\
gravity = [0, -9.8, 0]
time = { duration = 1, step = 1e-3 }
body = { lattice = { cells = [3, 1, 1], side = 0.1 }, mass = 0.1, lowest = 0.3 }
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', young = 2e5, damping_ratio = 0.1 }
[[run]]
name = 'Springs'
model = { kind = 'mass-spring', stiffness = 1e4, damping_ratio = 0.1 }
[[obstacle]]
kind = 'floor'
friction = 0.3
";

/// The models of all runs in words.
fn models(scene: &Scene) -> Vec<String> {
    let summary = scene.summary();
    summary.runs.into_iter().flat_map(|run| run.parts).map(|part| part.model).collect()
}

/// Cubes of side a have the constant k = E a/2.
#[test]
fn a_modulus_gives_cubes_their_elastic_constant() {
    let of_modulus = good(BAR);
    let of_constant = good(&BAR.replace("young = 2e5", "stiffness = 1e4"));
    let [one, other] = [&of_modulus, &of_constant].map(|scene| {
        let mut world = scene.world(0);
        world.advance(300);
        world.state().position.clone()
    });
    let far = one.iter().zip(&other).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(far < 1e-12, "{far:e}");
    assert!(models(&of_modulus)[0].starts_with("3 cubes, E = 200 kPa, ν = 0, ζ = 0.1, "));
    assert!(models(&of_modulus)[0].ends_with(", k = 10 kN/m"));
    assert!(models(&of_constant)[0].ends_with(", as a material E = 200 kPa, ν = 0"));
    assert!(!models(&of_constant)[1].contains("E = "), "springs are no material");
}

#[test]
fn bending_is_a_number_or_a_fraction() {
    let bending = |typed: &str| {
        let scene = good(&BAR.replace("young = 2e5", &format!("young = 2e5, poisson = 0.3, bending = {typed}")));
        models(&scene)[0].clone()
    };
    assert!(bending("'1/3'").contains("E = 200 kPa, ν = 0.3, "), "{}", bending("'1/3'"));
    assert!(bending("'1/3'").ends_with(", β = 1/3, k = 7.69 kN/m"));
    assert!(bending("0.4").contains(", β = 2/5"));
    assert!(!bending("1").contains('β'));
}

#[test]
fn materials_that_cannot_be() {
    let young = |to: &str, expected: &str| case(BAR, "young = 2e5", to, expected);
    young("stiffness = 1e4, young = 2e5", "6:50 `run[0].model` has both `stiffness` and `young`");
    young("damping_of = 'deformation'", "6:9 `run[0].model` has neither `stiffness` nor `young`; one is needed");
    young("stiffness = 1e4, poisson = 0.3", "6:50 `run[0].model.poisson` needs `young`");
    young("young = -1", "6:41 `run[0].model.young` is -1; expected a number greater than 0");
    young(
        "young = 2e5, poisson = 0.5",
        "6:56 `run[0].model.poisson` is 0.5; expected a number from 0 to less than 0.5",
    );
    young("young = 2e5, bending = 1.5", "6:56 `run[0].model.bending` is 1.5");
    young("young = 2e5, bending = '1/0'", "6:56 `run[0].model.bending` is \"1/0\"");
    case(
        BAR,
        "mass-spring', ",
        "mass-spring', young = 2e5, ",
        "9:33 unknown key `young` in `run[1].model` springs have a Poisson's ratio of their own, 1/4, in the plane 1/3; write `stiffness`: 6 E V/Σ L²",
    );
    // Elements that break have exact rotations.
    let breaks_at = |strain: &str| format!("young = 2e5, breaks_at = {strain}");
    young(&breaks_at("0"), "6:58 `run[0].model.breaks_at` is 0; expected a number greater than 0");
    young(&breaks_at("0.1, passes = 2"), "6:58 `breaks_at` compares strains, which need exact rotations");
    let rotation = "0.1, rotation = 'linear-update'";
    young(&breaks_at(rotation), "6:58 `breaks_at` compares strains, which need exact rotations");
    let bars = "bars = { count = 3, length = 0.1, direction = [1, 0.2, 0] }";
    case(BAR, "lattice = { cells = [3, 1, 1], side = 0.1 }", bars, "6:41 element 0 has no volume");
}

#[test]
fn bending_of_what_does_not_bend_is_told() {
    let triangle = "body = { nodes = [[0, 0], [1, 0], [0, 1]], elements = [[0, 1, 2]] }";
    let square = "body = { lattice = { cells = [1, 1], side = 1 } }";
    let with = |body: &str, model: &str| {
        let run = format!("[[run]]\nname = 'run'\nmodel = {{ kind = {model} }}\n");
        warnings(&format!("time = {{ duration = 1 }}\n{body}\n{run}"))
    };
    for kind in ["'shape-based'", "'xpbd'"] {
        let bent = format!("{kind}, stiffness = 1e4, bending = '1/3'");
        let [(5, message)] = &with(triangle, &bent)[..] else { panic!("{:?}", with(triangle, &bent)) };
        assert!(
            message.starts_with("`bending` has no effect on this body: segments and triangles do not bend"),
            "{message}"
        );
        assert_eq!(with(square, &bent), []);
        assert_eq!(with(triangle, &bent.replace("'1/3'", "1")), []);
        // A model of several bodies acts on those that bend.
        let both = format!(
            "body = [{}, {}]",
            square.replacen("body = {", "{ name = 'a', offset = [3, 0], ", 1),
            triangle.replacen("body = {", "{ name = 'b', ", 1)
        );
        assert_eq!(with(&both, &bent), []);
    }
}

/// The warnings of a scene.
fn warnings(text: &str) -> Vec<(usize, String)> {
    good(text).warnings.into_iter().map(|warning| (warning.line, warning.message)).collect()
}

#[test]
fn damping_that_brakes_a_body_which_turns_is_told() {
    let with = |more: &str| BAR.replace("lowest = 0.3", &format!("lowest = 0.3, {more}"));
    let message = |reason: &str| {
        vec![(6, format!("the damping of \"Local shape\" also brakes rotation, and its body will turn: {reason}"))]
    };
    assert_eq!(warnings(BAR), []);
    assert_eq!(warnings(&with("velocity = [0, -3, 0]")), []);
    assert_eq!(warnings(&with("velocity = [2, -3, 0]")), message("it meets an obstacle at an angle"));
    let spun = with("spin = { axis = [0, 1, 0], rate = 2 }");
    assert_eq!(warnings(&spun), message("it starts with a spin"));
    let hung = BAR.split("[[obstacle]]").next().unwrap();
    assert_eq!(warnings(&format!("{hung}[[hold]]\nnodes = 'left'\n")), message("it is held at one side"));
    assert_eq!(warnings(&format!("{hung}[[hold]]\nnodes = 'left'\nuntil = 0.5\n")), []);
    let slope = BAR.replace("kind = 'floor'", "kind = 'floor'\nnormal = [0.5, 1, 0]");
    assert_eq!(warnings(&slope), message("there is a slope"));
    // Whoever asks for it by name, does not damp, or does not compare, is not told.
    let of = |damping: &str| spun.replacen("damping_ratio = 0.1", damping, 1);
    assert_eq!(warnings(&of("damping_ratio = 0.1, damping_of = 'relative-motion'")), []);
    assert_eq!(warnings(&of("damping_ratio = 0.1, damping_of = 'deformation'")), []);
    assert_eq!(warnings(&of("damping_ratio = 0")), []);
    let alone = spun.replace("kind = 'mass-spring', stiffness", "kind = 'shape-based', stiffness");
    assert_eq!(warnings(&alone), []);
}
