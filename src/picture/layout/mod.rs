//! The layout of a picture: a tree of boxes for its page, and one for the words of each panel of a frame. It does not
//! depend on the frame, so nothing jumps. A frame is a sheet of one moment; the boxes in parentheses are only in sheets.
//!
//! ```text
//! title
//! caption, in figures                (key)
//! clock, where names leave it no room
//!            (heading)         (heading)
//! (words)  ┌ panel ──────────┬ panel ──────────┐
//! (beside) │ name            │ name      clock │
//! (the)    │ events          │ events          │
//! (row)    │      body       │      body       │
//!          │ count    number │ count    number │
//!          └─────────────────┴─────────────────┘
//! charts of all runs
//! keys of colours and arrows
//! caption, in frames
//! ```

mod scale;
pub(super) mod steps;
pub(super) mod tree;
mod words;

pub(crate) use scale::Rectangle;
pub(super) use scale::{ASCENT, SMALLEST_TYPE, Scale};
pub(super) use words::{WordPlaces, WordsShown, clear_of_words, rooms};

use crate::look::{View, print};
use scale::{LINE, unit};
use steps::{APART, BESIDE, CHART, GAP, MARGIN, NAME_ROW, ROW, SHORT, TALL_ROW, TILE};
use tree::{Node, Place, Solved};
use words::written;

/// The parts of a picture that panels keep without and with a chart.
const PANELS: [f64; 2] = [0.45, 0.36];
/// The largest part of a picture for a chart.
const CHART_SHARE: f64 = 0.3;
/// The largest part of the height of a page for a chart with an axis of its own.
const OWN_SHARE: f64 = 0.4;
/// The most lines of titles, and the most names at the ends of curves that make a chart higher.
const MOST_LINES: usize = 4;
const MOST_NAMES: usize = 10;

/// The boxes of a page and of its panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Edge,
    Title,
    Caption,
    Clock,
    Key,
    Heading,
    Row,
    Panel,
    Chart,
    Legend,
    // Beside the panels of a row: the room of its words, and the name, the line and the note of a row.
    Words,
    Label(usize),
    Sample(usize),
    Note(usize),
    // In a panel.
    Name,
    Second,
    Events,
    Body,
    Numbers,
}

impl Part {
    /// The size of its type (px).
    pub(super) fn size(self, scale: Scale) -> f64 {
        match self {
            Self::Title => scale.heading(),
            Self::Clock | Self::Name => scale.title(),
            Self::Note(_) | Self::Chart => scale.small(),
            _ => scale.caption(),
        }
    }

    /// The height of a line of it (px).
    pub(super) fn height(self, scale: Scale) -> f64 {
        let row = match self {
            Self::Title => MARGIN * scale.name_unit(),
            Self::Clock | Self::Name | Self::Numbers => NAME_ROW * scale.name_unit(),
            Self::Events => TALL_ROW * scale.type_unit(),
            Self::Label(_) | Self::Note(_) => SHORT * scale.type_unit(),
            Self::Sample(_) => return BESIDE * scale.type_unit(),
            _ => ROW * scale.type_unit(),
        };
        row.max(LINE * self.size(scale))
    }

    /// The box for a line of it. Type that cannot be read has no room.
    pub(super) fn line(self, scale: Scale) -> Node<Self> {
        // The most important parts have the highest ranks.
        let rank = match self {
            Self::Clock => 6,
            Self::Title | Self::Heading => 5,
            Self::Caption | Self::Label(_) => 2,
            Self::Sample(_) => 1,
            _ => 0,
        };
        let height = if Scale::legible(self.size(scale)) { self.height(scale) } else { f64::INFINITY };
        Node::new(self, height).rank(rank)
    }

    /// The message about a picture in which a box of it has no room.
    fn loss(self) -> Option<&'static str> {
        Some(match self {
            Self::Title => "the title is cut off",
            Self::Caption => "the caption is cut off",
            Self::Clock => "the clock is left out",
            Self::Key => "the key of turned-over elements is left out",
            Self::Heading => "headings of columns are cut off",
            Self::Legend => "the key of colours, lines and arrows is left out",
            Self::Words => "rows and charts have no names",
            Self::Label(_) => "names of rows are cut off",
            Self::Sample(_) => "rows do not show the lines of their runs",
            Self::Note(_) => "notes of rows are cut off",
            Self::Name => "panels have no names",
            Self::Second => "panels do not describe the models",
            Self::Events => "panels do not name the events of the chart",
            Self::Numbers => "panels have no numbers",
            Self::Edge | Self::Row | Self::Panel | Self::Chart | Self::Body => return None,
        })
    }
}

/// The boxes without room in words, each kind once.
pub(super) fn told(page: &Solved<Part>, in_panels: &[Part]) -> Vec<String> {
    let mut told: Vec<String> = Vec::new();
    for loss in page.left_out.iter().chain(in_panels).filter_map(|part| part.loss()) {
        if !told.iter().any(|other| other == loss) {
            told.push(loss.to_owned());
        }
    }
    let shown = page.all(Part::Chart).count();
    match shown + page.left_out.iter().filter(|&&part| part == Part::Chart).count() {
        all if all == shown => {}
        _ if shown == 0 => told.push("the charts are left out".to_owned()),
        all => told.push(format!("only {shown} of {all} charts have room")),
    }
    told
}

/// The requested parts of a page around its rows of panels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wanted {
    /// The numbers of lines of the title and of the caption.
    pub(super) titles: [usize; 2],
    /// Whether the caption is below the title instead of below everything.
    pub(super) is_figure: bool,
    /// A row for the clock.
    pub(super) clock: bool,
    /// The number of lines of the headings of columns.
    pub(super) headings: usize,
    /// The number of charts, and of the names at the ends of their curves.
    pub(super) charts: [usize; 2],
    /// How many of the charts, the last ones, have an axis of their own.
    pub(super) own_axes: usize,
    /// The height of a key of colours and arrows (px).
    pub(super) legend: Option<f64>,
}

/// The boxes of a page with some rows of panels, from top to bottom.
pub(super) fn page(scale: Scale, wanted: Wanted, rows: impl Iterator<Item = Node<Part>>) -> Vec<Node<Part>> {
    let (unit, type_unit) = (scale.unit, scale.type_unit());
    let Wanted { titles: [title, caption], is_figure, clock, headings, charts: [charts, names], own_axes, legend } =
        wanted;
    let lines = |part: Part, count: usize, gap: f64| {
        let too_many = move |at: usize| part == Part::Title && at >= MOST_LINES;
        let apart = move |at: usize| if at == 0 { gap * unit } else { 0.0 };
        (0..count).map(move |at| part.line(scale).after(if too_many(at) { f64::INFINITY } else { apart(at) }))
    };
    let [above, below] = if is_figure { [caption, 0] } else { [0, caption] };
    let header = lines(Part::Title, title, 0.0).chain(lines(Part::Caption, above, 0.0));
    let header = header.chain(lines(Part::Clock, clock.into(), 0.0)).chain(lines(Part::Heading, headings, GAP));
    let header: Vec<_> = header.collect();
    let top = (!header.is_empty()).then(|| Node::new(Part::Edge, MARGIN * unit));
    // The names at the ends of curves need room above each other. Curves do not grow with words.
    let names = (names.min(MOST_NAMES) as f64 * GAP - (CHART - NAME_ROW)).max(0.0) * type_unit;
    let charts = (0..charts).map(|at| {
        let has_own = at + own_axes >= charts;
        let words = if at == 0 { NAME_ROW + SHORT } else { APART + if has_own { SHORT } else { 0.0 } } * type_unit;
        let is_legible = Scale::legible(Part::Chart.size(scale));
        let gap = if at == 0 { GAP * unit } else { 0.0 };
        let [high, share] = if has_own { [TILE, OWN_SHARE] } else { [CHART, CHART_SHARE] };
        let chart = Node::new(Part::Chart, words + names + (high - NAME_ROW - SHORT) * unit);
        let chart = chart.least(words + APART * unit).most(TILE.max(high) * unit).share(share);
        // Of several charts, as many are drawn as have room.
        chart.after(if is_legible { gap } else { f64::INFINITY }).rank(if at == 0 { 3 } else { 1 })
    });
    let charts: Vec<_> = charts.collect();
    let has_parts_below = !charts.is_empty() || legend.is_some() || caption > 0;
    top.into_iter()
        .chain(header)
        .chain(rows)
        .chain(charts)
        .chain(legend.map(|height| Node::new(Part::Legend, height).after(GAP * unit).rank(4)))
        .chain(lines(Part::Caption, below, if legend.is_some() { BESIDE } else { GAP }))
        .chain([Node::new(Part::Edge, if is_figure || has_parts_below { SHORT * unit } else { 0.0 })])
        .collect()
}

/// The box of a row of panels, up to a height (px): the least part of its share of a picture (px), with or without charts.
pub(super) fn row(most: f64, share: f64, has_charts: bool) -> Node<Part> {
    Node::new(Part::Row, most).least(PANELS[usize::from(has_charts)] * share)
}

/// The room of charts (px).
pub(super) struct Room {
    /// The middle of the rings above all charts.
    pub(super) rings: f64,
    /// Left and right end of all charts.
    pub(super) span: [f64; 2],
    /// The left end of their names.
    pub(super) names: Option<f64>,
    /// Top and bottom of each chart.
    pub(super) charts: Vec<[f64; 2]>,
    /// The extent of names at the ends of curves above and below each chart.
    pub(super) beyond: f64,
}

impl Room {
    /// The room between two sides in the boxes of a page, with a place for the names of the charts, of which so many are over time and the
    /// others twice as high; `None` without boxes. Rings need room above the charts.
    pub(super) fn new(
        page: &Solved<Part>,
        scale: Scale,
        (span, over_time): ([f64; 2], usize),
        names: Option<f64>,
        has_rings: bool,
    ) -> Option<Self> {
        let (unit, count) = (scale.type_unit(), page.all(Part::Chart).count());
        let whole: f64 = page.all(Part::Chart).map(|place| place[3]).sum();
        let top = page.get(Part::Chart)?[1];
        let above = if has_rings { NAME_ROW } else { GAP };
        // Numbers below the last chart over time, and below each of the others.
        let has_axis = |at: usize| at + 1 >= over_time.min(count);
        let below = |at: usize| (APART + if has_axis(at) { SHORT } else { 0.0 }) * unit;
        let parts = |at: usize| if at < over_time { 1.0 } else { 2.0 };
        let words = above * unit + (0..count).map(below).sum::<f64>() - APART * unit;
        let height = (whole - words) / (0..count).map(parts).sum::<f64>();
        let chart = |top: &mut f64, at: usize| {
            let own = [*top, *top + parts(at) * height].map(f64::round);
            *top += parts(at) * height + below(at);
            Some(own)
        };
        let charts = (0..count).scan(top + above * unit, chart).collect();
        Some(Self { rings: top + BESIDE * unit, span: span.map(f64::round), names, charts, beyond: BESIDE * unit })
    }
}

/// The places of all parts of a frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Sizes of type and lines in panels.
    pub(super) scale: Scale,
    /// Sizes of type and lines around panels.
    pub(super) around: Scale,
    /// A rectangle for each run shown, row by row.
    pub(super) panels: Vec<Rectangle>,
    /// The words of each panel.
    pub(super) written: WordsShown,
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
        let scale = Scale::at(print::unit(size, [size[0] / columns as u32, size[1] / rows as u32])).within(view);
        let panels = |row: usize| {
            let key = |column: usize| if row * columns + column < count { Part::Panel } else { Part::Edge };
            (0..columns).map(|column| Node::new(key(column), 0.0).stretched()).collect()
        };
        // Without a title, all panels have the margin of the picture above their words.
        let apart = |row: usize| if row > 0 && !view.title.is_empty() { BESIDE * scale.unit } else { 0.0 };
        let row = row(f64::INFINITY, height / rows as f64, wanted.charts[0] > 0);
        let of_panels = (0..rows).map(|at| row.clone().after(apart(at)).with(panels(at)));
        let parts = tree::column(&page(around, wanted, of_panels), [0.0, 0.0, width, height]);
        let panels: Vec<_> = parts.all(Part::Panel).map(whole).collect();
        let written = written(view, panels.first().map_or(height, |panel| f64::from(panel[3])), scale.unit);
        Self { scale, around, panels, written, parts }
    }

    /// Sizes of type and lines around the panels of a view; they do not depend on the panels.
    pub(super) fn around(view: &View) -> Scale {
        Scale::at(unit(view)).within(view)
    }
}

/// The baselines of the lines of a part, with type of a scale (px).
pub(super) fn baselines(page: &Solved<Part>, part: Part, scale: Scale) -> impl Iterator<Item = f64> {
    page.all(part).map(move |place| place[1] + ASCENT * part.size(scale))
}

/// A place in whole pixels, so that adjacent places have no gap between them.
pub(super) fn whole([left, top, width, height]: Place) -> Rectangle {
    let [left, top, right, bottom] = [left, top, left + width, top + height].map(|at| at.round().max(0.0) as u32);
    [left, top, right - left, bottom - top]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::{Style, Theme};

    /// A view of a size with a title and a chart.
    fn view(size: [u32; 2]) -> View {
        let charts = vec![crate::sim::Diagnostic::TurnedOver.into()];
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
            let [x, y, width, height] =
                clear_of_words(panel, &view, Scale::at(print::unit([64, 64], [panel[2], panel[3]])));
            assert!(x >= panel[0] && x + width <= panel[0] + panel[2]);
            assert!(y >= panel[1] && y + height <= panel[1] + panel[3]);
        }
    }

    /// The parts of a page of a size in words: each with its first and last pixel down, then the parts without room.
    fn said((size, caption): ([u32; 2], usize)) -> String {
        let legend = Some(0.05 * f64::from(size[1]));
        let wanted = Wanted { titles: [1, caption], clock: true, legend, charts: [1, 3], ..Wanted::default() };
        let layout = Layout::new(&view(size), 3, 2, wanted);
        let named = [Part::Title, Part::Clock, Part::Row, Part::Chart, Part::Legend, Part::Caption];
        let lines = named.iter().flat_map(|&part| layout.parts.all(part).map(move |place| (part, place)));
        let lines = lines.map(|(part, [_, top, _, height])| format!("{part:?} {top:.0}–{:.0}, ", top + height));
        let [page, panels] = [&layout.parts.left_out, &layout.written.left_out];
        format!("{}without {page:?}; panels without {panels:?}", lines.collect::<String>())
    }

    #[test]
    fn the_least_important_parts_are_left_out_first() {
        let large = "Title 47–95, Clock 95–135, Row 135–438, Row 452–756, Chart 775–917, Legend 936–990, Caption 1004–1030, \
                     Caption 1030–1056, without []; panels without [Second, Events]";
        let low = "Title 40–80, Clock 80–114, Row 114–280, Row 290–456, Chart 472–592, Legend 608–644, Caption 656–678, \
                   Caption 678–700, without []; panels without [Events, Numbers]";
        // Type that cannot be read has no room.
        let small = "Title 11–22, Clock 22–32, Row 32–105, Row 107–180, Legend 184–194, \
                     without [Chart, Caption, Caption]; panels without [Events, Second]";
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
        let tall = Layout::around(&View { size: [900, 1600], ..View::default() }).unit;
        assert!((tall - 1.368).abs() < 1e-9, "{tall}");
    }

    #[test]
    fn type_grows_alone() {
        let look = Style { text_scale: 2.0, ..Style::of(Theme::Light) };
        let view = View { look, ..View::default() };
        let (usual, large) = (Scale::REFERENCE, Scale::REFERENCE.with(&view));
        // Names grow less than other type from 1.5 times on, and remain larger.
        assert_eq!((large.title(), large.caption()), (1.25 * large.caption(), 2.0 * usual.caption()));
        assert_eq!((large.line(), large.margin()), (usual.line(), usual.margin()));
        // Each row has room for its type.
        let panel = [0, 0, 640, 720];
        let rows = WordPlaces::new(large, panel);
        assert!(rows.second - rows.title > large.caption() && rows.caption - rows.count >= large.caption());
        let [_, top, _, height] = clear_of_words(panel, &view, large);
        assert!(f64::from(top) > rows.second && f64::from(top + height) < rows.count - large.title());
    }
}
