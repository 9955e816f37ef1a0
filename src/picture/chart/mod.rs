//! Charts without a box: two axes, layers of curves, and annotations, as plain data that one function draws into a
//! rectangle.

mod annotation;
pub(super) mod axis;
pub(super) mod event;
mod layer;
mod names;
mod series;
mod stack;
pub(super) mod timeline;

pub use annotation::Annotation;
pub(super) use annotation::{Flag, ring};
pub use axis::Axis;
pub use layer::Layer;
pub(super) use layer::{needed, simplified};
pub use names::Name;
pub(super) use names::spread;
pub(super) use series::{name, style};
pub(super) use stack::Stack;

use super::caption::Writer;
use super::layout::steps::{BESIDE, CLOSE, FREE, MARGIN, NEAR, SHORT, SMALL, TICK};
use super::page::{Item, Paint};
use super::text::Weight;
use crate::colour::{Colour, mixed};
use axis::{Kind, Stretch};

/// The most times with numbers on a stretch.
const MOST_TIMES: usize = 6;
/// The share of the width before a change of the scale of time.
const BEFORE: f64 = 0.8;

/// A chart: axes, layers and annotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// The axis to the right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// The layers, in the order in which they are drawn; areas and bands lie below all lines.
    pub layers: Vec<Layer>,
    /// Signs and words above the layers.
    pub annotations: Vec<Annotation>,
}

/// The place of a chart (px).
#[derive(Clone, Copy, Debug)]
pub(super) struct PlotArea {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    /// Pixels for one pixel of type in the reference picture.
    pub unit: f64,
    /// Thickness of lines, relative to the reference picture.
    pub line: f64,
}

impl PlotArea {
    /// Thickness of hairlines, which depends on the type, in whole pixels.
    fn hairline(self) -> f64 {
        self.unit.round().max(1.0)
    }

    /// The colour of a hairline. A hairline thinner than a pixel is fainter instead.
    fn thinned(self, colour: Colour, ground: Colour) -> Colour {
        mixed(ground, colour, (1.25 * self.unit / self.hairline()).min(1.0))
    }

    /// The baseline of the numbers below (px).
    pub(super) fn below(self) -> f64 {
        self.bottom + (SHORT - FREE) * self.unit
    }

    /// The sides within which curves are drawn: they leave at the top and at the bottom only.
    fn borders(self) -> [f64; 4] {
        [f64::NEG_INFINITY, self.top - CLOSE * self.unit, f64::INFINITY, self.bottom + CLOSE * self.unit]
    }

    /// The horizontal place of a value (px).
    fn x(self, axis: &Axis, value: f64) -> f64 {
        self.left + axis.share(value).clamp(0.0, 1.0) * (self.right - self.left)
    }

    /// The height of a value (px), which may be far outside.
    fn y(self, axis: &Axis, value: f64) -> f64 {
        self.bottom - axis.share(value) * (self.bottom - self.top)
    }

    /// The left and right end of a stretch of the axis to the right (px).
    fn ends(self, stretch: &Stretch) -> [f64; 2] {
        stretch.along.map(|share| self.left + share * (self.right - self.left))
    }

    fn curve(self, points: &[[f64; 2]], width: f64, dash: &[f64], paint: impl Into<Paint>) -> Item {
        let dash: Vec<_> = dash.iter().map(|length| length * self.line).collect();
        Item::curve(points, width * self.line, &dash, paint)
    }
}

impl Axis {
    /// An axis of time between two moments (s), with as many numbers as fit between two ends (px). Its scale may change
    /// at a moment between.
    fn of_time([left, right]: [f64; 2], unit: f64, [from, to]: [f64; 2], split: Option<f64>) -> Self {
        let stretch = |range: [f64; 2], along: [f64; 2]| {
            let most = (along[1] - along[0]) * (right - left) / (MARGIN * unit);
            Stretch { along, ..Stretch::new(Kind::Fixed, range, "s", 1.0, (most as usize).clamp(2, MOST_TIMES)) }
        };
        let Some(split) = split else { return Self(vec![stretch([from, to], [0.0, 1.0])]) };
        let gap = (BESIDE * unit).round();
        let middle = (BEFORE * (right - left - gap)).round();
        let [before, after] = [middle, middle + gap].map(|end| end / (right - left));
        Self(vec![stretch([from, split], [0.0, before]), stretch([split, to], [after, 1.0])])
    }
}

impl Chart {
    /// The place of a pair of values in a rectangle: left, top, right and bottom (px).
    pub fn at(&self, [left, top, right, bottom]: [f64; 4], [x, y]: [f64; 2]) -> [f64; 2] {
        let place = PlotArea { left, right, top, bottom, unit: 1.0, line: 1.0 };
        [place.x(&self.x, x), place.y(&self.y, y)]
    }

    /// Draws the axes with their numbers, optionally with those to the right.
    pub(super) fn ground(&self, writer: &mut Writer<'_>, place: PlotArea, with_times: bool) {
        self.rows(writer, place);
        if with_times || self.y.0.is_empty() {
            self.columns(writer, place);
        }
    }

    /// Draws the layers and what lies above them.
    pub(super) fn curves(&self, writer: &mut Writer<'_>, place: PlotArea) {
        self.layers.iter().for_each(|layer| layer.draw(writer, self, place));
        self.annotations.iter().for_each(|one| one.draw(writer, self, place));
    }

    /// Hairlines at round values, a stronger one at zero, with their numbers. Where two numbers are too close, only the
    /// upper one is written.
    fn rows(&self, writer: &mut Writer<'_>, place: PlotArea) {
        let palette = writer.palette;
        let thickness = place.hairline();
        for stretch in &self.y.0 {
            for (at, (&tick, text)) in stretch.ticks.iter().zip(&stretch.texts).enumerate() {
                let y = place.y(&self.y, tick);
                let colour = if tick == 0.0 { palette.axis } else { palette.hairline };
                for [left, right] in self.x.0.iter().map(|stretch| place.ends(stretch)) {
                    let line = [left, (y - thickness / 2.0).round(), right - left, thickness];
                    writer.marks.push(Item::rectangle(line, place.thinned(colour, palette.background)));
                }
                let above = stretch.ticks.get(at + 1).map(|&next| place.y(&self.y, next));
                if above.is_none_or(|above| y - above >= SMALL * place.unit) {
                    let [right, baseline] = [place.left - NEAR * place.unit, y + 0.36 * SMALL * place.unit];
                    writer.right(text, Weight::Regular, SMALL * place.unit, palette.second_text, right, baseline);
                }
            }
        }
    }

    /// Ticks at round values to the right, on a logarithmic axis lines, with their numbers, the last one of a stretch
    /// with the unit. Numbers end with their stretch.
    fn columns(&self, writer: &mut Writer<'_>, place: PlotArea) {
        let (palette, thickness, size) = (writer.palette, place.hairline(), SMALL * place.unit);
        let [hairline, axis] = [palette.hairline, palette.axis].map(|colour| place.thinned(colour, palette.background));
        for (part, stretch) in self.x.0.iter().enumerate() {
            let [left, right] = place.ends(stretch);
            if self.y.0.is_empty() {
                let line = [left, (place.bottom - thickness / 2.0).round(), right - left, thickness];
                writer.marks.push(Item::rectangle(line, hairline));
            }
            // The start is beside the lowest value's number, or beside the times of the other scale.
            let from = left - if part == 0 { CLOSE * place.unit } else { 0.0 };
            let mut free = f64::INFINITY;
            // Numbers are written backwards from the last one, which has the unit. Numbers that would overlap are left
            // out.
            for (at, (&tick, text)) in stretch.ticks.iter().zip(&stretch.texts).enumerate().rev() {
                let x = left + stretch.share(tick).clamp(0.0, 1.0) * (right - left);
                let [side, top] = [x - thickness / 2.0, place.bottom + thickness / 2.0].map(f64::round);
                let length = (TICK * place.unit).round().max(2.0);
                writer.marks.push(match stretch.is_logarithmic {
                    true => Item::rectangle([side, place.top, thickness, place.bottom - place.top], hairline),
                    false => Item::rectangle([side, top, thickness, length], axis),
                });
                let half = writer.fonts.width(text, Weight::Regular, size) / 2.0;
                let is_last = at + 1 == stretch.ticks.len() && !stretch.unit.is_empty();
                let text = if is_last { format!("{text} {}", stretch.unit) } else { text.clone() };
                let width = writer.fonts.width(&text, Weight::Regular, size);
                let start = (x - half).min(right - width).max(from);
                if start + width + NEAR * place.unit <= free {
                    writer.left(&text, Weight::Regular, size, palette.second_text, start, place.below());
                    free = start;
                }
            }
        }
    }
}
