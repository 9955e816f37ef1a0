//! Images from the device.

use super::{compose, draw, fig4b, gpu, renderer};
use image::RgbImage;
use localshape::look::{Style, Theme};
use localshape::render::{RenderError, Renderer};
use localshape::scene::Scene;
use localshape::sim::{Divergence, Status};

/// Number of pixels of an image that are clearly vermilion.
fn vermilion(image: &RgbImage) -> usize {
    image.pixels().filter(|pixel| pixel[0] > 180 && pixel[1] < 130 && pixel[2] < 90).count()
}

#[test]
fn the_same_picture_gives_the_same_bytes_whatever_was_drawn_before() {
    let Some(gpu) = gpu("the_same_picture_gives_the_same_bytes_whatever_was_drawn_before") else { return };
    let (mut scene, frame) = fig4b(4);
    scene.view.size = [427, 240];
    let (other_scene, other) = fig4b(32);
    let mut renderer = renderer(gpu, scene.view.size);
    let first = renderer.draw(&compose(&scene, &frame)).expect("the device works");
    let mut elsewhere = compose(&Scene { view: scene.view.clone(), ..other_scene.clone() }, &other);
    elsewhere.mute();
    renderer.draw(&elsewhere).expect("the device works");
    let again = renderer.draw(&compose(&scene, &frame)).expect("the device works");
    assert_eq!(first, again);
    assert_eq!(first, draw(gpu, &compose(&scene, &frame)), "new renderer");
}

#[test]
fn turned_over_elements_show_only_where_there_are_any() {
    let Some(gpu) = gpu("turned_over_elements_show_only_where_there_are_any") else { return };
    for theme in [Theme::Light, Theme::Dark] {
        let (mut scene, frame) = fig4b(4);
        scene.view.look = Style::of(theme);
        let over: Vec<_> = frame.runs.iter().map(|run| run.snapshot.diagnostics.turned_over).collect();
        assert_eq!(over[0], 0, "this frame is known for it");
        assert!(over[1] > 0, "this frame is known for it");
        let image = draw(gpu, &compose(&scene, &frame));
        let half = |left| image::imageops::crop_imm(&image, left, 0, 640, 720).to_image();
        assert_eq!(vermilion(&half(0)), 0, "{theme:?}");
        assert!(vermilion(&half(640)) > 2000, "{theme:?}: {}", vermilion(&half(640)));
    }
}

#[test]
fn any_size_can_be_drawn() {
    let Some(gpu) = gpu("any_size_can_be_drawn") else { return };
    let (mut scene, frame) = fig4b(4);
    for size in [[64, 64], [1, 1], [333, 77], [65, 1025], [2, 700]] {
        scene.view.size = size;
        let image = draw(gpu, &compose(&scene, &frame));
        assert_eq!([image.width(), image.height()], size);
    }
}

#[test]
fn sizes_that_cannot_be_had_are_refused() {
    let Some(gpu) = gpu("sizes_that_cannot_be_had_are_refused") else { return };
    let longest = gpu.longest_side([1; 2]);
    for size in [[0, 10], [10, 0], [longest + 1, 10], [u32::MAX, u32::MAX]] {
        assert!(matches!(Renderer::new(gpu, size), Err(RenderError::Size { .. })), "{size:?}");
    }
    let (scene, frame) = fig4b(0);
    let mut renderer = renderer(gpu, [10, 10]);
    assert!(matches!(renderer.draw(&compose(&scene, &frame)), Err(RenderError::OtherSize { .. })));
}

#[test]
fn a_run_that_blew_up_is_drawn_like_any_other() {
    let Some(gpu) = gpu("a_run_that_blew_up_is_drawn_like_any_other") else { return };
    let (mut scene, mut frame) = fig4b(4);
    scene.view.size = [320, 180];
    let snapshot = &mut frame.runs[1].snapshot;
    snapshot.status = Status::Diverged(Divergence { time: 0.035, step: 7, part: 0, element: None, is_end: false });
    for (at, position) in snapshot.position.iter_mut().enumerate() {
        *position *= 10_f64.powi(at as i32 % 40 * 7);
    }
    let image = draw(gpu, &compose(&scene, &frame));
    assert!(image.pixels().any(|pixel| pixel[0] < 100), "there is something to see");
}

#[test]
fn the_corner_of_the_picture_is_the_ground() {
    let Some(gpu) = gpu("the_corner_of_the_picture_is_the_ground") else { return };
    let (mut scene, frame) = fig4b(0);
    for (theme, ground) in [(Theme::Light, [0xfb, 0xfb, 0xfa]), (Theme::Dark, [0x12, 0x16, 0x1c])] {
        scene.view.look = Style::of(theme);
        let image = draw(gpu, &compose(&scene, &frame));
        for (x, y) in [(0, 0), (1279, 0), (0, 719), (1279, 719)] {
            assert_eq!(image.get_pixel(x, y).0, ground, "{theme:?} at {x}, {y}");
        }
    }
}
