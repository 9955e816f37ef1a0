//! The scale bar of a panel.

use super::Composer;
use crate::picture::caption::{self, Writer};
use crate::picture::layout::{Layout, Rectangle, Scale};
use crate::picture::tracking::Shot;
use crate::picture::{Framing, number};
use crate::sim::{RunFrame, Snapshot};

/// The largest and the least length of the scale bar (px in the reference picture).
const LONGEST: f64 = 120.0;
const LEAST: f64 = 20.0;
/// Shares of a panel's width for tallies: the first one that leaves room for a scale bar is used.
const TALLY_SHARES: [f64; 4] = [0.36, 0.28, 0.20, 0.12];

impl Composer<'_> {
    /// Draws the scale bar of a panel between two places (px), if there is room. Returns its right end (px).
    pub(super) fn draw_bar(
        &self,
        panel: Rectangle,
        framing: &Framing,
        between: [f64; 2],
        writer: &mut Writer<'_>,
    ) -> Option<f64> {
        let room = between[1] - between[0] - 2.0 * writer.scale.gap();
        let (metres, pixels) = self.scale_bar(panel, framing, writer.scale, room);
        // A shorter bar may have narrower words.
        let shorter = number::round_below(0.9 * metres);
        let bars = [(metres, pixels), (shorter, pixels * shorter / metres)].into_iter();
        let least = LEAST * writer.scale.unit;
        bars.filter(|(_, pixels)| *pixels >= least).find_map(|(metres, pixels)| {
            writer.scale_bar(panel, between, &number::round_length(metres, self.extent), pixels)
        })
    }

    /// The part of panels' widths for tallies, reduced if the scale bar needs it, and whether the scale bar has room
    /// beside them.
    pub(super) fn beside_tally(&self, layout: &Layout, shot: Option<&Shot>) -> (f64, bool) {
        let fits = |&share: &f64| self.fits_bar(layout, shot, share);
        match TALLY_SHARES.iter().find(|share| fits(share)) {
            Some(&share) => (share, true),
            None => (TALLY_SHARES[0], false),
        }
    }

    /// Whether the scale bar has room beside a tally that takes a part of its panel's width.
    fn fits_bar(&self, layout: &Layout, shot: Option<&Shot>, share: f64) -> bool {
        let (body, labels) = (&*self.scene.body, layout.written.labels);
        let Some(&panel) = layout.panels.first() else { return false };
        let snapshot = Snapshot {
            position: self.scene.initial.position.clone(),
            turned_over: vec![false; body.elements.len()],
            ..Snapshot::default()
        };
        let area = self.smallest_area_ratio(&snapshot);
        let start = RunFrame::new(0, snapshot);
        let mut writer = self.writer(layout.scale);
        let margin = writer.scale.margin();
        let [mut from, mut to] = [f64::from(panel[0]) + margin, f64::from(panel[0] + panel[2]) - margin];
        if labels.count {
            from = writer.count(panel, (&self.tally, share), &start.snapshot);
        }
        to = to.min(writer.left_of_numbers(panel, &caption::number(self.extent, &start.snapshot, area)));
        let framing = self.framing(shot, &start, (panel, layout.scale));
        labels.scale_bar && self.draw_bar(panel, &framing, [from, to], &mut writer).is_some()
    }

    /// Whether the scale bar of some runs in columns has no room, judged by the start.
    pub(super) fn lacks_bar(&self, runs: &[usize], columns: usize) -> bool {
        let layout = self.words().around(runs, columns).layout;
        let shot = layout.panels.first().and_then(|&panel| self.shot(panel, layout.scale));
        self.scene.view.labels.scale_bar && !layout.panels.is_empty() && !self.beside_tally(&layout, shot.as_ref()).1
    }

    /// The length of a scale bar in a room (px), in metres and in pixels.
    fn scale_bar(&self, viewport: Rectangle, framing: &Framing, scale: Scale, room: f64) -> (f64, f64) {
        let pixels = self.pixels_a_metre(viewport, framing, scale);
        let metres = number::round_below((LONGEST * scale.unit).min(room).max(1.0) / pixels);
        (metres, metres * pixels)
    }
}
