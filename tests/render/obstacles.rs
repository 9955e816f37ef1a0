//! Obstacles and grips in the composed picture; only one test needs a device.

use super::listed::{Composer, Listed, Mark, compose_figure, parts, remove};
use super::{compose, fig4b, frame, gpu, parse, renderer, unknown};
use glam::{DVec3, Vec3};
use localshape::picture::{
    Item, LineKind, MOST_OCCLUDERS, Mesh, Obstacles, Occluder, Pane, PaneCorner, Panel, Vertex, winding,
};
use localshape::render::Renderer;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::runner::moments::Moments;
use localshape::scene::Scene;
use localshape::scene::figure::{Content, Figure};
use localshape::sim::{Divergence, Status};
use std::collections::HashMap;

const WORLD: &str = "
    contact = { rule = 'nodes' }
    time = { duration = 1, step = 'T/50', frames_per_second = 50 }
    run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } }]
";
const CUBE: &str = "body = { lattice = { cells = [1, 1, 1], side = 0.2 }, lowest = 0.1 }\n";
const FLOOR: &str = "[[obstacle]]\nkind = 'floor'\n";
const TRIANGLE: &str = "[body]\nnodes = [[0, 1], [1, 1], [0.5, 1.8]]\nelements = [[0, 1, 2]]\n";
const SPHERE: &str = "[[obstacle]]\nkind = 'sphere'\ncentre = [0.4, 0.5, 0]\nradius = 0.1\n";
const MOVING: &str = "path = { keys = [{ time = 0 }, { time = 1, shift = [0, 0.4, 0] }], ease = 'linear' }\n";
const PLATE: &str = "[[obstacle]]\nkind = 'plate'\npoint = [0, 0.8, 0]\nnormal = [0, -1, 0]\n";

/// A scene with a fixed camera.
fn scene(parts: &[&str]) -> Scene {
    let text = parts.concat();
    let mut scene = following(&text);
    scene.view.camera.follow = false;
    scene
}

fn following(text: &str) -> Scene {
    parse(text)
}

fn picture(scene: &Scene, index: u64) -> Listed {
    compose(scene, &frame(scene, index))
}

fn at(mesh: &Mesh, index: u32) -> Vec3 {
    Vec3::from(mesh.vertices[index as usize].position)
}

fn volume(mesh: &Mesh) -> f32 {
    mesh.triangles.iter().map(|three| three.map(|index| at(mesh, index))).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn is_closed(mesh: &Mesh) -> bool {
    let mut balance: HashMap<[[i32; 3]; 2], i32> = HashMap::new();
    let place = |index: u32| at(mesh, index).to_array().map(|x| (x * 1e3).round() as i32);
    for triangle in &mesh.triangles {
        for side in 0..3 {
            let [a, b] = [place(triangle[side]), place(triangle[(side + 1) % 3])];
            let (key, sign) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *balance.entry(key).or_default() += sign;
        }
    }
    balance.values().all(|&sum| sum == 0)
}

fn middle(points: impl ExactSizeIterator<Item = [f32; 3]>) -> Vec3 {
    let count = points.len() as f32;
    points.map(Vec3::from).sum::<Vec3>() / count
}

/// A point of the world in sides from the panel's origin, for a camera that does not follow.
fn seen(scene: &Scene, point: [f64; 3]) -> Vec3 {
    ((DVec3::from(point) - scene.view.camera.target) / scene.view.side).as_vec3()
}

fn numbers(panel: &Panel) -> Vec<f32> {
    let mut all = Vec::new();
    for solid in &panel.obstacles.solids {
        let numbers = |vertex: &Vertex| [&vertex.position[..], &vertex.normal, &[vertex.hatch]].concat();
        all.extend(solid.mesh.vertices.iter().flat_map(numbers));
    }
    for corner in panel.obstacles.panes.iter().flat_map(|pane| &pane.corners) {
        all.extend(corner.position.iter().chain(&corner.grid).chain(&corner.from_middle));
    }
    all.extend(panel.obstacles.edges.iter().flatten().flatten());
    all.extend(panel.lines.iter().flat_map(|line| [line.from, line.to].concat()));
    all
}

fn marks(picture: &Listed, shapes: &[&str]) -> Vec<Mark> {
    picture.marks.iter().filter(|mark| shapes.contains(&mark.shape) && mark.opacity == 255).copied().collect()
}

#[test]
fn solids_are_closed_look_outward_and_are_where_their_paths_have_brought_them() {
    let ball = std::f64::consts::PI * 4.0 / 3.0 * 1e-3;
    let rod = ball + std::f64::consts::PI * 0.01 * 0.3;
    for (obstacle, centre, exact) in [
        ("'sphere'\ncentre = [0.4, 0.5, 0]\nradius = 0.1\n", [0.4, 0.5, 0.0], ball),
        ("'capsule'\nfrom = [0.4, 0.2, 0]\nto = [0.4, 0.5, 0]\nradius = 0.1\n", [0.4, 0.35, 0.0], rod),
        ("'capsule'\nfrom = [0.4, 0.2, 0.3]\nto = [0.4, 0.2, 0.6]\nradius = 0.1\n", [0.4, 0.2, 0.45], rod),
        (
            "'box'\ncentre = [0.4, 0.3, 0]\nsize = [0.1, 0.2, 0.3]\nrotation = { axis = [1, 2, 3], angle = 1 }\n",
            [0.4, 0.3, 0.0],
            0.006,
        ),
    ] {
        for (path, gone) in [("", 0.0), (MOVING, 0.2)] {
            let scene = scene(&[WORLD, CUBE, FLOOR, "[[obstacle]]\nkind = ", obstacle, path]);
            let picture = picture(&scene, 25);
            let panel = &picture.panels[0];
            let [solid] = &panel.obstacles.solids[..] else { panic!("{obstacle}") };
            let mesh = &solid.mesh;
            assert!(is_closed(mesh), "{obstacle}");
            let found = f64::from(volume(mesh)) * scene.view.side.powi(3);
            assert!((0.97..1.001).contains(&(found / exact)), "{obstacle} {found} {exact}");
            let centre = seen(&scene, [centre[0], centre[1] + gone, centre[2]]);
            // Segments are spread evenly.
            let corners = middle(mesh.vertices.iter().map(|vertex| vertex.position));
            assert!(corners.distance(centre) < 0.02, "{obstacle} {corners} {centre}");
            for vertex in &mesh.vertices {
                assert!(Vec3::from(vertex.normal).dot(Vec3::from(vertex.position) - centre) > 0.0, "{obstacle}");
            }
            assert!(panel.lines.iter().any(|line| line.kind == LineKind::ObstacleContour), "{obstacle}");
            let ([x, y, w, h], [left, top, width, height]) = (panel.region, panel.viewport);
            assert!(left <= x && top <= y && x + w <= left + width && y + h <= top + height);
        }
    }
}

#[test]
fn a_plate_is_transparent_behind_its_surface_and_says_where_it_goes() {
    for (path, gone, arrows) in [("", 0.0, 0), (MOVING, 0.4, 1)] {
        let view = "[view]\ncamera = { target = [0, 0.6, 0], distance = 8 }\n";
        let scene = scene(&[WORLD, CUBE, FLOOR, PLATE, path, view]);
        let picture = picture(&scene, 25);
        let panel = &picture.panels[0];
        assert!(panel.obstacles.solids.is_empty());
        let panes = &panel.obstacles.panes;
        assert!(panes.iter().all(|pane| pane.alpha < 1.0 && !pane.grid) && panes.len() == 3);
        assert_eq!(panel.obstacles.edges.len(), 9, "those that are seen");
        let gone = gone * frame(&scene, 25).time;
        let surface = seen(&scene, [0.0, 0.8 + gone, 0.0]).y;
        let heights = panes.iter().flat_map(|pane| &pane.corners).map(|corner| corner.position[1] - surface);
        let (low, high) = heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
        assert!(low.abs() < 1e-4 && (0.01..0.2).contains(&high), "{low} {high}");
        let found = marks(&picture, &["arrow"]);
        assert_eq!(found.len(), arrows);
        assert!(found.iter().all(|arrow| arrow.along[1] < -0.99), "upwards");
    }
}

/// A body that slides any distance stays on the drawn part of the plate below it.
#[test]
fn a_plate_reaches_as_far_as_bodies_slide_on_it() {
    let slope = "gravity = [0, -9.8, 0]\n[[obstacle]]\nkind = 'plate'\npoint = [0, 0, 0]\nnormal = [0.5, 0.866, 0]\nrestitution = 0\n";
    let cube = "body = { lattice = { cells = [1, 1, 1], side = 0.2 }, lowest = 0.02, rotation = { axis = [0, 0, 1], angle = -0.5236 } }\n";
    let scene = following(&[&WORLD.replace("duration = 1", "duration = 2"), cube, slope].concat());
    let composer = Composer::new(&scene, &History::new(&scene, &[0]));
    for index in [0, 30, scene.last_frame()] {
        let panel = &composer.compose(&frame(&scene, index)).panels[0];
        let range = |points: &mut dyn Iterator<Item = [f32; 3]>| {
            let down = points.map(|[x, y, _]| 0.866 * x - 0.5 * y);
            down.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        };
        let body = range(&mut panel.sound.vertices.iter().map(|vertex| vertex.position));
        let corners = panel.obstacles.panes.iter().flat_map(|pane| &pane.corners);
        let plate = range(&mut corners.map(|corner| corner.position));
        assert!(plate[0] < body[0] && body[1] < plate[1], "{index}: {body:?} {plate:?}");
    }
    let way = frame(&scene, scene.last_frame()).runs[0].snapshot.position[0].x;
    assert!(way > 8.0 * scene.bodies[0].body.extent(), "{way}");
}

#[test]
fn walls_have_a_grid_and_end_at_the_ground() {
    let wall = "[[obstacle]]\nkind = 'floor'\nnormal = [1, 0.2, 0]\nheight = -0.4\n";
    let scene = scene(&[WORLD, CUBE, FLOOR, wall, FLOOR]);
    let picture = picture(&scene, 0);
    let [pane] = &picture.panels[0].obstacles.panes[..] else { panic!("the second ground is the first again") };
    assert!(pane.grid && pane.alpha < 1.0);
    let ground = seen(&scene, [0.0; 3]).y;
    let corners = &pane.corners;
    assert!(corners.iter().all(|corner| corner.position[1] > ground - 1e-4));
    assert!(corners.iter().any(|corner| corner.position[1] < ground + 1e-4));
}

#[test]
fn slabs_are_ordered_from_the_farthest_to_the_nearest() {
    let plates: Vec<_> = [-0.3, -0.5, -0.9, -0.2]
        .map(|z| format!("[[obstacle]]\nkind = 'plate'\npoint = [3, 0, {z}]\nnormal = [0, 0, 1]\n"))
        .to_vec();
    let scene = scene(&[WORLD, CUBE, &plates.concat()[..], "[view]\ncamera = { azimuth = 0.0 }\n"]);
    let picture = picture(&scene, 0);
    let depth = |pane: &Pane| pane.corners.iter().map(|corner| corner.position[2]).fold(f32::INFINITY, f32::min);
    let panes = &picture.panels[0].obstacles.panes;
    // Of the faces of plates, the surfaces are fainter.
    let depths: Vec<_> = panes.iter().filter(|pane| pane.alpha < 0.6).map(depth).collect();
    assert!(depths.len() == 4 && depths.windows(2).all(|two| two[0] < two[1]), "{depths:?}");
}

#[test]
fn obstacles_throw_shadows_with_the_body() {
    let [without, with] = [&[WORLD, CUBE, FLOOR][..], &[WORLD, CUBE, FLOOR, SPHERE][..]].map(|parts| {
        let scene = scene(parts);
        let picture = picture(&scene, 0);
        let floor = picture.panels[0].floor.clone().expect("a floor");
        floor.shades[1].cells.iter().map(|&cell| u64::from(cell)).sum::<u64>()
    });
    assert!(with > without + 1000, "{without} {with}");
}

#[test]
fn floors_that_move_take_their_grid_along() {
    let moving = "path = { keys = [{ time = 0 }, { time = 1, shift = [0.07, -0.4, 0] }], ease = 'linear' }\n";
    let scene = scene(&[WORLD, CUBE, FLOOR, moving]);
    let [start, later] = [0, 25].map(|index| picture(&scene, index).panels[0].floor.clone().expect("a floor"));
    let (side, time) = (scene.view.side as f32, frame(&scene, 25).time as f32);
    assert!((later.height - start.height + 0.4 * time / side).abs() < 1e-4);
    let off = (later.grid[0] - start.grid[0] + 0.07 * time / side).rem_euclid(1.0);
    assert!(off.min(1.0 - off) < 1e-4, "{off}");
}

#[test]
fn what_blew_up_stays_among_finite_numbers() {
    let all = [
        WORLD,
        CUBE,
        FLOOR,
        PLATE,
        MOVING,
        SPHERE,
        MOVING,
        "[[obstacle]]\nkind = 'sphere'\ncentre = [0, -1e9, 0]\nradius = 1e9\n",
        "[[obstacle]]\nkind = 'box'\ncentre = [1e20, 0, 0]\nsize = [1, 1e19, 1]\n",
        "[[obstacle]]\nkind = 'capsule'\nfrom = [2, 2, 2]\nto = [2, 2, 2]\nradius = 1e-12\n",
        "[[obstacle]]\nkind = 'floor'\nnormal = [-1, 0, 0]\nheight = -1e12\n",
        "swing = { period = 0.02, rotation = { axis = [0, 1, 0], angle = 1e9 } }\n",
    ];
    let scene = scene(&all);
    for far in [1.0, 1e6, 1e200, f64::NAN, f64::INFINITY] {
        let mut frame = frame(&scene, 3);
        let snapshot = &mut frame.runs[0].snapshot;
        snapshot.position[2] *= far;
        if far != 1.0 {
            snapshot.status =
                Status::Diverged(Divergence { time: 0.01, step: 3, part: 0, element: None, is_end: false });
        }
        let picture = compose(&scene, &frame);
        assert!(numbers(&picture.panels[0]).iter().all(|number| number.is_finite()), "{far}");
        if let Some(gpu) = gpu("what_blew_up_stays_among_finite_numbers") {
            let mut renderer = renderer(gpu, picture.size);
            renderer.draw(&picture).expect("the device works");
        }
    }
}

#[test]
fn a_ball_as_large_as_a_planet_is_smooth_below_the_body() {
    let scene = scene(&[WORLD, CUBE, "[[obstacle]]\nkind = 'sphere'\ncentre = [0, -1e4, 0]\nradius = 1e4\n"]);
    let picture = picture(&scene, 0);
    let mesh = &picture.panels[0].obstacles.solids[0].mesh;
    let top = seen(&scene, [0.0; 3]).y;
    let near = mesh.triangles.iter().map(|three| three.map(|index| at(mesh, index)));
    let near: Vec<_> = near.filter(|three| three.iter().all(|at| at.x.abs() + at.z.abs() < 8.0)).collect();
    assert!(near.len() > 100, "{}", near.len());
    assert!(near.iter().flatten().all(|at| (at.y - top).abs() < 0.02), "flat there");
}

#[test]
fn obstacles_in_the_plane_are_flat_and_end_at_the_floor() {
    let obstacles = "
        [[obstacle]]\nkind = 'floor'\n
        [[obstacle]]\nkind = 'sphere'\ncentre = [2, 0]\nradius = 0.5\n
        [[obstacle]]\nkind = 'box'\ncentre = [-1, 0.5]\nsize = [0.4, 0.2]\n
        [[obstacle]]\nkind = 'capsule'\nfrom = [2, 2]\nto = [3, 2]\nradius = 0.2\n
        [[obstacle]]\nkind = 'plate'\npoint = [0, 2.8]\nnormal = [0, -1]\n
        path = { keys = [{ time = 0 }, { time = 1, shift = [0, -0.5] }] }\n";
    let view = "[view]\ncamera = { target = [0.5, 1.4], distance = 20 }\n";
    let scene = scene(&[WORLD, TRIANGLE, obstacles, view]);
    let picture = picture(&scene, 25);
    let metre = f64::from(picture.panels[0].sight.focal) / scene.view.side;
    let area = |item: &Item| -> f64 {
        let Item::Fill { path, .. } = item else { panic!("{item:?}") };
        f64::from(winding(&path.points()).abs()) / 2.0 / (metre * metre)
    };
    let pi = std::f64::consts::PI;
    // The last one is drawn first, each with its inside over the colour of its rim.
    let drawn = parts(&picture.under, "obstacle").concat();
    assert_eq!(drawn.len(), 6);
    for (items, exact) in drawn.chunks(2).zip([0.4 + pi * 0.04, 0.08, pi * 0.125]) {
        let [whole, inside] = [0, 1].map(|at| area(&items[at]) / exact);
        assert!((0.99..1.001).contains(&whole) && inside < whole, "{whole} {inside}");
    }
    // The plate has a line and a soft fill, like the floor, and an arrow.
    for (shape, count) in [("ground", 2), ("floor", 2)] {
        assert_eq!(picture.floors.iter().filter(|mark| mark.shape == shape).count(), count, "{shape:?}");
    }
    assert_eq!(marks(&picture, &["arrow"]).len(), 1);
}

#[test]
fn nothing_outside_the_panel_has_an_arrow() {
    let grab = "[[grab]]\nnodes = [3]\npath = { keys = [{ time = 0.4 }, { time = 0.8, shift = [0.3, 0, 0] }] }\n";
    for (target, expected) in [(0, 1), (40, 0), (-40, 0)] {
        let still = format!("[view.camera]\ntarget = [{target}, 0.5, 0]\ndistance = 10\n");
        let scene = scene(&[WORLD, CUBE, FLOOR, grab, &still]);
        assert_eq!(marks(&picture(&scene, 30), &["arrow"]).len(), expected, "{target}");
    }
}

#[test]
fn nodes_are_marked_only_while_they_are_held() {
    let hold = "[[hold]]\nnodes = [0, 7]\nfrom = 0.2\nuntil = 0.4\n";
    let grab = "[[grab]]\nnodes = [3]\npath = { keys = [{ time = 0.4 }, { time = 0.8, shift = [0.3, 0, 0] }] }\n";
    let scene = scene(&[WORLD, CUBE, FLOOR, hold, grab]);
    let count = |picture: &Listed, shape| picture.marks.iter().filter(|mark| mark.shape == shape).count();
    for (index, held, dragged, arrows) in [(0, 0, 0, 0), (15, 2, 0, 0), (30, 0, 1, 1), (45, 0, 0, 0)] {
        let picture = picture(&scene, index);
        assert_eq!(count(&picture, "pin"), held + dragged, "{index}");
        let arrows_found = marks(&picture, &["arrow"]);
        assert_eq!(arrows_found.len(), arrows, "{index}");
        assert!(arrows_found.iter().all(|arrow| arrow.along[0] > 0.9), "to the right");
    }
    // Node 0 lies behind, seen from above and from the right; node 7 in front.
    let picture = picture(&scene, 15);
    assert_eq!(count(&picture, "pin"), 2);
}

#[test]
fn scenes_without_obstacles_pay_nothing() {
    let (scene, frame) = fig4b(4);
    let picture = compose(&scene, &frame);
    assert!(picture.panels.iter().all(|panel| panel.obstacles == Obstacles::default()));
    assert!(picture.panels.iter().flat_map(|panel| &panel.lines).all(|line| (line.kind as u32) < 4));
}

#[test]
fn a_camera_that_follows_shows_what_comes_near_and_nothing_else() {
    let seen = |parts: &[&str]| {
        let scene = following(&[&[WORLD, CUBE, FLOOR], parts].concat().concat());
        let composer = Composer::new(&scene, &History::new(&scene, &[0]));
        let panel = &composer.compose(&Runner::new(&scene, &[0]).frame(0)).panels[0];
        let corner = panel.sight.clip * at(&panel.sound, 0).extend(1.0);
        (panel.sight.element, corner.x / corner.w)
    };
    let alone = seen(&[]);
    let far = "[[obstacle]]\nkind = 'sphere'\ncentre = [9, 0.1, 0]\nradius = 0.2\n";
    assert_eq!(seen(&[far]), alone);
    // Obstacles that come near are shown from any direction, and the body stays large.
    let near = "path = { keys = [{ time = 0 }, { time = 0.5, shift = [-8.7, 0, 0] }, { time = 1 }] }\n";
    let (element, x) = seen(&[far, near]);
    assert!(x < alone.1 - 0.05 && (0.7..=1.0).contains(&(element / alone.0)), "{element} {x} {alone:?}");
}

#[test]
fn following_the_body_lets_the_grid_scroll_below() {
    let text = "velocity = [3, 0, 0]";
    let body = CUBE.replace("lowest = 0.1", &format!("lowest = 0.1, {text}"));
    let body = following(&[WORLD, &body, FLOOR].concat());
    let composer = unknown(&body);
    let eye = |picture: &Listed| picture.panels[0].sight.eye;
    // Any frame alone, in any order.
    let [late, early] = [25, 0].map(|index| composer.compose(&frame(&body, index)));
    // The camera has the same position relative to the body, and the grid has moved as far as the body.
    assert!(eye(&late).distance(eye(&early)) < 1e-3);
    let grid = [&late, &early].map(|picture| picture.panels[0].floor.as_ref().expect("a floor").grid[0]);
    let gone = (3.0 * frame(&body, 25).time / body.view.side) as f32;
    let off = (grid[0] - grid[1] - gone).rem_euclid(1.0);
    assert!(off.min(1.0 - off) < 1e-3, "{grid:?} {gone}");
}

/// A block between a floor and an obstacle of a kind, its lower side at a height (m).
fn below(obstacle: &str) -> Panel {
    let block = "body = { lattice = { cells = [3, 2, 3], side = 0.1 }, lowest = 0 }\n";
    let obstacle = format!("[[obstacle]]\n{obstacle}\n");
    picture(&scene(&[WORLD, block, FLOOR, &obstacle]), 0).panels.remove(0)
}

/// The smallest distance of the body from the only solid of a panel.
fn nearest(panel: &Panel) -> f32 {
    let [solid] = &panel.obstacles.solids[..] else { panic!("one solid") };
    let near = || solid.mesh.vertices.iter().map(|vertex| vertex.hatch);
    assert!(is_closed(&solid.mesh) && near().all(|near| (0.0..=1.0).contains(&near)));
    near().fold(0.0, f32::max)
}

#[test]
fn bodies_and_obstacles_take_light_from_each_other_as_they_come_near() {
    let kinds: [&dyn Fn(f64) -> String; 3] = [
        &|height| format!("kind = 'sphere'\ncentre = [0, {}, 0]\nradius = 0.15", height + 0.15),
        &|height| {
            let level = height + 0.05;
            format!("kind = 'capsule'\nfrom = [-0.3, {level}, 0]\nto = [0.3, {level}, 0]\nradius = 0.05")
        },
        &|height| {
            let turned = "rotation = { axis = [0, 1, 0], angle = 0.4 }";
            format!("kind = 'box'\ncentre = [0, {}, 0]\nsize = [0.4, 0.1, 0.2]\n{turned}", height + 0.05)
        },
    ];
    for kind in kinds {
        // The upper side of the block is at 0.2 m. An obstacle that starts inside is an error.
        let touching = below(&kind(0.2005));
        assert!(nearest(&touching) > 0.9, "{}", nearest(&touching));
        assert_eq!(touching.obstacles.occluders.len(), 1);
        let mut last = nearest(&touching);
        for step in 1..=40 {
            let near = nearest(&below(&kind(0.2005 + 0.005 * f64::from(step))));
            assert!(near <= last + 1e-3 && last - near < 0.1, "{step}: {last} {near}");
            last = near;
        }
        assert_eq!(last, 0.0);
        assert!(below(&kind(1.2)).obstacles.occluders.is_empty());
    }
}

#[test]
fn the_ground_takes_no_light_twice_and_plates_do() {
    assert!(picture(&scene(&[WORLD, CUBE, FLOOR]), 0).panels[0].obstacles.occluders.is_empty());
    let plate = below("kind = 'plate'\npoint = [0, 0.25, 0]\nnormal = [0, -1, 0]");
    assert!(matches!(plate.obstacles.occluders[..], [Occluder { is_clear: true, .. }]));
    // Only this many of any number count, and they are the nearest.
    let ball = |at: i32| {
        let height = 0.41 + 0.005 * f64::from(at);
        format!("[[obstacle]]\nkind = 'sphere'\ncentre = [0, {height}, 0]\nradius = 0.1\n")
    };
    let balls: Vec<_> = (0..9).map(ball).collect();
    let crowded = picture(&scene(&[WORLD, CUBE, FLOOR, &balls.concat()]), 0);
    let Obstacles { occluders, solids, .. } = &crowded.panels[0].obstacles;
    assert_eq!((occluders.len(), solids.len()), (MOST_OCCLUDERS, 9));
}

#[test]
fn a_rod_that_touches_darkens_the_body_below_it_and_one_that_does_not_leaves_it_light() {
    let Some(gpu) = gpu("a_rod_that_touches_darkens_the_body_below_it_and_one_that_does_not_leaves_it_light") else {
        return;
    };
    let block = "body = { lattice = { cells = [3, 2, 3], side = 0.1 }, lowest = 0 }\n";
    let brightness = |height: f64| {
        let rod = format!(
            "[[obstacle]]\nkind = 'capsule'\nfrom = [-0.5, {height}, 0]\nto = [0.5, {height}, 0]\nradius = 0.03\n"
        );
        let view = "[view]\nsize = [320, 240]\nlabels = []\n\
                    camera = { target = [0, 0.2, 0], distance = 2, azimuth = 0, elevation = 1.2 }\n";
        let mut picture = picture(&scene(&[WORLD, block, FLOOR, &rod, view]), 0);
        // Only the shadow of the rod remains.
        picture.panels[0].obstacles.solids.clear();
        picture.panels[0].lines.clear();
        let image = Renderer::new(gpu, picture.size).and_then(|mut renderer| renderer.draw(&picture)).expect("drawn");
        let [near, far] = [0.02, 0.14].map(|z| {
            let at = picture.panels[0].sight.clip
                * seen(&scene(&[WORLD, block, FLOOR, &rod, view]), [0.02, 0.2, z]).extend(1.0);
            let pixel = [(0.5 + 0.5 * at.x / at.w) * 320.0, (0.5 - 0.5 * at.y / at.w) * 240.0];
            f64::from(image.get_pixel(pixel[0] as u32, pixel[1] as u32)[1])
        });
        near / far
    };
    let [touching, hovering] = [0.2305, 0.5].map(brightness);
    assert!(touching < 0.85 && (hovering - 1.0).abs() < 0.05, "{touching} {hovering}");
}

/// Fading increases with the part of the obstacle that leaves, so that nothing changes suddenly.
#[test]
fn obstacles_fade_where_they_leave_their_panel() {
    let alone = scene(&[WORLD, CUBE, FLOOR]);
    let mut strengths = Vec::new();
    for step in 0..80 {
        let x = -0.2 - 0.01 * f64::from(step);
        let sphere = format!("[[obstacle]]\nkind = 'sphere'\ncentre = [{x}, 0.2, 0]\nradius = 0.05\n");
        let mut seen = scene(&[WORLD, CUBE, FLOOR, &sphere]);
        seen.view.camera.clone_from(&alone.view.camera);
        let panel = &picture(&seen, 0).panels[0];
        let [left, _, width, _] = panel.viewport.map(|length| length as f32);
        let is_within = |room: [f32; 4]| room[0] > left && room[2] < left + width;
        assert!(panel.obstacles.fade.is_none_or(|fade| is_within(fade.room)), "{x}");
        strengths.push(panel.obstacles.fade.map_or(0.0, |fade| fade.strength[0]));
    }
    // Not where it is whole, and not where it is invisible.
    let [first, last] = [strengths.iter().position(|&at| at > 0.0), strengths.iter().rposition(|&at| at > 0.0)];
    let (first, last) = (first.expect("it leaves"), last.expect("it leaves"));
    assert!(first > 5 && last < 79 && strengths[last] == 1.0, "{strengths:?}");
    assert!(strengths[..=last].windows(2).all(|two| two[0] <= two[1]), "{strengths:?}");
    // It does not fade completely within one step of 10 mm.
    assert!(strengths[first] < 1.0, "{strengths:?}");
}

/// The ground shows through fading obstacles, and bodies do not change.
#[test]
fn what_fades_lets_the_ground_through() {
    let Some(gpu) = gpu("what_fades_lets_the_ground_through") else { return };
    let rod = "[[obstacle]]\nkind = 'capsule'\nfrom = [-9, 0.1, -0.3]\nto = [9, 0.1, -0.3]\nradius = 0.1\n";
    let view = "[view]\nsize = [320, 240]\nlabels = []\n\
                camera = { target = [0, 0.2, 0], distance = 2, azimuth = 0 }\n";
    let fading = picture(&scene(&[WORLD, CUBE, FLOOR, rod, view]), 0);
    let [mut whole, mut bare] = [fading.clone(), fading.clone()];
    whole.panels[0].obstacles.fade = None;
    bare.panels[0].obstacles.solids.clear();
    bare.panels[0].lines.retain(|line| (line.kind as u32) < 8);
    let draw = |picture: &Listed| {
        Renderer::new(gpu, picture.size).and_then(|mut renderer| renderer.draw(picture)).expect("drawn")
    };
    let [fading, whole, bare] = [&fading, &whole, &bare].map(draw);
    let off = |one: &image::RgbImage, x: u32, range: std::ops::Range<u32>| {
        let pixels = range.flat_map(|y| one.get_pixel(x, y).0.into_iter().zip(fading.get_pixel(x, y).0));
        pixels.map(|(one, other)| one.abs_diff(other)).max().expect("pixels")
    };
    // At the sides it is invisible, in the middle opaque, and between them translucent.
    let side = [3, 316].map(|x| [off(&bare, x, 0..240), off(&whole, x, 40..200)]);
    assert!(side.iter().all(|&[bare, whole]| bare <= 2 && whole > 30), "{side:?}");
    assert_eq!((off(&whole, 160, 0..240), off(&whole, 100, 0..200)), (0, 0));
    let between = [off(&bare, 32, 0..240), off(&whole, 32, 0..240)];
    assert!(between.iter().all(|&off| off > 5), "{between:?}");
}

/// A solid obstacle in front of a body lies over it as half of its colour, and hides the ground behind it whole.
#[test]
fn bodies_are_seen_through_what_stands_before_them() {
    let Some(gpu) = gpu("bodies_are_seen_through_what_stands_before_them") else { return };
    let view = "[view]\nsize = [320, 240]\nlabels = []\n\
                camera = { target = [0, 0.2, 0], distance = 2, azimuth = 0, elevation = 0.1 }\n";
    let solids =
        ["'box'\ncentre = [0, 0.2, 0.4]\nsize = [0.4, 0.4, 0.1]\n", "'sphere'\ncentre = [0, 0.2, 0.5]\nradius = 0.2\n"];
    for solid in solids {
        let both = picture(&scene(&[WORLD, CUBE, FLOOR, "[[obstacle]]\nkind = ", solid, view]), 0);
        let [mut body, mut obstacle] = [both.clone(), both.clone()];
        body.panels[0].obstacles.solids.clear();
        obstacle.panels[0].sound = Mesh::default();
        for picture in [&mut body, &mut obstacle] {
            picture.panels[0].lines.clear();
            picture.panels[0].borders.clear();
        }
        let mut both = both.clone();
        both.panels[0].lines.clear();
        both.panels[0].borders.clear();
        let draw = |picture: &Listed| {
            Renderer::new(gpu, picture.size).and_then(|mut renderer| renderer.draw(picture)).expect("drawn")
        };
        let [both, body, obstacle] = [&both, &body, &obstacle].map(draw);
        let light = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
        let [one, other, mixed] = [&body, &obstacle, &both].map(|image| image.get_pixel(160, 115).0.map(light));
        for at in 0..3 {
            let half = 0.5 * (one[at] + other[at]);
            assert!((mixed[at] - half).abs() < 0.02, "{solid}: {mixed:?}, half of {one:?} and {other:?}");
        }
        // Beside the body, but before the floor.
        let beside = (70..160).filter(|&x| body.get_pixel(x, 115) != obstacle.get_pixel(x, 115));
        let whole = beside.filter(|&x| both.get_pixel(x, 115) == obstacle.get_pixel(x, 115)).count();
        assert!(whole > 5, "{solid}: {whole}");
    }
}

/// Words over plates have a ground of their own.
#[test]
fn words_know_the_plates_behind_them() {
    let corners = [[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]];
    let corners = corners.map(|position| PaneCorner { position, ..PaneCorner::default() }).to_vec();
    let mut panel = Panel { viewport: [100, 0, 200, 100], ..Panel::default() };
    panel.sight.near = 0.1;
    panel.obstacles.panes = vec![Pane { corners, ..Pane::default() }];
    // In the middle of the lower half: from 150 to 250 px across, from 50 to 75 px down.
    for (bounds, is_over) in [
        ([160.0, 60.0, 170.0, 70.0], true),
        ([110.0, 60.0, 151.0, 70.0], true),
        ([110.0, 60.0, 149.0, 70.0], false),
        ([160.0, 30.0, 170.0, 49.0], false),
        ([160.0, 76.0, 170.0, 90.0], false),
    ] {
        assert_eq!(panel.has_pane_at(bounds), is_over, "{bounds:?}");
    }
    // A corner behind the viewer may be anywhere.
    panel.sight.near = 2.0;
    assert!(panel.has_pane_at([0.0, 0.0, 1.0, 1.0]));
    panel.obstacles.panes.clear();
    assert!(!panel.has_pane_at([0.0, 0.0, 1.0, 1.0]));
}

/// Grips do not mark nodes whose elements are all broken.
#[test]
fn nodes_without_elements_have_no_marks() {
    let scene = scene(&[WORLD, CUBE, FLOOR, "[[hold]]\nnodes = [0, 7]\n"]);
    let mut frame = frame(&scene, 0);
    let count = |frame: &_| compose(&scene, frame).marks.iter().filter(|mark| mark.shape == "pin").count();
    assert_eq!(count(&frame), 2);
    frame.runs[0].snapshot.broken = vec![true];
    assert_eq!(count(&frame), 0);
}

/// In the plane obstacles have smooth rims of their own.
#[test]
fn rims_fade_with_their_obstacles() {
    let rod = "[[obstacle]]\nkind = 'capsule'\nfrom = [-9, 0.9]\nto = [9, 0.7]\nradius = 0.05\n";
    let view = "[view]\nsize = [320, 240]\nlabels = []\n";
    let fading = picture(&scene(&[WORLD, TRIANGLE, rod, view]), 0);
    let mut bare = fading.clone();
    remove(&mut bare.under, "obstacle");
    let draw = |picture: &Listed| {
        Renderer::new(None, picture.size).and_then(|mut renderer| renderer.draw(picture)).expect("no device is needed")
    };
    let [fading, bare] = [&fading, &bare].map(draw);
    let off = |x: u32| {
        let pixels = (0..240).flat_map(|y| bare.get_pixel(x, y).0.into_iter().zip(fading.get_pixel(x, y).0));
        pixels.map(|(one, other)| one.abs_diff(other)).max().expect("pixels")
    };
    // The layout of the page decides where the rod begins to show.
    let first = (0..160).find(|&x| off(x) > 2).expect("a rod");
    let seen = [0, 4, 10, 18, 58].map(|further| off(first + further));
    assert!(off(2) <= 2 && off(317) <= 2 && seen.is_sorted() && 2 * seen[2] < seen[4], "{first}: {seen:?}");
}

#[test]
fn obstacles_fade_in_figures_of_forces() {
    let fade = |with_rod: bool| {
        let mut figure = Figure::built_in("fig3").expect("a figure of the paper");
        let Content::Forces(forces) = &mut figure.content else { panic!("a figure of forces") };
        if with_rod {
            // Across the whole panel, behind the body.
            let rod = "[[obstacle]]\nkind = 'capsule'\nfrom = [-9, 0, -2]\nto = [9, 0, -2]\nradius = 0.3\n";
            forces.scenes[1].obstacles = scene(&[WORLD, CUBE, rod]).obstacles;
        }
        compose_figure(&figure, &Moments::new(&figure)).expect("room").panels[1].obstacles.fade
    };
    let strength = fade(true).expect("it leaves the panel").strength;
    assert!(fade(false).is_none() && strength[0] == 1.0 && strength[2] == 1.0, "{strength:?}");
}
