//! The chart below the panels of a frame: the time series of all runs over the whole scene, numbered flags for their
//! events, and the present moment. Only that moment moves; the rest is composed once.

use super::caption::Writer;
use super::chart::{BELOW, NUMBERS};
use super::ends::Ends;
use super::event::{self, Event};
use super::flag::{self, Flag};
use super::layout::{LEAST_CHART, Rectangle, Scale};
use super::strip::{SplitChart, Strip};
use super::text::TextRun;
use super::{Colour, Item};
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::{Diagnostic, Frame, Status};

/// The heights from the top of the room to the middle of the rings, and to the chart (px in the reference picture).
const RINGS: f64 = 11.0;
const ABOVE: f64 = 33.0;
/// The narrowest chart (px), and the largest shares of the room for its name and for the names at the ends of curves.
const LEAST_WIDTH: f64 = 40.0;
const NAME: f64 = 0.3;
const NAMES: f64 = 0.22;
/// The largest extent of these names above the chart (px in the reference picture).
const NAMES_ABOVE: f64 = 8.0;
/// Radius of the circles around present values and width of their line (px in the reference picture), and their corners.
const CIRCLE: [f64; 2] = [4.5, 1.6];
const CORNERS: usize = 24;

/// The chart of a scene.
#[derive(Debug)]
pub(super) struct Timeline {
    strip: Strip,
    events: Vec<Event>,
    /// Its place; `None` if it could not be read.
    parts: Option<SplitChart>,
    /// The parts that do not move.
    marks: Vec<Item>,
    curves: Vec<Item>,
    words: Vec<TextRun>,
}

impl Timeline {
    /// The chart of a diagnostic of all runs of a history, in a room of the picture of a writer (px), whose panels may
    /// have letters. `explained` returns the number of events of a run whose words fit into its panel.
    pub(super) fn new(
        diagnostic: Diagnostic,
        history: &History,
        scene: &Scene,
        mut writer: Writer<'_>,
        (room, have_letters): (Option<Rectangle>, bool),
        explained: impl Fn(&[&Event]) -> usize,
    ) -> Self {
        let mut strip = Strip::new(diagnostic, &[(scene, history)], writer.palette, str::to_owned);
        let mut events = event::events(diagnostic, &strip.series, scene.body.extent(), history.end);
        // A number without an explanation in its panel would mean nothing.
        for one in &strip.series {
            let own: Vec<_> = events.iter().filter(|event| event.run == one.run).collect();
            let mut left = explained(&own);
            events.retain(|event| {
                let is_kept = event.run != one.run || left > 0;
                left -= usize::from(event.run == one.run && left > 0);
                is_kept
            });
        }
        let room = room.filter(|_| history.end > 0.0);
        let parts = room
            .and_then(|room| still(&mut strip, &events, &mut writer, room.map(f64::from), (history.end, have_letters)));
        let Writer { marks, curves, words, .. } = writer;
        Self { strip, events, parts, marks, curves, words }
    }

    /// Draws the chart with the present moment: a line behind the curves, and circles around the values, which hide
    /// nothing.
    pub(super) fn draw(&self, writer: &mut Writer<'_>, frame: &Frame) {
        writer.marks.extend_from_slice(&self.marks);
        writer.words.extend_from_slice(&self.words);
        if let Some(parts) = &self.parts {
            let (chart, now) = parts.place(frame.time);
            writer.curves.push(chart.moment(now, writer.palette.text));
        }
        writer.curves.extend_from_slice(&self.curves);
        let Some(parts) = &self.parts else { return };
        for run in frame.runs.iter().filter(|run| run.snapshot.status == Status::Ok) {
            let (chart, x) = parts.place(run.snapshot.time);
            let one = self.strip.series.iter().find(|one| one.run == run.run && !one.points.is_empty());
            let Some((one, values)) = one.zip(self.strip.values_in(chart)) else { continue };
            let y = chart.y(&values, self.strip.diagnostic.of(&run.snapshot.diagnostics));
            if (chart.top - 1.0..=chart.bottom + 1.0).contains(&y) {
                writer.curves.push(circle([x, y], chart.line, one.style.colour));
            }
        }
    }

    /// The events of a run, each with its number.
    pub(super) fn events_of(&self, run: usize) -> impl Iterator<Item = (usize, &Event)> {
        (1..).zip(&self.events).filter(move |(_, event)| event.run == run && self.parts.is_some())
    }
}

/// Draws the parts that do not move into a room (px), for a scene up to an end (s) whose panels may have letters.
/// Returns the place of the chart, if there is room for it.
fn still(
    strip: &mut Strip,
    events: &[Event],
    writer: &mut Writer<'_>,
    [left, top, width, height]: [f64; 4],
    (end, have_letters): (f64, bool),
) -> Option<SplitChart> {
    let (fonts, scale) = (writer.fonts, writer.scale);
    let unit = scale.type_unit();
    let chart = [(top + ABOVE * unit).round(), (top + height - BELOW * unit).round()];
    let names_room = [NAMES * width, chart[1] - chart[0] + (NAMES_ABOVE + BELOW) * unit];
    let names = Ends::new(fonts, &strip.series, unit, names_room, have_letters);
    let last = (left + width - names.as_ref().map_or(0.0, |names| names.width)).round();
    let split = event::split(&strip.series, end);
    let place = |strip: &Strip| {
        let [name, numbers] = [strip.name_width(fonts, scale), strip.numbers_width(fonts, unit)];
        let has_name = name <= NAME * width;
        let first = (left + numbers + if has_name { name } else { 0.0 }).round();
        let has_room =
            last - first >= LEAST_WIDTH && chart[1] - chart[0] >= LEAST_CHART && Scale::legible(NUMBERS * unit);
        has_room.then(|| (has_name, [first, last], SplitChart::new(scale, [first, last], chart, [0.0, end], split)))
    };
    // Bands are explained below the name, if there is room.
    let (_, _, parts) = place(strip)?;
    strip.explain_bands(fonts, &parts, |strip| place(strip).is_some_and(|(has_name, ..)| has_name));
    let (has_name, [first, last], parts) = place(strip)?;
    let flags = (1..).zip(events).map(|(number, event)| Flag {
        at: parts.place(event.time).1,
        text: number.to_string(),
        colour: strip
            .series
            .iter()
            .find(|one| one.run == event.run)
            .map_or(writer.palette.axis, |one| one.style.colour),
    });
    flag::draw(writer, &flags.collect::<Vec<_>>(), top + RINGS * unit, [first, last], chart);
    strip.draw(writer, &parts, true, names.as_ref(), [chart[0] - NAMES_ABOVE * unit, chart[1] + BELOW * unit]);
    if has_name {
        strip.write_name(writer, [left, 0.5 * (chart[0] + chart[1])]);
    }
    Some(parts)
}

/// A circle around a place (px).
fn circle([x, y]: [f64; 2], thickness: f64, colour: Colour) -> Item {
    let corner = |at: usize| {
        let (sine, cosine) = libm::sincos(std::f64::consts::TAU * at as f64 / CORNERS as f64);
        [x + CIRCLE[0] * thickness * cosine, y + CIRCLE[0] * thickness * sine]
    };
    let points: Vec<_> = (0..=CORNERS).map(corner).collect();
    Item::curve(&points, CIRCLE[1] * thickness, &[], colour)
}
