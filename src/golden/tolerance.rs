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
        distance.mean = largest_mean(expected, actual);
        Some(distance)
    }

    /// Whether the distance is within the tolerance.
    pub(crate) fn is_allowed(&self) -> bool {
        self.mean <= MEAN && self.differing.iter().zip(&self.allowed).all(|(differing, allowed)| differing <= allowed)
    }
}

/// Calls `each` for every unequal pixel, with its index and its distance ([`outside`]); `None` if the sizes differ.
pub(super) fn differences(expected: &Pixels, actual: &Pixels, mut each: impl FnMut(usize, u8)) -> Option<()> {
    if expected.size != actual.size {
        return None;
    }
    let width = expected.size[0] as usize;
    let [before, after] = [expected, actual].map(|picture| picture.bytes.as_chunks::<3>().0.chunks_exact(width));
    for (y, (before, after)) in before.zip(after).enumerate().filter(|(_, (before, after))| before != after) {
        for (x, (before, after)) in before.iter().zip(after).enumerate().filter(|(_, (before, after))| before != after)
        {
            let difference = outside(before, actual, [x, y]).max(outside(after, expected, [x, y]));
            each(y * width + x, difference);
        }
    }
    Some(())
}

/// The largest difference of the means of a channel over a block, of two pictures of one size. The last blocks of rows and
/// columns overlap the ones before them.
fn largest_mean(expected: &Pixels, actual: &Pixels) -> f64 {
    let [width, height] = expected.size.map(|side| side as usize);
    let [before, after] = [expected, actual].map(|picture| picture.bytes.as_chunks::<3>().0);
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
fn outside(pixel: &[u8; 3], picture: &Pixels, [x, y]: [usize; 2]) -> u8 {
    let [width, height] = picture.size.map(|side| side as usize);
    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
    let mut range = [[u8::MAX, 0]; 3];
    for at in near(y, height).flat_map(|y| near(x, width).map(move |x| y * width + x)) {
        for ([low, high], &byte) in range.iter_mut().zip(&picture.bytes.as_chunks::<3>().0[at]) {
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
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [400, 300];

    /// A dark square on light ground, after a change.
    fn picture(change: impl FnOnce(&mut [[u8; 3]])) -> Pixels {
        let [width, height] = SIZE;
        let is_dark = |at: usize| (100..300).contains(&(at % width)) && (50..250).contains(&(at / width));
        let mut pixels: Vec<[u8; 3]> = (0..width * height).map(|at| [if is_dark(at) { 50 } else { 200 }; 3]).collect();
        change(&mut pixels);
        Pixels { size: SIZE.map(|side| side as u32), bytes: pixels.concat(), label: None }
    }

    fn distance(change: impl FnOnce(&mut [[u8; 3]])) -> Distance {
        Distance::new(&picture(|_| ()), &picture(change)).expect("of one size")
    }

    #[test]
    fn limits_are_kept_to_the_pixel() {
        let ground = |count: usize, by: u8| distance(|pixels| pixels[..count].fill([200, 200 + by, 200]));
        let told = ground(1200, FAINT + 1);
        let mean = 3.0 * f64::from(FAINT + 1) / BLOCK as f64;
        let expected = Distance { unequal: 1200, differing: [1200, 0], allowed: [1200, 36], largest: FAINT + 1, mean };
        assert_eq!(told, expected);
        assert!(told.is_allowed() && !ground(1201, FAINT + 1).is_allowed());
        assert!(ground(10_000, 1).is_allowed() && !ground(10_000, FAINT).is_allowed());
        assert!(ground(36, STRONG + 1).is_allowed());
        assert!(!ground(37, STRONG + 1).is_allowed() && ground(37, STRONG).is_allowed());
        let told = ground(37, 50).to_string();
        assert_eq!(
            told,
            "37 pixels differ by more than 16 of 255 (36 may), 37 by more than 2 (1200 may), the mean of 16×16 pixels by 3.1 (1.5 may)"
        );
    }

    /// Drivers may disagree about some pixels along a border, but not about all of them, about two rows or about an object.
    #[test]
    fn borders_may_wander_by_a_pixel_here_and_there() {
        let [width, _] = SIZE;
        let moved = |by: usize, every: usize| {
            distance(|pixels| {
                for row in pixels.chunks_exact_mut(width).skip(50).take(200).step_by(every) {
                    row.rotate_right(by);
                }
            })
        };
        let here_and_there = moved(1, 8);
        assert_eq!((here_and_there.unequal, here_and_there.differing), (50, [0, 0]));
        assert!(here_and_there.is_allowed() && !moved(1, 4).is_allowed());
        // The whole square moves by a pixel. Each pixel is near one of its colour.
        assert_eq!((moved(1, 1).is_allowed(), moved(1, 1).differing), (false, [0, 0]));
        assert!(!moved(2, 1).is_allowed() && moved(2, 1).differing[1] >= 400);
        let line = distance(|pixels| pixels[20 * width..20 * width + 40].fill([120; 3]));
        assert_eq!((line.is_allowed(), line.differing), (false, [40, 40]));
        let single = Pixels { size: [1, 1], bytes: vec![7; 3], label: None };
        let other = Pixels { bytes: vec![9; 3], ..single.clone() };
        assert_eq!(Distance::new(&single, &other).expect("of one size").largest, 2);
        assert_eq!(Distance::new(&single, &picture(|_| ())), None);
    }

    /// A hatch of a part of the picture at nine tenths of its strength: few pixels differ, and each only a little.
    #[test]
    fn lines_may_not_fade() {
        let hatched = |by: u8| {
            picture(|pixels| {
                for (at, pixel) in pixels.iter_mut().enumerate() {
                    let [x, y] = [at % SIZE[0], at / SIZE[0]];
                    if x < 64 && y < 48 && x % 4 == 0 {
                        *pixel = [200 - by; 3];
                    }
                }
            })
        };
        let faded = Distance::new(&hatched(150), &hatched(135)).expect("of one size");
        assert_eq!((faded.is_allowed(), faded.differing), (false, [768, 0]));
        assert!(faded.mean > 3.0, "{faded}");
    }
}
