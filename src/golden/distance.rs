//! How far two pictures are apart, and how far they may be.
//!
//! One machine draws the same bytes. Machines of one kind round in their own ways, and now and then take another sample
//! where a silhouette passes through a corner of a pixel. Another kind of adapter has sample places of its own: all along
//! the silhouettes pixels differ by a little, but what lies between them must be the same.

use super::picture::Pixels;
use super::silhouettes::{CONTRAST, Finder, Place};
use crate::output::Label;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// Pixels differ visibly if a channel differs by more than this: drivers round in their own ways.
pub(super) const CHANNEL: u8 = 2;
/// Pictures of machines of one kind may differ visibly in this part of their pixels, and in so many in any case.
const PART: f64 = 1e-4;
const AT_LEAST: u64 = 8;

/// Of the silhouettes' pixels this part may differ visibly between kinds of adapters. Measured between two software
/// drivers of different makers (llvmpipe and SwiftShader, 154 pictures of 180 to 1280 px, and all goldens of this project):
/// median .008, at most .16 where a picture is hardly anything but lines. GPUs were not measured.
const PART_OF_SILHOUETTES: f64 = 0.25;
/// Of all others this part, measured as at most .05 %; and far from silhouettes never by more than the contrast that makes
/// one, measured as 7.
const PART_OF_INTERIORS: f64 = 1e-3;
/// And where only one picture has a silhouette, as along a line that is drawn new, so many as this part of the silhouettes
/// may differ by more than that contrast: measured as at most .07 %, and as none in nearly all pictures.
const PART_ONE_SIDED: f64 = 1e-3;

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
    /// Pixels of which a channel differs by more than 2 of 255, or by as much as is said where they are counted.
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
    /// For adapters of different kinds, those of them that differ by more than 8 where only one picture has a silhouette.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_sided: Option<Count>,
}

impl Distance {
    /// That of two pictures; `None` if their sizes or channels are not alike.
    pub fn new(expected: &Pixels, actual: &Pixels) -> Option<Self> {
        if expected.size != actual.size || expected.channels != actual.channels {
            return None;
        }
        let mut tally = Tally::new(expected.size, expected.channels, [&expected.label, &actual.label]);
        tally.count([&expected.bytes, &actual.bytes], 0..expected.size[1] as usize);
        Some(tally.distance())
    }

    /// Whether it is no more than such machines differ.
    pub fn is_allowed(&self) -> bool {
        let within = |count: Count| count.visible <= count.allowed;
        match self.machines {
            Machines::Same => self.unequal == 0,
            _ => {
                let is_smooth = self.interiors.iter().all(|count| count.largest <= CONTRAST);
                is_smooth && self.counts().all(within)
            }
        }
    }

    /// Pixels that differ visibly, wherever they are.
    pub fn visible(&self) -> u64 {
        self.counted.visible + self.interiors.map_or(0, |count| count.visible)
    }

    /// How much of what is allowed is used: 1 at the limit, and above it when there are too many.
    pub fn of_limit(&self) -> f64 {
        let part = |count: Count| count.visible as f64 / count.allowed.max(1) as f64;
        let strict = self.interiors.map_or(0.0, |count| f64::from(count.largest) / f64::from(CONTRAST));
        match self.machines {
            Machines::Same => self.unequal as f64,
            _ => self.counts().map(part).fold(strict, f64::max),
        }
    }

    fn counts(&self) -> impl Iterator<Item = Count> {
        [Some(self.counted), self.interiors, self.one_sided].into_iter().flatten()
    }
}

/// Counts how far two pictures are apart while their rows come: whole pictures are large.
pub(super) struct Tally {
    machines: Machines,
    size: [u32; 2],
    channels: usize,
    unequal: u64,
    counted: Count,
    interiors: Count,
    one_sided: Count,
    /// Pixels along silhouettes, which are looked for if the machines are of different kinds.
    of_silhouettes: u64,
    finder: Option<Finder>,
}

impl Tally {
    /// For pictures of one size, by what they say of themselves.
    pub(super) fn new(size: [u32; 2], channels: usize, labels: [&Option<Label>; 2]) -> Self {
        let [expected, actual] = labels.map(|label| label.as_ref().map(Label::adapter));
        let machines = Machines::of(expected, actual);
        let finder = (machines == Machines::OtherKind).then(|| Finder::new(size[0] as usize, channels));
        let [counted, interiors, one_sided] = [Count::default(); 3];
        Self { machines, size, channels, unequal: 0, counted, interiors, one_sided, of_silhouettes: 0, finder }
    }

    /// Adds some lines, given the same rows of both pictures: these lines, and those just above and below if there are any.
    pub(super) fn count(&mut self, rows: [&[u8]; 2], lines: Range<usize>) {
        let width = self.size[0] as usize;
        let row = width * self.channels;
        for line in lines {
            let places = self.finder.as_mut().map(|finder| finder.places(rows, line));
            if let Some(places) = places {
                let count: u32 = places.iter().map(|&place| u32::from(place == Place::Silhouette)).sum();
                self.of_silhouettes += u64::from(count);
            }
            let [expected, actual] = rows.map(|rows| &rows[line * row..(line + 1) * row]);
            let Self { unequal, counted, interiors, one_sided, .. } = self;
            differences(expected, actual, self.channels, |at, difference| {
                let place = places.map_or(Place::Silhouette, |places| places[at]);
                let count = if place == Place::Silhouette { &mut *counted } else { &mut *interiors };
                count.visible += u64::from(difference > CHANNEL);
                let largest = if place == Place::HalfSilhouette { &mut one_sided.largest } else { &mut count.largest };
                *largest = difference.max(*largest);
                one_sided.visible += u64::from(place == Place::HalfSilhouette && difference > CONTRAST);
                *unequal += 1;
            });
        }
    }

    /// How far apart they are.
    pub(super) fn distance(self) -> Distance {
        let Self { machines, size, unequal, mut counted, mut interiors, mut one_sided, of_silhouettes, .. } = self;
        let all = u64::from(size[0]) * u64::from(size[1]);
        // Of a few pixels none can be spared.
        let part = |part: f64, of: u64| AT_LEAST.min(of / 100).max((part * of as f64) as u64);
        if machines == Machines::OtherKind && unequal > 0 {
            counted.allowed = part(PART_OF_SILHOUETTES, of_silhouettes);
            interiors.allowed = part(PART_OF_INTERIORS, all - of_silhouettes);
            one_sided.allowed = part(PART_ONE_SIDED, of_silhouettes);
            return Distance { machines, unequal, counted, interiors: Some(interiors), one_sided: Some(one_sided) };
        }
        counted.allowed = if machines == Machines::Same { 0 } else { part(PART, all) };
        Distance { machines, unequal, counted, interiors: None, one_sided: None }
    }
}

/// Each pixel of a row that is not equal, by its place in the row, with its largest difference of a channel as it is seen: on
/// whatever ground, a colour counts as much as its opacity.
pub(super) fn differences(expected: &[u8], actual: &[u8], channels: usize, each: impl FnMut(usize, u8)) {
    // Most rows are equal, and whole rows are compared quickly.
    if expected == actual {
        return;
    }
    match channels {
        3 => unequal::<3>(expected, actual, each),
        _ => unequal::<4>(expected, actual, each),
    }
}

fn unequal<const CHANNELS: usize>(expected: &[u8], actual: &[u8], mut each: impl FnMut(usize, u8)) {
    const BLOCK: usize = 32;
    let blocks = expected.as_chunks::<CHANNELS>().0.chunks(BLOCK).zip(actual.as_chunks::<CHANNELS>().0.chunks(BLOCK));
    // So are blocks of pixels.
    for (block, (expected, actual)) in blocks.enumerate().filter(|(_, (expected, actual))| expected != actual) {
        for (at, (one, other)) in expected.iter().zip(actual).enumerate().filter(|(_, (one, other))| one != other) {
            each(block * BLOCK + at, seen(one, other));
        }
    }
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

impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Count { visible, allowed, largest } = self.counted;
        if let (Machines::Same, unequal) = (self.machines, self.unequal) {
            let pixels = if unequal == 1 { "1 pixel differs".to_owned() } else { format!("{unequal} pixels differ") };
            return write!(f, "{pixels}, by up to {largest} of 255; none may, for one machine drew both");
        }
        let by = if largest > 0 { format!(", by up to {largest}") } else { String::new() };
        let Some((inner, alone)) = self.interiors.zip(self.one_sided) else {
            return write!(f, "{visible} of the {allowed} pixels that may differ by more than {CHANNEL} of 255 do{by}");
        };
        write!(
            f,
            "another kind of adapter drew it; along silhouettes {visible} of the {allowed} pixels that may differ by more than \
             {CHANNEL} of 255 do{by}; between them {} of {} (by up to {}, {CONTRAST} is allowed); where only one picture has \
             silhouettes {} of {} by more than {CONTRAST}",
            inner.visible, inner.allowed, inner.largest, alone.visible, alone.allowed
        )
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
    fn what_cannot_be_seen_does_not_count() {
        assert_eq!(seen(&[255, 0, 0, 0], &[0, 0, 255, 0]), 0);
        assert_eq!(seen(&[255, 0, 0, 10], &[0, 0, 0, 10]), 10);
        assert_eq!(seen(&[9, 9, 9, 200], &[9, 9, 9, 250]), 50);
        assert_eq!(seen(&[9, 9, 9], &[9, 250, 9]), 241);
    }
}
