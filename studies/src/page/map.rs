//! Maps of outcomes: rectangles of cells over stiffness and step, with lines at predicted limits.
//!
//! ```text
//! ■ whole  ■ turned over  ■ diverged
//! name of a map
//! more about it
//! share ┌────────────┐ step
//!   1.0 │■■■■■■■■■■■■│ T/9
//!       │- - limit - │
//!   0.5 │■■■■■■■■■■■■│ T/18
//!       └──┼────┼────┘
//!         10³  10⁴
//! ```

use super::{Area, Colour, MARGIN, MIDDLE, NAME, Room, SECOND_TEXT, SMALL, TEXT, USUAL, power_of_ten, write};
use localshape::picture::{Diagram, TextStyle};

/// One map.
pub(crate) struct Map {
    /// The heading, and a line below it.
    pub(crate) name: [String; 2],
    /// The places of its columns, rising and logarithmically even.
    pub(crate) across: Vec<f64>,
    /// The places of its rows, rising and even.
    pub(crate) up: Vec<f64>,
    /// The cells, column by column from below.
    pub(crate) cells: Vec<Tile>,
    /// Heights with numbers at the left and at the right.
    pub(crate) ticks: Vec<(f64, [String; 2])>,
    /// Horizontal lines: their heights and names.
    pub(crate) lines: Vec<(f64, &'static str)>,
    /// The names of its axes: across, at the left and at the right.
    pub(crate) axes: [String; 3],
}

/// The outcome in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tile {
    Whole,
    TurnedOver,
    Diverged,
}

/// The room at both sides of a map, and above it for its names (px).
const LEFT: f64 = 44.0;
const RIGHT: f64 = 56.0;
const ABOVE: f64 = 72.0;
pub(super) const ROOM: Room = Room { around: [LEFT, ABOVE, RIGHT, 58.0], shape: 0.5, legend: 40.0 };
/// The size of a square of the legend (px).
const SQUARE: f64 = 16.0;
/// The gap between cells, the widths of hatches and of lines at limits, and the gap between a map and its words (px).
const GAP: f64 = 1.0;
const HATCH: f64 = 1.6;
const LIMIT: f64 = 2.4;
const BESIDE: f64 = 8.0;
/// The colours of cells, of their hatch, and around lines at limits.
const WHOLE: Colour = [0xb9, 0xc7, 0xd6];
const TURNED_OVER: Colour = [0xe2, 0x66, 0x1c];
const HATCHES: Colour = [0x5a, 0x1f, 0x00];
const GROUND: Colour = [0xfb, 0xfb, 0xfa];
const LABEL: TextStyle = TextStyle { size: 14.5, is_bold: true, colour: TEXT, has_halo: true };

/// Draws the meaning of each kind of cell.
pub(super) fn legend(diagram: &mut Diagram, top: f64) {
    let mut left = MARGIN;
    for (tile, text) in [
        (Tile::Whole, "whole at the end"),
        (Tile::TurnedOver, "stable, but elements turned over at the end"),
        (Tile::Diverged, "diverged"),
    ] {
        tile.draw(diagram, [left, top, SQUARE, SQUARE]);
        left += SQUARE + BESIDE;
        write(diagram, text, USUAL, 0.0, [left, top + 0.5 * SQUARE + MIDDLE * USUAL.size]);
        left += diagram.text_width(text, USUAL) + 3.0 * BESIDE;
    }
}

impl Tile {
    /// Draws the tile in a rectangle: left, top, width and height (px).
    fn draw(self, diagram: &mut Diagram, [left, top, wide, high]: [f64; 4]) {
        let colour = match self {
            Self::Whole => WHOLE,
            Self::TurnedOver => TURNED_OVER,
            Self::Diverged => SECOND_TEXT,
        };
        diagram.rectangle([left, top, wide, high], colour);
        // As in pictures of bodies, the hatch replaces the colour in grey prints.
        if self == Self::TurnedOver {
            let inset = 0.2 * wide.min(high);
            let ends = [[left + inset, top + high - inset], [left + wide - inset, top + inset]];
            diagram.curve(&ends, HATCH, HATCHES, &[]);
        }
    }
}

impl Map {
    pub(super) fn draw(&self, diagram: &mut Diagram, [left, top, right, bottom]: Area) {
        for (text, style, baseline) in [(&self.name[0], NAME, 24.0), (&self.name[1], SMALL, 43.0)] {
            let text = shortened(diagram, text, style, LEFT + right - left + RIGHT);
            write(diagram, &text, style, 0.0, [left - LEFT, top - ABOVE + baseline]);
        }
        let [across, at_left, at_right] = &self.axes;
        write(diagram, at_left, SMALL, 0.0, [left - LEFT, top - BESIDE]);
        write(diagram, at_right, SMALL, 1.0, [right + RIGHT, top - BESIDE]);
        write(diagram, across, SMALL, 1.0, [right, bottom + 41.0]);
        let (columns, rows) = (self.across.len(), self.up.len());
        if columns == 0 || rows == 0 {
            return;
        }
        let [column, row] = [(right - left) / columns as f64, (bottom - top) / rows as f64];
        // Whole pixels make all gaps equal.
        let x = |at: usize| (left + column * at as f64).round();
        let y = |at: usize| (bottom - row * at as f64).round();
        for (number, tile) in self.cells.iter().enumerate() {
            let (at, up) = (number / rows, number % rows);
            tile.draw(diagram, [x(at), y(up + 1), x(at + 1) - x(at) - GAP, y(up) - y(up + 1) - GAP]);
        }
        let apart = if rows > 1 { self.up[1] - self.up[0] } else { self.up[0] };
        let height = |value: f64| bottom - row * ((value - self.up[0]) / apart + 0.5);
        for (value, [before, after]) in &self.ticks {
            let baseline = height(*value) + MIDDLE * SMALL.size;
            write(diagram, before, SMALL, 1.0, [left - BESIDE, baseline]);
            write(diagram, after, SMALL, 0.0, [right + BESIDE, baseline]);
        }
        for (number, &(value, text)) in self.lines.iter().enumerate() {
            let line = [[left, height(value)], [right, height(value)]];
            let dash: &[f64] = if number == 0 { &[] } else { &[7.0, 4.0] };
            diagram.curve(&line, 2.0 * LIMIT, GROUND, &[]);
            diagram.curve(&line, LIMIT, TEXT, dash);
            write(diagram, text, LABEL, 0.0, [left + BESIDE, height(value) - 5.0]);
        }
        let logarithms = [self.across[0], self.across[columns - 1]].map(libm::log10);
        let step = if columns > 1 { (logarithms[1] - logarithms[0]) / (columns - 1) as f64 } else { 1.0 };
        let powers = libm::ceil(logarithms[0] - 1e-9) as i32..=libm::floor(logarithms[1] + 1e-9) as i32;
        for power in powers {
            let middle = left + column * ((f64::from(power) - logarithms[0]) / step + 0.5);
            write(diagram, &power_of_ten(power), SMALL, 0.5, [middle, bottom + 20.0]);
        }
    }
}

/// The text, without its end if it is wider than the room (px).
fn shortened(diagram: &Diagram, text: &str, style: TextStyle, room: f64) -> String {
    let ends = text.char_indices().map(|(at, _)| at).rev();
    let shorter = ends.map(|end| format!("{}…", text[..end].trim_end()));
    let mut texts = [text.to_owned()].into_iter().chain(shorter);
    texts.find(|text| diagram.text_width(text, style) <= room).unwrap_or_default()
}
