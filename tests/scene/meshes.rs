//! Bodies of mesh files.

use localshape::scene::{Limits, Scene, SceneError};

const SCENE: &str = "\
[time]
duration = 1
[body]
mesh = 'body.ply'
density = 1000.0
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
";

/// Reads a scene with files beside it.
fn load(scene: &str, files: &[(&str, &[u8])]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    files.iter().for_each(|(name, bytes)| put(name, bytes));
    put("scene.toml", scene.as_bytes());
    Scene::load(&folder.path().join("scene.toml"), &Limits::default())
}

/// Expects a mistake with these parts in its message and help.
fn wrong(scene: &str, files: &[(&str, &[u8])], parts: &[&str]) {
    let error = load(scene, files).unwrap_err();
    let has_parts = |text: &str| parts.iter().all(|part| text.contains(part));
    let texts =
        error.mistakes().iter().map(|one| format!("{} {}", one.message, one.help.as_deref().unwrap_or_default()));
    assert!(texts.into_iter().any(|text| has_parts(&text)), "{error}\nexpected {parts:?}");
}

/// A bar of one metre that is thinner than its tetrahedra, of a twentieth of a metre, has one node at its end.
#[test]
fn sides_on_one_line_are_told() {
    let warnings = |wide: f64, with: &str| {
        let corner =
            |bits: usize| [1.0, wide, wide].into_iter().enumerate().map(move |(at, x)| x * (bits >> at & 1) as f64);
        let corners = (0..8).map(|bits| corner(bits).fold("v".to_owned(), |line, x| format!("{line} {x}")) + "\n");
        let faces = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        let bar = corners.collect::<String>() + faces;
        let scene = SCENE.replace("ply'", &format!("obj'\nfill = {{ with = '{with}', side = 0.05 }}"));
        let scene = load(&format!("{scene}[[hold]]\nnodes = 'left'\n"), &[("body.obj", bar.as_bytes())]).unwrap();
        let told = scene.warnings.iter().filter(|one| one.message.contains("on one line"));
        told.map(|one| one.message.clone()).collect::<Vec<_>>()
    };
    let told = ["`hold[0]` takes 1 node of the body, on one line, about which it turns"];
    assert_eq!(warnings(0.048, "tetrahedra"), told);
    assert!(warnings(0.06, "tetrahedra").is_empty() && warnings(0.048, "cubes").is_empty());
}

#[test]
fn files_that_are_no_meshes_are_named() {
    wrong(SCENE, &[("bodi.ply", b"")], &["`body.ply` is not there", "did you mean \"bodi.ply\"?"]);
    let named = |name: &str| SCENE.replace("body.ply", name);
    wrong(&named("body.npz"), &[("body.npz", b"PK")], &["`body.npz` is a NumPy archive", "`file` in place of `mesh`"]);
    wrong(&named("body.fbx"), &[("body.fbx", b"")], &["`body.fbx` is a .fbx file", ".obj, .stl", "Blender"]);
    wrong(&named("body.stp"), &[("body.stp", b"")], &["`body.stp` is a .stp file", "gmsh -3 FILE -o NEW.msh"]);
    let file = SCENE.replace("mesh = 'body.ply'", "file = 'body.step'");
    wrong(&file, &[("body.step", b"")], &["is a mesh (.step), which is not read", "gmsh -3 FILE -o NEW.msh"]);
    wrong(&named("body.stll"), &[("body.stll", b"")], &["is a .stll file", "did you mean .stl?"]);
    let series = load(&named("body.vtm"), &[("body.vtm", b"")]).unwrap_err().to_string();
    assert!(series.contains("is a .vtm file") && !series.contains("did you mean"), "{series}");
    // The content says more than an ending that says nothing.
    for name in ["body", "body.k", "body.step"] {
        wrong(&named(name), &[(name, CUBE.as_bytes())], &["by its content it is a .obj file: name it so"]);
    }
    wrong(&named("body.k"), &[("body.k", b"*KEYWORD")], &["is a .k file", "write it as an Abaqus (`.inp`)"]);
    let pieces = b"<VTKFile type='PUnstructuredGrid'>";
    wrong(&named("body.pvtu"), &[("body.pvtu", pieces)], &["is a .pvtu file", "open it in ParaView"]);
    for name in ["body.pvd", "body.vtu.series"] {
        wrong(&named(name), &[(name, b"{}")], &["is a list of moments", "write it as `states` of a run"]);
    }
    wrong(&named("body"), &[("body", b"")], &["`body` has no ending; expected a mesh: .obj, .stl, .ply"]);
    wrong(&named("."), &[], &["`.` is a folder; expected a mesh"]);
}

#[test]
fn keys_of_meshes_belong_to_meshes() {
    let lattice = SCENE.replace("mesh = 'body.ply'", "lattice = { cells = [1, 1, 1], side = 1 }\nKEY");
    for (key, message) in [
        ("fill = {}", "`body.fill` needs `mesh`"),
        ("scale = 0.001", "`body.scale` needs `mesh`"),
        ("up = 'z'", "`body.up` needs `mesh`"),
        ("weld = 1e-6", "`body.weld` needs `mesh`"),
        ("mesh = 'body.ply'", "has both `lattice` and `mesh`"),
    ] {
        wrong(&lattice.replace("KEY", key), &[], &[message]);
    }
    let fill = |fill: &str| SCENE.replace("density", &format!("fill = {{ {fill} }}\ndensity"));
    wrong(&fill("side = 0.1, cells = 3"), &[], &["`body.fill` has both `side` and `cells`"]);
    wrong(&fill("with = 'cube'"), &[], &["`body.fill.with` is \"cube\"", "did you mean \"cubes\"?"]);
    wrong(&fill("side = 0"), &[], &["`body.fill.side` is 0; expected a number greater than 0"]);
    wrong(&SCENE.replace("density", "weld = 0\ndensity"), &[], &["`body.weld` is 0; expected a number greater than 0"]);
    wrong(&SCENE.replace("density", "scale = 'mm'\ndensity"), &[], &["`body.scale` is the string \"mm\"", "0.001"]);
}

/// A cube with a side of 1, as eight points and six quadrilaterals.
const CUBE: &str = "\
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6
";

/// A hexahedron with a group of four nodes at x = 0.
const BRICK: &str = "\
$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n2\n2 1 \"clamped\"\n3 2 \"brick\"\n$EndPhysicalNames
$Nodes\n8\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n5 0 0 1\n6 2 0 1\n7 2 1 1\n8 0 1 1\n$EndNodes
$Elements\n2\n1 3 2 1 1 1 4 8 5\n2 5 2 2 1 1 2 3 4 5 6 7 8\n$EndElements
";

fn loaded(scene: &str, files: &[(&str, &str)]) -> Scene {
    let files: Vec<_> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    load(scene, &files).unwrap_or_else(|error| panic!("{error}"))
}

/// The scene with a file and other lines in its body.
fn with(name: &str, lines: &str) -> String {
    SCENE.replace("mesh = 'body.ply'", &format!("mesh = '{name}'\n{lines}"))
}

#[test]
fn a_surface_is_filled_and_carried() {
    let cube = [("cube.obj", CUBE)];
    let scene = loaded(&with("cube.obj", "fill.cells = 2"), &cube);
    let body = &scene.bodies[0].body;
    assert_eq!((body.len(), body.elements().len(), &body.fill()), (27, 8, &None));
    assert!((body.mass().iter().sum::<f64>() - 1000.0).abs() < 1e-9);
    let carried = body.carried().unwrap();
    assert_eq!(carried.positions(body.rest()).len(), carried.rest.len());
    assert_eq!(scene.warnings, []);
    // By default some 20 cells lie along the longest side.
    let elements = |lines: &str| loaded(&with("cube.obj", lines), &cube).bodies[0].body.elements().len();
    assert_eq!(elements(""), 8000);
    assert_eq!(elements("fill.side = 0.5"), 8);
    assert_eq!(elements("scale = 0.001\nfill.side = 0.0005"), 8);
    // A cube that is cut has a part of the mass of all cubes, in proportion to its filling.
    let scene = loaded(&with("cube.obj", "fill.side = 0.4"), &cube);
    let body = &scene.bodies[0].body;
    assert!((body.mass().iter().sum::<f64>() - 1000.0).abs() < 1e-9);
    assert_eq!(body.fill().map(<[f64]>::len), Some(27));
}

#[test]
fn a_mesh_is_put_upright_in_metres() {
    let tall = CUBE.replace("v 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1", "v 0 0 3\nv 1 0 3\nv 0 1 3\nv 1 1 3");
    let extent = |lines: &str| {
        let scene = loaded(&with("tall.obj", &format!("{lines}\nfill.cells = 3")), &[("tall.obj", &tall)]);
        scene.summary().bodies[0].extent.clone()
    };
    assert_eq!(extent(""), [1.0, 1.0, 3.0]);
    assert_eq!(extent("up = 'z'"), [1.0, 3.0, 1.0]);
    assert_eq!(extent("up = 'z'\nscale = 0.5"), [0.5, 1.5, 0.5]);
    // A file in millimetres is as long as a house.
    let large = CUBE.replace('1', "150");
    let large = large.lines().filter(|line| line.starts_with('v')).collect::<Vec<_>>().join("\n")
        + &CUBE[CUBE.find("\nf").unwrap()..];
    let stiff = |lines: &str| with("large.obj", lines).replace("1e4", "1e12");
    let warnings = |lines: &str| loaded(&stiff(lines), &[("large.obj", &large)]).warnings;
    assert!(warnings("fill.cells = 2")[0].message.contains("`large.obj` is 150 m long, as no `scale` is given"));
    assert_eq!(warnings("fill.cells = 2\nscale = 1"), []);
}

#[test]
fn cells_become_elements_and_groups_are_named() {
    let held = |nodes: &str| {
        let scene = with("brick.msh", "") + &format!("[[hold]]\nnodes = '{nodes}'\n");
        let scene = loaded(&scene, &[("brick.msh", BRICK)]);
        let body = &scene.bodies[0].body;
        assert_eq!((body.len(), body.elements().len(), body.mass().iter().sum::<f64>()), (8, 1, 2000.0));
        assert!(body.carried().is_none() && body.fill().is_none());
        let grips = &scene.runs[0].grips;
        let mut at: Vec<_> = grips[0].nodes.iter().map(|&node| body.rest()[node as usize].x).collect();
        at.dedup();
        (grips[0].nodes.len(), at)
    };
    assert_eq!(held("clamped"), (4, vec![0.0]));
    assert_eq!(held("right"), (4, vec![2.0]));
    assert_eq!(held("brick").0, 8);
    let scene = with("brick.msh", "") + "[[hold]]\nnodes = 'clampd'\n";
    let expected = ["\"back\", or a group of the mesh: \"brick\" or \"clamped\"", "did you mean \"clamped\"?"];
    wrong(&scene, &[("brick.msh", BRICK.as_bytes())], &expected);
    wrong(&with("brick.msh", "fill = {}"), &[("brick.msh", BRICK.as_bytes())], &["is about surfaces", "has cells"]);
}

/// A group comes before a side of the same name, in its own body only.
#[test]
fn a_group_with_the_name_of_a_side_leaves_the_sides_of_other_bodies() {
    let block = |lines: &str| {
        let other = "[[body]]\nname = 'block'\nlattice = { cells = [1, 1, 1], side = 1 }\noffset = [9, 0, 0]\n[[run]]";
        with("brick.msh", lines).replace("[body]", "[[body]]\nname = 'brick'").replace("[[run]]", other)
            + "[[hold]]\nnodes = 'right'\n"
    };
    let brick = BRICK.replace("clamped", "right");
    let scene = loaded(&block(""), &[("brick.msh", &brick)]);
    let held: Vec<_> = scene.runs[0].grips.iter().map(|grip| grip.nodes.clone()).collect();
    // The group lies on the left side of the brick, the block has no group.
    assert_eq!(held, [vec![0, 3, 4, 7], vec![9, 11, 13, 15]]);
}

#[test]
fn groups_of_a_filled_surface_are_the_nodes_that_carry_them() {
    let surface = "\
$MeshFormat\n2.2 0 8\n$EndMeshFormat
$PhysicalNames\n1\n2 1 \"foot\"\n$EndPhysicalNames
$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes
$Elements\n4\n1 2 2 1 1 1 3 2\n2 2 2 0 1 1 2 4\n3 2 2 0 1 1 4 3\n4 2 2 0 1 2 3 4\n$EndElements
";
    for with_ in ["cubes", "graded", "tetrahedra", "polyhedra"] {
        let scene = |nodes: &str| {
            let fill = format!("fill = {{ with = '{with_}', side = 0.25 }}");
            with("foot.msh", &fill) + &format!("[[hold]]\nnodes = '{nodes}'\n")
        };
        let held = |nodes: &str| {
            let scene = loaded(&scene(nodes), &[("foot.msh", surface)]);
            let body = scene.bodies[0].body.clone();
            scene.runs[0].grips[0].nodes.iter().map(|&node| body.rest()[node as usize]).collect::<Vec<_>>()
        };
        // The face at z = 0 is all of the group, with the points between its corners: 15 of them, at distances of a quarter.
        let foot = held("foot");
        assert!(foot.len() >= 15, "{with_}: {foot:?}");
        // Lattices have nodes in the face; the nodes of cut elements around it are less than a side away.
        let far = if ["cubes", "graded"].contains(&with_) { 1e-9 } else { 0.25 };
        assert!(foot.iter().all(|at| at.z.abs() < far), "{with_}: {foot:?}");
        let expected = ["or a group of the mesh: \"foot\"", "did you mean \"foot\"?"];
        wrong(&scene("foo"), &[("foot.msh", surface.as_bytes())], &expected);
    }
}

#[test]
fn a_filled_body_needs_its_density_or_its_whole_mass() {
    let cube: &[(&str, &[u8])] = &[("cube.obj", CUBE.as_bytes())];
    let scene = with("cube.obj", "fill.cells = 2").replace("density = 1000.0", "KEY");
    wrong(&scene.replace("KEY", ""), cube, &["neither `density` nor `mass_total`", "such as density = 1000"]);
    wrong(&scene.replace("KEY", "mass = 1"), cube, &["`body.mass` is that of every node", "`density`"]);
    // One mistake is one error.
    let errors = |scene: &str| load(scene, cube).unwrap_err().mistakes().len();
    assert_eq!(errors(&scene.replace("KEY", "density = '1000'")), 1);
    let floor = "[[obstacle]]\nkind = 'floor'\n";
    assert_eq!(errors(&(scene.replace("KEY", "density = 1000\noffset = [0, -1, 0]") + floor)), 1);
    assert_eq!(errors(&(scene.replace("KEY", "density = 1000\noffset = [0, -1, 0]\nlowest = '2'") + floor)), 1);
    // Far too many elements are refused with what to do.
    let many = |fill: &str| with("cube.obj", fill);
    let expected = [
        "needs about 1e9 elements of side 0.001, and at most 8.2 million are allowed",
        "use cells = ",
        "--allow-large",
    ];
    wrong(&many("fill = { cells = 1000 }"), cube, &expected);
    wrong(&many("fill = { with = 'tetrahedra', cells = 150 }"), cube, &["needs about 40 million", "use cells = "]);
    wrong(&many("fill = { side = 0.001 }"), cube, &["use side = 0.0051 or more, or allow more with --allow-large"]);
    let whole = loaded(&scene.replace("KEY", "mass_total = 3"), &[("cube.obj", CUBE)]);
    assert!((whole.bodies[0].body.mass().iter().sum::<f64>() - 3.0).abs() < 1e-12);
}

#[test]
fn flaws_are_told_with_their_number() {
    let warned = |mesh: &str| {
        let scene = loaded(&with("body.obj", "fill.cells = 8"), &[("body.obj", mesh)]);
        scene.warnings.iter().map(|one| one.message.clone()).collect::<Vec<_>>().join("\n")
    };
    let turned = CUBE.replace("f 1 3 4 2", "f 2 4 3 1");
    assert_eq!(warned(&turned), "`body.obj` is mended: 2 triangles turned over");
    let doubled = format!("{CUBE}f 1 3 4 2\n");
    assert_eq!(warned(&doubled), "`body.obj` is mended: 2 doubled triangles left out");
    let open = CUBE.replace("f 2 4 8 6\n", "");
    let message = "`body.obj` has 4 open edges, and is filled where its triangles enclose most";
    assert_eq!(warned(&open), message);
    let two = two_cubes([3.0; 3]);
    assert_eq!(warned(&two), "`body.obj` makes 2 parts that share no node, so nothing holds them together");
    let crossing = two_cubes([0.5, 0.25, 0.0]);
    let message =
        "`body.obj` has shells that cross or lie in each other: 18.75 % of their volume is in several, and counts once";
    assert_eq!(warned(&crossing), message);
    // Cubes that touch in an edge, whose two points they share.
    let touching = two_cubes([1.0, 1.0, 0.0]);
    let message = "`body.obj` has 1 edge of three triangles or more, where parts may be joined or not";
    assert!(warned(&touching).starts_with(message), "{}", warned(&touching));
    let plate = CUBE.replace(" 1\n", " 0.03\n").replace(" 1\nf", " 0.03\nf");
    let message = "`body.obj` is thinner than its elements in 64 of 64 cells, and does not bend there as it would";
    for fill in ["cubes", "graded", "tetrahedra", "polyhedra"] {
        let scene = with("body.obj", &format!("fill = {{ with = '{fill}', cells = 8 }}"));
        let scene = loaded(&scene, &[("body.obj", &plate)]);
        assert!(scene.warnings.iter().any(|one| one.message == message), "{fill}: {:?}", scene.warnings);
    }
    let help = |lines: &str| {
        let scene = loaded(&with("body.obj", lines), &[("body.obj", &plate)]);
        scene.warnings[0].help.clone().unwrap()
    };
    assert_eq!(help("fill.cells = 8"), "use cells = 67 or more, or make it thicker");
    assert_eq!(help("fill.side = 0.125"), "use side = 0.015 or less, or make it thicker");
    assert_eq!(loaded(&with("body.obj", "fill.cells = 67"), &[("body.obj", &plate)]).warnings.len(), 0);
}

/// Two unit cubes, the second one moved.
fn two_cubes(by: [f64; 3]) -> String {
    let points = CUBE.lines().filter(|line| line.starts_with('v'));
    let moved = points.map(|line| {
        let at: Vec<f64> = line.split(' ').skip(1).map(|at| at.parse().unwrap()).collect();
        format!("v {} {} {}\n", at[0] + by[0], at[1] + by[1], at[2] + by[2])
    });
    let faces = "f 9 11 12 10\nf 13 14 16 15\nf 9 10 14 13\nf 11 15 16 12\nf 9 13 15 11\nf 10 12 16 14\n";
    format!("{CUBE}{}{faces}", moved.collect::<String>())
}

/// Each piece has its own mass, and shells that cross have that of what they enclose together.
#[test]
fn pieces_have_their_own_mass_and_shells_that_cross_that_of_their_union() {
    for fill in ["cubes", "graded"] {
        let masses = |mesh: &str, cells: u32| {
            let fill = format!("fill = {{ with = '{fill}', cells = {cells} }}");
            let scene = loaded(&with("body.obj", &fill), &[("body.obj", mesh)]);
            let body = &scene.bodies[0].body;
            // The first cube carries the first points of the surface.
            let mut masses = [0.0; 2];
            let first = body.elements().iter().flat_map(|nodes| nodes.iter().map(|&node| [nodes[0], node]));
            let mut leads: Vec<u32> = (0..body.len() as u32).collect();
            for _ in 0..64 {
                for [one, other] in first.clone() {
                    let least = leads[one as usize].min(leads[other as usize]);
                    (leads[one as usize], leads[other as usize]) = (least, least);
                }
            }
            leads.iter().zip(body.mass()).for_each(|(&lead, &mass)| masses[usize::from(lead > 0)] += mass);
            masses
        };
        // At a distance of a quarter of a cell.
        for mass in masses(&two_cubes([1.1, 0.0, 0.0]), 5) {
            assert!((mass - 1000.0).abs() < 0.01, "{fill}: {mass}");
        }
        for cells in [3, 8] {
            let sum: f64 = masses(&two_cubes([0.5, 0.25, 0.0]), cells).iter().sum();
            assert!((sum - 1625.0).abs() < 0.01, "{fill}: {sum}");
        }
    }
}

#[test]
fn the_digest_is_of_the_content_of_a_mesh() {
    let digest = |name: &str, lines: &str, mesh: &str| loaded(&with(name, lines), &[(name, mesh)]).digest;
    let cube = digest("cube.obj", "", CUBE);
    assert_eq!(cube.len(), 64);
    let defaults = "fill = { with = 'cubes', cells = 20 }\nscale = 1\nup = 'y'";
    assert_eq!(digest("other.obj", defaults, CUBE), cube);
    assert_ne!(digest("cube.obj", "fill.cells = 21", CUBE), cube);
    assert_ne!(digest("cube.obj", "", &format!("{CUBE}# a comment\n")), cube);
}

/// A file of the crate of meshes.
fn field(name: &str) -> Vec<u8> {
    std::fs::read(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("mesh/tests/files").join(name)).unwrap()
}

fn messages(scene: &Scene) -> String {
    scene.warnings.iter().map(|one| format!("{} {}\n", one.message, one.help.as_deref().unwrap_or_default())).collect()
}

#[test]
fn backslashes_in_paths_are_told_everywhere() {
    let expected = ["is not there", "write / between folders, not \\"];
    for scene in [
        with("a\\b.obj", ""),
        SCENE.replace("mesh = 'body.ply'", "file = 'a\\b.npz'"),
        "view.font.regular = 'a\\b.otf'\n".to_owned() + &with("cube.obj", ""),
        with("cube.obj", "").replace("model = { kind = 'shape-based', stiffness = 1e4 }", "states = 'a\\b.npz'"),
        with("cube.obj", "").replace("model = { kind = 'shape-based', stiffness = 1e4 }", "states = 'a\\b.pvd'"),
    ] {
        wrong(&scene, &[("cube.obj", CUBE.as_bytes())], &expected);
    }
    let stars =
        with("cube.obj", "").replace("model = { kind = 'shape-based', stiffness = 1e4 }", "states = 'a\\b*.obj'");
    wrong(&stars, &[("cube.obj", CUBE.as_bytes())], &["names no file", "write / between folders"]);
    let missing = Scene::load(std::path::Path::new("a\\b.toml"), &Limits::default()).unwrap_err().to_string();
    assert!(missing.contains("write / between folders"), "{missing}");
}

#[test]
fn points_are_welded_within_a_distance_in_metres() {
    let files = [
        ("a.stl", &field("last-digits.stl")[..]),
        ("b.stl", &field("small-zeros.stl")),
        ("c.vtu", &field("discontinuous.vtu")),
    ];
    let scene = |lines: &str, name: &str| load(&with(name, lines), &files).unwrap();
    let open = messages(&scene("fill.cells = 6", "a.stl"));
    assert!(
        open.contains("36 open edges") && open.contains("write weld = 1e-6 (m), or close it in the program"),
        "{open}"
    );
    let welded = "`a.stl` is mended: 28 points welded, nearer than weld = 1e-6 m to others \n";
    assert_eq!(messages(&scene("fill.cells = 6\nweld = 1e-6", "a.stl")), welded);
    // In metres after the scale.
    let small = scene("fill.cells = 6\nscale = 0.001\nweld = 1e-9", "a.stl");
    assert!(messages(&small).starts_with("`a.stl` is mended: 28 points welded, nearer than weld = 1e-9 m to others"));
    assert!(messages(&scene("fill.cells = 6\nscale = 0.001\nweld = 1e-11", "a.stl")).contains("36 open edges"));
    let zeros = messages(&scene("fill.cells = 6", "b.stl"));
    assert!(
        zeros.starts_with("`b.stl` is mended: ") && zeros.contains(" points welded that only round-off sets apart"),
        "{zeros}"
    );
    // Cells are joined on request, which the warning tells.
    let apart = scene("", "c.vtu");
    assert_eq!(apart.bodies[0].body.len(), 24);
    assert!(
        messages(&apart).contains("makes 6 parts that share no node")
            && messages(&apart).contains("write weld = 1e-10 (m)")
    );
    let joined = scene("weld = 1e-10", "c.vtu");
    assert_eq!((joined.bodies[0].body.len(), joined.bodies[0].body.elements().len()), (8, 6));
    assert_eq!(messages(&joined), "`c.vtu` is mended: 16 points welded, nearer than weld = 1e-10 m to others \n");
    assert_ne!(apart.digest, joined.digest);
}

#[test]
fn groups_of_obj_files_are_named() {
    let files = [("a.obj", &field("groups.obj")[..])];
    let held = |nodes: &str| {
        let scene = with("a.obj", "fill.cells = 6") + &format!("[[hold]]\nnodes = '{nodes}'\n");
        let scene = load(&scene, &files).unwrap();
        let body = &scene.bodies[0].body;
        scene.runs[0].grips[0].nodes.iter().map(|&node| body.rest()[node as usize].y).collect::<Vec<_>>()
    };
    // A box of 2 × 1 × 3 m with cubes of half a metre.
    assert_eq!(held("cap"), [1.0; 35]);
    assert_eq!(held("red"), held("cap"));
    let wrong_name = with("a.obj", "") + "[[hold]]\nnodes = 'cup'\n";
    wrong(&wrong_name, &files, &["or a group of the mesh: \"cap\", \"red\" or \"rest\"", "did you mean \"cap\"?"]);
}

#[test]
fn points_without_coordinates_are_told() {
    for name in ["unknown-point.obj", "unknown-point.ply", "unknown-point-binary.ply"] {
        let scene = load(&with(name, "fill.cells = 6"), &[(name, &field(name))]).unwrap();
        assert_eq!(messages(&scene), format!("`{name}` has a point without coordinates, which is left out \n"));
        assert!((scene.bodies[0].body.mass().iter().sum::<f64>() - 6000.0).abs() < 1e-9);
    }
}

#[test]
fn data_of_a_gltf_file_is_beside_it() {
    let gltf = "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": 0}], \"meshes\": [{\"primitives\": [{\"attributes\": \
        {\"POSITION\": 0}, \"indices\": 1}]}], \"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}, \
        {\"bufferView\": 1, \"componentType\": 5121, \"count\": 12, \"type\": \"SCALAR\"}], \"bufferViews\": [{\"buffer\": 0, \"byteLength\": 48}, \
        {\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 12}], \"buffers\": [{\"byteLength\": 60, \"uri\": \"my%20box.bin\"}]}";
    let data = |height: f32| {
        let corners = [[0.0f32; 3], [1.0, 0.0, 0.0], [0.0, height, 0.0], [0.0, 0.0, 1.0]];
        let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes.extend([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);
        bytes
    };
    let scene = with("a.gltf", "fill.cells = 6");
    let read = |height: f32| load(&scene, &[("a.gltf", gltf.as_bytes()), ("my box.bin", &data(height))]).unwrap();
    let (low, high) = (read(1.0), read(3.0));
    let mass = |scene: &Scene| scene.bodies[0].body.mass().iter().sum::<f64>();
    assert!((mass(&low) - 1000.0 / 6.0).abs() < 1e-9 && (mass(&high) - 500.0).abs() < 1e-9);
    assert_ne!(low.digest, high.digest, "the data is a part of the scene");
    let mut only = vec![("a.gltf", gltf.as_bytes())];
    wrong(&scene, &only, &["`a.gltf` has its data in `my box.bin`, which is not there (looked for "]);
    only.push(("my bo.bin", b""));
    wrong(&scene, &only, &["is not there", "did you mean \"my bo.bin\"?"]);
    let outside = gltf.replace("my%20box.bin", "../scene.toml");
    wrong(&scene, &[("a.gltf", outside.as_bytes())], &["outside of its folder", "beside it"]);
}

#[test]
fn what_is_left_out_of_cells_is_told() {
    let flat = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n\
                0 0 0 1 0 0 0 1 0 0 0 1 1 1 0\nCELLS 2 10\n4 0 1 2 3\n4 0 1 4 2\nCELL_TYPES 2\n10 10\n";
    let scene = loaded(&with("flat.vtk", ""), &[("flat.vtk", flat)]);
    let expected = "`flat.vtk` has a cell without volume, which is left out: it has corners at [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0] \n";
    assert_eq!(messages(&scene), expected);
    assert_eq!((scene.bodies[0].body.len(), scene.bodies[0].body.elements().len()), (4, 1));
    let scene = load(&with("kinds.inp", ""), &[("kinds.inp", &field("kinds.inp"))]).unwrap();
    let notes = messages(&scene);
    assert!(notes.starts_with("`kinds.inp` has elements that are not read: 2 of the type SPRINGA \n"), "{notes}");
}

#[test]
fn sets_of_abaqus_and_references_of_medit_are_groups() {
    for (name, group, nodes) in [
        ("assembly.inp", "held", 3),
        ("assembly.inp", "far", 4),
        ("kinds.mesh", "volume 2", 14),
        ("kinds.mesh", "point 5", 1),
    ] {
        let text = with(name, "") + &format!("[[hold]]\nnodes = '{group}'\n");
        let scene = load(&text, &[(name, &field(name))]).unwrap();
        assert_eq!(scene.runs[0].grips[0].nodes.len(), nodes, "{name}: {group}");
    }
}
