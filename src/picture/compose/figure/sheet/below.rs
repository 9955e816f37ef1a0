//! The text below the bodies of a contact sheet: tallies, counts and diagnostics, and the key of the tallies.

use super::sheet_layout::{SheetLayout, TALLY_RAISED};
use crate::picture::caption::{Writer, diverged, wider};
use crate::picture::compose::Composer;
use crate::picture::layout::Scale;
use crate::picture::tally::{self, Tally};
use crate::picture::text::Weight;
use crate::picture::{chart, number};
use crate::reading::captions::elements;
use crate::scene::Scene;
use crate::sim::{Diagnostic, RunFrame, Snapshot, Status};

/// Size of diagnostics (px in the reference picture).
const NUMBER: f64 = 14.0;
/// The size of tallies relative to those of panels, their largest share of a tile's width, and the gap between
/// tally, count and number (px in the reference picture).
const TALLY: f64 = 0.54;
const TALLY_SHARE: f64 = 0.6;
const COUNT_GAP: f64 = 10.0;
const NUMBER_GAP: f64 = 18.0;
/// Half the height of digits, in sizes of type.
const X_MIDDLE: f64 = 0.36;

/// The tallies of all scenes in one style: squares for all, or bars.
pub(super) fn tallies(scenes: &[Scene], scale: Scale, layout: &SheetLayout) -> Vec<Tally> {
    let tallies: Vec<_> = scenes.iter().map(|scene| Tally::new(&scene.body, scene.view.side)).collect();
    let (scale, room) = size_of_tallies(scale, layout);
    let have_squares = tallies.iter().all(|tally| tally.has_squares(scale, room));
    if have_squares { tallies } else { tallies.iter().map(Tally::as_bar).collect() }
}

/// The scale and the width of tallies (px).
fn size_of_tallies(scale: Scale, layout: &SheetLayout) -> (Scale, f64) {
    (scale.with_unit(TALLY * scale.unit), TALLY_SHARE * layout.words_width(scale))
}

/// Wordings of the key of turned-over elements, from the longest to the shortest.
pub(super) fn key(scenes: &[Scene], tallies: &[Tally], scale: Scale, layout: &SheetLayout) -> Vec<String> {
    let (scale, room) = size_of_tallies(scale, layout);
    let kinds: Vec<_> = scenes.iter().flat_map(|scene| elements(&scene.body)).map(|(_, kind)| kind).collect();
    let same = kinds.first().filter(|first| kinds.iter().all(|kind| kind == *first));
    let kind = same.and_then(|kind| kind.strip_suffix('s')).unwrap_or("element");
    let mut wordings = vec!["turned over".to_owned()];
    let several = scenes.iter().any(|scene| scene.body.elements.len() > 1);
    if several && tallies.iter().all(|tally| tally.has_squares(scale, room)) {
        wordings.push(format!("turned over (one square per {kind})"));
        if tallies.iter().all(Tally::has_layers) {
            wordings.push(format!("turned over (one square per {kind}, lowest layer at the bottom)"));
        }
    }
    wordings.reverse();
    wordings
}

/// The text below the body of a tile.
pub(super) struct Below<'a> {
    /// The tally, if there is one, and the turned-over and the flat elements.
    tally: Option<&'a Tally>,
    states: [&'a [bool]; 2],
    tally_width: f64,
    /// The number of turned-over elements or, if there are none, of flat ones; empty if unknown.
    count: String,
    is_alarm: bool,
    /// A diagnostic; empty for none.
    number: String,
    /// Wordings for a run that diverges, from long to short; empty if it does not.
    diverged: Vec<String>,
}

impl<'a> Below<'a> {
    /// The text for a run, with a diagnostic if requested.
    pub(super) fn new(
        writer: &Writer<'_>,
        layout: &SheetLayout,
        composer: &'a Composer<'_>,
        run: &'a RunFrame,
        number: Option<Diagnostic>,
    ) -> Self {
        let Snapshot { turned_over: over, flat, .. } = &run.snapshot;
        let diverged = match run.shown().status {
            Status::Diverged(divergence) => {
                let when = format!("{} at {}", diverged(run), number::time(divergence.time));
                let whole = wider(run).map(|wider| format!("{when}, {wider}"));
                whole.into_iter().chain([when, diverged(run).to_owned()]).collect()
            }
            Status::Ok => Vec::new(),
        };
        let tally = (!over.is_empty()).then_some(&composer.tally);
        let states = [&over[..], &flat[..]];
        let (scale, room) = size_of_tallies(writer.scale, layout);
        let count = run.snapshot.diagnostics.turned_over;
        let flattened = flat.iter().filter(|&&flat| flat).count();
        Self {
            tally,
            states,
            tally_width: tally.map_or(0.0, |tally| tally.width(scale, room)),
            count: match count {
                _ if over.is_empty() => String::new(),
                0 if flattened > 0 => format!("{flattened} flat"),
                count => number::count(count),
            },
            is_alarm: count > 0,
            number: number.and_then(|diagnostic| text(diagnostic, composer.scene, run)).unwrap_or_default(),
            diverged,
        }
    }

    /// Width of tally and count (px).
    fn counted(&self, writer: &Writer<'_>) -> f64 {
        let gap = if self.count.is_empty() { 0.0 } else { COUNT_GAP * writer.scale.type_unit() };
        self.tally_width + gap + writer.fonts.width(&self.count, Weight::SemiBold, writer.scale.caption())
    }

    /// Whether the diagnostic has room, too.
    pub(super) fn has_room(&self, writer: &Writer<'_>, layout: &SheetLayout) -> bool {
        let size = NUMBER * writer.scale.type_unit();
        let number = NUMBER_GAP * writer.scale.type_unit() + writer.fonts.width(&self.number, Weight::Regular, size);
        self.number.is_empty()
            || Scale::legible(size) && self.counted(writer) + number <= layout.words_width(writer.scale)
    }

    /// Writes tally, count and, if it has room in all tiles, the diagnostic; or that the run diverged.
    pub(super) fn write(
        self,
        writer: &mut Writer<'_>,
        layout: &SheetLayout,
        [row, column]: [usize; 2],
        with_number: bool,
    ) {
        let (scale, palette, fonts) = (writer.scale, writer.palette, writer.fonts);
        let size = scale.caption();
        if !layout.has_tally || !Scale::legible(size) {
            return;
        }
        let [left, top, width, height] = layout.tile(row, column).map(f64::from);
        let (middle, bottom) = (left + 0.5 * width, top + height - TALLY_RAISED * scale.unit);
        let baseline = bottom - 0.5 * TALLY * tally::HEIGHT * scale.type_unit() + X_MIDDLE * size;
        if !self.diverged.is_empty() {
            let wide = |text: &str| fonts.width(text, Weight::SemiBold, size);
            let Some(text) = self.diverged.iter().find(|text| wide(text) <= layout.words_width(scale)) else { return };
            return writer.left(text, Weight::SemiBold, size, palette.text, middle - 0.5 * wide(text), baseline);
        }
        let small = NUMBER * scale.type_unit();
        let number = if with_number { &self.number[..] } else { "" };
        let gap = if number.is_empty() { 0.0 } else { NUMBER_GAP * scale.type_unit() };
        let counted = self.counted(writer);
        let left = (middle - 0.5 * (counted + gap + fonts.width(number, Weight::Regular, small))).round();
        let corner = [left, bottom.round()];
        let (scale, room) = size_of_tallies(scale, layout);
        if let Some(tally) = self.tally {
            tally.draw(self.states, palette, scale, room, corner, &mut writer.marks);
        }
        let colour = if self.is_alarm { palette.alarm_text } else { palette.second_text };
        let count_left = left + counted - fonts.width(&self.count, Weight::SemiBold, size);
        writer.left(&self.count, Weight::SemiBold, size, colour, count_left, baseline);
        writer.left(number, Weight::Regular, small, palette.second_text, left + counted + gap, baseline);
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
    let value = number::value(diagnostic, value, scene.body.extent());
    Some(format!("{name} {value}"))
}
