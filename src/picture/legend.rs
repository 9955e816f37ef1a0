//! The key of colours and arrows: one for all panels, below them, so that it overlaps nothing.

use super::Item;
use super::arrows;
use super::caption::Writer;
use super::chart::NUMBERS;
use super::chart::axis::{Kind, Stretch};
use super::ghost;
use super::layout::Scale;
use super::number;
use super::page::{Path, point};
use super::text::Weight;
use crate::colour::Colour;
use glam::DVec2;
use std::borrow::Cow;

/// Height of the key (px in the reference picture).
const HEIGHT: f64 = 34.0;
/// The least size of its type relative to the reference picture, as long as it takes no more than this of the picture.
const LEAST_UNIT: f64 = 0.66;
const MOST_HEIGHT: f64 = 0.068;
/// The least widths of the arrow with its words, of a sample with its name, and of the bar with its name (px in the
/// reference picture).
const ARROW_ROOM: f64 = 250.0;
const SAMPLE_ROOM: f64 = 220.0;
const BAR_ROOM: f64 = 365.0;
/// Height of the bar, its least and largest length, and the length of a tick (px in the reference picture).
const BAR: f64 = 12.0;
const LENGTHS: [f64; 2] = [190.0, 340.0];
/// The least distance of numbers (px in the reference picture).
const NUMBERS_APART: f64 = 9.0;
const TICK: f64 = 5.0;
/// The most ticks.
const MOST_TICKS: usize = 5;
/// The gap between two parts of the key (px in the reference picture).
const APART: f64 = 44.0;
/// The length and the width of the sample of a line (px in the reference picture).
const SAMPLE: [f64; 2] = [48.0, 2.0];
/// The approximate length of the key's arrow if nothing moves (px in the reference picture).
const ARROW: f64 = 64.0;

/// A colour scale.
pub(super) struct Bar<'a> {
    name: String,
    unit: &'static str,
    definition: String,
    /// The values at its ends.
    range: [f64; 2],
    /// The size of the body (m).
    extent: f64,
    ramp: &'a [Colour],
    /// Whether there are values below and above it.
    beyond: [bool; 2],
}

impl<'a> Bar<'a> {
    /// The scale of a quantity with a name, a unit and a definition, for a body of a size (m), over a range. `values`
    /// may lie beyond the range.
    pub(super) fn new(
        name: String,
        unit: &'static str,
        definition: String,
        range: [f64; 2],
        extent: f64,
        ramp: &'a [Colour],
        values: impl Iterator<Item = f64>,
    ) -> Self {
        let [low, high] = range;
        let beyond = values.fold([false; 2], |[below, above], value| [below || value < low, above || value > high]);
        Self { name, unit, definition, range, extent, ramp, beyond }
    }
}

/// A line or a mark with its meaning.
pub(super) struct Sample<'a> {
    /// Wordings of its name, at least one. The longest one that fits is used.
    pub(super) names: Vec<Cow<'a, str>>,
    pub(super) kind: SampleKind,
}

/// The look of a sample.
pub(super) enum SampleKind {
    /// The dashed outline of a ghost.
    Ghost(Colour),
    /// Paths, each of a run in its colour.
    Path(Vec<Colour>),
}

/// Sizes of the key of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Legend {
    /// Pixels per pixel of the reference picture.
    unit: f64,
    /// Its height (px).
    pub(super) height: f64,
}

impl Legend {
    /// The key of a picture of a size (px) with panels of a scale, with or without an arrow and a bar, and with a
    /// number of samples; `None` if it could not be read.
    pub(super) fn new(size: [u32; 2], scale: Scale, [arrow, bar]: [bool; 2], samples: usize) -> Option<Self> {
        let [width, height] = size.map(f64::from);
        let parts = usize::from(arrow) + samples + usize::from(bar);
        let apart = APART * parts.saturating_sub(1) as f64;
        let [arrow, bar] =
            [(arrow, ARROW_ROOM), (bar, BAR_ROOM)].map(|(is_shown, room)| if is_shown { room } else { 0.0 });
        let needed = apart + arrow + SAMPLE_ROOM * samples as f64 + bar;
        let roomy = LEAST_UNIT.min(MOST_HEIGHT * height / HEIGHT);
        let unit = scale.of_type(scale.unit.max(roomy)).min((width - 2.0 * scale.margin()) / needed);
        Scale::legible(NUMBERS * unit).then_some(Self { unit, height: HEIGHT * unit })
    }

    /// Draws the key from a height on in a picture of a width (px). `arrow` has its length in
    /// words, its pixels, and its size relative to the reference picture.
    pub(super) fn draw(
        self,
        writer: &mut Writer<'_>,
        picture_width: f64,
        top: f64,
        arrow: Option<(String, [f64; 2])>,
        samples: &[Sample<'_>],
        bar: Option<Bar<'_>>,
    ) {
        let unit = self.unit;
        let margin = writer.scale.margin();
        let top = top.round();
        let middle = top + 0.5 * (BAR * unit).round();
        let mut left = margin;
        if let Some((metres, [length, size])) = arrow {
            left = self.arrow(writer, [left, middle], &metres, [length, size]) + APART * unit;
        }
        let taken_by_bar = if bar.is_some() { (BAR_ROOM + APART) * unit } else { 0.0 };
        for (sample, after) in samples.iter().zip((0..samples.len()).rev()) {
            let taken_by_others = after as f64 * (SAMPLE_ROOM + APART) * unit;
            let room = (picture_width - margin - left - taken_by_bar - taken_by_others).max(SAMPLE_ROOM * unit);
            left = self.sample(writer, [left, middle], room, sample) + APART * unit;
        }
        if let Some(bar) = bar {
            self.bar(writer, [left, picture_width - margin, picture_width / 2.0], top, &bar);
        }
    }

    /// An arrow and its length; returns the right end of the text (px).
    fn arrow(self, writer: &mut Writer<'_>, [left, middle]: [f64; 2], metres: &str, [length, size]: [f64; 2]) -> f64 {
        let (unit, palette) = (self.unit, writer.palette);
        let ends = [left, left + length].map(|x| DVec2::new(x, middle));
        writer.marks.push(arrows::arrow(ends, size, palette.text, palette.background));
        // The text does not move with the camera.
        let left = left + length.max(ARROW * unit) + 12.0 * unit;
        self.write(
            writer,
            &format!("displacement {metres}"),
            Weight::Regular,
            16.0,
            palette.second_text,
            left,
            middle + 5.5 * unit,
        )
    }

    /// A sample with its name in a room (px); returns its right end (px).
    fn sample(self, writer: &mut Writer<'_>, [left, middle]: [f64; 2], room: f64, sample: &Sample<'_>) -> f64 {
        let (unit, palette) = (self.unit, writer.palette);
        let [length, width] = SAMPLE.map(|length| length * unit);
        let curve = |[from, to]: [f64; 2], dash: &[f64], colour: Colour| {
            Item::curve(&[[from, middle], [to, middle]], width, dash, colour)
        };
        match sample.kind {
            SampleKind::Ghost(colour) => {
                let dash = ghost::DASH.map(|length| length * unit);
                writer.curves.push(curve([left, left + length], &dash, colour));
            }
            SampleKind::Path(ref colours) => {
                // A part for each run.
                let at = |part: usize| left + length * part as f64 / colours.len() as f64;
                let part = |(part, &colour)| curve([at(part), at(part + 1)], &[], colour);
                writer.curves.extend(colours.iter().enumerate().map(part));
            }
        }
        let before = length + 12.0 * unit;
        let fonts = writer.fonts;
        let fits = |name: &&Cow<'_, str>| fonts.width(name, Weight::Regular, 16.0 * unit) <= room - before;
        let name = sample.names.iter().find(fits).or(sample.names.last()).map_or("", |name| name);
        let name = fonts.shortened(name, Weight::Regular, 16.0 * unit, room - before);
        self.write(writer, &name, Weight::Regular, 16.0, palette.second_text, left + before, middle + 5.5 * unit)
    }

    /// A colour bar between two places, with its name before it, its numbers below and, if there is room, its
    /// definition below its name. It is centred at the given middle if possible.
    fn bar(self, writer: &mut Writer<'_>, [left, right, middle]: [f64; 3], top: f64, bar: &Bar<'_>) {
        let (unit, palette) = (self.unit, writer.palette);
        let &Bar { ref name, ref definition, ramp, beyond, .. } = bar;
        let mut definition = &definition[..];
        let mut axis = Stretch::new(Kind::Colour, bar.range, bar.unit, bar.extent, MOST_TICKS);
        let numbers = NUMBERS * unit;
        let fonts = writer.fonts;
        let wide = |text: &String| fonts.width(text, Weight::Regular, numbers);
        let widths: Vec<_> = axis.texts.iter().map(wide).collect();
        let overhang = widths.last().map_or(0.0, |width| width / 2.0);
        let unit_text = if axis.unit.is_empty() { String::new() } else { format!("({})", axis.unit) };
        let caption = 16.0 * unit;
        // The name of a run may be long.
        let name = &*fonts.shortened(name, Weight::SemiBold, caption, 0.45 * (right - left));
        let space = if unit_text.is_empty() { 0.0 } else { 5.0 * unit };
        let named = writer.fonts.width(name, Weight::SemiBold, caption)
            + space
            + writer.fonts.width(&unit_text, Weight::Regular, caption);
        let gap = 20.0 * unit;
        let defined = fonts.width(definition, Weight::Regular, numbers);
        if defined + gap + 2.0 * overhang + LENGTHS[0] * unit > right - left {
            definition = "";
        }
        // The first number overlaps the left end by half its width.
        let beside = widths.first().map_or(0.0, |width| width / 2.0);
        let named = if definition.is_empty() { named } else { named.max(defined + beside) };
        let free = right - left - named - gap - overhang;
        let length = (0.26 * (right - left)).clamp(LENGTHS[0] * unit, LENGTHS[1] * unit).min(free).max(1.0).round();
        let room = widths.iter().sum::<f64>() + NUMBERS_APART * unit * widths.len() as f64;
        if room > length && widths.len() == MOST_TICKS {
            axis.halve();
        }
        let whole = named + gap + length;
        let centred = middle - whole / 2.0;
        let left = centred.max(left).min(right - whole - overhang);
        let height = (BAR * unit).round().max(2.0);
        let baseline = top + 0.5 * height + 5.5 * unit;
        let after = self.write(writer, name, Weight::SemiBold, 16.0, palette.text, left, baseline);
        self.write(writer, &unit_text, Weight::Regular, 16.0, palette.second_text, after + space, baseline);
        let below = top + height + (TICK + 14.5) * unit;
        self.write(writer, definition, Weight::Regular, NUMBERS, palette.second_text, left, below);
        let bar_left = (left + named + gap).round();
        let rim = unit.round().max(1.0);
        // If values lie beyond the scale, the bar ends in a point.
        let cap = 0.8 * height;
        for (end, x) in [bar_left, bar_left + length].into_iter().enumerate().filter(|&(end, _)| beyond[end]) {
            let colour = ramp[if end == 0 { 0 } else { ramp.len() - 1 }];
            for (out, colour) in [(rim, palette.axis), (0.0, colour)] {
                let [wide, high] = [cap + 1.6 * out, height + 2.0 * out];
                let tip = if end == 0 { x - wide } else { x + wide };
                let middle = top + 0.5 * height;
                let corners = [[x, middle - 0.5 * high], [tip, middle], [x, middle + 0.5 * high]];
                let path = Path::polygon(&corners.map(|at| point(at.into())));
                writer.marks.push(Item::part("point", [Item::fill(path, colour)]));
            }
        }
        let sides = |end: usize| if beyond[end] { 0.0 } else { rim };
        let framed = [bar_left - sides(0), top - rim, length + sides(0) + sides(1), height + 2.0 * rim];
        writer.marks.push(Item::rectangle(framed, palette.axis));
        let corner = point([bar_left, top].into());
        let size = point([length, height].into());
        let ends = [corner, point([bar_left + length, top].into())];
        writer.marks.push(Item::Blend { path: Path::rectangle(corner, size), ends, colours: ramp.to_vec() });
        for (&tick, text) in axis.ticks.iter().zip(&axis.texts) {
            let x = bar_left + axis.share(tick).clamp(0.0, 1.0) * length;
            let line = [(x - 0.5 * rim).round(), top + height + rim, rim, (TICK * unit).round()];
            writer.marks.push(Item::rectangle(line, palette.axis));
            self.write(writer, text, Weight::Regular, NUMBERS, palette.second_text, x - wide(text) / 2.0, below);
        }
    }

    /// Writes a text of a size in the reference picture and returns its right end (px).
    #[expect(clippy::too_many_arguments, reason = "all of these describe a line of text")]
    fn write(
        self,
        writer: &mut Writer<'_>,
        text: &str,
        weight: Weight,
        size: f64,
        colour: Colour,
        left: f64,
        baseline: f64,
    ) -> f64 {
        let size = size * self.unit;
        if !text.is_empty() {
            let run = writer.fonts.lay_out(text, weight, size, colour, left, baseline);
            writer.words.push(run);
        }
        left + writer.fonts.width(text, weight, size)
    }

    /// The length (m) of the key's arrow: a round one, for about the arrow's length in the key, if a metre has
    /// `pixels`.
    pub(super) fn arrow_metres(self, pixels: f64) -> f64 {
        number::round_below(ARROW * self.unit / pixels)
    }
}
