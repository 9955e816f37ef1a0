//! No flicker: if everything moves by a twentieth of a pixel per frame, no pixel jumps, and none oscillates.

use super::{all, gpu, linear, parse, renderer, unknown};
use image::RgbImage;
use localshape::gpu::Gpu;
use localshape::render::Renderer;
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use localshape::sim::Dimension;

/// Frames of a film in which the fastest point moves by one pixel, and so through all positions in a pixel.
const FRAMES: u64 = 21;
/// Motion between two frames (px).
const SLOW: f64 = 0.05;

/// Changes of the worst pixels of a film, relative to the step from black to white, in linear light. The visibility of
/// lines is tested at four places, so a place that changes sides is a quarter at most.
#[derive(Debug, Default)]
struct Unrest {
    /// The largest change from one frame to the next.
    jump: f64,
    /// The largest oscillation. A pixel's series has a swing from each turning point to the next; a thin passing object
    /// causes two large ones. So this is the third largest swing, at the pixel where it is largest.
    fro: f64,
}

/// The bounds. A place that changes sides on a white background is .24, and the end of a line there adds to it; if
/// elements are a few pixels large, two places may change at once. Oscillations are smaller than one change: a fixed
/// edge moves within the 1/256 px to which corners are rounded.
const MOST: Unrest = Unrest { jump: 0.30, fro: 0.24 };

fn unrest(film: &[RgbImage]) -> Unrest {
    let light: [f64; 256] = std::array::from_fn(|byte| linear(byte as u8));
    let mut worst = Unrest::default();
    let film: Vec<&[u8]> = film.iter().map(|image| &image.as_raw()[..]).collect();
    for at in 0..film[0].len() {
        // Most of a picture does not move.
        if film.iter().all(|image| image[at] == film[0][at]) {
            continue;
        }
        let mut swings = vec![0.0_f64];
        for two in film.windows(2) {
            let step = light[usize::from(two[1][at])] - light[usize::from(two[0][at])];
            worst.jump = worst.jump.max(step.abs());
            match swings.last_mut() {
                Some(swing) if *swing * step >= 0.0 => *swing += step,
                _ => swings.push(step),
            }
        }
        swings.sort_by(|one, other| other.abs().total_cmp(&one.abs()));
        worst.fro = worst.fro.max(swings.get(2).map_or(0.0, |swing| swing.abs()));
    }
    worst
}

/// Frames between two others, a small fraction of the motion apart. Turned-over elements stay turned over.
fn between([from, to]: [&Frame; 2], part: f64) -> Vec<Frame> {
    (0..FRAMES)
        .map(|at| {
            let share = at as f64 * part;
            let mut frame = from.clone();
            for (run, (from, to)) in frame.runs.iter_mut().zip(from.runs.iter().zip(&to.runs)) {
                let (from, to) = (&from.snapshot, &to.snapshot);
                let now = &mut run.snapshot;
                now.time = from.time + share * (to.time - from.time);
                let ends = from.position.iter().zip(&to.position);
                now.position = ends.map(|(a, &b)| a.lerp(b, share)).collect();
                now.placements[0].centre = from.placements[0].centre.lerp(to.placements[0].centre, share);
                let fields = from.field.iter().zip(&to.field);
                now.field = fields.map(|(a, b)| a + share * (b - a)).collect();
            }
            frame
        })
        .collect()
}

/// Draws frames without text, which contains changing numbers, and without keys, whose bars tell whether values lie beyond
/// them.
struct Camera(Renderer);

impl Camera {
    fn new(gpu: &Gpu, scene: &Scene) -> Self {
        Self(renderer(gpu, scene.view.size))
    }

    fn shot(&mut self, scene: &Scene, frame: &Frame) -> RgbImage {
        let mut scene = scene.clone();
        scene.view.labels.legend = false;
        let mut picture = unknown(&scene).compose(frame);
        picture.mute();
        self.0.draw(&picture).expect("the device works")
    }
}

fn film(gpu: &Gpu, scene: &Scene, frames: &[Frame]) -> Vec<RgbImage> {
    let mut camera = Camera::new(gpu, scene);
    frames.iter().map(|frame| camera.shot(scene, frame)).collect()
}

/// A film of one frame around which the camera turns, with no pixel in its panel faster than a twentieth per frame.
fn around(gpu: &Gpu, scene: &mut Scene, frame: &Frame) -> Vec<RgbImage> {
    let width = f64::from(scene.view.size[0]) / frame.runs.len() as f64;
    let mut camera = Camera::new(gpu, scene);
    let mut shot = |_| {
        scene.view.camera.azimuth += 2.0 * SLOW / width;
        camera.shot(scene, frame)
    };
    (0..FRAMES).map(&mut shot).collect()
}

/// The greatest motion of a node between two frames (px).
fn way(scene: &Scene, from: &Frame, to: &Frame) -> f64 {
    let pixels = f64::from(unknown(scene).compose(from).panels[0].sight.element) / scene.view.side;
    let nodes = |frame: &Frame| frame.runs.iter().flat_map(|run| run.snapshot.position.clone()).collect::<Vec<_>>();
    nodes(from).iter().zip(nodes(to)).map(|(one, other)| one.distance(other)).fold(0.0, f64::max) * pixels
}

fn assert_steady(name: &str, film: &[RgbImage]) {
    let unrest = unrest(film);
    assert!(film[0] != film[film.len() - 1], "{name}: nothing moves");
    assert!(unrest.jump <= MOST.jump && unrest.fro <= MOST.fro, "{name}: {unrest:?}");
}

#[test]
fn nothing_flickers_in_slow_motion() {
    let Some(gpu) = gpu("nothing_flickers_in_slow_motion") else { return };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for (file, index) in [
        ("scenes/fig4a.toml", 60),
        ("scenes/fig4b.toml", 30),
        ("scenes/fig4b.toml", 45),
        ("tests/golden/primitives/arrows.toml", 1),
        ("tests/golden/primitives/cubes.toml", 3),
        ("tests/golden/primitives/field.toml", 3),
        ("tests/golden/primitives/obstacles.toml", 3),
        ("tests/golden/primitives/obstacles-plane.toml", 3),
        ("tests/golden/primitives/plane.toml", 1),
        ("tests/golden/primitives/spring-strain.toml", 3),
    ] {
        let mut scene = Scene::load(&root.join(file), &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        if scene.view.size[0] > 400 {
            scene.view.size = [320, 180];
        }
        scene.view.charts.clear();
        // The whole motion is in the picture.
        scene.view.camera.follow = false;
        let mut runner = Runner::new(&scene, &all(&scene));
        let [from, to] = [index, index + 1].map(|index| runner.frame(index));
        if file.starts_with("scenes") {
            scene.view.camera.target = from.runs[0].snapshot.placements[0].centre;
        }
        // Obstacles move at most two pixels from one frame of these scenes to the next.
        let part = SLOW / way(&scene, &from, &to).max(2.0);
        assert_steady(&format!("{file} {index}"), &film(gpu, &scene, &between([&from, &to], part)));
        if scene.bodies[0].body.dimension() == Dimension::Space {
            assert_steady(&format!("around {file} {index}"), &around(gpu, &mut scene, &from));
        }
    }
}

/// Two cubes pressed into a plane whose coordinates are not round numbers, slowly rotating.
const PRESSED: &str = "
    gravity = [0, 0, 0]
    time = { duration = 2, step = 0.0166666666667, frames_per_second = 60 }
    run = [{ name = 'one', model = { kind = 'mass-spring', stiffness = 1e-9, springs = 'edges+one-diagonal' } }]
    [body]
    nodes = [
        [0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [0, 0.1, 0], [0.1, 0.1, 0], [0.2, 0.1, 0],
        [0, 0, 0.1], [0.1, 0, 0.1], [0.2, 0, 0.1], [0, 0.1, 0.1], [0.1, 0.1, 0.1], [0.2, 0.1, 0.1],
    ]
    elements = [[0, 1, 3, 4, 6, 7, 9, 10], [1, 2, 4, 5, 7, 8, 10, 11]]
    positions = [
        [-0.1, 0.07, 0], [0, 0.1, 0], [0.1, 0.13, 0], [-0.1, 0.07, 0], [0, 0.1, 0], [0.1, 0.13, 0],
        [-0.1, 0.09, 0.1], [0, 0.12, 0.1], [0.1, 0.15, 0.1], [-0.1, 0.09, 0.1], [0, 0.12, 0.1], [0.1, 0.15, 0.1],
    ]
    spin = { axis = [1, 3, 1.5], rate = 0.045 }
    [view]
    size = [160, 120]
    camera = { target = [0, 0.1, 0.05], distance = 0.6 }
";

#[test]
fn what_is_pressed_flat_does_not_flicker() {
    let Some(gpu) = gpu("what_is_pressed_flat_does_not_flicker") else { return };
    for show in ["", "show = ['surfaces', 'nodes', 'springs']", "colour = { by = 'speed' }"] {
        let scene = parse(&[PRESSED, show].concat());
        let mut runner = Runner::new(&scene, &[0]);
        let frames: Vec<_> = (0..FRAMES).map(|index| runner.frame(index)).collect();
        assert!(way(&scene, &frames[0], &frames[1]) <= SLOW);
        assert!(frames.iter().all(|frame| frame.runs[0].snapshot.diagnostics.turned_over == 0));
        assert_steady(&format!("pressed {show}"), &film(gpu, &scene, &frames));
    }
}

/// Two plates that cross, between which the camera moves from one side to the other.
const CROSSING: &str = "
    gravity = [0, 0, 0]
    time = { duration = 1, step = 0.01 }
    run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1 } }]
    body = { lattice = { cells = [1, 1, 1], side = 0.05 } }
    obstacle = [
        { kind = 'plate', point = [-0.1, 0, 0], normal = [1, 0, 0.2] },
        { kind = 'plate', point = [0, 0, -0.1], normal = [0.2, 0, 1] },
    ]
    view = { size = [160, 120], camera = { azimuth = 0.78, elevation = 0.4, target = [0, 0, 0], distance = 0.5 } }
";

#[test]
fn plates_that_cross_do_not_flicker() {
    let Some(gpu) = gpu("plates_that_cross_do_not_flicker") else { return };
    let mut scene = parse(CROSSING);
    let frame = Runner::new(&scene, &[0]).frame(0);
    assert_steady("crossing", &around(gpu, &mut scene, &frame));
}
