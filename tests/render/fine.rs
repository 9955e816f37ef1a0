//! Antialiasing of everything, text included: pictures compared with themselves, drawn four times larger and averaged.

use super::listed::{Listed, enlarge};
use super::{compose, draw, fig4b, frame, gpu, linear};
use image::RgbImage;
use localshape::picture::Picture;
use localshape::scene::{Limits, Scene};

/// The scale of the reference pictures.
const TIMES: u32 = 4;
/// A larger difference of a channel is visible. This fraction of channels may differ visibly: where several lines share
/// a pixel, and where stripes are too fine and omitted.
const SEEN: u8 = 64;
const PART: f64 = 3e-4;
/// The greatest root mean square difference of channels. It is that of four samples per pixel, with which each pixel on
/// a border differs by up to an eighth of the step between its sides, which is 32.
const MEAN: f64 = 4.5;

/// The same picture with every length scaled: lines, marks and glyphs, too.
fn larger(picture: &Listed) -> Listed {
    let times = TIMES as f32;
    let mut large = picture.clone();
    large.size = large.size.map(|length| length * TIMES);
    for panel in &mut large.panels {
        panel.viewport = panel.viewport.map(|length| length * TIMES);
        panel.region = panel.region.map(|length| length * TIMES);
        let sight = &mut panel.sight;
        sight.focal *= times;
        sight.line_scale *= times;
        // `element` is not scaled: it determines how faint the edges of small elements are.
        sight.middle = sight.middle.map(|at| at * times);
        panel.floor.iter_mut().for_each(|floor| floor.fade_at_words = floor.fade_at_words.map(|height| times * height));
        let fades = panel.obstacles.fade.iter_mut();
        fades.flat_map(|fade| fade.room.iter_mut().chain(&mut fade.distance)).for_each(|at| *at *= times);
        if sight.flat {
            let meshes = panel.obstacles.solids.iter_mut().map(|solid| &mut solid.mesh);
            meshes.flat_map(|mesh| &mut mesh.vertices).for_each(|corner| corner.hatch *= times);
        }
        panel.strokes.iter_mut().for_each(|stroke| stroke.width *= times);
        panel.beads.iter_mut().for_each(|bead| bead.radius *= times);
    }
    let Picture { under, above, .. } = &mut *large;
    enlarge(under, times);
    enlarge(above, times);
    large
}

fn encoded(light: f64) -> f64 {
    255.0 * if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// For each channel of the small picture, the mean of the larger one's pixels, in linear light and in sRGB. The first
/// is right for bodies and their lines; the second for marks and text, which are blended in sRGB.
fn means(large: &RgbImage, light: &[f64; 256]) -> Vec<[u8; 2]> {
    let [width, height] = [large.width() / TIMES, large.height() / TIMES];
    let mut means = Vec::with_capacity((3 * width * height) as usize);
    for at in 0..width * height {
        let [x, y] = [at % width, at / width].map(|at| TIMES * at);
        let bytes = (0..TIMES * TIMES).map(|part| large.get_pixel(x + part % TIMES, y + part / TIMES).0);
        let sums = bytes.fold([[0.0; 2]; 3], |sums, bytes| {
            [0, 1, 2].map(|at| {
                let [of_light, of_bytes]: [f64; 2] = sums[at];
                [of_light + light[usize::from(bytes[at])], of_bytes + f64::from(bytes[at])]
            })
        });
        let count = f64::from(TIMES * TIMES);
        means.extend(sums.map(|[light, bytes]| [encoded(light / count).round() as u8, (bytes / count).round() as u8]));
    }
    means
}

/// The distance of a byte from the interval between two others.
fn off(byte: u8, [one, other]: [u8; 2]) -> u8 {
    one.min(other).saturating_sub(byte).max(byte.saturating_sub(one.max(other)))
}

/// The root mean square difference of channels, and the number of visibly different ones.
fn summary(off: impl Iterator<Item = u8>) -> (f64, usize) {
    let (mut squares, mut count, mut seen) = (0.0, 0, 0);
    for off in off {
        squares += f64::from(off) * f64::from(off);
        count += 1;
        seen += usize::from(off > SEEN);
    }
    (f64::sqrt(squares / f64::from(count)), seen)
}

#[test]
fn borders_are_as_smooth_as_in_larger_pictures() {
    let Some(gpu) = gpu("borders_are_as_smooth_as_in_larger_pictures") else { return };
    let light: [f64; 256] = std::array::from_fn(|byte| linear(byte as u8));
    for name in [
        "arrows",
        "cubes",
        "field",
        "grid",
        "lines",
        "obstacles",
        "obstacles-plane",
        "plane",
        "springs",
        "strip",
        "words",
    ] {
        let path =
            std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/primitives/{name}.toml"));
        let scene = Scene::load(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
        let picture = compose(&scene, &frame(&scene, scene.last_frame()));
        let small = draw(gpu, &picture);
        let large = draw(gpu, &larger(&picture));
        let truth = means(&large, &light);
        let ours = summary(small.as_raw().iter().zip(&truth).map(|(&byte, &truth)| off(byte, truth)));
        assert!(ours.0 <= MEAN && ours.1 as f64 <= PART * small.as_raw().len() as f64, "{name}: {ours:?}");
    }
}

#[test]
fn borders_of_what_is_seen_through_a_body_are_as_smooth_as_in_larger_pictures() {
    let Some(gpu) = gpu("borders_of_what_is_seen_through_a_body_are_as_smooth_as_in_larger_pictures") else { return };
    let light: [f64; 256] = std::array::from_fn(|byte| linear(byte as u8));
    let (mut scene, mut frame) = fig4b(0);
    scene.view.size = [320, 180];
    frame.runs.truncate(1);
    let mut draw_both = |turned_over: bool| {
        // The cube in the middle.
        frame.runs[0].snapshot.turned_over[13] = turned_over;
        let mut picture = compose(&scene, &frame);
        picture.panels[0].lines.clear();
        (draw(gpu, &picture), draw(gpu, &larger(&picture)))
    };
    let [(without, _), (small, large)] = [false, true].map(&mut draw_both);
    let truth = means(&large, &light);
    let channels = small.as_raw().iter().zip(without.as_raw()).zip(&truth);
    let changed = channels.filter(|((byte, without), _)| byte != without).map(|((&byte, _), &truth)| off(byte, truth));
    let ours = summary(changed);
    assert!(ours.0 <= MEAN, "{ours:?}");
}
