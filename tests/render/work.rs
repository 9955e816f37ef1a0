//! Devices: pictures that need none, and devices that are lost.

use super::listed::Composer;
use super::{compose, fig4b, gpu, parse, renderer};
use localshape::gpu::{AdapterChoice, Gpu, GpuError};
use localshape::render::{RenderError, Renderer};
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::vector::{Format, Page, write};
use std::collections::BTreeSet;

#[test]
fn pictures_in_the_plane_need_no_device() {
    let scene = parse(include_str!("../../scenes/fig4a.toml"));
    let picture = compose(&scene, &Runner::new(&scene, &[0, 1]).frame(90));
    let mut renderer = Renderer::new(None, picture.size).expect("a size that can be drawn");
    let image = renderer.draw(&picture).expect("no device is needed");
    assert_eq!(renderer.draw(&picture), Ok(image.clone()));
    let colours: BTreeSet<_> = image.pixels().map(|pixel| pixel.0).collect();
    assert!(colours.contains(&picture.palette.background) && colours.contains(&picture.palette.bodies_flat[0]));
    // Lit bodies do.
    let (scene, frame) = fig4b(0);
    let lit = Renderer::new(None, scene.view.size).and_then(|mut renderer| renderer.draw(&compose(&scene, &frame)));
    assert_eq!(lit, Err(RenderError::NoDevice));
}

#[test]
fn pictures_do_not_depend_on_those_before_them() {
    let Some(gpu) = gpu("pictures_do_not_depend_on_those_before_them") else { return };
    let (scene, mut frame) = fig4b(0);
    let mut renderer = renderer(gpu, scene.view.size);
    let drawn = [false, true, false].map(|turned_over| {
        frame.runs[0].snapshot.turned_over[13] = turned_over;
        renderer.draw(&compose(&scene, &frame)).expect("the device works")
    });
    assert!(drawn[0] == drawn[2] && drawn[0] != drawn[1]);
}

/// Patterns on bodies are made only where a panel shows them.
#[test]
fn bodies_far_larger_than_their_panel_are_drawn_in_bounded_time() {
    let shown = ["", "ghost = 'rest', paths = ['centre', 4], "];
    for (distance, shown) in
        [1e-2, 1e-5, 1e-6, 1e-9].into_iter().flat_map(|distance| shown.map(|shown| (distance, shown)))
    {
        let scene = parse(&format!(
            "time = {{ duration = 1, step = 'T/50', frames_per_second = 50 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e3 }} }}]
            view = {{ {shown}size = [320, 240], camera = {{ target = [0.1, 0.1], distance = {distance:e} }} }}
            body = {{ lattice = {{ cells = [2, 2], side = 0.2 }} }}"
        ));
        let mut frame = Runner::new(&scene, &[0]).frame(9);
        // Pressed flat, but for one cell, which is turned over.
        frame.runs[0].snapshot.position[..6].iter_mut().for_each(|node| node.y = 0.1);
        frame.runs[0].snapshot.position[8].y = -0.3;
        let picture = Composer::new(&scene, &History::new(&scene, &[0])).compose(&frame);
        Renderer::new(None, picture.size).and_then(|mut renderer| renderer.draw(&picture)).expect("drawn");
        assert!(write(&Page::new(&picture), Format::Svg).expect("a page").len() < 4 << 20, "{distance:e} {shown}");
    }
}

#[test]
fn a_device_that_is_lost_is_told_in_one_line_wherever_that_is_noticed() {
    let test = "a_device_that_is_lost_is_told_in_one_line_wherever_that_is_noticed";
    let Some(gpu) = gpu(test).map(|_| Gpu::new(&AdapterChoice::Auto).expect("as before")) else { return };
    let (mut scene, frame) = fig4b(4);
    scene.view.size = [320, 180];
    let picture = compose(&scene, &frame);
    let mut renderer = renderer(&gpu, picture.size);
    let pending = renderer.submit(&picture).expect("the device works");
    gpu.device().destroy();
    let errors = [
        renderer.collect(pending, &picture).map(drop).unwrap_err(),
        renderer.draw(&picture).map(drop).unwrap_err(),
        renderer.draw(&picture).map(drop).unwrap_err(),
    ];
    for error in errors {
        assert!(matches!(&error, RenderError::Gpu(GpuError::Lost(why)) if !why.contains('\n')), "{error:?}");
        let text = error.to_string();
        assert!(text.starts_with("the graphics device was lost (") && text.contains("run the command again"), "{text}");
    }
}
