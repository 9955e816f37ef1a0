//! Maps of outcomes: rectangles of cells over stiffness and step, with lines at predicted limits.
//!
//! ```text
//! title
//! caption
//! ■ whole  ■ turned over  ■ diverged
//! name of a map
//! what it is of
//! share ┌────────────┐ step
//!   1.0 │■■■■■■■■■■■■│ T/9
//!       │- - limit - │
//!   0.5 │■■■■■■■■■■■■│ T/18
//!       └──┼────┼────┘
//!         10³  10⁴
//! ```

use super::{
    CAPTION, Colour, GROUND, LINE, MARGIN, MIDDLE, Page, SECOND_TEXT, SMALL, Sketch, TEXT, USUAL, WIDE, power_of_ten,
};

/// The colours of cells, of their hatch, and of lines at limits.
const WHOLE: Colour = [0xb9, 0xc7, 0xd6];
const TURNED_OVER: Colour = [0xe2, 0x66, 0x1c];
const HATCHES: Colour = [0x5a, 0x1f, 0x00];

/// Several maps on one page.
pub(crate) struct Maps {
    /// The title.
    pub(crate) title: String,
    /// Lines below it.
    pub(crate) caption: Vec<String>,
    /// The maps, in rows of [`Self::columns`].
    pub(crate) maps: Vec<Map>,
    /// How many stand beside each other.
    pub(crate) columns: usize,
}

/// One map.
pub(crate) struct Map {
    /// What it shows, and a line below that.
    pub(crate) name: [String; 2],
    /// Where its columns are, rising and logarithmically even.
    pub(crate) across: Vec<f64>,
    /// Where its rows are, rising and even.
    pub(crate) up: Vec<f64>,
    /// The cells, column by column from below.
    pub(crate) cells: Vec<Tile>,
    /// Heights with numbers at the left and at the right.
    pub(crate) ticks: Vec<(f64, [String; 2])>,
    /// Heights of lines: where, and what it is called.
    pub(crate) lines: Vec<(f64, &'static str)>,
    /// The names of its axes: across, at the left and at the right.
    pub(crate) axes: [String; 3],
}

/// What a cell shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tile {
    Whole,
    TurnedOver,
    Diverged,
}

/// Room between maps, and for what is written at the left and the right of a map (px).
const BETWEEN: f64 = 30.0;
const LEFT: f64 = 44.0;
const RIGHT: f64 = 56.0;
/// The size of a square of the legend (px).
const SQUARE: f64 = 16.0;
/// Above a map for its names, its height in parts of its width, and room below it (px).
const NAMES: f64 = 72.0;
const SHAPE: f64 = 0.5;
const BELOW: f64 = 58.0;
/// Between cells, widths of hatches and of lines at limits, and from a map to what is written beside it (px).
const GAP: f64 = 1.0;
const HATCH: f64 = 1.6;
const LIMIT: f64 = 2.4;
const BESIDE: f64 = 8.0;

impl Page for Maps {
    fn title(&self) -> &str {
        &self.title
    }

    fn caption(&self) -> &[String] {
        &self.caption
    }

    fn size(&self) -> [u32; 2] {
        let rows = self.maps.len().div_ceil(self.columns) as f64;
        let high = self.top() + rows * (NAMES + SHAPE * self.wide() + BELOW);
        [WIDE as u32, high.round() as u32]
    }

    fn draw(&self, sketch: &mut Sketch) {
        self.legend(sketch);
        let (wide, high) = (self.wide(), SHAPE * self.wide());
        for (at, map) in self.maps.iter().enumerate() {
            let (column, row) = ((at % self.columns) as f64, (at / self.columns) as f64);
            let left = MARGIN + LEFT + column * (LEFT + wide + RIGHT + BETWEEN);
            let top = self.top() + NAMES + row * (NAMES + high + BELOW);
            map.draw(sketch, [left, top, wide, high]);
        }
    }
}

impl Maps {
    /// Where the maps begin (px).
    fn top(&self) -> f64 {
        self.legend_top() + SQUARE + 12.0
    }

    fn legend_top(&self) -> f64 {
        CAPTION + LINE * self.caption.len() as f64
    }

    /// The width of a map (px).
    fn wide(&self) -> f64 {
        let columns = self.columns as f64;
        (WIDE - 2.0 * MARGIN - columns * (LEFT + RIGHT) - (columns - 1.0) * BETWEEN) / columns
    }

    /// What each kind of cell means.
    fn legend(&self, sketch: &mut Sketch) {
        let (top, mut left) = (self.legend_top(), MARGIN);
        for (tile, text) in [
            (Tile::Whole, "whole at the end"),
            (Tile::TurnedOver, "stable, but elements turned over at the end"),
            (Tile::Diverged, "diverged"),
        ] {
            tile.draw(sketch, [left, top, SQUARE, SQUARE]);
            left += SQUARE + BESIDE;
            sketch.left(text, USUAL, false, TEXT, [left, top + 0.5 * SQUARE + MIDDLE * USUAL]);
            left += sketch.width(text, USUAL, false) + 3.0 * BESIDE;
        }
    }
}

impl Tile {
    fn draw(self, sketch: &mut Sketch, [left, top, wide, high]: [f64; 4]) {
        sketch.rectangle([left, top, wide, high], self.colour());
        // As in pictures of bodies, the hatch tells in grey what the colour does.
        if self == Self::TurnedOver {
            let inset = 0.2 * wide.min(high);
            let ends = [[left + inset, top + high - inset], [left + wide - inset, top + inset]];
            sketch.line(&ends, HATCH, HATCHES);
        }
    }

    fn colour(self) -> Colour {
        match self {
            Self::Whole => WHOLE,
            Self::TurnedOver => TURNED_OVER,
            Self::Diverged => SECOND_TEXT,
        }
    }
}

impl Map {
    /// Draws the map in an area: left, top, width and height (px).
    fn draw(&self, sketch: &mut Sketch, [left, top, wide, high]: [f64; 4]) {
        let [name, more] = &self.name;
        for (text, size, is_bold, colour, baseline) in
            [(name, USUAL, true, TEXT, 24.0), (more, SMALL, false, SECOND_TEXT, 43.0)]
        {
            let text = sketch.shortened(text, size, is_bold, LEFT + wide + RIGHT);
            sketch.left(&text, size, is_bold, colour, [left - LEFT, top - NAMES + baseline]);
        }
        let [across, at_left, at_right] = &self.axes;
        sketch.left(at_left, SMALL, false, SECOND_TEXT, [left - LEFT, top - BESIDE]);
        sketch.right(at_right, SMALL, SECOND_TEXT, [left + wide + RIGHT, top - BESIDE]);
        sketch.right(across, SMALL, SECOND_TEXT, [left + wide, top + high + 41.0]);
        let (columns, rows) = (self.across.len(), self.up.len());
        if columns == 0 || rows == 0 {
            return;
        }
        let [column, row] = [wide / columns as f64, high / rows as f64];
        // To whole pixels, so that all gaps are alike.
        let x = |at: usize| (left + column * at as f64).round();
        let y = |at: usize| (top + high - row * at as f64).round();
        for (number, tile) in self.cells.iter().enumerate() {
            let (at, up) = (number / rows, number % rows);
            tile.draw(sketch, [x(at), y(up + 1), x(at + 1) - x(at) - GAP, y(up) - y(up + 1) - GAP]);
        }
        let apart = if rows > 1 { self.up[1] - self.up[0] } else { self.up[0] };
        let height = |value: f64| top + high - row * ((value - self.up[0]) / apart + 0.5);
        for (value, [before, after]) in &self.ticks {
            let baseline = height(*value) + MIDDLE * SMALL;
            sketch.right(before, SMALL, SECOND_TEXT, [left - BESIDE, baseline]);
            sketch.left(after, SMALL, false, SECOND_TEXT, [left + wide + BESIDE, baseline]);
        }
        for (number, &(value, text)) in self.lines.iter().enumerate() {
            let line = [[left, height(value)], [left + wide, height(value)]];
            let dash: &[f64] = if number == 0 { &[] } else { &[7.0, 4.0] };
            sketch.line(&line, 2.0 * LIMIT, GROUND);
            sketch.dashed(&line, LIMIT, TEXT, dash);
            sketch.label(text, TEXT, [left + BESIDE, height(value) - 5.0]);
        }
        let logarithms = [self.across[0], self.across[columns - 1]].map(libm::log10);
        let step = if columns > 1 { (logarithms[1] - logarithms[0]) / (columns - 1) as f64 } else { 1.0 };
        let powers = libm::ceil(logarithms[0] - 1e-9) as i32..=libm::floor(logarithms[1] + 1e-9) as i32;
        for power in powers {
            let middle = left + column * ((f64::from(power) - logarithms[0]) / step + 0.5);
            let text = power_of_ten(power);
            sketch.centred(&text, SMALL, SECOND_TEXT, [middle, top + high + 20.0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Drawn;
    use super::super::tests::curves;
    use super::*;

    #[test]
    fn all_is_on_the_page() {
        let map = |columns: usize, rows: usize| Map {
            name: ["A run".to_owned(), "what it is of, ".repeat(20)],
            across: (0..columns).map(|at| libm::exp10(3.0 + at as f64 / 4.0)).collect(),
            up: (0..rows).map(|at| 0.05 + 0.1 * at as f64).collect(),
            cells: (0..columns * rows).map(|at| [Tile::Whole, Tile::TurnedOver, Tile::Diverged][at % 3]).collect(),
            ticks: vec![(0.5, ["0.5".to_owned(), "T/18".to_owned()])],
            lines: vec![(1.0, "predicted limit"), (0.7, "stretched")],
            axes: ["k/m (1/s²)", "share", "step"].map(str::to_owned),
        };
        let page = Maps {
            title: "Maps".to_owned(),
            caption: vec!["one line".to_owned()],
            maps: vec![map(13, 12), map(1, 1), map(0, 0)],
            columns: 2,
        };
        assert!(page.size()[1] > 600 && !curves(&page).is_empty());
        let rectangles = page.sketch().drawn.iter().filter(|one| matches!(one, Drawn::Rectangle)).count();
        // One for each cell, and three in the legend.
        assert_eq!(rectangles, 13 * 12 + 1 + 3);
    }
}
