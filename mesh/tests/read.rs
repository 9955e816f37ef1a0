//! Files of every format are read, and broken ones are told.

use glam::DVec3;
use localshape_mesh::{CellKind, Format, Limits, Mesh, Surface, Volume, read, read_cells};
use localshape_sim::geometry::{kind, volume_by_faces};
use localshape_sim::{Dimension, ElementKind, Solids};

const LIMITS: Limits = Limits { points: 1_000_000, corners: 8_000_000 };

fn surface(bytes: &[u8], format: Format) -> Surface {
    match read(bytes, format, &LIMITS) {
        Ok(Mesh::Surface(surface)) => surface,
        other => panic!("{other:?}"),
    }
}

fn volume(bytes: &[u8], format: Format) -> Volume {
    match read(bytes, format, &LIMITS) {
        Ok(Mesh::Volume(volume)) => volume,
        other => panic!("{other:?}"),
    }
}

/// The message and the remedy of a refusal.
fn refusal(bytes: &[u8], format: Format) -> String {
    let error = read(bytes, format, &LIMITS).expect_err("a refusal");
    format!("{} ({})", error.message, error.help.expect("a remedy"))
}

/// The volume inside a closed surface.
fn inside(surface: &Surface) -> f64 {
    let at = |point: u32| surface.points[point as usize];
    surface.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

/// The corners of a unit cube, x fastest, then y, then z.
fn corners() -> [DVec3; 8] {
    std::array::from_fn(|bits| DVec3::new((bits & 1) as f64, (bits >> 1 & 1) as f64, (bits >> 2) as f64))
}

/// The sides of a unit cube, counter-clockwise from outside.
const SIDES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The triangles of a unit cube.
fn triangles() -> Vec<[usize; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

fn lines(points: impl IntoIterator<Item = DVec3>) -> String {
    points.into_iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect()
}

fn check_cube(surface: &Surface) {
    assert_eq!(surface.points.len(), 8);
    assert_eq!(surface.triangles.len(), 12);
    assert!((inside(surface) - 1.0).abs() < 1e-12, "{}", inside(surface));
}

#[test]
fn a_cube_is_read_from_obj() {
    let mut text = String::from("# a cube\nmtllib none.mtl\no cube\n");
    for point in corners() {
        text += &format!("v {} {} {} 1.0\nvt 0 0\n", point.x, point.y, point.z);
    }
    text += "usemtl red\ns off\n";
    for [a, b, c, d] in &SIDES[..3] {
        text += &format!("f {}/1 {}//2 {} \\\n {}/1/1\n", a + 1, b + 1, c + 1, d + 1);
    }
    // Counted backwards.
    for side in &SIDES[3..] {
        text += &format!("f {}\r\n", side.map(|corner| (corner as i64 - 8).to_string()).join(" "));
    }
    check_cube(&surface(text.as_bytes(), Format::Obj));
}

#[test]
fn a_cube_is_read_from_off() {
    let faces: String =
        SIDES.iter().map(|side| format!("4 {}  255 0 0\n", side.map(|corner| corner.to_string()).join(" "))).collect();
    for header in ["OFF\n# a cube\n8 6 0\n", "OFF 8 6 12\n", "COFF\n\n8 6\n"] {
        check_cube(&surface(format!("{header}{}{faces}", lines(corners())).as_bytes(), Format::Off));
    }
}

/// Binary numbers of either order of bytes.
fn number(bytes: &[u8], is_big: bool) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if is_big {
        bytes.reverse();
    }
    bytes
}

#[test]
fn a_cube_is_read_from_ply() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a cube\nelement vertex 8\nproperty uchar red\nproperty float x\n\
             property double y\nproperty float z\nelement face 6\nproperty list uchar float uv\n\
             property list uchar int vertex_indices\nelement nothing 4000000000\nend_header\n"
        )
    };
    let mut text = header("ascii");
    for point in corners() {
        text += &format!("255 {} {} {}\n", point.x, point.y, point.z);
    }
    for side in SIDES {
        text += &format!("2 0.5 0.5 4 {}\n", side.map(|corner| corner.to_string()).join(" "));
    }
    check_cube(&surface(text.as_bytes(), Format::Ply));
    for (name, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = header(name).into_bytes();
        for point in corners() {
            bytes.push(255);
            bytes.extend(number(&(point.x as f32).to_le_bytes(), is_big));
            bytes.extend(number(&point.y.to_le_bytes(), is_big));
            bytes.extend(number(&(point.z as f32).to_le_bytes(), is_big));
        }
        for side in SIDES {
            bytes.push(1);
            bytes.extend(number(&0.5f32.to_le_bytes(), is_big));
            bytes.push(4);
            side.iter().for_each(|&corner| bytes.extend(number(&(corner as i32).to_le_bytes(), is_big)));
        }
        check_cube(&surface(&bytes, Format::Ply));
        let cut = refusal(&bytes[..bytes.len() - 3], Format::Ply);
        let length = bytes.len() - 3;
        assert_eq!(
            cut,
            format!(
                "ends at byte {length}; expected the index of a point (the file is incomplete: copy, download or write it again)"
            )
        );
    }
}

#[test]
fn strips_of_ply_alternate() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                element tristrips 1\nproperty list int int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 1\n1 1 1\n0 2 2\n9 0 1 2 3 4 -1 0 1 2\n";
    let found = surface(text.as_bytes(), Format::Ply);
    assert_eq!(found.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [0, 1, 2]]);
}

fn stl() -> (String, Vec<u8>) {
    let mut text = String::from("solid a cube of facet\n");
    let mut binary = b"solid but binary".to_vec();
    binary.resize(80, b' ');
    binary.extend(12u32.to_le_bytes());
    for triangle in triangles() {
        text += " facet normal 0 0 0\n  outer loop\n";
        binary.extend([0; 12]);
        for corner in triangle.map(|corner| corners()[corner]) {
            text += &format!("   vertex {:e} {} {}\n", corner.x, corner.y, corner.z);
            corner.to_array().iter().for_each(|&value| binary.extend((value as f32).to_le_bytes()));
        }
        text += "  endloop\n endfacet\n";
        binary.extend([7, 7]);
    }
    (text + "endsolid a cube\n", binary)
}

#[test]
fn a_cube_is_read_from_stl() {
    let (text, binary) = stl();
    check_cube(&surface(text.as_bytes(), Format::Stl));
    check_cube(&surface(&binary, Format::Stl));
    assert!(
        refusal(&binary[..400], Format::Stl).starts_with("ends after 6 triangles; expected 12 by its binary header"),
    );
    assert!(refusal(text[..300].trim_end().as_bytes(), Format::Stl).starts_with("ends in line "));
}

#[test]
fn a_concave_polygon_keeps_its_area_and_its_corners_on_straight_sides() {
    // A comb with a corner on its straight back, in several planes and from either side.
    let flat =
        [[0., 0.], [6., 0.], [6., 4.], [5., 4.], [5., 1.], [4., 1.], [4., 4.], [3., 4.], [3., 1.], [2., 1.], [2., 4.]];
    let flat = [&flat[..], &[[0., 4.], [0., 2.], [0., 1.]]].concat();
    let area = 6.0 * 4.0 - 2.0 * 3.0;
    for turn in 0..3 {
        for back in [false, true] {
            let mut points: Vec<DVec3> = flat
                .iter()
                .map(|&[x, y]| {
                    let mut point = [x, y, 0.25 * x];
                    point.rotate_right(turn);
                    DVec3::from(point)
                })
                .collect();
            if back {
                points.reverse();
            }
            let text = format!(
                "OFF\n{} 1 0\n{}{} {}\n",
                points.len(),
                lines(points.iter().copied()),
                points.len(),
                (0..points.len()).map(|at| at.to_string()).collect::<Vec<_>>().join(" ")
            );
            let found = surface(text.as_bytes(), Format::Off);
            assert_eq!(found.triangles.len(), points.len() - 2);
            let whole: DVec3 = (0..points.len()).map(|at| points[at].cross(points[(at + 1) % points.len()])).sum();
            let mut sum = 0.0;
            for &corners in &found.triangles {
                let [a, b, c] = corners.map(|corner| found.points[corner as usize]);
                let normal = (b - a).cross(c - a);
                assert!(normal.dot(whole) > 0.0, "{corners:?} is turned over or flat");
                sum += 0.5 * normal.length();
            }
            assert!((sum - area * (1.0f64 + 0.25 * 0.25).sqrt()).abs() < 1e-12, "{sum}");
        }
    }
}

#[test]
fn a_polygon_that_crosses_itself_is_divided_somehow() {
    let text = "OFF\n5 1 0\n0 0 0\n2 2 1\n2 0 0\n0 2 1\n1 3 0\n5 0 1 2 3 4\n";
    assert_eq!(surface(text.as_bytes(), Format::Off).triangles.len(), 3);
}

#[test]
fn faces_in_a_plane_are_a_volume_of_it_and_turned_counter_clockwise() {
    // A triangle, a clockwise one, and a quadrilateral whose corners are listed along its axes.
    let points = "9 9 9\n0 0 2\n1 0 2\n0 1 2\n1 1 2\n2 0 2\n2 1 2\n";
    let faces = "3 1 2 3\n3 2 3 4\n4 2 5 4 6\n";
    let text = format!(
        "# vtk DataFile Version 3.0\nfaces\nASCII\nDATASET POLYDATA\nPOINTS 7 double\n{points}POLYGONS 3 13\n{faces}"
    );
    let found = volume(text.as_bytes(), Format::Vtk);
    assert_eq!(found.dimension, Dimension::Plane);
    assert_eq!(found.points.len(), 6, "a point without faces is dropped");
    assert_eq!(found.turned, 2);
    let areas = found.cells.iter().map(|cell| volume_by_faces(ElementKind::Polygon, cell, &found.points));
    assert_eq!(areas.collect::<Vec<_>>(), [0.5, 0.5, 1.0]);
    // A format of surfaces alone says that they bound something.
    let text = format!("OFF\n7 3 0\n{points}{faces}");
    assert_eq!(surface(text.as_bytes(), Format::Off).triangles.len(), 4);
}

#[test]
fn cells_are_given_as_they_are_listed() {
    let text = "OFF\n4 2 0\n9 9 9\n0 0 0\n1 0 1\n0 1 1\n3 1 2 3\n2 1 2\n";
    let found = read_cells(text.as_bytes(), Format::Off, &LIMITS).expect("sound");
    assert_eq!(found.points.len(), 4);
    assert_eq!(found.kinds, [CellKind::Polygon, CellKind::Line]);
    assert_eq!(&found.corners[0], [1, 2, 3]);
}

#[test]
fn elements_of_files_without_solids_are_faces_or_else_lines() {
    let elements = |lists: &str, dimension| {
        let text = format!("OFF\n6 {} 0\n9 9 9\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n{lists}", lists.lines().count());
        read_cells(text.as_bytes(), Format::Off, &LIMITS).expect("sound").elements(dimension)
    };
    let found = |lists: &str, dimension| {
        let Volume { places, cells, turned, .. } = elements(lists, dimension).expect("elements");
        (places, cells.iter().map(<[u32]>::to_vec).collect::<Vec<_>>(), turned)
    };
    // Clockwise in the plane.
    assert_eq!(found("4 4 3 2 1\n2 1 5\n", Dimension::Plane), (vec![1, 2, 3, 4], vec![vec![0, 1, 2, 3]], 1));
    let triangles = vec![vec![0, 1, 2], vec![0, 2, 3]];
    assert_eq!(found("4 1 2 3 4\n2 1 5\n", Dimension::Space), (vec![1, 2, 3, 4], triangles, 0));
    assert_eq!(found("2 1 5\n2 5 3\n", Dimension::Space), (vec![1, 3, 5], vec![vec![0, 2], vec![2, 1]], 0));
    let error = elements("1 2\n", Dimension::Space).expect_err("points only");
    assert_eq!(error.message, "has 6 points, but neither faces nor cells");
}

#[test]
fn refusals_say_where_and_what_to_do() {
    use Format::{Gltf, Obj, Off, Ply, Stl, Vtu};
    let damaged = "(the file is damaged: copy, download or write it again)";
    let incomplete = "(the file is incomplete: copy, download or write it again)";
    for (format, text, expected) in [
        (Off, "", format!("is empty {incomplete}")),
        (Off, "OFF\n8 6 0\n0 0", format!("ends in line 3; expected a coordinate {incomplete}")),
        (Off, "OFF\n8 6 0\n0 0\n1 2 3", format!("has nothing more in line 3; expected a coordinate {damaged}")),
        (Off, "OFF\n8 6 0\n0 0 0\n", format!("ends in line 4; expected point 2 of 8 {incomplete}")),
        (Off, "OFF\n1 1 0\n0 0 x\n", format!("has `x` in line 3; expected a coordinate {damaged}")),
        (
            Off,
            "OFF\n1 1 0\n0 0 nan\n3 0 0 0\n",
            "has point 0 without coordinates in line 3, and a face with it; expected numbers (remove".to_owned(),
        ),
        (
            Off,
            "OFF\n1 1 0\n0 0 1e300\n",
            "has point 0 at [0.0, 0.0, 1e300]; expected coordinates up to 1e100 ".to_owned(),
        ),
        (Off, "OFF\n1 1 0\n0 0 0\n3 0 0 7\n", format!("names point 7 in line 4, but has points 0 to 0 {damaged}")),
        (Off, "OFF\n1 1 0\n0 0 0\n3 0 0 -7\n", format!("names a point that it does not have in line 4 {damaged}")),
        (Off, "OFF\n99999999999 1 0\n", "has 99999999999 points; at most 1000000 are read (make".to_owned()),
        (Off, "4OFF\n1 1 0\n", "has `4OFF` in line 1; expected points in space: `OFF`".to_owned()),
        (
            Off,
            "OFF\n2 1 0\n0 0 0\n1 1 1\n4 0 1 1 0\n",
            "has faces with less than three different corners only (mesh".to_owned(),
        ),
        (Off, "what\n", "begins with `what`; expected `OFF`, as an OFF file does (check".to_owned()),
        (
            Obj,
            "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 4\n",
            format!("names point 4 in line 4, but has points 1 to 3 {damaged}"),
        ),
        (Obj, "f 1 2 4\n", format!("names point 4 in line 1, but has no points {damaged}")),
        (
            Obj,
            "v 0 0 0\nf 0 1 1\n",
            format!("has `0` in line 2; expected the number of a point, counted from 1 {damaged}"),
        ),
        (Obj, "v 0 0 0\nv 0 0 1\nl 1 2\n", "has 2 points, but neither faces nor cells (write".to_owned()),
        (Obj, "hello world\n", "has `hello` in line 1; expected `v`, `f` or another keyword of OBJ".to_owned()),
        (Ply, "ply\nformat ascii 1.0\n", format!("ends in line 3; expected `end_header` {incomplete}")),
        (Ply, "ply\nformat utf8 1.0\n", "has `utf8` in line 2; expected `ascii`, `binary_little_endian`".to_owned()),
        (
            Stl,
            "solid\nfacet\nvertex 0 0 0\nvertex 0 0\nendloop",
            format!("has `endloop` in line 5; expected a coordinate {damaged}"),
        ),
        (
            Obj,
            "<!DOCTYPE html>\n<p>not found",
            "is a page of the Web (HTML), and no mesh file (the download gave".to_owned(),
        ),
        (
            Obj,
            "OFF\n1 0 0\n",
            "has the content of an OFF file, but the ending of an OBJ file (name it `.off`)".to_owned(),
        ),
        (
            Ply,
            "solid a\nfacet normal",
            "has the content of an STL file, but the ending of a PLY file (name it `.stl`)".to_owned(),
        ),
        (Vtu, "{}", "has the content of a glTF file, but the ending of a VTU file (name it `.gltf`)".to_owned()),
        (Gltf, "\u{1f}\u{fffd}", String::new()),
    ] {
        if !expected.is_empty() {
            let found = refusal(text.as_bytes(), format);
            assert!(found.starts_with(&expected), "{text:?}: {found}\nexpected: {expected}");
        }
    }
    let (_, binary) = stl();
    assert!(refusal(&binary, Obj).starts_with("has "), "a binary STL file named .obj");
}

/// A file in `tests/files`, which Gmsh 4.15, VTK 9.7 or a script of a few lines has written.
fn file(name: &str) -> (Vec<u8>, Format) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name);
    let ending = name.rsplit('.').next().expect("an ending");
    (std::fs::read(path).expect("a file"), Format::of(ending).expect("a format"))
}

/// The volume of all cells that have the order of their kind.
fn whole(volume: &Volume) -> f64 {
    let of = |cell: &[u32]| volume_by_faces(kind(volume.dimension, volume.solids, cell.len()), cell, &volume.points);
    volume.cells.iter().map(of).sum()
}

#[test]
fn cells_and_groups_are_read_from_gmsh() {
    let mut points = Vec::new();
    for name in ["bar-2.2.msh", "bar-2.2-binary.msh", "bar-4.1.msh", "bar-4.1-binary.msh"] {
        let (bytes, format) = file(name);
        let found = volume(&bytes, format);
        assert_eq!((found.dimension, found.turned), (Dimension::Space, 0), "{name}");
        assert!(found.cells.iter().all(|cell| cell.len() == 4), "{name}");
        assert!((whole(&found) - 2.0).abs() < 1e-12, "{name}: {}", whole(&found));
        let names: Vec<&str> = found.groups.iter().map(|group| &*group.name).collect();
        assert_eq!(names, ["bar", "both ends", "left", "surface 9"], "{name}");
        // A box of 2 × 1 × 1 from the origin along x.
        let at = |group: usize| found.groups[group].points.iter().map(|&point| found.points[point as usize].x);
        assert_eq!(found.groups[0].points.len(), found.points.len(), "{name}");
        assert!(at(1).any(|x| x == 0.0) && at(1).any(|x| x == 2.0) && at(1).all(|x| x == 0.0 || x == 2.0), "{name}");
        assert!(at(2).all(|x| x == 0.0) && at(3).all(|x| x == 2.0), "{name}");
        points.push(found.points.len());
    }
    assert!(points.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn corners_of_second_order_elements_in_a_plane_are_read() {
    let (bytes, format) = file("sheet-4.1.msh");
    let found = volume(&bytes, format);
    assert_eq!((found.dimension, found.turned), (Dimension::Plane, 0));
    assert!(found.points.iter().all(|point| point.z == 0.0), "it lies at z = 3 in the file");
    assert!((whole(&found) - 2.0).abs() < 1e-12);
    assert_eq!(found.groups.iter().map(|group| &*group.name).collect::<Vec<_>>(), ["left edge", "sheet"]);
    assert!(found.groups[0].points.iter().all(|&point| found.points[point as usize].x == 0.0));
}

#[test]
fn cells_of_all_kinds_are_read_from_vtk_files_in_every_coding() {
    let mut first = None;
    for name in [
        "cells-4.2.vtk",
        "cells-4.2-binary.vtk",
        "cells-5.1.vtk",
        "cells-5.1-binary.vtk",
        "cells-text.vtu",
        "cells-packed.vtu",
        "cells-plain.vtu",
        "cells-raw.vtu",
        "cells-raw-packed.vtu",
        "cells-base64.vtu",
    ] {
        let (bytes, format) = file(name);
        let found = volume(&bytes, format);
        // Two tetrahedra, one of them turned over, a pyramid, a wedge, and four cubes: listed around, along their axes where they
        // should be listed around, as a voxel, and by faces.
        let measures: Vec<f64> = found
            .cells
            .iter()
            .map(|cell| volume_by_faces(kind(found.dimension, found.solids, cell.len()), cell, &found.points))
            .collect();
        let expected = [1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0, 0.5, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(measures.len(), expected.len(), "{name}");
        assert!(
            measures.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12),
            "{name}: {measures:?}"
        );
        assert_eq!((found.turned, found.solids), (2, Solids::Ordered), "{name}");
        let listed = read_cells(&bytes, format, &LIMITS).expect("sound");
        assert_eq!(
            listed.points.len(),
            found.points.len() + 1 + 3 + 2 + 1,
            "{name}: points of other cells and of none"
        );
        assert_eq!(listed.kinds.len(), 11, "{name}");
        // Moments of a recording find their points by their places.
        let points: Vec<DVec3> = found.places.iter().map(|&place| listed.points[place as usize]).collect();
        assert_eq!(points, found.points, "{name}");
        assert_eq!(listed.elements(Dimension::Space).expect("cells"), found, "{name}");
        assert_eq!(*first.get_or_insert(found.clone()), found, "{name}");
    }
}

#[test]
fn other_polyhedra_make_all_cells_hulls() {
    let (bytes, format) = file("hulls.vtu");
    let found = volume(&bytes, format);
    assert_eq!(found.solids, Solids::Convex);
    assert_eq!(found.cells.iter().map(<[u32]>::len).collect::<Vec<_>>(), [6, 4]);
}

#[test]
fn a_cube_is_read_from_files_of_every_format_of_surfaces() {
    for name in [
        "cube.obj",
        "cube.off",
        "cube.ply",
        "cube-text.ply",
        "cube.stl",
        "cube-text.stl",
        "cube.vtk",
        "cube-binary.vtk",
        "cube.vtp",
    ] {
        let (bytes, format) = file(name);
        check_cube(&surface(&bytes, format));
    }
}

#[test]
fn nodes_of_gltf_move_turn_and_mirror_meshes() {
    // A unit cube, and one that is mirrored, stretched to 2, turned by a quarter, and moved. Points of another part are left out.
    let (bytes, format) = file("cubes.glb");
    let found = surface(&bytes, format);
    assert_eq!((found.points.len(), found.triangles.len()), (16, 24));
    assert!((inside(&found) - 3.0).abs() < 1e-6, "both look out: {}", inside(&found));
    let (low, high) = localshape_sim::geometry::bounds(&found.points);
    assert!(low.distance(DVec3::new(10.0, -2.0, 0.0)) < 1e-6, "{low}");
    assert!(high.distance(DVec3::new(15.0, 1.0, 1.0)) < 1e-6, "{high}");
    // As text, with one corner raised by 1 by a sparse list.
    let (bytes, format) = file("cubes.gltf");
    let found = surface(&bytes, format);
    assert!((inside(&found) - 4.0).abs() < 1e-6, "{}", inside(&found));
}

#[test]
fn files_cut_anywhere_are_refused_with_a_remedy_or_read() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files")).expect("files") {
        let name = entry.expect("a file").file_name().into_string().expect("a name");
        let (bytes, format) = file(&name);
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 200) {
            if let Err(error) = read(&bytes[..length], format, &LIMITS) {
                assert!(error.help.is_some() && !error.message.contains('\n'), "{name} cut to {length} bytes: {error}");
            }
        }
    }
}

#[test]
fn limits_hold() {
    let limits = Limits { points: 7, corners: 1000 };
    let text = format!("OFF\n8 0 0\n{}", lines(corners()));
    let error = read(text.as_bytes(), Format::Off, &limits).expect_err("a limit");
    assert_eq!(error.message, "has 8 points; at most 7 are read");
    let obj: String = corners().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let error = read(obj.as_bytes(), Format::Obj, &limits).expect_err("a limit");
    assert_eq!(error.message, "has more than 7 points; at most 7 are read");
    let limits = Limits { points: 8, corners: 35 };
    let (text, _) = stl();
    let error = read(text.as_bytes(), Format::Stl, &limits).expect_err("a limit");
    assert_eq!(error.message, "has more than 35 corners; at most 35 are read");
}

/// The time is bounded for hostile polygons, too.
#[test]
fn a_polygon_with_very_many_teeth_is_refused_or_read() {
    let teeth = 100_000;
    let mut text = format!("OFF\n{} 1 0\n", 2 * teeth + 1);
    for tooth in 0..2 * teeth {
        text +=
            &format!("{tooth} {} {}\n", if tooth % 2 == 0 { 1.0 } else { 1000.0 - 1e-3 * f64::from(tooth) }, tooth % 3);
    }
    text += &format!("{teeth} -1e6 0\n{}", 2 * teeth + 1);
    (0..=2 * teeth).for_each(|at| text += &format!(" {at}"));
    let found = read(text.as_bytes(), Format::Off, &LIMITS);
    let error = found.expect_err("too much work");
    assert!(error.message.starts_with("has concave faces that take too long to divide"), "{error}");
}

#[test]
fn a_cell_listed_twice_is_turned_over_once() {
    let cell = "4 0 2 1 3\n";
    let text = format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 2 2 2\n\
         CELLS 3 14\n{cell}{cell}3 0 1 4\nCELL_TYPES 3\n10 10 21\n"
    );
    let found = volume(text.as_bytes(), Format::Vtk);
    assert_eq!((found.cells.len(), found.turned, found.points.len()), (1, 1, 4));
    // The point between the ends of a line of second order is left out.
    let listed = read_cells(text.as_bytes(), Format::Vtk, &LIMITS).expect("sound");
    assert_eq!((listed.kinds[2], &listed.corners[2]), (CellKind::Line, &[0, 1][..]));
}

#[test]
fn data_that_are_skipped_may_be_no_numbers() {
    let head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
    let tail = "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    let fields = "FIELD FieldData 2\nnames 1 2 string\na text%20here\n\nheat 2 1 float\nnan -inf\n";
    assert_eq!(surface(format!("{head}{fields}{tail}").as_bytes(), Format::Vtk).triangles.len(), 4);
    let cut = refusal(format!("{head}FIELD FieldData 1\nnames 1 9 string\na\nb\n").as_bytes(), Format::Vtk);
    assert!(cut.starts_with("ends in line 9; expected a text of an array"), "{cut}");
    // In binary, texts follow their lengths of one, two and four bytes.
    let mut bytes = head.replace("ASCII", "BINARY").into_bytes();
    bytes.extend(b"FIELD FieldData 1\nnames 1 3 string\n\xc2\nx\x80\x01y\x40\0\0\x02ab\n");
    bytes.extend(b"POINTS 3 float\n");
    for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0] {
        bytes.extend(number.to_be_bytes());
    }
    bytes.extend(b"\nPOLYGONS 1 4\n");
    for number in [3i32, 0, 1, 2] {
        bytes.extend(number.to_be_bytes());
    }
    assert_eq!(surface(&bytes, Format::Vtk).triangles, [[0, 1, 2]]);
    let stl =
        "solid\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1\nendloop\nendfacet\n";
    assert_eq!(surface(stl.as_bytes(), Format::Stl).triangles.len(), 1);
}

#[test]
fn faces_named_again_and_again_are_refused() {
    let limits = Limits { points: 1000, corners: 1000 };
    let face: String = (0..1000).map(|point| format!("{point} ")).collect();
    let array = |name: &str, numbers: &str| format!("<DataArray type=\"Int64\" Name=\"{name}\">{numbers}</DataArray>");
    let text = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points><DataArray type=\"Float64\">{}</DataArray></Points>\
         <Cells>{}{}{}{}{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        "0 0 1 ".repeat(1000),
        array("connectivity", "0"),
        array("offsets", "1"),
        array("types", "42"),
        array("face_connectivity", &face),
        array("face_offsets", "1000"),
        array("polyhedron_to_faces", &"0 ".repeat(1000)),
        array("polyhedron_offsets", "1000"),
    );
    let error = read(text.as_bytes(), Format::Vtu, &limits).expect_err("a limit");
    assert_eq!(error.message, "has more than 21000 numbers in its arrays and faces");
}

/// Pieces that share packed data cost as much as others.
#[test]
fn data_unpacked_again_and_again_are_refused() {
    let (bytes, format) = file("cells-raw-packed.vtu");
    let place = |part: &[u8]| bytes.windows(part.len()).position(|window| window == part).expect("a part");
    let (start, end) = (place(b"<Piece"), place(b"</Piece>") + 8);
    let many = [&bytes[..start], &bytes[start..end].repeat(100), &bytes[end..]].concat();
    assert_eq!(volume(&many, format).cells.len(), 800);
    let limits = Limits { points: 10_000, corners: 1000 };
    let error = read(&many, format, &limits).expect_err("a limit");
    assert!(error.message.starts_with("has more than "), "{error}");
}

#[test]
fn only_the_first_buffer_of_gltf_is_the_data_of_the_file() {
    let (bytes, format) = file("cubes.glb");
    let text = String::from_utf8_lossy(&bytes[20..]);
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let json = text[..length].trim_end().replacen(
        "\"buffers\": [",
        "\"buffers\": [{\"byteLength\":1,\"uri\":\"data:a;base64,AA==\"},",
        1,
    );
    assert_ne!(json.len(), length, "it has a list of buffers");
    let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
    let rest = &bytes[20 + length..];
    let total = (20 + json.len() + rest.len()) as u32;
    let file = [&bytes[..8], &total.to_le_bytes(), &(json.len() as u32).to_le_bytes(), b"JSON", json.as_bytes(), rest];
    assert!(refusal(&file.concat(), format).starts_with("has no data for its buffer 1 "));
}

/// The file with an array of other displacements.
fn displaced(name: &str, components: usize, numbers: &str) -> String {
    let text = include_str!("files/displaced.vtu");
    let old = "Name=\"U\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 0.5 0 0 0 0.25 0 0 0 -1<";
    assert!(text.contains(old));
    text.replace(old, &format!("Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{numbers}<"))
}

/// Displacements are the point data `U` with two or three components, and are not added to the points.
#[test]
fn displacements_are_read_beside_points() {
    let bytes = include_bytes!("files/displaced.vtu");
    let limits = Limits { points: 4, corners: 4 };
    let cells = read_cells(bytes, Format::Vtu, &limits).unwrap();
    let moved = [DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.25, -DVec3::Z];
    assert_eq!((cells.points[1], cells.displacements.as_deref()), (DVec3::X, Some(&moved[..])));
    let of = |name: &str, components, numbers: &str| {
        read_cells(displaced(name, components, numbers).as_bytes(), Format::Vtu, &limits).unwrap()
    };
    // A scalar of that name is none. Vectors in the plane have z = 0.
    assert_eq!(of("U", 1, "0 0.5 0.25 1").displacements, None);
    let plane = [DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.25, DVec3::new(1.0, 2.0, 0.0)];
    for name in ["U", "displacement", "Displacement"] {
        assert_eq!(of(name, 2, "0 0 0.5 0 0 0.25 1 2").displacements.as_deref(), Some(&plane[..]), "{name}");
    }
    assert_eq!(of("velocity", 2, "0 0 0.5 0 0 0.25 1 2").velocities.as_deref(), Some(&plane[..]));
    // `U` beside a pressure is the velocity of OpenFOAM.
    for (name, is_read) in [("U", false), ("displacement", true)] {
        let pressure = r#"<PointData><DataArray type="Float64" Name="p" format="ascii">1 2 3 4</DataArray>"#;
        let text = displaced(name, 3, "0 0 0 1 0 0 0 2 0 0 0 3").replace("<PointData>", pressure);
        assert!(text.contains(pressure));
        let found = read_cells(text.as_bytes(), Format::Vtu, &limits).unwrap().displacements;
        assert_eq!(found.is_some(), is_read, "{name}");
    }
}

#[test]
fn vectors_of_other_numbers_than_their_points_are_told() {
    for name in ["U", "velocity"] {
        let found = refusal(displaced(name, 3, "0 0 0 1 0 0 0 2 0").as_bytes(), Format::Vtu);
        let expected = format!("has 3 entries in its array `{name}` in line 6; expected 4, one for each point");
        assert!(found.starts_with(&expected), "{found}");
    }
    // Pieces may have none.
    let text = displaced("U", 3, "0 0 0 1 0 0 0 2 0 0 0 3");
    let (start, end) = (text.find("<Piece").unwrap(), text.find("</Piece>").unwrap() + 8);
    let (data, after) = (text.find("<PointData>").unwrap(), text.find("<Points>").unwrap());
    let two = [&text[..end], &text[start..data], &text[after..]].concat();
    let cells = read_cells(two.as_bytes(), Format::Vtu, &LIMITS).unwrap();
    assert_eq!((cells.points.len(), cells.displacements), (8, None));
}

#[test]
fn displacements_stay_with_their_points_if_others_are_left_out() {
    const LOST: &str = "has a point without coordinates, which is left out";
    let text = displaced("U", 3, "9 9 9 0 0 0 0.5 0 0 0 0.25 0 0 0 -1")
        .replace(">0 0 0 1 0 0 0 1 0 0 0 1<", ">nan nan nan 0 0 0 1 0 0 0 1 0 0 0 1<")
        .replace(">0 1 2 3<", ">1 2 3 4<");
    let cells = read_cells(text.as_bytes(), Format::Vtu, &LIMITS).unwrap();
    let moved = [DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.25, -DVec3::Z];
    assert_eq!((cells.points[1], cells.notes), (DVec3::X, vec![LOST.to_owned()]));
    assert_eq!(cells.displacements.as_deref(), Some(&moved[..]));
}

/// A list without data of its own is of zeros, however long it says that it is.
#[test]
fn lists_of_gltf_are_not_longer_than_its_data() {
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:a;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[
        {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"componentType":5125,"count":9,"type":"SCALAR","sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0,"byteOffset":4}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]}"#;
    let found = refusal(json.replacen("\"count\":9", "\"count\":7999998", 1).as_bytes(), Format::Gltf);
    let expected =
        "has 7999998 entries in its list 1, which has no data of its own; expected at most 36, the bytes of its";
    assert!(found.starts_with(expected), "{found}");
    assert!(read_cells(json.as_bytes(), Format::Gltf, &LIMITS).is_ok());
}

#[test]
fn a_header_of_ply_may_end_the_file() {
    let header =
        "ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\rproperty float z\rend_header";
    for text in [header.to_owned(), header.replace('\r', "\n"), header.replace('\r', "\r\n")] {
        let found = refusal(text.as_bytes(), Format::Ply);
        assert!(found.starts_with("ends in "), "{found}");
    }
}
