//! Pictures in the plane look the same in SVG files, as a browser shows them, and in PNG files.

use super::browser::Browser;
use super::listed::Listed;
use super::{compose, frame, parse};
use glam::Vec2;
use localshape::look::{Style, Theme};
use localshape::picture::{Image, Item, Paint, Path, Pen, Picture, compose_figure};
use localshape::render::Renderer;
use localshape::runner::Frame;
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;
use localshape::scene::{Limits, Scene};
use localshape::sim::{Divergence, Status};
use localshape::vector::{Format, Page, write};

/// Colours are compared as means of squares of so many pixels: borders are smoothed in other ways.
const SQUARE: usize = 8;
const SIZE: [u32; 2] = [720, 480];

/// Draws a picture in both ways: the colours of all pixels.
fn both(browser: &mut Browser, picture: &Picture) -> [Vec<[u8; 3]>; 2] {
    let drawn =
        Renderer::new(None, picture.size).and_then(|mut renderer| renderer.draw(picture)).expect("no device is needed");
    let drawn = drawn.pixels().map(|pixel| pixel.0).collect();
    let svg = write(&Page::new(picture), Format::Svg).expect("a page");
    let svg = String::from_utf8(svg).expect("text");
    let pdf = write(&Page::new(picture), Format::Pdf).expect("a page");
    let masks = String::from_utf8_lossy(&pdf).matches("/SMask").count();
    assert_eq!(masks, svg.matches("<image").count(), "soft images of PDF are transparent, too");
    browser.resize(picture.size);
    browser.open(&format!("<!doctype html><meta charset=\"utf-8\"><body style=\"margin: 0\">{svg}"));
    browser.until("the fonts", "document.fonts.status === 'loaded'");
    let (width, seen) = browser.pixels();
    assert_eq!(width, picture.size[0] as usize);
    [drawn, seen]
}

/// Draws a picture without its words in both ways.
fn both_without_words(browser: &mut Browser, mut picture: Listed) -> [Vec<[u8; 3]>; 2] {
    picture.mute();
    both(browser, &picture)
}

/// The largest difference of a colour channel between the means of equal squares, with the place of the square (px), and the mean
/// difference of all squares.
fn differences([one, other]: &[Vec<[u8; 3]>; 2]) -> (f64, [usize; 2], f64) {
    let [width, height] = SIZE.map(|length| length as usize);
    let mean = |pixels: &[[u8; 3]], [left, top]: [usize; 2]| {
        let mut sums = [0.0; 3];
        for y in top..top + SQUARE {
            for pixel in &pixels[y * width + left..][..SQUARE] {
                (0..3).for_each(|channel| sums[channel] += f64::from(pixel[channel]));
            }
        }
        sums.map(|sum| sum / (SQUARE * SQUARE) as f64)
    };
    let places = (0..height / SQUARE).flat_map(|y| (0..width / SQUARE).map(move |x| [x * SQUARE, y * SQUARE]));
    let (mut most, mut at, mut sum) = (0.0, [0; 2], 0.0);
    for place in places {
        let (a, b) = (mean(one, place), mean(other, place));
        let off = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
        sum += off;
        if off > most {
            (most, at) = (off, place);
        }
    }
    (most, at, sum / ((width / SQUARE) * (height / SQUARE)) as f64)
}

const BLOCK: &str = "body = { lattice = { cells = [4, 3], side = 0.2 }, lowest = 0.1, rotation = { angle = 0.2 } }";
const MANY: &str = "body = { lattice = { cells = [30, 22], side = 0.2 }, lowest = 0.1, rotation = { angle = 0.2 } }";
/// On a floor, with a soft shadow.
const STANDING: &str =
    "body = { lattice = { cells = [4, 3], side = 0.2 }, lowest = 0.0 }\n[[obstacle]]\nkind = 'floor'";
/// Obstacles that leave the panel at each of its sides.
const CROSS: &str = "body = { nodes = [[0, 1], [1, 1], [0.5, 1.8]], elements = [[0, 1, 2]] }
    [[obstacle]]
    kind = 'capsule'
    from = [-9, 0.7]
    to = [9, 0.5]
    radius = 0.1
    [[obstacle]]
    kind = 'capsule'
    from = [1.4, -9]
    to = [1.2, 9]
    radius = 0.1";
const FIELD: &str = "colour = { by = 'speed', range = [0, 3] }";

fn diverged(frame: &mut Frame) {
    let snapshot = &mut frame.runs[0].snapshot;
    snapshot.status = Status::Diverged(Divergence { time: 0.0, step: 0, part: 0, element: None, is_end: false });
    let snapshot = snapshot.clone();
    frame.runs[0].last_fit = Some(Box::new(snapshot));
}

fn turned_over(frame: &mut Frame) {
    (0..3).for_each(|element| frame.runs[0].snapshot.turned_over[element] = true);
}

fn flat(frame: &mut Frame) {
    (2..7).for_each(|element| frame.runs[0].snapshot.flat[element] = true);
}

fn speeds(frame: &mut Frame) {
    let snapshot = &mut frame.runs[0].snapshot;
    snapshot.field = (0..snapshot.position.len()).map(|node| node as f64 % 4.0).collect();
}

/// Changes a frame.
type Change = fn(&mut Frame);

#[test]
fn a_browser_shows_flat_panels_as_they_are_drawn() {
    let Some(mut browser) = Browser::start() else { return };
    let cases: [(&str, &str, &[Change]); 10] = [
        (BLOCK, "", &[turned_over]),
        (BLOCK, "", &[diverged]),
        (BLOCK, "", &[flat]),
        (BLOCK, "", &[flat, diverged]),
        (MANY, "", &[]),
        (BLOCK, FIELD, &[speeds, turned_over]),
        (BLOCK, FIELD, &[speeds, flat]),
        (BLOCK, "ghost = 'rest'", &[]),
        (CROSS, "", &[]),
        (STANDING, "", &[]),
    ];
    for (case, (world, view, changes)) in cases.into_iter().enumerate() {
        for theme in [Theme::Light, Theme::Dark] {
            let mut scene = parse(&format!(
                "time = {{ duration = 1, step = 'T/50', frames_per_second = 50 }}
                run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e3 }} }}]
                view = {{ size = {SIZE:?}, {view} }}
                {world}"
            ));
            scene.view.look = Style::of(theme);
            scene.view.camera.follow = false;
            let mut frame = frame(&scene, 0);
            changes.iter().for_each(|change| change(&mut frame));
            let pictures = both_without_words(&mut browser, compose(&scene, &frame));
            let (most, at, mean) = differences(&pictures);
            assert!(most < 20.0 && mean < 0.4, "case {case}, {theme:?}: {most:.2} at {at:?}, {mean:.3} in the mean");
            if changes.contains(&(diverged as Change)) {
                let body = |y: usize| (y * 720 + 300)..(y * 720 + 400);
                for pixel in pictures.iter().flat_map(|pixels| (190..280).flat_map(|y| &pixels[body(y)])) {
                    let spread = pixel.iter().max().unwrap() - pixel.iter().min().unwrap();
                    // Dark grounds are bluish, but less than bodies.
                    assert!(spread < 14, "case {case}, {theme:?}: {pixel:?} is not grey");
                }
            }
        }
    }
}

/// Items of every kind.
#[test]
fn a_browser_shows_items_as_they_are_drawn() {
    let Some(mut browser) = Browser::start() else { return };
    let scene = parse(&format!(
        "time = {{ duration = 1, step = 'T/50', frames_per_second = 50 }}
        run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e3 }} }}]
        view = {{ size = {SIZE:?} }}\n{BLOCK}"
    ));
    let mut picture = compose(&scene, &frame(&scene, 0));
    picture.panels.clear();
    let (blue, yellow) = ([20, 90, 160], [250, 200, 40]);
    let square = |at: u16| Vec2::new(50.0 + 130.0 * f32::from(at % 5), 50.0 + 140.0 * f32::from(at / 5));
    let side = Vec2::splat(96.0);
    let disc = |at: u16| Path::circle(square(at) + 48.0, 40.0);
    let slant = Path::open(&[square(2), square(2) + side, square(2) + Vec2::new(96.0, 0.0)]);
    let pen = Pen { dash: vec![14.0, 6.0], round: false, ..Pen::solid(7.0) };
    let soft = (0..48).flat_map(|at| [20, 90, 160, 5 * at]).collect();
    let place = [square(5), Vec2::new(96.0, 0.0), Vec2::new(0.0, 96.0)];
    picture.above = vec![
        Item::fill(Path::rectangle(square(0), side), blue),
        Item::fill(disc(1), Paint { colour: blue, alpha: 0.4 }),
        Item::stroke(slant, pen, blue),
        Item::stroke(disc(3), Pen::solid(9.0), yellow),
        Item::Blend {
            path: Path::rectangle(square(4), side),
            ends: [square(4), square(4) + Vec2::new(96.0, 0.0)],
            colours: vec![blue, yellow, [0; 3]],
        },
        Item::Image(Image { size: [1, 48], pixels: soft, place }),
        Item::Clip { path: disc(6), items: vec![Item::fill(Path::rectangle(square(6), 0.5 * side), yellow)] },
        Item::part("two", [Item::fill(disc(7), blue), Item::fill(Path::rectangle(square(7), 0.5 * side), yellow)]),
    ];
    let (most, at, mean) = differences(&both_without_words(&mut browser, picture));
    assert!(most < 20.0 && mean < 0.4, "{most:.2} at {at:?}, {mean:.3} in the mean");
}

/// Whole pictures, with their words.
#[test]
fn a_browser_shows_each_shipped_picture_in_the_plane_as_it_is_drawn() {
    let Some(mut browser) = Browser::start() else { return };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pictures = 0;
    for folder in ["scenes", "scenes/elements", "figures"] {
        for entry in std::fs::read_dir(root.join(folder)).expect("a folder that ships") {
            let path = entry.expect("an entry").path();
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let name = path.display();
            let picture = if folder == "figures" {
                let figure = Figure::load(&path, &Limits::default()).expect("a figure that ships");
                if figure.is_lit() {
                    continue;
                }
                compose_figure(&figure, &Moments::new(&figure)).expect("room").0
            } else {
                let scene = Scene::load(&path, &Limits::default()).expect("a scene that ships");
                if scene.is_lit() {
                    continue;
                }
                localshape::compose(&scene, &frame(&scene, scene.last_frame() / 2))
            };
            let [drawn, seen] = both(&mut browser, &picture);
            let bytes = drawn.as_flattened().iter().zip(seen.as_flattened());
            let mean = bytes.map(|(&a, &b)| f64::from(a.abs_diff(b))).sum::<f64>() / (3 * drawn.len()) as f64;
            assert_eq!(drawn.len(), seen.len(), "{name}");
            assert!(mean <= 1.0, "{name}: {mean:.3} of 255 in the mean");
            pictures += 1;
        }
    }
    assert!(pictures >= 10, "{pictures}");
}
