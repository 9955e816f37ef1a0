//! What programs write into texts beside the plain case.

use super::{LIMITS, bytes_of, file, refusal, surface, surface_of, volume};
use glam::DVec3;
use localshape_mesh::{Format, read};

#[test]
fn points_without_coordinates_are_left_out_if_no_face_has_them() {
    let lost = ["has a point without coordinates, which is left out".to_owned()];
    for name in ["unknown-point.obj", "unknown-point.ply", "unknown-point-binary.ply"] {
        let found = surface_of(name);
        assert_eq!((found.points.len(), &found.notes[..]), (8, &lost[..]), "{name}");
    }
    // Corners behind the point are those of the file.
    for nothing in ["nan", "-nan(ind)", "NaN", "1.#QNAN", "-1.#IND", "inf", "-Infinity"] {
        let text = format!("v 0 0 0\nv {nothing} 0 {nothing}\nv 1 0 0\nv 0 2 1\ng a\nf 1 3 4\n");
        let found = surface(text.as_bytes(), Format::Obj);
        assert_eq!((&found.notes[..], &found.triangles[..]), (&lost[..], &[[0, 1, 2]][..]), "{nothing}");
        assert_eq!((found.points[2], &found.groups[0].points[..]), (DVec3::new(0.0, 2.0, 1.0), &[0, 1, 2][..]));
        let text = text.replace("f 1 3 4", "f 1 2 4");
        let expected =
            "has point 2 without coordinates in line 2, and a face with it; expected numbers (remove its faces";
        assert!(refusal(text.as_bytes(), Format::Obj).starts_with(expected), "{nothing}");
    }
    let (bytes, format) = file("unknown-point.ply");
    let text = String::from_utf8(bytes).expect("text");
    let used = text.trim_end().strip_suffix(|_: char| true).expect("a corner").to_owned() + "8\n";
    assert!(refusal(used.as_bytes(), format).contains("has point 8 without coordinates in line "), "{used}");
    // Each point of STL is a corner.
    let stl = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex nan 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    assert!(refusal(stl.as_bytes(), Format::Stl).starts_with("has `nan` in line 5; expected a coordinate"));
    assert!(refusal(b"v nandina 0 0\nf 1 1 1\n", Format::Obj).starts_with("has `nandina` in line 1"));
}

#[test]
fn decimal_commas_are_told() {
    let point = "write a decimal point, not a comma: 0.5)";
    for (format, text) in [
        (Format::Obj, "v 0 0 0\nv 0,5 0 0\n"),
        (Format::Off, "OFF\n2 1 0\n0,5 0 0\n"),
        (Format::Stl, "solid\nfacet normal 0 0 1\nouter loop\nvertex 0,5 0 0\n"),
        (
            Format::Ply,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0,5 0 0\n",
        ),
    ] {
        let found = refusal(text.as_bytes(), format);
        assert!(found.contains("has `0,5` in line ") && found.ends_with(point), "{found}");
    }
    let found = refusal(b"v 0.5, 1, 2\n", Format::Obj);
    assert_eq!(found, "has `0.5,` in line 1; expected a coordinate (separate numbers by spaces, not by commas)");
    assert!(refusal(b"v 1,x 1 2\n", Format::Obj).contains("the file is damaged"));
}

#[test]
fn exponents_of_fortran_are_read() {
    for number in ["0.5D0", "5d-1", "+.05D+01"] {
        let found = surface(format!("v 0 0 0\nv {number} 0 0\nv 0 1 0\nf 1 2 3\n"), Format::Obj);
        assert_eq!(found.points[1], DVec3::new(0.5, 0.0, 0.0), "{number}");
    }
    assert!(refusal(b"v 1 D 2\n", Format::Obj).starts_with("has `D` in line 1; expected a coordinate"));
}

#[test]
fn lines_end_with_carriage_returns_in_all_texts() {
    for name in ["cube.off", "cube-text.ply", "cube-text.stl", "cube.obj"] {
        let (bytes, format) = file(name);
        let text = String::from_utf8(bytes).expect("text").replace("\r\n", "\n");
        let expected = surface(text.as_bytes(), format);
        for end in ["\r", "\r\n"] {
            let text = text.replace('\n', end);
            assert_eq!(surface(text.as_bytes(), format), expected, "{name}");
            let cut = text.trim_end().rsplit_once(end).expect("lines").0.len();
            let lines = text[..cut].matches(end).count() + 1;
            let broken = format!("{}{end}§", &text[..cut]);
            if format != Format::Obj {
                assert!(refusal(broken.as_bytes(), format).contains(&format!("in line {}", lines + 1)), "{name}");
            }
        }
    }
    // A line feed behind the last carriage return of a header is data: here the lowest byte of a number.
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\n\
                property double z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n";
    let mut bytes = head.replace('\n', "\r").into_bytes();
    let first = f64::from_le_bytes([b'\n', 0, 0, 0, 0, 0, 0xf0, 0x3f]);
    for number in [first, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([3, 0, 1, 2]);
    assert_eq!(surface(&bytes, Format::Ply).points[0], DVec3::new(first, 0.0, 0.0));
    bytes.insert(head.len(), b'\n');
    assert!(read(&bytes, Format::Ply, &LIMITS).is_err());
}

#[test]
fn lines_may_end_with_a_carriage_return_alone() {
    for (name, format) in [
        ("comments-2.2.msh", Format::Gmsh),
        ("partitioned-4.1.msh", Format::Gmsh),
        ("cells-4.2.vtk", Format::Vtk),
        ("ghosts.vtu", Format::Vtu),
        ("kinds.mesh", Format::Medit),
        ("kinds.inp", Format::Abaqus),
        ("assembly.inp", Format::Abaqus),
    ] {
        let text = String::from_utf8(bytes_of(name)).expect("text");
        for end in ["\r", "\r\n"] {
            assert_eq!(volume(text.replace('\n', end), format), volume(&text, format), "{name}");
        }
    }
    let damaged =
        String::from_utf8(bytes_of("kinds.inp")).expect("text").replace("30, 0., 1.", "30, x, 1.").replace('\n', "\r");
    assert!(refusal(damaged, Format::Abaqus).starts_with("has `x` in line 7; expected a coordinate"));
}

#[test]
fn names_of_obj_are_groups() {
    let found = surface_of("groups.obj");
    let groups: Vec<_> = found.groups.iter().map(|group| (&*group.name, &*group.points)).collect();
    // A name stays until the next of its kind. Faces before `usemtl` have no material.
    assert_eq!(groups, [("cap", &[2, 3, 6, 7][..]), ("red", &[2, 3, 6, 7]), ("rest", &[0, 1, 2, 3, 4, 5, 6, 7])]);
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no my box\nf 1 2 3\ng left arm\nusemtl dark red\nf 1 2 4\ng\nf 2 3 4\no\n\
                usemtl arm\nf 3 1 4\n";
    let found = surface(text.as_bytes(), Format::Obj);
    let groups: Vec<_> = found.groups.iter().map(|group| (&*group.name, &*group.points)).collect();
    let expected = [
        ("arm", &[0, 1, 2, 3][..]),
        ("dark red", &[0, 1, 2, 3]),
        ("left", &[0, 1, 3]),
        ("left arm", &[0, 1, 3]),
        ("my box", &[0, 1, 2, 3]),
    ];
    assert_eq!(groups, expected);
    let (mended, _) = found.mended();
    assert_eq!(mended.groups, found.groups);
    // A comment is no part of a name.
    for comment in [" # of the front", "\t#2", "  ##"] {
        let names = ["my box", "left arm", "dark red"].map(|name| (format!("{name}\n"), format!("{name}{comment}\n")));
        let commented = names.iter().fold(text.to_owned(), |text, (name, with)| text.replace(name, with));
        assert_eq!(surface(commented.as_bytes(), Format::Obj).groups, found.groups, "{comment}");
    }
    assert_eq!(surface(text.replace("dark red", "red#2").as_bytes(), Format::Obj).groups[4].name, "red#2");
    // A sentence is one name.
    let text = text.replace("left arm", "a b c d e f g h i");
    assert_eq!(surface(text.as_bytes(), Format::Obj).groups[0].name, "a b c d e f g h i");
}

#[test]
fn off_has_its_numbers_in_any_line_and_more_than_coordinates() {
    let body = "0 0 0 N\n1 0 0 N\n0 2 0 N\n0 0 3 N\n3 0 2 1 255 0 0\n3 0 1 3\n3 1 2 3 0.5 0.5 0.5\n3 0 3 2\n";
    for (head, more) in [
        ("OFF 4 4 0\n", ""),
        ("OFF4 4 6\n", ""),
        ("OFF\n4 4\n", ""),
        ("OFF # a box\n\n# numbers\n4 4 6 # edges\n", ""),
        ("COFF\n4 4 0\n", "0.5 0.5 0.5 1"),
        ("NOFF 4 4 0\n", "0 0 1"),
        ("STCNOFF\n4 4 0\n", "0 0 1 255 0 0 255 0 1"),
        ("CNOFF\n4 4 0\n", "0 0 1 255 0 0 255"),
    ] {
        let found = surface((head.to_owned() + &body.replace('N', more)).as_bytes(), Format::Off);
        let expected = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z];
        assert_eq!((&found.points[..], found.triangles.len()), (&expected[..], 4), "{head}");
        assert!((found.measures().volume - 1.0).abs() < 1e-15, "{head}");
    }
    assert!(refusal(b"OFFICE 1 2\n", Format::Off).starts_with("has `ICE` in line 1; expected the number of points"));
}

#[test]
fn comments_begin_directly_behind_numbers() {
    let obj = "v 0 0 0# a point\nv 1 0 0.5#2 3\nv 0 2. 1.# C:\\\nv 0 2 1.#QNAN\ng a#b# c\nf 1/1 2/2 3/#note\nf 3 2 1# C:\\\nf 1 2 3#\n";
    let off = "OFF# a surface\n3 1 0# counts\n0 0 0#\n1 0 0.5#2\n0 2. 1.# x\n3 0 1 2# 3\n";
    let medit = "MeshVersionFormatted 2# a\nDimension 3#\nVertices 3#\n0 0 0 0#\n1 0 0.5 0#2\n0 2. 1. 0\nTriangles 1# x\n\
                 1 2 3 0# y\nEnd#\n";
    for (text, format) in [(obj, Format::Obj), (off, Format::Off), (medit, Format::Medit)] {
        let found = surface(text, format);
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 2.0, 1.0]].map(DVec3::from_array);
        assert_eq!((&found.points[..], found.triangles[0]), (&points[..], [0, 1, 2]), "{text}");
    }
    // A name keeps what is directly behind its letters.
    let found = surface(obj, Format::Obj);
    assert_eq!((found.triangles.len(), found.groups[0].name.as_str()), (3, "a#b#"));
}

/// Paths of folders end in a backslash.
#[test]
fn comments_are_not_continued() {
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    for comment in ["# folder C:\\models\\", "  # C:\\", "#\\"] {
        for end in ["\n", "\r\n", "\r"] {
            let text = format!("{points}{comment}\ng top\nf 1 2 3 \\\n4\n{comment}\nf 1 2 4\n").replace('\n', end);
            let found = surface(text, Format::Obj);
            assert_eq!((found.triangles.len(), &*found.groups[0].name), (3, "top"), "{comment}");
        }
    }
    // Behind a point and behind a name.
    let found = surface(format!("{}g top # b\\\nf 1 2 3\n", points.replace("1\n", "1 # a\\\n")), Format::Obj);
    assert_eq!((found.points.len(), found.triangles.len(), &*found.groups[0].name), (3, 1, "top"));
    let found = surface("OFF # a\\\n# b\\\n3 1 0\n0 0 0\n1 0 0 # c\\\n0 1 0\n# d\\\n3 0 1 2\n", Format::Off);
    assert_eq!((found.points.len(), found.triangles.len()), (3, 1));
}

#[test]
fn points_and_faces_of_off_have_lines_of_their_own() {
    let points = "0 0 0\n1 0 0\n0 2 0\n0 0 3";
    for (text, expected) in [
        (format!("OFF\n4 2 0\n{points}\n3 0 2 1 255 0 0\n"), "ends in line 8; expected a line with face 2 of 2"),
        (format!("OFF\n4 2 0\n{points}\n3 0 2 1 3 0 1 3\n"), "ends in line 8; expected a line with face 2 of 2"),
        (format!("OFF 4 2 0\n{}\n", points.replace('\n', " ")), "ends in line 3; expected a line with point 2 of 4"),
        (format!("OFF 4 2 0 {}\n", points.replace('\n', " ")), "ends in line 2; expected a line with point 1 of 4"),
    ] {
        let told = refusal(&text, Format::Off);
        assert!(told.starts_with(&format!("{expected} (the file is incomplete")), "{told}");
    }
}
