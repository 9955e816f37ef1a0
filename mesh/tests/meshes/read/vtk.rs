//! Cells and arrays of VTK, in its legacy format and in XML.

use super::{LIMITS, bytes_of, file, refusal, volume, whole};
use glam::DVec3;
use localshape_mesh::{Format, read_cells};
use localshape_sim::geometry::{kind, volume_by_faces};
use localshape_sim::{Dimension, Solids};

/// A box of 2 × 1 × 3 as six tetrahedra: its points, and the corners of the cells.
const POINTS: &str = "0 0 0 2 0 0 0 1 0 2 1 0 0 0 3 2 0 3 0 1 3 2 1 3";
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

fn corners() -> String {
    TETRAHEDRA.as_flattened().iter().map(|corner| format!("{corner} ")).collect()
}

fn array(name: &str, components: &str, numbers: &str) -> String {
    format!("<DataArray type='Float64' Name='{name}' NumberOfComponents='{components}'>{numbers}</DataArray>")
}

/// A piece with cells of four points, and data of points and cells.
fn piece(points: &str, corners: &str, data: &str) -> String {
    let count = corners.split_whitespace().count() / 4;
    let offsets: String = (1..=count).map(|at| format!("{} ", 4 * at)).collect();
    format!(
        "<Piece>{data}<Points>{points}</Points><Cells>{}{}{}</Cells></Piece>\n",
        array("connectivity", "1", corners),
        array("offsets", "1", &offsets),
        array("types", "1", &"10 ".repeat(count)),
    )
}

fn grid(pieces: &str) -> String {
    format!("<VTKFile type='UnstructuredGrid'><UnstructuredGrid>{pieces}</UnstructuredGrid></VTKFile>")
}

/// A legacy file of the box with data behind its cells.
fn legacy(data: &str) -> String {
    let cells: String = TETRAHEDRA.iter().map(|[a, b, c, d]| format!("4 {a} {b} {c} {d}\n")).collect();
    format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n{POINTS}\nCELLS 6 30\n{cells}\
         CELL_TYPES 6\n10 10 10 10 10 10\n{data}"
    )
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
fn ghost_cells_are_left_out_and_join_the_pieces() {
    let text = String::from_utf8(bytes_of("ghosts.vtu")).expect("text");
    let older = text.replace("vtkGhostType", "vtkGhostLevels");
    // Ghosts of higher levels, and cells that finer ones cover.
    for text in
        [&text, &older, &older.replace("0 0 0 1 1 1", "0 0 0 1 1 2"), &text.replace("0 0 0 1 1 1", "0 0 0 1 9 33")]
    {
        let found = volume(text, Format::Vtu);
        assert_eq!((found.cells.len(), found.points.len(), found.notes.len()), (6, 8, 0), "one box in two pieces");
        assert!((whole(&found) - 6.0).abs() < 1e-12);
        let listed = read_cells(text.as_bytes(), Format::Vtu, &LIMITS).expect("sound");
        assert_eq!((listed.points.len(), listed.kinds.len(), listed.copies.len()), (16, 6, 6));
    }
    // Other flags of VisIt and VTK leave nothing out.
    let shown = text.replace("0 0 0 1 1 1", "2 4 16 1 1 1");
    assert_eq!(volume(shown, Format::Vtu).cells.len(), 6);
    // Cells that finer ones cover and hidden ones are no part of the body, and no copies that join pieces.
    for flag in ["8", "32", "40"] {
        let hidden = text.replace("0 0 0 1 1 1", &format!("{flag} 0 0 1 1 1"));
        let found = volume(&hidden, Format::Vtu);
        assert_eq!(found.cells.len(), volume(&text, Format::Vtu).cells.len() - text.matches("0 0 0 1 1 1").count());
        let listed = read_cells(hidden.as_bytes(), Format::Vtu, &LIMITS).expect("sound");
        assert_eq!(listed.copies.len(), 6, "{flag}");
    }
    let short = refusal(text.replace("0 0 0 1 1 1", "0 0 0 1 1"), Format::Vtu);
    assert!(short.starts_with("has 5 entries in its array `vtkGhostType` in line "), "{short}");
}

/// Points at one place are the sides of a crack where no copy tells that they are one.
#[test]
fn pieces_are_joined_at_copies_alone() {
    let points = array("Points", "3", POINTS);
    let [one, other] = ["0 1 3 7 0 3 2 7 0 2 6 7", "0 6 4 7 0 4 5 7 0 5 1 7"];
    let data = |numbers: &str| format!("<PointData>{}</PointData>", array("vtkGhostType", "1", numbers));
    let points_of = |data: &str| {
        let text = grid(&(piece(&points, one, "") + &piece(&points, other, data)));
        let found = volume(text, Format::Vtu);
        assert!((whole(&found) - 6.0).abs() < 1e-12);
        found.points.len()
    };
    // The points of both pieces: six of each.
    assert_eq!(points_of(""), 12);
    // 0, 1, 6 and 7 are in both, and 0 and 7 are copies.
    assert_eq!(points_of(&data("1 0 0 0 0 0 0 1")), 10);
    assert_eq!(points_of(&data("1 1 0 0 0 0 1 1")), 8);
    let short = refusal(grid(&piece(&points, one, &data("1 0"))), Format::Vtu);
    assert!(short.starts_with("has 2 entries in its array `vtkGhostType` in line "), "{short}");
    assert!(short.contains("; expected 8, one for each point (the file is damaged"), "{short}");
    // A hidden point is no part of the body, and neither are its cells. 6 belongs to one of three, and 1 to another.
    let hidden = |numbers: &str| volume(grid(&piece(&points, one, &data(numbers))), Format::Vtu).cells.len();
    assert_eq!(hidden("0 0 0 0 0 0 2 0"), 2);
    assert_eq!(hidden("0 2 0 0 0 0 2 0"), 1);
}

#[test]
fn ghosts_of_legacy_files_are_left_out() {
    let ghosts = "0 0 0 1 1 1";
    for data in [
        format!("CELL_DATA 6\nSCALARS vtkGhostType unsigned_char 1\nLOOKUP_TABLE default\n{ghosts}\n"),
        format!(
            "CELL_DATA 6\nFIELD FieldData 2\nheat 1 6 float\n1 2 3 4 5 6\nvtkGhostLevels 1 6 unsigned_char\n{ghosts}\n"
        ),
        format!(
            "POINT_DATA 8\nSCALARS a int\n1 2 3 4 5 6 7 8\nCELL_DATA 6\nSCALARS vtkGhostType unsigned_char\n{ghosts}\n"
        ),
    ] {
        let found = volume(legacy(&data), Format::Vtk);
        assert_eq!(found.cells.len(), 3, "{data}");
        assert!((whole(&found) - 3.0).abs() < 1e-12, "{data}");
    }
    // Twice, and in the name of another array.
    let data = format!(
        "CELL_DATA 6\nSCALARS vtkGhostTypes int\nLOOKUP_TABLE default\n1 2 3 4 5 6\n{0}{0}",
        "FIELD a 1\nvtkGhostType 1 6 int\n1 0 0 0 0 0\n"
    );
    assert_eq!(volume(legacy(&data), Format::Vtk).cells.len(), 5);
    let data = "POINT_DATA 8\nSCALARS vtkGhostType unsigned_char\n0 0 0 0 0 0 0 1\n";
    assert_eq!(read_cells(legacy(data).as_bytes(), Format::Vtk, &LIMITS).expect("sound").copies.indices(), [7]);
    let cut = refusal(legacy("CELL_DATA 6\nSCALARS vtkGhostType unsigned_char\n0 0 0"), Format::Vtk);
    assert!(cut.starts_with("ends in line 18; expected what tells ghosts"), "{cut}");
    let data = "POINT_DATA 8\nSCALARS vtkGhostType unsigned_char\n0 2 0 0 0 0 0 0\n";
    assert_eq!(volume(legacy(data), Format::Vtk).cells.len(), 4, "a hidden point takes its cells with it");
}

/// Arrays of any kind may stand before vectors. The velocity `U` of OpenFOAM is known by the pressure beside it.
#[test]
fn vectors_of_legacy_files_are_those_of_xml() {
    let vectors = "1 0 0 0 2 0 0 0 3 0 0 0 0 0 0 0 0 0 0 0 0 4 5 6";
    let moved = |data: &str| read_cells(legacy(data).as_bytes(), Format::Vtk, &LIMITS).expect("sound").displacements;
    let before = "CELL_DATA 6\nSCALARS a float 2\nLOOKUP_TABLE b\n1 2 3 4 5 6 7 8 9 10 11 12\nLOOKUP_TABLE b 1\n0 0 0 1\n\
                  COLOR_SCALARS c 1\n0 0 0 0 0 1\nPOINT_DATA 8\nTEXTURE_COORDINATES d 1 float\n1 2 3 4 5 6 7 8\n\
                  METADATA\nINFORMATION 0\n\n";
    for name in ["displacement", "U", "u"] {
        for data in
            [format!("VECTORS {name} double\n{vectors}\n"), format!("FIELD f 1\n{name} 3 8 double\n{vectors}\n")]
        {
            let found = moved(&(before.to_owned() + &data)).expect("displacements");
            assert_eq!((found[1], found[7]), (DVec3::Y * 2.0, DVec3::new(4.0, 5.0, 6.0)), "{data}");
            assert_eq!(
                moved(&format!("{before}{data}SCALARS p float\n1 2 3 4 5 6 7 8\n")).is_some(),
                name == "displacement"
            );
        }
    }
    let short = refusal(legacy("POINT_DATA 7\nVECTORS u double\n"), Format::Vtk);
    assert!(short.starts_with("has 7 entries in its array `u` in line 17; expected 8, one for each point"), "{short}");
    let found = volume(legacy("POINT_DATA 8\nSPHERES\n"), Format::Vtk);
    assert_eq!(found.notes, ["has `SPHERES` in line 17 among its data, of which the rest is not read"]);
}

#[test]
fn structured_grids_are_refused_with_what_converts_them() {
    for kind in ["STRUCTURED_POINTS", "STRUCTURED_GRID", "RECTILINEAR_GRID"] {
        let text = format!("# vtk DataFile Version 3.0\nt\nASCII\nDATASET {kind}\nDIMENSIONS 3 2 4\n");
        assert_eq!(
            refusal(text, Format::Vtk),
            format!(
                "has `{kind}` in line 4; expected `UNSTRUCTURED_GRID` or `POLYDATA` (write it as an unstructured grid: \
                 ParaView's filter `Append Datasets` makes one)"
            )
        );
    }
}

#[test]
fn points_of_two_components_are_in_the_plane() {
    let text = |components: &str| {
        let points = array("Points", components, "0 0 2 0 2 2 0 2 1 1 1 0");
        let cells = [("connectivity", "0 1 2 0 2 3"), ("offsets", "3 6"), ("types", "5 5")];
        let cells: String = cells.iter().map(|(name, numbers)| array(name, "1", numbers)).collect();
        grid(&format!("<Piece>\n<Points>{points}</Points><Cells>{cells}</Cells></Piece>"))
    };
    let found = volume(text("2"), Format::Vtu);
    assert_eq!((found.dimension, found.points.len()), (Dimension::Plane, 4));
    assert!((whole(&found) - 4.0).abs() < 1e-12);
    let found = refusal(text("4"), Format::Vtu);
    assert_eq!(
        found,
        "has 4 components in its array `Points` in line 2; expected 3, or 2 in the plane (write points and vectors with x, y and z)"
    );
}

#[test]
fn attributes_in_single_quotes_are_read() {
    let text = String::from_utf8_lossy(&bytes_of("cells-raw.vtu")).into_owned();
    assert!(text.contains("encoding=\"raw\""));
    // Of XML alone: the data behind it are bytes.
    let bytes = bytes_of("cells-raw.vtu");
    let begin = bytes.windows(9).rposition(|window| window == b"encoding=").expect("an encoding");
    let end = begin + 20;
    let single: Vec<u8> = bytes[..end].iter().map(|&byte| if byte == b'"' { b'\'' } else { byte }).collect();
    assert_eq!(volume([&single, &bytes[end..]].concat(), Format::Vtu), volume(&bytes, Format::Vtu));
}

#[test]
fn flat_cells_among_others_are_left_out_and_told() {
    const CORNERS: &str = "[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]";
    let points = array("Points", "3", POINTS);
    let found = volume(grid(&piece(&points, &(corners() + "0 1 3 2"), "")), Format::Vtu);
    assert_eq!(found.cells.len(), 6);
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    assert_eq!(found.notes, [format!("has a cell without volume, which is left out: it has corners at {CORNERS}")]);
    let found = volume(grid(&piece(&points, &(corners() + "0 1 3 2 4 4 5 6"), "")), Format::Vtu);
    assert_eq!(
        found.notes,
        [format!("has 2 cells without volume, which are left out: the first has corners at {CORNERS}")]
    );
    let found = refusal(grid(&piece(&points, "0 1 3 2", "")), Format::Vtu);
    let expected = format!("has only cells without volume: the first has corners at {CORNERS} (mesh");
    assert!(found.starts_with(&expected), "{found}");
}

#[test]
fn points_without_a_position_are_left_out_where_no_cell_has_them() {
    let lost = ["nan nan nan", "0 -nan(ind) 0", "1.#QNAN 0 0", "0 0 inf"];
    for lost in lost {
        let points = array("Points", "3", &format!("{POINTS} {lost}"));
        let found = volume(grid(&piece(&points, &corners(), "")), Format::Vtu);
        assert_eq!((found.cells.len(), found.points.len(), found.notes.len()), (6, 8, 1));
        assert_eq!(found.notes[0], "has a point without coordinates, which is left out");
        let used = refusal(grid(&piece(&points, "0 1 3 7 0 3 2 8", "")), Format::Vtu);
        let expected = "has point 8 without coordinates in line 1, and a face with it; expected numbers (";
        assert!(used.starts_with(expected), "{used}");
        let old = legacy("").replace("POINTS 8", "POINTS 9").replace(POINTS, &format!("{POINTS} {lost}"));
        assert_eq!(volume(old, Format::Vtk).notes, found.notes);
    }
    let two = array("Points", "3", &format!("{POINTS} nan nan nan nan nan nan"));
    let found = volume(grid(&piece(&two, &corners(), "")), Format::Vtu);
    assert_eq!(found.notes, ["has 2 points without coordinates, which are left out"]);
    let gmsh = String::from_utf8(bytes_of("comments-2.2.msh")).expect("text");
    let found = volume(gmsh.replace("$Nodes\n8", "$Nodes\n9\n77 nan nan nan"), Format::Gmsh);
    assert_eq!((found.points.len(), found.notes.len()), (8, 1));
}

/// A prism of the height 1 over a polygon in the plane, as a polyhedron of a legacy file; its faces need not be turned outwards.
fn prism(polygon: &[[f64; 2]], move_by: f64, is_turned: bool) -> String {
    let count = polygon.len();
    let points: String =
        [0, 1].iter().flat_map(|z| polygon.iter().map(move |[x, y]| format!("{} {y} {z}\n", x + move_by))).collect();
    let mut faces: Vec<Vec<usize>> = vec![(0..count).rev().collect(), (count..2 * count).collect()];
    faces.extend((0..count).map(|at| vec![at, (at + 1) % count, (at + 1) % count + count, at + count]));
    faces.iter_mut().step_by(2).filter(|_| is_turned).for_each(|face| face.reverse());
    let lists: Vec<usize> =
        faces.iter().flat_map(|face| std::iter::once(face.len()).chain(face.iter().copied())).collect();
    let list = lists.iter().fold(faces.len().to_string(), |text, number| format!("{text} {number}"));
    format!(
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} float\n{points}CELLS 1 {}\n{} {list}\n\
         CELL_TYPES 1\n42\n",
        2 * count,
        lists.len() + 2,
        lists.len() + 1
    )
}

#[test]
fn polyhedra_that_are_not_convex_are_told() {
    const CORNER: [[f64; 2]; 6] = [[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]];
    const STRAIGHT: [[f64; 2]; 6] = [[0., 0.], [1., 0.], [2., 0.], [2.3, 1.1], [1., 2.], [0., 2.]];
    let told = ["has polyhedra that are not convex, which become the hulls of their points: 1"];
    for is_turned in [false, true] {
        for (polygon, notes) in [(CORNER, &told[..]), (STRAIGHT, &[])] {
            for move_by in [0.0, 1000.0] {
                let found = volume(prism(&polygon, move_by, is_turned), Format::Vtk);
                assert_eq!((found.cells.len(), found.cells[0].len()), (1, 12));
                assert!(found.notes.iter().eq(notes), "{polygon:?}, {move_by}, {is_turned}: {:?}", found.notes);
            }
        }
    }
    let one = prism(&CORNER, 0.0, false);
    let (start, end) = (one.find("CELLS").expect("cells"), one.find("CELL_TYPES").expect("types"));
    let list = one[start..end].lines().nth(1).expect("a list");
    let length: usize = list.split(' ').count();
    let two = format!("{}CELLS 2 {}\n{list}\n{list}\nCELL_TYPES 2\n42 42\n", &one[..start], 2 * length);
    let found = read_cells(two.as_bytes(), Format::Vtk, &LIMITS).expect("sound").notes;
    assert_eq!(found, ["has polyhedra that are not convex, which become the hulls of their points: 2"]);
}
