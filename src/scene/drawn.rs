//! The properties of a scene that only drawing needs.

use super::{Run, Scene};
use crate::look::{LineStyle, Palette};
use crate::sim::{Diagnostic, Grip, Motion};

impl Scene {
    /// Whether pictures depend on more than states: a clock, the course of the scene, or moving objects.
    pub(crate) fn shows_time(&self) -> bool {
        let view = &self.view;
        let is_moved = |grip: &Grip| grip.motion != Motion::Still || grip.from > 0.0 || grip.until.is_finite();
        view.labels.clock
            || self.time_series().is_some()
            || self.obstacles.iter().any(|obstacle| obstacle.motion != Motion::Still)
            || self.runs.iter().flat_map(|run| &run.grips).any(is_moved)
    }

    /// The diagnostics of a frame in its picture: the number of each run, and the present value in a chart.
    pub(crate) fn frame_diagnostics(&self) -> Vec<Diagnostic> {
        self.view.charts.iter().copied().chain([Diagnostic::ShapeError]).collect()
    }
}

impl Run {
    /// The run's line in pictures of a palette.
    pub(crate) fn line(&self, palette: &Palette) -> LineStyle {
        palette.line(self.place, self.colour)
    }
}
