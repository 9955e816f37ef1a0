//! `study work-precision`: the integrators.

use super::{Findings, Plan, StudyOptions, machine};
use crate::cli::failure::{Failure, Status};
use crate::cli::record;
use crate::cli::scenes::status_of;
#[cfg(feature = "render")]
use crate::picture::{Plot, PlotCurve, Plots};
use crate::scene::{Limits, Scene};
#[cfg(feature = "render")]
use crate::sim::integrate::Integrator;
#[cfg(feature = "render")]
use crate::study::work_precision::{Measured, Results, Study};
use crate::study::work_precision::{Protocol, Subject, measure, usual};
use clap::{Args, ValueHint};
use std::path::PathBuf;

/// The integrators: error of the positions against evaluations of the forces and time
#[derive(Args, Debug)]
pub(super) struct WorkPrecision {
    /// The scene, of which the first run is measured [default: a free lattice, a drop onto a floor and a disc in the plane]
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: Option<PathBuf>,

    /// Measure smaller steps and more turns, which takes ten times as long
    #[arg(long)]
    full: bool,

    #[command(flatten)]
    options: StudyOptions,
}

impl WorkPrecision {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let protocol = if self.full { Protocol::FULL } else { Protocol::USUAL };
        let subjects = self.subjects()?;
        let scene = self.scene.as_ref().map_or_else(String::new, |path| format!(" {}", path.display()));
        let mark = format!("localshape study work-precision{scene}{}", if self.full { " --full" } else { "" });
        let plan = Plan {
            name: "work-precision",
            mark: mark.clone(),
            plots: &["work-precision"],
            work: protocol.work(subjects.len()),
        };
        let pool = record::pool(1)?;
        self.options.run(&plan, |watch| {
            let results = pool.install(|| measure(protocol, &subjects, watch))?;
            let machine = machine();
            Some(Findings {
                markdown: results.markdown(&mark, &machine),
                csv: results.csv(),
                #[cfg(feature = "render")]
                plots: vec![plots(&results, &machine)],
                json: results.json(&machine),
            })
        })
    }

    fn subjects(&self) -> Result<Vec<Subject>, Failure> {
        let Some(path) = &self.scene else { return Ok(usual()) };
        let scene = Scene::load(path, &Limits::default()).map_err(|error| {
            crate::cli::failure::complain(&error.to_string());
            Failure::silent(status_of(&error))
        })?;
        if scene.duration == 0.0 {
            return Err(Failure::usage(format!(
                "{}: `time.duration` is 0: nothing moves, and there is nothing to measure; make it longer",
                path.display()
            )));
        }
        Ok(vec![(scene.title.clone(), scene)])
    }
}

/// For each scene errors against evaluations and against time.
#[cfg(feature = "render")]
fn plots(results: &Results, machine: &str) -> Plots {
    let of = |study: &Study| {
        let own = study.reference.as_ref().map_or(f64::INFINITY, |reference| reference.error);
        let plot = |name: String, axis: &str, across: fn(&Measured) -> f64, slopes| {
            let curve = |integrator: Integrator| {
                let is_shown = |one: &&Measured| one.error.is_some_and(|error| error > own && error < 1.0);
                let points = study.of(integrator).filter(is_shown).map(|one| [across(one), one.error.unwrap_or(1.0)]);
                PlotCurve {
                    name: crate::sim::words::typed(&integrator),
                    family: family(integrator),
                    is_strong: integrator == Integrator::default(),
                    points: points.collect(),
                }
            };
            let axes = [axis.to_owned(), "position error, as a share of the body's size".to_owned()];
            Plot { name, axes, curves: study.integrators().map(curve).collect(), slopes }
        };
        let slopes = Some(([8e3, 0.5], vec![-1.0, -2.0, -4.0]));
        [
            plot(study.name.clone(), "evaluations of the forces", |one| one.evaluations as f64, slopes),
            plot("Time".to_owned(), "time (s)", |one| one.time.median, None),
        ]
    };
    Plots {
        title: "Integrators: error against work".to_owned(),
        caption: vec![
            "Each dot is a run with half the step of the one before, or a tenth of the tolerance. Errors below that of the \
             reference are not shown."
                .to_owned(),
            format!("Times on one thread of {machine}."),
        ],
        plots: results.studies.iter().flat_map(of).collect(),
        columns: 2,
    }
}

/// One colour for each order.
#[cfg(feature = "render")]
fn family(integrator: Integrator) -> usize {
    match integrator {
        Integrator::SemiImplicitEuler | Integrator::ExplicitEuler | Integrator::BackwardEuler => 0,
        Integrator::VelocityVerlet => 1,
        Integrator::Pefrl | Integrator::ForestRuth | Integrator::RungeKutta => 2,
        Integrator::BlanesMoan => 3,
        Integrator::QuinlanTremaine => 4,
        Integrator::DormandPrince => 5,
    }
}
