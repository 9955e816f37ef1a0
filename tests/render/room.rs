//! Bodies have nearly half of the width or height of a panel, at any size.

use super::{all, parse};
use glam::{Vec2, Vec3};
use localshape::picture::{Composer, Panel};
use localshape::runner::Runner;
use localshape::runner::history::History;

/// The sizes of a small picture, of common screens, portrait, a strip, and one column of a journal at 300 dpi.
const SIZES: [[u32; 2]; 9] = [
    [320, 200],
    [640, 480],
    [1280, 720],
    [1280, 840],
    [1920, 1080],
    [3840, 2160],
    [1080, 1920],
    [2400, 400],
    [1004, 700],
];

/// The box around bodies, as shares of the width and height of their panel.
fn around(panel: &Panel) -> [Vec2; 2] {
    let meshes = [&panel.sound, &panel.turned_over];
    let corners = meshes.into_iter().flat_map(|mesh| &mesh.vertices).map(|corner| {
        let at = panel.sight.clip * Vec3::from(corner.position).extend(1.0);
        0.5 * at.truncate().truncate() / at.w
    });
    corners.fold([Vec2::INFINITY, Vec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
}

/// The share is that of all that a body covers in the course of its scene, for which cameras leave room. All panels have one scale, so it is that
/// of the largest body.
#[test]
fn bodies_take_nearly_half_of_the_width_or_height_of_a_panel() {
    const LEAST: f32 = 0.45;
    for (name, text) in [
        ("fig4b", include_str!("../../scenes/fig4b.toml")),
        ("swing", include_str!("../../scenes/swing.toml")),
        ("damping", include_str!("../../scenes/damping.toml")),
    ] {
        let mut scene = parse(text);
        let runs = all(&scene);
        let history = History::new(&scene, &runs);
        let mut runner = Runner::new(&scene, &runs);
        let frames: Vec<_> = (0..=scene.last_frame()).step_by(3).map(|at| runner.frame(at)).collect();
        for size in SIZES {
            scene.view.size = size;
            let composer = Composer::new(&scene, &history);
            let pictures = frames.iter().map(|frame| composer.compose(frame).panels);
            let boxes = pictures.map(|panels| panels.iter().map(around).collect::<Vec<_>>());
            let union = |[low, high]: [Vec2; 2], [from, to]: [Vec2; 2]| [low.min(from), high.max(to)];
            let all =
                boxes.reduce(|one, other| one.into_iter().zip(other).map(|(one, other)| union(one, other)).collect());
            let shares = all.expect("frames").into_iter().map(|[low, high]| (high - low).max_element());
            let largest = shares.fold(0.0, f32::max);
            assert!(largest >= LEAST, "{name} at {size:?}: {largest}");
        }
    }
}
