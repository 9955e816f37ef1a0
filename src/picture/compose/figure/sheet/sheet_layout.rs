//! The layout of a sheet: a page with words beside its rows.

use super::rows::RowLabels;
use crate::picture::layout::steps::{BESIDE, BLOCK, CLOSE, GAP, TILE};
use crate::picture::layout::tree::{self, Node, Solved};
use crate::picture::layout::{self, Part, Rectangle, Scale, Wanted};
use crate::scene::figure::Sheet;

/// The words beside rows and charts take at most this part of the width, and so do the numbers of charts.
const WORDS: f64 = 0.3;
const NUMBERS: f64 = 0.1;
/// Tiles are at most this many times higher than wide.
const HIGHEST: f64 = 1.12;
/// The thickness of lines in a tile of the usual size, relative to those of a panel. Larger and smaller tiles have thicker
/// and thinner lines, within the limits.
const TILE_LINES: f64 = 0.78;
const TILE_LIMITS: [f64; 2] = [0.34, 1.0];

/// The places of all parts (px).
pub(super) struct SheetLayout {
    pub(super) page: Solved<Part>,
    /// The sizes of the picture.
    size: [u32; 2],
    /// The left side of the first column, and the top of the first row.
    origin: [u32; 2],
    /// The sizes of a tile.
    pub(super) tile_size: [u32; 2],
    pub(super) tile_scale: Scale,
    /// The height at the lower side of a tile that its body leaves free.
    pub(super) below_body: f64,
}

impl SheetLayout {
    /// Plans a sheet of a size (px), with words beside the rows, the widths of the names of charts and of the numbers beside
    /// them, and tiles of a width (px), which may be infinite if it is not known yet.
    pub(super) fn new(
        sheet: &Sheet,
        (size, scale): ([u32; 2], Scale),
        wanted: Wanted,
        labels: &RowLabels,
        [names, numbers]: [f64; 2],
        pitch: f64,
    ) -> Self {
        let [width, height] = size.map(f64::from);
        let (unit, margin, rows) = (scale.unit, scale.margin(), sheet.rows.len().max(1));
        let below = Part::Numbers.line(scale);
        let body = Node::new(Part::Body, BLOCK * scale.type_unit()).stretched();
        let tile = Node::new(Part::Panel, 0.0).stretched().with(vec![body, below]);
        let words = labels.width.max(names);
        let numbers = if words > 0.0 { numbers.max(GAP * unit) } else { numbers };
        let row = |at: usize| {
            let words = Node::new(Part::Words, words).share(WORDS).rank(0).with(labels.boxes(at, scale));
            let numbers = Node::new(Part::Edge, numbers).least(0.0).share(NUMBERS);
            let beside = [words, numbers].into_iter();
            let highest = HIGHEST * pitch + Part::Numbers.height(scale);
            let row = layout::row(highest, height / rows as f64, wanted.charts[0] > 0);
            row.with(beside.chain(sheet.columns.iter().map(|_| tile.clone())).collect())
        };
        let nodes = layout::page(scale, wanted, (0..rows).map(row));
        let page = tree::column(&nodes, [margin, 0.0, width - 2.0 * margin, height]);
        let [left, top, pitch, high] = page.get(Part::Panel).unwrap_or_default();
        let body = page.get(Part::Body).map_or(high, |[.., height]| height);
        let tile = [pitch, high].map(|length| length.floor().max(1.0));
        let tile_unit = TILE_LINES * tile[0].min(tile[1]) / TILE;
        Self {
            size,
            origin: [left, top].map(|at| at.round() as u32),
            tile_size: tile.map(|length| length as u32),
            tile_scale: scale.with_unit(tile_unit.clamp(TILE_LIMITS[0] * unit, TILE_LIMITS[1] * unit)),
            below_body: (high - body).max(CLOSE * unit).min(0.5 * tile[1]),
            page,
        }
    }

    /// The place of a tile. More tiles than pixels lie over each other at the border of the picture.
    pub(super) fn tile(&self, row: usize, column: usize) -> Rectangle {
        let place = |axis: usize, at: usize| {
            let start = self.origin[axis] + self.tile_size[axis] * at as u32;
            start.min(self.size[axis].saturating_sub(self.tile_size[axis]))
        };
        [place(0, column), place(1, row), self.tile_size[0], self.tile_size[1]]
    }

    /// The part of a tile at the picture's origin that its body may touch: left, top, right and bottom (px).
    pub(super) fn body_room(&self) -> [f64; 4] {
        let [width, height] = self.tile_size.map(f64::from);
        let beside = (0.085 * width).max(2.0).min(0.25 * width);
        let above = (0.045 * height).max(2.0).min(0.25 * height);
        [beside, above, width - beside, (height - self.below_body).max(0.5 * height)]
    }

    /// The width of the room for words in a tile (px).
    pub(super) fn words_width(&self, scale: Scale) -> f64 {
        f64::from(self.tile_size[0]) - BESIDE * scale.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::{Palette, Theme};
    use crate::picture::caption::Writer;
    use crate::picture::text::Fonts;
    use crate::scene::figure::{Column, Row};

    /// The parts of a sheet of three columns and two rows in words, with a caption of some lines: their rows from top to
    /// bottom and the ends of each from left to right, then the parts without room.
    fn said((size, caption, charts): ([u32; 2], usize, usize)) -> String {
        let run =
            |name: &str| Row { run: name.to_owned(), time: None, label: name.to_owned(), note: "A note".to_owned() };
        let columns = vec![Column { scene: 0, time: Some(0.0), label: None }; 3];
        let rows = vec![run("Local shape"), run("Mass-spring")];
        let (scenes, charts_shown) = (Vec::new(), Vec::new());
        let sheet = Sheet { scenes, columns, rows, charts: charts_shown, number: None, from: 0.0, split: None };
        let scale = Scale::at(crate::look::print::unit_of_sheet(size));
        let (palette, fonts) = (Palette::of(Theme::Light), Fonts::default());
        let writer = Writer::new(&palette, &fonts, scale);
        let labels = RowLabels::new(&sheet, &writer, true, f64::from(size[0]));
        let charts = [charts, 2];
        let wanted = Wanted { titles: [1, caption], is_figure: true, headings: 1, charts, ..Wanted::default() };
        let pitch = 0.2 * f64::from(size[0]);
        let layout = SheetLayout::new(&sheet, (size, scale), wanted, &labels, [100.0 * scale.unit; 2], pitch);
        let parts =
            [Part::Title, Part::Caption, Part::Heading, Part::Words, Part::Label(0), Part::Sample(0), Part::Note(0)];
        let parts = parts.into_iter().chain([Part::Panel, Part::Body, Part::Numbers, Part::Chart]);
        let places = parts.filter_map(|part| Some((part, layout.page.get(part)?)));
        let places = places.map(|(part, [left, top, width, height])| {
            format!("{part:?} {left:.0}–{:.0} × {top:.0}–{:.0}, ", left + width, top + height)
        });
        format!("{}without: {}", places.collect::<String>(), layout::told(&layout.page, &[]).join("; "))
    }

    #[test]
    fn sheets_have_fewer_parts_the_smaller_they_are() {
        let large = "Title 40–1560 × 40–80, Caption 40–1560 × 80–102, Heading 40–1560 × 118–140, Words 40–140 × 140–394, \
                     Label(0) 40–140 × 224–244, Sample(0) 40–140 × 244–256, Note(0) 40–140 × 256–276, \
                     Panel 240–680 × 140–394, Body 240–680 × 140–360, Numbers 240–680 × 360–394, \
                     Chart 40–1560 × 664–784, without: ";
        assert_eq!(said(([1600, 900], 1, 2)), large);
        let tiny = "Title 14–50 × 14–29, Panel 18–28 × 29–43, Body 18–28 × 29–43, without: the caption is cut off; \
                    headings of columns are cut off; rows and charts have no names; panels have no numbers; \
                    the charts are left out";
        assert_eq!(said(([64, 64], 1, 1)), tiny);
        let low = "Title 20–780 × 20–40, Caption 20–780 × 40–51, Heading 20–780 × 70–81, Words 20–70 × 81–162, \
                   Label(0) 20–70 × 100–110, Sample(0) 20–70 × 110–116, Note(0) 20–70 × 116–126, \
                   Panel 120–340 × 81–162, Body 120–340 × 81–145, Numbers 120–340 × 145–162, \
                   Chart 20–780 × 251–298, without: only 5 of 6 charts have room";
        assert_eq!(said(([800, 450], 2, 6)), low);
    }
}
