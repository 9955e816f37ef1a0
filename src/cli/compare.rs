//! `compare`: whether pictures differ, and whether the simulation or the drawing changed.

use super::console;
use super::failure::{Failure, Status, with_causes};
use super::options::PrintOptions;
#[cfg(feature = "render")]
use super::{
    failure::{warn, warn_of_figure},
    frames::FrameRanges,
    interrupt,
    options::size,
};
#[cfg(feature = "render")]
use crate::golden::draw::{DrawError, DrawOptions, Subject, draw, usual_gpu};
use crate::golden::{BlessError, Blessed, Comparison, ComparisonError, Side};
#[cfg(feature = "render")]
use crate::gpu::{AdapterChoice, Gpu};
use crate::output::{FolderLock, OutputError, folder_of, is_folder, write_whole};
#[cfg(feature = "render")]
use crate::scene::Limits;
use clap::{Args, ValueHint};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape compare expected.png actual.png
  localshape compare before/ after/ --report what-moved.html
  localshape compare golden/fig4b scenes/fig4b.toml          draws the golden's frames and compares them
  localshape compare --bless golden/fig4b scenes/fig4b.toml  makes that golden, or updates its pictures

A golden is a folder with a few small pictures of a scene and golden.toml, which records the states of all frames. The \
result then names the first state that moved, the node, and its distance. For two folders of frames it does so if both \
have states.npz (render --states).

Frames record a digest of the state that they show, so a difference is either one of the state (`state moved`) or one of \
the drawing (`same state, drawn differently`). Pictures drawn by the same adapter must be equal in every byte. Those of \
two adapters of one kind may differ by more than 2 of 255 in at most 0.01 % of their pixels, or in 8. Those of different \
kinds may also differ along silhouettes, but hardly between them or in objects that are in one picture only. Pictures \
without a recorded state, such as those of other programs, are compared by their pixels alone.";

/// Compare pictures, folders of frames, or a scene with its golden
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Compare {
    /// Expected: a picture, a folder of pictures, or a golden
    #[arg(value_name = "EXPECTED", value_hint = ValueHint::AnyPath)]
    expected: PathBuf,

    /// Actual: a picture or a folder of pictures, or for a golden its scene or figure file
    #[arg(value_name = "ACTUAL", value_hint = ValueHint::AnyPath)]
    actual: PathBuf,

    /// Accept the actual pictures: replace expected pictures that failed, or make a golden that does not exist. Refused if
    /// the state moved
    #[arg(long)]
    bless: bool,

    /// Accept the actual pictures, also if the state moved
    #[arg(long)]
    bless_state: bool,

    /// Write an HTML page with both pictures of each pair, their difference, and the error over time
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    report: Option<PathBuf>,

    #[cfg(feature = "render")]
    #[command(flatten)]
    drawing: Drawing,

    #[command(flatten)]
    printing: PrintOptions,
}

/// How a scene is drawn to be compared.
#[cfg(feature = "render")]
#[derive(Args, Debug)]
#[command(next_help_heading = "Options for scenes and figures")]
struct Drawing {
    /// Frames of which the golden has pictures: 0-119x30, or 5,9,40-60 [default: those it has; three for a new one]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<FrameRanges>,

    /// Width and height of the pictures (px) [default: those of the golden; 320 wide for a new one]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Graphics adapter: auto, cpu, gpu, or part of its name [default: the kind that drew the golden, else cpu, a software
    /// driver]
    #[arg(long, value_name = "ADAPTER")]
    adapter: Option<AdapterChoice>,
}

impl Compare {
    pub(super) fn run(self) -> Result<Status, Failure> {
        if let Some(path) = &self.report {
            replaceable(path)?;
        }
        let Some(comparison) = self.comparison()? else { return Ok(Status::Interrupted) };
        // The verdict is printed even if the page cannot be written.
        let reported = match &self.report {
            Some(path) => {
                let page = comparison.report().page();
                let _lock = FolderLock::beside_others(folder_of(path));
                write_whole(path, page.as_bytes())
            }
            None => Ok(()),
        };
        let blesses = self.bless || self.bless_state;
        let blessed = blesses.then(|| comparison.bless(self.bless_state)).transpose();
        let is_changed = |blessed: &Blessed| !blessed.written.is_empty() || !blessed.removed.is_empty();
        let accepted = matches!(&blessed, Ok(Some(blessed)) if is_changed(blessed) && blessed.left.is_empty());
        if self.printing.json {
            let written = match &blessed {
                Ok(Some(blessed)) => {
                    json!({ "written": blessed.written, "removed": blessed.removed, "left": blessed.left })
                }
                _ => Value::Null,
            };
            console::print_json(&document(&comparison, &written))?;
        } else if !self.printing.quiet {
            console::print(&comparison.text(!blesses))?;
            if let Ok(Some(blessed)) = &blessed {
                let nothing = comparison.passes().then(|| "nothing to accept\n".to_owned());
                console::print(&nothing.unwrap_or_else(|| blessed.to_string()))?;
            }
        }
        reported?;
        match blessed {
            Ok(_) => Ok(if comparison.passes() || accepted { Status::Done } else { Status::Difference }),
            Err(BlessError::Write { blessed, source }) => {
                // Files written before are listed.
                let done = if blessed.written.is_empty() { String::new() } else { format!("\n{blessed}") };
                Err(Failure::files(format!("{}{}", with_causes(&source), done.trim_end())))
            }
            Err(error) => Err(Failure::difference(error.to_string())),
        }
    }

    /// Both sides beside each other; `None` if it was interrupted.
    fn comparison(&self) -> Result<Option<Comparison>, Failure> {
        let failed = |error: ComparisonError| match error {
            ComparisonError::Absent { .. } | ComparisonError::Read { .. } => Failure::files(with_causes(&error)),
            _ => Failure::usage(error.to_string()),
        };
        let is_scene = self.actual.extension().is_some_and(|ending| ending == "toml") && !self.actual.is_dir();
        if !is_scene {
            let is_scene = self.expected.extension().is_some_and(|ending| ending == "toml") && !self.expected.is_dir();
            if is_scene {
                let (scene, other) = (self.expected.display(), self.actual.display());
                let option = match (self.bless_state, self.bless) {
                    (true, _) => "--bless-state ",
                    (_, true) => "--bless ",
                    _ => "",
                };
                bail!("{scene} is a scene or figure and must come last: localshape compare {option}{other} {scene}");
            }
            self.no_drawing()?;
            return Comparison::of(&self.expected, &self.actual, self.bless || self.bless_state)
                .map(Some)
                .map_err(failed);
        }
        let expected = Side::read_or_absent(&self.expected).map_err(failed)?;
        if !expected.is_golden() {
            let (expected, actual) = (self.expected.display(), self.actual.display());
            bail!(
                "{expected} is not a golden (a folder with golden.toml), but {actual} is a scene or figure, which is \
                 compared with its golden; to make one, name a folder that does not exist"
            );
        }
        let Some(actual) = self.draw(&expected)? else { return Ok(None) };
        Comparison::between(expected, actual).map(Some).map_err(failed)
    }

    /// Rejects options that only scenes have.
    #[cfg(feature = "render")]
    fn no_drawing(&self) -> Result<(), Failure> {
        let Drawing { frames, size, adapter } = &self.drawing;
        let given = [("--frames", frames.is_some()), ("--size", size.is_some()), ("--adapter", adapter.is_some())];
        match given.into_iter().find(|(_, is_given)| *is_given) {
            None => Ok(()),
            Some((option, _)) => bail!(
                "{option} is for scenes and figures, which are drawn to be compared; {} is neither",
                self.actual.display()
            ),
        }
    }

    #[cfg(not(feature = "render"))]
    fn no_drawing(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// The scene or figure, simulated and drawn as its golden was.
    #[cfg(feature = "render")]
    fn draw(&self, expected: &Side) -> Result<Option<Side>, Failure> {
        let path: &Path = &self.actual;
        let subject = Subject::load(path, &Limits::default())?;
        match &subject {
            _ if self.printing.quiet => {}
            Subject::Scene(scene) => warn(path, scene),
            Subject::Figure(figure) => warn_of_figure(figure),
        }
        let Drawing { frames, size, adapter } = &self.drawing;
        let frames = match (frames, &subject) {
            (None, _) => None,
            (Some(frames), Subject::Scene(scene)) => {
                let message = |what: String| Failure::usage(format!("--frames of “{}”: {what}", scene.title));
                Some(frames.select(scene.last_frame()).map_err(message)?)
            }
            (Some(_), Subject::Figure(_)) => {
                bail!("--frames is for scenes; a figure is one picture");
            }
        };
        let wish = DrawOptions { frames, size: *size, distances: self.report.is_some(), ..DrawOptions::default() };
        let gpu = adapter.as_ref().map_or_else(|| usual_gpu(expected), Gpu::new)?;
        interrupt::listen();
        let drawn = draw(path, &subject, &wish, expected, Some(&gpu), &mut || !interrupt::requested());
        let drawn = drawn.map_err(|error| match error {
            DrawError::Render(error) => error.into(),
            DrawError::Disk(_) => Failure::files(error.to_string()),
            DrawError::Options(message) => Failure::usage(message),
        })?;
        // If interrupted while the last picture was drawn, nothing is accepted.
        Ok(drawn.filter(|_| !interrupt::requested()))
    }

    #[cfg(not(feature = "render"))]
    fn draw(&self, _expected: &Side) -> Result<Option<Side>, Failure> {
        let path: &Path = &self.actual;
        bail!(
            "{} must be drawn, but this program was built without the feature `render`; give a picture or a folder \
             of pictures",
            path.display()
        )
    }
}

/// Checks that the page does not replace another kind of file.
fn replaceable(path: &Path) -> Result<(), Failure> {
    is_folder(folder_of(path)).map_err(|error| match error {
        OutputError::NoFolder { path, what } => {
            Failure::files(format!("--report: {} is {what}, not a folder; name a file elsewhere", path.display()))
        }
        error => error.into(),
    })?;
    let mut start = [0; PAGE.len()];
    let mut is_page = || {
        let mut file = std::fs::File::open(path).ok()?;
        std::io::Read::read_exact(&mut file, &mut start).ok()?;
        start.eq_ignore_ascii_case(PAGE).then_some(())
    };
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    if path.symlink_metadata().is_err() || is_file && is_page().is_some() {
        return Ok(());
    }
    bail!("--report: {} exists and is not a page of a comparison; name another file", path.display())
}

/// How pages begin.
const PAGE: &[u8] = b"<!doctype html>";

/// The whole result as JSON.
fn document(comparison: &Comparison, blessed: &Value) -> Value {
    let head = json!({
        "passes": comparison.passes(),
        "verdict": comparison.verdict(),
        "first_moved": comparison.first_moved().map(|picture| &picture.name),
        "golden_is_missing": comparison.is_golden_missing(),
        "accept": comparison.command_to_accept(),
        "blessed": blessed,
    });
    let mut document = head;
    super::record::merge(&mut document, serde_json::to_value(comparison).expect("plain data"));
    document
}
