//! How the panels of a frame are seen: their arrangement, their cameras and their overviews.

use super::Composer;
use super::panel::Draft;
use crate::look::Place;
use crate::picture::Framing;
use crate::picture::caption::Writer;
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::locator::Located;
use crate::picture::tracking::{Shot, Tracking};
use crate::scene::Scene;
use crate::sim::snapshot::RunFrame;

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
        let taken = self.locator.as_ref().and_then(|locator| locator.place(&self.scene.view, viewport, scale));
        Some(self.tracking.as_ref()?.shot(self.scene, (viewport, scale), taken))
    }

    /// What the camera of a run looks at in a panel.
    pub(super) fn framing(&self, shot: Option<&Shot>, run: &RunFrame, panel: (Rectangle, Scale)) -> Framing {
        let Some((tracking, shot)) = self.tracking.as_ref().zip(shot) else {
            return Framing::still(&self.scene.view.camera);
        };
        let Scene { view, body, .. } = self.scene;
        let position = &run.shown().position;
        let is_known = position.len() == body.len();
        let place = is_known.then(|| Place::new(view, body.dimension, position)).flatten();
        tracking.framing(self.scene, shot, run, place, panel)
    }

    /// Where the overview of a panel stands (px: left, top, width and height), if its camera moves.
    pub(super) fn overview(&self, panel: Rectangle, shot: &Shot, scale: Scale) -> Option<[f64; 4]> {
        let locator = self.locator.as_ref().filter(|_| !shot.is_still)?;
        locator.place(&self.scene.view, panel, scale)
    }

    /// Draws the overview of a panel, if it has one.
    pub(super) fn locate(&self, draft: &Draft<'_>, shot: &Shot, tracking: &Tracking, writer: &mut Writer<'_>) {
        let Some((locator, place)) = self.locator.as_ref().zip(draft.overview) else { return };
        if draft.position.is_empty() {
            return;
        }
        let at = |&node: &u32| draft.position[node as usize];
        let bars = self.bare.iter().flat_map(|&element| draft.body.topology().edges_of(element));
        let located = Located {
            points: self.skin.nodes.iter().map(at).collect(),
            triangles: &self.skin.triangles,
            bars: bars.map(|ends| ends.map(|node| at(&node))).collect(),
            shown: draft.lens.shown(draft.viewport.map(f64::from), shot.pixels),
            colour: self.scene.runs.get(draft.run.run).map_or(self.palette.text, |run| run.line(&self.palette).colour),
        };
        let run = (draft.run.run, draft.run.snapshot.time);
        locator.draw(writer, place, tracking, run, &located);
    }
}
