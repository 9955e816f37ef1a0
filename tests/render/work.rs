//! The commands to the device: none that a picture does not need, and none twice.

use super::listed::Listed;
use super::{compose, draw, fig4b, gpu, parse, renderer};
use localshape::gpu::{AdapterChoice, Gpu, GpuError, Work};
use localshape::picture::Item;
use localshape::render::{RenderError, Renderer};
use localshape::runner::Runner;
use localshape::vector::{Format, Page, write};
use std::collections::BTreeSet;

/// A device whose work log no other test shares.
fn own_gpu(test: &str) -> Option<Gpu> {
    gpu(test).map(|_| Gpu::new(&AdapterChoice::Auto).expect("as before"))
}

fn drawn(work: &[Work]) -> BTreeSet<&'static str> {
    work.iter().filter_map(|work| if let Work::Draw(label) = work { Some(*label) } else { None }).collect()
}

fn made(work: &[Work]) -> BTreeSet<&'static str> {
    work.iter().filter_map(|work| if let Work::Pipeline(label) = work { Some(*label) } else { None }).collect()
}

fn uploads(work: &[Work]) -> Vec<(&'static str, usize)> {
    let upload = |work: &Work| if let Work::Upload(label, size) = work { Some((*label, *size)) } else { None };
    work.iter().filter_map(upload).collect()
}

fn pictures(work: &[Work]) -> usize {
    work.iter().filter(|&&work| work == Work::Picture).count()
}

/// The work of a new renderer for a picture.
fn work_for(gpu: &Gpu, picture: &Listed) -> Vec<Work> {
    gpu.take_work();
    draw(gpu, picture);
    gpu.take_work()
}

#[test]
fn only_what_a_picture_holds_is_drawn_and_has_pipelines() {
    let Some(gpu) = own_gpu("only_what_a_picture_holds_is_drawn_and_has_pipelines") else { return };
    const LINES: [&str; 4] = ["edges", "edge_opacity", "contours", "contour_opacity"];
    const BODY: [&str; 3] = ["sound", "border_colour", "composite"];
    const TURNED_OVER: [&str; 6] = [
        "turned over",
        "alarm_edges",
        "alarm_edge_opacity",
        "alarm_contours",
        "alarm_contour_opacity",
        "alarm_border_colour",
    ];
    let set = |parts: &[&[&'static str]]| parts.concat().into_iter().collect::<BTreeSet<_>>();
    let (scene, first) = fig4b(0);
    let mut still = compose(&scene, &first);
    let floors = still.panels.iter_mut().filter_map(|panel| panel.floor.as_mut());
    floors.flat_map(|floor| &mut floor.shades).for_each(|shade| shade.cells.clear());
    let floor = ["floor_colour", "shadowed_colour"];
    // The bodies still fall: nothing is turned over, and here they have no shadow.
    let work = work_for(&gpu, &still);
    assert_eq!(drawn(&work), set(&[&LINES, &BODY, &floor[..1]]));
    // The pipelines of surfaces and of the ground are made together.
    let together = set(&[&LINES, &BODY, &floor, &["turned over", "sound, before others"]]);
    assert!(made(&work).is_subset(&together), "{:?}", made(&work));

    // One panel has turned-over elements.
    let (_, later) = fig4b(32);
    let work = work_for(&gpu, &compose(&scene, &later));
    assert!(set(&[&TURNED_OVER, &["sound, before others"], &floor]).is_subset(&drawn(&work)), "{:?}", drawn(&work));

    // Only surfaces.
    let mut bare = still;
    for panel in &mut bare.panels {
        (panel.floor, panel.lines, panel.borders) = (None, Vec::new(), Vec::new());
    }
    bare.above.clear();
    assert_eq!(drawn(&work_for(&gpu, &bare)), set(&[&["sound", "composite"]]));
    bare.panels.clear();
    assert_eq!(drawn(&work_for(&gpu, &bare)), BTreeSet::new());
}

#[test]
fn only_what_changed_is_uploaded() {
    let Some(gpu) = own_gpu("only_what_changed_is_uploaded") else { return };
    let (mut scene, frame) = fig4b(32);
    scene.view.size = [640, 360];
    let mut picture = compose(&scene, &frame);
    let mut renderer = renderer(&gpu, picture.size);
    let mut work_for = |picture: &Listed| {
        gpu.take_work();
        let image = renderer.draw(picture).expect("the device works");
        (gpu.take_work(), image)
    };
    let (work, first) = work_for(&picture);
    let labels: BTreeSet<_> = uploads(&work).iter().map(|(label, _)| *label).collect();
    for label in ["vertices", "indices", "lines", "borders", "panels", "grounds", "shades"] {
        assert!(labels.contains(label), "{label} is not in {labels:?}");
    }
    // The same picture, drawn again: nothing is uploaded, and no pipeline is made.
    let (work, again) = work_for(&picture);
    assert_eq!((uploads(&work), made(&work), pictures(&work)), (Vec::new(), BTreeSet::new(), 1));
    assert!(again == first);
    // A body that moves a little keeps its triangles, and the floor stays.
    picture.panels[1].sound.vertices[0].position[0] += 0.01;
    let (work, moved) = work_for(&picture);
    assert!(matches!(uploads(&work)[..], [("vertices", size)] if size <= 4096), "{:?}", uploads(&work));
    assert_eq!(moved, draw(&gpu, &picture), "as drawn alone");
    // Words are painted without the device.
    let runs = picture.above.iter_mut().filter_map(|item| if let Item::Text(run) = item { Some(run) } else { None });
    runs.take(1).for_each(|run| run.size *= 1.5);
    let (work, larger) = work_for(&picture);
    assert_eq!(uploads(&work), Vec::new());
    assert_eq!(larger, draw(&gpu, &picture), "as drawn alone");
    // A shadow that moves.
    let floor = picture.panels[1].floor.as_mut().expect("a floor");
    let shade = floor.shades.iter_mut().find(|shade| !shade.cells.is_empty()).expect("a shadow");
    shade.cells[0] ^= 1;
    let (work, shaded) = work_for(&picture);
    assert!(matches!(uploads(&work)[..], [("shades", _)]), "{:?}", uploads(&work));
    assert_eq!(shaded, draw(&gpu, &picture), "as drawn alone");
}

#[test]
fn pictures_in_the_plane_need_no_device() {
    let scene = parse(include_str!("../../scenes/fig4a.toml"));
    let picture = compose(&scene, &Runner::new(&scene, &[0, 1]).frame(90));
    let mut renderer = Renderer::new(None, picture.size).expect("a size that can be drawn");
    let image = renderer.draw(&picture).expect("no device is needed");
    assert_eq!(renderer.draw(&picture), Ok(image.clone()));
    let colours: BTreeSet<_> = image.pixels().map(|pixel| pixel.0).collect();
    assert!(colours.contains(&picture.palette.background) && colours.contains(&picture.palette.sound_flat));
    // Lit bodies do.
    let (scene, frame) = fig4b(0);
    let lit = Renderer::new(None, scene.view.size).and_then(|mut renderer| renderer.draw(&compose(&scene, &frame)));
    assert_eq!(lit, Err(RenderError::NoDevice));
}

/// Patterns on bodies are made only where a panel shows them.
#[test]
fn bodies_far_larger_than_their_panel_are_drawn_in_bounded_time() {
    for distance in [1e-2, 1e-5, 1e-9] {
        let scene = parse(&format!(
            "time = {{ duration = 1, step = 'T/50', frames_per_second = 50 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e3 }} }}]
            view = {{ size = [320, 240], camera = {{ target = [0.1, 0.1], distance = {distance:e} }} }}
            body = {{ lattice = {{ cells = [2, 2], side = 0.2 }} }}"
        ));
        let mut frame = Runner::new(&scene, &[0]).frame(0);
        // Pressed flat, but for one cell, which is turned over.
        frame.runs[0].snapshot.position[..6].iter_mut().for_each(|node| node.y = 0.1);
        frame.runs[0].snapshot.position[8].y = -0.3;
        let picture = compose(&scene, &frame);
        Renderer::new(None, picture.size).and_then(|mut renderer| renderer.draw(&picture)).expect("drawn");
        assert!(write(&Page::new(&picture), Format::Svg).expect("a page").len() < 4 << 20, "{distance:e}");
    }
}

#[test]
fn a_device_that_is_lost_is_told_in_one_line_wherever_that_is_noticed() {
    let Some(gpu) = own_gpu("a_device_that_is_lost_is_told_in_one_line_wherever_that_is_noticed") else { return };
    let (mut scene, frame) = fig4b(4);
    scene.view.size = [320, 180];
    let picture = compose(&scene, &frame);
    let mut renderer = renderer(&gpu, picture.size);
    let pending = renderer.submit(&picture).expect("the device works");
    gpu.device().destroy();
    let errors = [
        renderer.collect(pending).map(drop).unwrap_err(),
        renderer.draw(&picture).map(drop).unwrap_err(),
        renderer.draw(&picture).map(drop).unwrap_err(),
    ];
    for error in errors {
        assert!(matches!(&error, RenderError::Gpu(GpuError::Lost(why)) if !why.contains('\n')), "{error:?}");
        let text = error.to_string();
        assert!(text.starts_with("the graphics device was lost (") && text.contains("run the command again"), "{text}");
    }
}
