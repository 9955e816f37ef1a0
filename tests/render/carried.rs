//! Bodies that carry fine surfaces.

use super::listed::Listed;
use super::{draw, frame, gpu, parse, unknown};
use glam::{DVec3, Vec3};
use image::RgbImage;
use localshape::picture::{LineKind, Mesh, Panel};
use localshape::runner::Frame;
use localshape::scene::Scene;
use localshape::sim::{Assembly, Body, Carried, Weights};
use rayon::ThreadPoolBuilder;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A scene whose bodies carry surfaces.
fn carrying(scene: &Scene, surface: impl Fn(&Body) -> Carried) -> Scene {
    let mut scene = scene.clone();
    for run in &mut scene.runs {
        let carry = |body: &Arc<Body>| {
            let carried = Arc::new(surface(body));
            Arc::new(Body::clone(body).with_carried(carried).expect("points of the body"))
        };
        run.bodies = Arc::new(Assembly::new(run.bodies.bodies().iter().map(carry).collect()));
    }
    scene
}

/// The outer faces of a body.
fn own(body: &Body) -> Carried {
    let mut weights = Weights::default();
    (0..body.len() as u32).for_each(|node| weights.push(&[node], &[1.0]));
    let outer = body.faces().nodes.iter().zip(&body.faces().outer).filter(|(_, outer)| outer.is_none());
    let triangles = outer.flat_map(|(face, _)| (2..face.len()).map(|at| [face[0], face[at - 1], face[at]])).collect();
    Carried { rest: body.rest().to_vec(), triangles, weights }
}

/// A sphere in a body of one cube.
fn sphere(body: &Body) -> Carried {
    const ROWS: u32 = 12;
    const COLUMNS: u32 = 24;
    let (low, high) = (body.rest()[0], body.rest()[body.len() - 1]);
    let mut carried = Carried { rest: Vec::new(), triangles: Vec::new(), weights: Weights::default() };
    let mut add = |polar: f64, round: f64| {
        let way = DVec3::new(polar.sin() * round.cos(), polar.cos(), polar.sin() * round.sin());
        let share = DVec3::splat(0.5) + 0.45 * way;
        let weight = |&node: &u32| {
            let end = (body.rest()[node as usize] - low) / (high - low);
            (end * share + (1.0 - end) * (1.0 - share)).to_array().iter().product()
        };
        let weights: Vec<f64> = body.elements()[0].iter().map(weight).collect();
        carried.weights.push(&body.elements()[0], &weights);
        carried.rest.push(low + share * (high - low));
    };
    add(0.0, 0.0);
    add(PI, 0.0);
    for row in 1..ROWS {
        (0..COLUMNS)
            .for_each(|at| add(PI * f64::from(row) / f64::from(ROWS), TAU * f64::from(at) / f64::from(COLUMNS)));
    }
    let at = |row: u32, column: u32| match row {
        0 => 0,
        ROWS => 1,
        _ => 2 + (row - 1) * COLUMNS + column % COLUMNS,
    };
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
            carried.triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    carried
}

/// A scene with a block of cells along each edge, whose nodes fall on a floor, and more keys of the view.
fn block(cells: u32, view: &str) -> Scene {
    parse(&format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = 1, step = 'T/50' }}
        contact = {{ rule = 'nodes' }}
        [[body]]
        lattice = {{ cells = [{cells}, {cells}, {cells}], side = 0.1 }}
        lowest = 0.05
        [[obstacle]]
        kind = 'floor'
        [[run]]
        name = 'one'
        model = {{ kind = 'shape-based', stiffness = 1e6, damping_ratio = 0.1 }}
        [view]
        {view}"
    ))
}

fn picture(scene: &Scene, index: u64) -> Listed {
    unknown(scene).compose(&frame(scene, index))
}

/// The number of lines of a kind.
fn count(panel: &Panel, kind: LineKind) -> usize {
    panel.lines.iter().filter(|line| line.kind == kind).count()
}

/// The share of pixels of two images that differ by more than this.
fn apart(one: &RgbImage, other: &RgbImage, by: u8) -> f64 {
    let differ = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| (0..3).any(|at| a[at].abs_diff(b[at]) > by);
    let count = one.pixels().zip(other.pixels()).filter(|&two| differ(two)).count();
    count as f64 / one.pixels().len() as f64
}

#[test]
fn a_block_that_carries_its_own_faces_looks_the_same() {
    let Some(gpu) = gpu("a_block_that_carries_its_own_faces_looks_the_same") else { return };
    let mut plain = block(3, "edges = 'outline'");
    let initial = &mut plain.runs[0].initial.position;
    let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 0.0, 1.0).normalize(), 0.4);
    initial.iter_mut().for_each(|at| *at = turn * *at + 0.1 * DVec3::Y);
    for index in [0, 12] {
        let [one, other] = [plain.clone(), carrying(&plain, own)].map(|scene| draw(gpu, &picture(&scene, index)));
        // Contours of carried surfaces are joined at corners. Goldens tolerate 1 % and 0.03 %.
        let shares = [2, 16].map(|by| apart(&one, &other, by));
        assert!(shares.iter().all(|share| *share < 3e-4), "{index}: {shares:?}");
    }
}

#[test]
fn cubes_keep_their_creases_and_spheres_are_smooth() {
    let plain = block(1, "");
    let normals = |picture: &Listed| -> Vec<(Vec3, Vec3)> {
        let vertices = picture.panels[0].sound.vertices.iter();
        vertices.map(|vertex| (Vec3::from(vertex.position), Vec3::from(vertex.normal))).collect()
    };
    let of_cube = normals(&picture(&carrying(&plain, own), 0));
    assert_eq!(of_cube.len(), 24);
    assert!(of_cube.iter().all(|(_, normal)| normal.abs().max_element() > 0.9999), "{of_cube:?}");
    // With the weights by Max, normals are exact on spheres.
    let picture = picture(&carrying(&plain, sphere), 0);
    let of_sphere = normals(&picture);
    assert_eq!(of_sphere.len(), 2 + 11 * 24);
    let middle = of_sphere.iter().map(|(at, _)| *at).sum::<Vec3>() / of_sphere.len() as f32;
    let eye = picture.panels[0].sight.eye;
    for (at, normal) in of_sphere.into_iter().filter(|(at, normal)| normal.dot((eye - at).normalize()).abs() > 0.02) {
        assert!((normal - (at - middle).normalize()).length() < 1e-4, "{at} {normal}");
    }
    // Its far side is not drawn, and its only lines are its outline.
    let panel = &picture.panels[0];
    assert!(panel.sound.triangles.len() < 12 * 24, "{}", panel.sound.triangles.len());
    assert_eq!(count(panel, LineKind::FineContour), panel.lines.len());
    assert!(panel.lines.len() > 20);
}

#[test]
fn fields_are_carried_to_the_points() {
    for by in ["speed", "strain"] {
        let plain = block(2, &format!("colour = {{ by = '{by}', range = [0, 1] }}"));
        let mut found = Vec::new();
        for scene in [plain.clone(), carrying(&plain, own)] {
            let sound = &picture(&scene, 10).panels[0].sound;
            assert_eq!(sound.shades.len(), sound.vertices.len());
            let mut values: Vec<_> =
                sound.vertices.iter().zip(&sound.shades).map(|(vertex, &shade)| (vertex.position, shade)).collect();
            values.sort_by(|one, other| one.0.partial_cmp(&other.0).expect("numbers"));
            found.push(values);
        }
        for (at, shade) in &found[1] {
            let beside = found[0].iter().filter(|(other, _)| Vec3::from(*other).distance((*at).into()) < 1e-5);
            let shades: Vec<_> = beside.map(|(_, shade)| *shade).collect();
            // Values of elements are means at their nodes.
            let mean = shades.iter().sum::<f32>() / shades.len() as f32;
            let (most, off) = (shades.iter().copied().fold(0.0, f32::max), (shade - mean).abs());
            assert!(
                most > 0.0 && off < if by == "speed" { 1e-6 } else { 0.5 * most },
                "{by} {at:?}: {shade} {shades:?}"
            );
        }
    }
}

#[test]
fn turned_over_elements_are_seen_on_a_surface_and_in_it_and_others_when_asked() {
    let without = picture(&carrying(&block(3, ""), own), 0);
    assert_eq!(count(&without.panels[0], LineKind::Edge), 0);
    // Three sides of 24 edges, which share nine.
    let scene = carrying(&block(3, "show = ['cage']"), own);
    assert!(scene.view.visible.surfaces);
    let with = picture(&scene, 0);
    assert_eq!(count(&with.panels[0], LineKind::Edge), 3 * 24 - 9);
    assert_eq!(with.panels[0].sound, without.panels[0].sound);
    // Through the surface, of which then the far side is drawn, too.
    let scene = carrying(&block(3, ""), own);
    let mut turned: Frame = frame(&scene, 0);
    turned.runs[0].snapshot.turned_over[13] = true;
    let panel = &unknown(&scene).compose(&turned).panels[0];
    assert_eq!((count(panel, LineKind::AlarmEdge), panel.sound.triangles.len()), (12, 6 * 9 * 2));
    // A turned-over element that moves a part of the surface has that part, with a hatch.
    turned.runs[0].snapshot.turned_over[13] = false;
    turned.runs[0].snapshot.turned_over[0] = true;
    let panel = &unknown(&scene).compose(&turned).panels[0];
    assert_eq!([&panel.turned_over, &panel.sound].map(|mesh| mesh.triangles.len()), [6, 6 * 9 * 2 - 6]);
    assert_eq!(count(panel, LineKind::AlarmEdge), 0);
    let hatches = || panel.turned_over.vertices.iter().map(|vertex| vertex.hatch);
    assert!(hatches().fold(f32::MIN, f32::max) - hatches().fold(f32::MAX, f32::min) > 0.5);
    assert_eq!(without.panels[0].sound.triangles.len(), 3 * 9 * 2);
}

/// A square of two triangles whose corners lie in the middles of four cells of a layer.
fn square(body: &Body) -> Carried {
    let mut carried = Carried { rest: Vec::new(), triangles: vec![[0, 1, 3], [0, 3, 2]], weights: Weights::default() };
    for nodes in body.elements().iter().take(4) {
        carried.rest.push(nodes.iter().map(|&node| body.rest()[node as usize]).sum::<DVec3>() / 8.0);
        carried.weights.push(nodes, &[0.125; 8]);
    }
    carried
}

/// The area of a mesh (squares of a side).
fn area(mesh: &Mesh) -> f32 {
    let corner = |at: u32| Vec3::from(mesh.vertices[at as usize].position);
    let of = |[a, b, c]: [u32; 3]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    mesh.triangles.iter().map(|&triangle| of(triangle)).sum()
}

/// Triangles that cross the border of a turned-over cell are cut at it.
#[test]
fn the_border_of_turned_over_elements_is_where_they_end() {
    let scene = carrying(&block(2, ""), square);
    let mut turned: Frame = frame(&scene, 0);
    // One cell has a quarter of the square, and three cells have three.
    for cell in 0..3 {
        turned.runs[0].snapshot.turned_over[cell] = true;
        let panel = &unknown(&scene).compose(&turned).panels[0];
        let [over, sound] = [&panel.turned_over, &panel.sound].map(area);
        let expected = [0.25, 0.5, 0.75][cell];
        assert!((over - expected).abs() < 1e-4 && (sound + over - 1.0).abs() < 1e-4, "{cell}: {over} {sound}");
        // Its outline is half a side in each cell at the border, and one kind of line.
        let border = panel.lines.iter().filter(|line| line.kind == LineKind::AlarmContour);
        let length: f32 = border.map(|line| Vec3::from(line.from).distance(line.to.into())).sum();
        assert!((length - 1.0).abs() < 1e-4, "{cell}: {length}");
    }
}

/// In bodies of more than 200 elements the outline of what has turned over is drawn, and no edges of single elements through the body.
#[test]
fn many_turned_over_elements_have_one_outline() {
    let alarm = |cells: u32| {
        let scene = block(cells, "");
        let mut turned: Frame = frame(&scene, 0);
        turned.runs[0].snapshot.turned_over.iter_mut().step_by(3).for_each(|over| *over = true);
        let picture = unknown(&scene).compose(&turned);
        let edges = picture.panels[0].lines.iter().filter(|line| line.kind == LineKind::AlarmEdge);
        let seen_through = edges.filter(|line| line.strength > 0.0).count();
        (picture.panels[0].sight.folds, seen_through, count(&picture.panels[0], LineKind::AlarmContour))
    };
    let (few, many) = (alarm(5), alarm(6));
    assert!(few.0 > 0.0 && few.1 > 0 && few.2 > 0, "{few:?}");
    assert!(many.0 == 0.0 && many.1 == 0 && many.2 > 0, "{many:?}");
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let scene = carrying(&block(20, "colour = { by = 'speed', range = [0, 1] }"), own);
    let frame = frame(&scene, 2);
    let [one, other] = [1, 4].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| unknown(&scene).compose(&frame))
    });
    assert_eq!(one, other);
}
