//! The row of numbers in panels, from left to right: tally, count, scale bar, number.

use super::Composer;
use crate::picture::caption;
use crate::picture::framing::Shot;
use crate::picture::layout::steps::{CHART, SHORT};
use crate::picture::layout::tree::{self, Node, Solved};
use crate::picture::layout::{Layout, Rectangle, Scale};
use crate::picture::{Framing, number};
use crate::runner::RunFrame;
use crate::sim::Snapshot;

/// The largest and the least part of a panel's width for tallies.
const TALLY: [f64; 2] = [0.36, 0.12];

/// The boxes of the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberPart {
    Row,
    Tally,
    Count,
    Bar,
    Number,
}

impl Composer<'_> {
    /// The names of the bodies of a run; empty if there is only one.
    pub(super) fn names_of(&self, run: usize) -> Vec<&str> {
        let of = self.scene.runs.get(run).map_or(&[][..], |run| &run.of);
        if of.len() < 2 { Vec::new() } else { of.iter().map(|&body| self.scene.bodies[body].name.as_str()).collect() }
    }

    /// The boxes of the row in each panel of some runs, from its left margin on (px). They are those of the start, so that
    /// nothing comes and goes.
    pub(super) fn numbers(&self, runs: &[usize], layout: &Layout, shot: Option<&Shot>) -> Solved<NumberPart> {
        let (labels, scale) = (layout.written.labels, layout.scale);
        let Some((&panel, &first)) = layout.panels.first().zip(runs.first()) else {
            return tree::column(&[], [0.0; 4]);
        };
        let snapshot = Snapshot { position: self.scene.runs[first].initial.position.clone(), ..Snapshot::default() };
        let number = caption::number(self.extent, &snapshot, self.bodies(first).smallest_area_ratio(&snapshot));
        let framing = self.framing(shot, &RunFrame::new(first, snapshot), (panel, scale));
        let writer = self.writer(scale);
        let width = (f64::from(panel[2]) - 2.0 * scale.margin()).max(0.0);
        let node = |numeral, [wanted, least]: [f64; 2]| Node::new(numeral, wanted).least(least).after(scale.gap());
        let elements = runs.iter().map(|&run| self.bodies(run).body().elements().len()).max().unwrap_or(0);
        let count = (labels.count && elements > 0).then(|| {
            let tallies = runs.iter().map(|&run| self.bodies(run).tally.width(scale, TALLY[0] * width));
            let tally = Node::new(NumberPart::Tally, tallies.fold(0.0, f64::max)).least(TALLY[1] * width);
            let counts = runs.iter().map(|&run| writer.count_widths(&self.names_of(run), &self.bodies(run).tally));
            let widest = counts.fold([0.0_f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)]);
            [tally, node(NumberPart::Count, widest)]
        });
        let bars = self.bars(panel, &framing, scale).map(|(text, pixels)| writer.bar_width(&text, pixels));
        let bars = bars.filter(|_| labels.scale_bar);
        // The longest bar that fits into spare room is drawn.
        let bar = bars.reduce(f64::min).map(|least| node(NumberPart::Bar, [least; 2]).stretched().rank(0));
        let number = node(NumberPart::Number, writer.number_widths(labels.number.then_some(&number))).rank(1);
        let row = count.into_iter().flatten().chain(bar).chain([number]).collect();
        tree::column(&[Node::new(NumberPart::Row, 1.0).with(row)], [0.0, 0.0, width, 1.0])
    }

    /// Scale bars with their lengths (px), from the longest to the shortest.
    pub(super) fn bars(
        &self,
        panel: Rectangle,
        framing: &Framing,
        scale: Scale,
    ) -> impl Iterator<Item = (String, f64)> {
        let pixels = self.pixels_a_metre(panel, framing, scale);
        let longest = number::round_below(CHART * scale.unit / pixels);
        let lengths = std::iter::successors(Some(longest), |metres| Some(number::round_below(0.9 * metres))).take(4);
        let bars = lengths.map(move |metres| (number::round_length(metres, self.extent), metres * pixels));
        bars.take_while(move |(_, length)| *length >= SHORT * scale.unit)
    }
}
