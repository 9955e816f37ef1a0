//! Pictures with their own fonts, colours and sizes.

use super::listed::{Composer, Listed, remove};
use super::{compose, fig4b, frame, gpu, parse, renderer};
use image::RgbImage;
use localshape::look::{EdgeStyle, FontFiles};
use localshape::picture::Picture;
use localshape::picture::{Line, LineKind, Obstacles, Weight};
use localshape::runner::Runner;
use localshape::runner::history::History;

const SIZE: [u32; 2] = [640, 360];

/// The built-in fonts.
fn built_in() -> [&'static [u8]; 2] {
    [
        include_bytes!("../../assets/fonts/LocalshapeSans-Regular.otf"),
        include_bytes!("../../assets/fonts/LocalshapeSans-SemiBold.otf"),
    ]
}

#[test]
fn fonts_that_a_scene_brings_are_the_ones_it_is_written_with() {
    let Some(gpu) = gpu("fonts_that_a_scene_brings_are_the_ones_it_is_written_with") else { return };
    let (mut scene, frame) = fig4b(0);
    scene.view.size = SIZE;
    let mut renderer = renderer(gpu, SIZE);
    let [regular, semi_bold] = built_in().map(|bytes| Some(bytes.into()));
    let mut draw = |font: FontFiles| {
        scene.view.look.font = font;
        renderer.draw(&compose(&scene, &frame)).expect("the device works")
    };
    let usual = draw(FontFiles::default());
    let same = draw(FontFiles { regular: regular.clone(), semi_bold: semi_bold.clone() });
    let one = draw(FontFiles { regular: regular.clone(), semi_bold: None });
    let turned = draw(FontFiles { regular: semi_bold, semi_bold: regular });
    assert_eq!(usual, same, "the same fonts from elsewhere");
    assert_ne!(usual, one, "a single font serves for names, too");
    assert_ne!(usual, turned);
    assert_eq!(usual, draw(FontFiles::default()), "one renderer draws with any fonts");
}

#[test]
fn without_edges_outlines_and_turned_over_elements_stay() {
    let (mut scene, mut frame) = fig4b(12);
    frame.runs[1].snapshot.turned_over[0] = true;
    let kinds = |picture: &Listed| {
        let count = |kind| {
            let lines = picture.panels.iter().flat_map(|panel| &panel.lines);
            lines.filter(|line: &&Line| line.kind == kind).count()
        };
        [LineKind::Contour, LineKind::AlarmContour, LineKind::Edge, LineKind::AlarmEdge].map(count)
    };
    let usual = kinds(&compose(&scene, &frame));
    scene.view.edges = EdgeStyle::Outline;
    assert!(usual.iter().all(|&count| count > 0), "{usual:?}");
    assert_eq!(kinds(&compose(&scene, &frame)), [usual[0], usual[1], 0, usual[3]]);
}

/// A picture of only its bodies' surfaces.
fn surfaces_alone(mut picture: Listed) -> Listed {
    for panel in &mut picture.panels {
        (panel.floor, panel.obstacles) = (None, Obstacles::default());
        panel.lines.clear();
        panel.strokes.clear();
        panel.beads.clear();
    }
    let Picture { under, above, .. } = &mut *picture;
    ["floor", "ground", "shadow", "obstacle", "edges", "strokes"].iter().for_each(|part| remove(under, part));
    above.clear();
    picture
}

/// The picture without sound elements.
fn turned_over_alone(picture: &Listed) -> Listed {
    let mut picture = surfaces_alone(picture.clone());
    remove(&mut picture.under, "elements");
    picture
}

/// The pixels of a set that is drawn alone, without a border of a pixel.
fn inside(alone: &RgbImage, background: [u8; 3]) -> Vec<(u32, u32)> {
    let is_set = |x: u32, y: u32| alone.get_pixel(x, y).0 != background;
    let all = (1..alone.height() - 1).flat_map(|y| (1..alone.width() - 1).map(move |x| (x, y)));
    all.filter(|&(x, y)| (x - 1..=x + 1).all(|x| (y - 1..=y + 1).all(|y| is_set(x, y)))).collect()
}

#[test]
fn turned_over_elements_are_hatched() {
    let Some(gpu) = gpu("turned_over_elements_are_hatched") else { return };
    let plane = include_str!("../../scenes/fig4a.toml");
    let text = |more: &str| {
        plane
            .replace("labels =", "# labels =")
            .replace("[view]", &format!("[view]\nshow = ['surfaces']\n{more}"))
            .replace("charts =", "# charts =")
    };
    for theme in ["light", "dark"] {
        for colour in ["", "colour.by = 'strain'"] {
            let text = text(&format!("theme = '{theme}'\nlabels = []\n{colour}"));
            let scene = parse(&text);
            let frame = Runner::new(&scene, &[1]).frame(scene.last_frame());
            assert!(frame.runs[0].snapshot.turned_over.contains(&true));
            let mut renderer = renderer(gpu, scene.view.size);
            let alarm = scene.view.look.palette().alarm;
            let picture = compose(&scene, &frame);
            let mut draw = |picture: &Listed| renderer.draw(picture).expect("the device works");
            let inside = inside(&draw(&turned_over_alone(&picture)), picture.palette.background);
            assert!(inside.len() > 200, "{theme} {colour}: {}", inside.len());
            let image = draw(&surfaces_alone(picture));
            let is_other = |&&(x, y): &&(u32, u32)| {
                let pixel = image.get_pixel(x, y);
                (0..3).any(|at| pixel[at].abs_diff(alarm[at]) > 2)
            };
            let hatched = inside.iter().filter(is_other).count() as f64 / inside.len() as f64;
            assert!(hatched > 0.1, "{theme} {colour}: {hatched}");
        }
    }
}

#[test]
fn type_becomes_larger_and_stays_in_the_picture() {
    let (mut scene, frame) = fig4b(4);
    for text_scale in [0.5, 1.0, 2.0, 3.0] {
        scene.view.look.text_scale = text_scale;
        let picture = compose(&scene, &frame);
        let name = picture.words.iter().find(|run| run.weight == Weight::SemiBold).expect("a name");
        // Names grow less than other type from 1.5 times on.
        let grown = if text_scale > 1.5 { 1.25 * 16.0 / 26.0 * text_scale } else { text_scale };
        assert!((f64::from(name.size) - 26.0 * grown).abs() < 1e-3);
        for run in &picture.words {
            let [left, right] = run.span;
            let (top, bottom) = (run.baseline - 0.78 * run.size, run.baseline + 0.3 * run.size);
            assert!(left >= 0.0 && right <= 1280.0 && top >= 0.0 && bottom <= 720.0, "{run:?}");
        }
    }
}

#[test]
fn small_bodies_have_narrower_contours_and_large_ones_the_usual() {
    let share = |times: f64| {
        let (mut scene, frame) = fig4b(0);
        scene.view.camera.distance *= times;
        compose(&scene, &frame).panels[0].sight.contour_share
    };
    assert_eq!(share(1.0), 1.0);
    assert!((share(100.0) - 0.4).abs() < 1e-6);
    let shares: Vec<_> = (0..200).map(|step| share(1.0 + 0.1 * f64::from(step))).collect();
    assert!(shares.windows(2).all(|two| two[1] <= two[0] && two[0] - two[1] < 0.05), "{shares:?}");
    assert!(shares.iter().any(|share| (0.5..0.7).contains(share)));
}

#[test]
fn the_floor_reaches_as_far_as_shadows_and_stays_as_it_is() {
    let text = super::plain().replace("camera.distance = 2.65", "");
    let scene = parse(&text);
    assert!(scene.view.camera.follow);
    let fade = |picture: &Listed| {
        picture.panels.iter().map(|panel| panel.floor.as_ref().expect("a floor").fade).collect::<Vec<_>>()
    };
    // Without a course the floor follows the shadow of the moment.
    let moved = |up: f64| {
        let mut frame = frame(&scene, 0);
        for run in &mut frame.runs {
            run.snapshot.position.iter_mut().for_each(|at| at.y += up);
        }
        fade(&compose(&scene, &frame))[0]
    };
    let [usual, up] = [0.0, 1.0].map(moved);
    assert!(up[0] > usual[0] + 1.0 && up[1] > usual[1] + 1.0, "{up:?} {usual:?}");
    let all: Vec<_> = (0..400).map(|step| moved(0.01 * f64::from(step))[0]).collect();
    assert!(all.windows(2).all(|two| (0.0..0.2).contains(&(two[1] - two[0]))), "{all:?}");
    // The course of a scene, and a camera that stands still, have one floor.
    let composer = Composer::new(&scene, &History::new(&scene, &[0, 1]));
    let mut runner = Runner::new(&scene, &[0, 1]);
    let fades: Vec<_> = [0, 20, 40, 60].map(|index| fade(&composer.compose(&runner.frame(index)))).concat();
    assert!(fades[0][0] > usual[0] + 1.0 && fades.iter().all(|other| *other == fades[0]), "{fades:?}");
    let (scene, mut frame) = fig4b(0);
    let before = fade(&compose(&scene, &frame));
    frame.runs[0].snapshot.position.iter_mut().for_each(|at| at.y += 2.0);
    assert_eq!(fade(&compose(&scene, &frame)), before);
}
