//! Cells and groups of Gmsh.

use super::{STRAIGHT, bytes_of, file, group, groups, refusal, volume, whole};
use localshape_mesh::Format;
use localshape_sim::Dimension;

#[test]
fn cells_and_groups_are_read_from_gmsh() {
    let mut points = Vec::new();
    for name in ["bar-2.2.msh", "bar-2.2-binary.msh", "bar-4.1.msh", "bar-4.1-binary.msh"] {
        let (bytes, format) = file(name);
        let found = volume(&bytes, format);
        assert_eq!((found.dimension, found.turned), (Dimension::Space, 0), "{name}");
        assert!(found.cells.iter().all(|cell| cell.len() == 4), "{name}");
        assert!((whole(&found) - 2.0).abs() < 1e-12, "{name}: {}", whole(&found));
        let names: Vec<&str> = found.groups.iter().map(|group| &*group.name).collect();
        assert_eq!(names, ["bar", "both ends", "left", "surface 9"], "{name}");
        // A box of 2 × 1 × 1 from the origin along x.
        let at = |group: usize| found.groups[group].points.iter().map(|&point| found.points[point as usize].x);
        assert_eq!(found.groups[0].points.len(), found.points.len(), "{name}");
        assert!(at(1).any(|x| x == 0.0) && at(1).any(|x| x == 2.0) && at(1).all(|x| x == 0.0 || x == 2.0), "{name}");
        assert!(at(2).all(|x| x == 0.0) && at(3).all(|x| x == 2.0), "{name}");
        points.push(found.points.len());
    }
    assert!(points.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn corners_of_second_order_elements_in_a_plane_are_read() {
    let (bytes, format) = file("sheet-4.1.msh");
    let found = volume(&bytes, format);
    assert_eq!((found.dimension, found.turned), (Dimension::Plane, 0));
    assert!(found.points.iter().all(|point| point.z == 0.0), "it lies at z = 3 in the file");
    assert!((whole(&found) - 2.0).abs() < 1e-12);
    assert_eq!(found.notes, STRAIGHT);
    assert_eq!(found.groups.iter().map(|group| &*group.name).collect::<Vec<_>>(), ["left edge", "sheet"]);
    assert!(found.groups[0].points.iter().all(|&point| found.points[point as usize].x == 0.0));
}

#[test]
fn groups_of_partitioned_gmsh_files_are_those_of_all_partitions() {
    let found = volume(bytes_of("partitioned-4.1.msh"), Format::Gmsh);
    assert_eq!((found.cells.len(), groups(&found)), (6, vec![("clamped side", 4), ("soft part", 8)]));
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    // As Gmsh has written it.
    let found = volume(bytes_of("partitioned-4.1-binary.msh"), Format::Gmsh);
    assert_eq!((found.cells.len(), groups(&found)), (18, vec![("clamped side", 4), ("soft part", 12)]));
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    assert!(group(&found, "clamped side").iter().all(|at| at[0] == 0.0));
}

#[test]
fn comments_of_gmsh_stand_before_and_between_sections() {
    let text = String::from_utf8(bytes_of("comments-2.2.msh")).expect("text");
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
    let text = String::from_utf8(bytes_of("partitioned-4.1.msh")).expect("text");
    let turned = text.replace("0 0 0 0 1 3 1 7 0", "0 0 0 0 1 3 1 -7 0");
    assert_ne!(text, turned);
    assert_eq!(groups(&volume(turned, Format::Gmsh)), [("clamped side", 4), ("soft part", 8)]);
    let old = String::from_utf8(bytes_of("comments-2.2.msh")).expect("text");
    assert!(old.contains("2 2 4 2 1 1 1 1 5 7\n3 2 4 -2 1 1 1 1 7 3"), "one triangle of either sign");
    assert_eq!(groups(&volume(old, Format::Gmsh))[1], ("ü", 4));
}

/// Faces at the surface of the solids name parts of it, and are left out without a word.
#[test]
fn faces_and_lines_apart_from_the_solids_are_told() {
    let text = |more: &str, count: usize| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 8 \"rod\"\n2 9 \"sheet\"\n3 1 \"vol\"\n$EndPhysicalNames\n\
             $Nodes\n7\n1 0 0 0\n2 2 0 0\n3 0 1 0\n4 0 0 3\n5 5 0 0\n6 6 0 0\n7 5 1 0\n$EndNodes\n$Elements\n{count}\n\
             1 4 2 1 1 1 2 3 4\n{more}$EndElements\n"
        )
    };
    let beside = "has lines and faces beside its solids, which are left out";
    let lost = "has groups whose points are all left out";
    for (more, count, names, notes) in [
        ("2 2 2 9 9 1 2 3\n3 1 2 8 8 1 4\n", 3, vec![("rod", 2), ("sheet", 3), ("vol", 4)], vec![]),
        (
            "2 2 2 9 9 5 6 7\n",
            2,
            vec![("sheet", 0), ("vol", 4)],
            vec![format!("{beside}: 1"), format!("{lost}: `sheet`")],
        ),
        ("2 2 2 9 9 1 6 7\n", 2, vec![("sheet", 1), ("vol", 4)], vec![format!("{beside}: 1")]),
        (
            "2 2 2 9 9 5 6 7\n3 1 2 8 8 5 6\n4 15 2 8 8 5\n",
            4,
            vec![("point 8", 0), ("rod", 0), ("sheet", 0), ("vol", 4)],
            vec![format!("{beside}: 2"), format!("{lost}: `point 8`, `rod`, `sheet`")],
        ),
    ] {
        let found = volume(text(more, count), Format::Gmsh);
        assert_eq!((groups(&found), &found.notes), (names, &notes), "{more}");
        assert!((whole(&found) - 1.0).abs() < 1e-12);
    }
    // Lines beside faces in the plane.
    let plane = text("2 1 2 8 8 5 6\n", 2).replace("1 4 2 1 1 1 2 3 4", "1 2 2 9 9 1 2 3");
    let found = volume(plane, Format::Gmsh);
    assert_eq!(found.notes, ["has lines beside its faces, which are left out: 1".to_owned(), format!("{lost}: `rod`")]);
}

#[test]
fn numbers_of_gmsh_nodes_at_two_places_are_refused() {
    let old = |again: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 2 0 0\n3 0 1 0\n4 0 0 3\n{again}\n$EndNodes\n\
             $Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
        )
    };
    let new = |again: &str| {
        let (tag, place) = again.split_once(' ').expect("a number and coordinates");
        format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 4\n3 1 0 5\n1\n2\n3\n4\n{tag}\n0 0 0\n2 0 0\n0 1 0\n0 0 3\n{place}\n\
             $EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"
        )
    };
    for (text, line) in [(old("2 2 0 9"), 10), (new("2 2 0 9"), 16)] {
        let found = refusal(&text, Format::Gmsh);
        let expected = format!("has node 2 again in line {line}, at another place; expected each number once (");
        assert!(found.starts_with(&expected), "{text}: {found}");
    }
    for text in [old("2 2 0 0"), new("2 2 0 0")] {
        let found = volume(text, Format::Gmsh);
        assert_eq!((found.cells.len(), found.points.len(), whole(&found)), (1, 4, 1.0));
    }
}
