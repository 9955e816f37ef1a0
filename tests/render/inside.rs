//! What is inside a body and behind it: see-through and exploded views.

use super::{fig4b, gpu};
use image::RgbImage;
use localshape::gpu::Gpu;
use localshape::picture::compose;
use localshape::render::Renderer;
use localshape::scene::{Limits, Scene};
use localshape::sequence::Sequence;
use localshape::sim::snapshot::Frame;

fn draw(gpu: &Gpu, scene: &Scene, frame: &Frame) -> RgbImage {
    let mut renderer = Renderer::new(gpu, scene.view.size, 4).expect("a size that can be drawn");
    renderer.draw(&compose(scene, frame)).expect("the device works")
}

/// The cubes of Fig. 4(b) at their start, with the one in the middle turned over.
fn middle_turned_over() -> (Scene, Frame) {
    let (scene, mut frame) = fig4b(0);
    frame.runs.truncate(1);
    frame.runs[0].snapshot.turned_over[13] = true;
    (scene, frame)
}

/// How orange an image is: of each pixel, how much more red than blue it has, above what light on grey gives.
fn orange(image: &RgbImage) -> u64 {
    let excess = |[red, _, blue]: [u8; 3]| u64::from(red.saturating_sub(blue).saturating_sub(40));
    image.pixels().map(|pixel| excess(pixel.0)).sum()
}

#[test]
fn an_element_turned_over_inside_is_seen_and_the_better_the_clearer_the_others_are() {
    let Some(gpu) = gpu("an_element_turned_over_inside_is_seen_and_the_better_the_clearer_the_others_are") else {
        return;
    };
    let (mut scene, frame) = middle_turned_over();
    let mut sound = frame.clone();
    sound.runs[0].snapshot.turned_over[13] = false;
    let seen = [1.0, 0.7, 0.4, 0.1].map(|opacity| {
        scene.view.opacity = opacity;
        assert_eq!(orange(&draw(gpu, &scene, &sound)), 0, "nothing has turned over");
        orange(&draw(gpu, &scene, &frame))
    });
    assert!(seen[0] > 100_000, "{seen:?}");
    assert!(seen.windows(2).all(|two| two[1] > two[0]), "{seen:?}");
    assert!(seen[2] as f64 > 1.3 * seen[0] as f64, "{seen:?}");
    scene.view.opacity = 1.0;
    scene.view.explode = 1.0;
    assert!(orange(&draw(gpu, &scene, &frame)) > 100_000);
    assert_eq!(orange(&draw(gpu, &scene, &sound)), 0, "nothing has turned over");
}

#[test]
fn an_opaque_body_is_the_same_whatever_was_seen_through_before() {
    let Some(gpu) = gpu("an_opaque_body_is_the_same_whatever_was_seen_through_before") else { return };
    let (scene, frame) = middle_turned_over();
    let mut clear = compose(&scene, &frame);
    clear.panels[0].opacity = 0.4;
    let mut renderer = Renderer::new(gpu, scene.view.size, 4).expect("a size that can be drawn");
    let through = renderer.draw(&clear).expect("the device works");
    let opaque = renderer.draw(&compose(&scene, &frame)).expect("the device works");
    assert_eq!(opaque, draw(gpu, &scene, &frame));
    assert_ne!(opaque, through);
}

#[test]
fn solids_are_seen_through_clear_surfaces_only() {
    let Some(gpu) = gpu("solids_are_seen_through_clear_surfaces_only") else { return };
    // The ball is behind the plate of cubes and much smaller.
    let scene = |ball: &str, opacity: f64| {
        let text = format!(
            "time = {{ duration = 0.1 }}
            body.lattice = {{ cells = [4, 4, 1], side = 0.1 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            obstacle = [{{ kind = 'floor' }}{ball}]
            [view]
            opacity = {opacity}
            camera = {{ azimuth = 0, elevation = 0.1, target = [0, 0.2, 0], distance = 3 }}"
        );
        Scene::parse(&text, "ball.toml", &Limits::default()).expect("the scene is sound")
    };
    let middle = |ball: &str, opacity: f64| {
        let scene = scene(ball, opacity);
        let frame = Sequence::new(&scene, &[0]).frame(0);
        let (at, side) = ([640 - 12, 365 - 12], 24);
        let image = draw(gpu, &scene, &frame);
        let inner = image::imageops::crop_imm(&image, at[0], at[1], side, side).to_image();
        inner.into_raw().into_iter().map(f64::from).sum::<f64>() / f64::from(3 * side * side)
    };
    let ball = ", { kind = 'sphere', centre = [0, 0.2, -0.4], radius = 0.12 }";
    let [bare, covered] = ["", ball].map(|ball| middle(ball, 1.0));
    assert!((bare - covered).abs() < 1.0, "nothing is seen through an opaque body: {bare} {covered}");
    let [bare, covered] = ["", ball].map(|ball| middle(ball, 0.3));
    assert!((bare - covered).abs() > 8.0, "a clear body shows the ball: {bare} {covered}");
}
