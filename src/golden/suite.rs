//! Goldens in `cargo test`.

use super::comparison::Comparison;
use super::device::TestDevice;
use super::draw::{Subject, draw};
use super::drawing::PICTURES;
use super::folder::Golden;
use crate::gpu::AdapterChoice;
use crate::reading::beside::{entries, name_of};
use crate::scene::Limits;
use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The environment variable that asks to accept changes.
const UPDATE: &str = "UPDATE_GOLDENS";

/// A folder of goldens and the scenes to compare with them.
///
/// ```no_run
/// use localshape::golden::Suite;
///
/// #[test]
/// fn my_scenes_are_as_they_were() {
///     let mut goldens = Suite::new("tests/golden");
///     goldens.scene("scenes/my-scene.toml");
///     goldens.finish();
/// }
/// ```
///
/// Each scene has the golden of its name, `tests/golden/my-scene/`: a few small pictures and `golden.toml`, a record of all
/// states. [`Self::finish`] panics with all failures: states that moved, pictures that are drawn differently, missing
/// goldens, and goldens without a scene.
///
/// With `UPDATE_GOLDENS=1` in the environment, goldens are made or renewed instead. Each accepted change is printed on
/// standard error, states that moved first. Each failure has a page for a browser in `target/golden/`.
///
/// Pictures are drawn by the kind of adapter that drew the goldens if the machine has it, else by a software driver, else by
/// any adapter. Without a graphics adapter only the states of bodies in space are compared; with `LOCALSHAPE_REQUIRE_GPU=1` this is a failure.
#[derive(Debug)]
#[must_use = "`finish` reports failures"]
pub struct Suite {
    goldens: PathBuf,
    reports: PathBuf,
    /// The number of pictures of new goldens.
    pictures: u64,
    device: TestDevice,
    /// Whether pictures without lit bodies must be equal.
    is_exact: bool,
    used: BTreeSet<String>,
    complaints: Vec<String>,
    is_finished: bool,
}

impl Suite {
    /// The goldens in a folder, which need not exist if there are none.
    pub fn new(goldens: impl Into<PathBuf>) -> Self {
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
        Self {
            goldens: goldens.into(),
            reports: target.join("golden"),
            pictures: PICTURES,
            device: TestDevice::default(),
            is_exact: false,
            used: BTreeSet::new(),
            complaints: Vec::new(),
            is_finished: false,
        }
    }

    /// The number of pictures of new goldens, evenly spaced up to the end of the scene (default 3).
    pub fn pictures(mut self, count: u64) -> Self {
        self.pictures = count;
        self
    }

    /// Draws on a given adapter instead of the kind that drew the goldens. Then nothing is accepted: goldens come from
    /// one kind of adapter.
    pub fn on(mut self, adapter: AdapterChoice) -> Self {
        self.device.adapter = Some(adapter);
        self
    }

    /// Allows pictures without lit bodies no tolerance: no device draws them. Their pixels are equal on x86-64 processors with
    /// the same C library.
    #[doc(hidden)]
    pub fn exact(mut self) -> Self {
        self.is_exact = true;
        self
    }

    /// The folder for reports of failures, instead of `target/golden/`.
    pub fn reports(mut self, folder: impl Into<PathBuf>) -> Self {
        self.reports = folder.into();
        self
    }

    /// Simulates and draws a scene or a figure, and compares it with the golden of its name.
    pub fn scene(&mut self, path: impl AsRef<Path>) -> &mut Self {
        let path = path.as_ref();
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        if !self.used.insert(name.clone()) {
            self.complaints.push(format!("{name}: two scenes of this name share one golden; give one another name"));
        } else if let Err(complaint) = self.check(path, &name) {
            self.complaints.push(format!("{name}: {complaint}"));
        }
        self
    }

    fn check(&mut self, path: &Path, name: &str) -> Result<(), String> {
        let update = std::env::var(UPDATE).unwrap_or_default();
        if !["", "0", "1"].contains(&update.as_str()) {
            return Err(format!("{UPDATE}={update} means nothing; {UPDATE}=1 makes and renews goldens"));
        }
        let updates = update == "1" && self.device.adapter.is_none();
        let folder = self.goldens.join(name);
        let subject = Subject::load(path, &Limits::default()).map_err(|error| error.to_string())?;
        let golden = Golden::read(&folder, updates).map_err(|error| error.to_string())?;
        let gpu = if subject.is_lit() { self.device.of(&golden)?.cloned() } else { None };
        let drawn = draw(path, &subject, &golden, self.pictures, gpu.as_ref(), &mut || true);
        let drawn = drawn.map_err(|error| error.to_string())?.expect("it is not interrupted");
        let mut comparison = Comparison::of_golden(&golden, &drawn);
        if self.is_exact && !subject.is_lit() {
            comparison.refuse_tolerance();
        }
        let report = self.reports.join(format!("{name}.html"));
        // A report of an earlier failure is out of date.
        let _ = std::fs::remove_file(&report);
        if updates {
            let told = comparison.accept(&golden, &drawn).map_err(|error| error.to_string())?;
            // `cargo test` captures the output of the printing macros.
            let told = told.iter().fold(String::new(), |told, line| format!("{told}{name}: {line}\n"));
            let _ = std::io::stderr().write_all(told.as_bytes());
            return Ok(());
        }
        if comparison.passes() {
            return Ok(());
        }
        let written =
            std::fs::create_dir_all(&self.reports).and_then(|()| std::fs::write(&report, comparison.page().html()));
        let seen = match written {
            Ok(()) => format!("see {}", report.display()),
            Err(error) => format!("there is no report: {} cannot be written: {error}", report.display()),
        };
        Err(format!("{comparison}{seen}\naccept with: {UPDATE}=1 cargo test"))
    }

    /// Ends the comparison.
    ///
    /// # Panics
    /// If anything is not as expected, with all failures; also if a golden has no scene.
    pub fn finish(mut self) {
        self.is_finished = true;
        let mut complaints = self.complaints.clone();
        complaints.extend(self.unused());
        if complaints.is_empty() {
            return;
        }
        let text: String = complaints.iter().map(|complaint| format!("\n\n{complaint}")).collect();
        panic!("{} of the goldens in {} are not as they were:{text}\n", complaints.len(), self.goldens.display());
    }

    /// Messages about goldens without a scene.
    fn unused(&self) -> Vec<String> {
        let paths = match entries(&self.goldens) {
            Ok(paths) => paths,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Vec::new(),
            Err(error) => return vec![format!("{} cannot be read: {error}", self.goldens.display())],
        };
        let is_golden = |path: &PathBuf| path.is_dir() || path.extension().is_some_and(|ending| ending == "png");
        let mut names: Vec<String> = paths.iter().filter(|path| is_golden(path)).map(|path| name_of(path)).collect();
        names.retain(|name| !name.starts_with('.') && !self.used.contains(name));
        names.sort();
        let told = |name: &String| {
            format!(
                "{name}: no scene of this test has this golden; delete {}, or test its scene",
                self.goldens.join(name).display()
            )
        };
        names.iter().map(told).collect()
    }
}

/// Without a call of `finish`, a suite would pass.
impl Drop for Suite {
    fn drop(&mut self) {
        let is_forgotten = !self.is_finished && !std::thread::panicking();
        let goldens = self.goldens.display();
        assert!(!is_forgotten, "the goldens in {goldens} were compared, but the result was not checked: call `finish`");
    }
}
