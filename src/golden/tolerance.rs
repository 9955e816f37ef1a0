//! The distance of two pictures of one size, and the tolerance.
//!
//! Graphics drivers round differently, and take other samples along silhouettes and lines. So each pixel is compared
//! with the range of colours of all pixels around its place. One tolerance holds for all drivers. It was measured
//! between two software drivers of different makers, llvmpipe and SwiftShader, with all goldens of this project: at
//! most 0.67 % of the pixels differ by more than [`FAINT`], and 0.016 % by more than [`STRONG`].

use super::picture::Pixels;
use serde::Serialize;
use std::fmt;

/// The largest difference of a channel, of 255, that is ignored.
pub(super) const FAINT: u8 = 2;
/// The largest difference of a channel that is hard to see.
pub(super) const STRONG: u8 = 16;
/// The shares of pixels that may differ by more than [`FAINT`] and by more than [`STRONG`].
const PARTS: [f64; 2] = [0.01, 0.0003];
/// The number of pixels that may differ in any picture, however small.
const AT_LEAST: u64 = 8;

/// The distance of two pictures of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Distance {
    /// Pixels that are not equal.
    pub(crate) unequal: u64,
    /// Pixels that differ by more than [`FAINT`] and by more than [`STRONG`].
    pub(crate) differing: [u64; 2],
    /// The number of pixels that may differ so.
    pub(crate) allowed: [u64; 2],
    /// The largest difference of a channel, of 255.
    pub(crate) largest: u8,
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
        Some(distance)
    }

    /// Whether the distance is within the tolerance.
    pub(crate) fn is_allowed(&self) -> bool {
        self.differing.iter().zip(&self.allowed).all(|(differing, allowed)| differing <= allowed)
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
             ({faint_allowed} may)"
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
        assert_eq!(told, Distance { unequal: 1200, differing: [1200, 0], allowed: [1200, 36], largest: FAINT + 1 });
        assert!(told.is_allowed() && !ground(1201, FAINT + 1).is_allowed());
        assert!(ground(10_000, FAINT).is_allowed() && ground(36, STRONG + 1).is_allowed());
        assert!(!ground(37, STRONG + 1).is_allowed() && ground(37, STRONG).is_allowed());
        let told = ground(37, 50).to_string();
        assert_eq!(told, "37 pixels differ by more than 16 of 255 (36 may), 37 by more than 2 (1200 may)");
    }

    /// Drivers may disagree about the pixels along a border, but not about two rows of them or about an object.
    #[test]
    fn borders_may_wander_by_a_pixel() {
        let [width, _] = SIZE;
        let moved = |by: usize| {
            distance(|pixels| {
                for row in pixels.chunks_exact_mut(width).skip(50).take(200) {
                    row.rotate_right(by);
                }
            })
        };
        assert_eq!((moved(1).unequal, moved(1).differing), (400, [0, 0]));
        assert!(!moved(2).is_allowed() && moved(2).differing[1] >= 400);
        let line = distance(|pixels| pixels[20 * width..20 * width + 40].fill([120; 3]));
        assert_eq!((line.is_allowed(), line.differing), (false, [40, 40]));
        let single = Pixels { size: [1, 1], bytes: vec![7; 3], label: None };
        let other = Pixels { bytes: vec![9; 3], ..single.clone() };
        assert_eq!(Distance::new(&single, &other).expect("of one size").largest, 2);
        assert_eq!(Distance::new(&single, &picture(|_| ())), None);
    }
}
