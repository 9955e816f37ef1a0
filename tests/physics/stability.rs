//! Predictions against known values, and against runs just below and just above them.

use glam::DVec3;
use localshape::scene::{Limits, Scene};
use localshape::sim::stability::{Restraint, Stability};
use localshape::sim::{Dimension, State, Stepping, Surroundings, World};

fn scene(text: &str) -> Scene {
    let text = format!("time.duration = 1\n{text}");
    Scene::parse(&text, "stability", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn predicted(scene: &Scene) -> Stability {
    scene.stability(0).0
}

/// `ω_max/ω` of the free lattice of 3×3×3 cubes from dense matrices of an independent program, and the bounds for
/// stretched springs.
#[test]
fn eigenvalues_of_the_lattice() {
    let of = |model: &str| {
        let lattice = "body = { lattice = { cells = [3, 3, 3], side = 0.1 } }";
        let Stability { largest, stretched } =
            predicted(&scene(&format!("{lattice}\nrun = [{{ name = 'a', model = {{ stiffness = 1e4, {model} }} }}]")));
        let ratio = |step: f64| 2.0 / step / 100.0;
        (ratio(largest), stretched.map(ratio))
    };
    let (shape, none) = of("kind = 'shape-based'");
    assert!((shape / 2.7585 - 1.0).abs() < 1e-4 && none.is_none(), "{shape}");
    for (springs, at_rest, stretched) in [
        ("edges", 1.848, 3.2004),
        ("edges+face-diagonals", 3.099, 4.5484),
        ("edges+body-diagonals", 2.686, 4.5291),
        ("edges+one-diagonal", 3.087, f64::NAN),
        ("all", 3.6795, 5.3365),
    ] {
        let (own, bound) = of(&format!("kind = 'mass-spring', springs = '{springs}'"));
        assert!((own / at_rest - 1.0).abs() < 3e-4, "{springs}: {own} {at_rest}");
        let bound = bound.expect("springs can be stretched");
        assert!(stretched.is_nan() || (bound / stretched - 1.0).abs() < 1e-4, "{springs}: {bound} {stretched}");
        // With edges alone it is √3 exactly.
        assert!(own < bound && bound < own * 3.0_f64.sqrt() * 1.0001, "{springs}: {own} {bound}");
    }
}

/// Whether small displacements of all nodes stay small for a number of steps (s).
fn stays(scene: &Scene, step: f64, steps: u64) -> bool {
    let run = &scene.runs[0];
    let small = 1e-9 * scene.bodies[0].body.extent();
    let mut seed = 5_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let across = if scene.bodies[0].body.dimension() == Dimension::Plane { 0.0 } else { small };
    let mut shaken = |rest: &DVec3| *rest + DVec3::new(small * noise(), small * noise(), across * noise());
    let position = scene.bodies[0].body.rest().iter().map(&mut shaken).collect();
    let surroundings = Surroundings { grips: scene.runs[0].grips.clone(), ..Surroundings::default() };
    let stepping = Stepping { kernel: run.kernel, ..Stepping::new(run.integrator, step) };
    let mut world =
        World::new(&scene.bodies[0].body, State::at_rest(position), run.models[0].as_ref(), surroundings, stepping);
    let away = |world: &World| {
        let position = &world.state().position;
        position.iter().zip(scene.bodies[0].body.rest()).map(|(at, rest)| at.distance(*rest)).fold(0.0, f64::max)
    };
    for _ in 0..100 {
        world.advance(steps.div_ceil(100));
        let away = away(&world);
        if away.is_nan() || away > 100.0 * small {
            return false;
        }
    }
    true
}

const CUBES: &str = "body = { lattice = { cells = [2, 2, 1], side = 0.1 } }";
const MASSES: &str = "body = { nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], \
    elements = [[0, 1, 2, 3], [1, 2, 3, 4]], masses = [1, 0.01, 3, 1000, 0.2] }";
const PLANE: &str = "body = { nodes = [[0, 0], [1, 0], [1.3, 0.9], [0.5, 1.6], [-0.3, 0.9]], elements = [[0, 1, 2, 3], [0, 3, 4], [0, 1]] }";
const HELD: &str = "body = { lattice = { cells = [3, 1, 1], side = 0.1 } }\nhold = [{ nodes = [0, 4, 8, 12] }]";

/// 1 % below the limit a run stays in place, 1 % above it departs.
#[test]
fn runs_stay_just_below_and_depart_just_above() {
    let shape = "kind = 'shape-based', stiffness = 100";
    let springs = "kind = 'mass-spring', springs = 'all', stiffness = 100";
    let undamped = ["semi-implicit-euler", "velocity-verlet", "pefrl", "runge-kutta"].map(|one| (one, ""));
    let damped = [
        ("semi-implicit-euler", ", damping_ratio = 0.2"),
        ("semi-implicit-euler", ", damping_ratio = 1.5"),
        ("velocity-verlet", ", damping_ratio = 0.2"),
        ("velocity-verlet", ", damping_ratio = 1.5"),
        ("runge-kutta", ", damping_ratio = 0.2"),
        ("runge-kutta", ", damping_ratio = 1.5"),
        ("explicit-euler", ", damping_ratio = 0.4"),
    ];
    let mut wrong = Vec::new();
    for body in [CUBES, MASSES, PLANE, HELD] {
        for (integrator, damping) in undamped.into_iter().chain(damped) {
            for model in [shape, springs] {
                let text = format!(
                    "{body}\nrun = [{{ name = 'a', integrator = '{integrator}', model = {{ {model}{damping} }} }}]"
                );
                let scene = scene(&text);
                let Stability { largest, .. } = predicted(&scene);
                // If damping has modes of its own, the limit is a lower bound.
                let is_exact = damping.is_empty() || model == springs || integrator == "semi-implicit-euler";
                for (share, stable) in [(0.99, true), (if is_exact { 1.01 } else { 1.12 }, false)] {
                    if stays(&scene, share * largest, 4000) != stable {
                        wrong.push(format!("{integrator} {model}{damping} {body}: {share} × {largest}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn implicit_and_adaptive_methods_have_no_limit_and_explicit_euler_has_no_stable_step() {
    for (integrator, limit) in
        [("backward-euler", f64::INFINITY), ("dormand-prince", f64::INFINITY), ("explicit-euler", 0.0)]
    {
        let model = "model = { kind = 'shape-based', stiffness = 100 }";
        let scene = scene(&format!("{CUBES}\nrun = [{{ name = 'a', integrator = '{integrator}', {model} }}]"));
        assert_eq!(predicted(&scene), Stability { largest: limit, stretched: None });
    }
}

/// The bound without eigenvalues does not exceed the limit.
#[test]
fn certain_steps_are_stable() {
    for (body, damping) in [CUBES, MASSES, PLANE].into_iter().flat_map(|body| [0.0, 0.3].map(|damping| (body, damping)))
    {
        for integrator in ["semi-implicit-euler", "velocity-verlet", "runge-kutta"] {
            for kind in ["shape-based", "mass-spring"] {
                let model = format!("model = {{ kind = '{kind}', stiffness = 100, damping_ratio = {damping} }}");
                let scene = scene(&format!("{body}\nrun = [{{ name = 'a', integrator = '{integrator}', {model} }}]"));
                let Stability { largest, stretched } = predicted(&scene);
                let run = &scene.runs[0];
                let certain = Stability::certain(&scene.bodies[0].body, run.models[0].as_ref(), run.integrator, 0.0)
                    .expect("both models know");
                assert!(certain > 0.0 && certain <= stretched.unwrap_or(largest) * 1.0001, "{certain} {largest}");
            }
        }
    }
}

/// What is told without exact eigenvalues holds, and is told of steps far below the limit.
#[test]
fn steps_that_are_roughly_below_the_limit_are() {
    for model in [
        "kind = 'shape-based', stiffness = 100",
        "kind = 'shape-based', young = 100, poisson = 0.4",
        "kind = 'mass-spring', stiffness = 100",
        "kind = 'limited-springs', stiffness = 100, limit = 0.2",
        "kind = 'volume-springs', stiffness = 100, bulk = 1000",
        "kind = 'linear', young = 100, poisson = 0.3",
        "kind = 'corotational', young = 100, poisson = 0.45",
        "kind = 'neo-hookean', young = 100, poisson = 0.49",
        "kind = 'metric', young = 100",
    ] {
        for (body, damping) in [CUBES, MASSES, HELD].into_iter().flat_map(|body| [0.0, 0.3].map(|ratio| (body, ratio)))
        {
            // A metric is measured on lattices.
            if model.contains("metric") && body != CUBES {
                continue;
            }
            let scene =
                scene(&format!("{body}\nrun = [{{ name = 'a', model = {{ {model}, damping_ratio = {damping} }} }}]"));
            let Stability { largest, .. } = predicted(&scene);
            let run = &scene.runs[0];
            let is_below = |share: f64| {
                let restraint = Restraint { grips: &run.grips, duration: scene.duration, mass_damping: 0.0 };
                Stability::is_below(&run.bodies, &run.models, run.integrator, restraint, share * largest)
            };
            assert_eq!([is_below(0.25), is_below(1.001)], [true, false], "{model} {damping} {body}");
        }
    }
}
