//! The key of colours, lines and arrows: one for all panels, below them, so that it overlaps nothing.

use super::Item;
use super::arrows::{self, DrawArrow};
use super::caption::Writer;
use super::chart::axis::Stretch;
use super::chart::{Axis, Chart, PlotArea};
use super::ghost;
use super::layout::steps::{BESIDE, BLOCK, MARGIN, NAME_ROW, SHORT, SMALL, STRONG, TEXT, TILE};
use super::layout::tree::{self, Node};
use super::layout::{SMALLEST_TYPE, Scale};
use super::page::{Path, point};
use super::text::Weight;
use crate::colour::Colour;
use crate::look::{BODIES, View};
use glam::DVec2;
use std::f64::consts::TAU;

/// The least width of the bar with its name, in those of a sample.
const BAR: f64 = 1.5;
/// The least width of the sample of a body with its name, in those of others.
const BODY: f64 = 0.5;
/// The sample of a torque: where its arc begins, below at the left, and its length, in turns; and its pieces.
const ARC: [f64; 2] = [0.4, 0.75];
const PIECES: u32 = 24;
/// The most ticks of a bar.
pub(super) const MOST_TICKS: usize = 5;

/// A colour scale.
pub(super) struct Bar<'a> {
    pub(super) name: String,
    pub(super) definition: &'static str,
    /// The values along it.
    pub(super) axis: Stretch,
    pub(super) ramp: &'a [Colour],
    /// Whether there are values below and above it.
    pub(super) beyond: [bool; 2],
}

/// A line or a mark with its meaning.
pub(super) struct Sample {
    /// Wordings of its name, at least one. The longest one that fits is used.
    pub(super) names: Vec<String>,
    pub(super) kind: SampleKind,
}

impl Sample {
    /// The width of its mark, and its least width with its name (px in the reference picture).
    fn least(&self) -> [f64; 2] {
        match self.kind {
            SampleKind::Body(_) => [SHORT, BODY * TILE],
            _ => [BLOCK, TILE],
        }
    }
}

/// The look of a sample.
pub(super) enum SampleKind {
    /// An arrow of a length (px), with its size relative to the reference picture.
    Arrow([f64; 2], Colour, DrawArrow),
    /// The arc of a torque, with the size of its arrow.
    Arc(f64),
    /// The dashed outline of a ghost.
    Ghost(Colour),
    /// Paths, each of a run in its colour.
    Path(Vec<Colour>),
    /// A body in its colour, with its outline.
    Body([Colour; 2]),
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
    /// The key of a view with panels of a scale; `None` if there is nothing to explain.
    pub(super) fn of(view: &View, scale: Scale) -> Option<Self> {
        let overlays = view.explained().into_iter().filter(|&is_explained| is_explained).count() as f64;
        let bodies = view.coloured_bodies().len().min(BODIES) as f64;
        view.has_key().then(|| Self::new(view.size, scale, overlays + BODY * bodies, view.colour.is_some()))
    }

    /// The key of a picture of a size (px) with panels of a scale, with a number of samples, and with or without a bar. A
    /// key that could not be read has no room. Samples of bodies count as a share of others.
    pub(super) fn new(size: [u32; 2], scale: Scale, samples: f64, has_bar: bool) -> Self {
        let room = f64::from(size[0].max(1)) - 2.0 * scale.margin();
        let [bar, bars] = if has_bar { [BAR, 1.0] } else { [0.0; 2] };
        let needed = (samples + bar) * TILE + (samples + bars - 1.0).max(0.0) * MARGIN;
        // A picture with a field needs its key at any size.
        let unit = scale.type_unit().max(SMALLEST_TYPE / SMALL).min(room / needed);
        Self { unit, height: if Scale::legible(SMALL * unit) { NAME_ROW * unit } else { f64::INFINITY } }
    }

    /// Draws the key from a height on in a picture of a width (px).
    pub(super) fn draw(
        self,
        writer: &mut Writer<'_>,
        [width, top]: [f64; 2],
        samples: &[Sample],
        bar: Option<&Bar<'_>>,
    ) {
        let (unit, margin) = (self.unit, writer.scale.margin());
        let gap = |at: usize| if at > 0 { MARGIN * unit } else { 0.0 };
        let wide = |sample: &Sample| {
            let name = writer.fonts.width(&sample.names[0], Weight::Regular, TEXT * unit);
            (sample.least()[0] + BESIDE) * unit + name
        };
        let boxes = samples
            .iter()
            .enumerate()
            .map(|(at, sample)| Node::new(at, wide(sample)).least(sample.least()[1] * unit).after(gap(at)));
        let of_bar = bar.map(|_| Node::new(samples.len(), BAR * TILE * unit).stretched().after(gap(samples.len())));
        let row = Node::new(usize::MAX, self.height).with(boxes.chain(of_bar).collect());
        let solved = tree::column(&[row], [margin, top.round(), width - 2.0 * margin, self.height]);
        for (at, sample) in samples.iter().enumerate() {
            solved.all(at).for_each(|place| self.sample(writer, place, sample));
        }
        if let Some((bar, place)) = bar.zip(solved.get(samples.len())) {
            self.bar(writer, place, width / 2.0, bar);
        }
    }

    /// A sample with its name.
    fn sample(self, writer: &mut Writer<'_>, [left, top, width, _]: tree::Place, sample: &Sample) {
        let (unit, palette, fonts) = (self.unit, writer.palette, writer.fonts);
        let (middle, mut length) = (top + 0.5 * (BESIDE * unit).round(), sample.least()[0] * unit);
        let curve = |[from, to]: [f64; 2], dash: &[f64], colour: Colour| {
            Item::curve(&[[from, middle], [to, middle]], STRONG * unit, dash, colour)
        };
        match sample.kind {
            SampleKind::Arrow([own, size], colour, draw) => {
                let ends = [left, left + own].map(|x| DVec2::new(x, middle));
                writer.marks.push(Item::part("arrow", draw(ends, size, colour, palette.background)));
                length = own;
            }
            SampleKind::Arc(size) => {
                let radius = 0.5 * SHORT * unit;
                let at = |turn: f64| DVec2::new(left + radius, middle) + radius * DVec2::from_angle(turn * TAU);
                let pixels = (0..=PIECES).map(|piece| at(ARC[0] + ARC[1] * f64::from(piece) / f64::from(PIECES)));
                writer.marks.push(arrows::bent(&pixels.collect::<Vec<_>>(), [unit, size], palette));
                length = 2.0 * radius;
            }
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
            SampleKind::Body([colour, outline]) => {
                let (side, rim) = (length.round(), (STRONG * unit).round().max(1.0));
                let [left, top] = [left, middle - 0.5 * side].map(f64::round);
                let square = |inset: f64| [left + inset, top + inset, side - 2.0 * inset, side - 2.0 * inset];
                writer.marks.push(Item::part(
                    "body",
                    [Item::rectangle(square(0.0), outline), Item::rectangle(square(rim), colour)],
                ));
            }
        }
        let before = length + BESIDE * unit;
        let (size, room) = (TEXT * unit, width - before);
        let fits = |name: &&String| fonts.width(name, Weight::Regular, size) <= room + 1e-6;
        let name = sample.names.iter().find(fits).or(sample.names.last()).map_or("", |name| name);
        let name = fonts.shortened(name, Weight::Regular, size, room + 1e-6);
        writer.left(&name, Weight::Regular, size, palette.second_text, left + before, middle + 0.34 * size);
    }

    /// A colour bar with its name before it, its numbers below and, if there is room, its definition below its name. It
    /// is centred at a place if possible.
    fn bar(self, writer: &mut Writer<'_>, [left, top, width, _]: tree::Place, middle: f64, bar: &Bar<'_>) {
        let (unit, palette, fonts) = (self.unit, writer.palette, writer.fonts);
        let [size, small, gap] = [TEXT, SMALL, SHORT].map(|length| length * unit);
        let length = (TILE * unit).min(0.5 * width).round();
        let room = width - length - gap;
        // The name of a run may be long.
        let name = fonts.shortened(&bar.name, Weight::SemiBold, size, room);
        let defined = fonts.width(bar.definition, Weight::Regular, small);
        let definition = if defined <= room { bar.definition } else { "" };
        let named = fonts.width(&name, Weight::SemiBold, size);
        let named = if definition.is_empty() { named } else { named.max(defined) };
        let whole = named + gap + length;
        let left = (middle - whole / 2.0).clamp(left, (left + width - whole).max(left));
        let height = (BESIDE * unit).round().max(2.0);
        let bar_left = (left + named + gap).round();
        let place = PlotArea { left: bar_left, right: bar_left + length, top, bottom: top + height, unit, line: unit };
        let chart = Chart { x: Axis(vec![bar.axis.clone()]), ..Chart::default() };
        chart.ground(writer, place, true);
        writer.left(&name, Weight::SemiBold, size, palette.text, left, top + 0.5 * height + 0.34 * size);
        writer.left(definition, Weight::Regular, small, palette.second_text, left, place.below());
        let rim = unit.round().max(1.0);
        // If values lie beyond the scale, the bar ends in a point.
        let cap = 0.8 * height;
        for (end, x) in [place.left, place.right].into_iter().enumerate().filter(|&(end, _)| bar.beyond[end]) {
            let colour = bar.ramp[if end == 0 { 0 } else { bar.ramp.len() - 1 }];
            for (out, colour) in [(rim, palette.axis), (0.0, colour)] {
                let [wide, high] = [cap + 1.6 * out, height + 2.0 * out];
                let tip = if end == 0 { x - wide } else { x + wide };
                let middle = top + 0.5 * height;
                let corners = [[x, middle - 0.5 * high], [tip, middle], [x, middle + 0.5 * high]];
                let path = Path::polygon(&corners.map(|at| point(at.into())));
                writer.marks.push(Item::part("point", [Item::fill(path, colour)]));
            }
        }
        let sides = bar.beyond.map(|is_beyond| if is_beyond { 0.0 } else { rim });
        let framed = [place.left - sides[0], top - rim, length + sides[0] + sides[1], height + 2.0 * rim];
        writer.marks.push(Item::rectangle(framed, palette.axis));
        let [corner, size, end] = [[place.left, top], [length, height], [place.right, top]].map(|at| point(at.into()));
        let path = Path::rectangle(corner, size);
        writer.marks.push(Item::Blend { path, ends: [corner, end], colours: bar.ramp.to_vec() });
    }

    /// The greatest length of an arrow (px).
    pub(super) fn arrow_length(self) -> f64 {
        BLOCK * self.unit
    }
}
