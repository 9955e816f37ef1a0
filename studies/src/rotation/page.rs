//! The plots: order of convergence, then errors against time for three increments.

use super::method::Method;
use super::sample::Kind;
use super::{Measured, Results};
use crate::page::{Line, Plot, Plots};
use crate::solver::Solver;
use crate::turns::machine;

impl Results {
    pub(super) fn page(&self) -> Plots {
        /// The strain of all plots.
        const STRAIN: f64 = 0.5;
        /// Errors below this are round-off of the rotation itself (rad).
        const ROUND_OFF: f64 = 1e-16;
        /// Beyond this increment (rad) most iterations leave it to another solver.
        const QUARTER: f64 = 1.6;
        let error = "worst angle error (rad)".to_owned();
        let methods: Vec<(usize, &Method)> = self.methods.iter().enumerate().collect();
        let curve = |name: &str, family: usize, is_strong: bool, points: Vec<[f64; 2]>| {
            let points = points.into_iter().map(|[x, error]| [x, error.max(ROUND_OFF)]).collect();
            Line { name: name.to_owned(), family, is_strong, points }
        };
        // One pass of each iteration, and the default.
        let single = methods.iter().filter(|(_, method)| method.is_single() || method.is_default());
        let orders = single.map(|&(at, method)| {
            let warm = self.of(at, STRAIN).filter(|(increment, _)| *increment < QUARTER);
            let points = warm.map(|(increment, one)| [increment, one.worst]);
            curve(method.name(), method.family(), method.is_default(), points.collect())
        });
        let by_time = [0.01, 0.1, 1.0].map(|increment| {
            let groups = methods.chunk_by(|(_, one), (_, other)| one.name() == other.name());
            let curves = groups.map(|group| {
                let found = group.iter().filter_map(|&(at, _)| self.at(at, STRAIN, increment));
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
                format!("Times on one thread of {}.", machine()),
            ],
            plots: [order].into_iter().chain(by_time).collect(),
            columns: 2,
        }
    }

    /// A method at a strain, with its increments (rad).
    fn of(&self, method: usize, strain: f64) -> impl Iterator<Item = (f64, &Measured)> {
        self.measured.iter().filter(move |one| one.method == method).filter_map(move |one| match one.kind {
            Kind::Warm { strain: own, increment } if own == strain => Some((increment, one)),
            _ => None,
        })
    }

    /// A method at a strain and an increment (rad).
    fn at(&self, method: usize, strain: f64, increment: f64) -> Option<&Measured> {
        self.of(method, strain).find(|(own, _)| *own == increment).map(|(_, one)| one)
    }
}

impl Method {
    /// Whether it is one pass of an iteration.
    fn is_single(&self) -> bool {
        self.passes == Some(1)
    }

    /// The number of its family.
    fn family(&self) -> usize {
        self.solver.unwrap_or(Solver::Davenport).family()
    }
}
