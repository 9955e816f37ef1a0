//! Cells and sets of Abaqus.

use super::{LIMITS, STRAIGHT, bytes_of, check_kinds, group, groups, refusal, volume, whole};
use localshape_mesh::{Format, Limits, read_cells};

#[test]
fn cells_and_sets_are_read_from_abaqus() {
    let found = volume(bytes_of("kinds.inp"), Format::Abaqus);
    check_kinds(&found);
    let notes = [
        "has elements that are not read: 2 of the type SPRINGA",
        "has lines and faces beside its solids, which are left out: 1",
        STRAIGHT[0],
    ];
    assert_eq!(found.notes, notes);
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
        ("springs", 0),
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
    let dependent = String::from_utf8(bytes_of("assembly.inp")).expect("text");
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

/// A box of 2 × 1 × 3 as six tetrahedra.
const NODES: &str =
    "*NODE\n1, 0, 0, 0\n2, 2, 0, 0\n3, 2, 1, 0\n4, 0, 1, 0\n5, 0, 0, 3\n6, 2, 0, 3\n7, 2, 1, 3\n8, 0, 1, 3\n";
const CELLS: [&str; 6] =
    ["1, 1, 2, 3, 7", "2, 1, 3, 4, 7", "3, 1, 4, 8, 7", "4, 1, 8, 5, 7", "5, 1, 5, 6, 7", "6, 1, 6, 2, 7"];

/// Abaqus knows no lines that a backslash continues, and paths of folders end in one.
#[test]
fn lines_of_abaqus_that_end_in_a_backslash_are_whole() {
    let [one, other] = [&CELLS[..3], &CELLS[3..]].map(|cells| cells.join("\n"));
    for comment in ["** job folder: C:\\temp\\", "*HEADING\nC:\\temp\\", "*HEADING\n\\"] {
        let text = format!(
            "{NODES}*ELEMENT, TYPE=C3D4, ELSET=A\n{one}\n{comment}\n*ELEMENT, TYPE=C3D4, ELSET=B\n{other}\n{comment}\n\
             *NSET, NSET=C\n1, 2, 8\n"
        );
        let found = volume(text, Format::Abaqus);
        assert_eq!((found.cells.len(), groups(&found)), (6, vec![("A", 6), ("B", 6), ("C", 3)]), "{comment}");
        assert!((whole(&found) - 6.0).abs() < 1e-12, "{comment}");
    }
    let found = refusal(format!("{NODES}*NSET, NSET=C\n1, \\\n2\n"), Format::Abaqus);
    assert!(found.starts_with("names the set `\\\\` in line 11, which it does not have before"), "{found}");
}

#[test]
fn a_comma_behind_the_last_parameter_of_abaqus_takes_no_data() {
    let cells = CELLS.join("\n");
    let text = format!(
        "*NODE,\n{}*ELEMENT, TYPE=C3D4, ELSET=all,\n{cells}\n*NSET, NSET=fix,\n1, 2, 3\n4, 5\n*NSET, NSET=more,\n\
         ** of another\nfix\n6,\n*ELSET, ELSET=some,\n1, 2\n",
        &NODES[6..]
    );
    let found = volume(text, Format::Abaqus);
    assert_eq!(found.cells.len(), 6);
    assert!((whole(&found) - 6.0).abs() < 1e-12);
    assert_eq!(groups(&found), [("all", 8), ("fix", 5), ("more", 6), ("some", 5)]);
    // Parameters in further lines.
    let text = format!(
        "{NODES}*ELEMENT,\nTYPE=C3D4,\n  ELSET=all\n{cells}\n*NSET, NSET=rows,\nGENERATE\n1, 7, 2\n*NSET,\n** a\nNSET=few, generate,\n\
         1, 3,\n"
    );
    let found = volume(text, Format::Abaqus);
    assert_eq!((found.cells.len(), groups(&found)), (6, vec![("all", 8), ("few", 3), ("rows", 4)]));
}

#[test]
fn numbers_of_abaqus_with_two_meanings_are_refused() {
    let text = format!("{NODES}*ELEMENT, TYPE=C3D4, ELSET=all\n{}\n", CELLS.join("\n"));
    let remedy = "(remove one of the two, or give each";
    let found = refusal(format!("{text}*NODE\n7, 2, 1, 9\n"), Format::Abaqus);
    let expected = "has node 7 again in line 18, at another place; expected each number once";
    assert_eq!(found, format!("{expected} {remedy} node a number of its own)"));
    let found = refusal(format!("{text}*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 6\n"), Format::Abaqus);
    let expected = "has element 1 again in line 18; expected each number once";
    assert_eq!(found, format!("{expected} {remedy} element a number of its own)"));
    let found = refusal(format!("{text}*ELEMENT, TYPE=S4\n2, 1, 3, 4, 7\n"), Format::Abaqus);
    assert!(found.starts_with("has element 2 again in line 18"), "{found}");
    // The same again: cells before and behind it have the one node.
    let again =
        "*NODE, NSET=two\n7, 2, 1, 3\n2, 2, 0, 0\n*ELEMENT, TYPE=C3D4, ELSET=one\n1, 1, 2, 3, 7\n8, 2, 3, 7, 9\n";
    let found = volume(text.replace("*ELEMENT", "9, 4, 0, 0\n*ELEMENT") + again, Format::Abaqus);
    assert_eq!((found.cells.len(), found.points.len(), whole(&found)), (7, 9, 7.0));
    assert_eq!(groups(&found), [("all", 8), ("one", 5), ("two", 2)]);
}
