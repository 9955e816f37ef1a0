//! Regions with a material of their own.

use super::{bad, expect, good};
use glam::DVec3;
use localshape::scene::{BodyBuilder, Lattice, Limits, NodeSet, RegionBuilder, Scene, Side};
use localshape::sim::model::shape_based;
use localshape::sim::{State, Surroundings, World};

/// A bar of four cubes with sides of 0.1 m.
fn text(regions: &str, model: &str) -> String {
    format!(
        "time = {{ duration = 1 }}\nrun = [{{ name = 'one', model = {{ {model} }} }}]\n\
         body = {{ lattice = {{ cells = [4, 1, 1], side = 0.1 }}, density = 1000, region = [{regions}] }}\n"
    )
}

const SHAPE: &str = "kind = 'shape-based', stiffness = 1e4";

#[test]
fn cells_are_chosen_by_place_side_and_number() {
    for (cells, expected) in [
        ("{ low = [-0.2, 0, -1], high = [0, 1, 1] }", &[0, 1][..]),
        ("{ of = [0.05, 0.05, 0], within = 0.05 }", &[2]),
        ("'right'", &[3]),
        ("'top'", &[0, 1, 2, 3]),
        ("[2, 0]", &[0, 2]),
    ] {
        let scene = good(&text(&format!("{{ name = 'core', cells = {cells}, stiffness = 4 }}"), SHAPE));
        let [core] = &scene.bodies[0].regions[..] else { panic!("a region") };
        assert_eq!(core.elements, expected, "{cells}");
        let moduli: Vec<f64> = (0..4).map(|cell| if expected.contains(&cell) { 4.0 } else { 1.0 }).collect();
        assert_eq!(scene.bodies[0].body.modulus(), Some(&moduli[..]));
    }
}

#[test]
fn densities_and_moduli_are_those_of_the_cells() {
    let region = "{ name = 'core', cells = [0], young = 4e5, density = 3000 }";
    let scene = good(&text(region, "kind = 'neo-hookean', young = 1e5, poisson = 0.3"));
    let body = &scene.bodies[0].body;
    assert_eq!(body.modulus(), Some(&[4.0, 1.0, 1.0, 1.0][..]));
    assert!((body.mass().iter().sum::<f64>() - 6.0).abs() < 1e-12);
    // Nodes of the first layer belong to the core alone, those of the second to both.
    for (node, mass) in [(0, 0.375), (1, 0.5), (2, 0.25), (4, 0.125)] {
        assert!((body.mass()[node] - mass).abs() < 1e-12, "{node}: {}", body.mass()[node]);
    }
    let said = scene.summary().to_string();
    assert!(said.contains("  region    core: 1 element, stiffness × 4, 3000 kg/m³\n"), "{said}");
    let plain = good(&text("", SHAPE));
    assert_eq!((plain.bodies[0].body.modulus(), plain.bodies[0].body.stiffness()), (None, None));
}

/// The forces of every model on a stretched body are those of the same body of one material, times the factor of its region.
#[test]
fn every_model_takes_the_modulus_of_its_cells() {
    for model in [
        SHAPE,
        "kind = 'shape-based', young = 1e5, poisson = 0.2",
        "kind = 'mass-spring', stiffness = 1e4",
        "kind = 'volume-springs', stiffness = 1e4, bulk = 1e5",
        "kind = 'linear', young = 1e5, poisson = 0.3",
        "kind = 'corotational', young = 1e5, poisson = 0.3",
        "kind = 'neo-hookean', young = 1e5, poisson = 0.3",
        "kind = 'metric', young = 1e5, poisson = 0.3",
    ] {
        let forces = |regions: &str| -> Vec<DVec3> {
            let scene = good(&text(regions, model));
            let (run, rest) = (&scene.runs[0], scene.bodies[0].body.rest());
            let bent = |&at: &DVec3| at * DVec3::new(1.2, 0.9, 1.0) + DVec3::Y * 0.5 * at.x * at.x;
            let initial = State::at_rest(rest.iter().map(bent).collect());
            let stepping = localshape::sim::Stepping::new(run.integrator, run.step);
            World::new(run.body(), initial, &*run.models[0], Surroundings::default(), stepping).forces()
        };
        let (plain, whole) = (forces(""), forces("{ name = 'all', cells = 'top', stiffness = 4 }"));
        let half = forces("{ name = 'half', cells = [2, 3], stiffness = 4 }");
        let off = |one: DVec3, other: DVec3| {
            (one - other).length() / plain.iter().map(|one| one.length()).fold(0.0, f64::max)
        };
        for (node, place) in good(&text("", model)).bodies[0].body.rest().iter().enumerate() {
            assert!(off(whole[node], 4.0 * plain[node]) < 1e-9, "{model}: {} {}", whole[node], plain[node]);
            let factor = if place.x < -0.05 { 1.0 } else { 4.0 };
            assert!(place.x.abs() < 0.05 || off(half[node], factor * plain[node]) < 1e-9, "{model}: node {node}");
        }
    }
}

#[test]
fn mistakes_in_regions_are_located() {
    let case = |regions: &str, model: &str, expected: &str| expect(&bad(&text(regions, model)), 2, expected);
    let from = 80;
    let at = |column: usize, words: &str| format!("1:{} {words}", from + column);
    let two = "{ name = 'a', cells = [0, 1], stiffness = 2 }, { name = 'b', cells = [1, 2], stiffness = 3 }";
    case(two, SHAPE, &at(70, "cell 1 lies in the regions \"a\" and \"b\", which give it different values make one"));
    good(&text(&two.replace("stiffness = 3", "density = 2000"), SHAPE));
    good(&text(&two.replace('3', "2"), SHAPE));
    case("{ name = 'a', cells = [4], stiffness = 2 }", SHAPE, &at(24, "there is no cell 4; the body has cells 0 to 3"));
    case("{ name = 'a', cells = [0] }", SHAPE, &at(1, "it has no `stiffness`, `young` or `density`"));
    let young = "{ name = 'a', cells = [0], young = 2e5 }";
    case(young, SHAPE, &at(28, "not all models of the body have one and the same `young` write `stiffness`"));
    let empty = "{ name = 'a', cells = { of = [5, 0, 0], within = 0.1 }, stiffness = 2 }";
    case(empty, SHAPE, &at(23, "takes no cell of the body"));
    let dense = text("{ name = 'a', cells = [0], density = 2000 }", SHAPE).replace("density = 1000, ", "");
    expect(&bad(&dense), 2, "1:92 needs the `density` of the rest of the body");
    case("{ cells = [0], stiffness = 2 }", SHAPE, &at(1, "has no `name`"));
}

#[test]
fn a_scene_in_code_has_regions() {
    let region = RegionBuilder::new("core", NodeSet::side(Side::Left)).stiffness(3.0).density(2000.0);
    let body = BodyBuilder::lattice(Lattice::new([2, 1, 1], 0.1)).density(1000.0).region(region);
    let scene = Scene::builder("bar", body).run("one", shape_based::Parameters::new(1e4));
    let scene = scene.build(&Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.bodies[0].body.modulus(), Some(&[3.0, 1.0][..]));
    assert!((scene.bodies[0].body.mass().iter().sum::<f64>() - 3.0).abs() < 1e-12);
}
