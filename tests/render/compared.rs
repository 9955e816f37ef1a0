//! Ghosts and paths of bodies.

use super::listed::{Composer, Curve, Listed, compose_figure};
use super::{fig4b, unknown};
use localshape::look::{Ghost, Style, Theme, Traced};
use localshape::picture::{Panel, TextRun};
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;
use localshape::scene::{Limits, Scene};
use localshape::sim::Status;

/// The dashed curves of a colour.
fn outlines(picture: &Listed, colour: [u8; 3]) -> Vec<&Curve> {
    let is_dashed = |curve: &&Curve| curve.colour == colour && curve.dash.len() == 2 && curve.points.len() > 2;
    picture.curves.iter().filter(is_dashed).collect()
}

fn inside(panel: [u32; 4], point: [f32; 2]) -> bool {
    let [left, top, width, height] = panel.map(|length| length as f32);
    (left..=left + width).contains(&point[0]) && (top..=top + height).contains(&point[1])
}

/// Whether a curve is cut off at the words of a panel, and begins and ends there if it leaves them.
fn is_between_words(curve: &Curve, panel: &Panel, picture: &Listed) -> bool {
    let Some([left, top, width, height]) = curve.room else { return false };
    let around = panel.viewport.map(|length| length as f32);
    let words = picture.words.iter().filter(|run| inside(panel.viewport, [run.span[0], run.baseline]));
    let is_apart = |run: &TextRun| run.baseline <= top || run.baseline - 0.7 * run.size >= top + height;
    let is_near = |&[x, y]: &[f32; 2]| {
        (left - 40.0..=left + width + 40.0).contains(&x) && (top - 40.0..=top + height + 40.0).contains(&y)
    };
    [left, width] == [around[0], around[2]]
        && words.into_iter().all(is_apart)
        && height > 0.5 * around[3]
        && curve.points.iter().all(is_near)
}

#[test]
fn a_ghost_has_the_colour_of_its_run_and_is_not_in_its_own_panel() {
    let (mut scene, frame) = fig4b(4);
    for theme in [Theme::Light, Theme::Dark] {
        scene.view.look = Style::of(theme);
        let palette = scene.view.look.palette();
        for (ghost, colour, panels) in [
            (Ghost::Run(0), scene.runs[0].line(&palette).colour, vec![1]),
            (Ghost::Run(1), scene.runs[1].line(&palette).colour, vec![0]),
            (Ghost::Rest, palette.second_text, vec![0, 1]),
        ] {
            scene.view.ghost = Some(ghost);
            let picture = unknown(&scene).compose(&frame);
            let found = outlines(&picture, colour);
            assert!(!found.is_empty());
            let is_clear = |curve: &Curve| picture.panels.iter().any(|panel| is_between_words(curve, panel, &picture));
            assert!(found.iter().all(|curve| is_clear(curve)), "{ghost:?}");
            let of = |curve: &Curve| picture.panels.iter().position(|panel| inside(panel.viewport, curve.points[0]));
            let mut has: Vec<_> = found.iter().map(|curve| of(curve).expect("in a panel")).collect();
            has.dedup();
            assert_eq!(has, panels, "{ghost:?}");
            // The key names the run of the outline.
            let name = if let Ghost::Run(run) = ghost { &scene.runs[run].name } else { "rest shape" };
            let straight = picture.curves.iter().filter(|curve| curve.points.len() == 2 && curve.colour == colour);
            let height = straight.map(|curve| curve.points[0][1]).fold(0.0, f32::max);
            let mut words = picture.words.iter().filter(|run| (run.baseline - height).abs() < 8.0);
            assert!(words.any(|run| run.text.starts_with(name)), "{ghost:?}");
        }
    }
    scene.view.ghost = None;
    assert!(unknown(&scene).compose(&frame).curves.is_empty());
}

/// Without its run there is no ghost, and nothing else changes.
#[test]
fn a_frame_without_the_run_of_the_ghost_has_none() {
    let (mut scene, frame) = fig4b(4);
    scene.view.ghost = Some(Ghost::Run(0));
    let alone = Frame { runs: vec![frame.runs[1].clone()], ..frame };
    let picture = unknown(&scene).compose(&alone);
    assert!(picture.curves.iter().all(|curve| curve.points.len() == 2), "the sample of the key alone");
}

/// A contact sheet of `scenes/fig4b.toml`, whose view begins with further keys.
fn sheet(view: &str, keys: &str) -> Figure {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = include_str!("../../scenes/fig4b.toml").replace("[view]\n", &format!("[view]\n{view}\n"));
    std::fs::write(folder.path().join("scene.toml"), scene).expect("a file");
    let file = folder.path().join("figure.toml");
    std::fs::write(&file, format!("[sheet]\nscene = 'scene.toml'\n{keys}")).expect("a file");
    Figure::load(&file, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A sheet outlines a run that none of its rows shows.
#[test]
fn sheets_have_ghosts_too() {
    let figure = sheet("ghost = 'Local shape'", "moments = [0.03, 0.05]\n[[sheet.row]]\nrun = 'Mass-spring'\n");
    let moments = Moments::new(&figure);
    let other = moments.others[0][1].first().expect("the ghost's run");
    assert_eq!((other.run, other.snapshot.time), (0, moments.cells[0][1].snapshot.time));
    let picture = compose_figure(&figure, &moments).expect("there is room");
    let colour = figure.scenes()[0].runs[0].line(&picture.palette).colour;
    for panel in &picture.panels {
        assert!(outlines(&picture, colour).iter().any(|curve| inside(panel.viewport, curve.points[0])));
    }
}

/// The pixel of a point of a panel.
fn seen(panel: &Panel, at: [f32; 3]) -> [f32; 2] {
    let clip = panel.sight.clip * glam::Vec3::from(at).extend(1.0);
    let [left, top, width, height] = panel.viewport.map(|length| length as f32);
    [left + width * (0.5 + 0.5 * clip.x / clip.w), top + height * (0.5 - 0.5 * clip.y / clip.w)]
}

#[test]
fn paths_end_where_bodies_are_and_begin_where_they_started() {
    let (mut scene, _) = fig4b(0);
    scene.duration = 0.2;
    (scene.view.camera.follow, scene.view.camera.distance) = (false, 2.0 * scene.view.camera.distance);
    scene.view.paths = vec![Traced::Centre, Traced::Node(63)];
    let mut runner = Runner::new(&scene, &[0, 1]);
    let frames = [0, 3, 9].map(|index| runner.frame(index));
    let history = History::new(&scene, &[0, 1]);
    let composer = Composer::new(&scene, &history);
    let mut longest = 0;
    for frame in &frames {
        let picture = composer.compose(frame);
        let palette = &picture.palette;
        for (run, panel) in frame.runs.iter().zip(&picture.panels) {
            let colour = scene.runs[run.run].line(palette).colour;
            let here = |curve: &&Curve| curve.colour == colour && inside(panel.viewport, curve.points[0]);
            let of_run: Vec<_> = picture.curves.iter().filter(here).collect();
            assert!(of_run.iter().all(|curve| is_between_words(curve, panel, &picture)));
            let (dots, lines): (Vec<_>, Vec<_>) = of_run.into_iter().partition(|curve| curve.points.len() == 1);
            assert_eq!(dots.len(), 2);
            // The dot of the node lies on a corner of the body, the dot of the centre inside of all corners.
            let vertices = panel.sound.vertices.iter().chain(&panel.turned_over.vertices);
            let pixels: Vec<_> = vertices.map(|vertex| seen(panel, vertex.position)).collect();
            let off = |[x, y]: [f32; 2]| {
                let far = pixels.iter().map(|pixel| (pixel[0] - x).abs().max((pixel[1] - y).abs()));
                far.fold(f32::INFINITY, f32::min)
            };
            let [centre, node] = dots[..] else { panic!("two dots") };
            assert!(off(node.points[0]) < 0.05, "frame {}: {}", frame.index, off(node.points[0]));
            for axis in 0..2 {
                let (low, high) = pixels
                    .iter()
                    .fold((f32::INFINITY, 0.0_f32), |(low, high), pixel| (low.min(pixel[axis]), high.max(pixel[axis])));
                assert!((low..high).contains(&centre.points[0][axis]));
            }
            for dot in [centre, node] {
                assert!(frame.index == 0 || lines.iter().any(|line| line.points.last() == dot.points.last()));
            }
            longest = longest.max(lines.iter().map(|line| line.points.len()).max().unwrap_or(0));
        }
        assert!(picture.words.iter().any(|run| run.text.starts_with("paths: centre")));
        let alone = Composer::new(&scene, &history);
        assert_eq!(alone.compose(frame), picture);
    }
    assert!(longest > 10, "{longest}");
    // Without the time series there are no paths.
    assert_eq!(unknown(&scene).compose(&frames[1]).curves.len(), 0);
}

#[test]
fn sheets_have_paths() {
    let figure = sheet("paths = ['centre']", "moments = [0.0, 0.05]\n");
    let moments = Moments::new(&figure);
    let ends = moments.histories[0].series.iter().map(|series| *series.times.last().expect("a start"));
    assert!(ends.into_iter().all(|end| (0.04..0.06).contains(&end)), "paths end with the last cell");
    let picture = compose_figure(&figure, &moments).expect("there is room");
    for (at, panel) in picture.panels.iter().enumerate() {
        let colour = figure.scenes()[0].runs[at / 2].line(&picture.palette).colour;
        let here = |curve: &&Curve| curve.colour == colour && inside(panel.viewport, curve.points[0]);
        let (dots, lines): (Vec<_>, Vec<_>) = picture.curves.iter().filter(here).partition(|one| one.points.len() == 1);
        assert_eq!((dots.len(), lines.is_empty()), (1, at % 2 == 0), "{at}");
    }
    assert!(picture.words.iter().any(|run| run.text == "path of the centre"));
}

/// Bars have no faces: each is a dashed line.
#[test]
fn bodies_of_bars_have_ghosts() {
    let text = include_str!("../../scenes/chain.toml");
    let mut scene = Scene::parse(text, "chain.toml", &Limits::default()).expect("the shipped scene is sound");
    scene.view.ghost = Some(Ghost::Rest);
    let frame = Runner::new(&scene, &[0]).frame(0);
    let picture = unknown(&scene).compose(&frame);
    let is_ghost = |curve: &&Curve| curve.colour == picture.palette.second_text && curve.dash.len() == 2;
    // Eight bars and the weight at their end; and the sample of the key.
    let counts: Vec<_> = picture.curves.iter().filter(is_ghost).map(|curve| curve.points.len()).collect();
    assert!(counts.len() == 2 && counts.iter().sum::<usize>() >= 14, "{counts:?}");
}

#[test]
fn what_finds_no_room_is_known() {
    let (mut scene, _) = fig4b(0);
    assert_eq!(localshape::picture::left_out(&scene), Vec::<String>::new());
    // A title has at most four lines.
    scene.view.title = "A title that goes on and on ".repeat(20);
    assert_eq!(localshape::picture::left_out(&scene), ["the title is cut off"]);
    // Narrow panels have no scale bar.
    let text = include_str!("../../scenes/fig4b.toml");
    let mut narrow = Scene::parse(text, "fig4b.toml", &Limits::default()).expect("the shipped scene is sound");
    (narrow.view.size, narrow.view.columns) = ([300, 800], Some(2));
    let told = localshape::picture::left_out(&narrow);
    assert!(told.iter().any(|text| text == "the scale bar is left out"), "{told:?}");
    let title =
        |picture: &Listed| picture.words.iter().filter(|run| run.size > 28.0).map(|run| run.text.clone()).collect();
    let lines: Vec<String> = title(&unknown(&scene).compose(&Runner::new(&scene, &[0, 1]).frame(0)));
    assert!(lines.last().is_some_and(|line| line.ends_with('…')), "{lines:?}");
}

/// A scene of Fig. 4(b) coloured by the distance to a run.
fn measured(to: &str) -> Scene {
    let view = format!("[view]\ncolour = {{ by = 'distance', to = '{to}', range = [0, 2] }}\n");
    let text = include_str!("../../scenes/fig4b.toml").replace("[view]\n", &view);
    Scene::parse(&text, "scene", &Limits::default()).expect("a scene")
}

#[test]
fn the_distance_to_another_run_is_a_field() {
    let scene = measured("Mass-spring");
    let mut frame = Runner::new(&scene, &[0, 1]).frame(4);
    let [one, other] = [0, 1].map(|run: usize| &frame.runs[run].snapshot);
    let nodes = one.position.iter().zip(&other.position);
    let expected: Vec<_> = nodes.map(|(one, other)| one.distance(*other)).collect();
    assert_eq!((&one.field, &other.field), (&expected, &Vec::new()), "the run itself has no values");
    let picture = unknown(&scene).compose(&frame);
    assert!(picture.panels[0].sound.shades.iter().all(|&shade| shade >= 0.0));
    assert!(picture.panels[1].sound.shades.iter().all(|&shade| shade < 0.0), "it is plain");
    assert!(picture.words.iter().any(|word| word.text == "distance to Mass-spring"));
    // Bodies at one place are at its low end, and bodies apart by half the range in its middle.
    let other = frame.runs[1].clone();
    for (shift, expected) in [(0.0, 0.0), (1.0, 0.5)] {
        let shifted = other.snapshot.position.iter().map(|&at| at + shift * glam::DVec3::Y).collect();
        frame.runs[0].snapshot.position = shifted;
        frame.runs[0].measure(&other);
        let shades = &unknown(&scene).compose(&frame).panels[0].sound.shades;
        assert!(shades.iter().all(|&shade| (shade - expected).abs() < 1e-6), "{shift}: {shades:?}");
    }
    assert!(picture.words.iter().any(|word| word.text.contains("that run is plain")));
    // Without the other run, all are plain.
    let alone = Runner::new(&scene, &[0]).frame(4);
    assert!(alone.runs[0].snapshot.field.is_empty());
}

/// A run that diverges is shown as it was, so there is no distance to its present state.
#[test]
fn there_is_no_distance_to_a_state_that_is_not_shown() {
    let view = "[view]\ncolour = { by = 'distance', to = 'As printed' }\n";
    let text = include_str!("../../scenes/explicit-euler.toml").replace("[view]\n", view);
    let scene = Scene::parse(&text, "scene", &Limits::default()).expect("a scene");
    let mut runner = Runner::new(&scene, &[0, 2]);
    let frames = (0..=scene.last_frame()).map(|index| runner.frame(index));
    let mut sound = [0; 2];
    for frame in frames {
        let [run, other] = &frame.runs[..] else { panic!("two runs") };
        let is_shown = other.last_fit.is_none();
        assert_eq!(run.snapshot.field.is_empty(), !is_shown, "frame {}", frame.index);
        sound[usize::from(is_shown)] += usize::from(other.snapshot.status == Status::Ok);
    }
    assert!(sound[0] > 0 && sound[1] > 0, "it is not shown before it diverges: {sound:?}");
}

/// A sheet measures the distance to a run that none of its rows shows.
#[test]
fn sheets_show_distances_too() {
    let colour = "colour = { by = 'distance', to = 'Mass-spring' }";
    let figure = sheet("", &format!("moments = [0.0, 0.05]\n{colour}\n[[sheet.row]]\nrun = 'Local shape'\n"));
    let cells = &Moments::new(&figure).cells[0];
    assert!(cells[0].snapshot.field.iter().all(|&distance| distance == 0.0) && !cells[0].snapshot.field.is_empty());
    assert!(cells[1].snapshot.field.iter().all(|&distance| distance > 0.0));
}
