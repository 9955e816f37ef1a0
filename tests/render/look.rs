//! Pictures without a background, and with fonts, colours and sizes of their own.

use super::{fig4b, gpu};
use image::{Rgb, RgbImage, RgbaImage};
use localshape::gpu::Gpu;
use localshape::picture::{Composer, Picture, Weight, compose};
use localshape::render::Renderer;
use localshape::scene::{FontFiles, Limits, Look, Scene, Theme};
use localshape::sequence::Sequence;
use localshape::sim::snapshot::Frame;

const SIZE: [u32; 2] = [640, 360];

/// A difference that is plain to see where two pictures are laid over each other.
const PLAIN: u8 = 12;

/// A picture on white, on black and without a background.
fn three(gpu: &Gpu, scene: &Scene, frame: &Frame) -> (RgbImage, RgbImage, RgbaImage) {
    let mut renderer = Renderer::new(gpu, scene.view.size, 4).expect("a size that can be drawn");
    let [white, black] = [[255; 3], [0; 3]].map(|ground| Composer::on_ground(scene, ground).compose(frame));
    let transparent = renderer.draw_transparent(&white, &black).expect("the device works");
    let mut draw = |picture: &Picture| renderer.draw(picture).expect("the device works");
    (draw(&white), draw(&black), transparent)
}

/// A picture laid on a page, the way pages are put together.
fn laid(picture: &RgbaImage, ground: u8) -> RgbImage {
    RgbImage::from_fn(picture.width(), picture.height(), |x, y| {
        let [r, g, b, alpha] = picture.get_pixel(x, y).0;
        let share = f64::from(alpha) / 255.0;
        Rgb([r, g, b].map(|byte| (f64::from(byte) * share + f64::from(ground) * (1.0 - share)).round() as u8))
    })
}

/// The largest difference of two pictures, and the part of their pixels that differ by more than [`PLAIN`].
fn apart(one: &RgbImage, other: &RgbImage) -> (u8, f64) {
    let difference = |(a, b): (&Rgb<u8>, &Rgb<u8>)| (0..3).map(|at| a[at].abs_diff(b[at])).max().unwrap_or_default();
    let all: Vec<u8> = one.pixels().zip(other.pixels()).map(difference).collect();
    let more = all.iter().filter(|&&difference| difference > PLAIN).count();
    (all.iter().copied().max().unwrap_or_default(), more as f64 / all.len() as f64)
}

/// Scenes with all that can be seen through: floors with shadows, glass, springs that fade, words and marks.
fn scenes() -> Vec<(String, Scene, Frame)> {
    let texts = [
        ("fig4b", include_str!("../../scenes/fig4b.toml"), 4),
        ("fig4a", include_str!("../../scenes/fig4a.toml"), 40),
        ("obstacles", include_str!("../../scenes/obstacles.toml"), 12),
        ("stretch", include_str!("../../scenes/stretch.toml"), 20),
    ];
    let mut scenes = Vec::new();
    for (name, text, frame) in texts {
        let mut scene = Scene::parse(text, name, &Limits::default()).expect("a scene that ships");
        let runs: Vec<_> = (0..scene.runs.len()).collect();
        let frame = Sequence::new(&scene, &runs).frame(frame);
        scene.view.size = SIZE;
        scenes.push((name.to_owned(), scene, frame));
    }
    let (mut lines, frame) = fig4b(4);
    (lines.view.size, lines.view.visible.surfaces) = (SIZE, false);
    (lines.view.visible.springs, lines.view.visible.nodes) = (true, true);
    scenes.push(("lines".to_owned(), lines, frame));
    scenes
}

#[test]
fn laid_on_a_page_a_picture_looks_as_drawn_on_it() {
    let Some(gpu) = gpu("laid_on_a_page_a_picture_looks_as_drawn_on_it") else { return };
    for (name, mut scene, frame) in scenes() {
        for theme in [Theme::Light, Theme::Dark] {
            scene.view.look = Look { transparent: true, ..Look::of(theme) };
            let (white, black, transparent) = three(gpu, &scene, &frame);
            let on_white = apart(&white, &laid(&transparent, 255));
            let on_black = apart(&black, &laid(&transparent, 0));
            let (own, other) = if theme == Theme::Light { (on_white, on_black) } else { (on_black, on_white) };
            println!("{name} {theme:?}: {own:?} on its own ground, {other:?} on the other");
            assert!(own.0 <= 1, "{name} {theme:?}: {own:?}");
            // Borders of coloured things: one opacity stands for three, see `draw_transparent`.
            assert!(other.0 <= 40 && other.1 < 0.01, "{name} {theme:?}: {other:?}");
        }
    }
}

#[test]
fn nothing_is_nothing_bodies_are_opaque_and_shadows_are_between() {
    let Some(gpu) = gpu("nothing_is_nothing_bodies_are_opaque_and_shadows_are_between") else { return };
    for (name, mut scene, frame) in scenes() {
        for theme in [Theme::Light, Theme::Dark] {
            scene.view.look = Look { transparent: true, ..Look::of(theme) };
            let (white, black, transparent) = three(gpu, &scene, &frame);
            let mut counts = [0_usize; 3];
            for ((pixel, white), black) in transparent.pixels().zip(white.pixels()).zip(black.pixels()) {
                let alpha = pixel[3];
                counts[usize::from(alpha > 0) + usize::from(alpha == 255)] += 1;
                assert!(white != black || alpha == 255, "{name}: {white:?} is opaque, not {pixel:?}");
                let nothing = white.0 == [255; 3] && black.0 == [0; 3];
                assert!(!nothing || pixel.0 == [0; 4], "{name}: nothing is nothing, not {pixel:?}");
            }
            assert!(counts.iter().all(|&count| count > 500), "{name} {theme:?}: {counts:?}");
            for (x, y) in [(0, 0), (SIZE[0] - 1, 0), (0, SIZE[1] - 1), (SIZE[0] - 1, SIZE[1] - 1)] {
                assert_eq!(transparent.get_pixel(x, y).0, [0; 4], "{name} {theme:?}");
            }
        }
    }
}

/// The fonts that are built in.
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
    let mut renderer = Renderer::new(gpu, SIZE, 1).expect("a size that can be drawn");
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
fn type_and_lines_become_larger_and_stay_in_the_picture() {
    let (mut scene, frame) = fig4b(4);
    for (text_scale, line_scale) in [(0.5, 0.25), (1.0, 1.0), (2.0, 3.0), (3.0, 4.0)] {
        (scene.view.look.text_scale, scene.view.look.line_scale) = (text_scale, line_scale);
        let picture = compose(&scene, &frame);
        let name = picture.words.iter().find(|run| run.weight == Weight::SemiBold).expect("a name");
        assert!((f64::from(name.size) - 26.0 * text_scale).abs() < 1e-3);
        assert!((f64::from(picture.panels[0].sight.line_scale) - line_scale).abs() < 1e-6);
        for run in &picture.words {
            let [left, right] = run.span;
            let (top, bottom) = (run.baseline - 0.78 * run.size, run.baseline + 0.3 * run.size);
            assert!(left >= 0.0 && right <= 1280.0 && top >= 0.0 && bottom <= 720.0, "{run:?}");
        }
    }
}
