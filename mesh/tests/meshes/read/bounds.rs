//! What is damaged, larger than its limits or read again and again.

use super::{LIMITS, cube, file, lines, refusal, stl, surface, volume};
use localshape_mesh::{Format, Limits, converter, read};

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
    let text = format!("OFF\n8 0 0\n{}", lines(cube()));
    let error = read(text.as_bytes(), Format::Off, &limits).expect_err("a limit");
    assert_eq!(error.message, "has 8 points; at most 7 are read");
    let obj: String = cube().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let error = read(obj.as_bytes(), Format::Obj, &limits).expect_err("a limit");
    assert_eq!(error.message, "has more than 7 points; at most 7 are read");
    let limits = Limits { points: 8, corners: 35 };
    let (text, _) = stl();
    let error = read(text.as_bytes(), Format::Stl, &limits).expect_err("a limit");
    assert_eq!(error.message, "has more than 35 corners; at most 35 are read");
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
        ("frd", "ccx2paraview"),
        ("odb", "program that made it"),
        ("smesh", "tetgen -p"),
        ("sldprt", "program that made it"),
    ] {
        assert!(converter(ending).is_some_and(|help| help.contains(tool)), "{ending}");
    }
    assert!(["toml", "npz", "png", ""].iter().all(|ending| converter(ending).is_none()));
    assert!(
        refusal(b"ISO-10303-21;\n", Format::Obj)
            .contains("is a STEP file, and is not read (mesh it with Gmsh: `gmsh -3")
    );
}
