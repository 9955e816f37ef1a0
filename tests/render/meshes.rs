//! Runs with bodies of their own, tested by the numbers in their pictures. No device is needed.

use super::listed::{Composer, Listed};
use super::{all, compose, frame, parse};
use localshape::picture::Panel;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::{Limits, Scene};

/// A scene of two cubes of 2 × 2 × 2 and 4 × 4 × 4 cells, before a fixed camera, with some runs and more keys of the view.
fn scene(runs: &str, view: &str) -> String {
    let bodies = [("coarse", 2, 0.1), ("fine", 4, 0.05)].map(|(name, cells, side)| {
        format!("[[body]]\nname = '{name}'\nlattice = {{ cells = [{cells}, {cells}, {cells}], side = {side} }}\n")
    });
    let model = "model = { kind = 'shape-based', stiffness = 1e4 }";
    let runs = runs.split_whitespace().map(|body| format!("[[run]]\nname = '{body}'\nbodies = ['{body}']\n{model}\n"));
    format!(
        "time = {{ duration = 0.1, frames_per_second = 20, step = 0.001 }}\n{}{}[view]\nfloor = 'none'\nshadow = false\n\
         camera = {{ target = [0.1, 0.1, 0.1], distance = 2 }}\n{view}",
        bodies.concat(),
        runs.collect::<String>()
    )
}

/// The panel of a run without what depends on the scene's unit of length and on the place in the picture: its triangles, its lines
/// and its nodes (m), and the size of its elements (px).
fn seen(panel: &Panel, side: f64) -> (Vec<[f32; 3]>, [usize; 4], f32) {
    let metres = |at: [f32; 3]| at.map(|length| length * side as f32);
    let points = panel.sound.vertices.iter().map(|vertex| metres(vertex.position)).collect();
    let counts = [panel.sound.triangles.len(), panel.lines.len(), panel.borders.len(), panel.strokes.len()];
    (points, counts, panel.sight.element)
}

#[test]
fn each_panel_shows_the_mesh_of_its_run_as_alone() {
    let both = parse(&scene("coarse fine", ""));
    let together = compose(&both, &frame(&both, 0));
    let alone = |run: usize| -> (Scene, Listed) {
        let scene = both.clone();
        let picture = Composer::new(&scene, &History::default()).compose(&Runner::new(&scene, &[run]).frame(0));
        (scene.clone(), picture)
    };
    for run in 0..2 {
        let (scene, picture) = alone(run);
        let [one, other] = [&picture.panels[0], &together.panels[run]].map(|panel| seen(panel, scene.view.side));
        assert_eq!((one.0.len(), one.1), (other.0.len(), other.1));
        let apart = one.0.iter().zip(&other.0).flat_map(|(a, b)| [0, 1, 2].map(|axis| (a[axis] - b[axis]).abs()));
        assert!(apart.fold(0.0, f32::max) < 1e-6);
    }
    let faces = [2, 4].map(|cells| 6 * cells * cells * 2);
    let triangles: Vec<_> = together.panels.iter().map(|panel| panel.sound.triangles.len()).collect();
    assert_eq!(triangles, faces);
    let elements: Vec<_> = together.panels.iter().map(|panel| panel.sight.element).collect();
    assert!((elements[0] / elements[1] - 2.0).abs() < 1e-4, "{elements:?}");
    let words: Vec<_> = together.words.iter().map(|word| &*word.text).collect();
    assert!(words.contains(&"0 of 8") && words.contains(&"0 of 64"), "{words:?}");
}

#[test]
fn nodes_of_different_bodies_are_not_compared() {
    let told = |view: &str| {
        let read = Scene::parse(&scene("coarse fine", view), "meshes.toml", &Limits::default());
        read.expect_err("different bodies").to_string()
    };
    for view in ["ghost = 'coarse'", "colour = { by = 'distance', to = 'coarse' }"] {
        let told = told(view);
        let message = "\"coarse\" and \"fine\" have different bodies, so their nodes cannot be compared";
        assert!(told.contains(message), "{told}");
    }
    let told = told("paths = [30]");
    assert!(told.contains("there is no node 30; the run \"coarse\" has nodes 0 to 26"), "{told}");
    // Nodes that all runs have leave paths.
    parse(&scene("coarse fine", "paths = ['centre', 26]"));
}

#[test]
fn cameras_frame_bodies_that_fly_apart() {
    for velocity in ["[4, 0, 0]", "[0, 4, 0]", "[0, 0, 4]", "[2, 1, -3]"] {
        let text = format!(
            "time = {{ duration = 1, frames_per_second = 10, step = 0.002 }}
            [[body]]
            name = 'stays'
            lattice = {{ cells = [2, 2, 2], side = 0.1 }}
            [[body]]
            name = 'goes'
            lattice = {{ cells = [3, 3, 3], side = 0.05 }}
            offset = [0.3, 0, 0]
            velocity = {velocity}
            [[run]]
            name = 'both'
            model = {{ kind = 'shape-based', stiffness = 1e4 }}
            [[run]]
            name = 'one'
            bodies = ['stays']
            model = {{ kind = 'mass-spring', stiffness = 1e4 }}"
        );
        let scene = parse(&text);
        let composer = Composer::new(&scene, &History::new(&scene, &all(&scene)));
        let mut runner = Runner::new(&scene, &all(&scene));
        for index in 0..=scene.last_frame() {
            for panel in &composer.compose(&runner.frame(index)).panels {
                for vertex in &panel.sound.vertices {
                    let at = panel.sight.clip * glam::Vec3::from(vertex.position).extend(1.0);
                    let is_inside = at.w > panel.sight.near && at.x.abs() < at.w && at.y.abs() < at.w;
                    assert!(is_inside, "{velocity}, frame {index}: {at}");
                }
            }
        }
    }
}
