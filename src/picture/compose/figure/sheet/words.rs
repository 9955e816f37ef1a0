//! The words of a contact sheet: headings of columns, names of rows, tallies and counts below bodies.

use super::plan::{HEADING_LINE, Plan, TALLY_RAISED};
use crate::picture::caption::{self, Writer, wrapped};
use crate::picture::compose::{Composer, cut};
use crate::picture::layout::Scale;
use crate::picture::narrow::narrow;
use crate::picture::tally::Tally;
use crate::picture::text::{Fonts, Weight};
use crate::picture::{Mark, course, number, tally};
use crate::scene::Scene;
use crate::scene::figure::{Row, Sheet};
use crate::sim::snapshot::{Diagnostic, RunFrame, Status};
use crate::sim::words::elements;

/// Names and notes of rows are at most this part of the picture wide, and have at most so many lines.
const WIDEST: f64 = 0.125;
const NAME_LINES: usize = 2;
const NOTE_LINES: usize = 3;
/// Size of notes, distances of the lines of names and notes, and from a name to the sample of its line and on to the
/// notes (px in the reference picture).
const NOTE: f64 = 14.0;
const NAME_LINE: f64 = 20.0;
const NOTE_LINE: f64 = 18.0;
const SAMPLE_BELOW: f64 = 13.0;
const NOTE_BELOW: f64 = 21.0;
/// Between the letter of a column and what stands beside it, and between columns (px in the reference picture).
const LETTER_GAP: f64 = 10.0;
const HEADINGS_APART: f64 = 14.0;
/// How large tallies are beside those of panels, the part of a tile's width that they take at most, and between tally, count and number (px in the reference picture).
const TALLY: f64 = 0.54;
const TALLY_SHARE: f64 = 0.6;
const COUNT_GAP: f64 = 10.0;
const NUMBER_GAP: f64 = 18.0;
/// Half the height of digits, in parts of the type's size.
const X_MIDDLE: f64 = 0.36;

/// What the key of turned-over elements may say, from the longest wording to the shortest.
pub(super) fn key(scenes: &[Scene]) -> Vec<String> {
    let tallies: Vec<_> = scenes.iter().map(|scene| Tally::new(&scene.body, scene.view.side)).collect();
    let kinds: Vec<_> = scenes.iter().flat_map(|scene| elements(&scene.body)).map(|(_, kind)| kind).collect();
    let same = kinds.first().filter(|first| kinds.iter().all(|kind| kind == *first));
    let kind = same.and_then(|kind| kind.strip_suffix('s')).unwrap_or("element");
    let mut wordings = vec!["turned over".to_owned()];
    let several = scenes.iter().any(|scene| scene.body.elements.len() > 1);
    if several && tallies.iter().all(Tally::has_squares) {
        wordings.push(format!("turned over (one square per {kind})"));
        if tallies.iter().all(Tally::has_layers) {
            wordings.push(format!("turned over (one square per {kind}, lowest layer at the bottom)"));
        }
    }
    wordings.reverse();
    wordings
}

/// What stands above a column.
pub(super) struct Heading {
    /// Empty for none.
    letter: String,
    /// What stands beside the letter.
    pub(super) lines: Vec<String>,
}

impl Heading {
    /// Those of all columns, which are `pitch` apart (px); none if not all have room.
    pub(super) fn all(sheet: &Sheet, writer: &Writer<'_>, pitch: f64, with_charts: bool) -> Vec<Self> {
        let (scale, fonts) = (writer.scale, writer.fonts);
        let size = scale.caption();
        let apart = HEADINGS_APART * scale.unit;
        let count = sheet.columns.len();
        let times = || sheet.columns.iter().filter_map(|column| column.time);
        let moment = moments(times());
        // A moment that every row replaces by its own says nothing.
        let replaced = sheet.rows.iter().all(|row| row.time.is_some());
        let text = |at: usize| {
            let column = &sheet.columns[at];
            let own = column.time.filter(|_| !replaced).map(&moment);
            column.label.clone().or(own).unwrap_or_default()
        };
        let letter = |at: usize| if count > 1 || with_charts { caption::letter(at) } else { String::new() };
        let all = (0..count).map(|at| {
            let letter = letter(at);
            let beside = beside_letter(&letter, fonts, scale);
            let room = pitch - apart - beside;
            let lines = wrapped(fonts, &text(at), Weight::Regular, size, room.max(0.0));
            let lines = lines.into_iter().filter(|line| !line.is_empty()).collect();
            Self { letter, lines }
        });
        let mut all: Vec<_> = all.collect();
        let wide = |text: &str| fonts.width(text, Weight::Regular, size);
        let fits = |heading: &Self| {
            let room = pitch - apart - beside_letter(&heading.letter, fonts, scale);
            let whole = |line: &String| wide(line) <= room && line.chars().count() > 1 || wide(line) <= 0.0;
            heading.lines.is_empty() || heading.lines.len() <= 2 && heading.lines.iter().all(whole)
        };
        if !all.iter().all(fits) {
            // Labels are shortened to one line each, moments are left out.
            let least = 4.0 * size;
            for (at, heading) in all.iter_mut().enumerate() {
                let room = pitch - apart - beside_letter(&heading.letter, fonts, scale);
                let label = sheet.columns[at].label.as_deref().filter(|_| room >= least).unwrap_or_default();
                let short = fonts.shortened(label, Weight::Regular, size, room.max(0.0));
                heading.lines = if short.is_empty() { Vec::new() } else { vec![short] };
            }
        }
        let letters_fit = |heading: &Self| fonts.width(&heading.letter, Weight::SemiBold, size) + 2.0 <= pitch;
        let has_lines = all.iter().any(|heading| !heading.lines.is_empty());
        if !Scale::legible(size) || !all.iter().all(letters_fit) && !has_lines {
            return Vec::new();
        }
        for heading in &mut all {
            // A letter alone still takes a line.
            if heading.lines.is_empty() && !heading.letter.is_empty() {
                heading.lines.push(String::new());
            }
        }
        all
    }
}

/// How moments (s) that stand beside each other are written: with equally many decimals from a second on, and zero like
/// its neighbours.
fn moments(times: impl Iterator<Item = f64>) -> impl Fn(f64) -> String {
    let times: Vec<_> = times.collect();
    let small = times.iter().all(|&time| time < 1.0) || times.iter().any(|&time| time > 0.0 && time < 1.0);
    let decimals = times.iter().map(|&time| number::decimals(time)).max().unwrap_or(1);
    move |time| number::moment(time, small, decimals)
}

/// The room that a letter takes before what stands beside it (px).
fn beside_letter(letter: &str, fonts: &Fonts, scale: Scale) -> f64 {
    if letter.is_empty() {
        return 0.0;
    }
    fonts.width(letter, Weight::SemiBold, scale.caption()) + LETTER_GAP * scale.unit
}

/// Writes the headings of all columns.
pub(super) fn write_headings(writer: &mut Writer<'_>, plan: &Plan, sheet: &Sheet) {
    let (scale, palette) = (writer.scale, writer.palette);
    for (column, heading) in plan.headings.iter().enumerate().take(sheet.columns.len()) {
        let left = f64::from(plan.tile(0, column)[0]);
        let baseline = plan.headings_baseline;
        writer.left(&heading.letter, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
        let left = left + beside_letter(&heading.letter, writer.fonts, scale);
        for (at, line) in heading.lines.iter().enumerate() {
            let baseline = baseline + at as f64 * HEADING_LINE * scale.type_unit();
            writer.left(line, Weight::Regular, scale.caption(), palette.second_text, left, baseline);
        }
    }
}

/// What stands beside the rows.
pub(super) struct RowLabels {
    /// Lines of the name and of the note of each row.
    rows: Vec<[Vec<String>; 2]>,
    /// Whether a sample of the row's line stands below its name.
    with_sample: bool,
    /// The width of all (px).
    pub(super) width: f64,
}

impl RowLabels {
    /// The words beside the rows of a sheet in a picture of a width (px).
    pub(super) fn new(sheet: &Sheet, fonts: &Fonts, scale: Scale, with_sample: bool, picture: f64) -> Self {
        let room = WIDEST * picture;
        let note_size = NOTE * scale.type_unit();
        let lines = |text: &str, weight, size, most: usize| {
            let all = wrapped(fonts, text, weight, size, room);
            let all: Vec<_> = all.into_iter().filter(|line| !line.is_empty()).collect();
            cut(all, most)
        };
        let moment = moments(sheet.rows.iter().filter_map(|row| row.time));
        let one = |row: &Row| {
            let own = row.time.filter(|_| row.note.is_empty()).map(&moment);
            let note = own.as_deref().unwrap_or(&row.note);
            let name = lines(&row.label, Weight::SemiBold, scale.caption(), NAME_LINES);
            let legible = Scale::legible(note_size);
            [name, if legible { lines(note, Weight::Regular, note_size, NOTE_LINES) } else { Vec::new() }]
        };
        let rows: Vec<_> =
            if Scale::legible(scale.caption()) { sheet.rows.iter().map(one).collect() } else { Vec::new() };
        let wide = |lines: &[String], weight, size| {
            lines.iter().map(|line| fonts.width(line, weight, size)).fold(0.0, f64::max)
        };
        let widths = rows.iter().map(|[name, note]| {
            wide(name, Weight::SemiBold, scale.caption()).max(wide(note, Weight::Regular, note_size))
        });
        Self { width: widths.fold(0.0, f64::max), rows, with_sample }
    }

    /// Writes them in the middle of their rows' bodies, as far as there is room.
    pub(super) fn write(&self, writer: &mut Writer<'_>, plan: &Plan, sheet: &Sheet) {
        let Some([left, _]) = plan.labels else { return };
        let (scale, palette) = (writer.scale, writer.palette);
        let unit = scale.type_unit();
        for (row, [name, note]) in self.rows.iter().enumerate() {
            let [_, top, _, height] = plan.tile(row, 0).map(f64::from);
            let room = height - 4.0 * scale.unit;
            let heights = |names: usize, with_sample: bool, notes: usize| {
                let sample = if with_sample { SAMPLE_BELOW } else { 0.0 };
                let notes = if notes > 0 { NOTE_BELOW + (notes - 1) as f64 * NOTE_LINE } else { 0.0 };
                (names as f64 * NAME_LINE + sample + notes) * unit
            };
            // What does not fit is left out: first the note, then the sample, then further lines of the name.
            let choices = [
                (name.len(), self.with_sample, note.len()),
                (name.len(), self.with_sample, 0),
                (name.len(), false, 0),
                (1, false, 0),
            ];
            let fitting = choices.into_iter().find(|&(names, sample, notes)| heights(names, sample, notes) <= room);
            let Some((names, with_sample, notes)) = fitting else { continue };
            let middle = top + 0.5 * (height - plan.below_body);
            let highest = top + room - heights(names, with_sample, notes);
            let mut baseline = (middle - 0.5 * heights(names, with_sample, notes)).clamp(top, highest) + 15.0 * unit;
            for line in &cut(name.clone(), names) {
                writer.left(line, Weight::SemiBold, scale.caption(), palette.text, left, baseline);
                baseline += NAME_LINE * unit;
            }
            baseline -= NAME_LINE * unit;
            if with_sample {
                baseline += SAMPLE_BELOW * unit;
                let run = |scene: &Scene| scene.runs.iter().position(|run| run.name == sheet.rows[row].run);
                if let Some((scene, run)) = sheet.scenes.first().and_then(|scene| Some((scene, run(scene)?))) {
                    writer.sample([left, baseline], scene.runs[run].line(palette));
                }
            }
            baseline += NOTE_BELOW * unit;
            for line in note.iter().take(notes) {
                writer.left(line, Weight::Regular, NOTE * unit, palette.second_text, left, baseline);
                baseline += NOTE_LINE * unit;
            }
        }
    }
}

/// What stands below the body of a tile.
pub(super) struct Below {
    /// The tally, as if the tile's lower left corner were the picture's left upper one.
    tally: Vec<Mark>,
    tally_width: f64,
    /// How many elements have turned over; empty if that cannot be said.
    count: String,
    is_alarm: bool,
    /// A diagnostic; empty for none.
    said: String,
    /// When the run has blown up (s).
    diverged: Option<f64>,
}

impl Below {
    /// What is said of a run, with a diagnostic if one is asked for.
    pub(super) fn new(
        writer: &Writer<'_>,
        plan: &Plan,
        composer: &Composer<'_>,
        run: &RunFrame,
        number: Option<Diagnostic>,
    ) -> Self {
        let over = &run.snapshot.turned_over;
        let diverged = match run.snapshot.status {
            Status::Diverged(divergence) => Some(divergence.time),
            Status::Ok => None,
        };
        let (mut tally, mut tally_width) = (Vec::new(), 0.0);
        if !over.is_empty() {
            let scale = writer.scale.with_unit(TALLY * writer.scale.unit);
            let room = TALLY_SHARE * plan.words_width(writer.scale);
            tally_width = composer.tally.draw(over, writer.palette, scale, room, [0.0; 2], &mut tally);
        }
        let count = run.snapshot.diagnostics.turned_over;
        Self {
            tally,
            tally_width,
            count: if over.is_empty() { String::new() } else { count.to_string() },
            is_alarm: count > 0,
            said: number.and_then(|diagnostic| said(diagnostic, composer.scene, run)).unwrap_or_default(),
            diverged,
        }
    }

    /// Width of tally and count (px).
    fn counted(&self, writer: &Writer<'_>) -> f64 {
        let gap = if self.count.is_empty() { 0.0 } else { COUNT_GAP * writer.scale.type_unit() };
        self.tally_width + gap + writer.fonts.width(&self.count, Weight::SemiBold, writer.scale.caption())
    }

    /// Whether there is room for the diagnostic, too.
    pub(super) fn has_room(&self, writer: &Writer<'_>, plan: &Plan) -> bool {
        let size = NOTE * writer.scale.type_unit();
        let said = NUMBER_GAP * writer.scale.type_unit() + writer.fonts.width(&self.said, Weight::Regular, size);
        self.said.is_empty() || Scale::legible(size) && self.counted(writer) + said <= plan.words_width(writer.scale)
    }

    /// Writes tally, count and, if there is room in all tiles, the diagnostic; or that the run has blown up.
    pub(super) fn write(self, writer: &mut Writer<'_>, plan: &Plan, [row, column]: [usize; 2], with_number: bool) {
        let (scale, palette, fonts) = (writer.scale, writer.palette, writer.fonts);
        let size = scale.caption();
        if !plan.has_tally || !Scale::legible(size) {
            return;
        }
        let [left, top, width, height] = plan.tile(row, column).map(f64::from);
        let (middle, bottom) = (left + 0.5 * width, top + height - TALLY_RAISED * scale.unit);
        let baseline = bottom - 0.5 * TALLY * tally::HEIGHT * scale.type_unit() + X_MIDDLE * size;
        if let Some(time) = self.diverged {
            let wordings = [format!("diverged at {}", number::time(time)), "diverged".to_owned()];
            let wide = |text: &str| fonts.width(text, Weight::SemiBold, size);
            let Some(text) = wordings.iter().find(|text| wide(text) <= plan.words_width(scale)) else { return };
            return writer.left(text, Weight::SemiBold, size, palette.text, middle - 0.5 * wide(text), baseline);
        }
        let small = NOTE * scale.type_unit();
        let said = if with_number { &self.said[..] } else { "" };
        let gap = if said.is_empty() { 0.0 } else { NUMBER_GAP * scale.type_unit() };
        let counted = self.counted(writer);
        let left = (middle - 0.5 * (counted + gap + fonts.width(said, Weight::Regular, small))).round();
        writer.marks.extend(self.tally.into_iter().map(|mut mark| {
            mark.rectangle[0] += narrow(left);
            mark.rectangle[1] += narrow(bottom.round());
            mark
        }));
        let colour = if self.is_alarm { palette.alarm_text } else { palette.second_text };
        let count_left = left + counted - fonts.width(&self.count, Weight::SemiBold, size);
        writer.left(&self.count, Weight::SemiBold, size, colour, count_left, baseline);
        writer.left(said, Weight::Regular, small, palette.second_text, left + counted + gap, baseline);
    }
}

/// A diagnostic with its name; `None` if it has no value.
fn said(diagnostic: Diagnostic, scene: &Scene, run: &RunFrame) -> Option<String> {
    let value = diagnostic.of(&run.snapshot.diagnostics);
    let name = course::name(diagnostic, scene);
    let name = name.strip_suffix(" ratio").unwrap_or(name);
    let value = match diagnostic {
        _ if !value.is_finite() => return None,
        Diagnostic::TurnedOver => return None,
        Diagnostic::VolumeRatio => number::ratio(value),
        Diagnostic::ShapeError => number::length(value, scene.body.extent()),
        _ => {
            let unit = diagnostic.unit();
            let value = crate::sim::words::rounded(value, 3);
            let plain = value == 0.0 || (1e-3..1e5).contains(&value.abs());
            number::with_minus(if plain { format!("{value} {unit}") } else { format!("{value:e} {unit}") })
        }
    };
    Some(format!("{name} {value}"))
}
