//! `check`: the contents of scenes, and every mistake in them.

use crate::cli::support::{Place, SMALL, numpy};

#[test]
fn says_what_a_scene_holds() {
    let place = Place::with_small();
    let ran = place.run("check small.toml").good();
    for word in ["Two cubes", "Local shape", "Mass-spring", "12 nodes"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    assert_eq!(place.run("check small.toml --quiet").good().out, "");
    assert_eq!(place.names("."), ["small.toml"], "it writes nothing");
}

#[test]
fn finds_every_mistake_in_all_scenes() {
    let place = Place::with_small();
    place.write(
        "one.toml",
        &SMALL.replace("stiffness = 1e4", "stifness = 1e4").replace("friction = 0.3", "friction = -1"),
    );
    place.write("two.toml", &SMALL.replace("mass = 1.0", "mass = 0"));
    let ran = place.run("check one.toml small.toml two.toml absent.toml");
    assert_eq!(ran.status, Some(2), "{ran:?}");
    assert!(ran.out.contains("Two cubes"), "{}", ran.out);
    assert_eq!(ran.err.matches("`stifness`").count(), 2, "{}", ran.err);
    for word in ["one.toml:", "stiffness", "friction", "two.toml:", "mass", "absent.toml"] {
        assert!(ran.err.contains(word), "{word}: {}", ran.err);
    }
}

#[test]
fn as_json() {
    let place = Place::with_small();
    place.write("wrong.toml", &SMALL.replace("mass = 1.0", "mass = 0"));
    let ran = place.run("check small.toml wrong.toml --json");
    assert_eq!((ran.status, ran.err.as_str()), (Some(2), ""), "{ran:?}");
    let document = ran.json();
    assert_eq!(document["scenes"][0]["ok"], true);
    assert_eq!(document["scenes"][0]["scene"]["title"], "Two cubes");
    assert_eq!(document["scenes"][1]["ok"], false);
    assert!(document["scenes"][1]["mistakes"][0]["line"].as_u64().unwrap() > 1);
}

#[test]
fn says_where_the_body_starts() {
    let place = Place::with_small();
    let ran = place.run("check small.toml").good();
    assert!(ran.out.contains("\n  start     between (-0.1, 0, -0.05) and (0.1, 0.1, 0.05) m\n"), "{}", ran.out);
    let document = place.run("check small.toml --json").good().json();
    let start = &document["scenes"][0]["scene"]["bodies"][0]["start"];
    assert_eq!(start, &serde_json::json!([[-0.1, 0.0, -0.05], [0.1, 0.1, 0.05]]));
}

#[cfg(feature = "render")]
#[test]
fn says_that_a_body_leaves_its_panel() {
    let place = Place::with_small();
    place.write("beside.toml", &SMALL.replace("[view]", "[view]\ncamera.target = [2, 0, 0]"));
    let ran = place.run("check small.toml beside.toml");
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert_eq!(ran.err.matches("the body leaves its panel at the start").count(), 1, "{}", ran.err);
    assert!(ran.err.contains("beside.toml: `view.camera`: "), "{}", ran.err);
    assert_eq!(place.run("check beside.toml --quiet").good().err, "");
    let scenes = place.run("check small.toml beside.toml --json").good().json();
    let warnings = |at: usize| scenes["scenes"][at]["warnings"].as_array().map(Vec::len);
    assert_eq!([warnings(0), warnings(1)], [Some(0), Some(1)]);
}

/// Runs with the reference kernel are reported, and `kernel = "fast"` is refused if there are no vectorised steps.
#[test]
fn says_which_runs_take_the_plain_code() {
    let place = Place::with_small();
    assert!(!place.run("check small.toml").good().out.contains("reference"));
    let typed = |more: &str| SMALL.replacen("stiffness = 1e4", &format!("stiffness = 1e4{more}"), 1);
    for more in
        [", rotation = 'vector-length'", ", rotation = 'linear-update'", ", rotation = 'arctangent', bending = '1/3'"]
    {
        place.write("plain.toml", &typed(more));
        let ran = place.run("check plain.toml").good();
        assert_eq!(ran.out.matches(", kernel reference\n").count(), 1, "{}", ran.out);
        let document = place.run("check plain.toml --json").good().json();
        let runs = &document["scenes"][0]["scene"]["runs"];
        assert_eq!((&runs[0]["kernel"], &runs[1]["kernel"]), (&"reference".into(), &"fast".into()));
        place.write("plain.toml", &typed(more).replacen("[[run]]", "[[run]]\nkernel = 'fast'", 1));
        place
            .run("check plain.toml")
            .bad(2, &["`run[0].kernel`", "`model.rotation`", "no vectorised steps", "reference"]);
    }
}

/// A warning is reported by every command that runs the scene, and has no other effect.
#[test]
fn warns_of_what_is_probably_not_meant() {
    let place = Place::new();
    place.write("rare.toml", &SMALL.replace("frames_per_second = 60", "frames_per_second = 1e-300"));
    let words = "warning: rare.toml:7:21: at 1e-300 frames per second, 0.1 s have only one frame, the start\n";
    for command in ["check rare.toml", "simulate rare.toml", "simulate rare.toml --json --overwrite"] {
        let ran = place.run(command);
        assert_eq!((ran.status, ran.err.matches("warning: ").count()), (Some(0), 1), "{command}: {ran:?}");
        assert!(ran.err.starts_with(words), "{command}: {ran:?}");
    }
    for command in ["check rare.toml --quiet", "simulate rare.toml --quiet --overwrite"] {
        place.run(command).good();
    }
    let document = place.run("check rare.toml --json").good().json();
    assert_eq!(document["scenes"][0]["warnings"][0]["line"], 7);
    assert_eq!(document["scenes"][0]["warnings"][0]["help"], "use at least 10 to show the end");
}

/// Words without room in the pictures of a scene are reported, but are not mistakes.
#[cfg(feature = "render")]
#[test]
fn tells_what_finds_no_room() {
    let place = Place::new();
    let view = "size = [640, 360]\ntext_scale = 3.0\ncharts = ['energy']";
    place.write("large.toml", &SMALL.replace("size = [96, 64]", view));
    let ran = place.run("check large.toml");
    assert_eq!(ran.status, Some(0));
    let told = "warning: large.toml: not everything has room in 640×360: ";
    assert!(ran.err.starts_with(told) && ran.err.contains("panels do not describe the models"), "{}", ran.err);
    let document = place.run("check large.toml --json").good().json();
    assert!(document["scenes"][0]["no_room"].as_array().is_some_and(|told| told.len() > 1), "{document}");
    let view = "size = [1280, 720]\ntext_scale = 1.4\ncharts = ['energy']";
    place.write("roomy.toml", &SMALL.replace("size = [96, 64]", view));
    assert_eq!(place.run("check roomy.toml").good().err, "");
    let told = "warning: roomy.toml: not everything has room in 300×200: ";
    assert!(place.run("check roomy.toml --size 300x200").err.starts_with(told));
    // What several runs lack is told once.
    let view = "size = [640, 360]\npanels = 2\ntext_scale = 2.6\nlabels = ['name', 'model']";
    place.write("narrow.toml", &SMALL.replace("size = [96, 64]", view));
    let ran = place.run("check narrow.toml");
    let told = "room in 640×360: the descriptions of 2 runs are shortened, of `Local shape` to `Mass-spring`\n";
    assert!(ran.status == Some(0) && ran.err.ends_with(told), "{ran:?}");
}

/// The example of `docs/bodies.md` makes the documented body: a stored archive of it, and a new one if there is NumPy.
#[test]
fn a_mesh_written_with_numpy() {
    let text = include_str!("../../docs/bodies.md");
    let block = |language: &str| {
        let start = text.find(&format!("```{language}\n")).expect("a block") + language.len() + 4;
        &text[start..start + text[start..].find("```").expect("its end")]
    };
    let place = Place::new();
    place.write("tube.toml", block("toml"));
    let check = |bytes: &[u8]| {
        std::fs::write(place.path("tube.npz"), bytes).unwrap();
        let document = place.run("check tube.toml --json").good().json();
        let scene = document["scenes"][0]["scene"].clone();
        let body = &scene["bodies"][0];
        assert_eq!((&body["nodes"], &body["elements"][0]), (&264.into(), &"120 hexahedra".into()));
        assert_eq!(body["start"][0], serde_json::json!([-0.5, -0.25, -0.25]));
        assert_eq!(scene["holds"][0], "24 nodes from 0 s on");
    };
    check(include_bytes!("tube.npz"));
    if let Some(python) = numpy() {
        python(&place.path("."), block("python"));
        check(&std::fs::read(place.path("tube.npz")).unwrap());
    }
}

#[cfg(unix)]
#[test]
fn a_scene_that_cannot_be_read() {
    let place = Place::new();
    // No user can follow a link to itself.
    std::os::unix::fs::symlink("loop.toml", place.path("loop.toml")).unwrap();
    place.run("check loop.toml").bad(4, &["loop.toml", "cannot be read"]);
}

/// The prediction is printed for each run; a step above it is reported by every command that runs the scene.
#[test]
fn says_which_step_is_stable() {
    let place = Place::with_small();
    let document = place.run("check small.toml --json").good().json();
    let run = &document["scenes"][0]["scene"]["runs"][1];
    let [step, largest, stretched] =
        ["step", "largest_step", "largest_stretched_step"].map(|key| run[key].as_f64().expect(key));
    assert!(step < stretched && stretched < largest, "{run}");
    let text = place.run("check small.toml").good().out;
    assert!(text.contains("largest stable step 0.0") && text.contains(" with stretched springs\n"), "{text}");

    place.write("near.toml", &SMALL.replacen("\"T/50\"", &(0.95 * largest).to_string(), 1));
    let ran = place.run("check near.toml");
    let told = "\"Mass-spring\" is 0.0";
    assert!(ran.err.contains(told) && ran.err.contains(" s, 95 % of the largest that is stable at rest"), "{ran:?}");
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert!(place.run("simulate near.toml").err.contains("or `step = \"auto\"`"));

    place.write("above.toml", &SMALL.replacen("\"T/50\"", &(1.05 * largest).to_string(), 1));
    let ran = place.run("check above.toml").too_large_steps();
    assert!(ran.err.contains("above.toml:") && ran.err.contains("may diverge"), "{ran:?}");
    // It can be simulated.
    let warnings = &place.run("check above.toml --json").good().json()["scenes"][0]["warnings"];
    assert_eq!(warnings.as_array().map(Vec::len), Some(1), "{warnings}");
    place.run("check small.toml above.toml --quiet").good();
    place.write("wrong.toml", &SMALL.replace("mass = 1.0", "mass = 0"));
    assert_eq!(place.run("check above.toml wrong.toml --quiet").status, Some(2));

    place.write("auto.toml", &SMALL.replacen("T/50", "auto", 1));
    let document = place.run("check auto.toml --json").good().json();
    let runs = document["scenes"][0]["scene"]["runs"].as_array().expect("two runs");
    let steps: Vec<_> = runs.iter().map(|run| run["step"].as_f64().expect("a step")).collect();
    let least = runs.iter().map(|run| run["largest_step"].as_f64().expect("a limit")).fold(f64::INFINITY, f64::min);
    assert_eq!(steps[0], steps[1]);
    let per_frame = 1.0 / 60.0 / steps[0];
    assert!(per_frame.fract() == 0.0 && steps[0] <= 0.5 * least && steps[0] > 0.4 * least, "{steps:?} {least}");
}

/// Undamped bodies gain energy in rebounds that take none.
#[test]
fn says_what_rebounds_add() {
    let place = Place::new();
    let undamped = SMALL.replace(", damping_ratio = 0.1", "");
    place.write("plain.toml", &undamped);
    place.write("elastic.toml", &undamped.replace("restitution = 0.5", "restitution = 1"));
    assert!(!place.run("check plain.toml").good().out.contains("each rebound"));
    let text = place.run("check elastic.toml").good().out;
    assert_eq!(text.matches("undamped, e = 1: each rebound adds about 0.").count(), 2, "{text}");
}

#[test]
fn what_cannot_be_meant_is_told() {
    let place = Place::new();
    let euler = SMALL.replacen(", damping_ratio = 0.1 }", " }\nintegrator = \"explicit-euler\"", 1);
    place.write("euler.toml", &euler);
    for command in ["check euler.toml", "simulate euler.toml --frames 0-1"] {
        let ran = place.run(command);
        let words = "warning: euler.toml:16:14: `explicit-euler` adds energy to \"Local shape\" with any step";
        assert!(ran.status == Some(0) && ran.err.starts_with(words), "{ran:?}");
    }
    place.write("of.toml", &SMALL.replace("friction = 0.3", "friction_of = \"path\""));
    place.run("check of.toml").bad(2, &["of.toml:22:1: `friction_of` needs `friction`"]);
    place.write("twice.toml", &SMALL.replace("[[run]]", "[run]"));
    place.run("check twice.toml").bad(2, &["write `[[run]]` before each of several"]);
}

/// A tetrahedron, and the same without one of its faces.
const MESHES: [(&str, &str); 2] = [
    ("whole.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"),
    ("sheet.obj", "v 0 0 0\nv 2 0 0\nv 0 2 1\nf 1 2 3\n"),
];

#[test]
fn says_what_a_mesh_is() {
    let place = Place::with_small();
    MESHES.iter().for_each(|(name, text)| place.write(name, text));
    let ran = place.run("check whole.obj").good();
    for word in
        ["4 points, 4 triangles", "2 × 2 × 2 in the unit of the file", "closed, volume 1.333", "cubes", "polyhedra"]
    {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    let both = place.run("check whole.obj sheet.obj").out;
    assert!(both.contains("mesh       whole.obj") && both.contains("mesh       sheet.obj"), "{both}");
    assert_eq!(place.run("check whole.obj small.toml --quiet").good().out, "");
    let ran = place.run("check sheet.obj absent.ply");
    assert_eq!(ran.status, Some(2), "{ran:?}");
    for word in ["sheet.obj has no inside", "absent.ply is not there"] {
        assert!(ran.err.contains(word), "{word}: {}", ran.err);
    }
    let document = place.run("check whole.obj sheet.obj small.toml --json").json();
    assert_eq!(document["scenes"][0]["ok"], true);
    let [whole, sheet] = [0, 1].map(|mesh| &document["meshes"][mesh]);
    assert_eq!((&whole["ok"], &sheet["ok"]), (&true.into(), &false.into()));
    assert_eq!((&whole["mesh"]["points"], &whole["mesh"]["surface"]["closed"]), (&4.into(), &true.into()));
    let fills = whole["mesh"]["surface"]["fills"].as_array().unwrap();
    assert_eq!(
        fills.iter().map(|fill| &fill["with"]).collect::<Vec<_>>(),
        ["cubes", "graded", "tetrahedra", "polyhedra"]
    );
    for fill in fills {
        assert!(fill["elements"].as_u64().unwrap() > 1000 && fill["side"] == 0.1 && fill["parts"] == 1, "{fill}");
    }
}

#[test]
fn says_what_is_left_out_of_a_mesh() {
    let place = Place::with_small();
    let files = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("mesh/tests/files");
    place.write("kinds.inp", &std::fs::read(files.join("kinds.inp")).expect("a file"));
    let ran = place.run("check kinds.inp").good();
    for word in [
        "23 points, 1 tetrahedron",
        "volume 2,",
        "note       has elements that are not read: 2 of the type SPRINGA",
        "group      \"Left end\": 3 points",
    ] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    let document = place.run("check kinds.inp --json").json();
    let mesh = &document["meshes"][0]["mesh"];
    assert_eq!(mesh["notes"][0], "has elements that are not read: 2 of the type SPRINGA");
    assert_eq!(mesh["cells"]["groups"].as_array().map(Vec::len), Some(10));
    // A group of nothing but springs.
    let held = "time = { duration = 1 }\nbody = { mesh = 'kinds.inp', density = 1e3 }\nhold = [{ nodes = 'springs' }]\n\
                run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } }]\n";
    place.write("held.toml", held);
    let words = "`hold[0].nodes` is \"springs\", a group whose points belong to no element of the body";
    place.run("check held.toml").bad(2, &[words]);
}

#[test]
fn says_which_distance_closes_a_surface_or_joins_cells() {
    let place = Place::with_small();
    let files = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("mesh/tests/files");
    for name in ["last-digits.stl", "discontinuous.vtu", "unknown-point.obj"] {
        place.write(name, &std::fs::read(files.join(name)).expect("a file"));
    }
    let ran = place.run("check last-digits.stl").good();
    for word in ["36 open edges", "remedy     weld = 1e-6 in `[body]`, times its `scale`, joins points"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    assert!(place.run("check discontinuous.vtu").good().out.contains("remedy     weld = 1e-10 in `[body]`"));
    let lost = place.run("check unknown-point.obj").good().out;
    assert!(
        lost.contains("note       has a point without coordinates, which is left out") && !lost.contains("remedy"),
        "{lost}"
    );
    let document = place.run("check last-digits.stl unknown-point.obj --json").json();
    let surface = |at: usize| &document["meshes"][at]["mesh"]["surface"];
    assert_eq!((&surface(0)["weld"], &surface(0)["open_edges"]), (&1e-6.into(), &36.into()));
    assert_eq!(surface(1)["weld"], serde_json::Value::Null);
    assert_eq!(document["meshes"][1]["mesh"]["notes"][0], "has a point without coordinates, which is left out");
}

#[test]
fn says_what_converts_files_that_are_not_read() {
    let place = Place::with_small();
    for (name, tool) in [("part.step", "gmsh -3 FILE -o NEW.msh"), ("part.FBX", "Blender"), ("part.3mf", "PrusaSlicer")]
    {
        place.write(name, "ISO-10303-21;\nHEADER;\n");
        let ran = place.run(&format!("check {name}"));
        ran.bad(2, &[&format!("{name} is a .{} file", name[5..].to_lowercase()), tool]);
    }
    place.run("simulate part.step").bad(2, &["part.step", "mesh"]);
    place.write("cube.toml", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.run("check cube.toml").bad(2, &["cube.toml is a .toml file", "by its content it is a .obj file: name it so"]);
}

/// Two hexahedra side by side, and a pentagon that crosses itself.
#[test]
fn says_what_cells_are() {
    let place = Place::with_small();
    let points = [0, 1, 2].map(|x| format!("{x} 0 0 {x} 1 0 {x} 0 1 {x} 1 1\n")).concat();
    place.write(
        "bricks.vtk",
        &format!(
            "# vtk DataFile Version 3.0\nbricks\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n{points}CELLS 2 18\n\
             8 0 4 5 1 2 6 7 3\n8 4 8 9 5 6 10 11 7\nCELL_TYPES 2\n12 12\n"
        ),
    );
    place.write(
        "crossed.vtk",
        "# vtk DataFile Version 3.0\ncrossed\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n\
         0 0 0 4 0 0 4 4 0 1 -1 0 0 4 0\nCELLS 1 6\n5 0 1 2 3 4\nCELL_TYPES 1\n7\n",
    );
    let ran = place.run("check bricks.vtk").good();
    for word in ["12 points, 2 cubes", "2 × 1 × 1 in the unit", "volume 2, 10 outer faces"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    let document = place.run("check bricks.vtk --json").json();
    let cells = &document["meshes"][0]["mesh"]["cells"];
    assert_eq!((&cells["volume"], &cells["outer_faces"]), (&2.0.into(), &10.into()));
    place.run("check crossed.vtk").bad(2, &["crossed.vtk has a cell, elements[0], whose sides", "cross"]);
}
