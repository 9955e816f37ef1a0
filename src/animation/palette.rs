//! Colour quantisation: a palette for all frames of an animation, and dithering of pictures with it.
//!
//! Colours are counted in cells of 4×4×4 levels. Boxes of cells are divided, the least uniform one first, as in P.
//! Heckbert, *Color Image Quantization for Frame Buffer Display*, SIGGRAPH 1982, but in Oklab, where equal distances
//! look about equal. Then each colour is moved to the mean of the nearest cells (k-means).

use super::Image;
use crate::colour::{Colour, Oklab, from_oklab, oklab};

/// Bits of each channel that select a cell.
const BITS: u32 = 6;
const CELLS: usize = 1 << (3 * BITS);
/// Colours of a palette. One more index means an unchanged pixel.
const MOST: usize = 255;
/// Iterations of k-means.
const ROUNDS: usize = 6;
/// Exponent of the weight of a colour by its number of pixels: with 1 a large background would take all colours.
const POWER: f64 = 0.4;
/// Colours nearer than this in Oklab look the same side by side, and are not dithered.
const NEAR: f64 = 0.012;
/// Weight of the difference of the two colours of a mixture, as it makes the dither pattern visible.
const GRAIN: f64 = 0.15;
/// Number of steps of a mixture.
const LEVELS: f64 = 64.0;

fn cell(pixel: [u8; 3]) -> usize {
    let [r, g, b] = pixel.map(|byte| usize::from(byte >> (8 - BITS)));
    r << (2 * BITS) | g << BITS | b
}

/// The number of pixels of each colour.
pub(super) struct Counts {
    /// For each cell the number of pixels and the sums of their channels.
    cells: Vec<[u64; 4]>,
}

impl Counts {
    pub(super) fn new() -> Self {
        Self { cells: vec![[0; 4]; CELLS] }
    }

    /// The cells of a picture that are not empty.
    pub(super) fn of(image: &Image) -> Vec<(u32, [u64; 4])> {
        let mut cells = Self::new().cells;
        for &pixel in image.pixels.as_chunks::<3>().0 {
            let [count, sums @ ..] = &mut cells[cell(pixel)];
            *count += 1;
            sums.iter_mut().zip(pixel).for_each(|(sum, byte)| *sum += u64::from(byte));
        }
        let filled = cells.iter().enumerate().filter(|(_, sums)| sums[0] > 0);
        filled.map(|(at, sums)| (at as u32, *sums)).collect()
    }

    pub(super) fn add(&mut self, more: &[(u32, [u64; 4])]) {
        for (at, sums) in more {
            (0..4).for_each(|number| self.cells[*at as usize][number] += sums[number]);
        }
    }

    /// The palette for these colours.
    pub(super) fn palette(&self) -> Palette {
        let filled = self.cells.iter().enumerate().filter(|(_, sums)| sums[0] > 0);
        let cells: Vec<Cell> = filled
            .map(|(at, &[count, r, g, b])| {
                let mean = [r, g, b].map(|sum| ((2 * sum + count) / (2 * count)) as u8);
                Cell { at, mean, lab: oklab(mean), count, weight: libm::pow(count as f64, POWER) }
            })
            .collect();
        let colours = chosen(&cells);
        let labs: Vec<Oklab> = colours.iter().map(|&colour| oklab(colour)).collect();
        let mut mixtures = vec![Mixture::default(); CELLS];
        cells.iter().for_each(|cell| mixtures[cell.at] = Mixture::of(cell.lab, &labs));
        Palette { colours, mixtures }
    }
}

/// The colours of a cell.
struct Cell {
    at: usize,
    mean: Colour,
    lab: Oklab,
    count: u64,
    weight: f64,
}

/// The sum of weights and the mean of some cells.
fn mean<'a>(cells: impl Iterator<Item = &'a Cell>) -> (f64, [f64; 3]) {
    let (mut weight, mut sums) = (0.0, [0.0; 3]);
    for cell in cells {
        weight += cell.weight;
        (0..3).for_each(|axis| sums[axis] += cell.weight * cell.lab.0[axis]);
    }
    (weight, sums.map(|sum| sum / weight))
}

/// The axis along which cells differ most, by how much, and their mean on it.
fn spread(cells: &[Cell], members: &[usize]) -> (usize, f64, f64) {
    let (_, middle) = mean(members.iter().map(|&at| &cells[at]));
    let squares = |axis: usize| {
        let off = |at: &usize| (cells[*at].lab.0[axis] - middle[axis]).powi(2) * cells[*at].weight;
        members.iter().map(off).sum::<f64>()
    };
    let along: [f64; 3] = std::array::from_fn(squares);
    let most = (0..3).max_by(|&one, &other| along[one].total_cmp(&along[other])).unwrap_or(0);
    (most, along[most], middle[most])
}

/// The colours of a palette.
fn chosen(cells: &[Cell]) -> Vec<Colour> {
    if cells.len() <= MOST {
        return cells.iter().map(|cell| cell.mean).collect();
    }
    let whole: Vec<usize> = (0..cells.len()).collect();
    let mut boxes = vec![(spread(cells, &whole), whole)];
    while boxes.len() < MOST {
        let widest = (0..boxes.len()).max_by(|&one, &other| boxes[one].0.1.total_cmp(&boxes[other].0.1));
        let ((axis, _, middle), members) = boxes.swap_remove(widest.unwrap_or(0));
        let (low, high): (Vec<_>, Vec<_>) = members.into_iter().partition(|&at| cells[at].lab.0[axis] < middle);
        // A box of one colour has an empty half. There are more cells than colours, so another box can be divided.
        for half in [low, high].into_iter().filter(|half| !half.is_empty()) {
            boxes.push((spread(cells, &half), half));
        }
    }
    let mut centres: Vec<Oklab> =
        boxes.iter().map(|(_, members)| Oklab(mean(members.iter().map(|&at| &cells[at])).1)).collect();
    let mut nearest = Vec::new();
    for _ in 0..ROUNDS {
        nearest = cells.iter().map(|cell| nearest_of(cell.lab, &centres)).collect::<Vec<_>>();
        let mut sums = vec![(0.0, [0.0; 3]); centres.len()];
        for (cell, &at) in cells.iter().zip(&nearest) {
            sums[at].0 += cell.weight;
            (0..3).for_each(|axis| sums[at].1[axis] += cell.weight * cell.lab.0[axis]);
        }
        for (centre, (weight, sum)) in centres.iter_mut().zip(sums) {
            if weight > 0.0 {
                *centre = Oklab(sum.map(|sum| sum / weight));
            }
        }
    }
    // A centre takes the exact colour that most of its pixels have: the background should match that of a page.
    let mut of: Vec<(u64, u64, usize)> = vec![(0, 0, 0); centres.len()];
    for (at, (cell, &centre)) in cells.iter().zip(&nearest).enumerate() {
        let (all, most, which) = &mut of[centre];
        *all += cell.count;
        if cell.count > *most {
            (*most, *which) = (cell.count, at);
        }
    }
    let colour = |(centre, (all, most, which)): (&Oklab, &(u64, u64, usize))| {
        if *most > 0 && 2 * most >= *all { cells[*which].mean } else { from_oklab(*centre) }
    };
    centres.iter().zip(&of).map(colour).collect()
}

fn square(one: Oklab, other: Oklab) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| one.0[axis] - other.0[axis]);
    x * x + y * y + z * z
}

fn nearest_of(colour: Oklab, all: &[Oklab]) -> usize {
    let mut best = (f64::INFINITY, 0);
    for (at, &other) in all.iter().enumerate() {
        let far = square(colour, other);
        if far < best.0 {
            best = (far, at);
        }
    }
    best.1
}

/// A colour of the palette, or a mixture of two, for a colour that is not in the palette.
#[derive(Clone, Copy, Default)]
struct Mixture {
    one: u8,
    other: u8,
    /// How many of 64 pixels have the second colour.
    share: u8,
}

impl Mixture {
    fn of(colour: Oklab, palette: &[Oklab]) -> Self {
        let one = nearest_of(colour, palette);
        let mut best = (square(colour, palette[one]), one, 0.0);
        if best.0 > NEAR * NEAR {
            for (other, &to) in palette.iter().enumerate() {
                let apart = square(palette[one], to);
                if apart == 0.0 {
                    continue;
                }
                let along: f64 = (0..3)
                    .map(|axis| (colour.0[axis] - palette[one].0[axis]) * (to.0[axis] - palette[one].0[axis]))
                    .sum();
                let share = (along / apart).clamp(0.0, 0.5);
                let from = palette[one].0;
                let mixed = Oklab(std::array::from_fn(|axis| from[axis] + share * (to.0[axis] - from[axis])));
                let error = square(colour, mixed) + GRAIN * share * (1.0 - share) * apart;
                if error < best.0 {
                    best = (error, other, share);
                }
            }
        }
        let (_, other, share) = best;
        Self { one: one as u8, other: other as u8, share: (share * LEVELS).round() as u8 }
    }
}

/// The order in which the pixels of an 8×8 square get the second colour (B. Bayer, 1973). A pixel with the second
/// colour at one share keeps it at every larger share, and such pixels are as far apart as possible.
const ORDER: [[u8; 8]; 8] = {
    let mut order = [[0; 8]; 8];
    let mut y = 0;
    while y < 8 {
        let mut x = 0;
        while x < 8 {
            let (mut rank, mut bit) = (0, 0);
            while bit < 3 {
                let (low, high) = ((x ^ y) >> bit & 1, y >> bit & 1);
                rank |= (low << 1 | high) << (2 * (2 - bit));
                bit += 1;
            }
            order[y][x] = rank as u8;
            x += 1;
        }
        y += 1;
    }
    order
};

/// A palette, and the colour or mixture for each cell.
pub(super) struct Palette {
    pub(super) colours: Vec<Colour>,
    mixtures: Vec<Mixture>,
}

impl Palette {
    /// A picture as indices into the palette. In a mixture the position of a pixel decides its colour, so the dither
    /// pattern does not move.
    pub(super) fn numbers(&self, image: &Image) -> Vec<u8> {
        let rows = image.pixels.as_chunks::<3>().0.chunks_exact(image.size[0] as usize);
        let number = |order: &[u8; 8], x: usize, pixel: [u8; 3]| {
            let Mixture { one, other, share } = self.mixtures[cell(pixel)];
            if order[x % 8] < share { other } else { one }
        };
        let row = |(y, row): (usize, &[[u8; 3]])| -> Vec<u8> {
            row.iter().enumerate().map(|(x, &pixel)| number(&ORDER[y % 8], x, pixel)).collect()
        };
        rows.enumerate().flat_map(row).collect()
    }
}

#[cfg(test)]
#[path = "../../tests/inside/palette.rs"]
mod tests;
