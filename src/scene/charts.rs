//! What the charts of a scene show.

use super::{Scene, SceneBody};
use crate::look::{Measure, Plot, PlotOf};
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, Here};
use crate::reading::coordinates::{direction, vector};
use crate::reading::words::{list, nearest, quoted};
use crate::sim::model::ElasticModel;
use crate::sim::{Diagnostic, Dimension, Obstacle, Shape, geometry};

impl Scene {
    /// The charts whose time series pictures need; `None` if pictures do not show the course of the whole scene.
    /// Charts, paths, cameras that follow, and the drawn sizes of plates and walls show it.
    pub(crate) fn time_series(&self) -> Option<&[Plot]> {
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
        self.view.visible.contacts || self.view.charts.iter().any(Plot::is_of_forces)
    }

    /// Reports charts that no run of these scenes has, and charts that are there already, in a table of a file.
    pub(super) fn check_charts(charts: &[Plot], scenes: &[Self], table: &'static str, report: &Collector<'_>) {
        for (index, chart) in charts.iter().enumerate() {
            let entry = |at: usize| report.to(table).to("charts").to(at);
            let here = entry(index);
            let found = chart.diagnostic().map_or("the same".to_owned(), |one| quoted(&typed(&one)));
            if let Some(first) = charts[..index].iter().position(|other| other == chart) {
                let message = format!("`{here}` is {found}, as is `{}`", entry(first));
                here.wrong(message, "expected each diagnostic once; remove one");
            } else if let Plot::Of(of) = chart {
                scenes.iter().for_each(|scene| scene.check_plot(of, &here));
                if scenes.len() > 1 && of.against.is_some() {
                    let message = format!("`{here}` is against a displacement, but of {} scenes", scenes.len());
                    here.to("against").wrong(message, "such a chart shows one scene; remove `against`");
                }
            } else if let Some((message, help)) = Self::lacks_bodies(chart, scenes) {
                here.wrong(format!("`{here}` is of each body, but {message}"), help);
            } else if let Some(why) =
                scenes.iter().map(|scene| scene.lacks(chart.diagnostic()?)).reduce(Option::and).flatten()
            {
                here.wrong(format!("`{here}` is {found}, which no run has"), why);
            }
        }
    }

    /// Why a chart of each body shows nothing, and the remedy.
    fn lacks_bodies(chart: &Plot, scenes: &[Self]) -> Option<(&'static str, &'static str)> {
        let Plot::ByBody(_) = chart else { return None };
        match scenes {
            [scene] if scene.runs.iter().all(|run| run.of.len() < 2) => {
                Some(("no run has several", "write the name of the diagnostic alone"))
            }
            [_] => None,
            _ => Some(("there are several scenes", "write the name of the diagnostic alone, for the mean over scenes")),
        }
    }

    /// Reports a chart at a path of a thing that is not there, or without a direction.
    fn check_plot(&self, of: &PlotOf, here: &Here<'_>) {
        let (exerting, moving) = (self.exerting(), self.moving());
        let measured = if of.plot == Measure::Displacement { &moving } else { &exerting };
        let is_other = |name: &&str| of.plot != Measure::Displacement && *name != of.of;
        let bodies = self.bodies.iter().filter(|_| self.bodies.len() > 1).map(|body| body.name.as_str());
        let others = bodies.filter(is_other).collect();
        let named = [
            ("of", Some(&of.of), measured),
            ("on", of.on.as_ref(), &others),
            ("against", of.against.as_ref(), &moving),
        ];
        for (key, name, known) in named.into_iter().filter_map(|(key, name, known)| Some((key, name?, known))) {
            if known.contains(&name.as_str()) {
                continue;
            }
            let what = match (key, of.plot) {
                ("on", Measure::Displacement) => "no `on`, which is a body that a force or a torque acts on",
                ("on", _) => "one of several bodies that a force or a torque acts on",
                ("of", Measure::Force | Measure::Torque) => "an obstacle, a hold, a grab or one of several bodies",
                _ => "a probe, a hold, a grab or an obstacle",
            };
            let all = list(known, "or", quoted);
            let expected = match (key, of.plot) {
                ("on", Measure::Displacement) => what.to_owned(),
                _ if known.is_empty() => format!("{what}; there is none"),
                _ => format!("{what}: {all}"),
            };
            let help = nearest(name, known).map(|near| format!("did you mean {}?", quoted(near)));
            let here = here.to(key);
            here.wrong(format!("`{here}` is {}; expected {expected}", quoted(name)), help);
            return;
        }
        let at = here.to("along");
        if let Some(typed) = &of.along {
            vector(typed, self.dimension(), &at).and_then(|along| direction(along, &at));
        } else if let Some(against) = of.against.as_ref().filter(|_| self.along(of).is_none()) {
            let message = format!("`{here}` has no `along`, and {} has no path", quoted(against));
            here.wrong(message, "give the direction of the force and the displacement, such as along = [0, -1, 0]");
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
            report.residual.is_some()
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
