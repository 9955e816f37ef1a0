//! The tally: one square for each element, a row for each layer, with the turned-over elements marked, the flat ones
//! hollow and the broken ones pale.

use super::layout::Scale;
use super::layout::steps::{CHART, FREE, MARGIN, RING, SMALL, STRONG, TEXT, TICK};
use super::page::{Path, point};
use super::{Colour, Item};
use crate::look::{BODIES, Palette};
use crate::sim::{Assembly, Dimension};
use glam::DVec3;
use std::ops::Range;

/// Bodies of more elements get a bar instead of squares.
const MOST_SQUARES: usize = 200;
/// The height of all rows together: three squares with gaps (px in the reference picture).
pub(super) const HEIGHT: f64 = 3.0 * RING + 2.0 * FREE;
/// The rim of a hollow square, relative to its side.
const RIM: f64 = 0.14;

/// The elements of each body in rows, highest layer first; each row in the order of the elements.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tally {
    blocks: Vec<BodyTally>,
    /// The number of elements.
    count: usize,
    dimension: Dimension,
}

/// The elements of one body.
#[derive(Clone, Debug, PartialEq)]
struct BodyTally {
    elements: Range<usize>,
    /// The elements in rows; empty if the tally is a bar.
    rows: Vec<Vec<usize>>,
    /// Whether each row is a layer.
    are_layers: bool,
}

impl BodyTally {
    /// Groups the elements of a body into layers of equal height at rest. Bodies without such layers get rows of equal
    /// length.
    fn new(bodies: &Assembly, body: usize, side: f64) -> Self {
        let (whole, range) = (bodies.whole(), bodies.elements(body));
        let count = range.len();
        let height = |element: usize| {
            let nodes = &whole.elements()[element];
            nodes.iter().map(|&node| whole.rest()[node as usize]).sum::<DVec3>().y / nodes.len() as f64
        };
        let mut elements: Vec<usize> = range.clone().collect();
        elements.sort_by(|&a, &b| height(b).total_cmp(&height(a)).then(a.cmp(&b)));
        let mut rows: Vec<Vec<usize>> = Vec::new();
        for &element in &elements {
            match rows.last_mut() {
                Some(row) if height(row[0]) - height(element) < 0.25 * side => row.push(element),
                _ => rows.push(vec![element]),
            }
        }
        rows.iter_mut().for_each(|row| row.sort_unstable());
        let even = rows.iter().all(|row| row.len() == rows[0].len());
        let are_layers = even && rows.len() <= 12;
        if !are_layers {
            let columns = if count <= 9 { count } else { count.div_ceil((count as f64 / 3.0).sqrt().ceil() as usize) };
            elements.sort_unstable();
            rows = elements.chunks(columns.max(1)).map(<[usize]>::to_vec).collect();
        }
        Self { elements: range, rows, are_layers }
    }

    /// The number of squares in its longest row.
    fn columns(&self) -> usize {
        self.rows.iter().map(Vec::len).max().unwrap_or(0)
    }
}

impl Tally {
    /// The tally of some bodies, with cells of a side (m).
    pub(super) fn new(bodies: &Assembly, side: f64) -> Self {
        let count = bodies.whole().elements().len();
        let blocks = (0..bodies.bodies().len()).map(|body| BodyTally::new(bodies, body, side)).collect();
        let tally = Self { blocks, count, dimension: bodies.whole().dimension() };
        if count > MOST_SQUARES { tally.as_bar() } else { tally }
    }

    /// The tally as bars.
    pub(super) fn as_bar(&self) -> Self {
        let bar =
            |block: &BodyTally| BodyTally { elements: block.elements.clone(), rows: Vec::new(), are_layers: false };
        Self { blocks: self.blocks.iter().map(bar).collect(), ..*self }
    }

    /// Whether it has squares in rows, if they have room.
    pub(super) fn has_rows(&self) -> bool {
        self.blocks.iter().any(|block| !block.rows.is_empty())
    }

    /// Whether its rows are several layers of bodies.
    pub(super) fn has_layers(&self) -> bool {
        self.blocks.iter().all(|block| block.are_layers) && self.blocks.iter().any(|block| block.rows.len() > 1)
    }

    /// The number of elements of each body in a state, such as turned over.
    pub(super) fn counts<'a>(&'a self, state: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
        self.blocks.iter().map(|block| state.get(block.elements.clone()).map_or(0, count))
    }

    /// The number of elements of each body.
    pub(super) fn sizes(&self) -> Vec<usize> {
        self.blocks.iter().map(|block| block.elements.len()).collect()
    }

    /// Its width in a room (px).
    pub(super) fn width(&self, scale: Scale, room: f64) -> f64 {
        match self.squares(scale, room) {
            Some([side, gap]) => self.columns() as f64 * (side + gap) - gap,
            None if self.count == 0 => 0.0,
            None => (CHART * scale.type_unit()).min(room).round(),
        }
    }

    /// The number of columns of all bodies, with an empty one between two bodies.
    fn columns(&self) -> usize {
        self.blocks.iter().map(BodyTally::columns).sum::<usize>() + self.blocks.len().saturating_sub(1)
    }

    /// The number of rows of the body with the most.
    fn rows(&self) -> usize {
        self.blocks.iter().map(|block| block.rows.len()).max().unwrap_or(0)
    }

    /// Draws the tally with its lower left corner at a place (px). `states` tells the turned-over, the flat and the broken elements.
    pub(super) fn draw(
        &self,
        states: [&[bool]; 3],
        palette: &Palette,
        scale: Scale,
        room: f64,
        corner: [f64; 2],
        marks: &mut Vec<Item>,
    ) {
        match self.squares(scale, room) {
            Some(lengths) => {
                // Few rows are centred in the height of three.
                let taken = self.rows() as f64 * (lengths[0] + lengths[1]) - lengths[1];
                let raised = ((HEIGHT * scale.type_unit() - taken) / 2.0).max(0.0);
                self.draw_squares(states, palette, lengths, [corner[0], corner[1] - raised], marks)
            }
            None => self.draw_bar(states, palette, scale, room, corner, marks),
        }
    }

    /// Side of the squares and the gap between them in a room (px), if squares fit; else each body has a bar.
    pub(super) fn squares(&self, scale: Scale, room: f64) -> Option<[f64; 2]> {
        let [columns, rows] = [self.columns(), self.rows()].map(|count| count as f64);
        if rows == 0.0 {
            return None;
        }
        let gap: f64 = if rows > 3.0 || columns > 14.0 { STRONG } else { FREE };
        let unit = scale.type_unit();
        let wide = (room / unit).min(5.0 * MARGIN);
        let side = ((HEIGHT + gap) / rows - gap).min((wide + gap) / columns - gap).min(TEXT);
        // Whole pixels keep all squares alike.
        let (pixels, gap) = ((side * unit).round(), (gap * unit).round().max(1.0));
        let fits = |pixels: &f64| *pixels >= 2.0 && columns * (pixels + gap) - gap <= room;
        let pixels = [pixels, pixels - 1.0].into_iter().find(fits)?;
        (side >= TICK).then_some([pixels, gap])
    }

    fn draw_squares(
        &self,
        states: [&[bool]; 3],
        palette: &Palette,
        [side, gap]: [f64; 2],
        [left, bottom]: [f64; 2],
        marks: &mut Vec<Item>,
    ) {
        let (mut left, bottom) = (left.round(), bottom.round());
        for (block, plain) in self.blocks.iter().zip(self.colours(palette)) {
            for (up, row) in block.rows.iter().rev().enumerate() {
                for (along, &element) in row.iter().enumerate() {
                    let [over, flat, broken] = states.map(|state| state.get(element).copied().unwrap_or(false));
                    let x = left + along as f64 * (side + gap);
                    let square = [x, bottom - side - up as f64 * (side + gap), side, side];
                    let colour = if broken { palette.hairline } else { plain };
                    if flat {
                        marks.extend(hollow(square, palette));
                    } else {
                        marks.push(if over { struck(square, palette) } else { Item::rectangle(square, colour) });
                    }
                }
            }
            left += (block.columns() + 1) as f64 * (side + gap);
        }
    }

    /// The colours of sound elements: that of the tally for one body, and those of the bodies for several.
    fn colours(&self, palette: &Palette) -> impl Iterator<Item = Colour> {
        let colours = match self.dimension {
            _ if self.blocks.len() == 1 => [palette.tally; BODIES],
            Dimension::Plane => palette.bodies_flat,
            Dimension::Space => palette.bodies,
        };
        colours.into_iter().cycle()
    }

    fn draw_bar(
        &self,
        states: [&[bool]; 3],
        palette: &Palette,
        scale: Scale,
        room: f64,
        [left, bottom]: [f64; 2],
        marks: &mut Vec<Item>,
    ) {
        let (width, height) = (self.width(scale, room), (SMALL * scale.type_unit()).round().max(1.0));
        let top = (bottom - (HEIGHT - SMALL) / 2.0 * scale.type_unit() - height).round();
        let gap = (FREE * scale.type_unit()).round();
        // Each body has its share of the width.
        let free = (width - gap * self.blocks.len().saturating_sub(1) as f64).max(0.0);
        let (mut left, mut before) = (left.round(), 0);
        for (block, plain) in self.blocks.iter().zip(self.colours(palette)) {
            let all = block.elements.len();
            let place = |elements: usize| (free * elements as f64 / self.count.max(1) as f64).round();
            let width = place(before + all) - place(before);
            before += all;
            // A single element among thousands is visible.
            let [over, flat, broken] = states.map(|state| match state.get(block.elements.clone()).map_or(0, count) {
                0 => 0.0,
                count => (width * count as f64 / all as f64).max(2.0).min(width).round(),
            });
            let flat = flat.min(width - over);
            let broken = broken.min(width - over - flat);
            let bar = |length, colour: Colour| Item::rectangle([left, top, length, height], colour);
            if width > 0.0 {
                marks.push(bar(width, plain));
            }
            if broken > 0.0 {
                marks.push(Item::rectangle([left + width - broken, top, broken, height], palette.hairline));
            }
            if flat > 0.0 {
                marks.extend(hollow([left + over, top, flat, height], palette));
            }
            if over > 0.0 {
                marks.push(bar(over, palette.alarm));
            }
            left += width + gap;
        }
    }
}

/// The number of elements in a state.
fn count(state: &[bool]) -> usize {
    state.iter().filter(|&&is_so| is_so).count()
}

/// A hollow rectangle, the sign of flat elements.
pub(in crate::picture) fn hollow([left, top, width, height]: [f64; 4], palette: &Palette) -> [Item; 2] {
    let rim = (RIM * height).round().max(1.0).min(width / 2.0);
    let inside = [left + rim, top + rim, width - 2.0 * rim, height - 2.0 * rim];
    [Item::rectangle([left, top, width, height], palette.axis), Item::rectangle(inside, palette.background)]
}

/// A square with a rising diagonal, the sign of turned-over elements.
pub(in crate::picture) fn struck(rectangle: [f64; 4], palette: &Palette) -> Item {
    /// Half the width of the diagonal along the sides, relative to them.
    const HALF: f64 = 0.127;
    let [left, top, width, height] = rectangle;
    let (x, y) = (HALF * width, HALF * height);
    let line = [[width - x, 0.0], [width, 0.0], [width, y], [x, height], [0.0, height], [0.0, height - y]];
    let path = Path::polygon(&line.map(|[x, y]| point([left + x, top + y].into())));
    Item::part("struck", [Item::rectangle(rectangle, palette.alarm), Item::fill(path, palette.alarm_line)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole pixels must not be more than there is room for: squares ran into the number beside them.
    #[test]
    fn squares_keep_to_their_room() {
        for columns in 1..=MOST_SQUARES {
            let block = BodyTally { elements: 0..columns, rows: vec![(0..columns).collect()], are_layers: true };
            let tally = Tally { blocks: vec![block], count: columns, dimension: Dimension::Space };
            for (room, unit) in
                (20..200).step_by(7).flat_map(|room| [0.6, 0.86, 1.0, 1.4].map(|unit| (f64::from(room), unit)))
            {
                let scale = Scale::at(unit);
                let (width, squares) = (tally.width(scale, room), tally.squares(scale, room));
                assert!(width <= room, "{columns} squares take {width} of {room} px");
                assert!(squares.is_some() || columns > 3 || room < 60.0, "{room} px have room for {columns} squares");
            }
        }
    }
}
