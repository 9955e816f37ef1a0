//! The layout of a picture: panels and text. It does not depend on the frame, so nothing jumps. This long file keeps
//! all distances of the layout together, with their tests.
//!
//! ```text
//! title
//! (clock, where names leave it no room)
//! ┌ panel ──────────┬ panel ──────────┐
//! │ name            │ name      clock │
//! │ events          │ events          │
//! │      body       │      body       │
//! │ count    number │ count    number │
//! └─────────────────┴─────────────────┘
//! chart of all runs
//! keys of colours and arrows
//! caption
//! ```

use crate::look::{Labels, View, print};

/// The smallest type of a picture (px in the reference picture): panels that are too small for it have fewer words.
const LEAST_TYPE: f64 = 14.0;
/// Smaller type cannot be read in any picture and is left out (px).
const SMALLEST_TYPE: f64 = 5.0;

/// The margin around and inside each panel (px in the reference picture).
const MARGIN: f64 = 40.0;
/// Height of the ground of the title, and of the chart with the room around it (px in the reference picture).
const TITLE: f64 = 48.0;
/// The baseline of the title, and the distance of its lines; the height of a row for the clock alone, and its baseline,
/// which reaches into the margin of the panels below (px in the reference picture).
const TITLE_BASELINE: f64 = 62.0;
const TITLE_LINE: f64 = 38.0;
const CLOCK_ROW: f64 = 40.0;
const CLOCK_BASELINE: f64 = 50.0;
const CHART: f64 = 140.0;
/// The gap below the chart (px in the reference picture).
const BELOW_CHART: f64 = 18.0;
/// Distance of the caption's lines, and the gaps above the first baseline and below the last one (px in the reference
/// picture).
pub(super) const CAPTION_LINE: f64 = 22.0;
const ABOVE_CAPTION: f64 = 8.0;
const BELOW_CAPTION: f64 = 30.0;
/// The largest shares of a panel for the text above and below a body: with second lines, without, and with margins.
const MOST_WORDS: [f64; 3] = [0.34, 0.45, 0.8];
/// The room of a chart besides its curves (px in the reference picture), and the lowest chart (px).
const LEAST_CHART_ROOM: f64 = 54.0;
pub(super) const LEAST_CHART: f64 = 14.0;
/// The largest share of the height of panels and chart for the chart.
const CHART_SHARE: f64 = 0.34;
/// The distance of names at the ends of curves, the height of their room in a chart of the usual height (px in the
/// reference picture), and the most names that make a chart higher.
pub(super) const CURVE_NAME: f64 = 15.0;
const CURVE_NAMES: f64 = 94.0;
const MOST_NAMES: usize = 8;

/// The gaps above and below the body in a panel without words there (px in the reference picture).
const NO_WORDS: f64 = 28.0;
/// Distances of lines of words in a panel: from its margin to the name, on to the second line and to the events; from
/// the lowest words up to the count; and from words to the body (px in the reference picture).
const ROWS: [f64; 3] = [20.0, 26.0, 24.0];
const COUNT_ABOVE: f64 = 20.0;
const CLEAR: [f64; 3] = [10.0, 9.0, 27.0];
/// The least distance of lines, in sizes of their type.
const LINE: f64 = 1.25;
const ASCENT: f64 = 0.77;
/// The gap below the baseline of a clock and of a title, in sizes of names.
const DESCENT: [f64; 2] = [0.4, 0.9];

/// A rectangle: left, top, width, height (px).
pub(crate) type Rectangle = [u32; 4];

/// The places of all parts of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Sizes of type and lines in panels.
    pub(super) scale: Scale,
    /// Sizes of type and lines around panels.
    pub(super) around: Scale,
    /// A rectangle for each run shown, row by row.
    pub(super) panels: Vec<Rectangle>,
    /// The room of the chart below the panels.
    pub(super) chart: Option<Rectangle>,
    /// The part of the picture that the panels cover.
    pub(super) ground: Rectangle,
    /// The number of lines of the title that fit.
    pub(super) title_lines: usize,
    /// Height of the clock's baseline (px from the top), if it has a row of its own.
    pub(super) clock: Option<f64>,
    /// Whether there is room for the keys of colours and arrows.
    pub(super) has_legend: bool,
    /// The number of lines of the caption that fit.
    pub(super) caption_lines: usize,
    /// The top of the keys of colours and arrows (px from the top).
    pub(super) legend: u32,
    /// Height of the caption's first baseline (px from the top).
    pub(super) caption: f64,
}

impl Layout {
    /// The layout of a view with a number of panels in columns and with the `wanted` parts around them.
    pub(super) fn new(view: &View, panels: usize, columns: usize, wanted: Wanted) -> Self {
        // The width of panels' margins follows from their size.
        let margin = Self::with_margin(view, panels, columns, wanted, f64::INFINITY).scale.margin();
        Self::with_margin(view, panels, columns, wanted, margin)
    }

    /// The layout for panels with margins of a width (px), if these are too narrow for the text that reaches into them.
    fn with_margin(view: &View, count: usize, columns: usize, around_them: Wanted, margin: f64) -> Self {
        let Wanted { title_lines, clock, legend, caption_lines } = around_them;
        let size = view.size.map(|length| length.max(1));
        let around = Self::around(view);
        let rows = |length: f64| (length * around.unit).round() as u32;
        let title_height = |lines: usize| match lines {
            0 => 0,
            lines => rows(around.of_type(TITLE + (lines - 1) as f64 * TITLE_LINE)),
        };
        // Panels keep at least half of the picture. The rest goes to the title, then the clock, the keys and the
        // caption.
        let most = size[1] / 2;
        let clock_row = Some(rows(around.of_type(CLOCK_ROW))).filter(|&row| clock && row <= most);
        let left = most - clock_row.unwrap_or(0);
        let title_lines = (0..=title_lines).rev().find(|&lines| title_height(lines) <= left).unwrap_or(0);
        let title = title_height(title_lines);
        let title_end = if title_lines > 0 { title_baseline(around, title_lines) } else { 0.0 };
        let in_row = f64::from(title) + around.of_type(CLOCK_BASELINE * around.unit);
        let clock = clock_row.map(|_| in_row.max(title_end + LINE * around.title()));
        let top = title + clock_row.unwrap_or(0);
        // The row reaches into the margin of the panels, unless that is too narrow.
        let free = DESCENT[usize::from(clock.is_none())] * around.title();
        let reach = clock.unwrap_or(title_end) + free - f64::from(top);
        let spared = (reach - margin).max(0.0).ceil() as u32;
        let title = (top + spared).min(most.max(top));
        let legend = if title + legend <= most { legend } else { 0 };
        // The caption reaches into the margin above it, too, by less than half of it.
        let reach = ASCENT * around.caption() - ABOVE_CAPTION * around.type_unit();
        let spared = if legend > 0 { 0 } else { (reach - 0.5 * margin).max(0.0).ceil() as u32 };
        let caption_height = |lines: usize| match lines {
            0 => 0,
            lines => rows(around.of_type((lines - 1) as f64 * CAPTION_LINE + ABOVE_CAPTION) + BELOW_CAPTION) + spared,
        };
        let fits = |lines: &usize| title + legend + caption_height(*lines) <= most;
        let caption_lines = (0..=caption_lines).rev().find(fits).unwrap_or(0);
        let caption = caption_height(caption_lines);
        let height = size[1] - title - legend - caption;
        let chart = view.strip.map_or(0.0, |_| {
            // The names at the ends of curves need room above each other.
            let names = count.min(MOST_NAMES) as f64 * CURVE_NAME;
            let units = CHART + (names - CURVE_NAMES).max(0.0) - BELOW_CHART;
            let usual = units * around.type_unit() + BELOW_CHART * around.unit;
            usual.min(CHART_SHARE * f64::from(height)).round()
        });
        // A chart that is too low to be read leaves its room to the bodies.
        let below = (BELOW_CHART * around.unit).min(chart);
        let has_room = chart - below > LEAST_CHART_ROOM * around.type_unit() + LEAST_CHART;
        let has_chart = has_room && Scale::legible(LEAST_TYPE * around.type_unit());
        let chart = if has_chart { chart as u32 } else { 0 };
        let mut panels = panels([size[0], height - chart], count, columns);
        panels.iter_mut().for_each(|panel| panel[1] += title);
        // With a chart, the rows of panels have the height that they have without it.
        let rows = count.div_ceil(columns.clamp(1, count.max(1))).max(1) as u32;
        let with_chart = |panel: Rectangle| [panel[0], panel[1], panel[2], panel[3] + chart / rows];
        let scale = panels.first().map_or(around, |&panel| Scale::new(size, with_chart(panel)).within(view));
        let side = scale.margin().min(f64::from(size[0]) / 2.0);
        let of_chart =
            [side, f64::from(title + height - chart), f64::from(size[0]) - 2.0 * side, f64::from(chart) - below];
        Self {
            scale,
            around,
            panels,
            chart: has_chart.then(|| of_chart.map(|length| length.round() as u32)),
            ground: [0, title, size[0], height],
            title_lines,
            clock,
            has_legend: legend > 0,
            caption_lines,
            legend: title + height,
            caption: f64::from(title + height + legend + spared) + ABOVE_CAPTION * around.type_unit(),
        }
    }

    /// Sizes of type and lines around the panels of a view; they do not depend on the panels.
    pub(super) fn around(view: &View) -> Scale {
        Scale { unit: whole(view), ..Scale::REFERENCE }.within(view)
    }
}

/// The requested parts around panels: lines of the title, a row for the clock, a key of a height (px), and lines of the
/// caption.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    pub(super) title_lines: usize,
    pub(super) clock: bool,
    pub(super) legend: u32,
    pub(super) caption_lines: usize,
}

/// The last baseline of a title of a number of lines (px).
pub(super) fn title_baseline(around: Scale, lines: usize) -> f64 {
    around.row(TITLE_BASELINE) + lines.saturating_sub(1) as f64 * TITLE_LINE * around.type_unit()
}

/// Pixels of the picture of a view per pixel of the reference picture.
fn whole(view: &View) -> f64 {
    let [width, height] = view.size.map(|length| f64::from(length.max(1)));
    // Panels that arrange themselves stand side by side in a wide picture.
    let columns = view.columns.unwrap_or(if width < height { 1 } else { 2 }).clamp(1, 2) as u32;
    print::unit(view.size, [(width / f64::from(columns)) as u32, u32::MAX])
}

/// The text in a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Written {
    pub(super) labels: Labels,
    /// Whether there is a second line, with the model and the start of the clock.
    pub(super) second: bool,
    /// Whether there is a line for events.
    pub(super) events: bool,
}

/// The text in a panel of a height (px), with `unit` pixels per pixel of the reference picture. If not all of it fits
/// beside the body, first the events are left out, then second lines, then the text below.
pub(super) fn written(view: &View, height: f64, unit: f64) -> Written {
    let scale = Scale { unit, ..Scale::REFERENCE }.within(view);
    let Labels { letters, name, model, clock, .. } = view.labels;
    let events = view.strip.is_some();
    let all = Written { labels: view.labels, second: model || clock, events };
    let plain = Written { events: false, ..all };
    let labels = Labels { model: false, ..view.labels };
    let names = Labels { letters, name, clock, ..Labels::NONE };
    let none = Written { labels: Labels::NONE, second: false, events: false };
    let choices = [all, plain, Written { labels, second: false, ..plain }, Written { labels: names, ..none }];
    let margins = 2.0 * MARGIN * unit;
    let fits = |written: &Written| {
        let taken: f64 = rooms_of(*written, scale).iter().sum();
        let words = if written.second { MOST_WORDS[0] } else { MOST_WORDS[1] };
        taken - margins <= words * height && taken <= MOST_WORDS[2] * height
    };
    choices.into_iter().find(fits).unwrap_or(none)
}

/// The heights for words above and below the body in a panel of a height (px), with `unit` pixels per pixel of the
/// reference picture (px in the reference picture).
pub(super) fn rooms(view: &View, height: f64, unit: f64) -> [f64; 2] {
    rooms_of(written(view, height, unit), Scale { unit, ..Scale::REFERENCE }.within(view)).map(|room| room / unit)
}

/// The heights for chosen words (px).
fn rooms_of(Written { labels, second, events }: Written, scale: Scale) -> [f64; 2] {
    let Labels { letters, name, clock, count, number, scale_bar, .. } = labels;
    let unit = scale.type_unit();
    let rows = Baselines::new(scale, [0; 4]);
    let nothing = NO_WORDS * scale.unit;
    let above = match (letters || name || clock, second) {
        _ if events => rows.events + CLEAR[1] * unit,
        (_, true) => rows.second + CLEAR[1] * unit,
        (true, false) => rows.title + CLEAR[0] * unit,
        (false, false) => nothing,
    };
    let has_below = count || number || scale_bar;
    let below = if has_below { CLEAR[2] * unit - rows.count } else { nothing };
    [above, below]
}

/// Divides a picture into panels, row by row, which cover it without gaps. Every panel has a pixel if the picture has
/// enough of them.
pub(super) fn panels(size: [u32; 2], count: usize, columns: usize) -> Vec<Rectangle> {
    let columns = columns.clamp(1, count.max(1));
    let rows = count.div_ceil(columns);
    let cut = |length: u32, parts: usize, at: usize| (u64::from(length) * at as u64 / parts.max(1) as u64) as u32;
    (0..count)
        .map(|at| {
            let (column, row) = (at % columns, at / columns);
            let [left, right] = [column, column + 1].map(|at| cut(size[0], columns, at));
            let [top, bottom] = [row, row + 1].map(|at| cut(size[1], rows, at));
            [left, top, right - left, bottom - top]
        })
        .collect()
}

/// Sizes of type and lines of one picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// Pixels per pixel of the reference picture.
    pub(super) unit: f64,
    /// The size of type, with its rows, relative to the usual one.
    type_factor: f64,
    /// The smallest type (px).
    least: f64,
}

impl Scale {
    /// The sizes of the reference picture.
    pub(super) const REFERENCE: Self = Self { unit: 1.0, type_factor: 1.0, least: 0.0 };

    pub(super) fn new(size: [u32; 2], panel: Rectangle) -> Self {
        Self { unit: print::unit(size, [panel[2], panel[3]]), ..Self::REFERENCE }
    }

    /// The sizes of a picture with a number of pixels per pixel of the reference picture.
    pub(super) fn at(unit: f64) -> Self {
        Self { unit, ..Self::REFERENCE }
    }

    /// The sizes with another unit.
    pub(super) fn with_unit(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// The sizes with the type of a scene.
    pub(super) fn with(self, view: &View) -> Self {
        Self { type_factor: view.look.text_scale, ..self }
    }

    /// The sizes for a part of the picture of a scene, whose type is not smaller than the picture's smallest type.
    fn within(self, view: &View) -> Self {
        Self { least: LEAST_TYPE * whole(view) * view.look.text_scale.min(1.0), ..self.with(view) }
    }

    /// Pixels per pixel of the reference picture, for type and for objects in its rows.
    pub(super) fn type_unit(self) -> f64 {
        self.of_type(self.unit)
    }

    /// A length, scaled like the type.
    pub(super) fn of_type(self, length: f64) -> f64 {
        length * self.type_factor
    }

    /// A height of type within margins, given in the reference picture with its margins (px). Inside the margin, rows
    /// are scaled like their type.
    pub(super) fn row(self, height: f64) -> f64 {
        (MARGIN + (height - MARGIN) * self.type_factor) * self.unit
    }

    /// Size of names, clock and count (px).
    pub(super) fn title(self) -> f64 {
        (26.0 * self.type_unit()).max(self.least)
    }

    /// Size of all other type (px).
    pub(super) fn caption(self) -> f64 {
        (16.0 * self.type_unit()).max(self.least)
    }

    /// Size of numbers in charts and in rings (px).
    pub(super) fn small(self) -> f64 {
        (14.0 * self.type_unit()).max(self.least)
    }

    /// The margin around and inside each panel (px).
    pub(super) fn margin(self) -> f64 {
        MARGIN * self.unit
    }

    /// The gap between adjacent parts (px).
    pub(super) fn gap(self) -> f64 {
        16.0 * self.unit
    }

    /// Whether type of `size` (px) can be read.
    pub(super) fn legible(size: f64) -> bool {
        size >= SMALLEST_TYPE
    }

    /// The thickness of lines relative to the reference picture. It is at least that at a third of the size, below
    /// which lines would only be fainter.
    pub(super) fn line(self) -> f64 {
        self.unit.max(0.35)
    }
}

/// The height of the lowest baseline of a panel above its margin (px in the reference picture).
const BELOW_BASELINE: f64 = 2.0;

/// The lines of text in a panel (px from its top).
pub(super) struct Baselines {
    pub(super) title: f64,
    pub(super) second: f64,
    pub(super) events: f64,
    pub(super) count: f64,
    pub(super) caption: f64,
}

impl Baselines {
    pub(super) fn new(scale: Scale, panel: Rectangle) -> Self {
        let apart = |length: f64| scale.of_type(length * scale.unit).max(LINE * scale.caption());
        let title = scale.margin() + scale.of_type(ROWS[0] * scale.unit).max(ASCENT * scale.title());
        let below = (MARGIN - BELOW_BASELINE) * scale.unit;
        let caption = f64::from(panel[3]) - below.max(0.5 * scale.caption());
        let count = caption - scale.of_type(COUNT_ABOVE * scale.unit).max(LINE * scale.caption());
        Self { title, second: title + apart(ROWS[1]), events: title + apart(ROWS[1]) + apart(ROWS[2]), count, caption }
    }
}

/// The part of a panel of a view between its lines of text, inside its margins.
pub(super) fn clear_of_words(panel: Rectangle, view: &View, scale: Scale) -> Rectangle {
    let [left, top, width, height] = panel;
    let [above, below] = rooms(view, f64::from(height), scale.unit);
    let inside = |at: f64, length: u32| at.clamp(0.0, f64::from(length)) as u32;
    let side = inside(scale.margin(), width / 2);
    let above = inside((above + 7.0) * scale.unit, height);
    let below = inside(f64::from(height) - (below + 15.0) * scale.unit, height).max(above);
    [left + side, top + above, width - 2 * side, below - above]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::{Style, Theme};

    #[test]
    fn panels_cover_the_picture_without_gaps() {
        for (size, count, columns) in [([1280, 720], 2, 2), ([1281, 719], 6, 3), ([64, 64], 5, 2), ([8192, 100], 1, 4)]
        {
            let panels = panels(size, count, columns);
            assert_eq!(panels.len(), count);
            // Each panel begins at the end of the one before, and the last ones end at the picture's edges.
            let columns = columns.min(count);
            for (at, &[left, top, width, height]) in panels.iter().enumerate() {
                assert!(width > 0 && height > 0);
                let beside = if at % columns == 0 { 0 } else { panels[at - 1][0] + panels[at - 1][2] };
                let above = if at < columns { 0 } else { panels[at - columns][1] + panels[at - columns][3] };
                assert_eq!([left, top], [beside, above]);
                assert!(at % columns != columns - 1 || left + width == size[0]);
                assert!(at / columns < (count - 1) / columns || top + height == size[1]);
            }
        }
        assert_eq!(panels([1280, 720], 2, 2), [[0, 0, 640, 720], [640, 0, 640, 720]]);
    }

    #[test]
    fn the_ground_between_the_words_lies_inside_the_panel() {
        let view = View::default();
        assert_eq!(clear_of_words([640, 0, 640, 720], &view, Scale::REFERENCE), [680, 102, 560, 518]);
        for panel in [[0, 0, 1, 1], [5, 7, 30, 12], [0, 0, 3000, 40]] {
            let [x, y, width, height] = clear_of_words(panel, &view, Scale::new([64, 64], panel));
            assert!(x >= panel[0] && x + width <= panel[0] + panel[2]);
            assert!(y >= panel[1] && y + height <= panel[1] + panel[3]);
        }
    }

    #[test]
    fn nothing_overlaps_and_all_is_used() {
        for (size, runs) in [([1280, 720], 2), ([640, 360], 2), ([1000, 1400], 6), ([300, 200], 1), ([17, 16], 3)] {
            let view = View {
                size,
                title: "Title".to_owned(),
                strip: Some(crate::sim::Diagnostic::TurnedOver),
                ..View::default()
            };
            let wanted = Wanted { title_lines: 1, clock: true, legend: 40 * size[1] / 720, caption_lines: 2 };
            let layout = Layout::new(&view, runs, 2, wanted);
            let [_, top, width, height] = layout.ground;
            assert!(width == size[0] && height >= size[1] / 2 && layout.legend == top + height);
            assert!(layout.caption >= f64::from(layout.legend));
            // A chart that could not be read leaves its room to the bodies.
            assert_eq!(layout.chart.is_some(), size[1] > 200, "{size:?}");
            let bottom = layout.chart.map_or(top + height, |chart| chart[1]);
            for panel in &layout.panels {
                assert!(panel[1] >= top && panel[1] + panel[3] <= bottom, "{panel:?} in {:?}", layout.ground);
            }
            if let Some(chart) = layout.chart {
                assert!(chart[1] + chart[3] <= top + height && chart[0] + chart[2] <= width, "{chart:?}");
            }
        }
    }

    #[test]
    fn type_grows_with_the_picture_and_shrinks_with_panels() {
        let unit = |size: [u32; 2], count, columns| Scale::new(size, panels(size, count, columns)[0]).unit;
        assert_eq!(unit([1280, 720], 2, 2), 1.0);
        assert_eq!(unit([1920, 1080], 2, 2), 1.5);
        assert!(unit([1280, 720], 6, 3) < 0.8);
        assert!(unit([64, 64], 2, 2) < 0.1);
    }

    #[test]
    fn type_grows_alone() {
        let look = Style { text_scale: 2.0, ..Style::of(Theme::Light) };
        let view = View { look, ..View::default() };
        let (usual, large) = (Scale::REFERENCE, Scale::REFERENCE.with(&view));
        assert_eq!((large.title(), large.caption()), (2.0 * usual.title(), 2.0 * usual.caption()));
        assert_eq!((large.line(), large.margin()), (usual.line(), usual.margin()));
        // Each row has room for its type.
        let panel = [0, 0, 640, 720];
        let rows = Baselines::new(large, panel);
        assert!(rows.second - rows.title > large.caption() && rows.caption - rows.count >= large.caption());
        let [_, top, _, height] = clear_of_words(panel, &view, large);
        assert!(f64::from(top) > rows.second && f64::from(top + height) < rows.count - large.title());
    }
}
