//! The diagnostics that pictures of a scene show over time.

use super::{Scene, SceneBody};
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, key_path};
use crate::reading::words::quoted;
use crate::sim::model::{ElasticModel, Report};
use crate::sim::{Diagnostic, Dimension, Obstacle, Shape, geometry};

impl Scene {
    /// The diagnostics whose time series pictures need; `None` if pictures do not show the course of the whole scene.
    /// Charts, paths, cameras that follow, and the drawn sizes of plates and walls show it.
    pub(crate) fn time_series(&self) -> Option<&[Diagnostic]> {
        let view = &self.view;
        let is_flat = self.dimension() == Dimension::Plane;
        let ground = geometry::ground(&self.obstacles, 0.0);
        let has_size = |one: &Obstacle| match one.shape {
            Shape::Plate { .. } => true,
            Shape::Floor { .. } => one.floor(0.0) != ground,
            _ => false,
        };
        let needed = !view.charts.is_empty()
            || !view.paths.is_empty()
            || view.camera.follow
            || (!is_flat && self.obstacles.iter().any(has_size));
        needed.then_some(&view.charts[..])
    }

    /// Whether charts or marks tell of forces of contact or of constraints, so that they are kept.
    pub(crate) fn keeps_forces(&self) -> bool {
        self.view.visible.contacts || self.view.charts.iter().any(|chart| chart.is_of_forces())
    }

    /// Reports charts that no run of these scenes has, and charts that are there already, in a table of a file.
    pub(super) fn check_charts(
        charts: &[Diagnostic],
        scenes: &[Self],
        table: &'static str,
        report: &mut Collector<'_>,
    ) {
        for (index, chart) in charts.iter().enumerate() {
            let (path, found) = (key_path![table, "charts", index], quoted(&typed(chart)));
            if let Some(first) = charts[..index].iter().position(|other| other == chart) {
                let message = format!("`{table}.charts[{index}]` is {found}, as is `{table}.charts[{first}]`");
                report.at(&path, message, "expected each diagnostic once; remove one".to_owned());
            } else if let Some(why) = scenes.iter().map(|scene| scene.lacks(*chart)).reduce(Option::and).flatten() {
                report.at(&path, format!("`{table}.charts[{index}]` is {found}, which no run has"), why);
            }
        }
    }

    /// The message for a diagnostic that no run has, with the diagnostics that charts can show; `None` if a run may
    /// have it.
    fn lacks(&self, diagnostic: Diagnostic) -> Option<&'static str> {
        let has = |has: &dyn Fn(&dyn ElasticModel, &SceneBody) -> bool| {
            self.runs.iter().any(|run| run.parts(self).any(|(model, body)| has(model, body)))
        };
        // Only the model can tell, from its forces.
        let has_residual = |model: &dyn ElasticModel, SceneBody { body, initial, .. }: &SceneBody| {
            let (forces, memory) = (model.prepare(body), model.start(body, &initial.position));
            let report = forces.report(initial.nodes(), &memory, &mut |_, _, _| ());
            report.residual(Report::ROTATION).is_some()
        };
        let (exists, why) = match diagnostic {
            Diagnostic::Elastic | Diagnostic::Energy => {
                (has(&|_, _| true), "recordings have none; plot another diagnostic, such as \"kinetic\"")
            }
            Diagnostic::GlobalRotations => (
                has(&|model, of| model.properties(&of.body).counts_fallbacks),
                "only shape-based models in space count them; plot another diagnostic, such as \"turned_over\"",
            ),
            Diagnostic::Broken => (
                has(&|model, of| model.properties(&of.body).breakable.is_some()),
                "only models with `breaks_at` break; give it, or plot another diagnostic, such as \"turned_over\"",
            ),
            Diagnostic::ContactForce | Diagnostic::ContactTorque => (
                has(&|_, _| true) && (!self.obstacles.is_empty() || self.runs.iter().any(|run| run.of.len() > 1)),
                "nothing is there to touch, or all is recorded; add an obstacle or a body, or plot another diagnostic, such as \"kinetic\"",
            ),
            Diagnostic::HoldForce | Diagnostic::HoldTorque => (
                self.runs.iter().any(|run| !run.grips.is_empty()),
                "nothing is held, or all is recorded; add a [[hold]], or plot another diagnostic, such as \"contact_force\"",
            ),
            Diagnostic::Work => (
                self.runs.iter().any(|run| !run.loads.is_empty()),
                "there are no loads, or all is recorded; add a [[load]], or plot another diagnostic, such as \"energy\"",
            ),
            Diagnostic::Crossings => (
                has(&|_, _| true) && self.contacts.is_some(),
                "with `rule = \"nodes\"` surfaces do not meet, and nothing is known of recordings; plot another diagnostic, such as \"turned_over\"",
            ),
            Diagnostic::Residual => (
                has(&has_residual),
                "models without rotations, such as springs, have none; plot another diagnostic, such as \"turned_over\"",
            ),
            _ => return None,
        };
        (!exists).then_some(why)
    }
}
