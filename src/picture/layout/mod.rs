//! The layout of a picture: a tree of boxes for the page, and one for the words of each panel. It does not depend on
//! the frame, so nothing jumps.
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

pub(super) mod steps;
pub(super) mod tree;

use crate::look::{Labels, View, print};
use steps::{BESIDE, GAP, MARGIN, NAME_ROW, NEAR, ROW, SHORT, SMALL, TALL_ROW};
use tree::{Node, Place, Solved};

/// Smaller type cannot be read in any picture and is left out (px).
const SMALLEST_TYPE: f64 = 5.0;
/// The parts of a picture that panels keep without and with a chart, and the part of a panel that its body keeps.
const PANELS: [f64; 2] = [0.45, 0.36];
const BODY: f64 = 0.46;
/// The height of a chart of a few curves, the least height besides its curves (px in the reference picture), the lowest
/// chart (px), and the largest part of the picture for it.
const CHART: f64 = 122.0;
const LEAST_CHART_ROOM: f64 = 54.0;
const LEAST_CHART: f64 = 14.0;
const CHART_SHARE: f64 = 0.3;
/// The height of a further chart (px in the reference picture).
const FURTHER: f64 = 84.0;
/// The distance of names at the ends of curves, the height of their room in a chart of the usual height (px in the
/// reference picture), and the most names that make a chart higher.
pub(super) const CURVE_NAME: f64 = 15.0;
const CURVE_NAMES: f64 = 94.0;
const MOST_NAMES: usize = 8;
/// The height of the rows of numbers in a panel, with the count above its words (px in the reference picture).
const NUMBERS: [f64; 2] = [28.0, 20.0];
/// The least distance of lines, and the height of letters, in sizes of their type.
const LINE: f64 = 1.25;
pub(super) const ASCENT: f64 = 0.77;

/// A rectangle: left, top, width, height (px).
pub(crate) type Rectangle = [u32; 4];

/// The boxes of a page and of its panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Edge,
    Title,
    Clock,
    Row,
    Panel,
    Chart,
    Legend,
    Caption,
    // In a panel.
    Name,
    Second,
    Events,
    Body,
    Numbers,
}

/// The places of all parts of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Sizes of type and lines in panels.
    pub(super) scale: Scale,
    /// Sizes of type and lines around panels.
    pub(super) around: Scale,
    /// A rectangle for each run shown, row by row.
    pub(super) panels: Vec<Rectangle>,
    /// The words of each panel.
    pub(super) written: Written,
    /// The places of all parts (px).
    pub(super) parts: Solved<Part>,
}

impl Layout {
    /// The layout of a view with a number of panels in columns and with the `wanted` parts around them.
    pub(super) fn new(view: &View, count: usize, columns: usize, wanted: Wanted) -> Self {
        let size = view.size.map(|length| length.max(1));
        let [width, height] = size.map(f64::from);
        let columns = columns.clamp(1, count.max(1));
        let rows = count.div_ceil(columns).max(1);
        let around = Self::around(view);
        let scale = Scale::new(size, [0, 0, size[0] / columns as u32, size[1] / rows as u32]).within(view);
        let [unit, type_unit] = [around.unit, around.type_unit()];
        let line = |part, step: f64, size: f64| Node::new(part, (step * type_unit).max(LINE * size));
        let first = |at: usize, gap: f64| if at == 0 { gap * unit } else { 0.0 };
        // The most important parts have the highest ranks.
        let title = |at| line(Part::Title, MARGIN, around.heading()).after(first(at, MARGIN)).rank(4);
        let caption = |at| {
            let gap = if wanted.legend.is_some() { BESIDE } else { GAP };
            line(Part::Caption, ROW, around.caption()).after(first(at, gap)).rank(1)
        };
        let panels = |row: usize| {
            let key = |column: usize| if row * columns + column < count { Part::Panel } else { Part::Edge };
            (0..columns).map(|column| Node::new(key(column), 0.0).stretched()).collect()
        };
        // The names at the ends of curves need room above each other.
        let names = (count.min(MOST_NAMES) as f64 * CURVE_NAME - CURVE_NAMES).max(0.0);
        let has_chart = !view.charts.is_empty() && Scale::legible(SMALL * type_unit);
        let chart = Node::new(Part::Chart, (CHART + names) * type_unit)
            .least(LEAST_CHART_ROOM * type_unit + LEAST_CHART)
            .after(GAP * unit)
            .share(CHART_SHARE)
            .rank(2);
        // Of several charts, as many are drawn as have room.
        let further = Node::new(Part::Chart, (FURTHER + names) * type_unit).rank(0);
        let least = PANELS[usize::from(has_chart)] * height / rows as f64;
        // Without a title, all panels have the margin of the picture above their words.
        let apart = |row: usize| if row > 0 && !view.title.is_empty() { BESIDE * scale.unit } else { 0.0 };
        let row = |row| Node::new(Part::Row, least).after(apart(row)).stretched().with(panels(row));
        // Below no title, the clock needs a margin.
        let above_clock = if wanted.title > 0 { 0.0 } else { MARGIN * unit };
        let clock = wanted.clock.then(|| line(Part::Clock, NAME_ROW, around.title()).after(above_clock).rank(5));
        let bottom = if has_parts_below(view) { SHORT * unit } else { 0.0 };
        let nodes: Vec<_> = (0..wanted.title)
            .map(title)
            .chain(clock)
            .chain((0..rows).map(row))
            .chain(has_chart.then_some(chart))
            .chain((1..view.charts.len()).filter(|_| has_chart).map(|_| further.clone()))
            .chain(wanted.legend.map(|height| Node::new(Part::Legend, height).after(GAP * unit).rank(3)))
            .chain((0..wanted.caption).map(caption))
            .chain([Node::new(Part::Edge, bottom)])
            .collect();
        let parts = tree::column(&nodes, [0.0, 0.0, width, height]);
        let panels: Vec<_> = parts.all(Part::Panel).map(whole).collect();
        let written = written(view, panels.first().map_or(height, |panel| f64::from(panel[3])), scale.unit);
        Self { scale, around, panels, written, parts }
    }

    /// Sizes of type and lines around the panels of a view; they do not depend on the panels.
    pub(super) fn around(view: &View) -> Scale {
        Scale { unit: unit(view), ..Scale::REFERENCE }.within(view)
    }

    /// The number of lines of a part that have room.
    pub(super) fn lines(&self, part: Part) -> usize {
        self.parts.all(part).count()
    }

    /// The baselines of the lines of a part with type of a size (px).
    pub(super) fn baselines(&self, part: Part, size: f64) -> impl Iterator<Item = f64> {
        self.parts.all(part).map(move |place| place[1] + ASCENT * size)
    }

    /// The room of all charts, inside the margins, and their number.
    pub(super) fn charts(&self) -> Option<(Rectangle, usize)> {
        let [_, top, width, _] = self.parts.get(Part::Chart)?;
        let height = self.parts.all(Part::Chart).map(|[_, _, _, height]| height).sum::<f64>();
        let side = self.scale.margin().min(width / 2.0);
        let room = [side, top, width - 2.0 * side, height].map(|length| length.round() as u32);
        Some((room, self.lines(Part::Chart)))
    }
}

/// Whether a view has something to show below its panels.
fn has_parts_below(view: &View) -> bool {
    !view.charts.is_empty() || view.wants_legend() || !view.caption.is_empty()
}

/// A place in whole pixels, so that adjacent places have no gap between them.
pub(super) fn whole([left, top, width, height]: Place) -> Rectangle {
    let [left, top, right, bottom] = [left, top, left + width, top + height].map(|at| at.round().max(0.0) as u32);
    [left, top, right - left, bottom - top]
}

/// The requested parts around panels: the number of lines of the title, a row for the clock, a key of a height (px), and
/// the number of lines of the caption.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    pub(super) title: usize,
    pub(super) clock: bool,
    pub(super) legend: Option<f64>,
    pub(super) caption: usize,
}

/// Pixels of the picture of a view per pixel of the reference picture.
fn unit(view: &View) -> f64 {
    let [width, height] = view.size.map(|length| f64::from(length.max(1)));
    // Panels that arrange themselves stand side by side in a wide picture.
    let columns = view.columns.unwrap_or(if width < height { 1 } else { 2 }).clamp(1, 2) as u32;
    print::unit(view.size, [(width / f64::from(columns)) as u32, u32::MAX])
}

/// The text in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Written {
    pub(super) labels: Labels,
    /// Whether there is a second line, with the model and the start of the clock.
    pub(super) second: bool,
    /// Whether there is a line for events.
    pub(super) events: bool,
    /// The heights above and below the body (px).
    rooms: [f64; 2],
    /// The rows without room.
    pub(super) left_out: Vec<Part>,
}

/// The text in a panel of a height (px), with `unit` pixels per pixel of the reference picture. If not all of it fits
/// beside the body, first the events are left out, then the second line, then the text below.
pub(super) fn written(view: &View, height: f64, unit: f64) -> Written {
    let scale = Scale::at(unit).within(view);
    let Labels { letters, name, model, clock, count, number, scale_bar, .. } = view.labels;
    let (second, events) = (model || clock, !view.charts.is_empty());
    let [has_heading, has_numbers] = [letters || name || second || events, count || number || scale_bar];
    let edge = |end: usize, has_words| Node::new(Part::Edge, if has_words { scale.edges[end] } else { ROW } * unit);
    let row = |part, height: f64, rank: u8| Node::new(part, height).rank(rank);
    let [of_name, of_second, of_events] = scale.rows();
    let nodes: Vec<_> = std::iter::once(edge(0, has_heading))
        .chain(has_heading.then(|| row(Part::Name, of_name, 3)))
        .chain(second.then(|| row(Part::Second, of_second, 1)))
        .chain(events.then(|| row(Part::Events, of_events, 0)))
        .chain([Node::new(Part::Body, BODY * height).stretched()])
        .chain(has_numbers.then(|| row(Part::Numbers, scale.numbers().iter().sum(), 2)))
        .chain([edge(1, has_numbers)])
        .collect();
    let mut solved = tree::column(&nodes, [0.0, 0.0, 0.0, height]);
    // Rows that cannot be read stay empty, and rows below a name without room.
    let sizes = [(Part::Name, scale.title()), (Part::Second, scale.caption()), (Part::Events, scale.caption())];
    let sizes = sizes.into_iter().chain([(Part::Numbers, scale.caption())]);
    let nameless = |part| solved.get(Part::Name).is_none() && part != Part::Numbers;
    let empty = sizes.filter(|&(part, size)| solved.get(part).is_some() && (nameless(part) || !Scale::legible(size)));
    solved.left_out.extend(empty.map(|(part, _)| part).collect::<Vec<_>>());
    let has = |part| solved.get(part).is_some() && !solved.left_out.contains(&part);
    let [above, room] = solved.get(Part::Body).map_or([0.0, height], |[_, top, _, height]| [top, height]);
    let (names, numbers) = (has(Part::Name), has(Part::Numbers));
    // A row keeps its place where the row above it has nothing to say.
    Written {
        labels: Labels {
            letters: letters && names,
            name: name && names,
            model: model && has(Part::Second),
            clock: clock && names,
            count: count && numbers,
            number: number && numbers,
            scale_bar: scale_bar && numbers,
            ..view.labels
        },
        second: has(Part::Second),
        events: has(Part::Events),
        rooms: [above, height - above - room],
        left_out: solved.left_out,
    }
}

/// The heights for words above and below the body in a panel of a height (px), with `unit` pixels per pixel of the
/// reference picture (px in the reference picture).
pub(super) fn rooms(view: &View, height: f64, unit: f64) -> [f64; 2] {
    written(view, height, unit).rooms.map(|room| room / unit)
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
    /// The heights above and below the words of a panel (px in the reference picture).
    pub(super) edges: [f64; 2],
}

impl Scale {
    /// The sizes of the reference picture.
    pub(super) const REFERENCE: Self = Self { unit: 1.0, type_factor: 1.0, least: 0.0, edges: [BESIDE; 2] };

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
        // The outermost words keep the margins of the picture.
        let above = if view.title.is_empty() { MARGIN } else { BESIDE };
        let below = if has_parts_below(view) { BESIDE } else { SHORT + BESIDE };
        Self { least: SMALL * unit(view) * view.look.text_scale.min(1.0), edges: [above, below], ..self.with(view) }
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

    /// The heights of the rows of a name, a second line and events in a panel (px).
    fn rows(self) -> [f64; 3] {
        let row = |step: f64, size: f64| (step * self.type_unit()).max(LINE * size);
        [row(NAME_ROW, self.title()), row(ROW, self.caption()), row(TALL_ROW, self.caption())]
    }

    /// The heights of the rows of a count and of the words below it (px).
    fn numbers(self) -> [f64; 2] {
        let [count, words] = NUMBERS.map(|step| step * self.type_unit());
        [count.max(ASCENT * self.title() + 0.5 * self.caption()), words.max(LINE * self.caption())]
    }

    /// Size of the title above all panels (px).
    pub(super) fn heading(self) -> f64 {
        1.16 * self.title()
    }

    /// Size of names, clock and count (px).
    pub(super) fn title(self) -> f64 {
        (steps::NAME * self.type_unit()).max(self.least)
    }

    /// Size of all other type (px).
    pub(super) fn caption(self) -> f64 {
        (steps::TEXT * self.type_unit()).max(self.least)
    }

    /// Size of numbers in charts and in rings (px).
    pub(super) fn small(self) -> f64 {
        (SMALL * self.type_unit()).max(self.least)
    }

    /// The margin around and inside each panel (px).
    pub(super) fn margin(self) -> f64 {
        MARGIN * self.unit
    }

    /// The gap between adjacent parts (px).
    pub(super) fn gap(self) -> f64 {
        GAP * self.unit
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
        let ([name, second, _], [count, below]) = (scale.rows(), scale.numbers());
        let [top, bottom] = scale.edges.map(|edge| edge * scale.unit);
        let bottom = f64::from(panel[3]) - bottom;
        let [large, small] = [scale.title(), scale.caption()].map(|size| ASCENT * size);
        Self {
            title: top + large,
            second: top + name + small,
            events: top + name + second + small,
            count: bottom - below - count + large,
            caption: bottom - below + small,
        }
    }
}

/// The part of a panel of a view between its lines of text, inside its margins.
pub(super) fn clear_of_words(panel: Rectangle, view: &View, scale: Scale) -> Rectangle {
    let [left, top, width, height] = panel;
    let [above, below] = written(view, f64::from(height), scale.unit).rooms;
    let inside = |at: f64, length: u32| at.clamp(0.0, f64::from(length)) as u32;
    let side = inside(scale.margin(), width / 2);
    let above = inside(above + NEAR * scale.unit, height);
    let below = inside(f64::from(height) - below - GAP * scale.unit, height).max(above);
    [left + side, top + above, width - 2 * side, below - above]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::{Style, Theme};

    /// A view of a size with a title and a chart.
    fn view(size: [u32; 2]) -> View {
        let charts = vec![crate::sim::Diagnostic::TurnedOver];
        View { size, title: "Title".to_owned(), charts, ..View::default() }
    }

    #[test]
    fn panels_cover_their_rows() {
        for (size, count, columns) in [([1280, 720], 2, 2), ([1281, 719], 6, 3), ([64, 64], 5, 2), ([8192, 100], 1, 4)]
        {
            let Layout { panels, scale, .. } = Layout::new(&view(size), count, columns, Wanted::default());
            assert_eq!(panels.len(), count);
            // Each panel begins at the end of the one before, and the last ones end at the picture's edges.
            let columns = columns.min(count);
            for (at, &[left, top, width, height]) in panels.iter().enumerate() {
                assert!(width > 0 && height > 0);
                let beside = if at % columns == 0 { 0 } else { panels[at - 1][0] + panels[at - 1][2] };
                let above = if at < columns { top } else { panels[at - columns][1] + panels[at - columns][3] };
                let gap = if at < columns { 0.0 } else { BESIDE * scale.unit };
                assert!(left == beside && (f64::from(top - above) - gap).abs() <= 1.0);
                assert!(at % columns != columns - 1 || left + width == size[0]);
            }
        }
    }

    #[test]
    fn the_ground_between_the_words_lies_inside_the_panel() {
        let view = View::default();
        assert_eq!(clear_of_words([640, 0, 640, 720], &view, Scale::REFERENCE), [680, 104, 560, 519]);
        for panel in [[0, 0, 1, 1], [5, 7, 30, 12], [0, 0, 3000, 40]] {
            let [x, y, width, height] = clear_of_words(panel, &view, Scale::new([64, 64], panel));
            assert!(x >= panel[0] && x + width <= panel[0] + panel[2]);
            assert!(y >= panel[1] && y + height <= panel[1] + panel[3]);
        }
    }

    /// The parts of a page of a size in words: each with its first and last pixel down, then the parts without room.
    fn said((size, caption): ([u32; 2], usize)) -> String {
        let wanted = Wanted { title: 1, clock: true, legend: Some(0.05 * f64::from(size[1])), caption };
        let layout = Layout::new(&view(size), 3, 2, wanted);
        let named = [Part::Title, Part::Clock, Part::Row, Part::Chart, Part::Legend, Part::Caption];
        let lines = named.iter().flat_map(|&part| layout.parts.all(part).map(move |place| (part, place)));
        let lines = lines.map(|(part, [_, top, _, height])| format!("{part:?} {top:.0}–{:.0}, ", top + height));
        let [page, panels] = [&layout.parts.left_out, &layout.written.left_out];
        format!("{}without {page:?}; panels without {panels:?}", lines.collect::<String>())
    }

    #[test]
    fn the_least_important_parts_are_left_out_first() {
        let large = "Title 47–95, Clock 95–135, Row 135–437, Row 451–753, Chart 772–917, Legend 936–990, Caption 1004–1030, \
                     Caption 1030–1056, without []; panels without [Events]";
        let low = "Title 40–80, Clock 80–114, Row 114–279, Row 289–454, Chart 470–592, Legend 608–644, Caption 656–678, \
                   Caption 678–700, without []; panels without [Second, Events]";
        let small = "Title 11–22, Clock 22–32, Row 32–97, Row 99–164, Legend 169–179, Caption 182–188, Caption 188–194, \
                     without []; panels without [Second, Events, Numbers]";
        assert_eq!([([1280, 1080], 2), ([1280, 720], 2), ([300, 200], 2)].map(said), [large, low, small]);
        let crowded = said(([1280, 720], 12));
        assert!(crowded.contains("without [Caption, "), "{crowded}");
    }

    #[test]
    fn type_grows_with_the_picture_and_shrinks_with_panels() {
        let unit = |size, count, columns| {
            Layout::new(&View { size, ..View::default() }, count, columns, Wanted::default()).scale.unit
        };
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
