//! The charts below the panels of a frame: the time series of all runs over the whole scene, numbered flags for their
//! events, and the present moment. Only that moment moves; the rest is composed once.

use super::annotation::Flag;
use super::event::{self, Event};
use super::series::Series;
use super::stack::Stack;
use super::{Chart, PlotArea};
use crate::look::Plot;
use crate::picture::Colour;
use crate::picture::caption::Writer;
use crate::picture::layout::steps::{MARGIN, THIN, TICK};
use crate::picture::layout::{Layout, Room};
use crate::picture::narrow::narrow;
use crate::picture::page::{self, Item, Path, Pen};
use crate::runner::history::History;
use crate::runner::{Frame, RunFrame};
use crate::scene::Scene;
use crate::sim::Status;

/// The largest shares of the room for names of charts and for the names at the ends of curves.
const NAME: f64 = 0.3;
const NAMES: f64 = 0.22;
/// The opacity of the line of a moment.
const MOMENT: f64 = 0.75;

/// The charts of a scene.
#[derive(Debug)]
pub(in crate::picture) struct Timeline {
    events: Vec<Event>,
    /// The charts that have room: what each shows, with the series of runs, whose present values move, and its place.
    charts: Vec<(Plot, Vec<Series>, Chart, PlotArea)>,
    /// The parts that do not move: those below the curves, and the curves.
    still: [Vec<Item>; 2],
}

/// The present value of a run in a chart with series of runs, and its colour.
fn now(plot: &Plot, series: &[Series], run: &RunFrame) -> Option<([f64; 2], Colour)> {
    let own = series.iter().find(|one| one.run == run.run)?;
    let time = run.snapshot.time;
    let at = match plot.diagnostic() {
        Some(diagnostic) => [time, diagnostic.of(&run.snapshot.diagnostics) / own.divisor],
        None => own.points[own.times.partition_point(|there| *there <= time).checked_sub(1)?],
    };
    Some((at, own.style.colour))
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
        let (first, axis, quantity) = stack.first(plots, scene);
        let mut events = event::events(first, axis.as_ref(), &quantity, history.end);
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
        let shown = stack.into_runs().zip(charts.unwrap_or_default());
        let shown = shown.map(|((at, series), (chart, place))| (plots[at].clone(), series, chart, place));
        Self { charts: shown.collect(), events, still }
    }

    /// Draws the charts with the present moment: a line behind the curves, and circles around the values, which hide
    /// nothing.
    pub(in crate::picture) fn draw(&self, writer: &mut Writer<'_>, frame: &Frame) {
        writer.marks.extend_from_slice(&self.still[0]);
        for (.., chart, place) in self.charts.iter().filter(|(plot, ..)| plot.is_over_time()) {
            let x = place.x(&chart.x, frame.time);
            let ends = [[x, place.borders()[1]], [x, place.bottom + TICK * place.unit]];
            writer.curves.push(place.curve(&ends, THIN, &[], (writer.palette.text, MOMENT)));
        }
        writer.curves.extend_from_slice(&self.still[1]);
        for (plot, series, chart, place) in &self.charts {
            for run in frame.runs.iter().filter(|run| run.snapshot.status == Status::Ok) {
                let Some((at, colour)) = now(plot, series, run) else { continue };
                let [x, y] = [place.x(&chart.x, at[0]), place.y(&chart.y, at[1])];
                if (place.top - 1.0..=place.bottom + 1.0).contains(&y) {
                    let [radius, width] = [TICK, THIN].map(|length| narrow(length * place.line));
                    let path = Path::circle(page::point([x, y].into()), radius);
                    writer.curves.push(Item::stroke(path, Pen::solid(width), colour));
                }
            }
        }
    }

    /// The events of a run, each with its number.
    pub(in crate::picture) fn events_of(&self, run: usize) -> impl Iterator<Item = (usize, &Event)> {
        (1..).zip(&self.events).filter(move |(_, event)| event.run == run && !self.charts.is_empty())
    }
}
