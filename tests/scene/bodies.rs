//! Generated bodies, and elements of every shape.

use super::{WORLD, bad, good};
use glam::DVec3;
use localshape::runner::Runner;
use localshape::scene::{Scene, description};
use localshape::sim::geometry::volumes_at_rest;
use localshape::sim::{Dimension, ElementKind};
use std::collections::BTreeMap;

/// A world in which a body falls on a floor, with a run of each model.
fn world(body: &str, dimension: Dimension) -> String {
    let gravity = if dimension == Dimension::Plane { "[0, -9.8]" } else { "[0, -9.8, 0]" };
    format!(
        "gravity = {gravity}
time = {{ duration = 0.3, step = 'T/100', frames_per_second = 10 }}
obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3 }}]
[[run]]
name = 'Local shape'
model = {{ kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1 }}
[[run]]
name = 'Mass-spring'
model = {{ kind = 'mass-spring', stiffness = 1e4, damping_ratio = 0.1, springs = 'edges+face-diagonals' }}
[body]
{body}
"
    )
}

/// The number of elements for each number of nodes.
type Sizes = &'static [(usize, usize)];

/// Bodies of every generator, with the number of elements for each number of nodes unless it is random.
const BODIES: [(&str, Dimension, Sizes); 13] = [
    ("lattice = { cells = [3, 2], side = 0.1 }", Dimension::Plane, &[(4, 6)]),
    ("lattice = { cells = [3, 2], side = [0.1, 0.2], elements = 'triangles' }", Dimension::Plane, &[(3, 12)]),
    ("lattice = { cells = [5, 4], side = 0.1, elements = 'mixed', irregular = 0.4 }", Dimension::Plane, &[]),
    ("lattice = { cells = [2, 2, 2], side = 0.1, irregular = 0.3, seed = 4 }", Dimension::Space, &[(8, 8)]),
    ("lattice = { cells = [2, 2, 3], side = 0.1, elements = 'tetrahedra' }", Dimension::Space, &[(4, 60)]),
    ("lattice = { cells = [3, 3, 3], side = 0.1, elements = 'mixed', irregular = 0.2 }", Dimension::Space, &[]),
    ("polygon = { sides = 6, radius = 0.3 }", Dimension::Plane, &[(6, 1)]),
    ("polygon = { sides = 3, radius = 0.3 }", Dimension::Plane, &[(3, 1)]),
    ("fan = { sides = 6, radius = 0.3 }", Dimension::Plane, &[(3, 6)]),
    ("disc = { radius = 0.3, rings = 3, sectors = 12 }", Dimension::Plane, &[(3, 12), (4, 24)]),
    ("disc = { radius = 0.3, rings = 1, sectors = 3 }", Dimension::Plane, &[(3, 3)]),
    ("bars = { count = 4, length = 0.1, direction = [1, 0] }", Dimension::Plane, &[(2, 4)]),
    ("bars = { count = 4, length = 0.1, direction = [0, 1, 1] }", Dimension::Space, &[(2, 4)]),
];

fn sizes(scene: &Scene) -> Vec<(usize, usize)> {
    let mut sizes = BTreeMap::new();
    scene.bodies[0].body.elements().iter().for_each(|nodes| *sizes.entry(nodes.len()).or_insert(0) += 1);
    sizes.into_iter().collect()
}

/// The positions of all runs at the last frame.
fn end(scene: &Scene) -> Vec<Vec<DVec3>> {
    let all: Vec<_> = (0..scene.runs.len()).collect();
    let frame = Runner::new(scene, &all).frame(scene.last_frame());
    frame.runs.into_iter().map(|run| run.snapshot.position.clone()).collect()
}

#[test]
fn every_rule_makes_the_body_that_it_says() {
    for (body, dimension, expected) in BODIES {
        let scene = good(&world(body, dimension));
        assert_eq!(scene.bodies[0].body.dimension(), dimension, "{body}");
        if !expected.is_empty() {
            assert_eq!(sizes(&scene), expected, "{body}");
        }
        // Each body stands at the level of the origin, and all nodes belong to elements.
        let lowest = scene.bodies[0].body.rest().iter().map(|node| node.y).fold(f64::INFINITY, f64::min);
        assert!(lowest.abs() < 1e-15, "{body}: {lowest}");
        let mut nodes: Vec<u32> = scene.bodies[0].body.elements().indices().to_vec();
        nodes.sort_unstable();
        nodes.dedup();
        assert_eq!(nodes.len(), scene.bodies[0].body.len(), "{body}");
    }
}

#[test]
fn every_rule_puts_the_body_where_it_is_said_to_be() {
    for (body, start) in [
        ("lattice = { cells = [6, 2, 3], side = 0.1 }", "between (-0.3, 0, -0.15) and (0.3, 0.2, 0.15) m"),
        ("lattice = { cells = [3, 2], side = [0.1, 0.2] }", "between (-0.15, 0) and (0.15, 0.4) m"),
        (
            "lattice = { cells = [4, 4, 4], side = 0.1, irregular = 0.3 }",
            "between (-0.2, 0, -0.2) and (0.2, 0.4, 0.2) m",
        ),
        ("polygon = { sides = 4, radius = 1.414213562373095 }", "between (-1, 0) and (1, 2) m"),
        ("fan = { sides = 4, radius = 1.414213562373095 }", "between (-1, 0) and (1, 2) m"),
        ("disc = { rings = 2, sectors = 4, radius = 1.414213562373095 }", "between (-1, 0) and (1, 2) m"),
        ("polygon = { sides = 3, radius = 1 }", "between (-0.8661, 0) and (0.8661, 1.5) m"),
        ("bars = { count = 3, length = 0.1, direction = [0, -2] }", "between (0, -0.3) and (0, 0) m"),
        ("bars = { count = 3, length = 0.1, direction = [-1, 0, 0] }", "between (-0.3, 0, 0) and (0, 0, 0) m"),
        ("nodes = [[1, 2], [2, 2], [1, 3]]\nelements = [[0, 1, 2]]", "between (1, 2) and (2, 3) m"),
        // A quarter turn about the mean of the nodes, a translation, and then the height.
        (
            "lattice = { cells = [6, 2], side = 0.1 }\nrotation.angle = 1.5707963267948966\noffset = [1, 7]\nlowest = 0.5",
            "between (0.9, 0.5) and (1.1, 1.1) m",
        ),
        (
            "lattice = { cells = [6, 2], side = 0.1 }\nrotation.angle = 1.5707963267948966",
            "between (-0.1, -0.2) and (0.1, 0.4) m",
        ),
    ] {
        let summary = good(&format!("{WORLD}[body]\n{body}")).summary().to_string();
        assert!(summary.contains(&format!("\n  start     {start}\n")), "{body}: {start}\n{summary}");
    }
}

#[test]
fn a_lattice_has_the_same_nodes_however_it_is_cut() {
    let nodes =
        |more: &str| good(&world(&format!("lattice = {{ cells = [4, 3, 2], side = 0.1{more} }}"), Dimension::Space));
    let plain = nodes("").bodies[0].body.rest().to_vec();
    assert_eq!(nodes(", elements = 'tetrahedra'").bodies[0].body.rest(), plain);
    assert_eq!(nodes(", elements = 'mixed', seed = 9").bodies[0].body.rest()[..plain.len()], plain);
}

#[test]
fn the_seed_chooses_the_body_and_one_is_the_default() {
    let rest = |more: &str| {
        let lattice =
            format!("lattice = {{ cells = [4, 3, 2], side = 0.1, elements = 'mixed', irregular = 0.2{more} }}");
        let scene = good(&world(&lattice, Dimension::Space));
        (scene.bodies[0].body.rest().to_vec(), scene.bodies[0].body.elements().clone(), scene.digest)
    };
    let one = rest("");
    assert_eq!(rest(", seed = 1"), one);
    let two = rest(", seed = 2");
    assert!(two.0 != one.0 && two.1 != one.1 && two.2 != one.2);
}

/// The corners of an element: a node and the nodes that span its area or volume with it.
fn corners(nodes: usize, dimension: Dimension) -> Vec<Vec<usize>> {
    match (dimension, nodes) {
        (Dimension::Plane, 4) => (0..4).map(|at| vec![at, (at + 1) % 4, (at + 3) % 4]).collect(),
        // All nodes are relative to the first one.
        (Dimension::Plane, _) => (2..nodes).map(|at| vec![0, at - 1, at]).collect(),
        (Dimension::Space, 4) => vec![vec![0, 1, 2, 3]],
        (Dimension::Space, 5) => (0..4).map(|at| vec![at, (at + 1) % 4, (at + 3) % 4, 4]).collect(),
        (Dimension::Space, 6) => {
            let triangle = |at: usize| at / 3 * 3;
            (0..6).map(|at| vec![at, triangle(at) + (at + 1) % 3, triangle(at) + (at + 2) % 3, (at + 3) % 6]).collect()
        }
        _ => (0..8).map(|at| vec![at, at ^ 1, at ^ 2, at ^ 4]).collect(),
    }
}

/// Random displacements that would make an element flat or invert it are reduced: each corner keeps a tenth of its
/// regular volume. Without that, one in ten thousand corners does not.
#[test]
fn irregular_blocks_have_no_element_that_is_nearly_flat() {
    for (cells, elements) in [
        ("[100, 100]", "cells"),
        ("[100, 100]", "triangles"),
        ("[100, 100]", "mixed"),
        ("[20, 20, 20]", "cells"),
        ("[20, 20, 20]", "tetrahedra"),
        ("[20, 20, 20]", "mixed"),
    ] {
        let mut moved_far = 0;
        for seed in 1..=2 {
            let block = |irregular: f64| {
                let rule = format!("cells = {cells}, side = 1, elements = '{elements}', irregular = {irregular}");
                good(&format!("body.lattice = {{ {rule}, seed = {seed} }}\n{WORLD}")).bodies.remove(0).body
            };
            let (regular, moved) = (block(0.0), block(0.4));
            assert_eq!(regular.elements(), moved.elements());
            for element in regular.elements().iter() {
                for corner in corners(element.len(), regular.dimension()) {
                    let spanned = |rest: &[DVec3]| {
                        let at =
                            |place: usize| rest[element[corner[place]] as usize] - rest[element[corner[0]] as usize];
                        let area = at(1).cross(at(2));
                        if corner.len() == 3 { area.z } else { area.dot(at(3)) }
                    };
                    let left = spanned(moved.rest()) / spanned(regular.rest());
                    assert!(left >= 0.1, "{cells} {elements}, seed {seed}, element {element:?}: {left}");
                }
            }
            moved_far += regular.rest().iter().zip(moved.rest()).filter(|(a, b)| a.distance(**b) > 0.25).count();
        }
        assert!(moved_far > 0, "{cells} {elements}: and yet they are irregular");
    }
}

/// The same bits on every machine: stored results of irregular bodies depend on them.
#[test]
fn random_bodies_are_the_same_everywhere() {
    let scene = good(&world(
        "lattice = { cells = [3, 3, 3], side = 0.1, elements = 'mixed', irregular = 0.2 }",
        Dimension::Space,
    ));
    let bits = scene.bodies[0].body.rest().iter().flat_map(|node| node.to_array()).map(f64::to_bits);
    let bits = bits.chain(scene.bodies[0].body.elements().indices().iter().map(|&index| index.into()));
    let sum = bits.fold(0u64, |sum, bits| (sum ^ bits).wrapping_mul(0x0100_0000_01b3).rotate_left(23));
    assert_eq!((scene.bodies[0].body.len(), scene.bodies[0].body.elements().len(), sum), RANDOM);
}

const RANDOM: (usize, usize, u64) = (78, 127, 7_934_938_136_864_051_000);

/// The same body listed node by node, with the nodes in another order and the elements reversed.
fn listed(scene: &Scene) -> (String, impl Fn(usize) -> usize) {
    let count = scene.bodies[0].body.len();
    // A stride without a common factor gives a permutation.
    let stride = [7, 11, 13].into_iter().find(|stride| !count.is_multiple_of(*stride)).expect("one of them");
    let renamed = move |node: usize| (node * stride + 3) % count;
    let point = |at: DVec3| match scene.bodies[0].body.dimension() {
        Dimension::Plane => format!("[{:?}, {:?}]", at.x, at.y),
        Dimension::Space => format!("[{:?}, {:?}, {:?}]", at.x, at.y, at.z),
    };
    let mut nodes = vec![String::new(); count];
    scene.bodies[0].body.rest().iter().enumerate().for_each(|(node, &at)| nodes[renamed(node)] = point(at));
    let renamed_all = |element: &[u32]| element.iter().map(|&node| renamed(node as usize)).collect();
    let mut elements: Vec<Vec<usize>> = scene.bodies[0].body.elements().iter().map(renamed_all).collect();
    elements.reverse();
    (format!("nodes = [{}]\nelements = {elements:?}", nodes.join(", ")), renamed)
}

#[test]
fn a_body_made_by_a_rule_moves_like_the_same_body_listed_in_any_order() {
    for (body, dimension, _) in BODIES {
        let start = match dimension {
            Dimension::Plane => "rotation = { angle = 0.1 }\nlowest = 0.02\nvelocity = [0.3, -2]",
            Dimension::Space => {
                "rotation = { axis = [1, 0, 2], angle = 0.1 }\nlowest = 0.02\nvelocity = [0.3, -2, 0.1]"
            }
        };
        for springs in ["edges+face-diagonals", "edges+one-diagonal"] {
            let with = |text: String| good(&world(&text, dimension).replace("edges+face-diagonals", springs));
            let made = with(format!("{body}\n{start}"));
            let (text, renamed) = listed(&made);
            let listed = with(format!("{text}\n{start}"));
            assert_eq!(listed.summary().bodies[0].elements, made.summary().bodies[0].elements);
            for (run, (one, other)) in end(&made).iter().zip(&end(&listed)).enumerate() {
                let moved = one[0].distance(made.runs[0].initial.position[0]);
                assert!(moved > 0.01, "{body}: {moved}");
                for (node, position) in one.iter().enumerate() {
                    let distance = position.distance(other[renamed(node)]);
                    assert!(distance <= 1e-12, "{body}, run {run}, node {node}: {distance:e}");
                }
            }
        }
    }
}

/// One element of each kind and shape, flat ones too, as nodes and elements.
const ELEMENTS: [(&str, &str, usize); 11] = [
    ("a bar in the plane", "[[0,0],[1,0]]", 2),
    ("a concave pentagon", "[[0,0],[2,0],[2,2],[1,0.5],[0,2]]", 5),
    (
        "a dodecagon that is no regular one",
        "[[0,0],[2,0],[3,1],[3,2],[2,3],[1.5,3.2],[1,3.2],[0,3],[-1,2],[-1.2,1.5],[-1.1,1],[-1,0.5]]",
        12,
    ),
    ("a bar in space", "[[0,0,0],[1,0,1]]", 2),
    ("cloth of one triangle", "[[0,0,0],[1,0,0],[0,0.2,1]]", 3),
    ("a pyramid", "[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0.4,0.5,1]]", 5),
    ("a cube without a corner", "[[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1]]", 7),
    ("a flat heptagon in space", "[[0,0,0],[2,0,0],[3,1,1],[2.5,2,2],[1,3,3],[-1,2,2],[-1,1,1]]", 7),
    ("a rod of seven nodes", "[[0,0,0],[1,1,0],[2,2,0],[3,3,0],[4,4,0],[5,5,0],[6,6,0]]", 7),
    (
        "a triangulated square antiprism with nodes inside",
        "[[1,0,0],[0,1,0],[-1,0,0],[0,-1,0],[0.7,0.7,1],[-0.7,0.7,1],[-0.7,-0.7,1],[0.7,-0.7,1],[0,0,0.4],[0.1,0,0.6]]",
        10,
    ),
    (
        "a pentagonal prism",
        "[[1,0,0],[0.31,0.95,0],[-0.81,0.59,0],[-0.81,-0.59,0],[0.31,-0.95,0],[1,0,1],[0.31,0.95,1],[-0.81,0.59,1],[-0.81,-0.59,1],[0.31,-0.95,1]]",
        10,
    ),
];

#[test]
fn elements_of_every_shape_run_in_both_models() {
    for (name, nodes, count) in ELEMENTS {
        let all: Vec<_> = (0..count).collect();
        let dimension = if nodes.matches(',').count() == 2 * count - 1 { Dimension::Plane } else { Dimension::Space };
        let scene = world(&format!("nodes = {nodes}\nelements = [{all:?}]\nlowest = 0.1"), dimension);
        let scene = good(&scene.replace("edges+face-diagonals", "all"));
        assert_eq!(scene.bodies[0].body.dimension(), dimension, "{name}");
        for positions in end(&scene) {
            assert!(positions.iter().all(|at| at.is_finite() && at.length() < 20.0), "{name}: {positions:?}");
        }
        assert!(!scene.summary().to_string().is_empty());
    }
}

#[test]
fn every_named_topology_holds_an_element_of_any_shape_together() {
    let (_, prism, _) = ELEMENTS[10];
    for (springs, count) in [
        ("edges", 15),
        ("edges+one-diagonal", 15 + 5 + 2 * 2),
        ("edges+face-diagonals", 15 + 5 * 2 + 2 * 5),
        ("edges+body-diagonals", 15 + 10),
        ("all", 45),
    ] {
        let scene =
            world(&format!("nodes = {prism}\nelements = [[0,1,2,3,4,5,6,7,8,9]]\nlowest = 0"), Dimension::Space);
        let scene = good(&scene.replace("edges+face-diagonals", springs));
        let words = description(scene.runs[1].models[0].as_ref(), &scene.bodies[0].body);
        assert!(words.starts_with(&format!("{count} springs,")), "{springs}: {words}");
    }
}

#[test]
fn faces_listed_by_hand_are_inside_where_two_elements_hold_them() {
    let nodes = "[[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,1],[1,0,1],[0,1,1],[1,1,1],[0,0,2],[1,0,2],[0,1,2],[1,1,2]]";
    let body = format!(
        "nodes = {nodes}\nelements = [[0,1,2,3,4,5,6,7],[4,5,6,7,8,9,10,11]]\n\
         faces = [[0,2,3,1],[4,5,7,6],[8,9,11,10],[0,1,5,4],[4,5,9,8]]"
    );
    let faces = good(&world(&body, Dimension::Space)).bodies[0].body.faces().clone();
    assert_eq!(faces.inner, [Some(0), Some(0), Some(1), Some(0), Some(1)]);
    assert_eq!(faces.outer, [None, Some(1), None, None, None]);
}

#[test]
fn a_summary_counts_the_elements_of_each_kind() {
    let body = |body, dimension| good(&world(body, dimension)).summary().to_string().lines().nth(1).unwrap().to_owned();
    assert_eq!(
        body(BODIES[9].0, Dimension::Plane),
        "  body      37 nodes, 36 elements (12 triangles and 24 quadrilaterals), 0.5796 × 0.5796 m, 37 kg"
    );
    let mixed = body("lattice = { cells = [4, 4, 4], side = 0.1, elements = 'mixed' }", Dimension::Space);
    assert!(
        mixed.contains(" elements (") && mixed.contains(" tetrahedra, ") && mixed.contains(" pyramids, "),
        "{mixed}"
    );
    assert!(mixed.contains(" wedges and ") && mixed.contains(" cubes), 0.4 × 0.4 × 0.4 m"), "{mixed}");
    assert!(body(BODIES[0].0, Dimension::Plane).contains(" 12 nodes, 6 squares, "));
}

#[test]
fn kinds_are_those_of_the_number_of_nodes() {
    let scene = good(&world("bars = { count = 2, length = 0.1, direction = [0, 0, 2] }", Dimension::Space));
    assert_eq!(scene.bodies[0].body.kinds(), [ElementKind::Segment; 2]);
    assert!((scene.bodies[0].body.rest()[2] - DVec3::Z * 0.2).length() < 1e-16);
}

#[test]
fn bodies_beyond_the_limits_are_refused_before_they_are_made() {
    for (body, dimension, words) in [
        ("polygon = { sides = 4000000000, radius = 1 }", Dimension::Plane, "4 000 000 000 nodes, 1 element and"),
        ("fan = { sides = 40000000, radius = 1 }", Dimension::Plane, "40 000 001 nodes, 40 000 000 elements and"),
        ("disc = { rings = 4000000000, sectors = 4000000000, radius = 1 }", Dimension::Plane, "32-bit indices"),
        ("bars = { count = 40000000, length = 1, direction = [1, 0] }", Dimension::Plane, "use fewer bars"),
        ("lattice = { cells = [300, 300, 300], side = 1, elements = 'mixed' }", Dimension::Space, "use fewer cells"),
        (
            "lattice = { cells = [300, 300, 300], side = 1, elements = 'tetrahedra' }",
            Dimension::Space,
            "135 000 000 elements",
        ),
        (
            "lattice = { cells = [9000, 9000], side = 1, elements = 'triangles' }",
            Dimension::Plane,
            "162 000 000 elements",
        ),
    ] {
        let error = bad(&world(body, dimension).replace("'edges+face-diagonals'", "'edges'"));
        let [mistake] = error.mistakes() else { panic!("{error}") };
        assert!(error.to_string().contains(words), "{error}");
        assert!(mistake.line == 11, "{error}");
    }
}

#[test]
fn bodies_may_start_without_depth_inside_out_or_at_random() {
    let scene = |start: &str| {
        let body = format!("body = {{ lattice = {{ cells = [2, 1, 1], side = 0.5 }}, start = {start} }}");
        good(&format!("{body}\n{WORLD}"))
    };
    let start = |typed: &str| {
        let scene = scene(typed);
        let middle = scene.bodies[0].body.rest().iter().sum::<DVec3>() / scene.bodies[0].body.len() as f64;
        let rest: Vec<_> = scene.bodies[0].body.rest().iter().map(|at| *at - middle).collect();
        (rest, scene.runs[0].initial.position.iter().map(|at| *at - middle).collect::<Vec<_>>())
    };
    let near = |one: DVec3, other: DVec3| one.distance(other) < 1e-12;
    let of = |typed: &str, expected: &dyn Fn(DVec3) -> DVec3| {
        let (rest, start) = start(typed);
        rest.iter().zip(&start).for_each(|(&rest, &at)| assert!(near(at, expected(rest)), "{typed}: {rest} {at}"));
    };
    of("{ shape = 'point' }", &|_| DVec3::ZERO);
    of("{ shape = 'line' }", &|at| at.x * DVec3::X);
    of("{ shape = 'line', direction = [0, -2, 0] }", &|at| at.y * DVec3::Y);
    of("{ shape = 'plane', direction = [0, 0, 3] }", &|at| at.with_z(0.0));
    of("{ shape = 'mirror-image' }", &|at| at.with_x(-at.x));
    let (rest, cloud) = start("{ shape = 'cloud' }");
    let size = rest.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    assert!(cloud.iter().all(|at| at.abs().cmple(size).all()), "{cloud:?}");
    assert_eq!(cloud, start("{ shape = 'cloud', seed = 1 }").1);
    assert_ne!(cloud, start("{ shape = 'cloud', seed = 2 }").1);
    // At rest nothing has changed, and the other initial conditions are applied.
    let moved = good(&format!(
        "body = {{ lattice = {{ cells = [2, 1, 1], side = 0.5 }}, start = {{ shape = 'point' }}, lowest = 3 }}\n{WORLD}"
    ));
    assert!(
        moved.runs[0].initial.position.iter().all(|at| at.y == 3.0)
            && moved.bodies[0].body.rest() == scene("{ shape = 'point' }").bodies[0].body.rest()
    );
}

#[test]
fn a_start_says_what_is_wrong_with_it() {
    let body = |start: &str, more: &str| {
        format!("body = {{ nodes = [[0, 0], [1, 0], [0, 1]], elements = [[0, 1, 2]], {more}start = {start} }}\n{WORLD}")
    };
    for (start, more, words) in [
        ("{ shape = 'ball' }", "", "expected \"point\", \"line\", \"plane\", \"mirror-image\" or \"cloud\""),
        ("{ seed = 2 }", "", "`body.start` has no `shape`"),
        ("{ shape = 'line', direction = [0, 0, 1] }", "", "`body.start.direction` has 3 coordinates; expected 2"),
        ("{ shape = 'line', direction = [0, 0] }", "", "`body.start.direction` is zero"),
        (
            "{ shape = 'point', direction = [0, 1] }",
            "",
            "`body.start.direction` is about lines, planes and mirror images, but the shape is \"point\"",
        ),
        ("{ shape = 'cloud', direction = [0, 1] }", "", "but the shape is \"cloud\""),
        // The default seed has no effect either.
        ("{ shape = 'plane', seed = 1 }", "", "`body.start.seed` is about clouds, but the shape is \"plane\""),
        ("{ shape = 'mirror-image', seed = 2 }", "", "but the shape is \"mirror-image\""),
        (
            "{ shape = 'point' }",
            "positions = [[0, 0], [1, 0], [0, 1]], ",
            "`positions` and `start`, which exclude each other",
        ),
    ] {
        let error = bad(&body(start, more));
        let [mistake] = error.mistakes() else { panic!("one mistake in {start}\n{error}") };
        assert_eq!(mistake.line, 1, "{error}");
        let error = error.to_string();
        assert!(error.contains(words), "{words:?} is not in\n{error}");
    }
}

/// The mass of each node.
fn masses(body: &str, dimension: Dimension) -> Vec<f64> {
    good(&world(body, dimension)).bodies[0].body.mass().to_vec()
}

/// The density times the volume, or the typed mass, whatever the elements are.
#[test]
fn masses_add_up() {
    for (body, dimension, _) in BODIES {
        let is_bars = body.starts_with("bars");
        for mass in masses(&format!("{body}\nmass_total = 2"), dimension) {
            assert!(mass > 0.0, "{body}");
        }
        let total: f64 = masses(&format!("{body}\nmass_total = 2"), dimension).iter().sum();
        assert!((total - 2.0).abs() < 1e-14, "{body}: {total}");
        if is_bars {
            continue;
        }
        let scene = good(&world(&format!("{body}\ndensity = 1e3"), dimension));
        let (rest, mass) = (&scene.bodies[0].body, scene.bodies[0].body.mass());
        let volume: f64 = volumes_at_rest(rest).iter().sum();
        assert!(mass.iter().all(|&mass| mass > 0.0), "{body}");
        let total: f64 = mass.iter().sum();
        assert!((total - 1e3 * volume).abs() < 1e-13 * total, "{body}: {total}, {volume}");
        // Both are shared in the same way.
        let shared = masses(&format!("{body}\nmass_total = {total:e}"), dimension);
        assert!(mass.iter().zip(shared).all(|(one, other)| (one - other).abs() < 1e-13 * one), "{body}");
    }
    let total = |body: &str, dimension| masses(body, dimension).iter().sum::<f64>();
    let block = "lattice = { cells = [3, 2, 2], side = [0.1, 0.2, 0.3]";
    for more in ["}", ", irregular = 0.3 }", ", elements = 'mixed' }", ", elements = 'tetrahedra' }"] {
        let total = total(&format!("{block}{more}\ndensity = 1e3"), Dimension::Space);
        assert!((total - 72.0).abs() < 1e-12, "{more}: {total}");
    }
    let hexagon = total("fan = { sides = 6, radius = 1 }\ndensity = 2", Dimension::Plane);
    assert!((hexagon - 27.0_f64.sqrt()).abs() < 1e-14, "{hexagon}");
}

/// A node has the share of all elements that it belongs to.
#[test]
fn elements_share_their_mass_equally_among_their_nodes() {
    let two = "nodes = [[0, 0], [1, 0], [1, 1], [0, 1], [3, 0]]\nelements = [[0, 1, 2, 3], [1, 4, 2]]\n";
    let third = 1.0 / 3.0;
    let shares = [0.25, 0.25 + third, 0.25 + third, 0.25, third];
    for (typed, expected) in [("density = 1", shares), ("mass_total = 4", shares.map(|share| 2.0 * share))] {
        let mass = masses(&format!("{two}{typed}"), Dimension::Plane);
        assert!(mass.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-15), "{typed}: {mass:?}");
    }
    // An octahedron of 4/3 m³ with a seventh node inside it.
    let octahedron = "nodes = [[1,0,0],[0,0,-1],[0,1,0],[-1,0,0],[0,-1,0],[0,0,1],[0.1,0,0]]\nelements = [[0,1,2,3,4,5,6]]\nlowest = 0\n";
    let mass = masses(&format!("{octahedron}density = 21"), Dimension::Space);
    assert!(mass.iter().all(|mass| (mass - 4.0).abs() < 1e-14), "{mass:?}");
    // A tail without a volume: all nodes are equal.
    let tail = "nodes = [[0, 0], [1, 0], [0, 1], [2, 0]]\nelements = [[0, 1, 2], [1, 3]]\n";
    assert_eq!(masses(&format!("{tail}mass_total = 2"), Dimension::Plane), [0.5; 4]);
    assert_eq!(
        masses("bars = { count = 4, length = 1, direction = [1, 0] }\nmass_total = 2", Dimension::Plane),
        [0.4; 5]
    );
}

#[test]
fn masses_that_cannot_be() {
    let wrong = |body: &str, expected: &str| {
        super::expect(&bad(&format!("{WORLD}[body]\n{body}")), WORLD.lines().count() + 1, expected);
    };
    wrong(
        "bars = { count = 4, length = 1, direction = [1, 0, 0] }\ndensity = 1",
        "2:1 `body.density` is a mass per volume, but no element of the body has a volume give `mass_total`",
    );
    wrong("bars = { count = 4, length = 1, direction = [1, 0] }\ndensity = 1", "2:1 per area, but no element");
    wrong(
        "nodes = [[0, 0], [1, 0], [0, 1], [2, 0]]\nelements = [[0, 1, 2], [1, 3]]\ndensity = 1",
        "3:1 `body.density` is a mass per area, but node 3 belongs to no element with an area",
    );
    wrong("nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nelements = [[0, 1, 2]]\ndensity = 1", "3:1 no element");
    wrong("fan = { sides = 6, radius = 1 }\ndensity = 0", "2:11 `body.density` is 0; expected a number greater than 0");
    wrong(
        "fan = { sides = 6, radius = 1 }\nmass_total = -1",
        "2:14 `body.mass_total` is -1; expected a number greater",
    );
    wrong("fan = { sides = 6, radius = 1e20 }\ndensity = 1e20", "2:11 `body.density` gives node 0 a mass of 8.66");
    wrong("fan = { sides = 6, radius = 1e-290 }\ndensity = 1", "2:1 no element of the body has an area");
    for (one, two) in [
        ("mass = 1", "density = 1"),
        ("mass = 1", "mass_total = 1"),
        ("masses = [1, 1, 1]", "density = 1"),
        ("masses = [1, 1, 1]", "mass_total = 1"),
        ("density = 1", "mass_total = 1"),
    ] {
        let [first, second] = [one, two].map(|typed| typed.split(' ').next().unwrap());
        wrong(
            &format!("nodes = [[0, 0], [1, 0], [0, 1]]\nelements = [[0, 1, 2]]\n{one}\n{two}"),
            &format!("4:1 `body` has both `{first}` and `{second}`, which exclude each other keep one"),
        );
    }
}
