//! The program as its users see it: files, messages and exit statuses.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Two cubes on a floor with two runs; quick.
const SMALL: &str = r#"
title = "Two cubes"
gravity = [0, -9.8, 0]
[time]
duration = 0.1
step = "T/50"
[body]
lattice = { cells = [2, 1, 1], side = 0.1 }
lowest = 0.0
velocity = [0, -2, 0]
[[run]]
name = "Local shape"
model = { kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1 }
[[run]]
name = "Mass-spring"
model = { kind = "mass-spring", stiffness = 1e4, damping_ratio = 0.1, springs = "edges+one-diagonal" }
[[obstacle]]
kind = "floor"
restitution = 0.5
friction = 0.3
"#;

/// A folder for running the program.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("a folder for the test"));
        place.write("small.toml", SMALL);
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, contents: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("below the place")).expect("a folder");
        fs::write(path, contents).expect("a file");
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names in a folder, including hidden ones, sorted.
    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_localshape-study"));
        command.current_dir(self.0.path()).args(arguments.split(' ')).stdin(Stdio::null());
        // Independent of the user's settings.
        for name in ["CLICOLOR", "CLICOLOR_FORCE", "NO_COLOR", "COLUMNS"] {
            command.env_remove(name);
        }
        command
    }

    fn output(&self, arguments: &str) -> Output {
        self.command(arguments).output().expect("the program runs")
    }

    /// Runs it to its end, and returns its output.
    #[track_caller]
    fn good(&self, arguments: &str) -> String {
        let output = self.output(arguments);
        assert!(output.status.success(), "{arguments}: {output:?}");
        String::from_utf8(output.stdout).expect("a text")
    }

    /// Runs it to its failure with a status and a message that has these words.
    #[track_caller]
    fn bad(&self, arguments: &str, status: i32, words: &[&str]) {
        let output = self.output(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{arguments}: {message}");
        assert!(words.iter().all(|word| message.contains(word)), "{arguments}: {message}");
        assert!(output.stdout.is_empty(), "{output:?}");
    }
}

/// Reports a skipped test on standard error directly: `cargo test` captures the output of macros.
fn skipped(why: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "SKIPPED {}: {why}", std::thread::current().name().unwrap_or("a test"));
}

#[test]
fn help_and_version_are_results() {
    let place = Place::new();
    let help = place.good("--help");
    let studies = [
        "rotation",
        "work-precision",
        "stability",
        "stress",
        "beam",
        "patch",
        "cook",
        "load",
        "contact",
        "beam-time",
        "table1",
        "ratio",
    ];
    for word in studies.iter().chain(&["Exit status:", "130", "Examples:"]) {
        assert!(help.contains(word), "{word}");
    }
    assert_eq!(place.good("--version"), format!("localshape-study {}\n", env!("CARGO_PKG_VERSION")));
    for study in studies {
        place.good(&format!("{study} --help"));
    }
}

#[test]
fn wrong_words() {
    let place = Place::new();
    place.bad("rotations", 2, &["rotations", "'rotation'"]);
    place.bad("rotation --json --quiet", 2, &["--json", "--quiet"]);
    place.bad("work-precision --only a", 2, &["--only", "<SCENE>"]);
    place.bad("work-precision small.toml --only nobody", 2, &["--only", "nobody", "“Mass-spring”"]);
    place.bad("work-precision smal.toml", 2, &["smal.toml"]);
    place.bad("tabel1", 2, &["tabel1", "'table1'"]);
    place.bad("table1 --orientations 0", 2, &["--orientations", "1..=10000"]);
    place.bad("ratio --threads 0", 2, &["--threads"]);
    place.write("still.toml", &SMALL.replace("duration = 0.1", "duration = 0"));
    place.bad("stability still.toml", 2, &["`time.duration` is 0"]);
    place.write("wrong.toml", &SMALL.replace("shape-based", "shape-baste"));
    place.bad("stability wrong.toml", 2, &["wrong.toml:", "shape-baste", "shape-based"]);
    let adaptive =
        SMALL.replace("[[run]]\n", "[[run]]\nintegrator = \"dormand-prince\"\n").replace("step = \"T/50\"\n", "");
    place.write("adaptive.toml", &adaptive);
    place.bad("stability adaptive.toml", 2, &["choose their own steps, so there is nothing to map"]);
    let bodies = SMALL.replace("[body]", "[[body]]\nname = \"one\"").replace(
        "[[run]]\nname = \"Local",
        "[[body]]\nname = \"other\"\nlattice = { cells = [1, 1, 1], side = 0.1 }\noffset = [9, 0, 0]\n[[run]]\nname = \"Local",
    );
    place.write("bodies.toml", &bodies);
    for study in ["stability", "work-precision"] {
        let words = ["bodies.toml: “Local shape” has 2 bodies with models", "give each run one body"];
        place.bad(&format!("{study} bodies.toml"), 2, &words);
    }
    let names = ["adaptive.toml", "bodies.toml", "small.toml", "still.toml", "wrong.toml"];
    assert_eq!(place.names("."), names);
}

#[test]
fn maps_the_stability_of_a_scene() {
    let place = Place::new();
    let command = "stability small.toml -o maps";
    let out = place.good(command);
    assert!(out.starts_with("<!-- localshape-study stability small.toml -->\n"), "{out}");
    assert!(out.starts_with(&place.read("maps/stability.md")) && out.contains("In maps: stability.md, stability.csv"));
    let table = place.read("maps/stability.csv");
    // Two runs, thirteen stiffnesses and twelve steps.
    assert_eq!(table.lines().count(), 1 + 2 * 13 * 12);
    let diverged = table.lines().filter(|line| line.contains(",diverged,"));
    let shares: Vec<f64> = diverged.map(|line| line.split(',').nth(6).unwrap().parse().unwrap()).collect();
    assert!(!shares.is_empty() && shares.iter().all(|&share| share > 1.0), "{shares:?}");
    assert_eq!(place.names("maps"), ["stability.csv", "stability.md", "stability.png", "stability.svg"]);
    place.good(&format!("{command} --threads 1"));
    assert_eq!(place.read("maps/stability.csv"), table, "for any number of threads");
    place.bad(&format!("{command} --full"), 2, &["maps", "stability small.toml"]);
}

/// The command in the Markdown file can be pasted into a shell.
#[test]
fn commands_are_quoted() {
    let place = Place::new();
    place.write("my scenes/it's.toml", &SMALL.replace("0.1\nstep", "0.02\nstep").replace("Mass-spring", "$HOME"));
    let mut command = place.command("work-precision --only $HOME -o out -q");
    let ran = command.arg("my scenes/it's.toml").output().expect("the program runs");
    assert!(ran.status.success(), "{ran:?}");
    let mark = "<!-- localshape-study work-precision 'my scenes/it'\\''s.toml' --only '$HOME' -->\n";
    assert!(place.read("out/work-precision.md").starts_with(mark), "{}", place.read("out/work-precision.md"));
}

/// One start of Table 1: a second or two.
#[test]
fn table1_is_the_same_for_any_number_of_threads() {
    let place = Place::new();
    let out = place.good("table1 --orientations 1 --threads 1");
    assert_eq!(place.good("table1 --orientations 1 --threads 2 -o two --quiet"), "");
    let files = ["table1-orientations.csv", "table1.csv", "table1.md", "table1.png", "table1.svg"];
    for folder in ["output/study-table1", "two"] {
        assert_eq!(place.names(folder), files);
    }
    for file in files {
        let bytes = |folder: &str| fs::read(place.path(folder).join(file)).expect("a file");
        assert!(bytes("output/study-table1") == bytes("two"), "{file}");
    }
    assert!(out.starts_with(&place.read("two/table1.md")));
    let records = |file: &str| -> Vec<csv::StringRecord> {
        let text = place.read(file);
        csv::Reader::from_reader(text.as_bytes()).records().map(|row| row.expect("a whole row")).collect()
    };
    let (summary, courses) = (records("two/table1.csv"), records("two/table1-orientations.csv"));
    assert_eq!((summary.len(), courses.len()), (18, 18));
    // Medians over one start are its values.
    for (summary, course) in summary.iter().zip(&courses) {
        assert_eq!([&summary[9], &summary[12], &summary[13]], [&course[11], &course[12], &course[13]]);
        assert_eq!(&course[14], "ok");
        let (evaluations, step) = (course[10].parse::<f64>().unwrap(), course[4].parse::<f64>().unwrap());
        assert!((evaluations * step - 10.0).abs() <= step, "ten seconds");
    }
}

#[test]
fn files_of_others_and_of_another_choice_are_refused_unless_told() {
    let place = Place::new();
    place.write("out/table1.csv", "mine");
    let words = ["out holds table1.csv", "not written by localshape-study", "--overwrite"];
    place.bad("table1 -o out", 2, &words);
    place.write("other/table1.md", "mine");
    place.bad("table1 -o other --orientations 1", 2, &["table1.md", "not written by localshape-study"]);
    place.good("table1 -o out --orientations 1 --overwrite");
    let before = place.read("out/table1.csv");
    place.bad("table1 -o out", 2, &["out holds", "table1 --orientations 1`", "--overwrite"]);
    assert_eq!(place.read("out/table1.csv"), before);
    let document = place.good("table1 -o out --orientations 1 --json");
    let document: serde_json::Value = serde_json::from_str(&document).expect("one document");
    assert_eq!(place.read("out/table1.csv"), before);
    assert_eq!((document["study"].as_str(), document["folder"].as_str()), (Some("table1"), Some("out")));
    assert_eq!(document["files"].as_array().unwrap().len(), place.names("out").len());
    let first = &document["tables"]["table1"][0];
    assert_eq!(first["paper_mean"], 4.52554);
    assert!(first["mean_median"].as_f64().unwrap() > 0.1);
}

#[test]
fn folders_that_cannot_be_written_to_are_told_before_anything_is_measured() {
    let place = Place::new();
    place.write("taken", "a file");
    for folder in ["taken", "taken/below"] {
        let message = "error: taken is a file, not a folder; choose another folder with -o\n";
        place.bad(&format!("ratio -o {folder}"), 4, &[message]);
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        place.write("locked/notes.txt", "mine");
        fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o555)).unwrap();
        if fs::write(place.path("locked/probe"), "").is_ok() {
            return skipped("this user may write anywhere; the test needs one who may not");
        }
        place.bad("ratio -o locked", 4, &["cannot write locked", "ermission denied"]);
        assert_eq!(place.names("locked"), ["notes.txt"]);
        fs::set_permissions(place.path("locked"), PermissionsExt::from_mode(0o755)).unwrap();
    }
}

/// An interrupted measurement writes nothing.
#[cfg(unix)]
#[test]
fn interrupted() {
    let place = Place::new();
    for study in ["table1 --orientations 10000", "ratio"] {
        let folder = format!("out-{}", study.len());
        let mut command = place.command(&format!("{study} -o {folder}"));
        let mut running = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        // It listens before it makes its folder.
        let begun = Instant::now();
        while !place.path(&folder).exists() {
            assert!(begun.elapsed() < Duration::from_secs(300), "it does not begin");
            std::thread::sleep(Duration::from_millis(2));
        }
        // Not Ctrl-C, which a program in the background may ignore. By the shell: a bare system has no program `kill`.
        let kill = format!("kill -s TERM {}", running.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
        let begun = Instant::now();
        while running.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < Duration::from_secs(300), "it goes on");
            std::thread::sleep(Duration::from_millis(2));
        }
        let output = running.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{output:?}");
        assert!(output.stdout.starts_with(b"interrupted; "), "{output:?}");
        assert_eq!(place.names(&folder), [""; 0]);
    }
}
