//! Golden images: the last frame of each scene in this folder, against the picture of the same name beside it; and that
//! of each scene that ships, drawn small, against the picture of the same name in `scenes/` here. All figures stand in
//! `figures/` here, drawn small, too.
//!
//! A golden is a frame as the program writes it, so it carries the digest of the state it shows. A failure can say
//! whether the physics moved or only the drawing.
//!
//! A scene without a picture fails, and so does a picture without a scene. To make or renew pictures:
//! `UPDATE_GOLDENS=1 cargo test --release --test golden`, then look at every one that changed.
#![cfg(feature = "render")]

use image::{DynamicImage, RgbImage};
use localshape::gpu::{AdapterChoice, Gpu};
use localshape::moments::Moments;
use localshape::output::{Tags, encode, read_tags};
use localshape::picture::{Composer, compose, compose_figure};
use localshape::render::Renderer;
use localshape::scene::figure::{Figure, NAMES};
use localshape::scene::{Limits, Scene};
use localshape::sequence::Sequence;
use localshape::sim::snapshot::{Frame, RunFrame};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// By how much a channel must differ before a pixel counts: rounding differs by 1 between processors.
const CHANNEL: u8 = 2;

/// How many pixels may differ by more, as a part of all and at least. Weaker processors and other drivers differ in
/// 10 to 30 pixels of a 1280×720 picture, now and then strongly where an outline passes through a pixel's corner.
/// A limit on the largest difference would be wrong either way.
const PART: f64 = 1e-4;
const AT_LEAST: usize = 8;

/// The largest golden (bytes): small pictures say as much and keep the store small.
const LARGEST_FILE: u64 = 40 * 1024;

/// Width of the pictures of scenes that ship (px).
const SMALL: u32 = 320;

/// A folder of scenes, the folder of their goldens, and the width of these if it is not that of the scene (px).
struct Set {
    scenes: PathBuf,
    goldens: PathBuf,
    width: Option<u32>,
}

fn sets() -> [Set; 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let here = root.join("tests/golden");
    [
        Set { scenes: here.clone(), goldens: here.clone(), width: None },
        Set { scenes: root.join("scenes"), goldens: here.join("scenes"), width: Some(SMALL) },
    ]
}

/// The stems of the files with an ending.
fn stems(folder: &Path, ending: &str) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder of scenes or goldens");
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let matching = paths.filter(|path| path.extension().is_some_and(|found| found == ending));
    matching.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect()
}

/// A device, or `None` with a word about it; with `LOCALSHAPE_REQUIRE_GPU=1` there must be one.
fn device() -> Option<Gpu> {
    match Gpu::new(&AdapterChoice::Cpu).or_else(|_| Gpu::new(&AdapterChoice::Auto)) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some_and(|value| value == "1") => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped, nothing was compared: {error}");
            None
        }
    }
}

/// The last frame of a scene, drawn, with opacities if it has no background.
fn draw(gpu: &Gpu, scene: &Scene) -> (DynamicImage, Tags) {
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let frame = Sequence::new(scene, &runs).frame(scene.last_frame());
    let mut renderer = Renderer::new(gpu, scene.view.size, 4).expect("a renderer");
    let image = if scene.view.look.transparent {
        let [on_white, on_black] = [[255; 3], [0; 3]].map(|ground| Composer::on_ground(scene, ground).compose(&frame));
        renderer.draw_transparent(&on_white, &on_black).expect("a picture").into()
    } else {
        renderer.draw(&compose(scene, &frame)).expect("a picture").into()
    };
    (image, Tags::new(scene, &frame, &gpu.description().to_string()))
}

/// How many pixels differ by more than [`CHANNEL`]; `None` if the sizes differ, or only one has opacities.
fn different_pixels(expected: &DynamicImage, actual: &DynamicImage) -> Option<usize> {
    let alike = expected.color() == actual.color() && expected.width() == actual.width();
    let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > CHANNEL);
    let pixels = |image: &DynamicImage| image.color().bytes_per_pixel() as usize;
    (alike && expected.height() == actual.height()).then(|| {
        let [one, other] = [expected, actual].map(|image| image.as_bytes().chunks(pixels(image)));
        one.zip(other).filter(|&two| differs(two)).count()
    })
}

fn allowed(picture: &DynamicImage) -> usize {
    AT_LEAST.max((PART * f64::from(picture.width()) * f64::from(picture.height())) as usize)
}

/// A picture as a file.
fn encoded(image: &DynamicImage, tags: &Tags) -> Vec<u8> {
    encode([image.width(), image.height()], image.as_bytes(), tags)
}

/// What is wrong with a picture, in words; `None` if it is as expected.
fn judge(golden: &Path, actual: &DynamicImage, tags: &Tags) -> Option<String> {
    let accept = "look at both, then accept with UPDATE_GOLDENS=1 cargo test --release --test golden";
    if !golden.exists() {
        return Some("the golden is missing; make it with UPDATE_GOLDENS=1 cargo test --release --test golden".into());
    }
    let expected = match image::open(golden) {
        Ok(expected) => expected,
        Err(error) => return Some(format!("the golden cannot be read: {error}")),
    };
    let Ok(Some(expected_tags)) = read_tags(golden) else {
        return Some(format!("the golden records no state; {accept}"));
    };
    if expected_tags.states != tags.states {
        return Some(format!("state moved: the simulation gives other positions or velocities; {accept}"));
    }
    match different_pixels(&expected, actual) {
        None => {
            let kind = |image: &DynamicImage| format!("{} × {} of {:?}", image.width(), image.height(), image.color());
            Some(format!("{} instead of {}; {accept}", kind(actual), kind(&expected)))
        }
        Some(count) if count > allowed(&expected) => {
            Some(format!("same state, drawn differently: {count} pixels, {} allowed; {accept}", allowed(&expected)))
        }
        Some(_) => None,
    }
}

/// Compares a picture with its golden, or renews that; says what is wrong.
fn complaint(stem: &str, golden: &Path, image: &DynamicImage, tags: &Tags) -> Option<String> {
    let complaint = judge(golden, image, tags)?;
    let bytes = encoded(image, tags);
    if std::env::var_os("UPDATE_GOLDENS").is_some_and(|value| value == "1") {
        assert!(bytes.len() as u64 <= LARGEST_FILE, "{stem}: {} bytes, make the picture smaller", bytes.len());
        std::fs::write(golden, bytes).expect("a golden");
        eprintln!("{stem}: renewed ({complaint})");
        return None;
    }
    let failed = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    std::fs::create_dir_all(&failed).expect("a folder for failures");
    let actual = failed.join(stem).with_extension("png");
    std::fs::write(&actual, bytes).expect("the picture of a failure");
    Some(format!("{stem}: {complaint}\n  expected {}\n  actual   {}", golden.display(), actual.display()))
}

#[test]
fn every_scene_looks_as_it_did() {
    let Some(gpu) = device() else { return };
    let mut complaints = Vec::new();
    for Set { scenes, goldens, width } in sets() {
        for stem in stems(&scenes, "toml") {
            let scene = Scene::load(&scenes.join(&stem).with_extension("toml"), &Limits::default());
            let mut scene = scene.unwrap_or_else(|error| panic!("{error}"));
            let [whole, height] = scene.view.size;
            scene.view.size = width.map_or(scene.view.size, |width| [width, width * height / whole]);
            let (image, tags) = draw(&gpu, &scene);
            let golden = goldens.join(&stem).with_extension("png");
            complaints.extend(complaint(&stem, &golden, &image, &tags));
        }
    }
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

/// Width of their pictures (px).
const SHEET: u32 = 330;

#[test]
fn every_figure_looks_as_it_did() {
    let Some(gpu) = device() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/figures");
    let mut complaints = Vec::new();
    for name in NAMES {
        let mut figure = Figure::built_in(name).expect("one of the program's");
        let [width, height] = figure.size;
        figure.size = [SHEET, SHEET * height / width];
        let moments = Moments::new(&figure);
        let picture = compose_figure(&figure, &moments).expect("room");
        let image = Renderer::new(&gpu, figure.size, 4).expect("a renderer").draw(&picture).expect("a picture").into();
        let start = |scene: &Scene| {
            let snapshot = |run: usize| RunFrame { run, snapshot: scene.world(run).snapshot() };
            (0..scene.runs.len()).map(snapshot).collect::<Vec<_>>()
        };
        // The states that are shown; diagrams show those at the start of all their scenes.
        let runs = match moments.cells.concat() {
            cells if cells.is_empty() => figure.scenes().iter().flat_map(start).collect(),
            cells => cells,
        };
        let frame = Frame { index: 0, time: 0.0, runs };
        let tags = Tags::new(&figure.scenes()[0], &frame, &gpu.description().to_string());
        complaints.extend(complaint(name, &folder.join(name).with_extension("png"), &image, &tags));
    }
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
    let pictures = stems(&folder, "png");
    assert_eq!(pictures, NAMES.map(str::to_owned).into(), "goldens and figures");
    for name in pictures {
        let size = std::fs::metadata(folder.join(&name).with_extension("png")).expect("a golden").len();
        assert!(size <= LARGEST_FILE, "{name}: {size} bytes");
    }
}

#[test]
fn every_golden_has_a_scene_and_is_small() {
    for Set { scenes, goldens, .. } in sets() {
        assert!(!stems(&scenes, "toml").is_empty());
        let pictures = stems(&goldens, "png");
        let dead: Vec<_> = pictures.difference(&stems(&scenes, "toml")).cloned().collect();
        assert_eq!(dead, [""; 0], "goldens without a scene");
        for stem in pictures {
            let size = std::fs::metadata(goldens.join(&stem).with_extension("png")).expect("a golden").len();
            assert!(size <= LARGEST_FILE, "{stem}: {size} bytes");
        }
    }
}

/// The gate itself: a missing golden fails, a moved state and a changed picture are told apart.
#[test]
fn the_gate_tells_what_moved() {
    let here = tempfile::tempdir().expect("a folder");
    let golden = here.path().join("golden.png");
    let mut image = RgbImage::from_pixel(32, 32, image::Rgb([90, 120, 150]));
    let mut tags = Tags {
        scene: "s".into(),
        states: vec![("1234".into(), "run".into())],
        frame: 3,
        time: 0.05,
        version: "0".into(),
        adapter: "none".into(),
    };
    let verdict = |image: &RgbImage, tags: &Tags| judge(&golden, &image.clone().into(), tags).unwrap_or_default();
    assert!(verdict(&image, &tags).starts_with("the golden is missing; make it with UPDATE_GOLDENS=1"));
    std::fs::write(&golden, encode([32, 32], image.as_raw(), &tags)).expect("a golden");
    assert_eq!(verdict(&image, &tags), "");
    let _ = image.pixels_mut().map(|pixel| pixel.0[0] += CHANNEL).count();
    assert_eq!(verdict(&image, &tags), "", "rounding is no difference");
    image.pixels_mut().take(AT_LEAST + 1).for_each(|pixel| pixel.0[1] += 9);
    assert!(verdict(&image, &tags).starts_with("same state, drawn differently: 9 pixels, 8 allowed"));
    tags.states[0].0 = "1235".into();
    assert!(verdict(&image, &tags).starts_with("state moved"));
}
