//! The digest depends only on the meaning of a scene.

use super::{WORLD, good, shipped};

#[test]
fn comments_layout_order_and_spelling_of_numbers_do_not_count() {
    let plain = good(&plain()).digest;
    assert_eq!(plain.len(), 64);
    let same = r#"
        view = { clock = "after first contact", camera = {}, size = [1_280, 0x2D0] }
        gravity = [0.0, -98e-1, 0]
        title = "3×3×3 cubes dropped on a floor"
        run = [
            { model = { stiffness = 10000, damping_ratio = 1e-1, kind = "shape-based" }, name = "Local shape" },
            { name = 'Mass-spring', model.kind = "mass-spring", model.stiffness = 10_000.0, model.damping_ratio = 0.10,
              model.springs = "edges+one-diagonal" },
        ]
        [[obstacle]]
        friction = 0.3
        friction_of = 'velocity'
        restitution = 0.5
        kind = "floor"
        [body]
        velocity = [0, -9.899495, 0]
        rotation = { angle = 0.028284, axis = [1.0, 0, 1] }
        mass = 1
        lowest = 0
        [body.lattice]
        side = 1e-1
        cells = [3, 3, 3]
        [time]
        frames_per_second = 6e1
        step = "T / 50.0"
        duration = 3
    "#;
    assert_eq!(good(same).digest, plain);
}

#[test]
fn a_default_may_be_typed_or_not() {
    let short = format!("{WORLD}[body]\nlattice = {{ cells = [1, 1, 1], side = 1 }}\n[[obstacle]]\nkind = 'floor'\n");
    let long = short.replace("duration = 1", "duration = 1\nstep = 'T/50'\nintegrator = 'semi-implicit-euler'")
        + "height = 0.0\nrestitution = -0.0\n[view]\nsize = [1280, 720]\ntheme = 'light'\n";
    assert_eq!(good(&short).digest, good(&long).digest);
    let rough = short + "friction = 0.5\n";
    assert_eq!(good(&rough).digest, good(&format!("{rough}friction_of = 'path'\n")).digest);
}

#[test]
fn whatever_changes_the_scene_changes_the_digest() {
    let scene = shipped("fig4b.toml");
    let mut digests = vec![good(&scene).digest];
    for (from, to) in [
        ("3×3×3 cubes", "Cubes"),
        ("-9.8,", "-9.81,"),
        ("3.0", "3.5"),
        ("T/50", "T/51"),
        ("cells = [3, 3, 3]", "cells = [3, 3, 4]"),
        ("angle = 0.028284", "angle = 0.0282840001"),
        ("mass = 1.0", "mass = 2.0"),
        ("damping_ratio = 0.1,", "damping_ratio = 0.2,"),
        ("damping_ratio = 0.1,", "damping = 0.1,"),
        ("damping_ratio = 0.1,", "damping_ratio = 0.1, passes = 3,"),
        ("one-diagonal", "face-diagonals"),
        ("friction = 0.3", "friction = 0.4"),
        ("friction = 0.3", "friction = 0.0"),
        ("\"velocity\"", "\"path\""),
        ("1280", "1281"),
        ("charts =", "camera.distance = 3\ncharts ="),
        ("\"Mass-spring\"", "\"mass-spring\""),
    ] {
        assert!(scene.contains(from), "{from}");
        digests.push(good(&scene.replacen(from, to, 1)).digest);
    }
    let all = digests.len();
    digests.sort();
    digests.dedup();
    assert_eq!(digests.len(), all);
}

/// The scene of Fig. 4(b) before views could have titles, letters and charts, and before the default solver changed.
fn plain() -> String {
    let text = shipped("fig4b.toml").replace(", rotation = \"arctangent\"", "");
    let (world, view) = text.split_once("[view]").expect("a view");
    let had = |line: &&str| !["size", "title", "labels", "charts"].iter().any(|key| line.starts_with(key));
    format!("{world}[view]\nsize = [1280, 720]{}\n", view.lines().filter(had).collect::<Vec<_>>().join("\n"))
}

/// Protects stored results: if this digest changes, all earlier frames count as those of another scene.
#[test]
fn the_digest_of_a_shipped_scene_stays() {
    assert_eq!(good(&plain()).digest, "1cc51747824f6dca33dd90fc360fd5fcc270e8e4ef93188d27b787211e0bf96b");
}

/// Lists are hashed in place, in the order of their keys among the others.
#[test]
fn the_digest_of_listed_nodes_stays() {
    let text = "
        title = 'scene'
        time.duration = 1
        body.nodes = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]
        body.elements = [[3, 2, 1, 0]]
        body.convex = true
        body.springs = [[0, 1], [1, 2]]
        body.faces = [[0, 1, 2]]
        body.masses = [1, 2, 3, 4]
        body.positions = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 0.1]]
        body.velocities = [[1, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, -0.0]]
        [[run]]
        name = 'One'
        model = { kind = 'shape-based', stiffness = 1.0 }
    ";
    assert_eq!(good(text).digest, "ecb913a14c89933dee410bd3912bfd8ddd2ebcbb6bed7724740e981b56f2d3ca");
}
