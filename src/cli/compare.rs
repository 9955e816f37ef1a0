//! `compare`: whether pictures differ, and whether the simulation or the drawing changed.

use super::console;
use super::failure::{Failure, Status};
use super::options::PrintOptions;
#[cfg(feature = "render")]
use super::{failure::warn, figure::warn_of_figure, interrupt};
use crate::golden::{Comparison, ComparisonError};
#[cfg(feature = "render")]
use crate::golden::{
    Golden,
    device::usual_gpu,
    draw::{DrawError, Subject, draw},
    drawing::PICTURES,
};
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
  localshape compare --bless golden/fig4b scenes/fig4b.toml  makes or renews that golden

A golden is a folder with a few small pictures of a scene and golden.toml, a record of the scene's keys and of the states of \
its frames. The result then names the keys that changed, the first state that moved, the node, and its distance.

Frames record a digest of the state that they show, so a difference is either of the state (`state moved`) or of the \
drawing (`drawn differently`). The difference of a pixel is its distance from the range of the pixels around its place in the \
other picture. Pictures pass if at most 1 % of their pixels differ by more than 2 of 255, and at most 0.03 %, or 8, by more \
than 16, and the mean of any 16 × 16 pixels by at most 1.5: other graphics drivers may differ as much.";

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

    /// Make the golden of a scene or figure, or renew it: changed parts are replaced, and listed
    #[arg(long)]
    bless: bool,

    /// Write an HTML page with both pictures of each pair and their difference
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    report: Option<PathBuf>,

    /// Graphics adapter for a scene or figure: auto, cpu, gpu, or part of its name [default: the kind that drew the golden, else
    /// cpu, a software driver]
    #[cfg(feature = "render")]
    #[arg(long, value_name = "ADAPTER")]
    adapter: Option<AdapterChoice>,

    #[command(flatten)]
    printing: PrintOptions,
}

impl Compare {
    pub(super) fn run(self) -> Result<Status, Failure> {
        if let Some(path) = &self.report {
            replaceable(path)?;
        }
        let is_scene = |path: &Path| path.extension().is_some_and(|ending| ending == "toml") && !path.is_dir();
        if is_scene(&self.actual) {
            return self.with_golden();
        }
        let [expected, actual] = [self.expected.display(), self.actual.display()];
        if is_scene(&self.expected) {
            if self.bless {
                bail!(
                    "{expected} is a scene or figure and must come last: localshape compare --bless {actual} {expected}"
                );
            }
            bail!(
                "{expected} is a scene or figure, which comes last, after its golden: localshape compare GOLDEN {expected}. \
                 Frames are compared with frames: give two folders"
            );
        }
        if self.bless {
            bail!("--bless makes or renews the golden of a scene or figure; {actual} is neither");
        }
        #[cfg(feature = "render")]
        if self.adapter.is_some() {
            bail!("--adapter is for scenes and figures, which are drawn to be compared; {actual} is neither");
        }
        let comparison = Comparison::of_pictures(&self.expected, &self.actual)?;
        self.tell(&comparison, None)?;
        Ok(if comparison.passes() { Status::Done } else { Status::Difference })
    }

    /// Writes the page, and prints the result and the accepted changes.
    fn tell(&self, comparison: &Comparison, accepted: Option<&[String]>) -> Result<(), Failure> {
        // The verdict is printed even if the page cannot be written.
        let reported = match &self.report {
            Some(path) => {
                let page = comparison.page().html();
                let _lock = FolderLock::beside_others(folder_of(path));
                write_whole(path, page.as_bytes())
            }
            None => Ok(()),
        };
        if self.printing.json {
            console::print_json(&document(comparison, accepted))?;
        } else if !self.printing.quiet {
            let text = match accepted {
                None => comparison.advised(),
                Some([]) => format!("{comparison}nothing to accept\n"),
                Some(lines) => format!("{comparison}{}\n", lines.join("\n")),
            };
            console::print(&text)?;
        }
        Ok(reported?)
    }

    /// Compares the scene or figure with its golden. On request, makes or renews the golden.
    #[cfg(feature = "render")]
    fn with_golden(&self) -> Result<Status, Failure> {
        let path: &Path = &self.actual;
        let golden = Golden::read(&self.expected, self.bless)?;
        let subject = Subject::load(path, &Limits::default())?;
        match &subject {
            _ if self.printing.quiet => {}
            Subject::Scene(scene) => warn(path, scene),
            Subject::Figure(figure) => warn_of_figure(figure),
        }
        let open = || self.adapter.as_ref().map_or_else(|| usual_gpu(&golden), Gpu::new);
        let gpu = subject.is_lit().then(open).transpose()?;
        interrupt::listen();
        let drawn = draw(path, &subject, &golden, PICTURES, gpu.as_ref(), &mut || !interrupt::requested());
        let drawn = drawn.map_err(|error| match error {
            DrawError::Render(error) => error.into(),
            DrawError::Disk(_) => Failure::files(error.to_string()),
            DrawError::NoRoom(message) => Failure::usage(message),
        })?;
        // If the last picture was interrupted, nothing is accepted.
        let Some(drawn) = drawn.filter(|_| !interrupt::requested()) else { return Ok(Status::Interrupted) };
        let comparison = Comparison::of_golden(&golden, &drawn);
        let accepted = self.bless.then(|| comparison.accept(&golden, &drawn)).transpose()?;
        self.tell(&comparison, accepted.as_deref())?;
        Ok(if comparison.passes() || self.bless { Status::Done } else { Status::Difference })
    }

    #[cfg(not(feature = "render"))]
    fn with_golden(&self) -> Result<Status, Failure> {
        bail!(
            "{} must be drawn, but this program was built without the feature `render`; give a picture or a folder \
             of pictures",
            self.actual.display()
        )
    }
}

impl From<ComparisonError> for Failure {
    fn from(error: ComparisonError) -> Self {
        match error {
            ComparisonError::Absent { .. } => Self::files(error.to_string()),
            ComparisonError::File(error) => error.into(),
            #[cfg(feature = "render")]
            ComparisonError::Undrawn => Self::new(Status::Difference, &error),
            ComparisonError::Wrong(message) => Self::usage(message),
        }
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

/// The beginning of every page.
const PAGE: &[u8] = b"<!doctype html>";

/// The whole result as JSON.
fn document(comparison: &Comparison, accepted: Option<&[String]>) -> Value {
    let mut document = json!({
        "passes": comparison.passes(),
        "verdict": comparison.verdict(),
        "accept": comparison.command_to_accept(),
        "accepted": accepted,
    });
    super::record::merge(&mut document, serde_json::to_value(comparison).expect("plain data"));
    document
}
