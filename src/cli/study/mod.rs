//! `study`: what methods can do, as tables and plots: errors against computation time on this machine, limits of stability, robustness.

mod rotation;
mod stability;
mod stress;
mod work_precision;

use super::console::{print, print_json};
use super::failure::{Failure, Status};
#[cfg(feature = "render")]
use super::options::DeviceOptions;
use super::options::PrintOptions;
use super::{interrupt, record};
use crate::output::SheetFiles;
#[cfg(feature = "render")]
use crate::picture::Page;
use crate::scene::{Limits, Scene};
use crate::table::Watch;
use clap::{Args, Subcommand, ValueHint};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape study rotation                    solvers of rotations in output/study-rotation/
  localshape study rotation -o rotations       the same elsewhere
  localshape study work-precision              integrators in output/study-work-precision/
  localshape study work-precision scenes/fig4b.toml  on a scene
  localshape study stability                   the largest stable steps in output/study-stability/
  localshape study stress                      what breaks which model in output/study-stress/

The folder then has the results as Markdown, which is also printed, as CSV with all digits, and, but for stress, as plots in SVG and \
PNG. Times are those of this machine, which should be idle otherwise.";

/// Measure errors against computation time, limits of stability and robustness
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, arg_required_else_help = false)]
pub(super) struct Study {
    #[command(subcommand)]
    subject: Subject,
}

/// What is studied.
#[derive(Subcommand, Debug)]
enum Subject {
    Rotation(rotation::Rotation),
    Stability(stability::Stability),
    Stress(stress::Stress),
    WorkPrecision(work_precision::WorkPrecision),
}

/// Options of all studies.
#[derive(Args, Debug)]
struct StudyOptions {
    /// Output folder [default: output/study-NAME]
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    /// Replace a study in the output folder that was made with other options, or other files
    #[arg(long)]
    overwrite: bool,

    #[command(flatten)]
    printing: PrintOptions,
}

/// Options of studies with plots.
#[derive(Args, Debug)]
struct PlotOptions {
    // Pixels need it.
    #[cfg(feature = "render")]
    #[command(flatten)]
    device: DeviceOptions,
}

/// Options of studies of a scene.
#[derive(Args, Debug)]
struct OfScene {
    /// The scene [default: built-in ones]
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: Option<PathBuf>,

    /// Measure more, which takes ten times as long or longer
    #[arg(long)]
    full: bool,

    #[command(flatten)]
    options: StudyOptions,
    #[command(flatten)]
    plots: PlotOptions,
}

/// A study to be made.
struct Plan<'a> {
    /// Its name, which its folder and its files have.
    name: &'a str,
    /// The command that repeats it.
    mark: String,
    /// The names of its plots, without extensions.
    plots: &'a [&'a str],
    /// How much it reports as done in all.
    work: u64,
}

/// What a study found.
struct Findings {
    /// For people; begins with the plan's mark in a comment.
    markdown: String,
    /// With all digits.
    csv: String,
    /// The plots, as many as the plan has.
    #[cfg(feature = "render")]
    plots: Vec<Box<dyn Page>>,
    json: Value,
}

impl Study {
    pub(super) fn run(self) -> Result<Status, Failure> {
        match self.subject {
            Subject::Rotation(rotation) => rotation.run(),
            Subject::Stability(stability) => stability.run(),
            Subject::Stress(stress) => stress.run(),
            Subject::WorkPrecision(work_precision) => work_precision.run(),
        }
    }
}

impl OfScene {
    /// The command that repeats the study.
    fn mark(&self, name: &str) -> String {
        let scene = self.scene.as_ref().map_or_else(String::new, |path| format!(" {}", path.display()));
        format!("localshape study {name}{scene}{}", if self.full { " --full" } else { "" })
    }

    fn subject(&self) -> Result<Option<Scene>, Failure> {
        let Some(path) = &self.scene else { return Ok(None) };
        let scene = Scene::load(path, &Limits::default())?;
        if scene.duration == 0.0 {
            bail!(
                "{}: `time.duration` is 0: nothing moves, and there is nothing to measure; make it longer",
                path.display()
            );
        }
        Ok(Some(scene))
    }
}

impl StudyOptions {
    /// The output folder.
    fn folder(&self, plan: &Plan<'_>) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("output").join(format!("study-{}", plan.name)))
    }

    /// Makes a study, with options for its plots if it has any; `measure` returns `None` if its argument says that the user wants to
    /// stop.
    fn run(
        &self,
        plan: &Plan<'_>,
        plots: Option<&PlotOptions>,
        measure: impl FnOnce(&Watch<'_>) -> Option<Findings>,
    ) -> Result<Status, Failure> {
        interrupt::listen();
        let folder = self.folder(plan);
        let mut names: Vec<_> = ["md", "csv"].map(|ending| format!("{}.{ending}", plan.name)).into();
        if cfg!(feature = "render") {
            names.extend(plan.plots.iter().flat_map(|plot| ["svg", "png"].map(|ending| format!("{plot}.{ending}"))));
        }
        let names: Vec<_> = names.iter().map(String::as_str).collect();
        SheetFiles::inspect(&folder, &names, &plan.mark, self.overwrite)?;
        #[cfg(feature = "render")]
        let gpu = plots.map(|plots| plots.device.open([])).transpose()?;
        #[cfg(not(feature = "render"))]
        let _ = plots;
        let files = SheetFiles::begin(&folder, &names, &plan.mark, self.overwrite)?;
        let bar = self.printing.progress(plan.name, plan.work);
        let found = measure(&interrupt::watch(&bar));
        bar.finish_and_clear();
        let Some(found) = found else {
            if self.printing.prints_text() {
                print(&format!("interrupted; {} was not made\n", plan.name))?;
            }
            return Ok(Status::Interrupted);
        };
        #[allow(unused_mut, reason = "plots need the renderer")]
        let mut contents = vec![found.markdown.clone().into_bytes(), found.csv.into_bytes()];
        #[cfg(feature = "render")]
        for (plots, gpu) in found.plots.iter().zip(gpu.iter().cycle()) {
            contents.extend(drawn(&**plots, &plan.mark, gpu)?);
        }
        files.finish(&contents)?;
        if self.printing.json {
            let mut document = json!({ "study": plan.name, "folder": folder.to_string_lossy(), "files": names });
            record::merge(&mut document, found.json);
            print_json(&document)?;
        } else if !self.printing.quiet {
            print(&format!("{}\nIn {}: {}\n", found.markdown, folder.display(), names.join(", ")))?;
        }
        Ok(Status::Done)
    }
}

/// Plots as SVG and as PNG.
#[cfg(feature = "render")]
fn drawn(plots: &dyn Page, mark: &str, gpu: &crate::gpu::Gpu) -> Result<[Vec<u8>; 2], Failure> {
    use super::still::{Format, Still};
    let (picture, print) = (plots.compose(), plots.print());
    let comment = format!("{}{}", super::film::MARK, env!("CARGO_PKG_VERSION"));
    let tags = [("comment", comment), ("study", mark.to_owned())];
    let still = Still { picture: &picture, print: Some(&print), source: mark, title: plots.title(), tags: &tags };
    let svg = still.draw(Format::Vector(crate::vector::Format::Svg), None)?.file();
    Ok([svg, still.draw(Format::Png, Some(gpu))?.file()])
}

/// The machine in a few words, for tables of times.
fn machine() -> String {
    // Only Linux has this file.
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = name.map_or(String::new(), |(_, name)| format!("{}, ", name.trim()));
    let bits = 64 * crate::sim::floor::lanes();
    format!("{name}{} {}, vectors of {bits} bits", std::env::consts::ARCH, std::env::consts::OS)
}
