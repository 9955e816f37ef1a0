//! Cameras over the whole course of all shipped scenes, tested by the numbers in their pictures. No device
//! is needed.

use super::compose;
use super::listed::{Composer, Listed, corners, heights, parts};
use localshape::picture::Item;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::{Limits, Scene};
use std::path::{Path, PathBuf};

fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).expect("a folder of scenes").map(|entry| entry.expect("an entry").path());
    let mut scenes: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    scenes.sort();
    scenes
}

fn load(path: &Path) -> Scene {
    Scene::load(path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn parse(text: &str) -> Scene {
    Scene::parse(text, "camera.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The whole course of a scene, and its frames at an interval, by a composer that knows the course. It is simulated once.
fn film(scene: &Scene, every: u64) -> (History, Vec<(u64, Listed)>) {
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let mut runner = Runner::new(scene, &runs).with_time_series(scene.time_series().unwrap_or_default());
    let frames = (0..=scene.last_frame()).filter(|frame| frame % every == 0);
    let frames: Vec<_> = frames.map(|frame| (frame, runner.frame(frame))).collect();
    runner.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
    let history = runner.take_history();
    let composer = Composer::new(scene, &history);
    let pictures = frames.iter().map(|(frame, shown)| (*frame, composer.compose(shown))).collect();
    (history, pictures)
}

/// The box around the body of a panel: left, top, right and bottom (px from the panel's left upper corner).
fn outline(picture: &Listed, index: usize) -> Option<[f32; 4]> {
    let panel = &picture.panels[index];
    let [left, top, width, height] = panel.viewport.map(|length| length as f32);
    let around = |all: Option<[f32; 4]>, [x, y]: [f32; 2]| {
        let [a, b, c, d] = all.unwrap_or([x, y, x, y]);
        Some([a.min(x), b.min(y), c.max(x), d.max(y)])
    };
    if panel.sight.flat {
        let is_body = |item: &&Item| match item {
            Item::Clip { items, .. } => {
                ["obstacle", "ground", "floor"].iter().all(|name| parts(items, name).is_empty())
            }
            _ => false,
        };
        let bodies: Vec<_> = picture.under.iter().filter(is_body).collect();
        let parts = ["elements", "turned over", "edges", "strokes"].into_iter();
        let points = parts.flat_map(|name| corners(std::slice::from_ref(bodies[index]), name));
        return points.map(|at| [at.x - left, at.y - top]).fold(None, around);
    }
    let meshes = [&panel.sound, &panel.turned_over].into_iter().flat_map(|mesh| &mesh.vertices);
    let points = meshes.map(|vertex| vertex.position);
    let points = points.chain(panel.strokes.iter().flat_map(|stroke| stroke.ends));
    let lines = panel.lines.iter().filter(|line| (line.kind as u32) < 8).flat_map(|line| [line.from, line.to]);
    points.chain(lines).fold(None, |all, point| {
        let at = panel.sight.clip * glam::Vec3::from(point).extend(1.0);
        let [x, y] = [(0.5 + 0.5 * at.x / at.w) * width, (0.5 - 0.5 * at.y / at.w) * height];
        around(all, [x, y])
    })
}

/// Panels whose camera follows have one scale, in which no moment is cut off and the widest takes about half of the panel's
/// width, or as much as the height of its body permits.
#[test]
fn every_shipped_scene_fills_its_panels_and_cuts_nothing_off() {
    let mut wrong = Vec::new();
    for path in shipped() {
        let scene = load(&path);
        let name = &scene.name;
        let file: toml::Table = std::fs::read_to_string(&path).expect("a file").parse().expect("TOML");
        let camera = file.get("view").and_then(|view| view.get("camera"));
        let is_fixed = camera.is_some_and(|camera| ["target", "distance"].iter().any(|key| camera.get(key).is_some()));
        assert_eq!(scene.view.camera.follow, !is_fixed, "{name}");
        // These fixed cameras show the whole course of a small body, what it passes, the plates of a hand, and a cloth as wide as its panel.
        if ["obstacles", "hare-squeezed", "gap", "cloth-over-ball"].contains(&name.as_str()) {
            continue;
        }
        let (mut widest, mut highest, mut smallest, mut scale) = (0.0_f32, 0.0_f32, f32::INFINITY, None);
        let (history, film) = film(&scene, 5);
        let diverged: Vec<_> = history.series.into_iter().map(|series| series.divergence.is_some()).collect();
        for (frame, picture) in film {
            for (panel, run) in picture.panels.iter().zip(0..) {
                let sides = scene.runs[run].of.iter().map(|&body| scene.bodies[body].side);
                let metre = panel.sight.element / sides.fold(f64::INFINITY, f64::min) as f32;
                let first = *scale.get_or_insert(metre);
                assert!((metre - first).abs() < 1e-4 * first, "{name} {frame}");
                let [width, height] = [panel.viewport[2], panel.viewport[3]].map(|length| length as f32);
                let Some([left, top, right, bottom]) = outline(&picture, run).filter(|_| !diverged[run]) else {
                    continue;
                };
                let is_inside = left >= 0.0 && right <= width && top >= 0.0 && bottom <= height;
                assert!(is_inside && !panel.is_cut, "{name}, run {run}, frame {frame}: {left} {top} {right} {bottom}");
                (widest, highest) = (widest.max((right - left) / width), highest.max((bottom - top) / height));
                smallest = smallest.min((right - left) * (bottom - top) / (width * height));
            }
        }
        let found =
            format!("{name}: width at most {widest:.3}, height at most {highest:.3}, area at least {smallest:.3}");
        println!("{found}");
        // Some bodies are thin, shrink, fly up, or lie beside each other.
        let least = match name.as_str() {
            "chain" | "column" | "elastica" | "six-models" | "stretch" | "three-bodies" | "turning" => 0.02,
            "bridge" | "fig4c" | "free-form-space" | "hare" | "swelling" | "swing" | "volume-kept" => 0.06,
            _ => 0.10,
        };
        // A tall body fills its panel before it is as wide.
        if !((0.45..=0.70).contains(&widest) || highest > 0.5) || smallest < least {
            wrong.push(found);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A tetrahedron grows to 1.9 times its size by the second of two moments, after which the scene goes on.
#[test]
fn recordings_that_end_before_their_scene_are_seen_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (at, size) in [1.0, 1.9].into_iter().enumerate() {
        let points: String = (0..4)
            .map(|axis| {
                let point: [f64; 3] = std::array::from_fn(|at| if at + 1 == axis { size } else { 0.0 });
                format!("v {} {} {}\n", point[0], point[1], point[2])
            })
            .collect();
        std::fs::write(folder.path().join(format!("f{at}.obj")), points + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
            .unwrap();
    }
    let path = folder.path().join("scene.toml");
    let body = "body = { lattice = { cells = [1, 1, 1], side = 0.1 } }\nrun = [{ name = 'R', states = 'f*.obj' }]\n";
    std::fs::write(&path, format!("time = {{ duration = 1.5, frames_per_second = 2 }}\n{body}")).unwrap();
    let (_, pictures) = film(&load(&path), 1);
    assert_eq!(pictures.len(), 4);
    for (frame, picture) in &pictures {
        let [_, _, width, height] = picture.panels[0].viewport.map(|length| length as f32);
        let [left, top, right, bottom] = outline(picture, 0).expect("a body");
        assert!(
            left >= 0.0 && top >= 0.0 && right <= width && bottom <= height,
            "{frame}: {left} {top} {right} {bottom}"
        );
    }
}

#[test]
fn a_frame_drawn_alone_is_that_of_its_sequence() {
    let scene = load(&shipped().into_iter().find(|path| path.ends_with("mixed.toml")).expect("a scene"));
    for (frame, picture) in film(&scene, 50).1 {
        let composer = Composer::new(&scene, &History::new(&scene, &[0, 1]));
        assert_eq!(composer.compose(&Runner::new(&scene, &[0, 1]).frame(frame)), picture, "{frame}");
    }
}

/// The wall of a course of obstacles has the same size in all panels and frames.
#[test]
fn plates_are_drawn_alike_in_all_panels_and_frames() {
    let scene = load(&shipped().into_iter().find(|path| path.ends_with("obstacles.toml")).expect("a scene"));
    let (_, film) = film(&scene, 20);
    let first = &film[0].1.panels[0].obstacles.panes;
    assert!(!first.is_empty());
    for (frame, picture) in &film {
        assert!(picture.panels.iter().all(|panel| panel.obstacles.panes == *first), "{frame}");
    }
}

#[test]
fn panels_are_arranged_so_that_bodies_are_largest() {
    let mut scene = load(&shipped().into_iter().find(|path| path.ends_with("springs.toml")).expect("a scene"));
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let frame = Runner::new(&scene, &runs).frame(0);
    for size in [[1280, 720], [2400, 500], [600, 1600], [1000, 1000]] {
        scene.view.size = size;
        let mut element = |columns: Option<usize>| {
            scene.view.columns = columns;
            compose(&scene, &frame).panels[0].sight.element
        };
        let chosen = element(None);
        let largest = [1, 2, 3, 6].map(|columns| element(Some(columns))).into_iter().fold(0.0, f32::max);
        assert!(chosen >= 0.97 * largest, "{size:?}: {chosen} of {largest}");
    }
}

#[test]
fn what_leaves_its_panel_is_known() {
    let with = |camera: &str| {
        parse(&format!(
            "time = {{ duration = 0.1, frames_per_second = 10 }}
            body.lattice = {{ cells = [2, 1, 1], side = 0.1 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            view.camera = {{ {camera} }}"
        ))
    };
    for (camera, cut) in
        [("", false), ("target = [0, 0, 0]", false), ("target = [2, 0, 0]", true), ("distance = 0.3", true)]
    {
        let scene = with(camera);
        let picture = compose(&scene, &Runner::new(&scene, &[0]).frame(0));
        assert_eq!(picture.panels[0].is_cut, cut, "{camera}");
    }
}

/// A following camera shows an obstacle near the body whole, if the body gets at most a fifth smaller for it.
#[test]
fn bodies_leave_room_to_obstacles_near_them() {
    let seen = |obstacle: &str| {
        let scene = parse(&format!(
            "time = {{ duration = 0.1, frames_per_second = 10 }}
            body.lattice = {{ cells = [2, 2, 2], side = 0.1 }}
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            obstacle = [{obstacle}]
            view.camera.azimuth = 0.541"
        ));
        film(&scene, 1).1.swap_remove(0).1
    };
    let alone = seen("");
    for ball in ["centre = [0.16, 0.1, 0], radius = 0.04", "centre = [0.20, 0.1, 0], radius = 0.08"] {
        let beside = seen(&format!("{{ kind = 'sphere', {ball} }}"));
        let panel = &beside.panels[0];
        let smaller = panel.sight.element / alone.panels[0].sight.element;
        assert!((0.8..=1.0).contains(&smaller), "{ball}: {smaller}");
        let corners = panel.obstacles.solids[0].mesh.vertices.iter();
        for at in corners.map(|corner| panel.sight.clip * glam::Vec3::from(corner.position).extend(1.0)) {
            assert!(at.x.abs() <= at.w && at.y.abs() <= at.w, "{ball}: {at}");
        }
    }
}

/// Where all runs hold nodes to their end, held nodes have one place in all panels and frames.
#[test]
fn held_bodies_are_seen_by_one_camera() {
    let pins = |hold: &str| {
        let scene = parse(&format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = 0.5, frames_per_second = 20 }}
            body.lattice = {{ cells = [4, 1, 1], side = 0.1 }}
            hold = [{{ nodes = 'left'{hold} }}]
            run = [
                {{ name = 'stiff', model = {{ kind = 'shape-based', stiffness = 1e4 }} }},
                {{ name = 'soft', model = {{ kind = 'shape-based', stiffness = 1e3 }} }},
            ]"
        ));
        let of_panel = |picture: &Listed, at: usize| {
            let [left, top, width, height] = picture.panels[at].viewport.map(|length| length as f32);
            let is_inside = |[x, y]: [f32; 2]| x >= left && x < left + width && y >= top && y < top + height;
            let pins = picture.marks.iter().filter(|mark| mark.shape == "pin").map(|mark| mark.rectangle);
            let pins = pins.filter(|&[x, y, ..]| is_inside([x, y]));
            pins.map(|[x, y, ..]| [(x - left).round() as i32, (y - top).round() as i32]).collect::<Vec<_>>()
        };
        let (_, film) = film(&scene, 5);
        film.iter().flat_map(|(_, picture)| [0, 1].map(|at| of_panel(picture, at))).collect::<Vec<_>>()
    };
    let held = pins("");
    assert!(held[0].len() == 4 && held.iter().all(|pins| *pins == held[0]), "{held:?}");
    let released = pins(", until = 0.3");
    assert!(released[0].len() == 4 && released[2] != released[3], "cameras follow: {released:?}");
}

/// So has one near the ground where words hide the ground: in Fig. 4(a) only one of two bodies rests at the end.
#[test]
fn heights_are_told_where_words_hide_the_ground() {
    let scene = parse(include_str!("../../scenes/fig4a.toml"));
    let mut runner = Runner::new(&scene, &[0, 1]);
    let picture = Composer::new(&scene, &History::for_pictures(&scene, &[0, 1])).compose(&runner.frame(300));
    let said: Vec<_> = heights(&picture).into_iter().map(|run| run.text.as_str()).collect();
    assert!(matches!(said[..], [one] if one.ends_with(" mm up")), "{said:?}");
}

/// A body that flies high before a camera that follows it has its height beside it.
#[test]
fn heights_are_told_where_the_camera_hides_them() {
    let words = |body: &str, more: &str| {
        let scene = parse(&format!(
            "time = {{ duration = 0.1, frames_per_second = 10 }}
            body = {{ lattice = {{ cells = [1, 1, 1], side = 0.2 }}, {body} }}
            obstacle = [{{ kind = 'floor' }}]
            run = [{{ name = 'one', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            {more}"
        ));
        let picture = film(&scene, 1).1.swap_remove(0).1;
        let said: Vec<_> = heights(&picture).into_iter().map(|run| run.text.clone()).collect();
        assert!(said.len() < 2, "{said:?}");
        said.concat()
    };
    assert_eq!(words("lowest = 1.25", ""), "1.25 m up");
    for (body, more) in [
        ("lowest = 0.05", ""),
        ("lowest = 1.25", "view.camera = { target = [0, 1, 0], distance = 5 }"),
        ("lowest = 1.25", "hold = [{ nodes = 'top' }]"),
        ("lowest = 1.25", "view.labels = ['name']"),
    ] {
        assert_eq!(words(body, more), "", "{body} {more}");
    }
}
