//! A place to run the program in, and what comes out of it.

use serde_json::Value;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
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

/// The number of frames of [`SMALL`].
pub(crate) const SMALL_FRAMES: usize = 7;

/// [`SMALL`] with another duration (s), and so another scene.
pub(crate) fn lasting(duration: &str) -> String {
    SMALL.replace("duration = 0.1", &format!("duration = {duration}"))
}

/// A folder of its own to run the program in; gone when dropped.
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

    pub(crate) fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("below the place")).expect("a folder");
        fs::write(path, text).expect("a file");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).expect("a JSON document")
    }

    /// The names in a folder, hidden ones too, in order.
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
        command
    }

    /// Runs the program with arguments, written with spaces between.
    pub(crate) fn run(&self, arguments: &str) -> Ran {
        Ran::from(self.command(arguments.split(' ')).output().expect("the program starts"))
    }
}

/// What a run of the program left on its outputs.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) status: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("text in UTF-8");
        Self { status: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Ran {
    /// Ended well and said nothing on standard error.
    #[track_caller]
    pub(crate) fn good(self) -> Self {
        assert_eq!((self.status, self.err.as_str()), (Some(0), ""), "{self:?}");
        self
    }

    /// Ended with a status and one message, which begins as errors do and holds all of `words`.
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

/// Says that a test did not do what it is for.
pub(crate) fn skip(why: &str) {
    eprintln!("SKIPPED: {why}");
}

/// What runs a script in a folder by a Python that has NumPy, and returns what it prints; `None`, with a notice, if there is
/// no such Python.
pub(crate) fn numpy() -> Option<impl Fn(&Path, &str) -> String> {
    let run = |folder: &Path, script: &str| {
        Command::new("python3").args(["-c", script]).current_dir(folder).stdin(Stdio::null()).output()
    };
    if !run(Path::new("."), "import numpy").is_ok_and(|output| output.status.success()) {
        skip("there is no Python with NumPy");
        return None;
    }
    Some(move |folder: &Path, script: &str| {
        let output = run(folder, script).expect("Python starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    })
}
