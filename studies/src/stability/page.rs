//! A map for each run, damping and speed.

use super::text::short;
use super::{Axes, Results};
use crate::page::{Contents, Map, Page};

impl Results {
    pub(super) fn page(&self) -> Page {
        /// Shares at which steps are written.
        const TICKS: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];
        let map = |(axes, speed): (&Axes, f64)| {
            let cells: Vec<_> = self.of(axes, speed).collect();
            let mut across: Vec<f64> = cells.iter().map(|cell| cell.rate).collect();
            across.dedup();
            let tick = |share: f64| (share, [short(share), format!("T/{:.1}", axes.steps_per_cycle(share))]);
            let limit = axes.limit.map(|_| (1.0, "predicted limit"));
            let stretched = axes.stretched.filter(|&share| share < 1.0).map(|share| (share, "with stretched springs"));
            // The conditions distinguish several maps of a run; the model is in the tables.
            let [name, conditions, model] = self.words(axes, speed);
            Map {
                name: [name, if conditions.is_empty() { model } else { conditions }],
                across,
                up: self.study.shares.clone(),
                cells: cells.iter().map(|cell| cell.turned_over).collect(),
                ticks: TICKS.map(tick).into(),
                lines: limit.into_iter().chain(stretched).collect(),
                axes: [
                    "k/m (1/s²)".to_owned(),
                    if axes.limit.is_some() { "ΔT, as a share of the limit" } else { "ΔT, as a share of T/π" }
                        .to_owned(),
                    "ΔT".to_owned(),
                ],
            }
        };
        Page {
            title: format!("Stability: {}", self.study.scene.title),
            caption: vec![
                "Each cell is a run. The stiffness changes with the same damping ratio; the limit is predicted before the run, at rest."
                    .to_owned(),
            ],
            contents: Contents::Maps(self.maps().map(map).collect(), self.study.speeds.len().clamp(2, 3)),
        }
    }
}

impl Axes {
    /// The cycle T in steps, for a share of the unit.
    fn steps_per_cycle(&self, share: f64) -> f64 {
        1.0 / (share * self.limit.unwrap_or(std::f64::consts::FRAC_1_PI))
    }
}
