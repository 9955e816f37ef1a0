//! A folder to run the program in, and its output.

use localshape::internals::{Compression, Shown, Tags, encode, skipped};
use serde_json::Value;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Two cubes on a floor with two runs and seven frames; quick, and small when drawn.
pub(crate) const SMALL: &str = r#"
title = "Two cubes"
gravity = [0, -9.8, 0]
[time]
duration = 0.1
step = "T/50"
frames_per_second = 60
[body]
lattice = { cells = [2, 1, 1], side = 0.1 }
mass = 1.0
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
[view]
size = [96, 64]
"#;

/// The metadata of a frame of a scene with one run, drawn by a fictitious adapter.
pub(crate) fn frame_tags(frame: u64, time: f64) -> Tags {
    Tags {
        shows: Shown::Frame { frame, time },
        scenes: vec!["5c".repeat(32)],
        states: vec![("ab".repeat(32), "Local shape".to_owned())],
        version: "0.1.0".to_owned(),
        adapter: "none".to_owned(),
    }
}

/// A picture as `render` writes it.
pub(crate) fn frame_file(size: [u32; 2], pixels: &[u8], tags: &Tags) -> Vec<u8> {
    encode(size, pixels, &tags.texts(), Compression::Fast)
}

/// The number of frames of [`SMALL`].
pub(crate) const SMALL_FRAMES: usize = 7;

/// [`SMALL`] with another duration (s), which makes it another scene. Its camera is fixed, so that it is not simulated
/// ahead.
pub(crate) fn lasting(duration: &str) -> String {
    SMALL.replace("duration = 0.1", &format!("duration = {duration}")).replace("[view]", "[view]\ncamera.distance = 2")
}

/// A disc in the plane that falls on a floor for some time (s), with a chart of its energy.
#[cfg(feature = "render")]
pub(crate) fn disc(duration: &str) -> String {
    format!(
        "title = \"A disc\"\ngravity = [0, -9.8]\ntime = {{ duration = {duration}, every = 0.004 }}\n\
         body = {{ fan = {{ sides = 6, radius = 0.1 }}, lowest = 0.05, velocity = [0, -2] }}\n\
         obstacle = [{{ kind = \"floor\", restitution = 0.9 }}]\n\
         [[run]]\nname = \"Local shape\"\nmodel = {{ kind = \"shape-based\", stiffness = 1e4 }}\n\
         [view]\nsize = [160, 120]\ncharts = [\"kinetic\"]\n"
    )
}

/// A folder for running the program; removed when dropped.
pub(crate) struct Place(TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for the test"))
    }

    /// A place with `small.toml`.
    pub(crate) fn with_small() -> Self {
        let place = Self::new();
        place.write("small.toml", SMALL);
        place
    }

    pub(crate) fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: &(impl AsRef<[u8]> + ?Sized)) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("below the place")).expect("a folder");
        fs::write(path, contents).expect("a file");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("a JSON document")
    }

    /// The names in a folder, including hidden ones, sorted.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
        let mut names: Vec<_> =
            entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a plain name")).collect();
        names.sort();
        names
    }

    /// The program with arguments, not yet started.
    pub(crate) fn command<S: AsRef<OsStr>>(&self, arguments: impl IntoIterator<Item = S>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
        command.current_dir(self.0.path()).args(arguments).stdin(Stdio::null());
        // Independent of the user's settings.
        for name in ["CLICOLOR", "CLICOLOR_FORCE", "NO_COLOR", "COLUMNS"] {
            command.env_remove(name);
        }
        command
    }

    /// The command line with these arguments, as messages show it.
    pub(crate) fn shown(&self, arguments: &str) -> String {
        format!("{} {arguments}", env!("CARGO_BIN_EXE_localshape"))
    }

    /// Runs the program with arguments, written with spaces between.
    pub(crate) fn run(&self, arguments: &str) -> Ran {
        run(&mut self.command(arguments.split(' ')))
    }
}

/// Timeout of the program, for a slow and busy machine.
const PATIENCE: Duration = Duration::from_secs(300);

/// Runs a command to its end.
pub(crate) fn run(command: &mut Command) -> Ran {
    Running::start(command).wait()
}

/// A running command, which is killed at the end of the test, also after a panic.
pub(crate) struct Running {
    child: Child,
    out: File,
    err: File,
}

impl Running {
    /// Starts a command. Its output goes to files, so it never blocks on a full pipe.
    #[track_caller]
    pub(crate) fn start(command: &mut Command) -> Self {
        let out = tempfile::tempfile().expect("a file");
        let mut running = Self::start_into(command, out.try_clone().expect("the same file"));
        running.out = out;
        running
    }

    /// Starts a command with another standard output.
    #[track_caller]
    pub(crate) fn start_into(command: &mut Command, out: impl Into<Stdio>) -> Self {
        let err = tempfile::tempfile().expect("a file");
        let into = err.try_clone().expect("the same file");
        let child = command.stdout(out).stderr(into).spawn().expect("the program starts");
        // The command keeps its end of a pipe open, and a reader may wait for it to be closed.
        command.stdout(Stdio::null());
        Self { child, out: tempfile::tempfile().expect("a file"), err }
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    pub(crate) fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("a child of this process").is_none()
    }

    /// Kills it.
    pub(crate) fn kill(&mut self) {
        self.child.kill().expect("a child of this process");
        self.child.wait().expect("a child of this process");
    }

    /// Waits for a condition.
    #[track_caller]
    pub(crate) fn until(&mut self, what: &str, mut is_so: impl FnMut(&mut Self) -> bool) {
        let started = Instant::now();
        while !is_so(self) {
            assert!(started.elapsed() < PATIENCE, "{what}: not within {PATIENCE:?}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Waits for its end.
    #[track_caller]
    pub(crate) fn wait(mut self) -> Ran {
        self.until("the end of a command", |running| !running.is_running());
        let status = self.child.wait().expect("a child of this process").code();
        let text = |file: &mut File| {
            let mut text = String::new();
            file.rewind().and_then(|()| file.read_to_string(&mut text)).expect("text in UTF-8");
            text
        };
        Ran { status, out: text(&mut self.out), err: text(&mut self.err) }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // If it has ended already, this does nothing.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The outputs of a run of the program.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Ran {
    /// Expects success and empty standard error.
    #[track_caller]
    pub(crate) fn good(self) -> Self {
        assert_eq!((self.status, self.err.as_str()), (Some(0), ""), "{self:?}");
        self
    }

    /// Expects success, and on standard error only warnings, of which one says something.
    #[track_caller]
    pub(crate) fn warned(self, of: &str) -> Self {
        let is_told = self.err.starts_with("warning: ") && self.err.contains(of);
        assert!(self.status == Some(0) && is_told && !self.err.contains("error"), "{self:?}");
        self
    }

    /// Expects success, and warnings of steps that are too large.
    #[track_caller]
    pub(crate) fn too_large_steps(self) -> Self {
        self.warned("of the largest that is stable at rest")
    }

    /// Expects an exit status and one error message that contains all of `words`.
    #[track_caller]
    pub(crate) fn bad(self, status: i32, words: &[&str]) -> Self {
        assert_eq!(self.status, Some(status), "{self:?}");
        assert_eq!(self.err.matches("error: ").count(), 1, "one message: {self:?}");
        assert!(self.err.starts_with("error: "), "{self:?}");
        for word in words {
            assert!(self.err.contains(word), "`{word}` is missing in: {}", self.err);
        }
        assert!(!self.err.contains("panicked"), "{self:?}");
        self
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out).expect("exactly one JSON document")
    }
}

/// The first column of the table in `docs/files.md` about a file.
pub(crate) fn documented(file: &str) -> Vec<String> {
    let text = include_str!("../../docs/files.md");
    let section = text.split("\n## ").find(|section| section.starts_with(&format!("`{file}`"))).expect("its section");
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`').to_owned()).collect()
}

/// Whether there is an `ffmpeg`, with a notice if there is none. With `LOCALSHAPE_REQUIRE_FFMPEG=1` this is a failure.
#[cfg(feature = "render")]
pub(crate) fn has_ffmpeg() -> bool {
    let is_there = Command::new("ffmpeg").arg("-version").output().is_ok();
    if !is_there {
        let missing = "there is no ffmpeg: `apt install ffmpeg`";
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_FFMPEG").is_none_or(|value| value != "1"), "{missing}");
        skipped(missing);
    }
    is_there
}

/// A command that runs a script in a folder by a Python with NumPy, as [`python`].
pub(crate) fn numpy() -> Option<impl Fn(&Path, &str) -> String> {
    python("numpy")
}

/// A function that runs a script in a folder by a Python with a package, `numpy` or `PIL`, and returns its output;
/// `None`, with a notice, if there is no such Python. With `LOCALSHAPE_REQUIRE_PYTHON=1` this is a failure.
pub(crate) fn python(package: &str) -> Option<impl Fn(&Path, &str) -> String + use<>> {
    python_with(package, None, "PYTHON", &format!("apt install python3-{}", package.to_lowercase()))
}

/// Where `.ci/run` installs the programs that read the files for other programs.
const VIEWERS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/viewers");

/// A function that runs a script in a folder by a Python with NumPy, VTK and USD, as [`python`]. Without them,
/// `LOCALSHAPE_REQUIRE_VIEWERS=1` is a failure.
pub(crate) fn viewers() -> Option<impl Fn(&Path, &str) -> String> {
    python_with("numpy, vtkmodules, pxr", Some(VIEWERS), "VIEWERS", ".ci/run viewers")
}

/// Validates a file by the validator of glTF, which must find nothing, not even a hint. Without it,
/// `LOCALSHAPE_REQUIRE_VIEWERS=1` is a failure.
pub(crate) fn validated(file: &Path) {
    let script = "const validator = require(process.argv[1] + '/node_modules/gltf-validator');\n\
                  const bytes = new Uint8Array(require('fs').readFileSync(process.argv[2]));\n\
                  validator.validateBytes(bytes).then(report => console.log(JSON.stringify(report.issues)));";
    if !Path::new(VIEWERS).join("node_modules/gltf-validator").is_dir() {
        let missing = "there is no validator of glTF: `.ci/run viewers`";
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_VIEWERS").is_none_or(|value| value != "1"), "{missing}");
        return skipped(missing);
    }
    let ran = run(Command::new("node").args(["-e", script, VIEWERS]).arg(file).stdin(Stdio::null()));
    let found = ran.json();
    let counts = ["numErrors", "numWarnings", "numInfos", "numHints"].map(|kind| found[kind].as_u64());
    assert_eq!(counts, [Some(0); 4], "{}: {found:#}", file.display());
}

/// As [`python`], with a folder of packages, and what is required and installed by which command if there is none.
fn python_with(
    package: &str,
    packages: Option<&'static str>,
    required: &str,
    how: &str,
) -> Option<impl Fn(&Path, &str) -> String + use<>> {
    // A shell reports a missing Python.
    let run_by = move |python: &str, folder: &Path, script: &str| {
        let mut command = Command::new("sh");
        command.args(["-c", "exec $0 -c \"$1\"", python, script]).current_dir(folder).stdin(Stdio::null());
        packages.into_iter().for_each(|packages| _ = command.env("PYTHONPATH", packages));
        run(&mut command)
    };
    let has_package = |python: &&str| run_by(python, Path::new("."), &format!("import {package}")).status == Some(0);
    // The first Python may belong to the user, without the packages of the system.
    let Some(python) = ["python3", "/usr/bin/python3"].into_iter().find(has_package) else {
        let missing = format!("there is no Python with {package}: `{how}`");
        let required = std::env::var_os(format!("LOCALSHAPE_REQUIRE_{required}"));
        assert!(required.is_none_or(|value| value != "1"), "{missing}");
        skipped(&missing);
        return None;
    };
    Some(move |folder: &Path, script: &str| {
        let ran = run_by(python, folder, script);
        assert_eq!(ran.status, Some(0), "{}", ran.err);
        ran.out
    })
}
