//! `study work-precision`: the integrators.

use super::{Findings, OfScene, Plan, machine};
use crate::cli::failure::{Failure, Status};
use crate::cli::record;
#[cfg(feature = "render")]
use crate::picture::{Plot, PlotCurve, Plots};
#[cfg(feature = "render")]
use crate::sim::integrate::Integrator;
#[cfg(feature = "render")]
use crate::study::work_precision::{Measured, Results, Study};
use crate::study::work_precision::{Protocol, measure, usual};
use clap::Args;

/// The integrators: error of the positions of a scene's first run against evaluations of the forces and time
#[derive(Args, Debug)]
pub(super) struct WorkPrecision {
    #[command(flatten)]
    of: OfScene,
}

impl WorkPrecision {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let protocol = if self.of.full { Protocol::FULL } else { Protocol::USUAL };
        let subjects = self.of.subject()?.map_or_else(usual, |scene| vec![(scene.title.clone(), scene)]);
        let mark = self.of.mark("work-precision");
        let plan = Plan {
            name: "work-precision",
            mark: mark.clone(),
            plots: &["work-precision"],
            work: protocol.work(subjects.len()),
        };
        let pool = record::pool(1)?;
        self.of.options.run(&plan, |watch| {
            let results = pool.install(|| measure(protocol, &subjects, watch))?;
            let machine = machine();
            Some(Findings {
                markdown: results.markdown(&mark, &machine),
                csv: results.csv(),
                #[cfg(feature = "render")]
                plots: vec![Box::new(plots(&results, &machine))],
                json: results.json(&machine),
            })
        })
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
