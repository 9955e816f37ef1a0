//! The layout of a picture: panels and text. It does not depend on the frame, so nothing jumps.
//!
//! ```text
//! title
//! ┌ panel ──────────┬ panel ──────────┐
//! │ name            │ name      clock │
//! │      body       │      body       │
//! │ count    number │ count    number │
//! │ strip           │ strip           │
//! └─────────────────┴─────────────────┘
//! keys of colours and arrows
//! caption
//! ```

use crate::look::{Labels, View, print};

/// Type smaller than this cannot be read and is left out (px).
const SMALLEST_TYPE: f64 = 5.0;

/// Free around and inside each panel unless the scene says otherwise (px in the reference picture).
const MARGIN: f64 = 40.0;
/// The narrowest margin, at type of the usual size: words keep off the picture's sides, and off those of the next panel
/// (px in the reference picture).
const LEAST_MARGIN: f64 = 10.0;
/// Above a strip the margin is so many times as wide: there is text of the same size on both sides.
const ABOVE_STRIP: f64 = 2.0;
/// This part of what narrow margins lack is added between rows, or the lowest text of panels would touch what is below.
const MADE_UP: f64 = 0.25;
/// Height of the ground of the title, and of a strip with the room around it (px in the reference picture).
const TITLE: f64 = 48.0;
const STRIP: f64 = 128.0;
/// Free below a strip with usual margins (px in the reference picture).
const BELOW_STRIP: f64 = 22.0;
/// Distance of the caption's lines, free above the first baseline and, with usual margins, below the last (px in the
/// reference picture).
pub(super) const CAPTION_LINE: f64 = 22.0;
const ABOVE_CAPTION: f64 = 8.0;
const BELOW_CAPTION: f64 = 30.0;
/// Strips are no smaller than this part of the reference, so that their numbers stay legible.
pub(super) const LEAST_STRIP_UNIT: f64 = 0.5;
/// The text above and below a body takes at most this part of its panel.
const MOST_WORDS: f64 = 0.62;
/// What a strip needs besides its chart (px in the reference picture), and the lowest chart (px).
const LEAST_STRIP: f64 = 46.0;
pub(super) const LEAST_CHART: f64 = 14.0;
/// A strip takes at most this part of its panel; the second part from so many runs on, whose curves it names.
const STRIP_SHARE: f64 = 0.34;
const STRIP_SHARE_OF_MANY: f64 = 0.42;
const MANY: usize = 5;
/// With more other runs than this, strips leave their curves out: they could not be told apart.
pub(super) const MOST_OTHERS: usize = 15;
/// From one name at the end of a curve to the next, and the height of the room for these names in strips of the usual
/// height (px in the reference picture).
pub(super) const CURVE_NAME: f64 = 15.0;
const CURVE_NAMES: f64 = 86.0;

/// Room above and below the body in a panel with and without words there (px in the reference picture).
const WORDS_ABOVE: f64 = 95.0;
const NAME_ABOVE: f64 = 70.0;
const WORDS_BELOW: f64 = 85.0;
const NO_WORDS: f64 = 28.0;

/// A rectangle: left, top, width, height (px).
pub(crate) type Rectangle = [u32; 4];

/// Where a run is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PanelRoom {
    /// The part for its body and its text.
    pub(super) viewport: Rectangle,
    /// The part for its strip, below that.
    pub(super) strip: Option<Rectangle>,
}

/// The places of everything in a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Sizes of type and lines in panels.
    pub(super) scale: Scale,
    /// Sizes of type and lines around panels.
    pub(super) around: Scale,
    /// One for each run shown, row by row.
    pub(super) panels: Vec<PanelRoom>,
    /// The part of the picture that the panels cover.
    pub(super) ground: Rectangle,
    /// Whether there is room for the title, and for the keys of colours and arrows.
    pub(super) has_title: bool,
    pub(super) has_legend: bool,
    /// For how many lines of the caption there is room.
    pub(super) caption_lines: usize,
    /// Where the keys of colours and arrows begin (px from the top).
    pub(super) legend: u32,
    /// Height of the caption's first baseline (px from the top).
    pub(super) caption: f64,
}

impl Layout {
    /// The layout of a view of a number of runs in columns, with room for a key of a height (px) and for lines of a caption.
    pub(super) fn new(view: &View, runs: usize, columns: usize, legend: u32, caption_lines: usize) -> Self {
        let size = view.size.map(|length| length.max(1));
        let around = Self::around(view, runs, columns);
        let rows = |length: f64| (length * around.unit).round() as u32;
        let title =
            if view.title.is_empty() || !Scale::legible(around.title()) { 0 } else { rows(around.of_type(TITLE)) };
        let caption_height = |lines: usize| match lines {
            0 => 0,
            lines => rows(
                around.of_type((lines - 1) as f64 * CAPTION_LINE + around.above_caption())
                    + around.like_margin(BELOW_CAPTION),
            ),
        };
        // Panels keep at least half of the picture: of the rest, first the title gets room, then the keys, then the caption.
        let most = size[1] / 2;
        let title = if title <= most { title } else { 0 };
        let legend = if title + legend <= most { legend } else { 0 };
        let fits = |lines: &usize| title + legend + caption_height(*lines) <= most;
        let caption_lines = (0..=caption_lines).rev().find(fits).unwrap_or(0);
        let caption = caption_height(caption_lines);
        let height = size[1] - title - legend - caption;
        let panels = panels([size[0], height], runs, columns);
        let scale = panels.first().map_or(around, |&panel| Scale::new(size, panel).with(view));
        let lowest = panels.iter().map(|panel| f64::from(panel[3])).fold(f64::INFINITY, f64::min);
        // The names at the ends of curves have room above each other.
        let names = if runs <= MOST_OTHERS + 1 { runs as f64 * CURVE_NAME } else { 0.0 };
        let strip_units = STRIP + (names - CURVE_NAMES).max(0.0);
        let share = if runs < MANY { STRIP_SHARE } else { STRIP_SHARE_OF_MANY };
        let strip_height = |height: f64| match view.strip {
            Some(_) => {
                let usual = strip_units * scale.of_type(scale.unit.max(LEAST_STRIP_UNIT));
                let more = (scale.like_margin(BELOW_STRIP) - BELOW_STRIP) * scale.unit;
                (usual + more).min(share * height).round()
            }
            None => 0.0,
        };
        // A strip too low to be read leaves its room to the body.
        let strip_unit = scale.of_type(scale.unit.max(LEAST_STRIP_UNIT));
        let below = scale.like_margin(BELOW_STRIP) * scale.unit;
        let has_strips = view.strip.is_some() && strip_height(lowest) - below > LEAST_STRIP * strip_unit + LEAST_CHART;
        let strip_height = |height: f64| if has_strips { strip_height(height) } else { 0.0 };
        // However large type and margins are, bodies have some of their panel for themselves.
        let room = MOST_WORDS * (lowest - strip_height(lowest)) / rooms(view).iter().sum::<f64>();
        let scale = Scale { unit: scale.unit.min(room), ..scale };
        let strip = |panel: Rectangle| {
            let [width, height] = [panel[2], panel[3]].map(f64::from);
            let room = strip_height(height);
            let (side, below) =
                (scale.margin().min(width / 2.0), (scale.like_margin(BELOW_STRIP) * scale.unit).min(room));
            let top = f64::from(title + panel[1]) + height - room;
            [f64::from(panel[0]) + side, top, width - 2.0 * side, room - below].map(|length| length.round() as u32)
        };
        let place = |mut panel: Rectangle| {
            let strip = has_strips.then(|| strip(panel));
            panel[1] += title;
            if let Some([_, top, ..]) = strip {
                panel[3] = top - panel[1];
            }
            PanelRoom { viewport: panel, strip }
        };
        Self {
            scale,
            around,
            panels: panels.into_iter().map(place).collect(),
            ground: [0, title, size[0], height],
            has_title: title > 0,
            has_legend: legend > 0,
            caption_lines,
            legend: title + height,
            caption: f64::from(title + height + legend) + around.above_caption() * around.type_unit(),
        }
    }

    /// Sizes of type and lines around the panels of a view of a number of runs in columns.
    pub(super) fn around(view: &View, runs: usize, columns: usize) -> Scale {
        let size = view.size.map(|length| length.max(1));
        panels(size, runs, columns).first().map_or(Scale::REFERENCE, |&panel| Scale::new(size, panel)).with(view)
    }
}

/// The room above and below the body in a panel that words need (px in the reference picture).
pub(super) fn rooms(view: &View) -> [f64; 2] {
    let Labels { letter, name, model, clock, count, number } = view.labels;
    let above = match (letter || name, model || clock) {
        (_, true) => WORDS_ABOVE,
        (true, false) => NAME_ABOVE,
        (false, false) => NO_WORDS,
    };
    let below = if count || number || view.scale_bar { WORDS_BELOW } else { NO_WORDS };
    // Inside the margin, rows are as high as their type.
    let room = |room: f64, margin: f64| {
        (room.min(MARGIN) + margin - MARGIN).max(0.0) + (room - MARGIN).max(0.0) * view.look.text_scale
    };
    let [margin, lower] = margins(view);
    [room(above, margin), room(below, lower)]
}

/// Free around and inside each panel, and below its lowest words (px in the reference picture).
fn margins(view: &View) -> [f64; 2] {
    let least = LEAST_MARGIN * view.look.text_scale;
    let margin = (MARGIN * view.look.margin).max(least);
    // To a strip the words keep a distance of their own.
    let lower = if view.strip.is_some() { margin.clamp((ABOVE_STRIP * least).min(MARGIN), MARGIN) } else { margin };
    [margin, lower]
}

/// How much wider and higher panels seem to a camera whose margins are narrower than usual (px in the reference
/// picture).
pub(super) fn gained(view: &View) -> [f64; 2] {
    let [margin, lower] = margins(view);
    [2.0 * (MARGIN - margin), (MARGIN - margin) + (MARGIN - lower)]
}

/// Divides a picture into panels, row by row; together they cover it without gaps. No panel is without a pixel as
/// long as the picture has enough of them.
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
    /// Pixels for one pixel of the reference picture.
    pub(super) unit: f64,
    /// How many times larger than usual type is, with its rows.
    type_factor: f64,
    /// How many times thicker than usual lines are.
    pub(super) line_factor: f64,
    /// Free around and inside each panel, and below its lowest words (px in the reference picture).
    margin: f64,
    lower_margin: f64,
}

impl Scale {
    /// That of the reference picture.
    pub(super) const REFERENCE: Self =
        Self { unit: 1.0, type_factor: 1.0, line_factor: 1.0, margin: MARGIN, lower_margin: MARGIN };

    pub(super) fn new(size: [u32; 2], panel: Rectangle) -> Self {
        Self { unit: print::unit(size, [panel[2], panel[3]]), ..Self::REFERENCE }
    }

    /// That of a picture of a number of pixels for each of the reference picture.
    pub(super) fn at(unit: f64) -> Self {
        Self { unit, ..Self::REFERENCE }
    }

    /// The same for things of another size.
    pub(super) fn with_unit(self, unit: f64) -> Self {
        Self { unit, ..self }
    }

    /// The same with type, lines and margins as a scene asks for.
    pub(super) fn with(self, view: &View) -> Self {
        let ([margin, lower_margin], look) = (margins(view), &view.look);
        Self { type_factor: look.text_scale, line_factor: look.line_scale, margin, lower_margin, ..self }
    }

    /// Pixels for one pixel of type in the reference picture, and of what stands in its rows.
    pub(super) fn type_unit(self) -> f64 {
        self.of_type(self.unit)
    }

    /// A length as much longer as type is larger.
    pub(super) fn of_type(self, length: f64) -> f64 {
        length * self.type_factor
    }

    /// A height of type within margins, given in the reference picture with its margins (px): inside the margin, rows are
    /// as high as their type.
    pub(super) fn row(self, height: f64) -> f64 {
        (self.margin + (height - MARGIN) * self.type_factor) * self.unit
    }

    /// Names, clock and count (px).
    pub(super) fn title(self) -> f64 {
        26.0 * self.type_unit()
    }

    /// Everything else (px).
    pub(super) fn caption(self) -> f64 {
        16.0 * self.type_unit()
    }

    /// Free space around and inside each panel (px).
    pub(super) fn margin(self) -> f64 {
        self.margin * self.unit
    }

    /// Free below the lowest words of each panel (px).
    pub(super) fn lower_margin(self) -> f64 {
        self.lower_margin * self.unit
    }

    /// A free length as much longer as margins are wider.
    fn like_margin(self, length: f64) -> f64 {
        length * (self.margin / MARGIN)
    }

    /// How much wider than usual margins are, if they are (px in the reference picture).
    pub(super) fn widened(self) -> f64 {
        (self.margin - MARGIN).max(0.0)
    }

    /// What is added between rows where margins are narrower than usual (px in the reference picture).
    pub(super) fn made_up(self) -> f64 {
        MADE_UP * (MARGIN - self.margin).max(0.0)
    }

    /// How much more than usual is free below the key of colours and arrows (px in the reference picture), which has less
    /// room there than a margin.
    pub(super) fn below_legend(self) -> f64 {
        0.5 * (self.margin - MARGIN)
    }

    /// Free above the caption's first baseline (px in the reference picture).
    fn above_caption(self) -> f64 {
        ABOVE_CAPTION + self.made_up()
    }

    /// Between things beside each other (px).
    pub(super) fn gap(self) -> f64 {
        16.0 * self.unit
    }

    /// Whether type of `size` (px) can be read.
    pub(super) fn legible(size: f64) -> bool {
        size >= SMALLEST_TYPE
    }

    /// How thick lines are, in parts of their thickness in the reference picture. Thinner ones than at a third of
    /// that size would only be fainter.
    pub(super) fn line(self) -> f64 {
        self.unit.max(0.35) * self.line_factor
    }
}

/// The lowest baseline of a panel lies so far within its margin (px in the reference picture).
const BELOW_BASELINE: f64 = 2.0;

/// The lines of text in a panel (px from its top).
pub(super) struct Baselines {
    pub(super) title: f64,
    pub(super) second: f64,
    pub(super) count: f64,
    pub(super) caption: f64,
}

impl Baselines {
    pub(super) fn new(scale: Scale, panel: Rectangle) -> Self {
        let height = f64::from(panel[3]);
        Self {
            title: scale.row(60.0),
            second: scale.row(86.0),
            count: height - (scale.lower_margin - BELOW_BASELINE + 20.0 * scale.type_factor) * scale.unit,
            caption: height - (scale.lower_margin - BELOW_BASELINE) * scale.unit,
        }
    }
}

/// The part of a panel between its lines of text, which need rooms above and below, inside its margins.
pub(super) fn clear_of_words(panel: Rectangle, scale: Scale, [above, below]: [f64; 2]) -> Rectangle {
    let [left, top, width, height] = panel;
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
            // Each begins where the one before it ends, and the last ones end at the picture's edges.
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
        let rooms = [WORDS_ABOVE, WORDS_BELOW];
        assert_eq!(clear_of_words([640, 0, 640, 720], Scale::REFERENCE, rooms), [680, 102, 560, 518]);
        for panel in [[0, 0, 1, 1], [5, 7, 30, 12], [0, 0, 3000, 40]] {
            let [x, y, width, height] = clear_of_words(panel, Scale::new([64, 64], panel), rooms);
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
                strip: Some(crate::sim::snapshot::Diagnostic::TurnedOver),
                ..View::default()
            };
            let layout = Layout::new(&view, runs, 2, 40 * size[1] / 720, 2);
            let [_, top, width, height] = layout.ground;
            assert!(width == size[0] && height >= size[1] / 2 && layout.legend == top + height);
            assert!(layout.caption >= f64::from(layout.legend));
            for PanelRoom { viewport, strip } in &layout.panels {
                // Where a strip could not be read, its room is the body's.
                let Some(strip) = strip else {
                    assert!(size[1] <= 200 && viewport[1] + viewport[3] <= top + height);
                    continue;
                };
                assert!(viewport[1] >= top && viewport[1] + viewport[3] <= strip[1]);
                assert!(strip[1] + strip[3] <= top + height, "{strip:?} in {:?}", layout.ground);
                assert!(strip[0] >= viewport[0] && strip[0] + strip[2] <= viewport[0] + viewport[2]);
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
    fn type_and_lines_grow_by_themselves() {
        let look = Style { text_scale: 2.0, line_scale: 3.0, ..Style::of(Theme::Light) };
        let view = View { look, ..View::default() };
        let (usual, large) = (Scale::REFERENCE, Scale::REFERENCE.with(&view));
        assert_eq!((large.title(), large.caption()), (2.0 * usual.title(), 2.0 * usual.caption()));
        assert_eq!((large.line(), large.margin()), (3.0 * usual.line(), usual.margin()));
        // Each row has room for its type.
        let panel = [0, 0, 640, 720];
        let rows = Baselines::new(large, panel);
        assert!(rows.second - rows.title > large.caption() && rows.caption - rows.count >= large.caption());
        let [_, top, _, height] = clear_of_words(panel, large, rooms(&view));
        assert!(f64::from(top) > rows.second && f64::from(top + height) < rows.count - large.title());
    }
}
