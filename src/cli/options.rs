//! Options that several commands share.

use super::failure::Failure;
use super::frames::FrameRanges;
#[cfg(feature = "render")]
use crate::gpu::{AdapterChoice, Gpu};
#[cfg(feature = "render")]
use crate::look::Theme;
use crate::output::export;
use crate::reading::setting::Setting;
#[cfg(feature = "render")]
use crate::scene::Scene;
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum, ValueHint};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::path::PathBuf;

/// The scenes of a command.
#[derive(Args, Clone, Debug)]
pub(super) struct SceneOptions {
    /// Scene files (TOML); all are read and checked before the first is run
    #[arg(value_name = "SCENE", required = true, value_hint = ValueHint::FilePath)]
    pub(super) scenes: Vec<PathBuf>,

    /// Change a key of the scene for this command, such as time.duration=2 or run[0].model.stiffness=1e4. The key is
    /// written as in messages, the value as in a scene file; words need no quotation marks. Can be repeated
    #[arg(long, value_name = "KEY=VALUE")]
    pub(super) set: Vec<Setting>,

    /// Accept scenes beyond the limits that guard against typing errors, as far as memory permits and up to 4294967295 nodes
    /// or elements
    #[arg(long)]
    pub(super) allow_large: bool,
}

/// The frames and runs that are made, and their folder.
#[derive(Args, Clone, Debug)]
pub(super) struct RunOptions {
    /// Output folder [default: output/NAME, with NAME from the scene file]; with several scenes, the
    /// parent of a folder NAME for each. With `render`, a name ending in .png, .svg or .pdf is the file of a single frame
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::AnyPath)]
    pub(super) out: Option<PathBuf>,

    /// Replace results of another scene, frames of another size or choice of runs, and other files with the names of
    /// output files
    #[arg(long)]
    pub(super) overwrite: bool,

    /// Frames to make, inclusive: 0-119, every third as 0-119x3, or 5,9,40-60 [default: all]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameRanges>,

    /// Only this run of the scene; can be repeated [default: all]
    #[arg(long, value_name = "RUN")]
    pub(super) only: Vec<String>,

    /// Also write positions and velocities of every frame to states.npz, for numpy.load: `time`, `RUN.position` and
    /// `RUN.velocity` for each run, and `RUN.time` for a run with its own time step. `render --from-states` draws them
    #[arg(long)]
    pub(super) states: bool,

    /// Also write the bodies in motion for other programs: vtu (ParaView), usd, gltf, obj, or several of them as vtu,usd
    #[arg(long, value_name = "FORMAT", value_enum, value_delimiter = ',', hide_possible_values = true)]
    pub(super) write: Vec<export::Format>,

    /// Continue after an interruption, from the last checkpoint or, without one, from the start. The results are those
    /// of an uninterrupted command. Existing
    /// frames with the same scene, states, version, adapter and size are not drawn again
    #[arg(long)]
    pub(super) resume: bool,

    #[command(flatten)]
    pub(super) threads: ThreadOptions,
    #[command(flatten)]
    pub(super) printing: PrintOptions,
}

impl RunOptions {
    /// The formats for other programs, each once.
    pub(super) fn formats(&self) -> Vec<export::Format> {
        let mut formats = self.write.clone();
        formats.sort_unstable();
        formats.dedup();
        formats
    }
}

impl ValueEnum for export::Format {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Vtu, Self::Usd, Self::Gltf, Self::Obj]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Self::ALL.into_iter().find(|(format, _)| format == self).map(|(_, name)| PossibleValue::new(name))
    }
}

/// The number of threads.
#[derive(Args, Clone, Copy, Debug)]
pub struct ThreadOptions {
    /// Number of threads, which does not change the results [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadOptions {
    /// The requested number, or one for each processor.
    pub fn count(self) -> usize {
        self.threads.map_or_else(processors, usize::from)
    }

    /// Starts the threads that share all work outside of runs, such as filling a surface and moving it with its body. A process has
    /// them once.
    pub(super) fn start(self) -> Result<(), Failure> {
        let pool = ThreadPoolBuilder::new().num_threads(self.count()).thread_name(|at| format!("share {at}"));
        pool.build_global().map_err(|error| no_threads(&error))
    }

    /// The threads that simulate.
    pub(super) fn pool(self) -> Result<ThreadPool, Failure> {
        let pool = ThreadPoolBuilder::new().num_threads(self.count()).thread_name(|at| format!("simulate {at}"));
        pool.build().map_err(|error| no_threads(&error))
    }
}

/// The failure of a system that does not start threads.
fn no_threads(error: &ThreadPoolBuildError) -> Failure {
    Failure::usage(format!("--threads: the system does not start so many threads ({error})"))
}

/// The output of a command to the terminal.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct PrintOptions {
    /// Print only errors: no progress, results or warnings
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// Print the results as one JSON document
    #[arg(long, conflicts_with = "quiet")]
    pub(super) json: bool,
}

impl PrintOptions {
    /// Whether results are printed as text.
    pub(super) fn prints_text(self) -> bool {
        !self.quiet && !self.json
    }

    /// A progress bar with the estimated time left, and with frames as its message. Invisible with `--quiet` or without
    /// a terminal.
    pub(super) fn progress(self, title: &str, steps: u64) -> ProgressBar {
        let target = if self.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{prefix}  {wide_bar}  {msg}, {eta} left");
        let bar = ProgressBar::with_draw_target(Some(steps), target);
        bar.set_style(style.expect("a template of known keys"));
        bar.set_prefix(title.to_owned());
        bar
    }
}

/// The graphics adapter.
#[cfg(feature = "render")]
#[derive(Args, Debug)]
pub(super) struct DeviceOptions {
    /// Graphics adapter for bodies in space: auto (a GPU if there is one), cpu, gpu, or part of its name
    #[arg(long, value_name = "ADAPTER", default_value = "auto")]
    adapter: AdapterChoice,
}

#[cfg(feature = "render")]
impl DeviceOptions {
    /// Opens the device for pictures with lit bodies, of these sizes (px), if there are any.
    pub(super) fn open(&self, sizes: impl IntoIterator<Item = [u32; 2]>) -> Result<Option<Gpu>, Failure> {
        let mut sizes = sizes.into_iter().peekable();
        if sizes.peek().is_none() {
            return Ok(None);
        }
        let gpu = Gpu::new(&self.adapter)?;
        if let Some([width, height]) = sizes.find(|size| size[0].max(size[1]) > gpu.longest_side(*size)) {
            let (adapter, longest) = (gpu.description(), gpu.longest_side([width, height]));
            bail!("{width}×{height} is too large: {adapter} draws up to {longest} pixels a side");
        }
        Ok(Some(gpu))
    }
}

#[cfg(feature = "render")]
impl ValueEnum for Theme {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Light, Self::Dark]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(if *self == Self::Light { "light" } else { "dark" }))
    }
}

#[cfg(feature = "render")]
pub(super) fn number_in(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |typed| {
        let number = typed.trim().parse().ok().filter(|number| (least..=most).contains(number));
        number.ok_or_else(|| format!("expected a number from {least} to {most}"))
    }
}

/// The sides that a picture of a scene may have (px).
#[cfg(feature = "render")]
const SIDES: std::ops::RangeInclusive<u32> = 16..=16384;

#[cfg(feature = "render")]
pub(super) fn size(typed: &str) -> Result<[u32; 2], String> {
    let sides = typed.split_once(['x', 'X', '×']).and_then(|(width, height)| {
        let side = |digits: &str| digits.trim().parse::<u32>().ok();
        Some([side(width)?, side(height)?])
    });
    let sides = sides.ok_or("expected width x height, such as 1280x720")?;
    if sides.iter().any(|side| !SIDES.contains(side)) {
        return Err(format!("a side has {} to {} pixels", SIDES.start(), SIDES.end()));
    }
    Ok(sides)
}

/// Gives a scene the requested size.
#[cfg(feature = "render")]
pub(super) fn resize(scene: &mut Scene, size: Option<[u32; 2]>) {
    if let Some(size) = size {
        (scene.view.size, scene.view.print) = (size, None);
    }
}

/// The number of threads that this machine runs at the same time.
pub(super) fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(all(test, feature = "render"))]
mod tests {
    use super::size;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        assert_eq!(size("640×360"), Ok([640, 360]));
        for wrong in ["", "x", "1280", "1280x", "0x5", "-1x4", "20000x100", "1280x720x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
