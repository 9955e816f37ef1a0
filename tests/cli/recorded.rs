//! Runs that show recorded states.

use crate::cli::parts::files;
use crate::cli::render::place_to_draw;
use crate::cli::support::{Place, lasting};
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use localshape::sim::Status;

/// A disc in the plane that falls on a floor, with a camera at rest.
const PLANE: &str = r#"
title = "A disc"
gravity = [0, -9.8]
time = { duration = 0.1, frames_per_second = 60 }
[body]
fan = { sides = 6, radius = 0.1 }
lowest = 0.05
velocity = [0, -2]
[[run]]
name = "Local shape"
model = { kind = "shape-based", stiffness = 1e4 }
[[obstacle]]
kind = "floor"
[view]
size = [160, 120]
camera.distance = 1
labels = ["name", "clock", "number"]
"#;

/// A scene whose runs show the states of `file` in place of their models.
fn recorded(scene: &str, file: &str) -> String {
    let line = |line: &str| if line.starts_with("model = ") { format!("states = {file}") } else { line.to_owned() };
    scene.lines().map(|one| line(one) + "\n").collect()
}

/// The parts of a picture without its texts, which have the digest of the scene.
fn drawn(png: &[u8]) -> Vec<u8> {
    let (mut rest, mut kept) = (&png[8..], Vec::new());
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let (chunk, others) = after.split_at(u32::from_be_bytes(*length) as usize + 8);
        if !chunk.starts_with(b"tEXt") && !chunk.starts_with(b"iTXt") {
            kept.extend(chunk);
        }
        rest = others;
    }
    kept
}

/// Pictures of all frames.
fn pictures(place: &Place, folder: &str) -> Vec<Vec<u8>> {
    let names = place.names(folder).into_iter().filter(|name| name.ends_with(".png"));
    names.map(|name| drawn(&std::fs::read(place.path(folder).join(name)).unwrap())).collect()
}

#[test]
fn our_own_states_played_back_give_the_pictures_of_the_run() {
    let Some(place) = place_to_draw() else { return };
    let lit = lasting("0.1").replace("[view]", "[view]\nlabels = [\"name\", \"clock\", \"number\"]");
    for (name, scene) in [("plane", PLANE), ("lit", &lit)] {
        place.write(&format!("{name}.toml"), scene);
        place.run(&format!("render {name}.toml --states -o {name}")).good();
        place.write("played.toml", &recorded(scene, &format!("\"{name}/states.npz\"")));
        place.run(&format!("render played.toml --states -o {name}-played")).good();
        let (own, played) = (pictures(&place, name), pictures(&place, &format!("{name}-played")));
        assert_eq!((own.len(), played.len()), (7, 7));
        assert!(own == played, "{name}");
        // States of a recording are stored like any others.
        place.run(&format!("render played.toml --from-states {name}-played/states.npz -o {name}-stored")).good();
        assert!(files(&place, &format!("{name}-stored")).iter().all(|(file, bytes)| {
            file == "states.npz" || std::fs::read(place.path(format!("{name}-played/{file}"))).unwrap() == *bytes
        }));
    }
}

#[test]
fn frames_of_a_recording_are_drawn_alone_in_shards_and_resumed() {
    let Some(place) = place_to_draw() else { return };
    place.write("plane.toml", PLANE);
    place.run("simulate plane.toml --states --frames 0-6x2 -o states").good();
    // The camera follows, so that pictures need the time series.
    let scene = PLANE.replace("camera.distance = 1\n", "charts = [\"kinetic\"]\n");
    place.write("played.toml", &recorded(&scene, "{ file = \"states/states.npz\", run = \"Local shape\" }"));
    place.run("render played.toml -o whole").good();
    place.run("render played.toml -o parts --frames 3").good();
    let frame = "frame_00003.png";
    let bytes = |folder: &str| std::fs::read(place.path(folder).join(frame)).unwrap();
    assert!(bytes("parts") == bytes("whole"));
    place.run("render played.toml -o parts --resume").good();
    assert!(files(&place, "parts") == files(&place, "whole"));
    place.run("render played.toml --shard 1/2 -o shards").good();
    place.run("render played.toml --shard 2/2 -o shards").good();
    assert_eq!(pictures(&place, "shards"), pictures(&place, "whole"));
}

/// A run that diverged is played back with its divergence, the state that its pictures show, and the words about it.
#[test]
fn our_own_run_that_diverged_is_played_back_as_such() {
    let Some(place) = place_to_draw() else { return };
    let wild = PLANE
        .replace("\"shape-based\", stiffness = 1e4 }", "\"mass-spring\", stiffness = 1e4 }\nstep = \"T/2\"")
        .replace("duration = 0.1", "duration = 1");
    place.write("wild.toml", &wild);
    place.run("render wild.toml --states -o own").too_large_steps();
    let played = recorded(&wild, "\"own/states.npz\"").replace("step = \"T/2\"\n", "");
    place.write("played.toml", &played);
    place.run("render played.toml -o played").good();
    let (own, played) = (pictures(&place, "own"), pictures(&place, "played"));
    assert!(own.len() == 61 && own == played);
    let run = |folder: &str| {
        let mut run = place.json(&format!("{folder}/run.json"))["runs"][0].clone();
        ["status", "time", "step", "element"].map(|key| run[key].take())
    };
    assert_eq!(run("own"), run("played"));
    assert_eq!(run("own")[0], "diverged");
    // Numbers that were changed since are not those of the run that diverged.
    let Some(python) = crate::cli::support::numpy() else { return };
    let script = "import numpy; states = dict(numpy.load('own/states.npz')); states['Local shape.position'][0, :, 0] += 1\n\
                  numpy.savez('own/states.npz', **states)";
    python(&place.path("."), script);
    place.run("render played.toml -o changed").good();
    assert_eq!(run("changed")[0], "ok");
}

/// Of a run that diverged, the states up to its last finite one are those of the recording.
#[test]
fn a_run_that_diverged_has_no_states_after_that() {
    let place = Place::new();
    let wild = PLANE
        .replace("\"shape-based\", stiffness = 1e4 }", "\"mass-spring\", stiffness = 1e4 }\nstep = \"T/2\"")
        .replace("duration = 0.1", "duration = 1");
    place.write("wild.toml", &wild);
    place.run("simulate wild.toml --states -o own").too_large_steps();
    let rows = place.read("own/diagnostics.csv");
    let sound = rows.lines().skip(1).filter(|row| row.ends_with(",ok"));
    let times: Vec<f64> = sound.map(|row| row.split(',').nth(3).unwrap().parse().unwrap()).collect();
    // Frames nearer than a step have one state.
    let before = times.iter().filter(|time| *time < times.last().unwrap()).count();
    assert!((2..60).contains(&before), "{rows}");
    place.write("played.toml", &recorded(&wild, "\"own/states.npz\"").replace("step = \"T/2\"\n", ""));
    let told = place.run("check played.toml").good();
    let words = format!("recorded, {} states", before + 1);
    assert!(told.out.contains(&words), "{words}: {}", told.out);
}

/// Of two bodies, the second one diverges. Where both are shown as one body, the divergence is in an element of that.
#[test]
fn a_divergence_in_another_body_is_played_back_as_well() {
    let place = Place::new();
    let two = r#"
gravity = [0, -9.8]
time = { duration = 1, frames_per_second = 20, integrator = "explicit-euler", step = 0.005 }
[[body]]
name = "soft"
fan = { sides = 6, radius = 0.1 }
lowest = 0
[[body]]
name = "stiff"
fan = { sides = 6, radius = 0.1 }
lowest = 1
[[obstacle]]
kind = "floor"
[[run]]
name = "Both"
models.soft = { kind = "shape-based", stiffness = 1e3, damping_ratio = 0.5 }
models.stiff = { kind = "shape-based", stiffness = 1e6 }
"#;
    place.write("two.toml", two);
    place.run("simulate two.toml --states -o own");
    let run = place.json("own/run.json")["runs"][0].clone();
    assert_eq!((&run["status"], &run["body"]), (&"diverged".into(), &"stiff".into()), "{run}");
    place.write("played.toml", &recorded(PLANE, "\"own/states.npz\"").replace("duration = 0.1", "duration = 1"));
    let scene = Scene::load(&place.path("played.toml"), &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let frame = Runner::new(&scene, &[0]).frame(scene.last_frame());
    let shown = frame.runs[0].last_fit.as_ref().expect("the last state that fits");
    assert!(shown.position.len() == 14, "{shown:?}");
    let Status::Diverged(divergence) = shown.status else { panic!("{shown:?}") };
    assert_eq!((divergence.part, divergence.element), (0, None), "an element of another body");
}

/// After its last moment a recording shows its last state, and says so.
#[test]
fn a_recording_ends() {
    let Some(place) = place_to_draw() else { return };
    place.write("plane.toml", PLANE);
    place.run("simulate plane.toml --states --frames 0-3 -o states").good();
    place.write("played.toml", &recorded(PLANE, "\"states/states.npz\""));
    let ran = place.run("render played.toml -o out").good();
    assert!(ran.out.contains("recording ends at 0.05"), "{}", ran.out);
    let run = &place.json("out/run.json")["runs"][0];
    assert_eq!((&run["status"], &run["steps"]), (&"ended".into(), &0.into()));
    let rows = place.read("out/diagnostics.csv");
    let states: Vec<_> = rows.lines().skip(1).filter_map(|row| row.rsplit(',').next()).collect();
    assert_eq!(states, ["ok", "ok", "ok", "ok", "ended", "ended", "ended"]);
    let pictures = pictures(&place, "out");
    assert!(pictures[3] != pictures[4] && pictures[4] == pictures[5]);
}

/// The documented scene and script.
#[test]
fn a_recording_written_with_numpy() {
    let Some(python) = crate::cli::support::numpy() else { return };
    let text = include_str!("../../docs/recordings.md");
    let block = |opening: &str| {
        let start = text.find(opening).expect("a block") + opening.len();
        &text[start..start + text[start..].find("```").expect("its end")]
    };
    let place = Place::new();
    python(&place.path("."), block("```python\n"));
    place.write("thrown.toml", block("```toml\ngravity"));
    let scene = format!("gravity{}", place.read("thrown.toml"));
    place.write("thrown.toml", &scene);
    place.run("simulate thrown.toml -o out").good();
    let table = place.read("out/diagnostics.csv");
    let heads: Vec<_> = table.lines().next().unwrap().split(',').collect();
    let column = |name: &str| heads.iter().position(|head| *head == name).unwrap();
    let of = |run: &str, name: &str| -> Vec<f64> {
        let rows = table.lines().filter(|row| row.starts_with(run));
        rows.map(|row| row.split(',').nth(column(name)).unwrap().parse().unwrap()).collect()
    };
    let [own, recorded] = ["Simulated", "Thrown"].map(|run| of(run, "kinetic"));
    assert_eq!((own.len(), recorded.len()), (61, 61));
    // Differences on one side, at both ends, are of the first order.
    let inner = own.iter().zip(&recorded).take(60).skip(1);
    assert!(inner.clone().all(|(own, recorded)| (own - recorded).abs() < 0.05 * own.max(1.0)), "{own:?} {recorded:?}");
    assert!(of("Thrown", "energy").iter().all(|energy| energy.is_nan()));
    assert!(of("Thrown", "shape_error").iter().all(|error| *error < 1e-12));
}
