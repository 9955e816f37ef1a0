//! Files of cells: what each field of them means, and what is left out.

use glam::DVec3;
use localshape_mesh::{Format, Limits, Mesh, Surface, Volume, read, read_cells};
use localshape_sim::geometry::{kind, volume_by_faces};
use localshape_sim::{Dimension, Solids};

const LIMITS: Limits = Limits { points: 1_000_000, corners: 8_000_000 };

fn mesh(bytes: impl AsRef<[u8]>, format: Format) -> Mesh {
    read(bytes.as_ref(), format, &LIMITS).unwrap_or_else(|error| panic!("{error} ({:?})", error.help))
}

fn volume(bytes: impl AsRef<[u8]>, format: Format) -> Volume {
    match mesh(bytes, format) {
        Mesh::Volume(volume) => volume,
        Mesh::Surface(surface) => panic!("{surface:?}"),
    }
}

fn surface(bytes: impl AsRef<[u8]>, format: Format) -> Surface {
    match mesh(bytes, format) {
        Mesh::Surface(surface) => surface,
        Mesh::Volume(volume) => panic!("{volume:?}"),
    }
}

/// The message and the remedy of a refusal.
fn refusal(bytes: impl AsRef<[u8]>, format: Format) -> String {
    let error = read(bytes.as_ref(), format, &LIMITS).expect_err("a refusal");
    format!("{} ({})", error.message, error.help.expect("a remedy"))
}

fn file(name: &str) -> Vec<u8> {
    std::fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name)).expect("a file")
}

/// The volume of each cell, negative if it is not in the order of its kind.
fn each(volume: &Volume) -> Vec<f64> {
    let of = |cell: &[u32]| volume_by_faces(kind(volume.dimension, volume.solids, cell.len()), cell, &volume.points);
    volume.cells.iter().map(of).collect()
}

fn whole(volume: &Volume) -> f64 {
    each(volume).iter().sum()
}

/// The number of points in each group, with its name.
fn groups(volume: &Volume) -> Vec<(&str, usize)> {
    volume.groups.iter().map(|group| (&*group.name, group.points.len())).collect()
}

/// The positions of the points of a group.
fn group(volume: &Volume, name: &str) -> Vec<[f64; 3]> {
    let group = volume.groups.iter().find(|group| group.name == name).unwrap_or_else(|| panic!("{name}"));
    group.points.iter().map(|&point| volume.points[point as usize].to_array()).collect()
}

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
fn groups_of_partitioned_gmsh_files_are_those_of_all_partitions() {
    let found = volume(file("partitioned-4.1.msh"), Format::Gmsh);
    assert_eq!((found.cells.len(), groups(&found)), (6, vec![("clamped side", 4), ("soft part", 8)]));
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    // As Gmsh has written it.
    let found = volume(file("partitioned-4.1-binary.msh"), Format::Gmsh);
    assert_eq!((found.cells.len(), groups(&found)), (18, vec![("clamped side", 4), ("soft part", 12)]));
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    assert!(group(&found, "clamped side").iter().all(|at| at[0] == 0.0));
}

#[test]
fn comments_of_gmsh_stand_before_and_between_sections() {
    let text = String::from_utf8(file("comments-2.2.msh")).expect("text");
    let comment = "$Comments\nof $Nodes and $Elements\n$EndComments\n";
    for text in
        [text.clone(), text.replace("$Nodes\n8", &format!("{comment}{comment}$Nodes\n8")), format!("{comment}{text}")]
    {
        let found = volume(&text, Format::Gmsh);
        assert_eq!(groups(&found), [("a \"b\" c", 8), ("ü", 4)]);
        assert!((whole(&found) - 6.0).abs() < 1e-12);
    }
    assert!(refusal("$Comments\nno end", Format::Gmsh).starts_with("ends in line 2; expected `$EndComments`"));
}

/// A negative number of a physical group stands for the other orientation of its surface.
#[test]
fn negative_groups_of_gmsh_keep_their_names() {
    let text = String::from_utf8(file("partitioned-4.1.msh")).expect("text");
    let turned = text.replace("0 0 0 0 1 3 1 7 0", "0 0 0 0 1 3 1 -7 0");
    assert_ne!(text, turned);
    assert_eq!(groups(&volume(turned, Format::Gmsh)), [("clamped side", 4), ("soft part", 8)]);
    let old = String::from_utf8(file("comments-2.2.msh")).expect("text");
    assert!(old.contains("2 2 4 2 1 1 1 1 5 7\n3 2 4 -2 1 1 1 1 7 3"), "one triangle of either sign");
    assert_eq!(groups(&volume(old, Format::Gmsh))[1], ("ü", 4));
}

#[test]
fn ghost_cells_are_left_out_and_join_the_pieces() {
    let text = String::from_utf8(file("ghosts.vtu")).expect("text");
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
    let text = String::from_utf8_lossy(&file("cells-raw.vtu")).into_owned();
    assert!(text.contains("encoding=\"raw\""));
    // Of XML alone: the data behind it are bytes.
    let bytes = file("cells-raw.vtu");
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
    let gmsh = String::from_utf8(file("comments-2.2.msh")).expect("text");
    let found = volume(gmsh.replace("$Nodes\n8", "$Nodes\n9\n77 nan nan nan"), Format::Gmsh);
    assert_eq!((found.points.len(), found.notes.len()), (8, 1));
}

/// The volumes of one element of each kind, with the lengths 1: a tetrahedron, a pyramid, a wedge and a cube.
const OF_KINDS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 0.5, 1.0];

fn check_kinds(found: &Volume) {
    assert_eq!((found.dimension, found.solids, found.turned), (Dimension::Space, Solids::Ordered, 0));
    assert_eq!(found.points.len(), 23);
    let volumes = each(found);
    assert_eq!(volumes.len(), 4);
    assert!(volumes.iter().zip(OF_KINDS).all(|(found, expected)| (found - expected).abs() < 1e-12), "{volumes:?}");
}

#[test]
fn cells_and_references_are_read_from_medit() {
    let text = String::from_utf8(file("kinds.mesh")).expect("text");
    let found = volume(&text, Format::Medit);
    check_kinds(&found);
    assert_eq!(found.notes, [""; 0]);
    let expected =
        [("curve 3", 2), ("point 5", 1), ("surface -7", 3), ("surface 7", 7), ("volume 1", 9), ("volume 2", 14)];
    assert_eq!(groups(&found), expected);
    assert_eq!(group(&found, "curve 3"), [[4.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    assert_eq!(group(&found, "point 5"), [[0.0, 0.0, 1.0]]);
    // Faces alone in the plane, with points of two coordinates, and triangles of second order.
    let plane = "MeshVersionFormatted\n1\nDimension 2\nVertices\n5\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n1 0 0\n\
                 Quadrilaterals\n1\n1 2 3 4 0\nEnd\n";
    let found = volume(plane, Format::Medit);
    assert_eq!((found.dimension, groups(&found), found.points.len()), (Dimension::Plane, vec![], 4));
    assert!((whole(&found) - 2.0).abs() < 1e-12);
    let second = plane.replace("Quadrilaterals\n1\n1 2 3 4 0", "TrianglesP2\n1\n1 2 3 5 5 5 0");
    assert!((whole(&volume(second, Format::Medit)) - 1.0).abs() < 1e-12);
    let points = ["0 0", "2 0", "2 1", "0 1", "1 0"].map(|point| format!("\n{point} 0"));
    let space = (0..).zip(&points).fold(plane.replace("Dimension 2", "Dimension 3"), |text, (at, point)| {
        text.replacen(point, &format!("{} {} 0", &point[..4], at % 2), 1)
    });
    assert_eq!(surface(space, Format::Medit).triangles.len(), 2);
}

#[test]
fn refusals_of_medit_files_say_where_and_what_to_do() {
    let text = String::from_utf8(file("kinds.mesh")).expect("text");
    for (from, to, expected) in [
        ("MeshVersionFormatted 2", "MeshVersionFormatted x", "has `x` in line 1; expected the version ("),
        (
            "MeshVersionFormatted 2",
            "MFEM mesh v1.0",
            "begins with `MFEM mesh v1.0`; expected `MeshVersionFormatted`, as a Medit",
        ),
        ("Dimension\n3", "Dimension\n4", "has `4` in line 5; expected the dimension 2 or 3 ("),
        ("1 2 3 4 1\n", "1 2 3 24 1\n", "names point 24 in line 48, but has points 1 to 23 ("),
        ("1 2 3 4 1\n", "1 2 3 0 1\n", "names a point that it does not have in line 48 ("),
        ("1 2 3 4 1\n", "1 2 3 x 1\n", "has `x` in line 48; expected the number of a vertex ("),
        ("2 0 0 0\n", "2,5 0 0 0\n", "has `2,5` in line 11; expected a coordinate"),
        ("Vertices\n23", "Vertices\n-1", "has `-1` in line 6; expected the number of vertices ("),
        ("Vertices\n23", "Vertices\n24", "has `Corners` in line 30; expected a coordinate ("),
        ("Corners", "1 Corners", "has `1` in line 30; expected a keyword, such as `Tetrahedra` ("),
    ] {
        assert!(text.contains(from), "{from}");
        let found = refusal(text.replacen(from, to, 1), Format::Medit);
        assert!(found.starts_with(expected), "{to}: {found}");
    }
    let binary = refusal([1, 0, 0, 0, 2, 0, 0, 0], Format::Medit);
    let expected = "is a binary file of Medit (.meshb); expected Medit's text (.mesh) (convert it: `meshio convert FILE.meshb NEW.mesh`)";
    assert_eq!(binary, expected);
    // What is not read, and an end that is missing.
    let odd = text.replace("Corners", "TetrahedraP7").replace("End\n", "");
    assert_eq!(
        volume(odd, Format::Medit).notes,
        ["has `TetrahedraP7` in line 30, which is not read", "has no `End`, so that its end may be missing"]
    );
    let several = text.replace("Corners", "TetrahedraP7").replace("RequiredVertices", "SolAtVertices");
    assert_eq!(
        volume(several, Format::Medit).notes,
        ["has keywords that are not read: `TetrahedraP7` in line 30, `SolAtVertices` in line 33"]
    );
    let nothing =
        "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nTrianglesP7\n1\n1 1\nHexahedraQ9\n1\n1 1\nEnd\n";
    let found = refusal(nothing, Format::Medit);
    let expected =
        "has keywords that are not read: `TrianglesP7` in line 6, `HexahedraQ9` in line 9 (write triangles, ";
    assert!(found.starts_with(expected), "{found}");
}

#[test]
fn cells_and_sets_are_read_from_abaqus() {
    let found = volume(file("kinds.inp"), Format::Abaqus);
    check_kinds(&found);
    assert_eq!(found.notes, ["has elements that are not read: 2 of the type SPRINGA"]);
    let expected = [
        ("CUBE", 1),
        ("Left end", 3),
        ("all", 9),
        ("all elements", 23),
        ("both", 5),
        ("mixed", 17),
        ("rows", 2),
        ("skin", 3),
        ("small", 9),
    ];
    assert_eq!(groups(&found), expected);
    assert_eq!(group(&found, "Left end"), [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(group(&found, "rows"), [[4.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    assert_eq!(group(&found, "CUBE"), [[6.0, 0.0, 0.0]], "a set of nodes before one of elements");
}

#[test]
fn kinds_of_elements_of_abaqus_have_their_numbers_of_nodes() {
    let nodes: String =
        (1..=24).map(|node| format!("{node}, {}, {}, {}\n", node % 3, node / 3 % 3, node / 9)).collect();
    let all = |kind: &str, count: usize| {
        let list: Vec<String> = (1..=count).map(|node| node.to_string()).collect();
        let text = format!("*NODE\n{nodes}*ELEMENT, TYPE={kind}\n1, {}\n", list.join(", "));
        read_cells(text.as_bytes(), Format::Abaqus, &LIMITS).map(|cells| cells.corners[0].len())
    };
    for (kind, nodes, corners) in [
        ("C3D4", 4, 4),
        ("C3D4H", 4, 4),
        ("C3D10M", 10, 4),
        ("C3D5", 5, 5),
        ("C3D6", 6, 6),
        ("C3D15", 15, 6),
        ("C3D8", 8, 8),
        ("C3D8R", 8, 8),
        ("C3D8I", 8, 8),
        ("C3D20", 20, 8),
        ("C3D20RH", 20, 8),
        ("SC8R", 8, 8),
        ("CPS3", 3, 3),
        ("CPE4R", 4, 4),
        ("CPS6", 6, 3),
        ("CPE8", 8, 4),
        ("S3R", 3, 3),
        ("S4RSW", 4, 4),
        ("S8R5", 8, 4),
        ("STRI3", 3, 3),
        ("R3D4", 4, 4),
        ("M3D3", 3, 3),
        ("SFM3D4R", 4, 4),
        ("T3D2", 2, 2),
    ] {
        assert_eq!(all(kind, nodes).expect("sound"), corners, "{kind}");
        let message = all(kind, nodes + 1).expect_err("too many nodes").message;
        assert!(message.contains(&format!("expected {nodes}, as {kind} has")), "{kind}: {message}");
    }
    for kind in ["C3D15V", "COH3D8", "CAX4", "STRI65", "B31", "U1"] {
        let message = all(kind, 8).expect_err("not read").message;
        assert!(message.starts_with(&format!("has elements that are not read: 1 of the type {kind}")), "{message}");
    }
}

#[test]
fn an_assembly_of_abaqus_has_the_mesh_of_its_part_or_of_its_instance() {
    let dependent = String::from_utf8(file("assembly.inp")).expect("text");
    let mesh = &dependent[dependent.find("*NODE").expect("nodes")..dependent.find("*END PART").expect("an end")];
    let independent =
        dependent.replace(mesh, "").replace("0, 0, 0\n*END INSTANCE", &format!("0, 0, 0\n{mesh}*END INSTANCE"));
    for text in [&dependent, &independent] {
        let found = volume(text, Format::Abaqus);
        assert_eq!((found.cells.len(), found.points.len()), (2, 5), "{text}");
        assert!((whole(&found) - 0.5).abs() < 1e-12, "{text}");
        // Nodes and sets of the assembly itself are points of reference, with numbers of their own.
        assert_eq!(groups(&found), [("Tip", 1), ("all", 5), ("far", 4), ("held", 3), ("of far", 4)]);
        assert_eq!(group(&found, "Tip"), [[0.0, 0.0, 1.0]]);
        assert_eq!(group(&found, "held"), [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(group(&found, "far").contains(&[1.0, 1.0, 1.0]));
        assert_eq!(found.notes, ["has sets of its assembly without `INSTANCE`, which are not read: 1"]);
    }
    let two = dependent.replace("*END ASSEMBLY", "*ELSET, ELSET=other\n1\n*END ASSEMBLY");
    let expected = ["has sets of its assembly without `INSTANCE`, which are not read: 2"];
    assert_eq!(volume(two, Format::Abaqus).notes, expected);
}

/// Members are counted as they are listed, not only those that are left when each is there once.
#[test]
fn sets_of_abaqus_named_again_and_again_are_refused() {
    let nodes: String = (1..=100).map(|node| format!("{node}, {node}, 0, 0\n")).collect();
    let elements: String = (1..100).map(|node| format!("{node}, {node}, {}\n", node + 1)).collect();
    let mesh = format!("*NODE, NSET=all\n{nodes}*ELEMENT, TYPE=T3D2, ELSET=rods\n{elements}");
    let limits = Limits { points: 1000, corners: 1000 };
    for (again, times, is_read) in [
        (format!("*NSET, NSET=more\n{}\n", "all, ".repeat(30)), 1, true),
        (format!("*NSET, NSET=more\n{}\n", "all, ".repeat(41)), 1, false),
        ("*NSET, NSET=more\nall\n".to_owned(), 41, false),
        ("*NSET, NSET=more, ELSET=rods\n".to_owned(), 21, false),
    ] {
        match read_cells(format!("{mesh}{}", again.repeat(times)).as_bytes(), Format::Abaqus, &limits) {
            Ok(_) => assert!(is_read, "{again}"),
            Err(error) => {
                assert_eq!((error.message.as_str(), is_read), ("has groups with more than 4000 nodes", false))
            }
        }
    }
}

#[test]
fn refusals_of_abaqus_files_say_where_and_what_to_do() {
    let nodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";
    let cell = "*ELEMENT, TYPE=C3D4, ELSET=all\n1, 1, 2, 3, 4\n";
    let damaged = "(the file is damaged: copy, download or write it again)";
    for (text, expected) in [
        ("[TITLE]\nwater", "begins with `[TITLE]`; expected a keyword, such as `*NODE`, as an Abaqus file does (check"),
        (
            "*NODE\n1, 0,5, 0,0, 0,0\n",
            "has more than a number and three coordinates of a node in line 2 (write decimal points",
        ),
        ("*NODE\n1 0 0 0\n", "has `0` in line 2; expected a comma"),
        ("*NODE\n1, x\n", "has `x` in line 2; expected a coordinate"),
        (
            "*NODE, SYSTEM=C\n1, 1, 90\n",
            "has `*NODE` in line 1; expected all nodes and elements in this file, with x, y and z (write",
        ),
        ("*NODE, INPUT=a.inp\n", "has `*NODE` in line 1; expected all nodes and elements in this file"),
        ("*NODE\n1, 0, 0, 0\n*NGEN\n1, 9\n", "has `*NGEN` in line 3; expected all nodes and elements in this file"),
        ("*Include, input=mesh.inp\n", "has `*INCLUDE` in line 1; expected all nodes and elements in this file"),
        ("*NODE\n, 0, 0, 0\n", "has `,` in line 2; expected the number of a node"),
        ("*NSET\n1", "has `*NSET` in line 1; expected the keyword with `NSET` ("),
        (
            "*PART, NAME=b\n*END PART\n*INSTANCE, NAME=a, PART=b\n0, 0, 9\n",
            "has `*INSTANCE` in line 3; expected a single part with a single instance, which is not moved (write it without",
        ),
        ("*PART, NAME=b\n*END PART\n*PART, NAME=c\n", "has `*PART` in line 3; expected a single part with a single"),
        ("NODES *ELEMENT, ELSET=a\n1, 1\n", "has `*ELEMENT` in line 6; expected the keyword with `TYPE` ("),
        ("NODES *ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 9\n", "names node 9 in line 7, which it does not have"),
        (
            "NODES *ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4, 4\n",
            "has an element with 5 nodes in line 7; expected 4, as C3D4 has",
        ),
        ("NODES *ELEMENT, TYPE=C3D4\n7, 1, 2, 3\n", "has an element with 3 nodes in line 7; expected 4, as C3D4 has"),
        ("NODES *ELEMENT, TYPE=C3D4\n7, 1, 2, 3\n8, 1, 2, 3, 4\n", "names node 8 in line 8, which it does not have"),
        ("NODES CELL *NSET, NSET=a\n5\n", "names the node `5` in line 9, which it does not have before"),
        ("NODES CELL *ELSET, ELSET=a\n2\n", "names the element `2` in line 9, which it does not have before"),
        ("NODES CELL *NSET, NSET=a\nb\n", "names the set `b` in line 9, which it does not have before"),
        ("NODES CELL *NSET, NSET=a, ELSET=c\n", "names the set `c` in line 8, which it does not have before"),
        (
            "NODES CELL *NSET, NSET=a, GENERATE\n4, 1\n",
            "has `4, 1` in line 9; expected a first number, a last one and a step",
        ),
        (
            "NODES CELL *NSET, NSET=a, GENERATE\n1, 4, 0\n",
            "has `1, 4, 0` in line 9; expected a first number, a last one",
        ),
        (
            "NODES CELL *NSET, NSET=a, GENERATE\n1, 4, 1, 1\n",
            "has `1, 4, 1, 1` in line 9; expected a first number, a last one",
        ),
        (
            "NODES CELL *NSET, NSET=a, GENERATE\n1, 9223372036854775807\n",
            "has groups with more than 32000000 nodes (put",
        ),
    ] {
        let text = text.replace("NODES ", nodes).replace("CELL ", cell);
        let found = refusal(&text, Format::Abaqus);
        assert!(found.starts_with(expected), "{text}: {found}");
        assert!(found.contains(damaged) || !found.contains("damaged"), "{found}");
    }
    assert_eq!(volume(format!("{nodes}{cell}"), Format::Abaqus).cells.len(), 1);
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
        let text = String::from_utf8(file(name)).expect("text");
        for end in ["\r", "\r\n"] {
            assert_eq!(volume(text.replace('\n', end), format), volume(&text, format), "{name}");
        }
    }
    let damaged =
        String::from_utf8(file("kinds.inp")).expect("text").replace("30, 0., 1.", "30, x, 1.").replace('\n', "\r");
    assert!(refusal(damaged, Format::Abaqus).starts_with("has `x` in line 7; expected a coordinate"));
}
