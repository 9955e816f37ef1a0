//! Antialiased borders without flicker: a slight motion changes pixels slightly.

use super::listed::Listed;
use super::{all, compose, draw, fig4b, gpu, linear, parse, renderer, unknown};
use glam::Vec2;
use image::RgbImage;
use localshape::picture::{Item, Path};
use localshape::picture::{LineKind, Second, Stroke};
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::scene::Scene;
use std::collections::HashMap;

const WORLD: &str = "
    gravity = [0, 0, 0]
    time = { duration = 2, step = 0.0166666666667, frames_per_second = 60 }
";
const SPRINGS: &str = "
    run = [{ name = 'one', model = { kind = 'mass-spring', stiffness = 1e-9, springs = 'edges+one-diagonal' } }]
";
/// Rotates by half a pixel per frame at the farthest node.
const TURNING: &str = "spin = { axis = [1, 3, 1.5], rate = 0.06 }\n";
const PLANE: &str = "
    gravity = [0, 0]
    time = { duration = 1, step = 0.01 }
    body = { polygon = { sides = 5, radius = 0.02 }, offset = [3, 0] }
    run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1 } }]
    view = { camera = { target = [0, 0], distance = 4 }, size = [320, 180] }
";

fn scene(parts: &[&str]) -> Scene {
    let text = parts.concat();
    parse(&text)
}

fn frames(scene: &Scene, indices: std::ops::Range<u64>) -> Vec<Frame> {
    let mut runner = Runner::new(scene, &all(scene));
    indices.map(|index| runner.frame(index)).collect()
}

/// A picture of the plane without marks and text.
fn empty_plane(obstacle: &str) -> Listed {
    let scene = scene(&[PLANE, obstacle]);
    let mut picture = compose(&scene, &frames(&scene, 0..1)[0]);
    picture.above.clear();
    picture
}

/// Along a slightly inclined border, a row of pixels changes from the background to its darkest pixel in many even
/// steps.
fn assert_smooth(image: &RgbImage, x: std::ops::Range<u32>, y: u32, name: &str) {
    let mut row: Vec<u8> = x.map(|x| image.get_pixel(x, y)[1]).collect();
    if row.first() < row.last() {
        row.reverse();
    }
    let darkest = row.iter().enumerate().min_by_key(|(_, value)| **value).map_or(0, |(at, _)| at);
    row.truncate(darkest + 1);
    assert!(row.windows(2).all(|two| two[0] >= two[1]), "{name}: {row:?}");
    row.dedup();
    // Both sides and the values between them.
    assert!(row.len() >= 7, "{name}: {row:?}");
}

/// The row in the middle of a border that a column crosses once.
fn crossing(image: &RgbImage, x: u32, y: std::ops::Range<u32>) -> u32 {
    let at = |y: u32| i32::from(image.get_pixel(x, y)[1]);
    let middle = (at(y.start) + at(y.end)) / 2;
    let above = at(y.start) > middle;
    y.into_iter().find(|&y| (at(y) > middle) != above).expect("a border")
}

#[test]
fn borders_of_flat_marks_are_smooth() {
    let Some(gpu) = gpu("borders_of_flat_marks_are_smooth") else { return };
    // Beside a long side, and at the upper end of a disc.
    let mut picture = empty_plane("");
    let turn = |x: f32, y: f32| Vec2::new(60.3, 60.2) + Vec2::from_angle(0.08).rotate(Vec2::new(x, y));
    let corners = [turn(0.0, 0.0), turn(200.0, 0.0), turn(200.0, 80.0), turn(0.0, 80.0)];
    picture.above.push(Item::fill(Path::polygon(&corners), [0; 3]));
    let image = draw(gpu, &picture);
    let y = crossing(&image, 110, 40..90);
    assert_smooth(&image, 100..120, y, "rectangle");
    let mut picture = empty_plane("");
    picture.above.push(Item::fill(Path::circle(Vec2::new(110.0, 90.3), 50.0), [0; 3]));
    let image = draw(gpu, &picture);
    assert_smooth(&image, 94..110, 40, "disc");
}

#[test]
fn borders_of_obstacles_in_the_plane_are_smooth() {
    let Some(gpu) = gpu("borders_of_obstacles_in_the_plane_are_smooth") else { return };
    let turned = "box'\nsize = [0.8, 0.4]\ncentre = [0, 0]\nrotation = { angle = 0.08 }";
    for (kind, x) in [(turned, 150..170), ("sphere'\nradius = 0.3\ncentre = [0, 0]", 144..160)] {
        let image = draw(gpu, &empty_plane(&format!("[[obstacle]]\nkind = '{kind}\n")));
        // In the middle of the picture are the long side of the box and the upper end of the disc.
        let y = crossing(&image, 160, 20..95);
        assert_smooth(&image, x, y, kind);
    }
}

#[test]
fn lines_and_bodies_in_space_are_smooth() {
    let Some(gpu) = gpu("lines_and_bodies_in_space_are_smooth") else { return };
    let body = "[body]\nlattice = { cells = [1, 1, 1], side = 0.2 }\nrotation = { axis = [0, 0, 1], angle = 0.08 }\n";
    let camera = "camera = { azimuth = 0, elevation = 0, target = [0, 0.1, 0], distance = 1.2 }\n";
    let view = format!("[view]\nsize = [320, 180]\n{camera}");
    let scene = scene(&[WORLD, SPRINGS, body, &view]);
    let mut picture = compose(&scene, &frames(&scene, 0..1)[0]);
    picture.above.clear();
    let image = draw(gpu, &picture);
    let y = crossing(&image, 160, 30..96);
    assert_smooth(&image, 150..170, y, "outline");
    let panel = &mut picture.panels[0];
    panel.lines.retain(|line| line.kind == LineKind::Edge);
    panel.strokes.push(Stroke {
        ends: [[-1.0, 0.05, 1.0], [1.0, 0.22, 1.0]],
        colours: [[0; 3]; 2],
        second: Second::None,
        behind: 0,
        width: 16.0,
    });
    let image = draw(gpu, &picture);
    let y = crossing(&image, 160, 62..84);
    assert_smooth(&image, 140..180, y, "stroke");
}

/// The largest change of a pixel between two pictures, in linear light.
fn change(one: &RgbImage, other: &RgbImage) -> f64 {
    let pairs = one.as_raw().iter().zip(other.as_raw());
    pairs.map(|(&a, &b)| (linear(a) - linear(b)).abs()).fold(0.0, f64::max)
}

#[test]
fn what_turns_slowly_changes_slowly() {
    let Some(gpu) = gpu("what_turns_slowly_changes_slowly") else { return };
    let bodies = [
        "[body]\nlattice = { cells = [2, 2, 2], side = 0.1 }\n",
        "[body]\nlattice = { cells = [2, 2, 2], side = 0.1, irregular = 0.35, seed = 3 }\n",
        "[body]\nlattice = { cells = [2, 1, 2], side = [0.1, 0.01, 0.1] }\n",
    ];
    let camera = "size = [320, 180]\ncamera = { target = [0, 0.05, 0], distance = 1.6 }\n";
    let shows = ["[view]\n", "[view]\nshow = ['surfaces', 'nodes', 'springs', 'displacements']\n"];
    for body in bodies {
        for show in shows {
            let scene = scene(&[WORLD, SPRINGS, body, TURNING, show, camera]);
            let composer = unknown(&scene);
            let mut renderer = renderer(gpu, scene.view.size);
            let images: Vec<_> = frames(&scene, 0..12)
                .iter()
                .map(|frame| {
                    let mut picture = composer.compose(frame);
                    picture.mute();
                    renderer.draw(&picture).expect("the device works")
                })
                .collect();
            let largest = images.windows(2).map(|two| change(&two[0], &two[1])).fold(0.0, f64::max);
            // A quarter of the way from black to white is one sample of four.
            assert!((1e-3..0.2).contains(&largest), "{body}{show}: {largest}");
        }
    }
}

#[test]
fn obstacles_are_drawn_alike_every_time() {
    let Some(gpu) = gpu("obstacles_are_drawn_alike_every_time") else { return };
    let text = include_str!("../golden/primitives/obstacles.toml");
    let scene = parse(text);
    let frame = &frames(&scene, 6..7)[0];
    let [one, other] = [(), ()].map(|()| draw(gpu, &compose(&scene, frame)));
    assert_eq!(one, other);
}

/// Means of 8×8 pixels are between two bytes where the shadow changes slowly: there are no bands of one byte each. The
/// plain background does not change.
#[test]
fn a_wide_shadow_has_no_bands() {
    let Some(gpu) = gpu("a_wide_shadow_has_no_bands") else { return };
    let (mut scene, frame) = fig4b(2);
    scene.view.floor = localshape::look::FloorStyle::None;
    let mut picture = compose(&scene, &frame);
    (picture.words, picture.marks) = Default::default();
    for panel in &mut picture.panels {
        (panel.sound, panel.turned_over) = Default::default();
        panel.lines.clear();
    }
    let image = draw(gpu, &picture);
    assert!((0..1280).all(|x| image.get_pixel(x, 2).0 == picture.palette.background));
    let (mut between, mut all) = (0, 0);
    for (x, y) in (40..75).flat_map(|y| (0..160).map(move |x| (8 * x, 8 * y))) {
        let block: Vec<_> = (0..64).map(|at| f64::from(image.get_pixel(x + at % 8, y + at / 8)[1])).collect();
        let (low, high) = block.iter().fold((255.0, 0.0), |(a, b): (f64, f64), &at| (a.min(at), b.max(at)));
        let mean = block.iter().sum::<f64>() / 64.0;
        if mean < 245.0 && high - low <= 2.0 {
            all += 1;
            between += usize::from((mean - mean.round()).abs() > 0.03);
        }
    }
    assert!(all > 200 && between * 10 > all * 8, "{between} of {all}");
}

/// Neighbours are cut differently, but have the same points along their edge.
#[test]
fn surfaces_of_bent_faces_have_no_gaps() {
    let (scene, frame) = fig4b(4);
    let picture = compose(&scene, &frame);
    for panel in &picture.panels {
        let mesh = &panel.sound;
        // Weights of the corners round differently on both sides of an edge.
        let place = |at: u32| mesh.vertices[at as usize].position.map(|part| (f64::from(part) * 1e4).round() as i64);
        let mut pieces: HashMap<_, i32> = HashMap::new();
        for [a, b, c] in mesh.triangles.iter().map(|corners| corners.map(place)) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *pieces.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(mesh.triangles.len() > 2 * 54, "some faces are cut: {}", mesh.triangles.len());
        assert!(pieces.values().all(|&count| count == 0), "each piece of an edge lies between two triangles");
    }
}
