//! Cells that list a corner more than once.

use super::{each, refusal, volume, whole};
use localshape_mesh::{Format, Mesh, read_cells};
use localshape_sim::Solids;

/// The corners of a box of 2 × 1 × 3, counted from 1 around its lower side and then around its upper one, and two points beside it.
const NODES: &str = "*NODE\n1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 1, 0\n4, 0, 1, 0\n5, 0, 0, 3\n6, 2, 0, 3\n7, 2, 1, 3\n8, 0, 1, 3\n9, 4, 0, 0\n\
                     10, 4, 0, 3\n11, 1, 0.5, 0.5\n";

/// A file of cells with these corners.
fn file(kind: &str, cells: &[&str]) -> String {
    let lists: String = (1..).zip(cells).map(|(at, corners)| format!("{at}, {corners}\n")).collect();
    format!("{NODES}*ELEMENT, TYPE={kind}\n{lists}")
}

/// The note of so many cells.
fn note(count: usize) -> String {
    format!("has cells that list a corner more than once, which are read as wedges, pyramids and tetrahedra: {count}")
}

#[test]
fn hexahedra_and_wedges_with_repeated_corners_are_simpler_cells() {
    for (kind, corners, nodes, expected) in [
        // Wedges as Abaqus and Ansys write them, and as LS-DYNA does; the first also inside out.
        ("C3D8", "1, 2, 3, 3, 5, 6, 7, 7", 6, 3.0),
        ("C3D8", "5, 6, 7, 7, 1, 2, 3, 3", 6, 3.0),
        ("C3D8", "1, 2, 6, 5, 4, 4, 8, 8", 6, 3.0),
        // Pyramids: four corners in one, and a wedge with an edge that is one corner.
        ("C3D8", "1, 2, 3, 4, 5, 5, 5, 5", 5, 2.0),
        ("C3D6", "1, 2, 3, 1, 6, 7", 5, 2.0),
        // Tetrahedra, of which the second has a bent quadrilateral.
        ("C3D8", "1, 2, 3, 3, 7, 7, 7, 7", 4, 1.0),
        ("C3D8", "1, 2, 3, 7, 7, 7, 7, 7", 4, 1.0),
        ("C3D6", "1, 2, 3, 7, 7, 7", 4, 1.0),
        ("C3D5", "1, 2, 3, 3, 7", 4, 1.0),
    ] {
        let found = volume(file(kind, &[corners]), Format::Abaqus);
        assert_eq!((found.cells.len(), found.cells[0].len(), found.points.len()), (1, nodes, nodes), "{corners}");
        assert_eq!((found.solids, found.turned, &found.notes[..]), (Solids::Ordered, 0, &[note(1)][..]), "{corners}");
        assert!((whole(&found) - expected).abs() < 1e-12, "{corners}: {}", whole(&found));
    }
    let found = volume(file("C3D8", &["1, 2, 3, 4, 5, 6, 7, 8", "2, 9, 3, 3, 6, 10, 7, 7"]), Format::Abaqus);
    assert_eq!((found.cells.len(), found.points.len(), &found.notes[..]), (2, 10, &[note(1)][..]));
    assert!((whole(&found) - 9.0).abs() < 1e-12);
    let found = volume(file("C3D8", &["1, 2, 3, 3, 5, 6, 7, 7", "1, 3, 4, 4, 5, 7, 8, 8"]), Format::Abaqus);
    assert_eq!((found.cells.len(), found.points.len(), &found.notes[..]), (2, 8, &[note(2)][..]));
    assert!((whole(&found) - 6.0).abs() < 1e-12);
}

#[test]
fn cells_that_are_of_no_kind_become_tetrahedra() {
    let check = |text: &str, points: usize, expected: f64| {
        let found = volume(text, Format::Abaqus);
        assert!(found.cells.iter().all(|cell| cell.len() == 4) && found.points.len() == points, "{text}");
        assert!(each(&found).iter().all(|&volume| volume > 0.0), "{text}");
        assert!((whole(&found) - expected).abs() < 1e-12, "{text}: {}", whole(&found));
        assert_eq!((found.turned, found.notes), (0, vec![note(1)]));
    };
    // One edge is one corner: a roof over 4 × 1 with the height 2, of which a tetrahedron is cut off the front.
    let roof = "*NODE\n1, 0, 0, 0\n2, 4, 0, 0\n3, 4, 1, 0\n4, 0, 1, 0\n5, 1, 0, 1\n6, 3, 0, 1\n7, 2, 1, 2\n\
                *ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 7\n";
    check(roof, 7, 11.0 / 3.0);
    // A wedge with a bent side, however its corners are numbered.
    for [a, b, c, d, e] in [[1, 2, 3, 5, 6], [2, 3, 1, 5, 6]] {
        let nodes = format!("{a}, 0, 0, 0\n{b}, 1, 0, 0\n{c}, 1, 1, 0\n{d}, 0, 0, 1\n{e}, 1, 0, 1\n");
        let text = format!("*NODE\n{nodes}*ELEMENT, TYPE=C3D6\n1, {a}, {b}, {c}, {d}, {e}, {e}\n");
        check(&text, 5, 1.0 / 3.0);
    }
    // Two edges across each other are one corner each. The two quadrilaterals that are left are bent.
    check(&file("C3D8", &["1, 2, 3, 3, 5, 5, 7, 8"]), 6, 4.0);
}

#[test]
fn cells_that_are_flat_are_left_out_however_they_are_listed() {
    for corners in
        ["1, 2, 3, 4, 1, 2, 3, 4", "1, 2, 11, 4, 1, 2, 11, 4", "1, 2, 3, 3, 3, 3, 3, 3", "1, 1, 1, 1, 1, 1, 1, 1"]
    {
        let found = refusal(file("C3D8", &[corners]), Format::Abaqus);
        assert!(found.starts_with("has only cells without volume: the first has corners at ["), "{corners}: {found}");
        let found = volume(file("C3D8", &[corners, "1, 2, 3, 4, 5, 6, 7, 8"]), Format::Abaqus);
        assert_eq!(found.cells.len(), 1, "{corners}");
        assert!(found.notes.len() == 1 && found.notes[0].starts_with("has a cell without volume, which is left out"));
    }
}

#[test]
fn welded_cells_are_simpler_ones() {
    let nodes =
        "*NODE\n1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 1, 0\n4, 2, 1, 0\n5, 0, 0, 3\n6, 2, 0, 3\n7, 2, 1, 3\n8, 2, 1, 3\n";
    let text = format!("{nodes}*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n");
    let mut cells = read_cells(text.as_bytes(), Format::Abaqus, &super::LIMITS).expect("sound");
    assert_eq!(cells.weld(1e-9), 2);
    let Ok(Mesh::Volume(found)) = cells.mesh(Format::Abaqus) else { panic!("a volume") };
    assert_eq!((found.cells[0].len(), found.points.len(), &found.notes[..]), (6, 6, &[note(1)][..]));
    assert!((whole(&found) - 3.0).abs() < 1e-12);
}
