//! Displacements and velocities beside the points of VTK.

use super::{LIMITS, refusal};
use glam::DVec3;
use localshape_mesh::{Format, Limits, read_cells};

/// The file with an array of other displacements.
fn displaced(name: &str, components: usize, numbers: &str) -> String {
    let text = include_str!("../../files/displaced.vtu");
    let old = "Name=\"U\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 0.5 0 0 0 0.25 0 0 0 -1<";
    assert!(text.contains(old));
    text.replace(old, &format!("Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{numbers}<"))
}

/// Displacements are the point data `U` with two or three components, and are not added to the points.
#[test]
fn displacements_are_read_beside_points() {
    let bytes = include_bytes!("../../files/displaced.vtu");
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
    for name in ["velocity", "Velocity", "VELOCITY"] {
        assert_eq!(of(name, 2, "0 0 0.5 0 0 0.25 1 2").velocities.as_deref(), Some(&plane[..]), "{name}");
    }
    // The length of a velocity.
    assert_eq!(of("Velocity", 1, "0 0.5 0.25 1").velocities, None);
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
