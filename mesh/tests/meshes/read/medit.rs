//! Cells and references of Medit.

use super::{STRAIGHT, bytes_of, check_kinds, group, groups, refusal, surface, volume, whole};
use localshape_mesh::Format;
use localshape_sim::Dimension;

#[test]
fn cells_and_references_are_read_from_medit() {
    let text = String::from_utf8(bytes_of("kinds.mesh")).expect("text");
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
    let second = volume(second, Format::Medit);
    assert!((whole(&second) - 1.0).abs() < 1e-12);
    assert_eq!(second.notes, STRAIGHT);
    let points = ["0 0", "2 0", "2 1", "0 1", "1 0"].map(|point| format!("\n{point} 0"));
    let space = (0..).zip(&points).fold(plane.replace("Dimension 2", "Dimension 3"), |text, (at, point)| {
        text.replacen(point, &format!("{} {} 0", &point[..4], at % 2), 1)
    });
    assert_eq!(surface(space, Format::Medit).triangles.len(), 2);
}

#[test]
fn refusals_of_medit_files_say_where_and_what_to_do() {
    let text = String::from_utf8(bytes_of("kinds.mesh")).expect("text");
    for (from, to, expected) in [
        ("MeshVersionFormatted 2", "MeshVersionFormatted x", "has `x` in line 1; expected the version ("),
        ("MeshVersionFormatted 2", "Mesh v1.0", "begins with `Mesh v1.0`; expected `MeshVersionFormatted`, as a Medit"),
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
fn comments_of_medit_stand_anywhere() {
    let text = String::from_utf8(bytes_of("kinds.mesh")).expect("text");
    let expected = volume(&text, Format::Medit);
    let end = text.rfind("End").expect("an end");
    for comment in ["# a", "  # End 1 2 3", "#1\n\n# 2"] {
        let lines: Vec<String> = text[..end].lines().map(|line| format!("{line} # 9\n{comment}\n")).collect();
        assert_eq!(volume(lines.concat() + "End # a\n", Format::Medit), expected, "{comment}");
    }
    // Numbers behind a comment have their lines.
    let wrong = refusal(text.replacen("Vertices\n23", "Vertices\n# a\n23 # b\n# c\nx", 1), Format::Medit);
    assert!(wrong.starts_with("has `x` in line 9; expected a coordinate"), "{wrong}");
}
