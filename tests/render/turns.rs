//! One renderer draws pictures of every kind in turn: each has the bytes that it has alone.

use super::listed::{Listed, line};
use super::{compose, draw, frame, gpu, parse, renderer};
use localshape::runner::Frame;

const SIZE: [u32; 2] = [160, 100];
const CUBES: &str = "body = { lattice = { cells = [2, 2, 2], side = 0.2 }, lowest = 0.1 }";
const SQUARES: &str = "body = { lattice = { cells = [2, 2], side = 0.2 }, lowest = 0.1 }";
const FLOOR: &str = "[[obstacle]]\nkind = 'floor'";
const BALL: &str = "[[obstacle]]\nkind = 'sphere'\ncentre = [0.4, 0.2, 0.1]\nradius = 0.15";
const DISC: &str = "[[obstacle]]\nkind = 'sphere'\ncentre = [0.4, 0.2]\nradius = 0.15";
const PLATE: &str = "[[obstacle]]\nkind = 'plate'\npoint = [0, 0.3, 0.25]\nnormal = [0, 0, -1]";
const SPEED: &str = "colour = { by = 'speed', range = [0, 3] }";

fn over(frame: &mut Frame) {
    frame.runs[0].snapshot.turned_over[0] = true;
}

fn flat(frame: &mut Frame) {
    frame.runs[0].snapshot.flat[2] = true;
}

fn none(_: &mut Frame) {}

/// The parts of a scene, keys of its view, and a change of its frame.
type Case<'a> = (&'a [&'a str], &'a str, fn(&mut Frame));

/// Pictures of two sizes of the body, so that textures are replaced. No picture equals another one.
fn pictures() -> Vec<Listed> {
    let lines = "show = ['springs', 'nodes'], colour = { by = 'strain', range = [0, 0.1] }";
    let cases: [Case<'_>; 11] = [
        (&[CUBES, FLOOR], "", none),
        (&[CUBES, FLOOR], "", over),
        (&[CUBES, FLOOR], "", flat),
        (&[CUBES, FLOOR], SPEED, none),
        (&[CUBES, FLOOR], SPEED, over),
        (&[CUBES, FLOOR], lines, over),
        (&[CUBES, FLOOR], "show = ['surfaces', 'springs', 'nodes']", none),
        (&[CUBES, FLOOR, BALL], "", none),
        (&[CUBES, FLOOR, PLATE], "", over),
        (&[CUBES, FLOOR, BALL, PLATE], SPEED, none),
        (&[SQUARES, DISC], "", over),
    ];
    let mut pictures = Vec::new();
    for (case, (world, view, change)) in cases.into_iter().enumerate() {
        let mut scene = parse(&format!(
            "time = {{ duration = 1, step = 'T/50', frames_per_second = 50 }}
            run = [{{ name = 'one', model = {{ kind = 'mass-spring', stiffness = 1e3, springs = 'all' }} }}]
            view = {{ size = {SIZE:?}, {view} }}\n{}",
            world.join("\n")
        ));
        scene.view.camera.follow = false;
        let mut frame = frame(&scene, 0);
        change(&mut frame);
        let snapshot = &mut frame.runs[0].snapshot;
        let values = if view == SPEED { snapshot.position.len() } else { scene.bodies[0].body.elements().len() };
        snapshot.field = (0..values).map(|at| 0.1 * at as f64).collect();
        for near in [1.0, 0.5] {
            scene.view.camera.distance *= near;
            let mut picture = compose(&scene, &frame);
            if case % 3 == 0 {
                let points = [[10.0, 10.0 + 30.0 * near as f32], [90.0, 80.0 - case as f32]];
                picture.above.push(line(&points, 3.0, &[], ([200, 0, 90], 0.7)));
            }
            pictures.push(picture);
        }
    }
    pictures
}

#[test]
fn every_picture_has_the_same_bytes_alone_and_after_any_other() {
    let Some(gpu) = gpu("every_picture_has_the_same_bytes_alone_and_after_any_other") else { return };
    let pictures = pictures();
    let alone: Vec<_> = pictures.iter().map(|picture| draw(gpu, picture)).collect();
    for (at, image) in alone.iter().enumerate() {
        assert!(alone[..at].iter().all(|other| other != image), "picture {at} is like another");
    }
    let mut renderer = renderer(gpu, SIZE);
    let mut before = 0;
    // Each picture follows each other one once.
    for next in (0..pictures.len()).flat_map(|one| (0..one).flat_map(move |other| [other, one])) {
        let image = renderer.draw(&pictures[next]).expect("the device works");
        assert!(image == alone[next], "picture {next} after {before}");
        before = next;
    }
}
