//! The distance of two pictures of one size, and the tolerance.
//!
//! Graphics drivers round differently, and take other samples along silhouettes and lines. So each pixel is compared
//! with the range of colours of all pixels around its place. A shift or a fade of a whole area changes the means
//! of blocks. One tolerance holds for all drivers. It was measured between two software drivers of different makers,
//! llvmpipe and SwiftShader, with all goldens of this project: at most 0.67 % of the pixels differ by more than
//! [`FAINT`], 0.016 % by more than [`STRONG`], and the means of blocks by 1.14 of 255. A shift of a picture by one
//! pixel changes the mean of some block by at least 2.10.

use super::picture::Pixels;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// The largest difference of a channel, of 255, that is ignored.
pub(super) const FAINT: u8 = 2;
/// The largest difference of a channel that is hard to see.
pub(super) const STRONG: u8 = 16;
/// The shares of pixels that may differ by more than [`FAINT`] and by more than [`STRONG`].
const PARTS: [f64; 2] = [0.01, 0.0003];
/// The number of pixels that may differ in any picture, however small.
const AT_LEAST: u64 = 8;
/// The side of a block (px), and the largest allowed difference of the means of a channel over it, of 255.
const BLOCK: usize = 16;
const MEAN: f64 = 1.5;

/// The distance of two pictures of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Distance {
    /// Pixels that are not equal.
    pub(crate) unequal: u64,
    /// Pixels that differ by more than [`FAINT`] and by more than [`STRONG`].
    pub(crate) differing: [u64; 2],
    /// The number of pixels that may differ so.
    pub(crate) allowed: [u64; 2],
    /// The largest difference of a channel, of 255.
    pub(crate) largest: u8,
    /// The largest difference of the means of a channel over a block of 16 × 16 pixels, of 255.
    pub(crate) mean: f64,
}

impl Distance {
    /// The distance of two pictures; `None` if their sizes differ.
    pub(super) fn new(expected: &Pixels, actual: &Pixels) -> Option<Self> {
        let all = u64::from(expected.size[0]) * u64::from(expected.size[1]);
        let allowed = PARTS.map(|part| ((part * all as f64) as u64).max(AT_LEAST));
        let mut distance = Self { allowed, ..Self::default() };
        differences(expected, actual, |_, difference| {
            distance.unequal += 1;
            for (count, least) in distance.differing.iter_mut().zip([FAINT, STRONG]) {
                *count += u64::from(difference > least);
            }
            distance.largest = distance.largest.max(difference);
        })?;
        let means = grounds(expected, actual).into_iter().map(|both| largest_mean(expected.size, both));
        distance.mean = means.fold(0.0, f64::max);
        Some(distance)
    }

    /// Whether the distance is within the tolerance.
    pub(crate) fn is_allowed(&self) -> bool {
        self.mean <= MEAN && self.differing.iter().zip(&self.allowed).all(|(differing, allowed)| differing <= allowed)
    }
}

/// The pixels of both pictures on white, and if some are transparent, on black.
fn grounds<'p>(expected: &'p Pixels, actual: &'p Pixels) -> Vec<[&'p [[u8; 3]]; 2]> {
    let both = [expected, actual];
    let has_holes = both.iter().any(|picture| picture.on_black.is_some());
    let white = both.map(|picture| &picture.bytes);
    let black = has_holes.then(|| both.map(|picture| picture.on_black.as_ref().unwrap_or(&picture.bytes)));
    [white].into_iter().chain(black).map(|both| both.map(|bytes| bytes.as_chunks::<3>().0)).collect()
}

/// Calls `each` for every unequal pixel, with its index and its distance ([`outside`]), on the worse ground; `None` if the sizes differ.
pub(super) fn differences(expected: &Pixels, actual: &Pixels, mut each: impl FnMut(usize, u8)) -> Option<()> {
    if expected.size != actual.size {
        return None;
    }
    let (width, all) = (expected.size[0] as usize, grounds(expected, actual));
    for row in (0..expected.size[1] as usize).map(|y| y * width..(y + 1) * width) {
        if all.iter().all(|[before, after]| before[row.clone()] == after[row.clone()]) {
            continue;
        }
        for at in row {
            let unequal = all.iter().filter(|[before, after]| before[at] != after[at]);
            let one =
                |from: &[[u8; 3]], to: &[[u8; 3]]| outside(&from[at], to, expected.size, [at % width, at / width]);
            let worst = unequal.map(|[before, after]| one(before, after).max(one(after, before))).max();
            worst.into_iter().for_each(|worst| each(at, worst));
        }
    }
    Some(())
}

/// The largest difference of the means of a channel over a block, of two pictures of one size. The last blocks of rows and
/// columns overlap the ones before them.
fn largest_mean(size: [u32; 2], [before, after]: [&[[u8; 3]]; 2]) -> f64 {
    let [width, height] = size.map(|side| side as usize);
    let blocks = |side: usize| {
        let start = move |at: usize| (at * BLOCK).min(side.saturating_sub(BLOCK));
        (0..side.div_ceil(BLOCK)).map(move |at| start(at)..(start(at) + BLOCK).min(side))
    };
    let mean = |rows: &Range<usize>, columns: Range<usize>| {
        let mut sums = [0_i32; 3];
        for at in rows.clone().flat_map(|row| columns.clone().map(move |column| row * width + column)) {
            for (sum, (before, after)) in sums.iter_mut().zip(before[at].iter().zip(after[at])) {
                *sum += i32::from(after) - i32::from(*before);
            }
        }
        let largest = sums.iter().map(|sum| sum.abs()).max().unwrap_or(0);
        f64::from(largest) / (rows.len() * columns.len()) as f64
    };
    let means = blocks(height).flat_map(|rows| blocks(width).map(move |columns| mean(&rows, columns)));
    means.fold(0.0, f64::max)
}

/// The distance of a pixel, in its worst channel, from the range of the nine pixels around its place in a picture.
fn outside(pixel: &[u8; 3], picture: &[[u8; 3]], size: [u32; 2], [x, y]: [usize; 2]) -> u8 {
    let [width, height] = size.map(|side| side as usize);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let mut range = [[u8::MAX, 0]; 3];
    for at in near(y, height).flat_map(|y| near(x, width).map(move |x| y * width + x)) {
        for ([low, high], &byte) in range.iter_mut().zip(&picture[at]) {
            (*low, *high) = ((*low).min(byte), (*high).max(byte));
        }
    }
    let by = |(&byte, [low, high]): (&u8, [u8; 2])| low.saturating_sub(byte).max(byte.saturating_sub(high));
    pixel.iter().zip(range).map(by).max().unwrap_or(0)
}

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [[faint, strong], [faint_allowed, strong_allowed]] = [self.differing, self.allowed];
        let differ = if strong == 1 { "pixel differs" } else { "pixels differ" };
        write!(
            f,
            "{strong} {differ} by more than {STRONG} of 255 ({strong_allowed} may), {faint} by more than {FAINT} \
             ({faint_allowed} may), the mean of {BLOCK}×{BLOCK} pixels by {:.1} \
             ({MEAN} may)",
            self.mean
        )
    }
}

#[cfg(test)]
#[path = "../../tests/inside/tolerance.rs"]
mod tests;
