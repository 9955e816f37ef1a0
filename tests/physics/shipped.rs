//! The results of shipped and other scenes, as their comments describe them.

use super::support::{after, shipped};
use glam::DVec3;
use localshape::scene::{Limits, Scene};
use localshape::sim::{Integrator, State, Status};
use std::path::Path;

/// The shipped scene: with Eq. (16) as printed the body grows, with accumulated rotations it keeps its size.
#[test]
fn the_linear_update_swells_a_spinning_cube() {
    let scene = shipped("swelling", &[]);
    let volume = |run| after(&scene, run, 10.0).diagnostics.volume_ratio;
    let mended = volume("Rotations accumulated");
    assert!((0.99..1.06).contains(&mended), "{mended}");
    let printed = volume("Eq. (16) as printed");
    assert!(printed > 2.0, "{printed}");
}

/// The shipped scene: Eqs. (2) and (3) as printed diverge, and the other methods do not.
#[test]
fn explicit_euler_blows_up_a_spinning_block() {
    let scene = shipped("explicit-euler", &[]);
    assert!(matches!(after(&scene, "As printed", 2.0).status, Status::Diverged(_)));
    for run in ["Semi-implicit Euler", "Velocity Verlet"] {
        let end = after(&scene, run, 2.0);
        assert_eq!((end.status, end.diagnostics.turned_over), (Status::Ok, 0), "{run}");
    }
}

#[test]
fn a_bar_that_is_stretched_and_let_go_comes_back_with_the_shape_model() {
    let scene = shipped("stretch", &[]);
    let at = |run: &str, seconds| after(&scene, run, seconds);
    let right: Vec<usize> =
        (0..scene.bodies[0].body.len()).filter(|&node| scene.runs[0].initial.position[node].x > 0.29).collect();
    let (grabbed, pulled) = (at("Local shape", 0.499), at("Local shape", 1.5));
    for &node in &right {
        let way = pulled.position[node] - grabbed.position[node];
        // Between the last two steps before the grip the end still oscillates a little.
        assert!((way - DVec3::new(0.5, 0.2, 0.0)).length() < 2e-3, "{way}");
    }
    let end = at("Local shape", 4.0);
    assert_eq!(end.diagnostics.turned_over, 0);
    let held: Vec<usize> =
        (0..scene.bodies[0].body.len()).filter(|&node| scene.runs[0].initial.position[node].x < -0.29).collect();
    assert_eq!(held.len(), 9);
    for node in held {
        assert_eq!(end.position[node], scene.runs[0].initial.position[node]);
    }
}

/// A step and a damping ratio that are stable together stay stable if a node is ten thousand times lighter than the
/// others.
#[test]
fn the_default_step_serves_any_contrast_of_masses() {
    for lightest in ["1", "0.01", "0.0001"] {
        let text = format!(
            "[time]
            duration = 1
            frames_per_second = 100
            [body]
            nodes = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,1],[1,0,1],[0,1,1],[1,1,1]]
            elements = [[0,1,2,3,4,5,6,7]]
            masses = [{lightest},1,1,1,1,1,1,1]
            spin = {{ axis = [1, 2, 3], rate = 0.001 }}
            [[run]]
            name = 'a'
            model = {{ kind = 'shape-based', stiffness = 100.0, damping_ratio = 0.1 }}"
        );
        let scene = Scene::parse(&text, "contrast.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let mut world = scene.world(0);
        world.advance((1.0 / scene.runs[0].step) as u64);
        assert_eq!(world.status(), Status::Ok);
        let fastest = world.state().velocity.iter().map(|v| v.length()).fold(0.0, f64::max);
        assert!(fastest < 2e-3, "{lightest} kg: {fastest}");
    }
}

/// A block of three layers of nodes rests on a slope with `tan α < μ`. With the paper's rule it creeps by `3 g sin α ΔT`; by default, with
/// the friction of the path, it stays.
#[test]
fn friction_of_the_path_ends_creep() {
    let creep = |rule: &str, integrator: &str, e: f64| {
        let text = format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = 4, step = 0.001, integrator = '{integrator}' }}
            body = {{ lattice = {{ cells = [2, 2, 2], side = 0.1 }}, offset = [0, 0.03, 0], rotation = {{ axis = [0, 0, 1], angle = -0.1 }} }}
            run = [{{ name = 'a', model = {{ kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.3 }} }}]
            [[obstacle]]
            kind = 'floor'
            normal = [0.09983341664682815, 0.9950041652780258, 0]
            restitution = {e}
            friction = 1
            {rule}"
        );
        let scene = Scene::parse(&text, "slope", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let down = DVec3::new(0.9950041652780258, -0.09983341664682815, 0.0);
        let mut world = scene.world(0);
        let mut place = || {
            world.advance(1500);
            world.state().position.iter().map(|at| at.dot(down)).sum::<f64>() / world.state().position.len() as f64
        };
        place();
        let before = place();
        (place() - before) / 1.5
    };
    let paper = 3.0 * 9.8 * 0.09983341664682815 * 0.001;
    for (integrator, part) in [("semi-implicit-euler", 1.0), ("velocity-verlet", 0.5)] {
        let own = creep("friction_of = 'velocity'", integrator, 0.0) / paper;
        assert!((own / part - 1.0).abs() < 0.01, "{integrator}: {own}");
        // From about 0.4 on, semi-implicit Euler leaves nodes in the air for whole steps.
        let restitutions: &[f64] =
            if integrator == "velocity-verlet" { &[0.0, 0.3, 0.6, 0.8] } else { &[0.0, 0.2, 0.3] };
        for &e in restitutions {
            let [own, named] = ["", "friction_of = 'path'"].map(|rule| creep(rule, integrator, e));
            assert!(own.abs() < 1e-3 * paper && own.abs() < 1e-4, "{integrator}, e = {e}: {own} m/s");
            assert_eq!(own, named, "{integrator}, e = {e}");
        }
    }
}

#[test]
fn every_shipped_scene_goes_on_from_what_was_written_with_the_same_bits() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["scenes", "scenes/contact", "scenes/elements"];
    let files = folders.map(|folder| std::fs::read_dir(root.join(folder)).expect("scenes"));
    let paths = files.into_iter().flatten().map(|entry| entry.expect("an entry").path());
    let mut scenes = 0;
    for path in paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")) {
        let scene = Scene::load(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        scenes += 1;
        for run in 0..scene.runs.len() {
            // A step of backward Euler costs as much as many of the others.
            let most = if scene.runs[run].integrator == Integrator::BackwardEuler { 20 } else { 120 };
            let steps = scene.frame_step(run, scene.last_frame()).min(most);
            let mut whole = scene.world(run);
            whole.advance(steps);
            let mut cut = scene.world(run);
            for share in [0.31, 0.07, 0.8] {
                let left = steps - cut.steps();
                cut.advance((share * left as f64) as u64);
                let state = State::from_bytes(&cut.state().to_bytes()).expect("what was written");
                cut = scene.world(run);
                cut.set_state(state);
            }
            cut.advance(steps - cut.steps());
            assert!(cut.state().to_bytes() == whole.state().to_bytes(), "{} {}", path.display(), scene.runs[run].name);
            let [cut, whole] = [cut, whole].map(|world| format!("{:?}", world.snapshot()));
            assert!(cut == whole, "{}: diagnostics", path.display());
        }
    }
    assert!(scenes >= 25, "{scenes}");
}

/// Computed before the step, and after it from the rotations of the step: the same bits.
#[test]
fn alpha_follows_from_what_a_step_leaves_behind() {
    for rotation in ["arctangent", "robust", "vector-length", "linear-update"] {
        let text = format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = 1, step = 0.006 }}
            body = {{ lattice = {{ cells = [2, 1, 1], side = 0.1 }}, lowest = 0.1, rotation = {{ axis = [1, 2, 3], angle = 1 }} }}
            obstacle = [{{ kind = 'floor', restitution = 1, friction = 0 }}]
            run = [{{ name = 'one', kernel = 'reference', \
                      model = {{ kind = 'shape-based', stiffness = 1e4, rotation = '{rotation}' }} }}]"
        );
        let scene = Scene::parse(&text, "alpha", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let mut world = scene.world(0);
        let mut largest = 0.0f64;
        for _ in 0..100 {
            let asked = world.report(0).residual.expect("rotations");
            let before = world.state().position.clone();
            world.advance(1);
            let left = world.residuals(0, &before);
            assert_eq!(left.len(), 2);
            assert_eq!(left.into_iter().fold(0.0, f64::max).to_bits(), asked.to_bits(), "{rotation}");
            largest = largest.max(asked);
        }
        assert!(largest > 0.0, "{rotation}");
    }
}
