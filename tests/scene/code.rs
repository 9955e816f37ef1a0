//! Scenes made in code, as the author of another crate would make them.

use localshape::glam::DVec3;
use localshape::look::View;
use localshape::scene::{Limits, Run, Scene};

fn parse(text: &str) -> Scene {
    Scene::parse(text, "scene.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A body that is made in code, its obstacles and runs put beside it afterwards, is looked at as the same one in a file:
/// nobody has to work out a camera, whatever the body's size and wherever it starts.
#[test]
fn a_body_made_in_code_is_looked_at_as_one_in_a_file() {
    let run = "[[run]]\nname = 'One'\nmodel = { kind = 'shape-based', stiffness = 1.0 }\n";
    let space = "nodes = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [0, 0, 1e3]]\nelements = [[0, 1, 2, 3]]";
    let plane = "nodes = [[5, 5], [5.01, 5], [5, 5.01]]\nelements = [[0, 1, 2]]";
    let ball = "[[obstacle]]\nkind = 'sphere'\ncentre = [1.5e3, 0, 0]\nradius = 300.0\nrestitution = 0\nfriction = 0\n";
    for (body, more) in [(space, ""), (plane, ""), (space, ball)] {
        let file = parse(&format!("time.duration = 1\n[body]\n{body}\n{run}{more}"));
        let mut scene = Scene::new("scene", (*file.body).clone(), file.runs.clone());
        if !more.is_empty() {
            scene.obstacles = file.obstacles.clone();
            assert_ne!(scene.view, file.view, "the ball would be cut");
            scene = scene.framed();
        }
        assert_eq!(scene.view, file.view, "{body}");
        assert_eq!((scene.title.as_str(), scene.last_frame()), ("scene", 60));
        assert_eq!((&scene.initial, scene.gravity), (&file.initial, DVec3::ZERO));
        assert_ne!(scene.view.camera, View::default().camera);
    }
}

/// Runs that are put beside others have colours and dashes of their own, as in a file.
#[test]
fn runs_made_in_code_are_told_apart() {
    let run = "[[run]]\nname = 'One'\nmodel = { kind = 'shape-based', stiffness = 1.0 }\n";
    let file = parse(&format!("time.duration = 1\nbody.lattice = {{ cells = [1, 1, 1], side = 1 }}\n{run}"));
    let one = || Run::new("One", file.runs[0].model.clone(), file.runs[0].integrator, 1e-3);
    let mut scene = Scene::new("scene", (*file.body).clone(), vec![one()]);
    scene.runs.extend([one(), one()]);
    scene.runs[1].colour = Some([0, 128, 128]);
    scene = scene.framed();
    let lines: Vec<_> = scene.runs.iter().map(|run| run.line(&scene.view.look.palette)).collect();
    for (at, line) in lines.iter().enumerate() {
        assert!(lines[..at].iter().all(|other| other.colour != line.colour && other.dash != line.dash), "{lines:?}");
    }
}
