//! The plots.

use super::method::Method;
use super::{Comparison, Measured, Results};
use crate::page::{Contents, Line, Page, Plot};
use crate::turns::machine;

/// The name of the axis upwards.
const ERROR: &str = "position error, as a share of the body's size";

impl Results {
    /// For each run errors against evaluations and against time.
    pub(super) fn page(&self) -> Page {
        let of = |comparison: &Comparison| {
            let plot = |name: &str, axis: &'static str, across: fn(&Measured) -> f64, slopes| {
                let line = |method: Method| {
                    let points = comparison.of(method).filter_map(|one| {
                        let error = one.error.filter(|&error| error < 1.0)?;
                        Some([across(one), error])
                    });
                    let name = method.names().into_iter().rfind(|name| !name.is_empty()).unwrap_or_default();
                    let (family, is_strong) = (method.family.to_owned(), method == Method::DEFAULT);
                    Line { name, family, is_strong, points: points.collect() }
                };
                let axes = [axis, ERROR];
                Plot { name: name.to_owned(), axes, curves: comparison.methods().map(line).collect(), slopes }
            };
            let slopes = Some(([50.0, 3e-8], vec![-1.0, -2.0, -4.0]));
            [
                plot(&comparison.name, "evaluations of the forces", |one| one.evaluations as f64, slopes),
                plot("Time", "time (s)", |one| one.time.median, None),
            ]
        };
        Page {
            title: "Integrators: error against work".to_owned(),
            caption: vec![
                "Each dot is a run with half the step of the one before, or a tenth of the tolerance; its error is the largest over \
                 the whole time."
                    .to_owned(),
                format!("Times on one thread of {}.", machine()),
            ],
            contents: Contents::Plots(self.comparisons.iter().flat_map(of).collect()),
        }
    }
}
