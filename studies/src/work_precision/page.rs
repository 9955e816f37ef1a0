//! The plots of integrators, and those of solvers of rotations.

use super::method::Method;
use super::{Comparison, Measured, Results};
use crate::page::{Line, Page, Plot, Plots};
use crate::solver::Solver;
use crate::turns::machine;
use localshape::sim::Integrator;

/// The name of the axis upwards.
const ERROR: &str = "position error, as a share of the body's size";

/// A curve through measurements.
fn line<'a>(
    (name, family, is_strong): (&str, usize, bool),
    measured: impl Iterator<Item = &'a Measured>,
    across: fn(&Measured) -> f64,
) -> Line {
    let points = measured.filter_map(|one| Some([across(one), one.error.filter(|&error| error < 1.0)?]));
    Line { name: name.to_owned(), family, is_strong, points: points.collect() }
}

impl Results {
    pub(super) fn pages(&self) -> Vec<(&'static str, Box<dyn Page>)> {
        let mut pages: Vec<(_, Box<dyn Page>)> = vec![("work-precision", Box::new(self.integrators()))];
        if self.comparisons.iter().any(|one| one.solvers().next().is_some()) {
            pages.push(("work-precision-rotations", Box::new(self.rotations())));
        }
        pages
    }

    /// For each run errors against evaluations and against time.
    fn integrators(&self) -> Plots {
        let of = |comparison: &Comparison| {
            let plot = |name: &str, axis: &str, across: fn(&Measured) -> f64, slopes| {
                let one = |method: Method| {
                    let look = (method.name(), method.family(), method == Method::DEFAULT);
                    line(look, comparison.of(method), across)
                };
                let axes = [axis.to_owned(), ERROR.to_owned()];
                Plot { name: name.to_owned(), axes, curves: comparison.methods().map(one).collect(), slopes }
            };
            let slopes = Some(([8e3, 0.5], vec![-1.0, -2.0, -4.0]));
            [
                plot(&comparison.name, "evaluations of the forces", |one| one.evaluations as f64, slopes),
                plot("Time", "time (s)", |one| one.time.median, None),
            ]
        };
        Plots {
            title: "Integrators: error against work".to_owned(),
            caption: vec![
                "Each dot is a run with half the step of the one before, or a tenth of the tolerance; its error is the largest over \
                 the whole time."
                    .to_owned(),
                format!("Times on one thread of {}.", machine()),
            ],
            plots: self.comparisons.iter().flat_map(of).collect(),
            columns: 2,
        }
    }

    /// For each run in space errors against time with each solver of rotations, by a method with one evaluation a step, and by
    /// one with several.
    fn rotations(&self) -> Plots {
        let of = |comparison: &Comparison| {
            let several = [Method::PEFRL, Method::RUNGE_KUTTA];
            let several = several.into_iter().find(|&one| comparison.of(one).next().is_some());
            let plot = |method: Method| {
                let curves = comparison.solvers().map(|solver| {
                    let look = (solver.name(), solver.family(), solver == Solver::DEFAULT);
                    line(look, comparison.with(method, solver), |one| one.time.median)
                });
                let curves = curves.filter(|curve| !curve.points.is_empty()).collect();
                let axes = ["time (s)".to_owned(), ERROR.to_owned()];
                Plot { name: format!("{}, {}", comparison.name, method.name()), axes, curves, slopes: None }
            };
            [Some(Method::VERLET), several].into_iter().flatten().map(plot).collect::<Vec<_>>()
        };
        Plots {
            title: "Solvers of rotations: error of the motion against time".to_owned(),
            caption: vec![
                "Each dot is a run with a quarter of the step of the one before, and of robust with half of it."
                    .to_owned(),
                "Solvers with a fixed number of passes need a method of one evaluation a step.".to_owned(),
                format!("Times on one thread of {}; robust and arctangent are vectorised.", machine()),
            ],
            plots: self.comparisons.iter().filter(|one| one.solvers().next().is_some()).flat_map(of).collect(),
            columns: 2,
        }
    }
}

impl Method {
    /// The number of the family of its order.
    fn family(self) -> usize {
        match self {
            Self::Scene(Integrator::VelocityVerlet) => 1,
            Self::Scene(Integrator::Pefrl | Integrator::RungeKutta) | Self::ForestRuth => 2,
            Self::BlanesMoan => 3,
            Self::QuinlanTremaine => 4,
            Self::Scene(Integrator::DormandPrince) => 5,
            Self::Scene(_) => 0,
        }
    }
}
