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

use super::{Area, Colour, MARGIN, MIDDLE, NAME, Room, SECOND_TEXT, SMALL, TEXT, USUAL, write};
use localshape::picture::{Annotation, Axis, Chart, Diagram, Layer, Name, TextStyle};

/// One map.
pub(crate) struct Map {
    /// The heading, and a line below it.
    pub(crate) name: [String; 2],
    /// The places of its columns, rising and logarithmically even.
    pub(crate) across: Vec<f64>,
    /// The places of its rows, rising and even.
    pub(crate) up: Vec<f64>,
    /// How many elements are turned over at the end, column by column from below; `None` where the run diverged.
    pub(crate) cells: Vec<Option<usize>>,
    /// Heights with numbers at the left and at the right.
    pub(crate) ticks: Vec<(f64, [String; 2])>,
    /// Horizontal lines: their heights and names.
    pub(crate) lines: Vec<(f64, &'static str)>,
    /// The names of its axes: across, at the left and at the right.
    pub(crate) axes: [String; 3],
}

/// The room at both sides of a map, and above it for its names (px).
const LEFT: f64 = 44.0;
const RIGHT: f64 = 56.0;
const ABOVE: f64 = 72.0;
pub(super) const ROOM: Room = Room { around: [LEFT, ABOVE, RIGHT, 58.0], shape: 0.5, legend: 40.0 };
/// The size of a square of the legend, the width of lines at limits, and the gap between a map and its words (px).
const SQUARE: f64 = 16.0;
const LIMIT: f64 = 2.4;
const BESIDE: f64 = 8.0;
/// The most numbers across.
const MOST: usize = 9;
/// The colours of cells, of their hatch, and around lines at limits.
const WHOLE: Colour = [0xb9, 0xc7, 0xd6];
const TURNED_OVER: Colour = [0xe2, 0x66, 0x1c];
const HATCHES: Colour = [0x5a, 0x1f, 0x00];
const GROUND: Colour = [0xfb, 0xfb, 0xfa];
const LABEL: TextStyle = TextStyle { size: 14.5, is_bold: true, colour: TEXT, has_halo: true };

/// A kind of cells: which they are, their meaning, and their colour and hatch. As in pictures of bodies, the hatch replaces the colour in
/// grey prints.
type Kind = (fn(Option<usize>) -> bool, &'static str, Colour, Option<Colour>);
const KINDS: [Kind; 3] = [
    (|cell| cell == Some(0), "whole at the end", WHOLE, None),
    (|cell| cell > Some(0), "stable, but elements turned over at the end", TURNED_OVER, Some(HATCHES)),
    (|cell| cell.is_none(), "diverged", SECOND_TEXT, None),
];

/// Draws the meaning of each kind of cell.
pub(super) fn legend(diagram: &mut Diagram, top: f64) {
    let mut left = MARGIN;
    for (_, text, colour, diagonal) in KINDS {
        let axis = Axis::linear([0.0, 1.0], Vec::new());
        let layers = vec![Layer::Tiles { points: vec![[0.5; 2]], counts: [1, 1], colour, diagonal }];
        let chart = Chart { x: axis.clone(), y: axis, layers, annotations: Vec::new() };
        diagram.chart(&chart, [left, top, left + SQUARE, top + SQUARE]);
        left += SQUARE + BESIDE;
        write(diagram, text, USUAL, 0.0, [left, top + 0.5 * SQUARE + MIDDLE * USUAL.size]);
        left += diagram.text_width(text, USUAL) + 3.0 * BESIDE;
    }
}

impl Map {
    pub(super) fn draw(&self, diagram: &mut Diagram, area: Area) {
        let [left, top, right, bottom] = area;
        for (text, style, baseline) in [(&self.name[0], NAME, 24.0), (&self.name[1], SMALL, 43.0)] {
            let text = shortened(diagram, text, style, LEFT + right - left + RIGHT);
            write(diagram, &text, style, 0.0, [left - LEFT, top - ABOVE + baseline]);
        }
        let [across, at_left, at_right] = &self.axes;
        write(diagram, at_left, SMALL, 0.0, [left - LEFT, top - BESIDE]);
        write(diagram, at_right, SMALL, 1.0, [right + RIGHT, top - BESIDE]);
        write(diagram, across, SMALL, 1.0, [right, bottom + 41.0]);
        let logarithms: Vec<_> = self.across.iter().copied().map(libm::log10).collect();
        let Some((x, y)) = ends(&logarithms).zip(ends(&self.up)) else { return };
        let (x, counts) = (x.map(libm::exp10), [self.across.len(), self.up.len()]);
        let at = |number: usize| [self.across[number / counts[1]], self.up[number % counts[1]]];
        let tiles = KINDS.map(|(is_kind, _, colour, diagonal)| {
            let alike = self.cells.iter().enumerate().filter(|(_, cell)| is_kind(**cell));
            Layer::Tiles { points: alike.map(|(number, _)| at(number)).collect(), counts, colour, diagonal }
        });
        let limits = self.lines.iter().enumerate().flat_map(|(number, &(height, _))| {
            let points = x.map(|end| [end, height]).to_vec();
            let dash = if number == 0 { Vec::new() } else { vec![7.0, 4.0] };
            [(GROUND, 2.0 * LIMIT, Vec::new()), (TEXT, LIMIT, dash)].map(|(colour, width, dash)| Layer::Line {
                points: points.clone(),
                colour,
                width,
                dash,
            })
        });
        let names = self.ticks.iter().map(|(height, [_, text])| Name {
            text: text.clone(),
            end: [x[1], *height],
            colour: SECOND_TEXT,
            dash: Vec::new(),
        });
        let chart = Chart {
            x: Axis::logarithmic(x, MOST),
            y: Axis::linear(y, self.ticks.iter().map(|(height, [text, _])| (*height, text.clone())).collect()),
            layers: tiles.into_iter().chain(limits).collect(),
            annotations: vec![Annotation::Names { names: names.collect(), beyond: [SMALL.size; 2] }],
        };
        diagram.chart(&chart, area);
        for &(height, text) in &self.lines {
            let [_, y] = chart.at(area, [x[0], height]);
            write(diagram, text, LABEL, 0.0, [left + BESIDE, y - 5.0]);
        }
    }
}

/// The ends of a row of cells with even middles; `None` without cells.
fn ends(middles: &[f64]) -> Option<[f64; 2]> {
    let (&first, &last) = middles.first().zip(middles.last())?;
    let apart = if middles.len() > 1 { (last - first) / (middles.len() - 1) as f64 } else { 1.0 };
    Some([first - 0.5 * apart, last + 0.5 * apart])
}

/// The text, without its end if it is wider than the room (px).
fn shortened(diagram: &Diagram, text: &str, style: TextStyle, room: f64) -> String {
    let ends = text.char_indices().map(|(at, _)| at).rev();
    let shorter = ends.map(|end| format!("{}…", text[..end].trim_end()));
    let mut texts = [text.to_owned()].into_iter().chain(shorter);
    texts.find(|text| diagram.text_width(text, style) <= room).unwrap_or_default()
}
