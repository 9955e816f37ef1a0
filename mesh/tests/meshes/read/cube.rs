//! One cube in every format of surfaces.

use super::{SIDES, cube, file, lines, refusal, stl, surface};
use glam::DVec3;
use localshape_mesh::{Format, Surface};

/// The volume inside a closed surface.
fn inside(surface: &Surface) -> f64 {
    let at = |point: u32| surface.points[point as usize];
    surface.triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

fn check_cube(surface: &Surface) {
    assert_eq!(surface.points.len(), 8);
    assert_eq!(surface.triangles.len(), 12);
    assert!((inside(surface) - 1.0).abs() < 1e-12, "{}", inside(surface));
}

#[test]
fn a_cube_is_read_from_obj() {
    let mut text = String::from("# a cube\nmtllib none.mtl\no cube\n");
    for point in cube() {
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
        check_cube(&surface(format!("{header}{}{faces}", lines(cube())).as_bytes(), Format::Off));
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
    for point in cube() {
        text += &format!("255 {} {} {}\n", point.x, point.y, point.z);
    }
    for side in SIDES {
        text += &format!("2 0.5 0.5 4 {}\n", side.map(|corner| corner.to_string()).join(" "));
    }
    check_cube(&surface(text.as_bytes(), Format::Ply));
    for (name, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut bytes = header(name).into_bytes();
        for point in cube() {
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
fn refusals_say_where_and_what_to_do() {
    use Format::{Gltf, Gmsh, Medit, Obj, Off, Ply, Stl, Vtu};
    let damaged = "(the file is damaged: copy, download or write it again)";
    let incomplete = "(the file is incomplete: copy, download or write it again)";
    for (format, text, expected) in [
        (Off, "", format!("is empty {incomplete}")),
        (Off, "OFF\n8 6 0\n0 0", format!("ends in line 3; expected a coordinate {incomplete}")),
        (Off, "OFF\n8 6 0\n0 0\n1 2 3", format!("has nothing more in line 3; expected a coordinate {damaged}")),
        (Off, "OFF\n8 6 0\n0 0 0\n", format!("ends in line 4; expected a line with point 2 of 8 {incomplete}")),
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
            "is a page of the Web (HTML), and is not read (the download gave".to_owned(),
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
        // What the most common program for drawing writes, under another ending.
        (
            Stl,
            "# made elsewhere\nmtllib cube.mtl\no cube\nv 0 0 0\nv 1 0 0\n",
            "has the content of an OBJ file, but the ending of an STL file (name it `.obj`)".to_owned(),
        ),
        (Ply, "v 0 0 0.5e1\r\nv 1 0 0", "has the content of an OBJ file, but the ending of a PLY file".to_owned()),
        (Gltf, "{\"asset\": {", "ends in its JSON (the file is incomplete".to_owned()),
        (Gmsh, "(0 \"Fluent\")\n", "is a Fluent file, and is not read (convert it with meshio: `meshio".to_owned()),
        (Medit, "MFEM mesh v1.0\n", "is an MFEM file, and is not read (write it as `.vtu` with".to_owned()),
        (Medit, "<mesh>\n", "is another XML file, and is not read (convert".to_owned()),
        (Obj, "v 0 0 0\ncstype bezier\n", "has free-form curves or surfaces only (export it as tri".to_owned()),
        (Gltf, "what\n", "begins with `what`; expected `{` or `glTF`, as a glTF file does (check".to_owned()),
        (Obj, "# empty\n", "has no points, faces or cells (write it again with the object".to_owned()),
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

/// Several files behind each other, and headers that are wrong.
#[test]
fn what_a_file_has_beyond_the_counts_of_its_header_is_told() {
    let (_, binary) = stl();
    let mut short = binary.clone();
    short[80] = 6;
    for (bytes, triangles, rest) in
        [([&binary[..], &binary].concat(), 12, 684), (short, 6, 300), ([&binary[..], &[7; 50]].concat(), 12, 50)]
    {
        let found = surface(bytes, Format::Stl);
        assert_eq!(found.triangles.len(), triangles);
        assert_eq!(found.notes, [format!("has {rest} bytes more than its header counts, which are not read")]);
    }
    // Less than a triangle, and zeros.
    for more in [&[7; 49][..], &[0; 512]] {
        assert_eq!(surface([&binary[..], more].concat(), Format::Stl).notes, [""; 0]);
    }
    let more =
        |place: usize| [format!("has more than its header counts, which begins in line {place} and is not read")];
    let off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(surface(format!("{off}# a\n\n3 0 2 1\n"), Format::Off).notes, more(9));
    assert_eq!(surface(format!("{off}# a\n\n"), Format::Off).notes, [""; 0]);
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uchar int vertex_indices\nend_header\n";
    let ply = format!("{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    assert_eq!(surface(format!("{ply}3 0 2 1\n"), Format::Ply).notes, more(14));
    assert_eq!(surface(format!("{ply}\n \n"), Format::Ply).notes, [""; 0]);
    let mut bytes = head.replace("ascii", "binary_little_endian").into_bytes();
    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().for_each(|value: &f32| bytes.extend(value.to_le_bytes()));
    bytes.push(3);
    (0..3).for_each(|index: i32| bytes.extend(index.to_le_bytes()));
    assert_eq!(surface([&bytes[..], b"\r\n\0"].concat(), Format::Ply).notes, [""; 0]);
    let found = surface([&bytes[..], &bytes[bytes.len() - 13..]].concat(), Format::Ply);
    assert_eq!(found.notes, ["has 13 bytes more than its header counts, which are not read"]);
}

#[test]
fn a_text_of_stl_that_is_cut_behind_a_facet_is_told() {
    let (text, _) = stl();
    let missing = ["has no `endsolid` behind its last facet, so that its end may be missing"];
    let end = "endfacet\n";
    let cut = |text: &str, facets: usize| {
        text.match_indices(end).nth(facets - 1).map(|(at, _)| text[..at + end.len()].to_owned()).expect("a facet")
    };
    for (text, triangles, notes) in [
        (text.clone(), 12, &[][..]),
        (text.replace("endsolid", "end solid"), 12, &[]),
        (text.replace("endsolid a cube", "ENDSOLID"), 12, &[]),
        (cut(&text, 12), 12, &missing),
        (cut(&text, 5), 5, &missing),
        // Of the second solid.
        (format!("{text}{}", cut(&text, 5)), 17, &missing),
        (format!("{}{text}", cut(&text, 5)), 17, &[]),
    ] {
        let found = surface(&text, Format::Stl);
        assert_eq!(
            (found.triangles.len(), &found.notes[..]),
            (triangles, &notes.iter().map(|&note| note.to_owned()).collect::<Vec<_>>()[..])
        );
    }
}
