//! `simulate`: diagnostics, summary and states.

use crate::cli::support::{Place, SMALL, SMALL_FRAMES, documented, frame_file, lasting, run};
use localshape::internals::{Shown, Spent, Tags, Timings};
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene};
use localshape::sim::Diagnostic;
use serde_json::Value;
use std::io::Read;

const HEADS: &str = "run,body,frame,time,kinetic,elastic,gravitational,momentum_x,momentum_y,momentum_z,angular_momentum_x,\
                     angular_momentum_y,angular_momentum_z,residual,turned_over,volume_ratio,shape_error,energy,work,global_rotations,broken,\
                     contact_force_x,contact_force_y,contact_force_z,contact_torque_x,contact_torque_y,contact_torque_z,\
                     hold_force_x,hold_force_y,hold_force_z,hold_torque_x,hold_torque_y,hold_torque_z,crossings,status";

/// The rows of a table without its headings.
fn rows(table: &str) -> Vec<Vec<&str>> {
    table.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

#[test]
fn diagnostics_of_each_run_and_frame() {
    let place = Place::with_small();
    let ran = place.run("simulate small.toml").good();
    for word in ["Two cubes", "7 frames", "output/small", "Local shape", "Mass-spring", "ok", "turned over"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "run.json"]);

    let table = place.read("output/small/diagnostics.csv");
    assert_eq!(table.lines().next(), Some(HEADS));
    let rows = rows(&table);
    assert_eq!(rows.len(), 2 * SMALL_FRAMES);
    assert_eq!((rows[0][0], rows[1][0]), ("Local shape", "Mass-spring"));
    // Twelve nodes of one kilogram at 2 m/s.
    assert_eq!(rows[0][4].parse::<f64>().unwrap(), 24.0);
    assert_eq!(rows[0][8].parse::<f64>().unwrap(), -24.0);
    // A model without rotations has no residual.
    assert!(rows.iter().all(|row| (row[13] == "nan") == (row[0] == "Mass-spring")), "{table}");
    let digits = |number: &str| number.chars().take_while(|&c| c != 'e').filter(char::is_ascii_digit).count();
    assert!(rows.iter().all(|row| digits(row[3]) == 17 && digits(row[4]) == 17), "{table}");
    assert!(rows.iter().all(|row| row.last() == Some(&"ok")));
    // The sum of all energies.
    let number = |text: &str| text.parse::<f64>().unwrap();
    let sum = |row: &[&str]| number(row[4]) + number(row[5]) + number(row[6]);
    assert!(rows.iter().all(|row| number(row[17]) == sum(row)), "{table}");
    assert!(rows.iter().any(|row| number(row[5]) > 0.0 && number(row[6]) > 0.0), "{table}");
}

/// Where springs break no velocity may solve a step of backward Euler.
#[test]
fn steps_that_are_not_solved_are_told() {
    let place = Place::new();
    let scene = "time = { duration = 1, step = 0.05, frames_per_second = 20, integrator = 'backward-euler' }
        body = { lattice = { cells = [3, 3, 3], side = 0.1 }, mass = 0.01, spin = { axis = [0, 0, 1], rate = 8 } }
        run = [{ name = 'torn', model = { kind = 'mass-spring', stiffness = 10, breaks_at = 0.1 } }]";
    place.write("torn.toml", scene);
    let ran = place.run("simulate torn.toml");
    assert_eq!(ran.status, Some(0), "{}", ran.err);
    let unsolved = place.json("output/torn/run.json")["runs"][0]["unsolved"].clone();
    let (steps, first) = (unsolved["steps"].as_u64().expect("steps"), unsolved["first"].as_f64().expect("a time"));
    assert!(steps > 0 && unsolved["residual"].as_f64().expect("a residual") > 1e-6, "{unsolved}");
    assert!(ran.out.contains(&format!("ok, {steps} step")) && ran.out.contains(" not solved"), "{}", ran.out);
    let line = "warning: “torn” has ";
    let [told] = ran.err.lines().filter(|told| told.starts_with(line)).collect::<Vec<_>>()[..] else {
        panic!("{}", ran.err)
    };
    assert!(told.contains(&format!(" first at {first} s, with a residual of up to ")), "{told}");
    assert!(told.ends_with("; take shorter steps"), "{told}");
    // A body at rest is solved.
    place.write("still.toml", &scene.replace("rate = 8", "rate = 0"));
    let ran = place.run("simulate still.toml").good();
    assert!(!ran.out.contains("not solved"), "{}", ran.out);
    assert!(place.json("output/still/run.json")["runs"][0].get("unsolved").is_none());
}

/// Springs that break are counted after the run, beside runs that do not break.
#[test]
fn what_is_broken_is_counted_if_something_breaks() {
    let place = Place::with_small();
    assert!(!place.run("simulate small.toml").good().out.contains("broken"));
    place.write("brittle.toml", &SMALL.replace("springs = \"edges", "breaks_at = 1e-3, springs = \"edges"));
    let ran = place.run("simulate brittle.toml").good();
    let line = |start: &str| ran.out.lines().find(|line| line.starts_with(start)).expect(start);
    assert!(line("  run ").contains("turned over  broken  shape error"), "{}", ran.out);
    let document: Value = serde_json::from_str(&place.read("output/brittle/run.json")).unwrap();
    let broken = document["runs"][1]["last"]["broken"].as_u64().expect("springs that break");
    assert!(broken > 0 && line("  Mass-spring ").contains(&format!("  {broken}  ")), "{}", ran.out);
    assert_eq!(line("  Local shape ").split("  ").filter(|cell| !cell.trim().is_empty()).count(), 4, "{}", ran.out);
}

/// Each number is in the column of its name.
#[test]
fn columns_are_what_their_heads_say() {
    let place = Place::with_small();
    place.run("simulate small.toml").good();
    let table = place.read("output/small/diagnostics.csv");
    let heads: Vec<_> = table.lines().next().unwrap().split(',').collect();
    let scene = Scene::load(&place.path("small.toml"), &Limits::default()).unwrap();
    let mut runner = Runner::new(&scene, &[0, 1]);
    let rows = rows(&table);
    for (number, row) in rows.iter().enumerate() {
        let frame = runner.frame(number as u64 / 2);
        let d = &frame.runs[number % 2].snapshot.diagnostics;
        let columns = [
            ("kinetic", d.kinetic),
            ("elastic", d.elastic),
            ("gravitational", d.gravitational),
            ("momentum_x", d.momentum.x),
            ("momentum_y", d.momentum.y),
            ("momentum_z", d.momentum.z),
            ("angular_momentum_x", d.angular_momentum.x),
            ("angular_momentum_y", d.angular_momentum.y),
            ("angular_momentum_z", d.angular_momentum.z),
            ("residual", d.residual),
            ("turned_over", d.turned_over as f64),
            ("volume_ratio", d.volume_ratio),
            ("shape_error", d.shape_error),
            ("global_rotations", d.global_rotations),
            ("broken", d.broken),
        ];
        for (name, number) in columns {
            let at = heads.iter().position(|head| *head == name).expect("a column");
            let written: f64 = row[at].parse().unwrap();
            assert!(written == number || written.is_nan() && number.is_nan(), "{name}: {written} for {number}");
        }
    }
}

/// A square stretched to 1.5 times its width, with results that can be computed by hand.
#[test]
fn volume_and_shape_of_a_square_pulled_wide() {
    let place = Place::new();
    let (head, tail) = SMALL.split_once("[body]").unwrap();
    let runs = &tail[tail.find("[[run]]").unwrap()..tail.find("[[obstacle]]").unwrap()];
    let body = "[body]\nnodes = [[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]]\nelements = [[0, 1, 2, 3]]\n\
                positions = [[0, 0], [0.3, 0], [0.3, 0.2], [0, 0.2]]\nmass = 1.0\n";
    place.write("wide.toml", &format!("{}{body}{runs}", head.replace("[0, -9.8, 0]", "[0, -9.8]")));
    place.run("simulate wide.toml --frames 0").good();
    let table = place.read("output/wide/diagnostics.csv");
    let heads: Vec<_> = table.lines().next().unwrap().split(',').collect();
    let run = place.json("output/wide/run.json");
    // Each node is a quarter of the extension away from its position in the best-fitting square.
    for (name, number) in [("volume_ratio", 1.5), ("shape_error", 0.05)] {
        let at = heads.iter().position(|head| *head == name).expect("a column");
        for row in rows(&table) {
            assert!((row[at].parse::<f64>().unwrap() - number).abs() < 1e-12, "{name}: {table}");
        }
        for run in run["runs"].as_array().unwrap() {
            assert!((run["last"][name].as_f64().unwrap() - number).abs() < 1e-12, "{name}: {run}");
        }
    }
}

#[test]
fn summary_of_what_was_run() {
    let place = Place::with_small();
    place.run("simulate small.toml --threads 1").good();
    let run = place.json("output/small/run.json");
    assert_eq!(run["localshape"], env!("CARGO_PKG_VERSION"));
    assert_eq!(run["scene"]["title"], "Two cubes");
    assert_eq!(run["scene"]["digest"].as_str().unwrap().len(), 64);
    assert_eq!(run["command"].as_array().unwrap().len(), 5);
    assert_eq!(run["command"][1], "simulate");
    assert_eq!(run["outcome"], "done");
    assert_eq!((run["frames"]["asked"].as_u64(), run["frames"]["recorded"].as_u64()), (Some(7), Some(7)));
    assert!(run["adapter"].is_null());
    assert_eq!((run["runs"][0]["name"].as_str(), run["runs"][0]["status"].as_str()), (Some("Local shape"), Some("ok")));
    assert_eq!(run["runs"][1]["last"]["frame"], 6);
    assert!(run["times"]["simulate"]["wall"].as_f64().unwrap() > 0.0);
    assert!(run["times"]["draw"].is_null());
}

/// Numbers have points and no separators in every language.
#[test]
fn the_same_in_any_language() {
    let place = Place::with_small();
    place.run("simulate small.toml -q -o C").good();
    for language in ["de_DE.UTF-8", "tr_TR.UTF-8"] {
        let mut command = place.command(["simulate", "small.toml", "-q", "-o", language]);
        run(command.env("LC_ALL", language).env("LANG", language)).good();
        assert_eq!(place.read(&format!("{language}/diagnostics.csv")), place.read("C/diagnostics.csv"), "{language}");
    }
}

/// The command line never changes a bit of the state.
#[test]
fn the_same_for_any_number_of_threads() {
    let place = Place::with_small();
    place.run("simulate small.toml -o one --threads 1 --states").good();
    place.run("simulate small.toml -o four --threads 4 --states").good();
    assert_eq!(place.read("one/diagnostics.csv"), place.read("four/diagnostics.csv"));
    let states = |folder: &str| std::fs::read(place.path(folder).join("states.npz")).unwrap();
    assert!(states("one") == states("four"), "states.npz differs");
}

#[test]
fn some_frames_of_one_run() {
    let place = Place::with_small();
    place.run("simulate small.toml -o all").good();
    place.run("simulate small.toml -o some --frames 1-5x2,6 --only Mass-spring").good();
    let (all, some) = (place.read("all/diagnostics.csv"), place.read("some/diagnostics.csv"));
    let wanted: Vec<_> = rows(&all)
        .into_iter()
        .filter(|row| row[0] == "Mass-spring" && ["1", "3", "5", "6"].contains(&row[2]))
        .collect();
    assert_eq!(wanted.len(), 4);
    assert_eq!(rows(&some), wanted);
}

/// Nothing else is simulated: neither other runs nor the time after the last frame.
#[test]
fn only_what_was_asked_for_is_simulated() {
    let place = Place::with_small();
    let runs = |options: &str| {
        place.run(&format!("simulate small.toml --overwrite{options}")).good();
        place.json("output/small/run.json")["runs"].as_array().unwrap().clone()
    };
    let whole = runs("");
    let steps = |run: &Value, frame: f64| (frame / 60.0 / run["time_step"].as_f64().unwrap()).round() as u64;
    for (options, names, last) in [
        ("", &["Local shape", "Mass-spring"][..], 6.0),
        (" --frames 0-2", &["Local shape", "Mass-spring"], 2.0),
        (" --frames 4,1 --only Mass-spring", &["Mass-spring"], 4.0),
        (" --frames 0", &["Local shape", "Mass-spring"], 0.0),
    ] {
        let runs = runs(options);
        assert_eq!(runs.iter().map(|run| run["name"].as_str().unwrap()).collect::<Vec<_>>(), names, "{options}");
        let simulated: Vec<_> = runs.iter().map(|run| run["steps"].as_u64().unwrap()).collect();
        assert_eq!(simulated, runs.iter().map(|run| steps(run, last)).collect::<Vec<_>>(), "{options}");
    }
    assert!(steps(&whole[0], 6.0) > 6, "more than one step to a frame");
}

#[test]
fn json_is_one_document() {
    let place = Place::with_small();
    place.write("other.toml", SMALL);
    let ran = place.run("simulate small.toml other.toml -o both --json").good();
    let document = ran.json();
    let scenes = document["scenes"].as_array().unwrap();
    assert_eq!(scenes.len(), 2);
    assert_eq!(scenes[1]["folder"].as_str().unwrap(), std::path::Path::new("both").join("other").to_str().unwrap());
    assert_eq!(scenes[0]["runs"][0]["status"], "ok");
    assert_eq!(place.names("both/small"), ["diagnostics.csv", "run.json"]);
    assert_eq!(place.names("both/other"), ["diagnostics.csv", "run.json"]);
}

/// Finished files are reported, and then the failure.
#[cfg(unix)]
#[test]
fn json_is_one_document_also_when_a_later_scene_fails() {
    let place = Place::with_small();
    place.write("other.toml", &lasting("300"));
    place.write("third.toml", SMALL);
    let arguments = "simulate small.toml other.toml third.toml -o out --json";
    let running = crate::cli::interrupt::start(&place, arguments, "out/other/run.json");
    // A folder in the place of a file fails early.
    place.write("out/other/diagnostics.csv/notes.txt", "mine");
    let ran = running.wait().bad(4, &["cannot write", "diagnostics.csv"]);
    let document = ran.json();
    let outcomes: Vec<_> = document["scenes"].as_array().unwrap().iter().map(|scene| &scene["outcome"]).collect();
    assert_eq!(outcomes, ["done", "failed"]);
    assert_eq!(document["scenes"][1]["files"], serde_json::json!([]));
    // The files on the disk are the same.
    assert_eq!(place.json("out/small/run.json")["outcome"], "done");
    assert_eq!(place.json("out/other/run.json")["outcome"], "failed");
    assert!(!place.path("out/third").exists());
}

#[test]
fn quiet_says_nothing() {
    let place = Place::with_small();
    assert_eq!(place.run("simulate small.toml --quiet").good().out, "");
}

#[test]
fn a_run_that_diverges_is_a_result() {
    let place = Place::new();
    // Far beyond the largest stable step.
    place.write("wild.toml", &SMALL.replace("step = \"T/50\"", "step = \"T/2\"").replace("0.1\n", "5.0\n"));
    let ran = place.run("simulate wild.toml").too_large_steps();
    assert!(ran.out.contains("diverged at"), "{}", ran.out);
    let run = &place.json("output/wild/run.json")["runs"][1];
    assert_eq!(run["status"], "diverged");
    assert!(run["time"].as_f64().unwrap() > 0.0 && run["step"].as_u64().unwrap() > 0, "{run}");
    assert!(run["time_step"].as_f64().unwrap() < 1.0, "{run}");
    assert!(place.read("output/wild/diagnostics.csv").trim_end().ends_with(",diverged"));
}

/// The paths of all values in a document: `runs[].last.time`.
fn ways(document: &Value, before: &str) -> Vec<String> {
    match document {
        Value::Object(table) if !table.is_empty() => {
            let dot = if before.is_empty() { "" } else { "." };
            table.iter().flat_map(|(key, value)| ways(value, &format!("{before}{dot}{key}"))).collect()
        }
        Value::Array(items) if items.iter().any(Value::is_object) => {
            items.iter().flat_map(|item| ways(item, &format!("{before}[]"))).collect()
        }
        _ => vec![before.to_owned()],
    }
}

/// The names of the text chunks of a picture.
fn chunks(picture: &[u8]) -> Vec<String> {
    let names = picture.windows(11).enumerate().filter(|(_, bytes)| bytes == b"localshape:");
    let name = |at: usize| picture[at..].split(|&byte| byte == 0).next().expect("a keyword").to_vec();
    names.map(|(at, _)| String::from_utf8(name(at)).expect("a keyword")).collect()
}

#[test]
fn everything_in_the_files_is_documented() {
    let place = Place::new();
    let own = "springs = \"edges+one-diagonal\" }\nstep = \"T/7\"";
    place.write("small.toml", &SMALL.replace("springs = \"edges+one-diagonal\" }", own));
    place.run("simulate small.toml --states").too_large_steps();
    let heads: Vec<_> = HEADS.split(',').collect();
    assert_eq!(documented("diagnostics.csv"), heads);
    // Each diagnostic has the same meaning on the page as in the table of the code.
    for &diagnostic in Diagnostic::ALL {
        let (unit, sentence) = (diagnostic.unit(), diagnostic.meaning().trim_end_matches('.'));
        let meaning = sentence.replace(&format!(" ({unit})"), "");
        assert_eq!(meaning != sentence, !unit.is_empty(), "the unit stands in brackets: {sentence}");
        let is_its = |head: &&&str| {
            head.strip_prefix(diagnostic.key()).is_some_and(|axis| ["", "_x", "_y", "_z"].contains(&axis))
        };
        let columns: Vec<_> = heads.iter().filter(is_its).map(|head| format!("`{head}`")).collect();
        let columns = columns.join(", ");
        let page = include_str!("../../docs/files.md");
        let row = page.lines().find_map(|line| line.strip_prefix(&format!("| {columns} | "))).expect("its row");
        let (told_unit, told) = row.split_once("| ").expect("a unit");
        assert_eq!(told_unit.trim(), unit, "{columns}");
        // Cells of the table begin with lower case.
        let is_name = meaning[1..].starts_with(char::is_uppercase);
        let first = if is_name { meaning[..1].to_owned() } else { meaning[..1].to_lowercase() };
        assert!(told.starts_with(&(first + &meaning[1..])), "{told} / {meaning}");
    }

    // Several bodies, which diverge and could break, have more arrays and keys.
    place.write(
        "bodies.toml",
        &crate::cli::bodies::of_their_own()
            .replace("step = 5e-4", "step = 0.05")
            .replace("= 0.1\n", "= 10.0\n")
            .replace("stiffness = 1e4 }", "stiffness = 1e4, breaks_at = 1e9 }"),
    );
    place.run("simulate bodies.toml --states").too_large_steps();
    let general = |name: &str| {
        let name = name.trim_end_matches(".npy");
        name.split_once('.').map_or(name.to_owned(), |(_, quantity)| format!("NAME.{quantity}"))
    };
    let arrays_of = |scene: &str| -> Vec<String> {
        let file = std::fs::File::open(place.path(format!("output/{scene}/states.npz"))).unwrap();
        let archive = zip::ZipArchive::new(file).unwrap();
        archive.file_names().map(|name| general(name.unwrap_or_default().as_ref())).collect()
    };
    let mut arrays = [arrays_of("small"), arrays_of("bodies")].concat();
    let mut told = documented("states.npz");
    told.sort();
    arrays.sort();
    arrays.dedup();
    assert_eq!(told, arrays);

    // A run that diverges has more keys, and so do pictures, and bodies that leave their panels.
    place.write("wild.toml", &SMALL.replace("step = \"T/50\"", "step = \"T/2\"").replace("0.1\n", "5.0\n"));
    place.run("simulate wild.toml").too_large_steps();
    let mut run = place.json("output/wild/run.json");
    let spent = Some(Spent::default());
    let times = Timings { compose: spent, draw: spent, encode: spent, ..Timings::default() };
    run["times"] = serde_json::to_value(times).unwrap();
    run["runs"][0]["cut"] = [3].into();
    run["runs"][0]["rest"] = serde_json::json!({ "residual": 1e-10, "evaluations": 100 });
    run["runs"][0]["comes_to_rest"] = serde_json::json!({ "frame": 3, "kinetic_energy": 0.1, "residual": 1e-4 });
    run["runs"][0]["unsolved"] = serde_json::json!({ "steps": 1, "first": 0.5, "residual": 0.1 });
    (run["frames"]["repeated"], run["frames"]["azimuth"]) = (1.into(), 0.5.into());
    (run["frames"]["kept"], run["set"]) = (1.into(), serde_json::json!(["time.duration=5"]));
    let of_bodies = place.json("output/bodies/run.json");
    let [mut found, mut told] = [[ways(&run, ""), ways(&of_bodies, "")].concat(), documented("run.json")];
    // All diagnostics have the same keys.
    for way in &mut found {
        for diagnostic in Diagnostic::ALL {
            *way = way.replace(&format!("st.{}.", diagnostic.key()), "st.KEY.");
        }
    }
    found.sort();
    found.dedup();
    told.sort();
    assert_eq!(told, found);

    let (text, states) = (String::new, vec![(String::new(), String::new())]);
    let shows = Shown::Frame { frame: 0, time: 0.0 };
    let tags = Tags { shows, scenes: vec![], states, version: text(), adapter: text() };
    assert_eq!(documented("frame_00000.png"), chunks(&frame_file([1, 1], &[0; 3], &tags)));
    let tags = Tags { shows: Shown::Figure(text()), ..tags };
    assert_eq!(documented("NAME.png"), chunks(&frame_file([1, 1], &[0; 3], &tags)));
    assert!(include_str!("../../README.md").contains("](docs/files.md)"));
}

/// One array of `states.npz`: its header and its numbers.
fn array(place: &Place, file: &str, name: &str) -> (String, Vec<f64>) {
    let (head, numbers) = raw(place, file, name);
    (head, numbers.into_iter().map(f64::from_le_bytes).collect())
}

/// An array of numbers with eight bytes each.
fn raw(place: &Place, file: &str, name: &str) -> (String, Vec<[u8; 8]>) {
    let file = std::fs::File::open(place.path(file)).expect("an archive");
    let mut archive = zip::ZipArchive::new(file).expect("a whole archive");
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).expect("the array").read_to_end(&mut bytes).expect("its bytes");
    let length = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let numbers = bytes[length..].chunks_exact(8).map(|number| number.try_into().unwrap());
    (String::from_utf8_lossy(&bytes[10..length]).trim_end().to_owned(), numbers.collect())
}

#[test]
fn states_of_every_frame() {
    let place = Place::with_small();
    place.run("simulate small.toml --states --frames 0,3-6").good();
    let file = "output/small/states.npz";
    let (head, time) = array(&place, file, "time");
    assert_eq!(head, "{'descr': '<f8', 'fortran_order': False, 'shape': (5,), }");
    let (head, position) = array(&place, file, "Local shape.position");
    assert_eq!(head, "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 12, 3), }");
    let (_, velocity) = array(&place, file, "Mass-spring.velocity");
    assert_eq!((time.len(), position.len(), velocity.len()), (5, 5 * 12 * 3, 5 * 12 * 3));
    assert_eq!((time[0], velocity[1]), (0.0, -2.0));
    // The times are those of the diagnostics, to the last bit.
    let table = place.read("output/small/diagnostics.csv");
    let times: Vec<f64> = rows(&table).iter().step_by(2).map(|row| row[3].parse().unwrap()).collect();
    assert_eq!(time, times);
    // The lowest nodes start on the floor.
    assert_eq!(position[..36].chunks(3).map(|node| node[1]).fold(f64::INFINITY, f64::min), 0.0);
}

/// The archive suffices to draw the body and has its masses.
#[test]
fn states_come_with_their_body() {
    let place = Place::with_small();
    place.run("simulate small.toml --states").good();
    let file = "output/small/states.npz";
    let (head, rest) = array(&place, file, "rest");
    assert_eq!(head, "{'descr': '<f8', 'fortran_order': False, 'shape': (12, 3), }");
    assert_eq!((&rest[..3], &rest[33..]), (&[-0.1, 0.0, -0.05][..], &[0.1, 0.1, 0.05][..]));
    let (head, mass) = array(&place, file, "mass");
    assert_eq!((head.as_str(), mass), ("{'descr': '<f8', 'fortran_order': False, 'shape': (12,), }", vec![1.0; 12]));
    let indices = |file: &str, name| {
        let (head, numbers) = raw(&place, file, name);
        (head, numbers.into_iter().map(i64::from_le_bytes).collect::<Vec<_>>())
    };
    let (head, elements) = indices(file, "elements");
    assert_eq!(head, "{'descr': '<i8', 'fortran_order': False, 'shape': (2, 8), }");
    assert_eq!(elements, [0, 1, 3, 4, 6, 7, 9, 10, 1, 2, 4, 5, 7, 8, 10, 11]);
    // Ten faces bound the two cubes; the one between them does not.
    let (head, faces) = indices(file, "faces");
    assert_eq!(head, "{'descr': '<i8', 'fortran_order': False, 'shape': (10, 4), }");
    let middle = [1, 4, 7, 10];
    assert!(faces.chunks(4).all(|face| !middle.iter().all(|node| face.contains(node))), "{faces:?}");
    let at = |node: i64, axis: usize| rest[3 * node as usize + axis];
    for face in faces.chunks(4) {
        // Counter-clockwise from outside: the normal points away from the centre of the body.
        let edge = |from: usize, axis: usize| at(face[from + 1], axis) - at(face[from], axis);
        let area = [0, 1, 2].map(|axis| {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            edge(0, a) * edge(1, b) - edge(0, b) * edge(1, a)
        });
        let from_middle: f64 = (0..3).map(|axis| area[axis] * (at(face[0], axis) - [0.0, 0.05, 0.0][axis])).sum();
        assert!(from_middle > 0.0, "{face:?}");
    }

    // Short rows end in -1; a body of bars has no faces.
    let other =
        SMALL.replace("lattice = { cells = [2, 1, 1], side = 0.1 }", "disc = { rings = 2, sectors = 3, radius = 0.1 }");
    let other = other.replace("[0, -9.8, 0]", "[0, -9.8]").replace("[0, -2, 0]", "[0, -2]");
    place.write("disc.toml", &other);
    place.write(
        "bars.toml",
        &other.replace("disc = { rings = 2, sectors = 3, radius", "bars = { count = 2, direction = [1, 0], length"),
    );
    place.run("simulate disc.toml bars.toml --states -o both").good();
    let (head, elements) = indices("both/disc/states.npz", "elements");
    assert_eq!(head, "{'descr': '<i8', 'fortran_order': False, 'shape': (6, 4), }");
    assert_eq!((&elements[..4], &elements[12..16]), (&[0, 1, 2, -1][..], &[1, 4, 5, 2][..]));
    assert_eq!(array(&place, "both/disc/states.npz", "rest").1.len(), 7 * 3);
    assert_eq!(indices("both/bars/states.npz", "elements").1, [0, 1, 1, 2]);
    let (head, faces) = indices("both/bars/states.npz", "faces");
    assert_eq!((head.as_str(), faces.len()), ("{'descr': '<i8', 'fortran_order': False, 'shape': (0, 3), }", 0));
    if let Some(python) = crate::cli::support::numpy() {
        let script = "import numpy; a = numpy.load('both/disc/states.npz'); print(a['elements'].shape, a['mass'].sum(), a['Local shape.position'].shape)";
        let output = python(place.path(".").as_path(), script);
        assert_eq!(output, "(6, 4) 7.0 (7, 7, 3)\n");
    }
}

#[test]
fn states_of_runs_with_odd_names() {
    let place = Place::new();
    place.write("odd.toml", &SMALL.replace("Local shape", "k: ½ 弾性"));
    let ran = place.run("simulate odd.toml --states");
    match cfg!(feature = "render") {
        true => ran.warned("no font has \"弾\" (U+5F3E) and \"性\" (U+6027)"),
        false => ran.good(),
    };
    array(&place, "output/odd/states.npz", "k: ½ 弾性.position");
    for name in ["../out", "line\\nbreak", ""] {
        place.write("odd.toml", &SMALL.replace("Local shape", name));
        place.run("simulate odd.toml --states").bad(2, &["odd.toml:14:8"]);
    }
}

/// A run with another time step has its own times.
#[test]
fn states_of_runs_with_steps_of_their_own() {
    let place = Place::new();
    let own = "springs = \"edges+one-diagonal\" }\nstep = \"T/7\"";
    place.write("own.toml", &SMALL.replace("springs = \"edges+one-diagonal\" }", own));
    place.run("simulate own.toml --states").too_large_steps();
    let file = "output/own/states.npz";
    let (head, times) = array(&place, file, "Mass-spring.time");
    assert_eq!(head, "{'descr': '<f8', 'fortran_order': False, 'shape': (7,), }");
    let table = place.read("output/own/diagnostics.csv");
    let recorded: Vec<f64> = rows(&table).iter().skip(1).step_by(2).map(|row| row[3].parse().unwrap()).collect();
    assert_eq!(times, recorded);
    assert_ne!(times, array(&place, file, "time").1);
    assert_eq!(array(&place, file, "Mass-spring.position").1.len(), 7 * 12 * 3);

    // Alone, it is the first run shown.
    place.run("simulate own.toml --states --only Mass-spring").too_large_steps();
    assert_eq!(array(&place, file, "time").1, recorded);
    let archive = zip::ZipArchive::new(std::fs::File::open(place.path(file)).unwrap()).unwrap();
    assert_eq!(archive.len(), 5 + 5, "it has no second time");
}

/// A cube falls on another, which is held.
const PAIR: &str = r#"
contact.rule = "nodes"
gravity = [0, -10, 0]
[time]
duration = 0.4
frames_per_second = 100
[[body]]
name = "cube"
lattice = { cells = [2, 2, 2], side = 0.1 }
lowest = 0.65
[[body]]
name = "block"
lattice = { cells = [2, 2, 2], side = 0.1 }
[[hold]]
body = "block"
nodes = "bottom"
[[run]]
name = "Together"
model = { kind = "shape-based", stiffness = 1e5, damping_ratio = 0.1 }
[[run]]
name = "Alone"
bodies = ["cube"]
model = { kind = "shape-based", stiffness = 1e5, damping_ratio = 0.1 }
"#;

/// The cube reaches the block after a fall of 0.45 m, in 0.3 s. The step is told, whatever frames are asked for.
#[test]
fn bodies_that_go_through_each_other_are_told_once() {
    let place = Place::new();
    place.write("pair.toml", PAIR);
    let all = "through each other";
    let told = |options: &str| {
        let ran = place.run(&format!("simulate pair.toml {options}"));
        assert_eq!(ran.status, Some(0), "{ran:?}");
        ran.err.lines().filter(|line| line.contains(all)).map(str::to_owned).collect::<Vec<_>>()
    };
    let usual = told("--overwrite");
    let [line] = &usual[..] else { panic!("{usual:?}") };
    let time = line.strip_prefix("warning: “cube” and “block” go through each other from ").expect(line);
    let (time, rest) = time.split_once(' ').expect("a time");
    assert_eq!(rest, "s on in “Together”: bodies do not collide");
    let time: f64 = time.parse().unwrap();
    assert!((0.3..0.3005).contains(&time), "{line}");
    for options in ["--frames 0,40", "--set time.frames_per_second=7.5", "--states", "--write vtu", "--only Together"] {
        assert_eq!(told(&format!("--overwrite {options}")), usual, "{options}");
    }
    for options in ["--quiet", "--frames 0-25"] {
        place.run(&format!("simulate pair.toml --overwrite {options}")).good();
    }
    // Bodies that overlap from the start are told of before.
    place.write("pair.toml", &PAIR.replace("lowest = 0.65", "lowest = 0.15"));
    let ran = place.run("simulate pair.toml --overwrite").err;
    assert_eq!(ran.lines().filter(|line| line.contains(all)).count(), 1, "{ran}");
    assert!(ran.contains("\"cube\" and \"block\" overlap at the start"), "{ran}");
}

/// Rows on request: each step has one, and the rows of frames are those of a scene without them.
#[test]
fn rows_between_frames() {
    let place = Place::with_small();
    place.write("rows.toml", &SMALL.replace("frames_per_second", "every = 1e-6\nframes_per_second"));
    place.run("simulate small.toml rows.toml -o out").good();
    let rows = |scene: &str| -> Vec<Vec<String>> {
        let text = place.read(&format!("out/{scene}/diagnostics.csv"));
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let (frames, all) = (rows("small"), rows("rows"));
    let of_frames: Vec<_> = all.iter().filter(|row| !row[2].is_empty()).cloned().collect();
    assert_eq!(of_frames, frames);
    let run = place.json("out/rows/run.json")["runs"].clone();
    for (at, name) in ["Local shape", "Mass-spring"].into_iter().enumerate() {
        let own: Vec<_> = all.iter().filter(|row| row[0] == name).collect();
        let number = |row: &[String], column: usize| row[column].parse::<f64>().expect("a number");
        let step = number(own[1], 3);
        assert_eq!(own.len() as u64, 1 + run[at]["steps"].as_u64().expect("a count"), "each step once");
        assert!(own.iter().enumerate().all(|(number_of, row)| number(row, 3) == number_of as f64 * step));
        // The column of the elastic energy, which frames miss.
        let elastic =
            |rows: &[&Vec<String>]| rows.iter().map(|row| [number(row, 5), number(row, 3)]).collect::<Vec<_>>();
        let most = elastic(&own).into_iter().reduce(|a, b| if b[0] > a[0] { b } else { a }).expect("rows");
        let told = ["value", "time"].map(|key| run[at]["greatest"]["elastic"][key].as_f64().expect("a number"));
        assert_eq!(told, most);
        let of_frames: Vec<_> = own.iter().copied().filter(|row| !row[2].is_empty()).collect();
        let most_of_frames = elastic(&of_frames).into_iter().map(|[value, _]| value).fold(0.0, f64::max);
        assert!(most_of_frames < most[0], "{most_of_frames} {most:?}");
        let told = place.json("out/small/run.json")["runs"][at]["greatest"]["elastic"]["value"].as_f64();
        assert_eq!(told, Some(most_of_frames), "without rows between frames, it is that of frames");
    }
    place.write("rows.toml", &SMALL.replace("frames_per_second", "every = 0.004\nframes_per_second"));
    place.run("simulate rows.toml --frames 2-4 -o part").good();
    let text = place.read("part/diagnostics.csv");
    let times: Vec<f64> = text
        .lines()
        .filter(|line| line.starts_with("Local"))
        .map(|line| line.split(',').nth(3).and_then(|time| time.parse().ok()).expect("a time"))
        .collect();
    let step = run[0]["time_step"].as_f64().expect("a step");
    // Frames at 2/60, 3/60 and 4/60 s.
    let near = [2.0 / 60.0, 0.036, 0.04, 0.044, 0.048, 3.0 / 60.0, 0.052, 0.056, 0.06, 0.064, 4.0 / 60.0];
    assert!(
        times.len() == near.len() && times.iter().zip(near).all(|(time, near)| (time - near).abs() <= 0.5001 * step)
    );
    // Two runs of one body, with a row for each step of 1 ms at most.
    let long = |every: &str| {
        let rows = SMALL.replace("step = \"T/50\"", &format!("step = 1e-3\nevery = {every}"));
        rows.replace("duration = 0.1", "duration = 1000")
    };
    for every in ["1e-8", "1.999e-3"] {
        place.write("rows.toml", &long(every));
        let ran = place.run("check rows.toml").bad(
            2,
            &[
                "rows.toml:7:9: ",
                "rows of all runs and bodies; the most is 1 000 000",
                "write every = 2.000e-3 or more",
            ],
        );
        assert_eq!(ran.err.contains("make 2.000e6 rows"), every == "1e-8", "{}", ran.err);
    }
    place.write("rows.toml", &long("2e-3"));
    assert_ne!(place.run("check rows.toml").status, Some(2));
}

/// Rows of each of several bodies, up to the last finite state of a run that diverges.
#[test]
fn rows_between_frames_of_bodies_that_diverge() {
    let place = Place::new();
    // The cube diverges between the first frame and the second.
    let scene = crate::cli::bodies::of_their_own().replace("step = 5e-4", "step = 0.02\nevery = 0.02");
    place.write("bodies.toml", &scene.replace("= 0.1\nstep", "= 1.0\nstep").replace("= 60\n", "= 10\n"));
    place.run("simulate bodies.toml -o out").too_large_steps();
    let text = place.read("out/diagnostics.csv");
    let runs = place.json("out/run.json")["runs"].clone();
    let run = &runs[0];
    assert_eq!((&run["status"], run["bodies"].as_array().map(Vec::len)), (&"diverged".into(), Some(2)));
    let end = run["time"].as_f64().expect("a time");
    let rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[0] == "all");
    let (own, of_frames): (Vec<_>, Vec<_>) = rows.partition(|row| row[2].is_empty());
    assert!(own.len() > 9 && own.iter().all(|row| row.last() == Some(&"ok")));
    assert!(own.iter().all(|row| row[3].parse::<f64>().expect("a time") < end));
    let bodies: std::collections::BTreeSet<_> = own.iter().map(|row| row[1]).collect();
    assert_eq!(bodies, ["all", "ball", "cube"].into());
    // The last finite state has the greatest energy. Later frames show it again.
    let most = ["value", "time"].map(|key| run["greatest"]["kinetic"][key].as_f64().expect("a number"));
    let of_all = of_frames.iter().rfind(|row| row[1] == "all").expect("frames");
    assert_eq!(most[0], of_all[4].parse::<f64>().expect("a number"));
    assert!((most[1] - (end - 0.02)).abs() < 1e-9, "{most:?}");
}

/// With a chart of contact, the forces on each body are the change of its momentum but for gravity, whoever exerts them.
#[test]
fn forces_of_contact_are_columns() {
    let place = Place::new();
    let scene = |charts: &str| {
        format!(
            "gravity = [0, -9.8, 0]\ntime = {{ duration = 0.2, frames_per_second = 20, every = 0.025, step = 0.001 }}\n\
             view.charts = [{charts}]\n\
             body = [{{ name = 'low', lattice = {{ cells = [2, 1, 2], side = 0.1 }}, density = 300.0, lowest = 0.004 }},\n\
             {{ name = 'high', lattice = {{ cells = [2, 1, 2], side = 0.1 }}, density = 300.0, lowest = 0.12, offset = [0.03, 0, 0] }}]\n\
             run = [{{ name = 'soft', model = {{ kind = 'shape-based', stiffness = 3e3 }} }}]\n\
             obstacle = [{{ kind = 'floor', name = 'ground' }}, {{ kind = 'sphere', centre = [5, 0, 0], radius = 0.1 }}]\n"
        )
    };
    place.write("told.toml", &scene("'contact_force'"));
    place.write("untold.toml", &scene(""));
    place.run("simulate told.toml -q").good();
    place.run("simulate untold.toml -q").good();
    let (told, untold) = (place.read("output/told/diagnostics.csv"), place.read("output/untold/diagnostics.csv"));
    let heads: Vec<_> = told.lines().next().unwrap().split(',').collect();
    let at = |name: &str| heads.iter().position(|head| *head == name).unwrap_or_else(|| panic!("{name} in {heads:?}"));
    let first = at("contact_force_x");
    let (rows, plain) = (rows(&told), rows(&untold));
    assert_eq!(rows.len(), plain.len());
    assert!(rows.iter().zip(&plain).all(|(told, untold)| told[..first] == untold[..first]), "the same motion");
    let unknown = [["nan"; 12].as_slice(), &["0.0000000000000000e0", "ok"]].concat();
    assert!(plain.iter().all(|row| row[first..] == unknown), "{:?}", plain[0]);
    let number = |row: &[&str], name: &str| row[at(name)].parse::<f64>().unwrap();
    let mut most: f64 = 0.0;
    for body in ["low", "high", "all"] {
        let own: Vec<_> = rows.iter().filter(|row| row[1] == body).collect();
        assert!(number(own[0], "contact_force_y").is_nan() && number(own[0], "force of ground_y").is_nan());
        let mass = if body == "all" { 2.4 } else { 1.2 };
        for two in own.windows(2) {
            let time = number(two[1], "time") - number(two[0], "time");
            let change = (number(two[1], "momentum_y") - number(two[0], "momentum_y")) / time + 9.8 * mass;
            let whole = number(two[1], "contact_force_y");
            let of = |name: &str| number(two[1], &format!("force of {name}_y"));
            assert!((change - whole).abs() < 1e-9 && (0.024..0.026).contains(&time), "{body}: {change} {whole}");
            let by_each = of("ground") + of("obstacle[1]") + of("low") + of("high");
            assert!((by_each - whole).abs() < 1e-9, "{body}: {by_each} {whole}");
            assert_eq!(number(two[1], "crossings"), 0.0);
            most = most.max(of("low"));
        }
    }
    assert!(most > 5.0, "they met: {most}");
    let peak = &place.json("output/told/run.json")["runs"][0]["greatest"]["force of low on high"]["value"];
    assert!(peak.as_f64().expect("a peak of the pair") >= most, "{peak}");
}

/// A hold carries weight and load once the body rests, and energy without work is what damping has taken.
#[test]
fn forces_of_holds_are_columns() {
    let place = Place::new();
    place.write(
        "held.toml",
        "gravity = [0, -9.8, 0]\ntime = { duration = 3, frames_per_second = 10, step = 0.001 }\nview.charts = ['hold_force', 'work']\n\
         body = { lattice = { cells = [2, 1, 1], side = 0.1 }, density = 1000.0 }\n\
         hold = [{ nodes = 'left' }]\ngrab = [{ nodes = [2], path.keys = [{ time = 0.1 }, { time = 0.3 }] }]\n\
         load = [{ faces = 'right', force = [3, 0, 1], ramp = 0.5 }]\n\
         probe = [{ name = 'end', nodes = 'right' }]\n\
         run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.5 } }]\n",
    );
    place.run("simulate held.toml -q").good();
    let table = place.read("output/held/diagnostics.csv");
    let heads: Vec<_> = table.lines().next().unwrap().split(',').collect();
    let last = rows(&table).pop().expect("rows");
    let number = |name: &str| last[heads.iter().position(|head| *head == name).expect(name)].parse::<f64>().unwrap();
    for (axis, expected) in [("x", -3.0), ("y", 19.6), ("z", -1.0)] {
        let [whole, of_hold] = ["hold_force", "force of hold[0]"].map(|name| number(&format!("{name}_{axis}")));
        assert!((whole - expected).abs() < 1e-4 && whole == of_hold, "{axis}: {whole} {of_hold}");
        assert_eq!(number(&format!("force of grab[0]_{axis}")), 0.0, "released");
        assert!(number(&format!("contact_force_{axis}")).is_nan());
    }
    assert!(number("work") > 0.0 && number("energy") < number("work") + 19.6 * 0.1);
    // The end hangs below, and `run.json` has the peaks of all of these.
    let [least, mean, most] = ["least", "mean", "greatest"].map(|key| number(&format!("displacement of end_{key}")));
    assert!(0.0 < least && least <= mean && mean <= most && number("displacement of end_y") < -0.5 * mean);
    let summary: Value = serde_json::from_str(&place.read("output/held/run.json")).expect("JSON");
    let peak = |which: &str, key: &str| summary["runs"][0][which][key]["value"].as_f64().expect(key);
    let force =
        ["x", "y", "z"].map(|axis| number(&format!("force of hold[0]_{axis}")).powi(2)).iter().sum::<f64>().sqrt();
    assert!(peak("greatest", "force of hold[0]") >= force && peak("least", "force of hold[0]") <= force);
    assert!(peak("greatest", "displacement of end_mean") >= mean && peak("least", "displacement of end_least") == 0.0);
}

/// Features that pass each other sideways in a long step cross; the first frame in which they do is told.
#[test]
fn surfaces_that_cross_are_told() {
    let place = Place::new();
    place.write(
        "fast.toml",
        "time = { duration = 0.1, step = 0.004, frames_per_second = 250 }\n\
         body = [\n\
         { name = 'left', lattice = { cells = [3, 3, 3], side = 0.1, elements = 'tetrahedra' }, velocity = [10, 0, 0],\n\
         rotation = { axis = [2, 0.2, -1.3], angle = 0.9 }, offset = [-0.35, 0, 0] },\n\
         { name = 'right', lattice = { cells = [3, 3, 3], side = 0.1, elements = 'tetrahedra' }, velocity = [-10, 0, 0],\n\
         rotation = { axis = [0, -0.9, 1.5], angle = 1.4 }, offset = [0.35, 0.004, 0.02] }]\n\
         run = [{ name = 'soft', model = { kind = 'shape-based', young = 2e4, damping = 2.108, damping_of = 'deformation' } }]\n",
    );
    let output = place.run("simulate fast.toml");
    let (status, told) = (output.status, output.err);
    assert_eq!(status, Some(0), "{told}");
    let expected = "in “soft”, of “left” and “right” (";
    assert!(told.contains(expected) && told.contains("take a shorter step, such as 0.002 s"), "{told}");
    assert_eq!(told.matches("surfaces cross or lie in each other at").count(), 1, "{told}");
    let of = |step: &str| {
        let output = place.run(&format!("simulate fast.toml --set time.step={step} --overwrite -q"));
        assert_eq!(output.status, Some(0), "{output:?}");
        let table = place.read("output/fast/diagnostics.csv");
        let at = table.lines().next().unwrap().split(',').position(|head| head == "crossings").expect("a column");
        rows(&table).iter().map(|row| row[at].parse::<f64>().unwrap()).fold(0.0, f64::max)
    };
    assert!(of("0.004") > 0.0 && of("0.0005") == 0.0);
}
