//! How far two pictures are apart, and how far they may be.
//!
//! One machine draws the same bytes. Machines of one kind round in their own ways, and now and then take another sample
//! where a silhouette passes through a corner of a pixel. Another kind of adapter has sample places of its own: all along
//! the silhouettes pixels differ by a little, but what lies between them must be the same.

use super::picture::Pixels;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// Pixels differ visibly if a channel differs by more than this: drivers round in their own ways.
pub(super) const CHANNEL: u8 = 2;
/// Pictures of machines of one kind may differ visibly in this part of their pixels, and in so many in any case.
const PART: f64 = 1e-4;
const AT_LEAST: u64 = 8;

/// A pixel belongs to a silhouette if a channel changes by more than this within the pixels around it, in both pictures:
/// what is drawn new, or not any more, is none.
const CONTRAST: u8 = 8;
/// Of the silhouettes' pixels this part may differ visibly between kinds of adapters. Measured between two software
/// drivers of different makers (llvmpipe and SwiftShader, 154 pictures of 180 to 1280 px, and all goldens of this project):
/// median .008, at most .16 where a picture is hardly anything but lines. GPUs were not measured.
const PART_OF_SILHOUETTES: f64 = 0.25;
/// Of all others this part, measured as at most .05 %; and far from silhouettes never by more than the contrast that makes
/// one, measured as 6.
const PART_OF_INTERIORS: f64 = 1e-3;

/// What is known of the machines that drew two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Machines {
    /// The same adapter with the same driver: not a byte may differ.
    Same,
    /// Adapters of one kind, or nobody knows.
    OneKind,
    /// Adapters of different kinds.
    OtherKind,
}

impl Machines {
    /// What two adapters, as pictures name them, are to each other.
    pub fn of(expected: Option<&str>, actual: Option<&str>) -> Self {
        match (expected, actual) {
            (Some(one), Some(other)) if one == other => Self::Same,
            (Some(one), Some(other)) if kind(one) != kind(other) => Self::OtherKind,
            _ => Self::OneKind,
        }
    }
}

/// The kind of an adapter. What stands in brackets of its own is a version: of the compiler, the driver, the interface.
pub(super) fn kind(adapter: &str) -> &str {
    adapter.split(" (").next().unwrap_or_default().trim()
}

/// How many pixels differ visibly, and how many may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Count {
    /// Pixels of which a channel differs by more than 2 of 255.
    pub visible: u64,
    /// How many of them are allowed.
    pub allowed: u64,
    /// The largest difference of a channel, of 255.
    pub largest: u8,
}

/// How far two pictures of one size are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Distance {
    /// What the limits are made for.
    pub machines: Machines,
    /// Pixels that are not equal.
    pub unequal: u64,
    /// All pixels, or for adapters of different kinds those of silhouettes.
    #[serde(flatten)]
    pub counted: Count,
    /// For adapters of different kinds, all other pixels, of which none may differ by more than 8 where neither picture has
    /// a silhouette; `largest` is that of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interiors: Option<Count>,
}

impl Distance {
    /// That of two pictures; `None` if their sizes or channels are not alike.
    pub fn new(expected: &Pixels, actual: &Pixels) -> Option<Self> {
        if expected.size != actual.size || expected.channels != actual.channels {
            return None;
        }
        let adapter = |pixels: &'_ Pixels| pixels.label.as_ref().map(|label| label.adapter().to_owned());
        let machines = Machines::of(adapter(expected).as_deref(), adapter(actual).as_deref());
        let all = u64::from(expected.size[0]) * u64::from(expected.size[1]);
        // Of a few pixels none can be spared.
        let part = |part: f64, of: u64| AT_LEAST.min(of / 100).max((part * of as f64) as u64);
        let counted =
            Count { allowed: if machines == Machines::Same { 0 } else { part(PART, all) }, ..Count::default() };
        let mut distance = Self { machines, unequal: 0, counted, interiors: None };
        if expected.bytes == actual.bytes {
            return Some(distance);
        }
        let mask = (machines == Machines::OtherKind).then(|| silhouettes([expected, actual]));
        let mut interiors = Count::default();
        for (at, difference) in differences(expected, actual) {
            let place = mask.as_ref().map_or(Place::Silhouette, |mask| mask[at]);
            let count = if place == Place::Silhouette { &mut distance.counted } else { &mut interiors };
            count.visible += u64::from(difference > CHANNEL);
            if place != Place::HalfSilhouette {
                count.largest = count.largest.max(difference);
            }
            distance.unequal += 1;
        }
        if let Some(mask) = mask {
            let of_silhouettes = mask.iter().filter(|&&place| place == Place::Silhouette).count() as u64;
            distance.counted.allowed = part(PART_OF_SILHOUETTES, of_silhouettes);
            interiors.allowed = part(PART_OF_INTERIORS, all - of_silhouettes);
            distance.interiors = Some(interiors);
        }
        Some(distance)
    }

    /// Whether it is no more than such machines differ.
    pub fn is_allowed(&self) -> bool {
        let within = |count: &Count| count.visible <= count.allowed;
        match self.machines {
            Machines::Same => self.unequal == 0,
            _ => within(&self.counted) && self.interiors.iter().all(|count| within(count) && count.largest <= CONTRAST),
        }
    }

    /// Pixels that differ visibly, wherever they are.
    pub fn visible(&self) -> u64 {
        self.counted.visible + self.interiors.map_or(0, |count| count.visible)
    }

    /// How much of what is allowed is used: 1 at the limit, and above it when there are too many.
    pub fn of_limit(&self) -> f64 {
        let part = |count: &Count| count.visible as f64 / count.allowed.max(1) as f64;
        let strict = |count: &Count| f64::from(count.largest) / f64::from(CONTRAST);
        let interiors = self.interiors.iter().map(|count| part(count).max(strict(count)));
        match self.machines {
            Machines::Same => self.unequal as f64,
            _ => interiors.fold(part(&self.counted), f64::max),
        }
    }
}

/// Each pixel that is not equal, by its place in its picture, with its largest difference of a channel as it is seen: on
/// whatever ground, a colour counts as much as its opacity.
pub(super) fn differences<'a>(expected: &'a Pixels, actual: &'a Pixels) -> impl Iterator<Item = (usize, u8)> + 'a {
    let channels = expected.channels;
    let width = expected.size[0] as usize * channels;
    let rows = expected.bytes.chunks_exact(width).zip(actual.bytes.chunks_exact(width)).enumerate();
    // Most rows are equal, and whole rows are compared quickly.
    let unequal = rows.filter(|(_, (one, other))| one != other);
    unequal.flat_map(move |(row, (one, other))| {
        let pairs = one.chunks_exact(channels).zip(other.chunks_exact(channels)).enumerate();
        let start = row * (width / channels);
        pairs
            .filter(|(_, (one, other))| one != other)
            .map(move |(column, (one, other))| (start + column, seen(one, other)))
    })
}

/// The largest difference of a channel of two pixels.
fn seen(one: &[u8], other: &[u8]) -> u8 {
    let largest = |weigh: [u32; 2]| {
        let weighed = |(&a, &b): (&u8, &u8)| (u32::from(a) * weigh[0] / 255).abs_diff(u32::from(b) * weigh[1] / 255);
        one.iter().zip(other).take(3).map(weighed).max().unwrap_or(0) as u8
    };
    match (one.get(3), other.get(3)) {
        (Some(&a), Some(&b)) => largest([a.into(), b.into()]).max(a.abs_diff(b)),
        _ => largest([255, 255]),
    }
}

/// Where a pixel lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Along a silhouette, a line or a letter of both pictures.
    Silhouette,
    /// Along one that only one of the pictures has.
    HalfSilhouette,
    /// Where both are smooth.
    Interior,
}

/// For each pixel of two pictures where it lies.
pub(super) fn silhouettes(pictures: [&Pixels; 2]) -> Vec<Place> {
    const ROWS: usize = 32;
    let (width, channels) = (pictures[0].size[0] as usize, pictures[0].channels);
    let mut mask = vec![Place::Interior; pictures[0].bytes.len() / channels];
    // Row by row in plain loops over bytes, which compilers turn into vector code: 3 ms instead of 14 for two pictures of
    // 1280×720.
    mask.par_chunks_mut(ROWS * width).enumerate().for_each(|(band, mask)| {
        let row = width * channels;
        let (mut low, mut high, mut contrast) = (vec![0; row], vec![0; row], vec![0; row]);
        for (line, mask) in mask.chunks_exact_mut(width).enumerate() {
            for (number, picture) in pictures.into_iter().enumerate() {
                contrast.fill(0);
                extremes(&picture.bytes, row, band * ROWS + line, &mut low, &mut high);
                widen(&low, &high, channels, &mut contrast);
                for (place, pixel) in mask.iter_mut().zip(contrast.chunks_exact(channels)) {
                    let is_silhouette = pixel.iter().any(|&contrast| contrast > CONTRAST);
                    *place = match (number, is_silhouette, *place) {
                        (0, true, _) | (1, false, Place::HalfSilhouette) => Place::HalfSilhouette,
                        (1, true, Place::HalfSilhouette) => Place::Silhouette,
                        (1, true, _) => Place::HalfSilhouette,
                        _ => Place::Interior,
                    };
                }
            }
        }
    });
    mask
}

/// The least and the greatest of each byte of a row, the one above and the one below.
fn extremes(bytes: &[u8], row: usize, line: usize, low: &mut [u8], high: &mut [u8]) {
    let rows = bytes.len() / row;
    let part = |line: usize| &bytes[line * row..(line + 1) * row];
    low.copy_from_slice(part(line));
    high.copy_from_slice(part(line));
    for near in [line.saturating_sub(1), (line + 1).min(rows - 1)] {
        for ((low, high), &near) in low.iter_mut().zip(high.iter_mut()).zip(part(near)) {
            *low = near.min(*low);
            *high = near.max(*high);
        }
    }
}

/// How far the greatest lies above the least of three pixels side by side, or what was there before if that is more.
fn widen(low: &[u8], high: &[u8], channels: usize, contrast: &mut [u8]) {
    let row = low.len();
    if row < 3 * channels {
        // One or two pixels in a row.
        for (at, contrast) in contrast.iter_mut().enumerate() {
            let beside = || (at % channels..row).step_by(channels);
            let least = beside().map(|at| low[at]).min().unwrap_or(0);
            let greatest = beside().map(|at| high[at]).max().unwrap_or(0);
            *contrast = (*contrast).max(greatest - least);
        }
        return;
    }
    let [inner, right] = [row - 2 * channels, 2 * channels];
    let three = low[..inner].iter().zip(&low[channels..]).zip(&low[right..]);
    let greatest = high[..inner].iter().zip(&high[channels..]).zip(&high[right..]);
    for ((contrast, ((a, b), c)), ((d, e), f)) in contrast[channels..].iter_mut().zip(three).zip(greatest) {
        *contrast = (*contrast).max(*d.max(e).max(f) - *a.min(b).min(c));
    }
    for at in (0..channels).chain(row - channels..row) {
        let beside = if at < channels { at + channels } else { at - channels };
        contrast[at] = contrast[at].max(high[at].max(high[beside]) - low[at].min(low[beside]));
    }
}

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Count { visible, allowed, largest } = self.counted;
        if let (Machines::Same, unequal) = (self.machines, self.unequal) {
            let pixels = if unequal == 1 { "1 pixel differs".to_owned() } else { format!("{unequal} pixels differ") };
            return write!(f, "{pixels}, by up to {largest} of 255; none may, for one machine drew both");
        }
        match self.interiors {
            None => write!(f, "{visible} of the {allowed} pixels that may differ by more than {CHANNEL} of 255 do")?,
            Some(Count { visible: inner, allowed: inner_allowed, largest: inner_largest }) => write!(
                f,
                "another kind of adapter drew it; along silhouettes {visible} of the {allowed} pixels that may differ by more \
                 than {CHANNEL} of 255 do, between them {inner} of {inner_allowed} (by up to {inner_largest}, {CONTRAST} is \
                 allowed)"
            )?,
        }
        if largest > 0 { write!(f, ", by up to {largest}") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adapters_are_told_apart() {
        let [old, new] = ["llvmpipe (LLVM 15, 256 bits) (cpu, vulkan)", "llvmpipe (LLVM 19, 128 bits) (cpu, vulkan)"];
        assert_eq!(Machines::of(Some(old), Some(old)), Machines::Same);
        assert_eq!(Machines::of(Some(old), Some(new)), Machines::OneKind);
        assert_eq!(Machines::of(Some(old), Some("NVIDIA H200 (discrete gpu, vulkan)")), Machines::OtherKind);
        assert_eq!(Machines::of(Some(old), None), Machines::OneKind);
        let [one, other] = ["Intel(R) UHD (integrated gpu, vulkan)", "Intel(R) Xe (integrated gpu, vulkan)"];
        assert_eq!(Machines::of(Some(one), Some(other)), Machines::OtherKind);
    }

    #[test]
    fn silhouettes_are_where_colours_change() {
        let mut bytes = vec![100; 9 * 7 * 3];
        bytes[(3 * 9 + 4) * 3 + 1] = 100 + CONTRAST + 1;
        let flat = Pixels { size: [9, 7], channels: 3, bytes: vec![100; 9 * 7 * 3], label: None };
        let spot = Pixels { bytes, ..flat.clone() };
        assert!(silhouettes([&flat, &flat]).iter().all(|&place| place == Place::Interior));
        for (two, near) in [
            ([&flat, &spot], Place::HalfSilhouette),
            ([&spot, &flat], Place::HalfSilhouette),
            ([&spot, &spot], Place::Silhouette),
        ] {
            for (at, place) in silhouettes(two).into_iter().enumerate() {
                let is_near = (at / 9).abs_diff(3) <= 1 && (at % 9).abs_diff(4) <= 1;
                assert_eq!(place, if is_near { near } else { Place::Interior }, "{at}");
            }
        }
    }

    #[test]
    fn silhouettes_are_the_same_in_rows_of_any_length() {
        for size in [[1, 1], [1, 5], [2, 3], [3, 2], [7, 70]] {
            for channels in [3, 4] {
                let [width, height] = size.map(|side| side as usize);
                let mut seed = 1_u32;
                let mut byte = || {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    100 + (seed >> 24) as u8 / 20
                };
                let bytes = (0..width * height * channels).map(|_| byte()).collect();
                let picture = Pixels { size, channels, bytes, label: None };
                let mask = silhouettes([&picture, &picture]);
                for (at, place) in mask.into_iter().enumerate() {
                    let [x, y] = [at % width, at / width];
                    let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
                    let is = (0..channels).any(|channel| {
                        let around =
                            near(y, height).flat_map(|y| near(x, width).map(move |x| (y * width + x) * channels));
                        let all: Vec<u8> = around.map(|at| picture.bytes[at + channel]).collect();
                        all.iter().max().unwrap() - all.iter().min().unwrap() > CONTRAST
                    });
                    assert_eq!(place == Place::Silhouette, is, "{size:?} {channels} {at}");
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_seen_does_not_count() {
        assert_eq!(seen(&[255, 0, 0, 0], &[0, 0, 255, 0]), 0);
        assert_eq!(seen(&[255, 0, 0, 10], &[0, 0, 0, 10]), 10);
        assert_eq!(seen(&[9, 9, 9, 200], &[9, 9, 9, 250]), 50);
        assert_eq!(seen(&[9, 9, 9], &[9, 250, 9]), 241);
    }
}
