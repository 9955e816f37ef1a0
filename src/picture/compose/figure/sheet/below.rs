//! The text below the bodies of a contact sheet: tallies, counts and diagnostics, and the key of the tallies.

use super::sheet_layout::SheetLayout;
use crate::picture::caption::{Writer, diverges, shown_moment};
use crate::picture::compose::Composer;
use crate::picture::layout::steps::{BESIDE, NEAR, SHORT};
use crate::picture::layout::{Part, Scale};
use crate::picture::tally::{self, Tally, hollow, struck};
use crate::picture::text::Weight;
use crate::picture::{Colour, chart, number};
use crate::reading::captions::elements;
use crate::runner::RunFrame;
use crate::scene::Scene;
use crate::sim::{Diagnostic, Snapshot, Status};

/// The size of tallies relative to those of panels, and their largest share of a tile's width.
const TALLY: f64 = 0.54;
const TALLY_SHARE: f64 = 0.6;
/// Half the height of digits, in sizes of type.
const X_MIDDLE: f64 = 0.36;
/// The meaning of a hollow square.
const FLAT: &str = "flat: volume below 1 %";

/// Gives the tallies of all shown bodies one style: squares for all, or bars.
pub(super) fn unify(composers: &mut [Composer<'_>], shown: &[[usize; 2]], scale: Scale, layout: &SheetLayout) {
    let (scale, room) = size_of_tallies(scale, layout);
    if !tallies(composers, shown).all(|tally| tally.squares(scale, room).is_some()) {
        let all = composers.iter_mut().flat_map(|composer| &mut composer.bodies);
        all.for_each(|bodies| bodies.tally = bodies.tally.as_bar());
    }
}

/// The tallies of the runs shown, each given by the places of its scene and of the run in it.
fn tallies<'c>(composers: &'c [Composer<'_>], shown: &'c [[usize; 2]]) -> impl Iterator<Item = &'c Tally> {
    shown.iter().map(|&[scene, run]| &composers[scene].bodies(run).tally)
}

/// The scale and the width of tallies (px).
fn size_of_tallies(scale: Scale, layout: &SheetLayout) -> (Scale, f64) {
    (scale.with_unit(TALLY * scale.unit), TALLY_SHARE * layout.words_width(scale))
}

/// The key of struck squares and, if there are any, of hollow ones.
pub(super) struct TallyKey {
    /// The meaning of struck squares, from the longest to the shortest wording.
    pub(super) wordings: Vec<String>,
    has_flat: bool,
}

impl TallyKey {
    /// The key for the runs shown, each given by the places of its scene and of the run in it.
    pub(super) fn new(composers: &[Composer<'_>], shown: &[[usize; 2]], has_flat: bool) -> Self {
        let bodies = || shown.iter().map(|&[scene, run]| composers[scene].bodies(run).body());
        let tallies = || tallies(composers, shown);
        let kinds: Vec<_> = bodies().flat_map(elements).map(|(_, kind)| kind).collect();
        let same = kinds.first().filter(|first| kinds.iter().all(|kind| kind == *first));
        let kind = same.and_then(|kind| kind.strip_suffix('s')).unwrap_or("element");
        let mut wordings = vec!["turned over".to_owned()];
        let several = bodies().any(|body| body.elements().len() > 1);
        if several && tallies().all(Tally::has_rows) {
            if tallies().all(Tally::has_layers) {
                wordings.push(format!("turned over (a square per {kind}, in layers)"));
                wordings.push(format!("turned over (one square per {kind}, lowest layer at the bottom)"));
            } else {
                wordings.push(format!("turned over (one square per {kind})"));
            }
        }
        wordings.reverse();
        Self { wordings, has_flat }
    }

    /// The width of a square with its words (px).
    fn one(writer: &Writer<'_>, text: &str) -> f64 {
        (BESIDE + NEAR) * writer.scale.type_unit() + writer.fonts.width(text, Weight::Regular, writer.scale.caption())
    }

    /// The width with a wording (px).
    pub(super) fn width(&self, writer: &Writer<'_>, text: &str) -> f64 {
        let flat = if self.has_flat { Self::one(writer, FLAT) + SHORT * writer.scale.type_unit() } else { 0.0 };
        flat + Self::one(writer, text)
    }

    /// Writes a wording that ends at a place on a baseline (px).
    pub(super) fn write(&self, writer: &mut Writer<'_>, text: &str, [right, baseline]: [f64; 2]) {
        let (scale, palette) = (writer.scale, writer.palette);
        let side = (BESIDE * scale.type_unit()).round().max(2.0);
        let flat = self.has_flat.then_some((FLAT, right - self.width(writer, text)));
        for (text, left) in flat.into_iter().chain([(text, right - Self::one(writer, text))]) {
            let square = [left.round(), (baseline - X_MIDDLE * scale.caption() - side / 2.0).round(), side, side];
            let marks = if text == FLAT { hollow(square, palette).to_vec() } else { vec![struck(square, palette)] };
            writer.marks.extend(marks);
            let right = left + Self::one(writer, text);
            writer.right(text, Weight::Regular, scale.caption(), palette.second_text, right, baseline);
        }
    }
}

/// The text below the body of a tile.
pub(super) struct Below<'a> {
    /// The tally, if there is one, the turned-over and the flat elements, and its width (px).
    tally: Option<(&'a Tally, [&'a [bool]; 3], f64)>,
    /// The number of broken elements of a run that breaks, else of turned-over ones, then of flat ones, then a diagnostic; or that the run diverges.
    texts: [Option<Text>; 3],
}

/// Which of the number of flat elements, which the tally shows as well, and the diagnostic are written.
pub(super) type Written = [bool; 2];

type Text = (String, Weight, f64, Colour);

impl<'a> Below<'a> {
    /// The text for a run, with a diagnostic if requested.
    pub(super) fn new(
        writer: &Writer<'_>,
        layout: &SheetLayout,
        composer: &'a Composer<'_>,
        run: &'a RunFrame,
        number: Option<Diagnostic>,
    ) -> Self {
        let (scale, palette) = (writer.scale, writer.palette);
        if let Status::Diverged(divergence) = run.shown().status {
            let when = format!("{} at {}", diverges(run), number::time(divergence.time, composer.scene.duration));
            let shown = shown_moment(run, divergence.time, composer.scene.duration);
            let whole = shown.map(|shown| format!("{when}, {shown}"));
            let mut wordings = whole.into_iter().chain([when, diverges(run).to_owned()]);
            let wide = |text: &String| writer.fonts.width(text, Weight::SemiBold, scale.caption());
            let fitting = wordings.find(|text| wide(text) <= layout.words_width(scale));
            let text = |text| (text, Weight::SemiBold, scale.caption(), palette.text);
            return Self { tally: None, texts: [fitting.map(text), None, None] };
        }
        let Snapshot { turned_over: over, flat, broken, broken_springs, diagnostics, .. } = &run.snapshot;
        if over.is_empty() {
            return Self { tally: None, texts: [None, None, None] };
        }
        let states = [&over[..], &flat[..], &broken[..]];
        let (smaller, room) = size_of_tallies(scale, layout);
        let tally = &composer.bodies(run.run).tally;
        let width = tally.width(smaller, room);
        let [flattened, gone] = [flat, broken].map(|state| state.iter().filter(|&&is_so| is_so).count());
        let (count, colour) = match diagnostics.turned_over {
            _ if !broken_springs.is_empty() => (format!("{} in pieces", number::count(gone)), palette.second_text),
            _ if !broken.is_empty() => (format!("{} broken", number::count(gone)), palette.second_text),
            0 => (number::count(0), palette.second_text),
            count => (number::count(count), palette.alarm_text),
        };
        let number = number.and_then(|diagnostic| text(diagnostic, composer.scene, run));
        let number = number.map(|text| (text, Weight::Regular, scale.small(), palette.second_text));
        let flat = (flattened > 0).then(|| format!("{} flat", number::count(flattened)));
        let flat = flat.map(|text| (text, Weight::Regular, scale.small(), palette.second_text));
        let count = (count, Weight::SemiBold, scale.caption(), colour);
        Self { tally: Some((tally, states, width)), texts: [Some(count), flat, number] }
    }

    /// The texts that are written.
    fn texts(&self, [flat, number]: Written) -> impl Iterator<Item = &Text> {
        self.texts
            .iter()
            .zip([true, flat, number])
            .filter(|(_, written)| *written)
            .filter_map(|(text, _)| text.as_ref())
    }

    /// The width of the tally and of the texts (px).
    fn width(&self, writer: &Writer<'_>, written: Written) -> f64 {
        let gap = BESIDE * writer.scale.type_unit();
        let texts = self.texts(written);
        let texts = texts.map(|(text, weight, size, _)| gap + writer.fonts.width(text, *weight, *size)).sum::<f64>();
        self.tally.map_or(-gap, |(.., width)| width) + texts
    }

    /// Whether the tally and the texts have room.
    pub(super) fn has_room(&self, writer: &Writer<'_>, layout: &SheetLayout, written: Written) -> bool {
        let is_legible = self.texts(written).all(|&(_, _, size, _)| Scale::legible(size));
        is_legible && self.width(writer, written) <= layout.words_width(writer.scale)
    }

    /// Writes the tally and the texts into a tile.
    pub(super) fn write(&self, writer: &mut Writer<'_>, layout: &SheetLayout, tile: [usize; 2], written: Written) {
        let scale = writer.scale;
        let [left, top, width, height] = layout.tile(tile[0], tile[1]).map(f64::from);
        let bottom = top + height - NEAR * scale.unit;
        let baseline = bottom - 0.5 * TALLY * tally::HEIGHT * scale.type_unit() + X_MIDDLE * Part::Numbers.size(scale);
        let mut left = (left + 0.5 * (width - self.width(writer, written))).round();
        if let Some((tally, states, width)) = self.tally {
            let (smaller, room) = size_of_tallies(scale, layout);
            tally.draw(states, writer.palette, smaller, room, [left, bottom.round()], &mut writer.marks);
            left += width + BESIDE * scale.type_unit();
        }
        for (text, weight, size, colour) in self.texts(written) {
            writer.left(text, *weight, *size, *colour, left, baseline);
            left += writer.fonts.width(text, *weight, *size) + BESIDE * scale.type_unit();
        }
    }
}

/// A diagnostic with its name; `None` if it has no value.
fn text(diagnostic: Diagnostic, scene: &Scene, run: &RunFrame) -> Option<String> {
    let value = diagnostic.of(&run.snapshot.diagnostics);
    let name = chart::name(diagnostic, scene);
    let name = name.strip_suffix(" ratio").unwrap_or(name);
    if !value.is_finite() || diagnostic == Diagnostic::TurnedOver {
        return None;
    }
    let value = number::value(diagnostic, value, scene.extent());
    Some(format!("{name} {value}"))
}
