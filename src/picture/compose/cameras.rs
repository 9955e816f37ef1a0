//! How the panels of a frame are seen: their arrangement and their cameras.

use super::Composer;
use crate::look::Traced;
use crate::picture::Framing;
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::tracking::Shot;
use crate::scene::Scene;
use crate::sim::RunFrame;

/// Panels that a scene leaves to be arranged stand in at most so many columns, and in fewer than possible only where that
/// makes bodies so many times larger.
const MOST_COLUMNS: usize = 64;
const LARGER: f64 = 1.02;

impl Composer<'_> {
    /// In how many columns the panels of some runs stand: as the scene says, or so that bodies are largest.
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
            // With as many rows, as even as possible; side by side unless that costs much.
            for columns in (2..=panels).map(|rows| panels.div_ceil(rows)).filter(|&columns| columns < most) {
                let pixels = pixels(columns).unwrap_or(0.0);
                best = if pixels > LARGER * best.1 { (columns, pixels) } else { best };
            }
            best.0
        };
        view.columns.map_or_else(chosen, |columns| columns.clamp(1, panels.max(1)))
    }

    /// How a camera that follows sees bodies in a panel.
    pub(super) fn shot(&self, viewport: Rectangle, scale: Scale) -> Option<Shot> {
        Some(self.tracking.as_ref()?.shot(self.scene, (viewport, scale)))
    }

    /// What the camera of a run looks at in a panel.
    pub(super) fn framing(&self, shot: Option<&Shot>, run: &RunFrame, panel: (Rectangle, Scale)) -> Framing {
        let Scene { view, body, .. } = self.scene;
        let Some((tracking, shot)) = self.tracking.as_ref().zip(shot) else { return Framing::still(&view.camera) };
        let position = &run.shown().position;
        let centre = (position.len() == body.len()).then(|| Traced::Centre.of(body, position));
        let centre = centre.filter(|centre| centre.is_finite()).unwrap_or(view.camera.target);
        tracking.framing(self.scene, shot, centre, panel)
    }
}
