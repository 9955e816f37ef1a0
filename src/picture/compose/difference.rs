//! The panel that shows how far the same nodes of two runs are apart: the body of the first, coloured by the distances, the
//! outline of the second, and the largest distance over the time of the scene.

use super::Composer;
use super::panel::Draft;
use crate::look::ColourScale;
use crate::picture::axis::{Axis, Kind};
use crate::picture::caption::{self, Heading, Writer};
use crate::picture::chart::{BELOW, Chart, GAP, MOST_TICKS, NUMBERS, ROWS_APART, dot, wide};
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::narrow::narrow;
use crate::picture::series::{EXACT, OWN, simplified};
use crate::picture::text::Weight;
use crate::picture::{Curve, Framing, Mark, Panel};
use crate::runner::history::History;
use crate::sim::apart;
use crate::sim::field::Field;
use crate::sim::snapshot::{Frame, RunFrame};
use glam::DVec3;

/// The height of the chart with its name and its times and the room below it, and the largest part of the panel that it takes
/// (px in the reference picture).
const STRIP: f64 = 104.0;
const BELOW_STRIP: f64 = 22.0;
const MOST: f64 = 0.3;
/// From the outline of the other body to the strip (px in the reference picture).
const ABOVE_STRIP: f64 = 14.0;
/// From the top of the strip to its name's baseline and to the chart; size of the name's type, and radius of the dot and of
/// its halo (px in the reference picture).
const NAME_BASELINE: f64 = 13.0;
const ABOVE: f64 = 26.0;
const NAME: f64 = 16.0;
const DOT: f64 = 4.5;
const HALO: f64 = 2.2;
/// The lowest and the narrowest chart (px).
const LEAST: [f64; 2] = [14.0, 40.0];

/// The largest distance over the time of a scene.
#[derive(Debug)]
pub(super) struct LargestDistance {
    /// The last time shown (s).
    end: f64,
    /// Times (s) and distances (m).
    points: Vec<[f64; 2]>,
}

impl LargestDistance {
    pub(super) fn new(history: &History) -> Self {
        Self { end: history.end, points: history.difference.clone() }
    }
}

/// Two runs at one moment.
pub(super) struct Compared<'a> {
    pub(super) one: &'a RunFrame,
    /// The index of the other run, and where its nodes are outlined (m); none if one of the runs has diverged.
    other: usize,
    outlined: Vec<DVec3>,
    /// The distance of each node of the first from that of the other (m).
    distances: Vec<f64>,
}

impl Compared<'_> {
    fn largest(&self) -> Option<f64> {
        self.distances.iter().copied().reduce(f64::max)
    }
}

impl Composer<'_> {
    /// The runs whose difference a frame shows, if it does.
    pub(super) fn compared<'f>(&self, frame: &'f Frame) -> Option<Compared<'f>> {
        let difference = self.scene.view.difference?;
        let [one, other] = difference.runs.map(|run| frame.runs.iter().find(|shown| shown.run == run));
        let (one, other) = (one?, other?);
        let body = &*self.scene.body;
        // A run that diverges is shown as it fitted last, at another time.
        let is_whole = |run: &RunFrame| run.last_fit.is_none() && run.snapshot.position.len() == body.len();
        let [here, there] = [one, other].map(|run| &run.snapshot.position[..]);
        let outlined = match is_whole(one) && is_whole(other) {
            true if difference.after_fit => apart::fitted(body.dimension, there, here),
            true => there.to_vec(),
            false => Vec::new(),
        };
        let distances = apart::distances(here, &outlined).collect();
        Some(Compared { one, other: other.run, outlined, distances })
    }

    /// The colours of distances: up to the largest of the whole scene, so that they mean the same in all frames.
    pub(super) fn distance_scale(&self) -> ColourScale {
        let points = self.largest_distance.iter().flat_map(|largest| &largest.points);
        let largest = points.fold(0.0, |largest: f64, [_, distance]| distance.max(largest));
        let high = if largest > 0.0 { largest } else { 0.5 * self.scene.view.side };
        let map = self.scene.view.colour.map(|colour| colour.map).unwrap_or_default();
        ColourScale { field: Field::Displacement, range: [0.0, high], map }
    }

    /// The size (m) of bodies whose lengths have the unit of distances: small ones have a unit of their own.
    pub(super) fn unit_of_distances(&self) -> f64 {
        const SIZE: f64 = 30.0;
        (SIZE * self.distance_scale().range[1]).min(self.extent)
    }

    /// The values of the colour bar.
    pub(super) fn distances<'c>(&self, compared: Option<&'c Compared<'_>>) -> &'c [f64] {
        compared.map_or(&[], |compared| &compared.distances)
    }

    /// The part of a panel's room for the body, and that for the chart, if there is one.
    pub(super) fn rooms(&self, panel: Rectangle, scale: Scale) -> (Rectangle, Option<Rectangle>) {
        let [left, top, width, height] = panel;
        let unit = unit_of_chart(scale);
        let taken = ((STRIP + BELOW_STRIP) * unit).round() as u32;
        if f64::from(taken) > MOST * f64::from(height) {
            return (panel, None);
        }
        let margin = scale.margin().min(f64::from(width) / 2.0).round() as u32;
        let strip = [left + margin, top + height - taken, width - 2 * margin, (STRIP * unit).round() as u32];
        ([left, top, width, height - taken], Some(strip))
    }

    /// Writes the words of the panel and draws its chart. `time` is the time of the clock (s), if it stands here.
    pub(super) fn write_difference(
        &self,
        compared: &Compared<'_>,
        panel: Rectangle,
        at: usize,
        time: Option<f64>,
        writer: &mut Writer<'_>,
    ) {
        let view = &self.scene.view;
        let (viewport, strip) = self.rooms(panel, writer.scale);
        let written = layout::written(view, f64::from(viewport[3]), writer.scale.unit);
        let (labels, clock_label) = (written.labels, self.words().clock_label(written));
        let taken = if time.is_some() { writer.clock_room(viewport, clock_label) } else { [0.0; 2] };
        let [one, other] = [compared.one.run, compared.other].map(|run| &self.scene.runs[run].name[..]);
        let is_fitted = view.difference.is_some_and(|difference| difference.after_fit);
        let name = if is_fitted { "Difference of shapes" } else { "Difference" };
        // Which of them is dashed is said in any case.
        let free = f64::from(viewport[2]) - 2.0 * writer.scale.margin();
        let free = free - if taken[1] > 0.0 { taken[1] + writer.scale.gap() } else { 0.0 };
        let wide = |text: &String| writer.fonts.width(text, Weight::Regular, writer.scale.caption());
        let wordings =
            [format!("{one} to {other} (dashed)"), format!("to {other} (dashed)"), format!("dashed: {other}")];
        let second = wordings.into_iter().find(|text| wide(text) <= free).unwrap_or_default();
        let heading = Heading {
            letter: if labels.letter { caption::letter(at) } else { String::new() },
            name: if labels.name { name } else { "" },
            sample: None,
            second: if labels.model { second } else { String::new() },
            names: &[],
        };
        writer.heading(viewport, &heading, taken);
        time.iter().for_each(|&time| writer.clock(viewport, time, clock_label));
        if let Some(largest) = compared.largest().filter(|_| labels.number) {
            let left = f64::from(viewport[0]) + writer.scale.margin();
            let number = caption::distance(largest, self.distance_scale().range[1], self.unit_of_distances());
            writer.number(viewport, left, &number);
        }
        if let (Some(largest), Some(strip)) = (&self.largest_distance, strip) {
            let shown = (compared.one.snapshot.time, compared.largest());
            largest.draw(writer, strip, self.unit_of_distances(), shown);
        }
    }

    /// The body with its outlined counterpart.
    pub(super) fn draw_difference(
        &self,
        compared: &Compared<'_>,
        panel: Rectangle,
        framing: &Framing,
        scale: Scale,
        [under, above]: [&mut Vec<Mark>; 2],
        curves: &mut Vec<Curve>,
    ) -> Panel {
        let mut draft = Draft::new(self, self.rooms(panel, scale).0, compared.one, framing, scale);
        draft.colour_by(&self.distance_scale(), &compared.distances);
        let colour = self.scene.runs[compared.other].line(&self.palette).colour;
        // Wherever the other body is, it is not cut off at rows of words.
        let [left, top, width, height] = draft.viewport;
        let free = if self.rooms(panel, scale).1.is_some() { (ABOVE_STRIP * scale.unit).round() as u32 } else { 0 };
        draft.outline(&compared.outlined, colour, [left, top, width, height.saturating_sub(free)], curves);
        draft.panel(under, above)
    }
}

/// Pixels of the chart for one pixel of type in the reference picture: its numbers are no smaller than others.
fn unit_of_chart(scale: Scale) -> f64 {
    scale.small() / NUMBERS
}

impl LargestDistance {
    /// Draws it into a rectangle, with a mark at a time (s) and a distance (m), in the unit for bodies of a size (m); nothing if
    /// the rectangle is too small.
    fn draw(&self, writer: &mut Writer<'_>, room: Rectangle, extent: f64, (time, distance): (f64, Option<f64>)) {
        let unit = unit_of_chart(writer.scale);
        let [left, top, width, height] = room.map(f64::from);
        let (name_baseline, palette) = (top + NAME_BASELINE * unit, writer.palette);
        let [top, bottom] = [top + (ABOVE * unit).round(), top + height - (BELOW * unit).round()];
        let largest = self.points.iter().fold(0.0, |largest: f64, [_, distance]| distance.max(largest));
        let rows = ((bottom - top) / (ROWS_APART * unit)).max(0.0) as usize + 1;
        let values = Axis::new(Kind::Value, [0.0, largest], "m", extent, rows.min(MOST_TICKS));
        let numbers = values.texts.iter().map(|text| wide(writer.fonts, text, unit)).fold(0.0, f64::max);
        let indent = (numbers + GAP * unit).round();
        let [lowest, narrowest] = LEAST;
        if bottom - top < lowest || width - indent < narrowest || self.end <= 0.0 || !Scale::legible(NAME * unit) {
            return;
        }
        let line = writer.scale.line();
        let chart = Chart { left: left + indent, right: left + width, top, bottom, unit, line };
        let times = chart.times(writer.fonts, [0.0, self.end]);
        let (name, size) = ("largest distance", NAME * unit);
        writer.left(name, Weight::SemiBold, size, palette.text, left, name_baseline);
        let after = left + writer.fonts.width(name, Weight::SemiBold, size);
        writer.left(&format!(" ({})", values.unit), Weight::Regular, size, palette.second_text, after, name_baseline);
        chart.rows(writer, &values, true);
        chart.columns(writer, &times, false, f64::NEG_INFINITY);
        let now = chart.x(&times, time);
        writer.curves.push(chart.moment(now, palette.text));
        let points = self.points.iter().map(|&[time, value]| [chart.x(&times, time), chart.y(&values, value)]);
        let points = simplified(&points.collect::<Vec<_>>(), EXACT);
        writer.curves.push(Curve {
            points: points.into_iter().map(|point| point.map(narrow)).collect(),
            width: narrow(OWN * chart.line),
            dash: Vec::new(),
            colour: palette.text,
            alpha: 1.0,
        });
        if let Some(distance) = distance {
            for (radius, colour) in [(DOT + HALO, palette.background), (DOT, palette.text)] {
                writer.curves.push(dot([now, chart.y(&values, distance)], radius * chart.line, colour));
            }
        }
    }
}
