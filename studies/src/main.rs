//! Measurements with `localshape`: the accuracy and the cost of its methods, their limits of stability, the robustness
//! of models, their materials, and the tables of the paper. All use the public interface of the library.
//!
//! A study has a name, a measurement, and findings: text, tables and pages ([`study`]). It does not depend on files or on the
//! command line.

mod contact;
mod folder;
mod load;
mod material;
mod methods;
mod models;
mod page;
mod random;
mod ratio;
#[cfg(test)]
#[path = "../tests/inside/reading.rs"]
mod reading;
mod rotation;
mod spread;
mod stability;
mod stress;
mod study;
mod table;
mod table1;
mod turns;
mod work_precision;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueHint};
use contact::Contact;
use load::Loads;
use localshape::internals::{Failure, ThreadOptions};
use localshape::{Limits, Scene};
use material::{Beam, Cook, Patch, Time};
use ratio::Ratio;
use rotation::Rotation;
use stability::Stability;
use std::path::PathBuf;
use std::process::ExitCode;
use stress::Stress;
use study::{Options, Study, Task};
use table1::Table1;
use work_precision::{Effort, Subject, WorkPrecision};

const EXAMPLES: &str = "\
Examples:
  localshape-study rotation                    solvers of rotations in output/study-rotation/
  localshape-study rotation -o rotations       the same study in another folder
  localshape-study work-precision              integrators in output/study-work-precision/
  localshape-study work-precision scenes/fig4b.toml  on a scene
  localshape-study stability                   the largest stable steps in output/study-stability/
  localshape-study stress                      the robustness of models in output/study-stress/
  localshape-study beam                        how the models bend in output/study-beam/
  localshape-study beam-time                   the error of a beam against time
  localshape-study contact                     what must hold where bodies meet
  localshape-study load                        bodies at rest under loads, beside closed forms
  localshape-study table1 --orientations 200   Table 1 of the paper, from more starts
  localshape-study ratio --threads 4 -o four   the ratio of computation times on four threads

The folder then has the results as Markdown, which is also printed, as CSV with all digits, and mostly as plots in SVG and PNG. \
Times are those of this machine, which should be otherwise idle.

Exit status:
    0  done
    2  wrong usage, or mistakes in a scene file
    4  reading or writing failed
  130  interrupted by Ctrl-C or SIGTERM";

/// Measure the methods of localshape: accuracy, cost, stability, robustness, materials, and the tables of the paper
#[derive(Debug, Parser)]
#[command(name = "localshape-study", version, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    name: Name,

    #[command(flatten)]
    options: Options,
}

/// The studies.
#[derive(Debug, Subcommand)]
enum Name {
    /// The solvers of rotations: angle error against time for each element, and outcomes for degenerate elements
    Rotation,
    /// The integrators: error of the positions against evaluations of the forces and time
    WorkPrecision {
        /// Only this run of the scene; can be repeated [default: all]
        #[arg(long, value_name = "RUN", requires = "scene")]
        only: Vec<String>,
        #[command(flatten)]
        of: OfScene,
    },
    /// The outcome of a scene's runs for stiffnesses over three decades and steps up to beyond the predicted limit:
    /// whole, turned over or diverged
    Stability {
        #[command(flatten)]
        of: OfScene,
        #[command(flatten)]
        threads: ThreadOptions,
    },
    /// Falls, impacts, degenerate starts and elements, very long runs: the outcome of each with every model
    Stress {
        /// A model beside the shape-based one; can be repeated [default: springs, and Eq. (15)]
        #[arg(long, value_name = "KIND", value_parser = PossibleValuesParser::new(models::kinds()))]
        model: Vec<String>,
        #[command(flatten)]
        threads: ThreadOptions,
    },
    /// The models as materials: cantilevers of few cells beside the theory of beams, the elastica, modes and waves
    Beam(ThreadOptions),
    /// The patch test: irregular blocks in uniform strain
    Patch(ThreadOptions),
    /// Cook's membrane in the plane, beside the literature
    Cook(ThreadOptions),
    /// Loads: bodies at rest that are pulled, twisted, bent and pressed, beside closed forms and the literature
    Load(ThreadOptions),
    /// Contact: momenta, energies, rest, friction, waves and Hertz's law beside what is asked, and what crosses
    Contact(ThreadOptions),
    /// The error of the end of one beam against the time of a simulated second, by model and resolution
    BeamTime,
    /// Table 1 of the paper, the errors of the rotations from Eq. (15), beside ours
    Table1 {
        /// Number of random orientations; the first ones are the same for any number
        #[arg(long, value_name = "N", default_value_t = Table1::ORIENTATIONS)]
        #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
        orientations: u32,
        #[command(flatten)]
        threads: ThreadOptions,
    },
    /// The computation time of the shape model divided by that of mass-spring, beside the paper's ratio (section 4)
    Ratio {
        /// Number of threads
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: u16,
    },
}

/// Options of studies of a scene.
#[derive(Args, Debug)]
struct OfScene {
    /// The scene [default: built-in ones]
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: Option<PathBuf>,

    /// A model for the built-in scenes; can be repeated [default: those of the paper]
    #[arg(long, value_name = "KIND", conflicts_with = "scene", value_parser = PossibleValuesParser::new(models::kinds()))]
    model: Vec<String>,

    /// Measure more, which takes ten times as long or longer
    #[arg(long)]
    full: bool,
}

/// The arguments that give an option these values.
fn repeated(option: &str, values: &[String]) -> Vec<String> {
    values.iter().flat_map(|value| [option.to_owned(), value.clone()]).collect()
}

impl OfScene {
    /// The arguments that repeat it.
    fn arguments(&self) -> Vec<String> {
        let scene = self.scene.iter().map(|path| path.to_string_lossy().into_owned());
        scene.chain(repeated("--model", &self.model)).chain(self.full.then(|| "--full".to_owned())).collect()
    }

    fn load(&self) -> Result<Option<Scene>, Failure> {
        let Some(path) = &self.scene else { return Ok(None) };
        let scene = Scene::load(path, &Limits::default()).map_err(|error| Failure::usage(error.to_string()))?;
        if scene.duration == 0.0 {
            let path = path.display();
            return Err(Failure::usage(format!(
                "{path}: `time.duration` is 0: nothing moves, and there is nothing to measure; make it longer"
            )));
        }
        if let Some(run) = scene.runs.iter().find(|run| run.models.len() != 1) {
            return Err(Failure::usage(format!(
                "{}: “{}” has {} bodies with models, and a study measures one; give each run one body",
                path.display(),
                run.name,
                run.models.len()
            )));
        }
        Ok(Some(scene))
    }
}

impl Name {
    /// The study, with its number of threads and the arguments that repeat it.
    fn task(self) -> Result<Task, Failure> {
        Ok(match self {
            Self::Rotation => Task::new("rotation", Rotation::usual(), 1, Vec::new()),
            Self::WorkPrecision { only, of } => {
                let effort = if of.full { Effort::FULL } else { Effort::USUAL };
                let subjects =
                    of.load()?.map_or_else(|| Ok(work_precision::usual(&of.model)), |scene| subjects(&scene, &only))?;
                let arguments = [of.arguments(), repeated("--only", &only)].concat();
                Task::new("work-precision", WorkPrecision { effort, subjects }, 1, arguments)
            }
            Self::Stability { of, threads } => {
                let scene = of.load()?.unwrap_or_else(|| stability::usual(&of.model));
                let study = if of.full { Stability::full(scene) } else { Stability::usual(scene) };
                if study.work() == 0 {
                    return Err(Failure::usage(format!(
                        "all runs of “{}” choose their own steps, so there is nothing to map; give one another integrator",
                        study.scene.title
                    )));
                }
                Task::new("stability", study, threads.count(), of.arguments())
            }
            Self::Stress { model, threads } => {
                let study = Stress { steps: stress::STEPS, models: stress::compared(&model) };
                Task::new("stress", study, threads.count(), repeated("--model", &model))
            }
            Self::Beam(threads) => Task::new("beam", Beam::usual(), threads.count(), Vec::new()),
            Self::Patch(threads) => Task::new("patch", Patch::usual(), threads.count(), Vec::new()),
            Self::Cook(threads) => Task::new("cook", Cook::usual(), threads.count(), Vec::new()),
            Self::Load(threads) => Task::new("load", Loads::USUAL, threads.count(), Vec::new()),
            Self::Contact(threads) => Task::new("contact", Contact::usual(), threads.count(), Vec::new()),
            Self::BeamTime => Task::new("beam-time", Time::usual(), 1, Vec::new()),
            Self::Table1 { orientations, threads } => {
                let arguments = repeated("--orientations", &[orientations.to_string()]);
                Task::new("table1", Table1::new(orientations), threads.count(), arguments)
            }
            Self::Ratio { threads } => {
                let given = Some(threads.to_string()).filter(|_| threads != 1);
                let arguments = repeated("--threads", given.as_slice());
                Task::new("ratio", Ratio::new(threads.into()), threads.into(), arguments)
            }
        })
    }
}

/// The runs of a scene with these names; all runs without names.
fn subjects(scene: &Scene, only: &[String]) -> Result<Vec<Subject>, Failure> {
    if let Some(unknown) = only.iter().find(|name| scene.runs.iter().all(|run| run.name != **name)) {
        let names: Vec<_> = scene.runs.iter().map(|run| format!("“{}”", run.name)).collect();
        let names = names.join(", ");
        return Err(Failure::usage(format!(
            "--only {unknown}: “{}” has no run of this name; its runs are {names}",
            scene.title
        )));
    }
    let runs = (0..scene.runs.len()).filter(|&run| only.is_empty() || only.contains(&scene.runs[run].name));
    let subject = |run: usize| {
        let name = match scene.runs.len() {
            1 => scene.title.clone(),
            _ => format!("{}: {}", scene.title, scene.runs[run].name),
        };
        Subject { name, scene: scene.clone(), run }
    };
    Ok(runs.map(subject).collect())
}

fn main() -> ExitCode {
    let Cli { name, options } = Cli::parse();
    name.task().and_then(|task| study::make(&task, &options)).unwrap_or_else(Failure::report).into()
}
