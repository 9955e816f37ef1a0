//! The plots: order of convergence, then errors against time for three increments.

use super::sample::Kind;
use super::{Measured, Results, Solver};
use crate::page::{Contents, Line, Page, Plot};
use crate::turns::machine;

impl Results {
    pub(super) fn page(&self) -> Page {
        /// The strain of all plots.
        const STRAIN: f64 = 0.5;
        /// Errors below this are round-off of the rotation itself (rad).
        const ROUND_OFF: f64 = 1e-16;
        /// Beyond this increment (rad) most iterations switch to another solver.
        const QUARTER: f64 = 1.6;
        let error = "worst angle error (rad)";
        let solvers: Vec<(usize, &Solver)> = self.solvers.iter().enumerate().collect();
        let curve = |solver: &Solver, points: Vec<[f64; 2]>| Line {
            name: solver.name.to_owned(),
            family: solver.family().to_owned(),
            is_strong: solver.is_default(),
            points: points.into_iter().map(|[x, error]| [x, error.max(ROUND_OFF)]).collect(),
        };
        // One pass of each iteration, and the default.
        let single = solvers.iter().filter(|(_, solver)| solver.passes == Some(1) || solver.is_default());
        let orders = single.map(|&(at, solver)| {
            let warm = self.of(at, STRAIN).filter(|(increment, _)| *increment < QUARTER);
            let points = warm.map(|(increment, one)| [increment, one.worst]);
            curve(solver, points.collect())
        });
        let by_time = [0.01, 0.1, 1.0].map(|increment| {
            let groups = solvers.chunk_by(|(_, one), (_, other)| one.name == other.name);
            let curves = groups.map(|group| {
                let found = group.iter().filter_map(|&(at, _)| self.of(at, STRAIN).find(|(own, _)| *own == increment));
                let points = found.map(|(_, one)| [one.time.median, one.worst]).collect();
                curve(group[0].1, points)
            });
            Plot {
                name: format!("Elements turned by {increment} rad since the last rotation"),
                axes: ["time for each element (ns)", error],
                curves: curves.collect(),
                slopes: None,
            }
        });
        let order = Plot {
            name: "One pass: error against increment".to_owned(),
            axes: ["increment since the last rotation (rad)", error],
            curves: orders.collect(),
            slopes: Some(([0.9, 1e-8], vec![1.0, 2.0, 3.0, 5.0])),
        };
        Page {
            title: "Solvers of rotations: error against time".to_owned(),
            caption: vec![
                format!(
                    "Cubes stretched by up to ±{STRAIN}, in double precision. Dots on a line: 1, 2 and 3 passes; of mueller \
                     1, 2, 5 and 20."
                ),
                format!("Times on one thread of {}.", machine()),
            ],
            contents: Contents::Plots([order].into_iter().chain(by_time).collect()),
        }
    }

    /// A solver at a strain, with its increments (rad).
    fn of(&self, solver: usize, strain: f64) -> impl Iterator<Item = (f64, &Measured)> {
        self.measured.iter().filter(move |one| one.solver == solver).filter_map(move |one| match one.kind {
            Kind::Warm { strain: own, increment } if own == strain => Some((increment, one)),
            _ => None,
        })
    }
}

impl Solver {
    /// Its family.
    fn family(&self) -> &'static str {
        match self.name {
            "symmetric" | "cayley" | "quintic" | "kugelstadt" => "Newton's methods",
            "mueller" => "relaxation",
            "SVD (library)" | "davenport" | "closed-form" => "global solvers",
            "robust" => "the default",
            _ => "readings of the paper",
        }
    }
}
