//! The charts below the panels of a frame: the time series of all runs over the whole scene, numbered flags for their
//! events, and the present moment. Only that moment moves; the rest is composed once.

use super::annotation::{Annotation, Flag};
use super::event::{self, Event};
use super::series::Series;
use super::stack::Stack;
use super::{Chart, PlotArea};
use crate::look::Plot;
use crate::picture::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::steps::MARGIN;
use crate::picture::layout::{Layout, Room};
use crate::picture::page::Item;
use crate::runner::history::History;
use crate::runner::{Frame, RunFrame};
use crate::scene::Scene;
use crate::sim::{Diagnostic, Status};

/// The largest shares of the room for names of charts and for the names at the ends of curves.
const NAME: f64 = 0.3;
const NAMES: f64 = 0.22;

/// The charts of a scene.
#[derive(Debug)]
pub(in crate::picture) struct Timeline {
    /// What moves in each of the charts.
    moving: Vec<Moving>,
    events: Vec<Event>,
    /// The charts that have room, at their places.
    charts: Vec<(Chart, PlotArea)>,
    /// The parts that do not move: those below the curves, and the curves.
    still: [Vec<Item>; 2],
}

/// A point of a chart, with the time when it is there (s).
type Timed = (f64, [f64; 2]);

/// The present values in a chart.
#[derive(Debug)]
struct Moving {
    diagnostic: Option<Diagnostic>,
    is_over_time: bool,
    /// For each run shown its colour, the number by which its diagnostic is divided and, of what is measured of one thing, points.
    runs: Vec<(usize, Colour, f64, Vec<Timed>)>,
}

impl Moving {
    fn new(plot: &Plot, series: &[Series]) -> Self {
        let points = |one: &Series| one.times.iter().copied().zip(one.points.iter().copied()).collect();
        let runs = series.iter().map(|one| (one.run, one.style.colour, one.divisor, points(one))).collect();
        Self { diagnostic: plot.diagnostic(), is_over_time: plot.is_over_time(), runs }
    }

    /// The present value of a run, and its colour.
    fn now(&self, run: &RunFrame) -> Option<([f64; 2], Colour)> {
        let (_, colour, divisor, points) = self.runs.iter().find(|(of, ..)| *of == run.run)?;
        let time = run.snapshot.time;
        let at = match self.diagnostic {
            Some(diagnostic) => [time, diagnostic.of(&run.snapshot.diagnostics) / divisor],
            None => points[points.partition_point(|(there, _)| *there <= time).checked_sub(1)?].1,
        };
        Some((at, *colour))
    }
}

impl Timeline {
    /// The charts of all runs of a history of a scene, as many charts as have boxes in a layout, in the
    /// picture of a writer. `explained` returns the number of events of a run whose words fit into its panel.
    pub(in crate::picture) fn new<'w>(
        history: &History,
        scene: &Scene,
        writer: impl Fn() -> Writer<'w>,
        layout: &Layout,
        explained: impl Fn(&[&Event]) -> usize,
    ) -> Self {
        let [mut ground, mut curves] = [writer(), writer()];
        let plots = &scene.view.charts;
        let side = layout.scale.margin();
        let width = f64::from(scene.view.size[0]) - 2.0 * side;
        let stack = Stack::new(plots, &[(scene, history)], &ground, NAMES * width, str::to_owned);
        let moving = stack.runs().map(|(at, series)| Moving::new(&plots[at], series)).collect();
        let (place, first) = stack.first();
        let mut events = event::events(&plots[place], first, scene.extent(), history.end);
        // A number without an explanation in its panel would mean nothing.
        for one in first {
            let own: Vec<_> = events.iter().filter(|event| event.run == one.run).collect();
            let mut left = explained(&own);
            events.retain(|event| {
                let is_kept = event.run != one.run || left > 0;
                left -= usize::from(event.run == one.run && left > 0);
                is_kept
            });
        }
        let has_names = stack.names_width <= NAME * width;
        let left = side + stack.numbers_width + if has_names { stack.names_width } else { 0.0 };
        let span = [left, side + width - stack.ends_width()];
        let names = has_names.then_some(side);
        let room = Room::new(&layout.parts, ground.scale, (span, stack.over_time()), names, !events.is_empty());
        let charts = room.filter(|_| history.end > 0.0 && span[1] - span[0] >= MARGIN).map(|room| {
            let flag = |(number, event): (usize, &Event)| {
                let own = first.iter().find(|one| one.run == event.run);
                let colour = own.map_or(ground.palette.axis, |one| one.style.colour);
                Flag { at: event.time, text: number.to_string(), colour }
            };
            let flags: Vec<_> = (1..).zip(&events).map(flag).collect();
            let time = ([0.0, history.end], event::split(first, history.end));
            stack.draw([&mut ground, &mut curves], &room, time, &flags)
        });
        let still = [ground, curves].map(|writer| writer.items().collect());
        Self { moving, events, charts: charts.unwrap_or_default(), still }
    }

    /// Draws the charts with the present moment: a line behind the curves, and circles around the values, which hide
    /// nothing.
    pub(in crate::picture) fn draw(&self, writer: &mut Writer<'_>, frame: &Frame) {
        writer.marks.extend_from_slice(&self.still[0]);
        for (_, (chart, place)) in self.moving.iter().zip(&self.charts).filter(|(one, _)| one.is_over_time) {
            Annotation::Moment { at: frame.time, colour: writer.palette.text }.draw(writer, chart, *place);
        }
        writer.curves.extend_from_slice(&self.still[1]);
        for (moving, (chart, place)) in self.moving.iter().zip(&self.charts) {
            for run in frame.runs.iter().filter(|run| run.snapshot.status == Status::Ok) {
                let ring = moving.now(run).map(|(at, colour)| Annotation::Ring { at, colour });
                ring.iter().for_each(|ring| ring.draw(writer, chart, *place));
            }
        }
    }

    /// The events of a run, each with its number.
    pub(in crate::picture) fn events_of(&self, run: usize) -> impl Iterator<Item = (usize, &Event)> {
        (1..).zip(&self.events).filter(move |(_, event)| event.run == run && !self.charts.is_empty())
    }
}
