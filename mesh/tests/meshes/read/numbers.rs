//! Every type of numbers of PLY and STL.

use super::{file, refusal, surface};
use glam::DVec3;
use localshape_mesh::Format;

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

#[test]
fn a_header_of_ply_may_end_the_file() {
    let header =
        "ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\rproperty float z\rend_header";
    for text in [header.to_owned(), header.replace('\r', "\n"), header.replace('\r', "\r\n")] {
        let found = refusal(text.as_bytes(), Format::Ply);
        assert!(found.starts_with("ends in "), "{found}");
    }
}
