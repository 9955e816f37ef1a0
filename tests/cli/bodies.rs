//! Scenes of several bodies, and runs with bodies of their own: numbers, states and findings by body and in all.

use crate::cli::support::Place;
use serde_json::{Value, json};

/// Three bodies in the plane.
pub(crate) const BODIES: [(&str, &str); 3] = [
    ("ball", "disc = { radius = 0.1, rings = 2, sectors = 7 }\nmass = 2.0\nlowest = 0.0\nvelocity = [0.5, -2]"),
    ("cube", "lattice = { cells = [2, 2], side = 0.1 }\nlowest = 0.05\noffset = [0.7, 0]\nvelocity = [0, -3]"),
    (
        "raft",
        "lattice = { cells = [3, 1], side = 0.05 }\nmass = 0.5\nlowest = 0.02\noffset = [-0.7, 0]\nspin.rate = 2.0",
    ),
];

/// The runs of all bodies.
const RUNS: &str = r#"
[[run]]
name = "soft"
model = { kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1, damping_of = "relative-motion" }
[[run]]
name = "springs"
model = { kind = "mass-spring", stiffness = 1e4, springs = "edges+one-diagonal" }
"#;

/// A scene of these bodies with some runs. The step is in seconds: T depends on the lightest node of the scene.
pub(crate) fn scene(bodies: &[usize], runs: &str) -> String {
    let body = |&body: &usize| format!("[[body]]\nname = \"{}\"\n{}\n", BODIES[body].0, BODIES[body].1);
    let bodies: String = bodies.iter().map(body).collect();
    format!(
        "title = \"Bodies\"\ngravity = [0, -9.8]\n\
         [time]\nduration = 0.1\nstep = 5e-4\nframes_per_second = 60\n\
         {bodies}{runs}\n\
         [[obstacle]]\nkind = \"floor\"\nrestitution = 0.5\nfriction = 0.3\n\
         [view]\nsize = [192, 128]\n"
    )
}

/// The bodies in other discretisations: a run with all, and two with one each.
pub(crate) fn of_their_own() -> String {
    let model = "model = { kind = \"shape-based\", stiffness = 1e4 }";
    let run = |name: &str, bodies: &str| format!("[[run]]\nname = \"{name}\"\n{bodies}\n{model}\n");
    let runs = [("all", ""), ("coarse", "bodies = [\"cube\"]"), ("fine", "bodies = [\"ball\"]")];
    scene(&[0, 1], &runs.map(|(name, bodies)| run(name, bodies)).concat())
}

/// The rows of a table without its headings, each with its run, its body and the rest.
fn rows(place: &Place, folder: &str) -> Vec<[String; 3]> {
    let table = place.read(&format!("{folder}/diagnostics.csv"));
    let row = |line: &str| line.splitn(3, ',').map(str::to_owned).collect::<Vec<_>>().try_into().expect("a row");
    table.lines().skip(1).map(row).collect()
}

/// Some runs of a summary.
fn runs(place: &Place, folder: &str) -> Vec<Value> {
    place.json(&format!("{folder}/run.json"))["runs"].as_array().expect("runs").clone()
}

#[test]
fn each_of_several_bodies_is_as_alone() {
    let place = Place::new();
    place.write("all.toml", &scene(&[0, 1, 2], RUNS));
    place.run("simulate all.toml -o all").good();
    let all = rows(&place, "all");
    assert_eq!(all.len(), 7 * 2 * 4);
    let order: Vec<_> = all[..8].iter().map(|[run, body, _]| (run.as_str(), body.as_str())).collect();
    let bodies = ["all", "ball", "cube", "raft"];
    assert_eq!(order, ["soft", "springs"].map(|run| bodies.map(|body| (run, body))).concat());
    let summary = runs(&place, "all");
    for (at, (name, _)) in BODIES.iter().enumerate() {
        place.write("alone.toml", &scene(&[at], RUNS));
        place.run(&format!("simulate alone.toml -o {name}")).good();
        let alone = rows(&place, name);
        assert!(alone.iter().all(|[_, body, _]| body == "all"), "nothing is said twice");
        let same = all.iter().filter(|[_, body, _]| body == name).map(|[run, _, rest]| (run, rest));
        assert!(same.eq(alone.iter().map(|[run, _, rest]| (run, rest))), "{name}");
        for (of_all, of_alone) in summary.iter().zip(runs(&place, name)) {
            let mut expected = of_alone["last"].clone();
            let keys = expected.as_object_mut().expect("a table");
            keys.retain(|key, _| key != "frame" && key != "time");
            keys.insert("name".to_owned(), json!(name));
            assert_eq!(of_all["last"]["bodies"][at], expected);
            assert_eq!((&of_alone["bodies"], &of_alone["last"]["bodies"]), (&json!([name]), &Value::Null));
        }
    }
}

/// Sums over bodies have the same bits, too.
#[test]
fn order_changes_nothing_but_the_order_of_rows() {
    let place = Place::new();
    for (name, order) in [("one", [0, 1, 2]), ("other", [2, 0, 1])] {
        place.write(&format!("{name}.toml"), &scene(&order, RUNS));
        place.run(&format!("simulate {name}.toml -o {name}")).good();
    }
    let [one, other] = ["one", "other"].map(|folder| {
        let mut rows = rows(&place, folder);
        rows.sort();
        rows
    });
    assert_eq!(one, other);
    let bodies = |folder: &str| runs(&place, folder)[0]["bodies"].clone();
    assert_eq!([bodies("one"), bodies("other")], [json!(["ball", "cube", "raft"]), json!(["raft", "ball", "cube"])]);
}

#[test]
fn states_of_bodies() {
    let place = Place::new();
    place.write("all.toml", &scene(&[0, 1, 2], RUNS));
    place.write("own.toml", &of_their_own());
    place.write("alone.toml", &scene(&[1], RUNS));
    place.run("simulate all.toml own.toml alone.toml --states -o out").good();
    let names = |scene: &str| -> Vec<String> {
        let file = std::fs::File::open(place.path(format!("out/{scene}/states.npz"))).expect("states");
        let archive = zip::ZipArchive::new(file).expect("an archive");
        let names = archive.file_names().map(|name| name.unwrap_or_default().as_ref().to_owned());
        names.map(|name: String| name.trim_end_matches(".npy").to_owned()).collect()
    };
    let is_own = |name: &&String| {
        name.contains('.') && !["position", "velocity", "memory", "step"].iter().any(|end| name.ends_with(end))
    };
    assert!(!names("alone").contains(&"bodies".to_owned()) && names("all").contains(&"bodies".to_owned()));
    assert_eq!(names("all").iter().filter(is_own).count(), 0);
    let own = ["rest", "mass", "elements", "faces", "body"];
    let own: Vec<_> = ["coarse", "fine"].iter().flat_map(|run| own.map(|array| format!("{run}.{array}"))).collect();
    assert_eq!(names("own").into_iter().filter(|name| is_own(&name)).collect::<Vec<_>>(), own);
    let Some(python) = crate::cli::support::numpy() else { return };
    // The lines of the page, with its runs and bodies, and what must hold of them.
    let page = include_str!("../../docs/files.md");
    let snippet = page.split("```python\n").find(|part| part.starts_with("ball = ")).expect("the example");
    let snippet = snippet.split("```").next().expect("its end");
    let script = format!(
        "import numpy\n\
         states = numpy.load('out/all/states.npz')\n\
         {snippet}\
         print(middle.shape, states['bodies'].tolist(), numpy.bincount(states['body']).tolist(), faces.max() == len(states['rest']) - 1)\n\
         states = numpy.load('out/own/states.npz')\n\
         {}\
         print(len(states['fine.rest']), states['fine.position'].shape, faces.max(), states['fine.body'].max(), states['coarse.body'].min())\n",
        snippet.lines().last().map(|line| format!("{line}\n")).expect("the faces of a run"),
    );
    let out = python(place.path(".").as_path(), &script);
    assert_eq!(out, "(7, 3) ['ball', 'cube', 'raft'] [15, 9, 8] True\n15 (7, 15, 3) 14 0 1\n");
}

#[test]
fn a_divergence_names_its_body() {
    let place = Place::new();
    // Only the second body is too stiff for its steps.
    let models = "models = { ball = { kind = \"shape-based\", stiffness = 1e4 }, \
                  cube = { kind = \"mass-spring\", stiffness = 1e9, springs = \"edges\" } }";
    place.write("wild.toml", &scene(&[0, 1], &format!("[[run]]\nname = \"two\"\n{models}\n")));
    let ran = place.run("simulate wild.toml -o out").too_large_steps();
    let run = &runs(&place, "out")[0];
    assert_eq!((&run["status"], &run["body"]), (&json!("diverged"), &json!("cube")));
    let (node, element) = (run["node"].as_u64().expect("a node"), run["element"].as_u64().expect("an element"));
    assert!(node < 9 && element < 4, "counted in the cube: {run}");
    let cause = run["cause"].as_str().expect("a cause");
    assert!(
        cause.starts_with(&format!("node {node} of element {element} of “cube” would move faster than ")),
        "{cause}"
    );
    assert!(
        ran.out.contains(&format!(", element {element} of cube)")) && ran.out.contains("\n    cube "),
        "{}",
        ran.out
    );
}

/// Bodies are compared one by one.
#[cfg(feature = "render")]
#[test]
fn a_golden_names_the_bodies_that_moved() {
    let place = Place::new();
    place.write("two.toml", &scene(&[0, 1], RUNS));
    place.run("compare --bless golden two.toml").good();
    let same = place.run("compare golden two.toml").good();
    assert!(same.out.ends_with("28 states are the same\n"), "{}", same.out);
    place.write("two.toml", &scene(&[0, 1], RUNS).replace("velocity = [0, -3]", "velocity = [0, -3.1]"));
    let moved = place.run("compare golden two.toml --json").json();
    let names: Vec<_> = moved["moved"].as_array().expect("states").iter().map(|moved| moved["run"].clone()).collect();
    assert_eq!(names, ["soft · cube", "springs · cube"]);
    for moved in moved["moved"].as_array().expect("states") {
        assert!(moved["largest"]["node"].as_u64().expect("a node") < 9, "counted in the cube: {moved}");
    }
    let pictures = moved["pictures"].as_array().expect("pictures");
    assert!(pictures.iter().all(|picture| picture["runs"] == json!(["soft · cube", "springs · cube"])), "{moved}");
}

/// An interrupted command goes on with the bytes of one that was not, with several bodies and with runs of their own.
#[cfg(unix)]
#[test]
fn cut_and_continued() {
    use crate::cli::interrupt::{results, signal, start};
    let place = Place::new();
    place.write(
        "own.toml",
        &of_their_own().replace("duration = 0.1", "duration = 20").replace("[view]", "[view]\ncharts = [\"energy\"]"),
    );
    let typed = "simulate own.toml --states -o";
    let running = start(&place, &format!("{typed} out"), "out/run.json");
    signal(&running, &["INT"]);
    let ran = running.wait();
    assert!(ran.status == Some(130) && ran.out.contains("to go on: "), "{ran:?}");
    place.run(&format!("{typed} out --resume")).good();
    place.run(&format!("{typed} whole")).good();
    for name in results(&place, "whole").iter().filter(|name| *name != "run.json") {
        let [one, other] = ["out", "whole"].map(|folder| std::fs::read(place.path(folder).join(name)).expect("a file"));
        assert!(one == other, "{name}");
    }
    assert_eq!(
        runs(&place, "out").iter().map(|run| run["last"].clone()).collect::<Vec<_>>(),
        runs(&place, "whole").iter().map(|run| run["last"].clone()).collect::<Vec<_>>()
    );
}

/// Frames drawn from stored states, also in shards, have the bytes of frames drawn at once.
#[cfg(feature = "render")]
#[test]
fn drawn_from_states() {
    let place = Place::new();
    place.write("all.toml", &scene(&[0, 1, 2], RUNS));
    place.write("own.toml", &of_their_own().replace("[view]", "[view]\ncharts = [\"energy\"]"));
    for name in ["all", "own"] {
        place.run(&format!("render {name}.toml --states -o {name}-whole")).good();
        place.run(&format!("simulate {name}.toml --states -o {name}")).good();
        for shard in ["1/2", "2/2"] {
            place.run(&format!("render {name}.toml --from-states {name}/states.npz --shard {shard} -o {name}")).good();
        }
        let files = |folder: String| crate::cli::parts::files(&place, &folder);
        assert!(files(name.to_owned()) == files(format!("{name}-whole")), "{name}");
    }
}

/// The name of the rows on all bodies together is no body's.
#[test]
fn a_body_is_not_called_all() {
    let place = Place::new();
    place.write("all.toml", &scene(&[0, 1], RUNS).replace("\"cube\"", "\"all\""));
    place.run("check all.toml").bad(2, &["all.toml:14:8: a body is called \"all\"", "expected another name"]);
}

#[cfg(feature = "render")]
#[test]
fn numbers_of_figures() {
    let place = Place::new();
    place.write("all.toml", &scene(&[0, 1, 2], RUNS));
    place.run("simulate all.toml -o out").good();
    place.write("sheet.toml", "title = \"Bodies\"\n[sheet]\nscene = \"all.toml\"\nmoments = [0.0, 0.1]\n");
    place.write("forces.toml", "title = \"Forces\"\n[forces]\nscenes = [\"all.toml\"]\n");
    let numbers = |name: &str| {
        let document = place.run(&format!("figure {name}.toml -o figures --json")).good().json();
        document["figures"][0]["numbers"].clone()
    };
    let sheet = numbers("sheet");
    for (row, run) in runs(&place, "out").iter().enumerate() {
        for (at, (name, _)) in BODIES.iter().enumerate() {
            let [shown, last] = [&sheet[row][1]["bodies"][at], &run["last"]["bodies"][at]];
            assert_eq!((&shown["name"], &shown["shape_error"]), (&json!(name), &last["shape_error"]));
        }
    }
    let key = "forces_over_stiffness_and_side";
    for run in numbers("forces")[0]["runs"].as_array().expect("runs") {
        let bodies = run["bodies"].as_array().expect("bodies");
        let of_bodies: Vec<_> = bodies.iter().flat_map(|body| body[key].as_array().expect("forces").clone()).collect();
        assert_eq!((bodies.len(), &json!(of_bodies)), (3, &run[key]));
    }
}
