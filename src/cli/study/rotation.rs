//! `study rotation`: the solvers of rotations.

use super::{Findings, Plan, PlotOptions, StudyOptions, machine};
use crate::cli::failure::{Failure, Status};
#[cfg(feature = "render")]
use crate::picture::{Plot, PlotCurve, Plots};
use crate::study::rotation::{Protocol, Results, measure};
use clap::Args;

/// The solvers of rotations: angle error against time for each element, and what they make of degenerate elements
#[derive(Args, Debug)]
pub(super) struct Rotation {
    #[command(flatten)]
    options: StudyOptions,
    #[command(flatten)]
    plots: PlotOptions,
}

impl Rotation {
    pub(super) fn run(self) -> Result<Status, Failure> {
        let protocol = Protocol::default();
        let mark = "localshape study rotation".to_owned();
        let plan = Plan { name: "rotation", mark: mark.clone(), plots: &["rotation"], work: protocol.work() };
        self.options.run(&plan, Some(&self.plots), |watch| {
            let results = measure(&protocol, watch)?;
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

/// Order of convergence, then errors against time for three increments.
#[cfg(feature = "render")]
fn plots(results: &Results, machine: &str) -> Plots {
    /// The strain of all plots.
    const STRAIN: f64 = 0.5;
    /// Errors below this are round-off of the rotation itself (rad).
    const ROUND_OFF: f64 = 1e-16;
    /// Beyond this increment (rad) most iterations leave it to another solver.
    const QUARTER: f64 = 1.6;
    let error = "worst angle error (rad)".to_owned();
    let methods = results.methods();
    let curve = |name: &str, family: usize, is_strong: bool, points: Vec<[f64; 2]>| {
        let points = points.into_iter().map(|[x, error]| [x, error.max(ROUND_OFF)]).collect();
        PlotCurve { name: name.to_owned(), family, is_strong, points }
    };
    // One pass of each iteration, and the default.
    let single = methods.iter().filter(|(_, method)| method.is_single() || method.is_default());
    let orders = single.map(|&(at, method)| {
        let warm = results.of(at, STRAIN).filter(|(increment, _)| *increment < QUARTER);
        let points = warm.map(|(increment, one)| [increment, one.worst]);
        curve(method.name(), method.family(), method.is_default(), points.collect())
    });
    let by_time = [0.01, 0.1, 1.0].map(|increment| {
        let groups = methods.chunk_by(|(_, one), (_, other)| one.name() == other.name());
        let curves = groups.map(|group| {
            let found = group.iter().filter_map(|&(at, _)| results.at(at, STRAIN, increment));
            let points = found.map(|one| [one.time.median, one.worst]).collect();
            let (_, method) = group[0];
            curve(method.name(), method.family(), method.is_default(), points)
        });
        Plot {
            name: format!("Elements turned by {increment} rad since the last rotation"),
            axes: ["time for each element (ns)".to_owned(), error.clone()],
            curves: curves.collect(),
            slopes: None,
        }
    });
    let order = Plot {
        name: "One pass: error against increment".to_owned(),
        axes: ["increment since the last rotation (rad)".to_owned(), error.clone()],
        curves: orders.collect(),
        slopes: Some(([0.9, 1e-8], vec![1.0, 2.0, 3.0, 5.0])),
    };
    Plots {
        title: "Solvers of rotations: error against time".to_owned(),
        caption: vec![
            format!(
                "Cubes stretched by up to ±{STRAIN}, in double precision. Dots on a line: 1, 2 and 3 passes; of mueller \
                 1, 2, 5 and 20."
            ),
            format!("Times on one thread of {machine}."),
        ],
        plots: [order].into_iter().chain(by_time).collect(),
        columns: 2,
    }
}
