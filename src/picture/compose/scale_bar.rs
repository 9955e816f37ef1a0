//! The scale bar of a panel.

use super::Composer;
use crate::picture::caption::{self, Writer};
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::{Framing, number};
use crate::sim::snapshot::{RunFrame, Snapshot};

/// The scale bar is at most and at least this long (px in the reference picture).
const LONGEST: f64 = 120.0;
const LEAST: f64 = 20.0;

impl Composer<'_> {
    /// Draws the scale bar of a panel between two places (px), if there is room; returns where it ends (px).
    pub(super) fn draw_bar(
        &self,
        panel: Rectangle,
        framing: &Framing,
        between: [f64; 2],
        writer: &mut Writer<'_>,
    ) -> Option<f64> {
        let room = between[1] - between[0] - 2.0 * writer.scale.gap();
        let (metres, pixels) = self.scale_bar(panel, framing, writer.scale, room);
        // Words of a shorter one may be narrower.
        let shorter = number::round_below(0.9 * metres);
        let bars = [(metres, pixels), (shorter, pixels * shorter / metres)].into_iter();
        let least = LEAST * writer.scale.unit;
        bars.filter(|(_, pixels)| *pixels >= least).find_map(|(metres, pixels)| {
            writer.scale_bar(panel, between, &number::round_length(metres, self.extent), pixels)
        })
    }

    /// Whether the scale bar of some runs in columns has no room at the start.
    pub(super) fn lacks_bar(&self, runs: &[usize], columns: usize) -> bool {
        let (view, body) = (&self.scene.view, &*self.scene.body);
        let layout = self.words().around(runs, columns).layout;
        let Some(&panel) = layout.panels.first().filter(|_| view.labels.scale_bar) else { return false };
        let layout::Written { labels, .. } = layout::written(view, f64::from(panel[3]), layout.scale.unit);
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
            from = writer.count(panel, &self.tally, &start.snapshot);
        }
        to = to.min(writer.left_of_numbers(panel, &caption::number(self.extent, &start.snapshot, area)));
        let shot = self.shot(panel, layout.scale);
        let framing = self.framing(shot.as_ref(), &start, (panel, layout.scale));
        !labels.scale_bar || self.draw_bar(panel, &framing, [from, to], &mut writer).is_none()
    }

    /// What a scale bar in a room (px) stands for (m), and how long it is (px).
    fn scale_bar(&self, viewport: Rectangle, framing: &Framing, scale: Scale, room: f64) -> (f64, f64) {
        let pixels = self.pixels_a_metre(viewport, framing, scale);
        let metres = number::round_below((LONGEST * scale.unit).min(room).max(1.0) / pixels);
        (metres, metres * pixels)
    }
}
