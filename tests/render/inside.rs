//! The inside of a body, and objects behind it.

use super::{compose, draw, fig4b, gpu, parse, renderer};
use glam::Vec3;
use image::RgbImage;
use localshape::picture::LineKind;
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::scene::Scene;

/// The cubes of Fig. 4(b) at their start, with the one in the middle turned over.
fn middle_turned_over() -> (Scene, Frame) {
    let (scene, mut frame) = fig4b(0);
    frame.runs.truncate(1);
    frame.runs[0].snapshot.turned_over[13] = true;
    (scene, frame)
}

/// The orange of an image: the excess of red over blue in each pixel, above the excess in the light on grey.
fn orange(image: &RgbImage) -> u64 {
    let excess = |[red, _, blue]: [u8; 3]| u64::from(red.saturating_sub(blue).saturating_sub(40));
    image.pixels().map(|pixel| excess(pixel.0)).sum()
}

#[test]
fn an_element_turned_over_inside_is_seen() {
    let Some(gpu) = gpu("an_element_turned_over_inside_is_seen") else { return };
    let (scene, mut frame) = middle_turned_over();
    assert!(orange(&draw(gpu, &compose(&scene, &frame))) > 100_000);
    frame.runs[0].snapshot.turned_over[13] = false;
    assert_eq!(orange(&draw(gpu, &compose(&scene, &frame))), 0, "nothing has turned over");
}

#[test]
fn a_dotted_body_shows_nothing_of_what_was_turned_over_before() {
    let Some(gpu) = gpu("a_dotted_body_shows_nothing_of_what_was_turned_over_before") else { return };
    let (scene, frame) = middle_turned_over();
    let mut dotted = frame.clone();
    dotted.runs[0].snapshot.turned_over[13] = false;
    dotted.runs[0].snapshot.flat[0] = true;
    let mut renderer = renderer(gpu, scene.view.size);
    renderer.draw(&compose(&scene, &frame)).expect("the device works");
    let after = renderer.draw(&compose(&scene, &dotted)).expect("the device works");
    assert_eq!(after, draw(gpu, &compose(&scene, &dotted)));
    assert_eq!(orange(&after), 0, "nothing has turned over");
}

/// One renderer keeps nothing of the picture before.
#[test]
fn turned_over_plain_and_turned_over_again() {
    let Some(gpu) = gpu("turned_over_plain_and_turned_over_again") else { return };
    let (scene, over) = middle_turned_over();
    let mut plain = over.clone();
    plain.runs[0].snapshot.turned_over[13] = false;
    let mut renderer = renderer(gpu, scene.view.size);
    for frame in [&over, &plain, &over] {
        let picture = compose(&scene, frame);
        assert!(renderer.draw(&picture).expect("the device works") == draw(gpu, &picture));
    }
}

#[test]
fn lines_that_reach_far_beyond_the_picture_are_drawn_like_those_that_end_at_it() {
    let Some(gpu) = gpu("lines_that_reach_far_beyond_the_picture_are_drawn_like_those_that_end_at_it") else { return };
    let (scene, frame) = fig4b(0);
    let lengthened = |by: f32| {
        let mut picture = compose(&scene, &frame);
        for line in picture.panels[0].lines.iter_mut().filter(|line| line.kind == LineKind::Contour) {
            let [from, to] = [line.from, line.to].map(Vec3::from);
            line.to = (to + by * (to - from)).to_array();
        }
        draw(gpu, &picture)
    };
    let (far, farther) = (lengthened(1e3), lengthened(1e6));
    let differing = far.pixels().zip(farther.pixels()).filter(|(one, other)| one != other).count();
    assert!(differing < 200, "{differing}");
    assert_ne!(far, lengthened(0.0));
}

#[test]
fn solids_behind_bodies_are_hidden() {
    let Some(gpu) = gpu("solids_behind_bodies_are_hidden") else { return };
    // The ball is behind the plate of cubes and much smaller.
    let scene = |ball: &str| {
        let text = format!(
            "time = {{ duration = 0.1 }}
            body.lattice = {{ cells = [4, 4, 1], side = 0.1 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            obstacle = [{{ kind = 'floor' }}{ball}]
            [view]
            camera = {{ azimuth = 0, elevation = 0.1, target = [0, 0.2, 0], distance = 3 }}"
        );
        parse(&text)
    };
    let middle = |ball: &str| {
        let scene = scene(ball);
        let frame = Runner::new(&scene, &[0]).frame(0);
        let (at, side) = ([640 - 12, 365 - 12], 24);
        let image = draw(gpu, &compose(&scene, &frame));
        let inner = image::imageops::crop_imm(&image, at[0], at[1], side, side).to_image();
        inner.into_raw().into_iter().map(f64::from).sum::<f64>() / f64::from(3 * side * side)
    };
    let ball = |z: f64| format!(", {{ kind = 'sphere', centre = [0, 0.2, {z}], radius = 0.12 }}");
    let [bare, behind, before] = ["", &ball(-0.4), &ball(0.4)].map(middle);
    assert!((bare - behind).abs() < 1.0, "nothing is seen through a body: {bare} {behind}");
    assert!((bare - before).abs() > 8.0, "{bare} {before}");
}
