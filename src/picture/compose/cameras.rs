//! The arrangement and the cameras of the panels of a frame.

use super::Composer;
use crate::look::Traced;
use crate::picture::Framing;
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::tracking::Shot;
use crate::scene::Scene;
use crate::sim::RunFrame;

/// The most columns of panels that a scene does not arrange itself, and how many times larger bodies must become for
/// fewer columns than possible.
const MOST_COLUMNS: usize = 64;
const LARGER: f64 = 1.02;

impl Composer<'_> {
    /// The number of columns for the panels of some runs: that of the scene, or the one with the largest bodies.
    pub(super) fn columns(&self, runs: &[usize]) -> usize {
        let (view, words) = (&self.scene.view, self.words());
        let pixels = |columns: usize| {
            let layout = words.around(runs, columns).layout;
            let panel = *layout.panels.first()?;
            let shot = self.shot(panel, layout.scale).map(|shot| shot.pixels);
            let still = || self.pixels_a_metre(panel, &Framing::still(&view.camera), layout.scale);
            Some(shot.unwrap_or_else(still))
        };
        let panels = runs.len();
        let most = panels.clamp(1, MOST_COLUMNS);
        let chosen = || {
            let mut best = (most, pixels(most).unwrap_or(0.0));
            // For each number of rows the columns are as even as possible. One row is preferred if bodies are nearly as
            // large.
            for columns in (2..=panels).map(|rows| panels.div_ceil(rows)).filter(|&columns| columns < most) {
                let pixels = pixels(columns).unwrap_or(0.0);
                best = if pixels > LARGER * best.1 { (columns, pixels) } else { best };
            }
            best.0
        };
        view.columns.map_or_else(chosen, |columns| columns.clamp(1, panels.max(1)))
    }

    /// The view of a camera that follows, in a panel.
    pub(super) fn shot(&self, viewport: Rectangle, scale: Scale) -> Option<Shot> {
        Some(self.tracking.as_ref()?.shot(self.scene, (viewport, scale)))
    }

    /// The target and distance of the camera of a run in a panel.
    pub(super) fn framing(&self, shot: Option<&Shot>, run: &RunFrame, panel: (Rectangle, Scale)) -> Framing {
        let Scene { view, body, .. } = self.scene;
        let Some((tracking, shot)) = self.tracking.as_ref().zip(shot) else { return Framing::still(&view.camera) };
        let position = &run.shown().position;
        let centre = (position.len() == body.len()).then(|| Traced::Centre.of(body, position));
        let centre = centre.filter(|centre| centre.is_finite()).unwrap_or(view.camera.target);
        tracking.framing(self.scene, shot, centre, panel)
    }
}
