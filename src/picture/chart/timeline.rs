//! The charts below the panels of a frame: the time series of all runs over the whole scene, numbered flags for their
//! events, and the present moment. Only that moment moves; the rest is composed once.

use super::annotation::{Annotation, Flag};
use super::event::{self, Event};
use super::stack::{Room, Stack};
use super::{Chart, Place};
use crate::picture::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::steps::{APART, BESIDE, GAP, MARGIN, NAME_ROW, NEAR, RING, SHORT, SMALL};
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::page::Item;
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::{Diagnostic, Frame, Status};

/// The narrowest and the lowest chart (px), and the largest shares of the room for names of charts and for the names at
/// the ends of curves.
const LEAST: [f64; 2] = [MARGIN, SMALL];
const NAME: f64 = 0.3;
const NAMES: f64 = 0.22;

/// The charts of a scene.
#[derive(Debug)]
pub(in crate::picture) struct Timeline {
    diagnostics: Vec<Diagnostic>,
    /// The colour of each run shown.
    colours: Vec<(usize, Colour)>,
    events: Vec<Event>,
    /// The charts that have room, at their places.
    charts: Vec<(Chart, Place)>,
    /// The parts that do not move: those below the curves, and the curves.
    still: [Vec<Item>; 2],
}

impl Timeline {
    /// The charts of all runs of a history of a scene, as many charts as a number in a room (px) of the picture of
    /// a writer. `explained` returns the number of events of a run whose words fit into its panel.
    pub(in crate::picture) fn new<'w>(
        history: &History,
        scene: &Scene,
        writer: impl Fn() -> Writer<'w>,
        room: Option<(Rectangle, usize)>,
        explained: impl Fn(&[&Event]) -> usize,
    ) -> Self {
        let [mut ground, mut curves] = [writer(), writer()];
        let (unit, diagnostics) = (ground.scale.type_unit(), scene.view.charts.clone());
        let ([left, top, width, height], count) =
            room.map_or_else(Default::default, |(room, count)| (room.map(f64::from), count));
        let beyond = if count > 1 { [BESIDE; 2] } else { [NEAR, SHORT] };
        let beyond = beyond.map(|length| length * unit);
        let names_room = [NAMES * width, height / count.max(1) as f64];
        let stack = Stack::new(&diagnostics, &[(scene, history)], &ground, names_room, str::to_owned);
        let colours = stack.first().iter().map(|one| (one.run, one.style.colour)).collect();
        let mut events = event::events(diagnostics[0], stack.first(), scene.body.extent(), history.end);
        // A number without an explanation in its panel would mean nothing.
        for one in stack.first() {
            let own: Vec<_> = events.iter().filter(|event| event.run == one.run).collect();
            let mut left = explained(&own);
            events.retain(|event| {
                let is_kept = event.run != one.run || left > 0;
                left -= usize::from(event.run == one.run && left > 0);
                is_kept
            });
        }
        // Rings of flags need room above the charts.
        let above = if events.is_empty() { GAP } else { NAME_ROW };
        let gaps = count.saturating_sub(1) as f64;
        let chart = (height - (above + SHORT + gaps * APART) * unit) / count.max(1) as f64;
        let is_drawn = room.is_some() && history.end > 0.0 && Scale::legible(SMALL * unit);
        let charts = (is_drawn && chart >= LEAST[1]).then(|| {
            let has_names = stack.names_width <= NAME * width;
            let names = if has_names { stack.names_width } else { 0.0 };
            let span = [left + stack.numbers_width + names, left + width - stack.ends_width()].map(f64::round);
            let flag = |(number, event): (usize, &Event)| {
                let own = stack.first().iter().find(|one| one.run == event.run);
                let colour = own.map_or(ground.palette.axis, |one| one.style.colour);
                Flag { at: event.time, text: number.to_string(), colour }
            };
            let flags: Vec<_> = (1..).zip(&events).map(flag).collect();
            let time = ([0.0, history.end], event::split(stack.first(), history.end));
            let ends = |at: usize| {
                let top = top + above * unit + at as f64 * (chart + APART * unit);
                [top, top + chart].map(f64::round)
            };
            let room = Room {
                rings: top + RING * unit,
                span,
                names: has_names.then_some(left),
                charts: (0..count).map(ends).collect(),
                beyond,
            };
            let has_room = span[1] - span[0] >= LEAST[0];
            if has_room { stack.draw([&mut ground, &mut curves], &room, time, &flags) } else { Vec::new() }
        });
        let still = [ground, curves].map(|writer| writer.items().collect());
        Self { diagnostics, colours, events, charts: charts.unwrap_or_default(), still }
    }

    /// Draws the charts with the present moment: a line behind the curves, and circles around the values, which hide
    /// nothing.
    pub(in crate::picture) fn draw(&self, writer: &mut Writer<'_>, frame: &Frame) {
        writer.marks.extend_from_slice(&self.still[0]);
        for (chart, place) in &self.charts {
            Annotation::Moment { at: frame.time, colour: writer.palette.text }.draw(writer, chart, *place);
        }
        writer.curves.extend_from_slice(&self.still[1]);
        for (&diagnostic, (chart, place)) in self.diagnostics.iter().zip(&self.charts) {
            for run in frame.runs.iter().filter(|run| run.snapshot.status == Status::Ok) {
                let value = diagnostic.of(&run.snapshot.diagnostics);
                let colour = self.colours.iter().find(|(of, _)| *of == run.run).map(|(_, colour)| *colour);
                let ring = colour.map(|colour| Annotation::Ring { at: [run.snapshot.time, value], colour });
                ring.iter().for_each(|ring| ring.draw(writer, chart, *place));
            }
        }
    }

    /// The events of a run, each with its number.
    pub(in crate::picture) fn events_of(&self, run: usize) -> impl Iterator<Item = (usize, &Event)> {
        (1..).zip(&self.events).filter(move |(_, event)| event.run == run && !self.charts.is_empty())
    }
}
