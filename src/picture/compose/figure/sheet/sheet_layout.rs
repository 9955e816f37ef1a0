//! The layout of a sheet.

use super::headings::{HEADING_LINE, Heading};
use crate::picture::caption::Writer;
use crate::picture::chart::{Room, Stack};
use crate::picture::layout::{Rectangle, Scale};
use crate::scene::figure::Sheet;
use crate::sim::Dimension;

/// The distance from the last line of the header to the first line of the headings, and from the last one to the tiles
/// (px in the reference picture).
const ABOVE_HEADINGS: f64 = 37.0;
const BELOW_HEADINGS: f64 = 9.0;
/// The gap between the words of rows and the tiles (px in the reference picture).
const BESIDE_LABELS: f64 = 18.0;
/// The words beside rows and charts take at most this part of the picture's width.
const MOST_LABELS: f64 = 0.4;
/// Room for tally and count below the body in a tile, and their height above its lower side (px in the reference
/// picture). Tiles lower or narrower than the second length have none.
const BELOW_BODY: f64 = 36.0;
pub(super) const TALLY_RAISED: f64 = 9.0;
const LEAST_TILE: [f64; 2] = [100.0, 62.0];
/// The gaps at both sides of the words in a tile, together (px in the reference picture).
const BESIDE_WORDS: f64 = 12.0;
/// The least height of the floor of the plane above the lower side of a tile (px at the tile's scale).
const BELOW_FLOOR: f64 = 44.0;
/// Tiles are at most this many times higher than wide.
const HIGHEST: f64 = 1.12;
/// The size of a tile (px in the reference picture) whose lines have this thickness, relative to those of a panel.
/// Larger and smaller tiles have thicker and thinner lines, within the limits.
const USUAL_TILE: f64 = 240.0;
const TILE_LINES: f64 = 0.78;
const TILE_LIMITS: [f64; 2] = [0.34, 1.0];
/// The distances from the tiles to the middle of the rings, from there to the first chart, between charts (most and
/// least), and from the last chart to the end of the picture (px in the reference picture).
const ABOVE_RINGS: f64 = 24.0;
const BELOW_RINGS: f64 = 27.0;
const BETWEEN_CHARTS: [f64; 2] = [40.0, 26.0];
const BELOW_CHARTS: f64 = 44.0;
/// Half of the gap between the names of two charts at the ends of curves (px in the reference picture).
const NAMES_APART: f64 = 3.0;
/// The least, usual and largest height of a chart (px in the reference picture).
const CHART: [f64; 3] = [32.0, 68.0, 150.0];
/// The largest share of the height of tiles and charts for the charts.
const CHARTS_SHARE: f64 = 0.58;
/// The gap below the tiles if there are no charts (px in the reference picture).
const BELOW_TILES: f64 = 22.0;

/// The places of all parts (px).
pub(super) struct SheetLayout {
    /// The left side of the first column, and the top of the first row.
    origin: [u32; 2],
    /// The sizes of a tile.
    tile: [u32; 2],
    columns: usize,
    pub(super) tile_scale: Scale,
    /// The height at the lower side of a tile that its body leaves free.
    pub(super) below_body: f64,
    /// Whether there is room for tallies.
    pub(super) has_tally: bool,
    /// The headings of the columns, and the baseline of their first lines.
    pub(super) headings: Vec<Heading>,
    pub(super) headings_baseline: f64,
    /// The left end and width of the words beside rows; `None` if there are none.
    pub(super) labels: Option<[f64; 2]>,
    pub(super) charts: Option<Room>,
}

impl SheetLayout {
    /// Plans a sheet of a size (px) below the last baseline of a header, with words of a width beside the rows (px).
    pub(super) fn new(
        sheet: &Sheet,
        writer: &Writer<'_>,
        size: [u32; 2],
        header: f64,
        labels: f64,
        charts: Option<&Stack>,
    ) -> Self {
        let scale = writer.scale;
        let [width, height] = size.map(f64::from);
        let [unit, type_unit] = [scale.unit, scale.type_unit()];
        let (columns, rows) = (sheet.columns.len().max(1), sheet.rows.len().max(1));
        let margin = scale.margin();
        let words = labels.max(charts.map_or(0.0, |charts| charts.names_width));
        let numbers = charts.map_or(0.0, |charts| charts.numbers_width);
        let labels_end = (labels + BESIDE_LABELS * unit).max(words + numbers);
        let has_labels = words > 0.0 && margin + labels_end <= MOST_LABELS * width;
        let left = (margin + if has_labels { labels_end } else { numbers.min(0.1 * width) }).round();
        let pitch = ((width - margin - left) / columns as f64).floor().max(1.0);
        let right = left + pitch * columns as f64;

        let headings = Heading::all(sheet, writer, pitch, charts.is_some());
        let lines = headings.iter().map(|heading| heading.lines.len()).max().unwrap_or(0) as f64;
        let first = if header > 0.0 { header + ABOVE_HEADINGS * type_unit } else { 0.75 * margin + 16.0 * type_unit };
        let top = match lines {
            0.0 if header > 0.0 => header + 12.0 * unit,
            0.0 => 0.5 * margin,
            lines => first + (lines - 1.0) * HEADING_LINE * type_unit + BELOW_HEADINGS * unit,
        };
        let free = (height - top).max(0.0);
        let shape = charts.and_then(|charts| ChartsShape::new(charts, free, scale));
        let below = shape.as_ref().map_or(BELOW_TILES * unit, |shape| shape.height(scale));
        let usual = ((free - below) / rows as f64).max(1.0);
        let tally = (BELOW_BODY * type_unit).max(TALLY_RAISED * unit);
        let tile_height = usual.min(HIGHEST * pitch + tally).floor().max(1.0);
        // Spare height makes charts higher.
        let left_over = (free - below - tile_height * rows as f64).max(0.0);
        let shape = shape.map(|shape| shape.higher(left_over, scale));
        let has_tally = pitch >= LEAST_TILE[1] * type_unit && tile_height >= LEAST_TILE[0] * type_unit;
        let tile_unit = TILE_LINES * pitch.min(tile_height) / USUAL_TILE;
        let tile_scale = scale.with_unit(tile_unit.clamp(TILE_LIMITS[0] * unit, TILE_LIMITS[1] * unit));
        let flat = sheet.scenes.iter().any(|scene| scene.body.dimension == Dimension::Plane);
        let below_body = if has_tally { tally } else { 6.0 * unit };
        let below_floor = if flat { BELOW_FLOOR * tile_scale.unit } else { 0.0 };
        let tiles_end = top.round() + tile_height * rows as f64;
        Self {
            origin: [left, top.round()].map(|at| at as u32),
            tile: [pitch, tile_height].map(|length| length as u32),
            columns,
            tile_scale,
            below_body: below_body.max(below_floor).min(0.5 * tile_height),
            has_tally,
            headings,
            headings_baseline: first,
            labels: has_labels.then_some([margin, words]),
            charts: shape.map(|shape| {
                // The names of curves are right of the charts.
                let right = right - charts.map_or(0.0, Stack::ends_width);
                shape.place(tiles_end, [left, right.round()], has_labels.then_some(margin), scale)
            }),
        }
    }

    /// The place of a tile.
    pub(super) fn tile(&self, row: usize, column: usize) -> Rectangle {
        let ([left, top], [width, height]) = (self.origin, self.tile);
        debug_assert!(column < self.columns);
        [left + width * column as u32, top + height * row as u32, width, height]
    }

    /// The part of a tile at the picture's origin that its body may touch: left, top, right and bottom (px).
    pub(super) fn body_room(&self) -> [f64; 4] {
        let [width, height] = self.tile.map(f64::from);
        let beside = (0.09 * width).max(2.0).min(0.25 * width);
        let above = (0.045 * height).max(2.0).min(0.25 * height);
        [beside, above, width - beside, (height - self.below_body).max(0.5 * height)]
    }

    /// The width of the room for words in a tile (px).
    pub(super) fn words_width(&self, scale: Scale) -> f64 {
        f64::from(self.tile[0]) - BESIDE_WORDS * scale.unit
    }

    /// The sizes of a tile (px).
    pub(super) fn tile_size(&self) -> [u32; 2] {
        self.tile
    }
}

/// The heights of charts (px).
#[derive(Clone, Copy)]
struct ChartsShape {
    count: usize,
    chart: f64,
    between: f64,
}

impl ChartsShape {
    /// As many charts as fit into a height (px) with tiles above them; `None` for none.
    fn new(charts: &Stack, free: f64, scale: Scale) -> Option<Self> {
        let [least, usual, _] = CHART;
        let [wide, narrow] = BETWEEN_CHARTS;
        let sizes = [(usual, wide), (0.75 * usual, wide), (0.75 * usual, narrow), (least, narrow)];
        // Charts are as high as the names of their curves need, or lower without names.
        let with_names =
            |(chart, between): (f64, f64)| (chart.max(charts.ends_height() + 2.0 * NAMES_APART - between), between);
        let sizes: Vec<_> = sizes.map(with_names).into_iter().chain([sizes[3]]).collect();
        // With larger type, charts become lower before bodies become smaller.
        let wanted = CHARTS_SHARE * (scale.unit / scale.type_unit()).min(1.0);
        (1..=charts.count()).rev().find_map(|count| {
            let shape = |size: &(f64, f64)| {
                let [chart, between] = [size.0, size.1].map(|length| length * scale.type_unit());
                Self { count, chart, between }
            };
            let shapes: Vec<_> = sizes.iter().map(shape).collect();
            let lowest = shapes.iter().rev().find(|shape| shape.height(scale) <= CHARTS_SHARE * free);
            shapes.iter().find(|shape| shape.height(scale) <= wanted * free).or(lowest).copied()
        })
    }

    /// The height of all charts with the gaps between and around them.
    fn height(&self, scale: Scale) -> f64 {
        let count = self.count as f64;
        count * self.chart + (count - 1.0) * self.between + around(scale)
    }

    /// The heights after spare room is used.
    fn higher(self, left_over: f64, scale: Scale) -> Self {
        let chart = self.chart + left_over / self.count as f64;
        Self { chart: chart.min(CHART[2] * scale.type_unit()).max(self.chart), ..self }
    }

    fn place(&self, top: f64, span: [f64; 2], names: Option<f64>, scale: Scale) -> Room {
        let rings = top + ABOVE_RINGS * scale.type_unit();
        let first = rings + BELOW_RINGS * scale.type_unit();
        // Names may extend beside the gaps between charts, but must stay apart from the names of another chart.
        let beyond = 0.5 * self.between - NAMES_APART * scale.type_unit();
        let chart = |at: usize| {
            let top = first + at as f64 * (self.chart + self.between);
            [top, top + self.chart].map(f64::round)
        };
        Room { rings, span, names, charts: (0..self.count).map(chart).collect(), beyond: [beyond; 2] }
    }
}

/// The room above and below all charts together.
fn around(scale: Scale) -> f64 {
    (ABOVE_RINGS + BELOW_RINGS + BELOW_CHARTS) * scale.type_unit()
}
