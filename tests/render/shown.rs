//! The contents of pictures, tested by their numbers: no device needed.

use super::listed::{Composer, Listed, Mark, corners};
use super::{compose, fig4b, frame, parse, unknown};
use localshape::colour::contrast;
use localshape::look::{ColourMap, ColourScale, Palette, Theme};
use localshape::picture::winding;
use localshape::picture::{LineKind, Mesh, TextRun, Weight};
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::{Limits, Scene};
use localshape::sim::{Assembly, Body, Divergence, Field, Status};
use std::collections::HashMap;

/// A scene with other cells, runs and view.
fn scene(change: impl Fn(String) -> String) -> (Scene, Frame) {
    let text = change(super::plain());
    let scene = parse(&text);
    let frame = frame(&scene, 0);
    (scene, frame)
}

/// Every number in a picture.
fn numbers(picture: &Listed) -> Vec<f32> {
    let mut all = Vec::new();
    for panel in &picture.panels {
        all.extend(panel.sight.clip.to_cols_array());
        all.extend(panel.sight.eye.to_array());
        all.extend([panel.sight.near, panel.sight.focal, panel.sight.element, panel.sight.soft]);
        for mesh in [&panel.sound, &panel.turned_over] {
            all.extend(mesh.vertices.iter().flat_map(|v| [v.position, v.normal].concat()));
        }
        all.extend(panel.lines.iter().flat_map(|line| [line.from, line.to].concat()));
    }
    all.extend(picture.words.iter().flat_map(|run| run.span));
    all
}

/// The signed volume of a closed surface: the sum of the volumes of tetrahedra from the origin.
fn volume(mesh: &Mesh) -> f32 {
    let at = |index: u32| glam::Vec3::from(mesh.vertices[index as usize].position);
    mesh.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

/// Whether each edge of the triangles occurs equally often in both directions.
fn is_closed(mesh: &Mesh) -> bool {
    let mut balance: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    let place = |index: u32| mesh.vertices[index as usize].position.map(|x| (x * 1e4).round().to_bits());
    for triangle in &mesh.triangles {
        for at in 0..3 {
            let [a, b] = [place(triangle[at]), place(triangle[(at + 1) % 3])];
            let (key, sign) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *balance.entry(key).or_default() += sign;
        }
    }
    balance.values().all(|&sum| sum == 0)
}

#[test]
fn both_sets_are_closed_surfaces_that_look_outward() {
    let (scene, mut frame) = fig4b(0);
    let snapshot = &mut frame.runs[1].snapshot;
    // The lowest layer of the 27 cubes: those with the lowest centres.
    let height = |element: usize| -> f64 {
        scene.bodies[0].body.elements()[element].iter().map(|&node| scene.bodies[0].body.rest()[node as usize].y).sum()
    };
    let mut order: Vec<_> = (0..27).collect();
    order.sort_by(|&a, &b| height(a).total_cmp(&height(b)));
    for &element in &order[..9] {
        snapshot.turned_over[element] = true;
    }
    let picture = compose(&scene, &frame);
    let panel = &picture.panels[1];
    // Faces of a 3×3×2 and a 3×3×1 block, two triangles each.
    assert_eq!(panel.sound.triangles.len(), 2 * (2 * 9 + 4 * 6));
    assert_eq!(panel.turned_over.triangles.len(), 2 * (2 * 9 + 4 * 3));
    assert!(is_closed(&panel.sound) && is_closed(&panel.turned_over));
    assert!((volume(&panel.sound) - 18.0).abs() < 1e-2, "{}", volume(&panel.sound));
    assert!((volume(&panel.turned_over) - 9.0).abs() < 1e-2, "{}", volume(&panel.turned_over));
    assert!(panel.lines.iter().any(|line| line.kind == LineKind::AlarmEdge));
    assert!(picture.panels[0].turned_over.triangles.is_empty());
    assert!(picture.words.iter().any(|run| run.text == "9 of 27"));
}

#[test]
fn a_cube_from_the_corner_has_six_contour_edges() {
    let (scene, frame) = scene(|text| text.replace("cells = [3, 3, 3]", "cells = [1, 1, 1]"));
    let picture = compose(&scene, &frame);
    let count = |kind| picture.panels[0].lines.iter().filter(|line| line.kind == kind).count();
    assert_eq!(count(LineKind::Edge), 12);
    assert_eq!(count(LineKind::Contour), 6);
}

#[test]
fn words_keep_inside_their_panels_and_apart() {
    let long = "A name that is far too long for any panel, and then some more of it 龍龍龍";
    for size in [[1280, 720], [640, 360], [720, 1280], [300, 200], [64, 64], [8192, 700]] {
        for columns in [1, 2] {
            let (mut scene, frame) = scene(|text| {
                text.replace("\"Mass-spring\"", &format!("{long:?}"))
                    .replace("[view]", &format!("[view]\npanels = {columns}"))
            });
            scene.view.size = size;
            scene.view.clock = long.to_owned();
            let picture = compose(&scene, &frame);
            let top = picture.panels.iter().map(|panel| panel.viewport[1]).min().expect("panels") as f32;
            for run in &picture.words {
                // A clock without room beside the name stands above the panels.
                let above = run.baseline < top + 14.0 && run.span[0] >= 0.0 && run.span[1] <= size[0] as f32;
                let inside = above
                    || picture.panels.iter().any(|panel| {
                        let [left, top, width, height] = panel.viewport.map(|length| length as f32);
                        left <= run.span[0]
                            && run.span[1] <= left + width
                            && top < run.baseline - 0.7 * run.size
                            && run.baseline < top + height
                    });
                assert!(inside, "{size:?} {columns}: {run:?}");
            }
            for (at, one) in picture.words.iter().enumerate() {
                for other in &picture.words[..at] {
                    let beside = one.span[1] <= other.span[0] || other.span[1] <= one.span[0];
                    let apart = (one.baseline - other.baseline).abs() >= 0.9 * one.size.min(other.size);
                    assert!(beside || apart, "{size:?} {columns}: `{}` and `{}`", one.text, other.text);
                }
            }
        }
    }
}

#[test]
fn words_do_not_move_from_frame_to_frame() {
    let (scene, _) = fig4b(0);
    let composer = unknown(&scene);
    let mut runner = Runner::new(&scene, &[0, 1]);
    let mut ends = Vec::new();
    for index in [0, 3, 7, 40] {
        let picture = composer.compose(&runner.frame(index));
        let run = |text: &str| picture.words.iter().find(|run| run.text.ends_with(text)).unwrap().clone();
        let (clock, count) = (run(" ms"), run("of 27"));
        ends.push((picture.words[0].span, clock.span[1], clock.baseline, count.span[0]));
    }
    assert!(ends.windows(2).all(|two| two[0] == two[1]), "{ends:?}");
}

#[test]
fn a_run_that_blew_up_says_when() {
    let (scene, mut frame) = fig4b(0);
    let snapshot = &mut frame.runs[1].snapshot;
    snapshot.status = Status::Diverged(Divergence { time: 0.0351, step: 7, part: 0, element: Some(3), is_end: false });
    snapshot.position[0] *= 1e300;
    snapshot.position[9].x = f64::MAX;
    snapshot.diagnostics.shape_error = f64::INFINITY;
    let picture = compose(&scene, &frame);
    let said = picture.words.iter().find(|run| run.text == "diverges").expect("the word");
    assert!(picture.words.iter().any(|run| run.text == "at 35 ms"));
    assert!(said.weight == Weight::SemiBold && said.colour == picture.palette.text && said.size >= 16.0);
    let beside = |run: &&TextRun| (run.baseline - said.baseline).abs() < 5.0 && run.span[0] >= 640.0 && *run != said;
    assert!(picture.words.iter().filter(beside).all(|run| run.span[1] < said.span[0]));
    assert!(numbers(&picture).iter().all(|number| number.is_finite()));
    // It does not move the camera: the other panel is unchanged.
    assert_eq!(picture.panels[0].sight.eye, compose(&scene, &fig4b(0).1).panels[0].sight.eye);
}

#[test]
fn one_to_six_panels_find_their_place() {
    let (mut scene, frame) = fig4b(0);
    for count in 1..=6 {
        for columns in 1..=4 {
            scene.view.columns = Some(columns);
            let runs = (0..count).map(|at| frame.runs[at % 2].clone()).collect();
            let picture = compose(&scene, &Frame { runs, ..frame.clone() });
            assert_eq!(picture.panels.len(), count);
            let clocks = picture.words.iter().filter(|run| run.text == "0 ms").count();
            assert_eq!(clocks, 1, "{count} panels, {columns} columns");
            for panel in &picture.panels {
                let ([x, y, w, h], [left, top, width, height]) = (panel.region, panel.viewport);
                assert!(left <= x && top <= y && x + w <= left + width && y + h <= top + height);
            }
        }
    }
}

#[test]
fn a_frame_without_runs_is_an_empty_picture() {
    let (scene, frame) = fig4b(0);
    let picture = compose(&scene, &Frame { runs: Vec::new(), ..frame });
    assert!(picture.panels.is_empty() && picture.words.is_empty());
}

#[test]
fn many_elements_are_counted_in_a_bar() {
    let (scene, mut frame) = scene(|text| text.replace("cells = [3, 3, 3]", "cells = [8, 8, 8]"));
    frame.runs[0].snapshot.turned_over[5] = true;
    let picture = compose(&scene, &frame);
    // A hairline, a bar and its alarmed part, and another bar; the scale bar and its ticks.
    assert_eq!(picture.marks.len(), 4 + 3);
    assert!(picture.words.iter().any(|run| run.text == "1 of 512"));
}

#[test]
fn few_elements_are_counted_in_squares() {
    let (scene, frame) = fig4b(0);
    let picture = compose(&scene, &frame);
    assert_eq!(picture.marks.len(), 1 + 2 * 27 + 3);
}

/// The scene of Fig. 4(b) with all lengths and speeds times a factor.
fn scaled(factor: f64) -> (Scene, Frame) {
    let (mut scene, mut frame) = fig4b(4);
    let body = &scene.bodies[0].body;
    let scaled = Body::builder(body.rest().iter().map(|&at| at * factor).collect()).dimension(body.dimension());
    let body = scaled.elements(body.elements().clone()).masses(body.mass().to_vec()).build().expect("a body");
    let bodies = std::sync::Arc::new(Assembly::new(vec![std::sync::Arc::new(body)]));
    for run in &mut scene.runs {
        run.bodies = bodies.clone();
        run.initial.position.iter_mut().chain(&mut run.initial.velocity).for_each(|at| *at *= factor);
    }
    (scene.view.side, scene.bodies[0].side) = (factor * scene.view.side, factor * scene.bodies[0].side);
    scene.view.camera.target *= factor;
    scene.view.camera.distance *= factor;
    for run in &mut frame.runs {
        run.snapshot.position.iter_mut().chain(&mut run.snapshot.velocity).for_each(|at| *at *= factor);
    }
    (scene, frame)
}

#[test]
fn a_picture_is_the_same_in_any_unit_of_length() {
    let (scene, frame) = fig4b(4);
    let expected = compose(&scene, &frame);
    for factor in [1e-6, 1e-5, 0.1, 1.0, 1e3, 1e6] {
        let (scene, frame) = scaled(factor);
        let picture = compose(&scene, &frame);
        for (panel, expected) in picture.panels.iter().zip(&expected.panels) {
            let rows = |panel: &localshape::picture::Panel| panel.sight.clip.to_cols_array();
            for (a, b) in rows(panel).into_iter().zip(rows(expected)) {
                assert!((a - b).abs() <= 1e-5 * b.abs().max(1.0), "{factor}: {a} for {b}");
            }
            let near = [panel.sight.near, expected.sight.near];
            assert!((near[0] / near[1] - 1.0).abs() < 1e-5, "{factor}: {near:?}");
            assert_eq!(panel.region, expected.region, "{factor}");
            assert_eq!(panel.lines.len(), expected.lines.len(), "{factor}");
            for (a, b) in panel.lines.iter().zip(&expected.lines) {
                let apart = |a: [f32; 3], b: [f32; 3]| glam::Vec3::from(a).distance(glam::Vec3::from(b));
                assert!(a.kind == b.kind && apart(a.from, b.from).max(apart(a.to, b.to)) < 1e-4, "{factor}: {a:?}");
                // The compared point is in front of the near plane.
                let distance = |point: [f32; 3]| (panel.sight.clip * glam::Vec3::from(point).extend(1.0)).w;
                assert!(distance(a.from) > panel.sight.near && distance(a.to) > panel.sight.near, "{factor}");
            }
        }
    }
}

#[test]
fn lines_of_large_bodies_in_the_plane_are_before_the_near_plane() {
    let text = "time = { duration = 1, step = 'T/50', frames_per_second = 60 }
        body = { lattice = { cells = [60, 4], side = 0.01 } }
        [[run]]
        name = 'a'
        model = { kind = 'shape-based', stiffness = 1e3 }";
    let scene = parse(text);
    let sight = compose(&scene, &Runner::new(&scene, &[0]).frame(0)).panels[0].sight;
    assert!(sight.near < sight.clip.w_axis.w, "{sight:?}");
}

#[test]
fn every_floor_of_the_plane_is_drawn_and_stays_in_its_panel() {
    let floor = |normal: &str| format!("[[obstacle]]\nkind = 'floor'\nnormal = {normal}\nheight = -0.3\n");
    let normals = ["[0, 1]", "[1, 1]", "[-1, 3]", "[1, 0]", "[-1, 0]", "[0, -1]", "[2, -1]"];
    for normal in normals {
        let text = format!(
            "time = {{ duration = 1, step = 'T/50', frames_per_second = 60 }}
            [body]
            lattice = {{ cells = [3, 3], side = 0.1 }}
            [[run]]
            name = 'a'
            model = {{ kind = 'shape-based', stiffness = 1e3 }}
            {}[view.camera]
            target = [0, 0]
            distance = 4",
            floor(normal)
        );
        let scene = parse(&text);
        let picture = compose(&scene, &Runner::new(&scene, &[0]).frame(0));
        for shape in ["floor", "ground"] {
            assert_eq!(picture.floors.iter().filter(|mark| mark.shape == shape).count(), 1, "{normal}");
        }
        let Some(obstacle) = scene.obstacles.first() else { panic!("{normal}") };
        let Some((out, height)) = obstacle.floor(0.0) else { panic!("{normal}") };
        // Slopes and walls run on behind words, which have halos there.
        let is_slope = out.y.abs() < 0.999;
        assert_eq!(picture.words.iter().all(|word| word.has_halo), is_slope, "{normal}");
        for mark in &picture.floors {
            let [left, top, width, depth] = mark.rectangle;
            let [x, y] = mark.along;
            // A slope or a wall ends beyond the borders of its panel, in which it is clipped.
            let corners = [(0.0, 0.0), (width, 0.0), (0.0, depth), (width, depth)];
            let corners = corners.map(|(across, down)| [left + across * x - down * y, top + across * y + down * x]);
            let inside = corners.iter().filter(|at| (0.0..=1280.0).contains(&at[0]) && (0.0..=720.0).contains(&at[1]));
            let expected = if is_slope { 0 } else { 4 };
            assert!(inside.count() == expected || mark.shape == "shadow", "{normal} {mark:?}");
            // Its solid side lies against the normal, and its line on the floor.
            assert!((glam::DVec2::new((-y).into(), x.into()) - glam::DVec2::new(-out.x, out.y)).length() < 1e-5);
            let sight = picture.panels[0].sight;
            let at = |pixel: [f32; 2]| {
                let [x, y] = [pixel[0] / 640.0 - 1.0, 1.0 - pixel[1] / 360.0];
                let clip = sight.clip;
                let point = [(x - clip.w_axis.x) / clip.x_axis.x, (y - clip.w_axis.y) / clip.y_axis.y];
                let [x, y] = point.map(|sides| f64::from(sides) * scene.view.side);
                glam::DVec3::new(x, y, 0.0) + scene.view.camera.target
            };
            let off = out.dot(at([left, top])) - height;
            let pixel = f64::from(1.6 / sight.focal) * scene.view.side;
            assert!(off.abs() < pixel, "{normal}: {off} {pixel}");
        }
    }
}

/// A scene of one body with one element of all its nodes.
fn one_element(nodes: &str, count: usize) -> (Scene, Listed) {
    let all: Vec<_> = (0..count).collect();
    let text = format!(
        "time = {{ duration = 1, step = 'T/50', frames_per_second = 60 }}
        [body]
        nodes = {nodes}
        elements = [{all:?}]
        [[run]]
        name = 'a'
        model = {{ kind = 'shape-based', stiffness = 1e3 }}"
    );
    let scene = parse(&text);
    let picture = compose(&scene, &Runner::new(&scene, &[0]).frame(0));
    (scene, picture)
}

#[test]
fn a_concave_polygon_is_filled_to_its_own_sides() {
    for (nodes, count, area) in
        [("[[0,0],[2,0],[2,2],[1,0.3],[0,2]]", 5, 2.3), ("[[0,0],[2,-1],[0.5,0],[2,1]]", 4, 0.5)]
    {
        let (scene, picture) = one_element(nodes, count);
        let panel = &picture.panels[0];
        let metre = f64::from(panel.sight.focal) / scene.view.side;
        let triangles = corners(&picture.under, "elements");
        let areas: Vec<_> =
            triangles.chunks(3).map(|corners| f64::from(winding(corners)) / (2.0 * metre.powi(2))).collect();
        assert!(areas.iter().all(|&area| area > 0.0) && areas.len() == count - 2, "{areas:?}");
        assert!((areas.iter().sum::<f64>() - area).abs() < 1e-4, "{areas:?}");
        // Edges and contours, each line with both ends.
        assert_eq!(corners(&picture.under, "edges").len(), 2 * (count + 1));
    }
}

#[test]
fn an_element_of_any_shape_is_drawn_by_its_hull() {
    // A cube without one corner: three squares and four triangles.
    let nodes = "[[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1]]";
    let (scene, picture) = one_element(nodes, 7);
    assert_eq!(scene.bodies[0].body.faces().nodes.len(), 7);
    let panel = &picture.panels[0];
    assert_eq!(panel.sound.triangles.len(), 3 * 2 + 4);
    assert_eq!(panel.lines.iter().filter(|line| line.kind == LineKind::Edge).count(), 12);
}

#[test]
fn an_element_without_faces_is_drawn_from_its_middle() {
    let nodes = "[[0,0,0],[1,1,1],[2,2,2],[3,3,3],[4,4,4],[5,5,5],[7,7,7]]";
    let (_, picture) = one_element(nodes, 7);
    let panel = &picture.panels[0];
    assert_eq!(panel.lines.len(), 7);
    assert!(panel.lines.iter().all(|line| line.kind == LineKind::Bar && line.from == panel.lines[0].from));
    assert!(panel.region[2] > 50 && panel.region[3] > 50);
}

/// The only turned-over triangle of Fig. 4(a) is fully visible: its sign stands beside the body and points to it.
#[test]
fn a_sign_that_would_hide_its_element_stands_beside_the_body() {
    let text = include_str!("../../scenes/fig4a.toml")
        .replace("[view]", "[view]\ncamera = { target = [0, 0.75], distance = 13.5 }");
    let scene = Scene::parse(&text, "fig4a.toml", &Limits::default()).expect("the shipped scene is sound");
    let mut runner = Runner::new(&scene, &[1]);
    let composer = Composer::new(&scene, &History::new(&scene, &[1]));
    for index in [89, 120, 300] {
        let frame = runner.frame(index);
        assert_eq!(frame.runs[0].snapshot.diagnostics.turned_over, 1, "this run is known for it");
        let picture = composer.compose(&frame);
        let [sound, over] = ["elements", "turned over"].map(|name| corners(&picture.under, name));
        let (low, high) = sound
            .iter()
            .chain(&over)
            .fold((glam::Vec2::INFINITY, glam::Vec2::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)));
        let signs: Vec<_> = picture.marks.iter().filter(|mark| mark.shape == "alarm arrow").collect();
        let [sign] = signs[..] else { panic!("one sign: {signs:?}") };
        let [x, _, width, _] = sign.rectangle;
        assert!(x + width < low.x || x > high.x, "frame {index}: {x} is between {low} and {high}");
        // The leader goes from its disc into the triangle.
        let mut leaders = picture.marks.iter().filter(|mark| mark.shape == "line");
        let leader = leaders.next_back().expect("a leader");
        let start = glam::Vec2::new(leader.rectangle[0], leader.rectangle[1]);
        let (low, high) = over.iter().fold((over[0], over[0]), |(low, high), &at| (low.min(at), high.max(at)));
        assert!(start.cmpge(low - 2.0).all() && start.cmple(high + 2.0).all(), "frame {index}: {start}");
        assert!(leader.rectangle[2] > 20.0);
    }
}

#[test]
fn contours_are_closed_chains() {
    let (simulated, _) = fig4b(0);
    let (mut scene, mut runner) = (simulated.clone(), Runner::new(&simulated, &[0, 1]));
    let mut seen = 0;
    for index in [3, 5, 8, 14] {
        let frame = runner.frame(index);
        for azimuth in [0.1, 1.3, 2.9] {
            scene.view.camera.azimuth = azimuth;
            let picture = compose(&scene, &frame);
            let lines = picture.panels[0].lines.iter().filter(|line| line.kind == LineKind::Contour);
            let ends: Vec<_> = lines.flat_map(|line| [line.from, line.to]).map(glam::Vec3::from).collect();
            for end in &ends {
                // The distance is much smaller than the pieces of a patch.
                let meeting = ends.iter().filter(|other| end.distance(**other) < 4e-4).count();
                assert!(meeting % 2 == 0, "{index} {azimuth}: {meeting} contours meet at {end}");
            }
            seen += ends.len();
        }
    }
    assert!(seen > 500, "{seen}");
}

/// A shipped scene.
fn shipped(text: &str) -> Scene {
    Scene::parse(text, "shipped.toml", &Limits::default()).expect("the shipped scene is sound")
}

#[test]
fn a_run_that_diverged_is_grey_and_stands_still_as_it_fitted_last() {
    let scene = shipped(include_str!("../../scenes/explicit-euler.toml"));
    let composer = unknown(&scene);
    let mut runner = Runner::new(&scene, &[0, 1, 2]);
    let [before, growing, first, last] = [10, 57, 90, 119].map(|index| composer.compose(&runner.frame(index)));
    let greyed = |picture: &Listed| picture.panels.iter().map(|panel| panel.greyed).collect::<Vec<_>>();
    assert_eq!((greyed(&before), greyed(&last)), (vec![false; 3], vec![false, false, true]));
    assert_eq!((&growing.panels[2], &first.panels[2]), (&last.panels[2], &last.panels[2]));
    let [left, top, width, height] = last.panels[2].viewport;
    let [x, y, wide, high] = last.panels[2].region;
    assert!(x > left && y > top && x + wide < left + width && y + high < top + height, "it fits");
    let said: Vec<_> = last.words.iter().map(|run| run.text.as_str()).collect();
    let Status::Diverged(divergence) = runner.snapshots()[2].snapshot.status else { panic!("it diverged") };
    let when = format!("diverges at {:.0} ms", divergence.time * 1e3);
    assert!(said.contains(&when.as_str()), "{said:?}");
    assert!(said.iter().any(|text| text.starts_with("shown as at ")), "{said:?}");
    // Alone it has the scale bar, which measures the shown body.
    let alone = Runner::new(&scene, &[2]).frame(119);
    let picture = unknown(&scene).compose(&alone);
    let shown = &alone.runs[0].last_fit.as_ref().expect("it diverged").position;
    let sight = &picture.panels[0].sight;
    let across = glam::Vec3::new(sight.clip.x_axis.x, sight.clip.y_axis.x, sight.clip.z_axis.x).normalize();
    let along = |points: &mut dyn Iterator<Item = f64>| {
        let [low, high] =
            points.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    let metres = along(&mut shown.iter().map(|at| at.dot(across.as_dvec3())));
    let corners = picture.panels[0].sound.vertices.iter().chain(&picture.panels[0].turned_over.vertices);
    let seen = corners.map(|corner| sight.clip.project_point3(glam::Vec3::from(corner.position)).x);
    let pixels = along(&mut seen.map(|at| 0.5 * f64::from(at) * f64::from(picture.panels[0].viewport[2])));
    let text = picture.words.iter().find(|run| run.text.ends_with("mm")).expect("a bar");
    let stands_for = text.text.trim_end_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().expect("a number") * 1e-3;
    let is_bar = |mark: &&Mark| mark.shape == "rectangle" && mark.colour == picture.palette.second_text;
    let bar = picture.marks.iter().filter(is_bar).map(|mark| f64::from(mark.rectangle[2])).fold(0.0, f64::max);
    // Nearer points are a little larger.
    assert!(
        (pixels / metres * stands_for / bar - 1.0).abs() < 0.1,
        "{pixels} px, {metres} m, {bar} px, {stands_for} m"
    );
    assert!(growing.words.iter().any(|run| run.text == when), "it has not yet");
}

#[test]
fn greys_have_no_hue_and_keep_their_order() {
    for theme in [Theme::Light, Theme::Dark] {
        let palette = Palette::of(theme);
        let grey = palette.greyed();
        for colour in [grey.bodies[0], grey.bodies_flat[0], grey.alarm, grey.edge, grey.outline] {
            let [least, most] = [colour.iter().min(), colour.iter().max()].map(|byte| *byte.expect("three"));
            assert!(most - least <= 8, "{theme:?}: {colour:?}");
        }
        assert!(contrast(grey.outline, palette.background) > contrast(grey.bodies[0], palette.background));
    }
}

#[test]
fn flat_elements_are_a_state_of_their_own() {
    let scene = shipped(include_str!("../../scenes/elements/restore-plane.toml"));
    let frame = Runner::new(&scene, &[0]).frame(0);
    let picture = compose(&scene, &frame);
    assert!(picture.panels[0].sound.vertices.iter().all(|vertex| vertex.hatch == 1.0), "dots");
    let squares = |picture: &Listed, colour| {
        let is_one = |mark: &&Mark| mark.colour == colour && mark.rectangle[2] == mark.rectangle[3];
        picture.marks.iter().filter(is_one).count()
    };
    assert_eq!([picture.palette.axis, picture.palette.tally].map(|colour| squares(&picture, colour)), [27, 0]);
    let says = |picture: &Listed, text: &str| picture.words.iter().any(|run| run.text == text);
    assert!(says(&picture, "0 of 27") && says(&picture, "turned over, 27 flat"));
    // At rest nothing is flat.
    let (scene, frame) = fig4b(0);
    let picture = compose(&scene, &frame);
    assert!(picture.panels.iter().all(|panel| panel.sound.vertices.iter().all(|vertex| vertex.hatch == 0.0)));
    assert!(says(&picture, "0 of 27") && says(&picture, "turned over") && !says(&picture, "flat"));
    // Where broken elements are counted, turned-over ones are told beside them.
    let mut frame = frame;
    let of_one = |one: usize| (0..27).map(|element| element == one).collect::<Vec<_>>();
    // The first panel has a scale bar beside the count.
    (frame.runs[1].snapshot.broken, frame.runs[1].snapshot.turned_over) = (of_one(3), of_one(5));
    let picture = compose(&scene, &frame);
    assert!(says(&picture, "1 of 27") && says(&picture, "broken, 1 turned over"));
}

#[test]
fn the_more_strained_springs_lie_above_and_have_the_colours_of_the_key() {
    let (mut scene, _) = fig4b(0);
    scene.view.visible = localshape::look::Visible { springs: true, ..Default::default() };
    let scale = ColourScale { field: Field::Strain, to: None, range: [-0.1, 0.1], map: ColourMap::VioletGreen };
    scene.view.colour = Some(scale);
    let frame = Runner::new(&scene, &[1]).frame(4);
    let strokes = &compose(&scene, &frame).panels[0].strokes;
    let ends = localshape::look::ramp::ramp(scale.map, Theme::Light);
    let full = |colour| colour == ends[0] || colour == ends[ends.len() - 1];
    let springs = scene.runs[1].models[0].springs().len();
    let first = strokes.iter().position(|stroke| full(stroke.colours[0])).expect("some are strained so far");
    let above = &strokes[first..springs];
    // These springs are in the same step of strain.
    let count = above.iter().filter(|stroke| full(stroke.colours[0])).count();
    assert!(above.len() < 2 * count && count > 20, "{count} of {}", above.len());
}

#[test]
fn springs_show_their_own_strain_without_its_sign_unless_the_range_has_one() {
    let (mut scene, _) = fig4b(0);
    scene.view.visible = localshape::look::Visible { springs: true, ..Default::default() };
    let (body, frame) = (scene.bodies[0].body.clone(), Runner::new(&scene, &[0, 1]).frame(4));
    let springs = scene.runs[1].models[0].springs().to_vec();
    let strain = |[a, b]: [u32; 2]| {
        let length = |points: &[glam::DVec3]| points[a as usize].distance(points[b as usize]);
        length(&frame.runs[1].snapshot.position) / length(body.rest()) - 1.0
    };
    let count = |is: &dyn Fn(f64) -> bool| springs.iter().filter(|&&ends| is(strain(ends))).count();
    for (range, low, high) in [
        ([0.0, 0.1], count(&|strain| strain.abs() < 1e-4), count(&|strain| strain.abs() > 0.1)),
        ([-0.1, 0.1], count(&|strain| strain < -0.1), count(&|strain| strain > 0.1)),
    ] {
        scene.view.colour = Some(ColourScale { field: Field::Strain, to: None, range, map: ColourMap::VioletGreen });
        let picture = compose(&scene, &frame);
        let ramp = localshape::look::ramp::ramp(ColourMap::VioletGreen, Theme::Light);
        let of = |end: [u8; 3]| picture.panels[1].strokes.iter().filter(|stroke| stroke.colours[0] == end).count();
        assert!(of(ramp[0]) >= low && of(ramp[ramp.len() - 1]) >= high && high > 0, "{range:?}");
        assert!(range[0] == 0.0 || low > 0);
        // The other model has no springs, and its edges show the strain of elements.
        assert!(picture.words.iter().any(|word| word.text.starts_with("springs: change of length")));
    }
}
