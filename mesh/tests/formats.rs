//! The value of every field of files of surfaces: what programs write beside the plain case, each with its right value.

use glam::{DQuat, DVec3};
use localshape_mesh::{Flaws, Format, Limits, Mesh, ReadError, Surface, converter, read, read_cells, read_cells_with};

const LIMITS: Limits = Limits { points: 1_000_000, corners: 8_000_000 };

/// A file in `tests/files`.
fn file(name: &str) -> (Vec<u8>, Format) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name);
    let ending = name.rsplit('.').next().expect("an ending");
    (std::fs::read(path).expect("a file"), Format::of(ending).expect("a format"))
}

fn surface(bytes: &[u8], format: Format) -> Surface {
    match read(bytes, format, &LIMITS) {
        Ok(Mesh::Surface(surface)) => surface,
        other => panic!("{other:?}"),
    }
}

fn surface_of(name: &str) -> Surface {
    let (bytes, format) = file(name);
    surface(&bytes, format)
}

/// The message and the remedy of a refusal.
fn refusal(bytes: &[u8], format: Format) -> String {
    let error = read(bytes, format, &LIMITS).expect_err("a refusal");
    format!("{} ({})", error.message, error.help.expect("a remedy"))
}

/// Volume, area, and numbers of points, triangles and pieces of a mended surface that is closed.
fn check(name: &str, [volume, area]: [f64; 2], [points, triangles, pieces]: [usize; 3]) -> Flaws {
    let (mended, flaws) = surface_of(name).mended();
    let measures = mended.measures();
    assert!(measures.closed, "{name}: {flaws:?}");
    assert!((measures.volume - volume).abs() < 1e-5 * volume, "{name}: {}", measures.volume);
    assert!((measures.area - area).abs() < 1e-5 * area, "{name}: {}", measures.area);
    assert_eq!((mended.points.len(), mended.triangles.len(), flaws.pieces), (points, triangles, pieces), "{name}");
    flaws
}

#[test]
fn boxes_are_read_however_they_are_written() {
    for name in [
        // A byte order mark, both ends of lines, continued lines, colours, comments, no last line feed.
        "odd-lines.obj",
        "carriage-returns.obj",
        // At 500 km and 4650 km from the origin, in double precision.
        "far.obj",
        "groups.obj",
        "unknown-point.obj",
        "unknown-point.ply",
        "unknown-point-binary.ply",
        // Binary files that begin with `solid` and `facet`, with data behind them, with spaces in place of zeros.
        "solid-in-header-a.stl",
        "solid-in-header-b.stl",
        "solid-in-header-c.stl",
        "solid-in-header-d.stl",
        "two-words.stl",
        "small-zeros.stl",
        "big-endian-ushort.ply",
        "crlf-header.ply",
        "crlf-text.ply",
        "int64.ply",
        "cr-header.ply",
        "int8-int16.ply",
        "draco-optional.gltf",
        "skinned.gltf",
    ] {
        check(name, [6.0, 22.0], [8, 12, 1]);
    }
    // Indices counted back from the last point so far.
    check("negative-blocks.obj", [12.0, 44.0], [16, 24, 2]);
    // Faces with a hole, which a bridge joins to their border. The corners of the bridge are listed twice.
    check("keyhole.obj", [12.0, 48.0], [16, 32, 1]);
    check("hollow.obj", [26.0, 60.0], [16, 24, 2]);
    check("morphed.gltf", [9.0, 30.0], [8, 12, 1]);
}

#[test]
fn zeros_with_round_off_are_one_point() {
    let flaws = check("small-zeros.stl", [6.0, 22.0], [8, 12, 1]);
    assert!(flaws.near > 0 && flaws.near == flaws.welded, "{flaws:?}");
    // Equal points are nothing to tell.
    assert_eq!(surface_of("two-words.stl").mended().1.near, 0);
}

#[test]
fn a_distance_joins_what_differs_in_the_last_digits() {
    let (bytes, format) = file("last-digits.stl");
    let (mended, flaws) = surface(&bytes, format).mended();
    assert_eq!((flaws.boundary, flaws.pieces, mended.points.len()), (36, 12, 36));
    assert_eq!(mended.closing_weld(), Some(1e-6), "corners are up to 7e-7 apart");
    let mut cells = read_cells(&bytes, format, &LIMITS).expect("sound");
    assert_eq!(cells.weld(1e-6), 28);
    let Ok(Mesh::Surface(welded)) = cells.mesh(format) else { panic!("a surface") };
    let measures = welded.measures();
    assert!(measures.closed && (measures.volume - 6.0).abs() < 1e-5, "{measures:?}");
    assert_eq!((welded.points.len(), welded.closing_weld()), (8, None));
    // A hole is no crack.
    let mut open = surface_of("odd-lines.obj");
    open.triangles.truncate(10);
    assert_eq!(open.closing_weld(), None);
}

#[test]
fn cells_with_points_of_their_own_are_joined_on_request() {
    let (bytes, format) = file("discontinuous.vtu");
    let Ok(Mesh::Volume(volume)) = read(&bytes, format, &LIMITS) else { panic!("cells") };
    assert_eq!((volume.points.len(), volume.cells.len()), (24, 6));
    let distance = volume.joining_weld().expect("equal points");
    assert!(distance < 1e-9, "{distance}");
    let mut cells = read_cells(&bytes, format, &LIMITS).expect("sound");
    assert_eq!(cells.weld(distance), 16);
    let Ok(Mesh::Volume(volume)) = cells.mesh(format) else { panic!("cells") };
    assert_eq!((volume.points.len(), volume.cells.len(), volume.joining_weld()), (8, 6, None));
}

/// Which of several points stays is a matter of their order alone, and no point moves farther than the distance.
#[test]
fn points_in_a_row_are_joined_with_the_first_within_the_distance() {
    let points: String = (0..3000).map(|at| format!("v {} {} 0\n", 0.75 * f64::from(at % 1000), at / 1000)).collect();
    let faces: String = (1..1000).map(|at| format!("f {at} {} {}\n", at + 1, at + 2000)).collect();
    let joined = |distance: f64| {
        let mut cells = read_cells((points.clone() + &faces).as_bytes(), Format::Obj, &LIMITS).expect("sound");
        (cells.weld(distance), cells.corners.indices().to_vec())
    };
    assert_eq!(joined(0.7).0, 0);
    // Every other point of a row stays: a row is not one point, although each is near to the next.
    let (count, corners) = joined(0.8);
    assert_eq!(count, 1500);
    assert!(corners.iter().all(|corner| corner % 2 == 0), "the first stays");
    // As grids of very many points that no gap along an axis divides.
    let several = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads").install(|| joined(0.8));
    assert_eq!(several, (count, corners));
}

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

/// Bytes of a number in a type of PLY.
fn ply_number(kind: &str, value: f64, is_big: bool) -> Vec<u8> {
    let mut bytes = match kind {
        "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
        "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
        "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "int64" => (value as i64).to_le_bytes().to_vec(),
        "uint64" => (value as u64).to_le_bytes().to_vec(),
        "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
        _ => value.to_le_bytes().to_vec(),
    };
    if is_big {
        bytes.reverse();
    }
    bytes
}

#[test]
fn every_type_of_ply_has_its_value_in_every_place() {
    let kinds = "char uchar short ushort int uint float double int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64";
    for kind in kinds.split(' ') {
        let is_signed = !kind.starts_with('u');
        // Values with more than one byte, where the type has them.
        let low = if is_signed { -3.0 } else { 3.0 };
        let high = if kind.ends_with('8') || kind.ends_with("char") { 100.0 } else { 300.0 };
        let points = [[low, 0.0, 1.0], [high, 2.0, 0.0], [0.0, high, 5.0]];
        let length = if kind.starts_with("float") || kind == "double" { "uchar" } else { kind };
        for (format, is_big) in [("ascii", false), ("binary_little_endian", false), ("binary_big_endian", true)] {
            let number = |kind: &str, value: f64| match format {
                "ascii" => format!("{value} ").into_bytes(),
                _ => ply_number(kind, value, is_big),
            };
            // What is not read has the same type: before the coordinates, between them and behind.
            let mut bytes = format!(
                "ply\nformat {format} 1.0\nelement vertex 3\nproperty {kind} a\nproperty {kind} z\nproperty list {length} {kind} b\n\
                 property {kind} x\nproperty {kind} y\nproperty {kind} c\nelement face 1\nproperty {kind} d\n\
                 property list {length} {kind} vertex_indices\nproperty {kind} e\nend_header\n"
            )
            .into_bytes();
            for [x, y, z] in points {
                for (kind, value) in
                    [(kind, 9.0), (kind, z), (length, 2.0), (kind, 7.0), (kind, 8.0), (kind, x), (kind, y), (kind, 6.0)]
                {
                    bytes.extend(number(kind, value));
                }
            }
            for (kind, value) in [(kind, 9.0), (length, 3.0), (kind, 2.0), (kind, 0.0), (kind, 1.0), (kind, 9.0)] {
                bytes.extend(number(kind, value));
            }
            let found = surface(&bytes, Format::Ply);
            assert_eq!(found.points, points.map(DVec3::from), "{kind} {format}");
            assert_eq!(found.triangles, [[2, 0, 1]], "{kind} {format}");
        }
    }
    let text =
        String::from_utf8(file("cube-text.ply").0).expect("text").replacen("property float x", "property int128 x", 1);
    assert!(refusal(text.as_bytes(), Format::Ply).contains("has `int128` in line "), "{text}");
}

#[test]
fn triangles_of_stl_have_all_their_coordinates() {
    let corners = [[0.5f32, -1.25, 2.0], [3.0, 4.5, -5.0], [1e-3, 7e6, 8.0]];
    let mut bytes = [0; 80].to_vec();
    bytes.extend(1u32.to_le_bytes());
    // The normal and the attribute are not read.
    [9.0f32, 9.0, 9.0].iter().chain(corners.as_flattened()).for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes.extend([0xff, 0xff]);
    let expected = corners.map(|corner| DVec3::from(corner.map(f64::from)));
    assert_eq!(surface(&bytes, Format::Stl).points, expected);
    let lines: String = corners.iter().map(|[x, y, z]| format!("vertex {x} {y} {z}\n")).collect();
    for (end, last) in
        [("endloop endfacet", "endsolid a"), ("end loop end facet", "end solid a b"), ("ENDLOOP ENDFACET", "")]
    {
        let solid = format!("solid a b\nfacet normal 9 9 9 outer loop\n{lines}{end}\n{last}\n");
        let found = surface(solid.repeat(2).as_bytes(), Format::Stl);
        let expected =
            corners.map(|corner| DVec3::from(corner.map(|number| number.to_string().parse().expect("a number"))));
        assert_eq!((&found.points[..], found.triangles.len()), (&expected[..], 2), "{end}");
    }
    let text = format!("solid\nfacet\nouter loop\n{lines}end lop\n");
    assert!(refusal(text.as_bytes(), Format::Stl).starts_with("has `lop` in line 7; expected `endloop`"));
}

/// A glTF file of some parts of its document, with its data in a file beside it.
fn gltf(parts: &str, length: usize) -> String {
    format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"buffers\": [{{\"byteLength\": {length}, \"uri\": \"a%20b.bin\"}}], {parts}}}"
    )
}

/// Reads it with these bytes in that file.
fn with_data(parts: &str, data: &[u8]) -> Result<Surface, ReadError> {
    let text = gltf(parts, data.len());
    let mut names = Vec::new();
    let mut beside = |name: &str| {
        names.push(name.to_owned());
        Ok(data.to_vec())
    };
    let cells = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut beside);
    assert!(names.is_empty() || names == ["a b.bin"], "{names:?}");
    match cells?.mesh(Format::Gltf)? {
        Mesh::Surface(surface) => Ok(surface),
        other => panic!("{other:?}"),
    }
}

/// Parts of a document whose accessors are triangles of three points in this notation, the first of them positions.
fn parts(accessors: &str, views: &str, primitive: &str, rest: &str) -> String {
    format!(
        "\"accessors\": [{accessors}], \"bufferViews\": [{views}], \
         \"meshes\": [{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0{primitive}]{rest}"
    )
}

const NODE: &str = "}], \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]";

#[test]
fn numbers_of_gltf_have_every_type() {
    let (one, most) = (DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 100.0));
    let points = [DVec3::ZERO, one, most];
    for (kind, size, largest) in
        [(5120, 1, 127.0), (5121, 1, 255.0), (5122, 2, 32767.0), (5123, 2, 65535.0), (5126, 4, 1.0)]
    {
        for normalized in [false, true] {
            // A view that begins at byte 8, with numbers from byte 4 of it on and rows of 24 bytes.
            let mut data = vec![0xee; 8 + 4 + 3 * 24];
            for (row, point) in points.iter().enumerate() {
                for (column, value) in point.to_array().into_iter().enumerate() {
                    let number = match kind {
                        5120 | 5121 => vec![value as u8],
                        5122 | 5123 => (value as u16).to_le_bytes().to_vec(),
                        _ => (value as f32).to_le_bytes().to_vec(),
                    };
                    let at = 12 + 24 * row + size * column;
                    data[at..at + size].copy_from_slice(&number);
                }
            }
            let accessor = format!(
                "{{\"bufferView\": 0, \"byteOffset\": 4, \"componentType\": {kind}, \"normalized\": {normalized}, \"count\": 3, \"type\": \"VEC3\"}}"
            );
            let view =
                format!("{{\"buffer\": 0, \"byteOffset\": 8, \"byteLength\": {}, \"byteStride\": 24}}", data.len() - 8);
            let found = with_data(&parts(&accessor, &view, "}}", NODE), &data).expect("sound");
            let scale = if normalized { 1.0 / largest } else { 1.0 };
            let is_near = |(found, expected): (&DVec3, &DVec3)| found.distance(*expected * scale) < 1e-12;
            assert!(found.points.iter().zip(&points).all(is_near), "{kind} {normalized}: {:?}", found.points);
        }
    }
    // There is one more integer below zero than above.
    let accessor =
        "{\"bufferView\": 0, \"componentType\": 5120, \"normalized\": true, \"count\": 3, \"type\": \"VEC3\"}";
    let view = "{\"buffer\": 0, \"byteLength\": 12, \"byteStride\": 4}";
    let found = with_data(&parts(accessor, view, "}}", NODE), &[0x80, 0x81, 0x7f, 0].repeat(3)).expect("sound");
    assert_eq!(found.points[0], DVec3::new(-1.0, -1.0, 1.0));
    // Indices of every type, and what lists of corners mean.
    let positions: Vec<u8> =
        (0..5).flat_map(|at| [at as f32, (at * at) as f32, 1.0]).flat_map(f32::to_le_bytes).collect();
    for (kind, size) in [(5121, 1), (5123, 2), (5125, 4)] {
        for (mode, expected) in [
            (4, vec![[4, 0, 3]]),
            (5, vec![[4, 0, 3], [3, 0, 1], [3, 1, 2]]),
            (6, vec![[4, 0, 3], [4, 3, 1], [4, 1, 2]]),
        ] {
            let mut data = positions.clone();
            [4u32, 0, 3, 1, 2].iter().for_each(|index| data.extend(&index.to_le_bytes()[..size]));
            let accessors = format!(
                "{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 5, \"type\": \"VEC3\"}}, \
                 {{\"bufferView\": 1, \"componentType\": {kind}, \"count\": 5, \"type\": \"SCALAR\"}}"
            );
            let views = format!(
                "{{\"buffer\": 0, \"byteLength\": 60}}, {{\"buffer\": 0, \"byteOffset\": 60, \"byteLength\": {}}}",
                5 * size
            );
            let primitive = format!("}}, \"indices\": 1, \"mode\": {mode}}}");
            let mut cells = None;
            let text = gltf(&parts(&accessors, &views, &primitive, NODE), data.len());
            let found =
                read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |_| Ok(data.clone())).expect("sound");
            let found: Vec<_> =
                cells.insert(found).corners.iter().map(|corners| [corners[0], corners[1], corners[2]]).collect();
            assert_eq!(found, expected, "{kind} {mode}");
        }
    }
}

/// Three points in single precision and their description.
fn three() -> (Vec<u8>, &'static str, &'static str) {
    let data = [[1.0f32, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    (
        data.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect(),
        "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}",
        "{\"buffer\": 0, \"byteLength\": 36}",
    )
}

#[test]
fn nodes_of_gltf_turn_by_their_rotation_whatever_its_length() {
    let (data, accessor, view) = three();
    let turn = DQuat::from_xyzw(0.5, -0.5, 0.5, 0.5);
    for length in [1.0, 2.0, 0.001] {
        let [x, y, z, w] = (turn * length).to_array();
        let nodes = format!(
            "}}], \"scenes\": [{{\"nodes\": [1]}}], \"nodes\": [{{\"mesh\": 0, \"scale\": [2, 3, 4]}}, \
             {{\"children\": [0], \"rotation\": [{x}, {y}, {z}, {w}], \"translation\": [10, 20, 30]}}]"
        );
        let found = with_data(&parts(accessor, view, "}}", &nodes), &data).expect("sound");
        let expected =
            [2.0 * DVec3::X, 6.0 * DVec3::Y, 12.0 * DVec3::Z].map(|at| turn * at + DVec3::new(10.0, 20.0, 30.0));
        assert!(
            found.points.iter().zip(expected).all(|(found, at)| found.distance(at) < 1e-5),
            "{length}: {:?}",
            found.points
        );
    }
    // By columns.
    let nodes = "}], \"nodes\": [{\"mesh\": 0, \"matrix\": [0, 1, 0, 0, -2, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]}]";
    let found = with_data(&parts(accessor, view, "}}", nodes), &data).expect("sound");
    assert_eq!(found.points, [DVec3::new(7.0, 9.0, 9.0), DVec3::new(3.0, 8.0, 9.0), DVec3::new(7.0, 8.0, 12.0)]);
}

#[test]
fn joints_place_the_points_of_a_skin() {
    let (data, ..) = three();
    let (bytes, format) = file("skinned.gltf");
    let found = surface(&bytes, format);
    let (low, high) = localshape_sim::geometry::bounds(&found.points);
    assert_eq!(
        (low, high),
        (DVec3::new(0.0, 5.0, 0.0), DVec3::new(2.0, 6.0, 3.0)),
        "its joint moves it, its node does not"
    );
    // Two joints, the second below the first, with inverse matrices, weights as bytes whose sum is not 1, and a second set of joints.
    let mut data = data;
    let identity = [1.0f32, 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let mut moved = identity;
    moved[12] = -4.0;
    identity.iter().chain(&moved).for_each(|number| data.extend(number.to_le_bytes()));
    // The first point follows both joints alike, the second the first, the third the second by its second set.
    data.extend([0u8, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    data.extend([100u8, 100, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0]);
    data.extend([0u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0]);
    data.extend([0u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 50, 0]);
    let accessors = "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}, \
        {\"bufferView\": 1, \"componentType\": 5126, \"count\": 2, \"type\": \"MAT4\"}, \
        {\"bufferView\": 2, \"componentType\": 5121, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 12, \"componentType\": 5121, \"normalized\": true, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 24, \"componentType\": 5121, \"count\": 3, \"type\": \"VEC4\"}, \
        {\"bufferView\": 2, \"byteOffset\": 36, \"componentType\": 5121, \"normalized\": true, \"count\": 3, \"type\": \"VEC4\"}";
    let views = "{\"buffer\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 128}, \
        {\"buffer\": 0, \"byteOffset\": 164, \"byteLength\": 48}";
    let primitive = ", \"JOINTS_0\": 2, \"WEIGHTS_0\": 3, \"JOINTS_1\": 4, \"WEIGHTS_1\": 5}}";
    let nodes = "}], \"skins\": [{\"joints\": [1, 2], \"inverseBindMatrices\": 1}], \"scenes\": [{\"nodes\": [0, 1]}], \
        \"nodes\": [{\"mesh\": 0, \"skin\": 0, \"scale\": [9, 9, 9]}, {\"children\": [2], \"translation\": [0, 10, 0]}, \
        {\"translation\": [4, 0, 0], \"scale\": [1, 1, 2]}]";
    let whole = parts(accessors, views, primitive, nodes);
    let found = with_data(&whole, &data).expect("sound");
    // The second joint moves (x, y, z) to (x − 4 + 4, y + 10, 2z).
    assert_eq!(found.points, [DVec3::new(1.0, 10.0, 0.0), DVec3::new(0.0, 12.0, 0.0), DVec3::new(0.0, 10.0, 6.0)]);
    let told = |text: &str, data: &[u8]| with_data(text, data).expect_err("a refusal").message;
    let without = whole.replace(", \"JOINTS_1\": 4, \"WEIGHTS_1\": 5", "");
    assert_eq!(told(&without, &data), "has point 2 of a part without weights, which its skin needs");
    let few = whole.replace("\"joints\": [1, 2]", "\"joints\": [1]");
    assert_eq!(told(&few, &data), "names joint 1 of a skin with 1 joints");
    let outside = whole.replace("\"scenes\": [{\"nodes\": [0, 1]}]", "\"scenes\": [{\"nodes\": [0]}]");
    assert_eq!(told(&outside, &data), "has the joint 1 of its skin 0 outside of its scene");
    let fewer = whole.replace("\"count\": 2, \"type\": \"MAT4\"", "\"count\": 1, \"type\": \"MAT4\"");
    assert_eq!(told(&fewer, &data), "has 1 inverse matrices for 2 joints of its skin 0");
}

#[test]
fn weights_of_nodes_come_before_those_of_meshes() {
    let (mut data, ..) = three();
    let moves = [[1.0f32, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 5.0, 0.0]];
    moves.as_flattened().iter().for_each(|number| data.extend(number.to_le_bytes()));
    let accessor =
        |view: usize| format!("{{\"bufferView\": {view}, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}}");
    let accessors = format!("{}, {}", accessor(0), accessor(1));
    let views = "{\"buffer\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36, \"byteLength\": 36}";
    let primitive = "}, \"targets\": [{\"POSITION\": 0}, {\"NORMAL\": 1}, {\"POSITION\": 1}]}";
    let found = |mesh: &str, node: &str| {
        let rest = format!(", \"weights\": {mesh}}}], \"nodes\": [{{\"mesh\": 0{node}}}]");
        with_data(&parts(&accessors, views, primitive, &rest), &data).expect("sound").points
    };
    let expected = |first: f64, third: f64| {
        let third = [DVec3::X, DVec3::ZERO, 5.0 * DVec3::Y].map(|moves| third * moves);
        let at = [DVec3::X, 2.0 * DVec3::Y, 3.0 * DVec3::Z].map(|at| (1.0 + first) * at);
        [0, 1, 2].map(|point| at[point] + third[point])
    };
    assert_eq!(found("[0, 0, 0]", ""), expected(0.0, 0.0));
    assert_eq!(found("[0.5, 7, 2]", ""), expected(0.5, 2.0));
    assert_eq!(found("[0.5, 7, 2]", ", \"weights\": [0, 0, 0.25]"), expected(0.0, 0.25));
}

#[test]
fn extensions_that_are_needed_are_honoured_or_refused() {
    let (data, accessor, view) = three();
    let told = |keys: &str| match with_data(&format!("{keys}, {}", parts(accessor, view, "}}", NODE)), &data) {
        Ok(found) => format!("{} triangle", found.triangles.len()),
        Err(ReadError { message, help }) => format!("{message} ({})", help.expect("a remedy")),
    };
    for known in ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual"] {
        assert_eq!(told(&format!("\"extensionsRequired\": [\"{known}\"]")), "1 triangle");
    }
    assert_eq!(told("\"extensionsUsed\": [\"KHR_node_visibility\"]"), "1 triangle");
    let expected =
        "needs extensions that are not read: `ABC_other`, `EXT_mesh_gpu_instancing` (export it again without";
    let keys = "\"extensionsUsed\": [\"EXT_mesh_gpu_instancing\"], \"extensionsRequired\": [\"KHR_xmp\", \"EXT_mesh_gpu_instancing\", \"ABC_other\"]";
    assert!(told(keys).starts_with(expected), "{}", told(keys));
    assert!(
        told("\"extensionsUsed\": [\"EXT_mesh_gpu_instancing\"]")
            .starts_with("needs extensions that are not read: `EXT_mesh")
    );
    let packed = told("\"extensionsRequired\": [\"KHR_draco_mesh_compression\"]");
    assert!(packed.starts_with("needs extensions that are not read: `KHR_draco_mesh_compression` (export"), "{packed}");
}

#[test]
fn an_empty_scene_shows_nothing() {
    let (data, accessor, view) = three();
    let scene = |scenes: &str| {
        let rest = format!("}}], \"scene\": 0, \"scenes\": {scenes}, \"nodes\": [{{\"mesh\": 0}}]");
        with_data(&parts(accessor, view, "}}", &rest), &data)
    };
    for empty in ["[{}]", "[{\"nodes\": []}]", "[{}, {\"nodes\": [0]}]"] {
        let error = scene(empty).expect_err("nothing");
        assert_eq!(error.message, "shows nothing: no node of its scene has a mesh of triangles");
    }
    assert_eq!(scene("[{\"nodes\": [0]}, {}]").expect("sound").triangles.len(), 1);
    // As a binary file.
    let json = gltf(&parts(accessor, view, "}}", "}], \"scenes\": [{}], \"nodes\": [{\"mesh\": 0}]"), data.len());
    let json = format!("{json}{}", " ".repeat((4 - json.len() % 4) % 4));
    let lengths = [2, 20 + json.len() as u32, json.len() as u32].map(u32::to_le_bytes);
    let glb = [b"glTF", &lengths[0][..], &lengths[1], &lengths[2], b"JSON", json.as_bytes()].concat();
    let found = read_cells_with(&glb, Format::Gltf, &LIMITS, &mut |_| Ok(data.clone()));
    assert!(found.expect_err("nothing").message.starts_with("shows nothing"));
}

#[test]
fn data_of_gltf_may_be_beside_it_and_nowhere_else() {
    let (data, accessor, view) = three();
    let named = |uri: &str| {
        let text = gltf(&parts(accessor, view, "}}", NODE), data.len()).replace("a%20b.bin", uri);
        let mut asked = Vec::new();
        let found = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |name| {
            asked.push(name.to_owned());
            Ok(data.clone())
        });
        (asked.pop(), found.err().map(|error| error.message))
    };
    for (uri, name) in [
        ("a.bin", "a.bin"),
        ("my%20box%c3%bc.bin", "my boxü.bin"),
        ("parts/my box.bin", "parts/my box.bin"),
        ("parts\\\\a.bin", "parts/a.bin"),
        ("parts%5Ca.bin", "parts/a.bin"),
        ("100%.bin", "100%.bin"),
        ("%+f%zz.bin", "%+f%zz.bin"),
        ("a%2fb.bin", "a/b.bin"),
        ("..a/b..", "..a/b.."),
    ] {
        assert_eq!(named(uri), (Some(name.to_owned()), None), "{uri}");
    }
    for uri in [
        "../a.bin",
        "a/../../b.bin",
        "%2e%2e/a.bin",
        "/etc/passwd",
        "%2Fetc",
        "\\\\\\\\host\\\\a",
        "a\\\\..\\\\b",
        "//host/a",
    ] {
        let (asked, error) = named(uri);
        assert!(
            asked.is_none() && error.expect("a refusal").starts_with("has its data outside of its folder, `"),
            "{uri}"
        );
    }
    for uri in ["http://host/a.bin", "HTTPS://host/a.bin", "file:///etc/passwd", "file%3A/a", "c:/a.bin", "x-a+b.c:d"] {
        let (asked, error) = named(uri);
        assert!(asked.is_none() && error.expect("a refusal").starts_with("has its data by an address, `"), "{uri}");
    }
    // A file alone, a file that is not there, and one that is too short.
    let text = gltf(&parts(accessor, view, "}}", NODE), data.len());
    assert_eq!(
        refusal(text.as_bytes(), Format::Gltf),
        "has its data in `a b.bin`, which is another file (export all as one file)"
    );
    let missing = |_: &str| Err(ReadError { message: "is not there".to_owned(), help: None });
    let error = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut { missing }).expect_err("missing");
    assert_eq!(error.message, "has its data in `a b.bin`, which is not there");
    let short = read_cells_with(text.as_bytes(), Format::Gltf, &LIMITS, &mut |_| Ok(vec![0; 35])).expect_err("short");
    assert_eq!(short.message, "has data beyond the end of its buffer 0");
}

/// Parts that share a list are read as often as they are named, within bounds.
#[test]
fn lists_named_again_and_again_are_refused() {
    let (data, accessor, view) = three();
    let targets = vec!["{\"POSITION\": 0}"; 2000].join(", ");
    let weights = vec!["1"; 2000].join(", ");
    let rest = format!(", \"weights\": [{weights}]}}], \"nodes\": [{{\"mesh\": 0}}]");
    let text = gltf(&parts(accessor, view, &format!("}}, \"targets\": [{targets}]}}"), &rest), data.len());
    let limits = Limits { points: 10, corners: 100 };
    let error =
        read_cells_with(text.as_bytes(), Format::Gltf, &limits, &mut |_| Ok(data.clone())).expect_err("a limit");
    assert!(error.message.starts_with("has 3 entries in its list 0; at most "), "{error}");
}

#[test]
fn formats_that_are_not_read_have_converters() {
    for (ending, tool) in [
        ("step", "gmsh -3"),
        ("igs", "gmsh -2"),
        ("3mf", "PrusaSlicer"),
        ("fbx", "Blender"),
        ("usdz", "Blender"),
        ("bdf", "meshio"),
        ("unv", "gmsh FILE -save"),
        ("vti", "ParaView"),
        ("sldprt", "program that made it"),
    ] {
        assert!(converter(ending).is_some_and(|help| help.contains(tool)), "{ending}");
    }
    assert!(["toml", "npz", "png", ""].iter().all(|ending| converter(ending).is_none()));
    assert!(
        refusal(b"ISO-10303-21;\n", Format::Obj)
            .contains("is a STEP file, and no mesh file (mesh it with Gmsh: `gmsh -3")
    );
}
