//! `study work-precision`: the integrators.

use super::{Findings, OfScene, Plan, machine};
use crate::cli::failure::{Failure, Status};
use crate::cli::record;
use crate::cli::scenes::runs_of;
#[cfg(feature = "render")]
use crate::picture::{Page, Plot, PlotCurve, Plots};
#[cfg(feature = "render")]
use crate::sim::integrate::Integrator;
#[cfg(feature = "render")]
use crate::sim::words::typed;
#[cfg(feature = "render")]
use crate::study::rotation::method::family as family_of_rotation;
#[cfg(feature = "render")]
use crate::study::work_precision::{Measured, Results, Study};
use crate::study::work_precision::{Protocol, Subject, measure, usual};
use clap::Args;

/// The integrators: error of the positions against evaluations of the forces and time
#[derive(Args, Debug)]
pub(super) struct WorkPrecision {
    /// Only this run of the scene; can be repeated [default: all]
    #[arg(long, value_name = "RUN", requires = "scene")]
    only: Vec<String>,

    #[command(flatten)]
    of: OfScene,
}

impl WorkPrecision {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let protocol = if self.of.full { Protocol::FULL } else { Protocol::USUAL };
        let subjects = self.subjects()?;
        let mut mark = self.of.mark("work-precision");
        self.only.iter().for_each(|run| mark += &format!(" --only \"{run}\""));
        let all = ["work-precision", "work-precision-rotations"];
        let has_solvers = subjects.iter().any(Subject::has_solvers);
        let plan = Plan {
            name: "work-precision",
            mark: mark.clone(),
            plots: if has_solvers { &all } else { &all[..1] },
            work: protocol.work(&subjects),
        };
        let pool = record::pool(1)?;
        self.of.options.run(&plan, Some(&self.of.plots), |watch| {
            let results = pool.install(|| measure(protocol, &subjects, watch))?;
            let machine = machine();
            Some(Findings {
                markdown: results.markdown(&mark, &machine),
                csv: results.csv(),
                #[cfg(feature = "render")]
                plots: [Some(plots(&results, &machine)), has_solvers.then(|| rotations(&results, &machine))]
                    .into_iter()
                    .flatten()
                    .map(|page| Box::new(page) as Box<dyn Page>)
                    .collect(),
                json: results.json(&machine),
            })
        })
    }

    fn subjects(&self) -> Result<Vec<Subject>, Failure> {
        let Some(scene) = self.of.subject()? else { return Ok(usual()) };
        let runs = runs_of(&self.only, &scene)?;
        let subject = |run: usize| {
            let name = match scene.runs.len() {
                1 => scene.title.clone(),
                _ => format!("{}: {}", scene.title, scene.runs[run].name),
            };
            Subject { name, scene: scene.clone(), run }
        };
        Ok(runs.into_iter().map(subject).collect())
    }
}

/// The name of the axis upwards.
#[cfg(feature = "render")]
const ERROR: &str = "position error, as a share of the body's size";

/// A curve through measurements, without errors below that of the reference.
#[cfg(feature = "render")]
fn curve<'a>(
    study: &Study,
    (name, family, is_strong): (String, usize, bool),
    measured: impl Iterator<Item = &'a Measured>,
    across: fn(&Measured) -> f64,
) -> PlotCurve {
    let own = study.reference.as_ref().map_or(f64::INFINITY, |reference| reference.error);
    let points = measured.filter_map(|one| Some([across(one), one.error.filter(|&error| error > own && error < 1.0)?]));
    PlotCurve { name, family, is_strong, points: points.collect() }
}

/// For each run errors against evaluations and against time.
#[cfg(feature = "render")]
fn plots(results: &Results, machine: &str) -> Plots {
    let of = |study: &Study| {
        let plot = |name: String, axis: &str, across: fn(&Measured) -> f64, slopes| {
            let one = |integrator: Integrator| {
                let look = (typed(&integrator), family(integrator), integrator == Integrator::default());
                curve(study, look, study.of(integrator), across)
            };
            let axes = [axis.to_owned(), ERROR.to_owned()];
            Plot { name, axes, curves: study.integrators().map(one).collect(), slopes }
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

/// For each run in space errors against time with each solver of rotations, by a method with one evaluation a step, and by
/// one with several.
#[cfg(feature = "render")]
fn rotations(results: &Results, machine: &str) -> Plots {
    let of = |study: &Study| {
        let several = [Integrator::Pefrl, Integrator::RungeKutta];
        let several = several.into_iter().find(|&one| study.of(one).next().is_some());
        let plot = |integrator: Integrator| {
            let curves = study.solvers().map(|rotation| {
                let look = (typed(&rotation), family_of_rotation(rotation), rotation == Default::default());
                curve(study, look, study.with(integrator, rotation), |one| one.time.median)
            });
            let curves: Vec<_> = curves.filter(|curve| !curve.points.is_empty()).collect();
            let axes = ["time (s)".to_owned(), ERROR.to_owned()];
            Plot { name: format!("{}, {}", study.name, typed(&integrator)), axes, curves, slopes: None }
        };
        [Some(Integrator::VelocityVerlet), several].into_iter().flatten().map(plot).collect::<Vec<_>>()
    };
    Plots {
        title: "Solvers of rotations: error of the motion against time".to_owned(),
        caption: vec![
            "Each dot is a run with a quarter of the step of the one before, and of robust with half of it.".to_owned(),
            "Solvers with a fixed number of passes need a method of one evaluation a step.".to_owned(),
            format!("Times on one thread of {machine}; robust and arctangent are vectorised."),
        ],
        plots: results.studies.iter().filter(|study| study.solvers().next().is_some()).flat_map(of).collect(),
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
