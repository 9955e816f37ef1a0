//! The distance of two pictures, and the tolerances.
//!
//! One machine draws the same bytes every time. Machines of one kind round differently, and in rare cases take another sample
//! where a silhouette passes through the corner of a pixel. Another kind of adapter has other sample positions: pixels
//! differ a little along all silhouettes, but those between them must be the same.

use super::picture::Pixels;
use super::silhouettes::{CONTRAST, Location, silhouettes};
use serde::Serialize;
use std::fmt;

/// Pixels differ visibly if a channel differs by more than this: drivers round differently.
pub(super) const CHANNEL: u8 = 2;
/// Pictures of machines of one kind may differ visibly in this part of their pixels, or in this number if that is more.
const PART: f64 = 1e-4;
const AT_LEAST: u64 = 8;

/// Part of the pixels along silhouettes that may differ visibly between kinds of adapters. Measured between two software
/// drivers of different makers (llvmpipe and SwiftShader, 154 pictures of 180 to 1280 px, and all goldens of this project):
/// median 0.008, at most 0.16 in pictures that consist mostly of lines. GPUs were not measured.
const PART_OF_SILHOUETTES: f64 = 0.25;
/// Part of all other pixels that may differ, measured as at most 0.05 %; away from silhouettes never by more than the contrast
/// that defines one, measured as 7. Objects in one picture only, such as a new line or mark, may differ by more in
/// [`AT_LEAST`] pixels, measured as 2.
const PART_OF_INTERIORS: f64 = 1e-3;

/// How the adapters that drew two pictures are related.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Machines {
    /// The same adapter with the same driver, for software on the same type of processor: not a byte may differ.
    Same,
    /// Neither picture records its adapter: not a byte may differ.
    Unknown,
    /// Adapters of one kind, or one of them is not recorded.
    OneKind,
    /// Adapters of different kinds.
    OtherKind,
}

impl Machines {
    /// The relation of two adapters, as recorded in pictures.
    pub(crate) fn of(expected: Option<&str>, actual: Option<&str>) -> Self {
        match (expected, actual) {
            (None, None) => Self::Unknown,
            (Some(one), Some(other)) if one == other => Self::Same,
            (Some(one), Some(other)) if kind(one) != kind(other) => Self::OtherKind,
            _ => Self::OneKind,
        }
    }
}

/// The kind of an adapter: its name without the versions of compiler, driver and interface, which are in brackets.
pub(super) fn kind(adapter: &str) -> &str {
    adapter.split(" (").next().unwrap_or_default().trim()
}

/// How many pixels differ visibly, and how many may.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Count {
    /// Pixels of which a channel differs by more than 2 of 255; for [`Distance::one_sided`] by more than 8.
    pub visible: u64,
    /// How many of them are allowed.
    pub allowed: u64,
    /// The largest difference of a channel, of 255.
    pub largest: u8,
}

/// How far two pictures of one size are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Distance {
    /// The relation of the adapters, which determines the limits.
    pub machines: Machines,
    /// Pixels that are not equal.
    pub unequal: u64,
    /// All pixels, or for adapters of different kinds those along silhouettes.
    #[serde(flatten)]
    pub counted: Count,
    /// For adapters of different kinds, pixels that differ where neither picture has a silhouette, none of them by more than
    /// 8, and, counted with them, those that differ by no more than that where one of them has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interiors: Option<Count>,
    /// For adapters of different kinds, pixels that differ by more than 8 where one picture alone has a silhouette.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub one_sided: Option<Count>,
}

impl Distance {
    /// The distance of two pictures; `None` if their sizes or channels differ.
    pub(super) fn new(expected: &Pixels, actual: &Pixels) -> Option<Self> {
        if expected.size != actual.size || expected.channels != actual.channels {
            return None;
        }
        let adapters = [expected, actual].map(|picture| picture.label.as_ref().map(|label| label.adapter.as_str()));
        let machines = Machines::of(adapters[0], adapters[1]);
        let are_equal = expected.bytes == actual.bytes;
        let places = (machines == Machines::OtherKind && !are_equal).then(|| silhouettes([expected, actual]));
        let mut unequal = 0;
        let [mut counted, mut interiors, mut one_sided] = [Count::default(); 3];
        differences(expected, actual, |at, difference| {
            unequal += 1;
            let (count, least) = match places.as_ref().map_or(Location::Silhouette, |places| places[at]) {
                Location::Silhouette | Location::Beside => (&mut counted, CHANNEL),
                Location::OneSided if difference > CONTRAST => (&mut one_sided, CONTRAST),
                Location::OneSided => {
                    interiors.visible += u64::from(difference > CHANNEL);
                    return;
                }
                Location::Interior => (&mut interiors, CHANNEL),
            };
            count.visible += u64::from(difference > least);
            count.largest = difference.max(count.largest);
        });
        let all = u64::from(expected.size[0]) * u64::from(expected.size[1]);
        // In very small pictures the tolerance is smaller.
        let part = |part: f64, of: u64| AT_LEAST.min(of / 100).max((part * of as f64) as u64);
        let Some(places) = places else {
            counted.allowed = if machines == Machines::OneKind { part(PART, all) } else { 0 };
            return Some(Self { machines, unequal, counted, interiors: None, one_sided: None });
        };
        let of_silhouettes = places.iter().filter(|&&place| place == Location::Silhouette).count() as u64;
        counted.allowed = part(PART_OF_SILHOUETTES, of_silhouettes);
        interiors.allowed = part(PART_OF_INTERIORS, all - of_silhouettes);
        one_sided.allowed = part(0.0, all);
        Some(Self { machines, unequal, counted, interiors: Some(interiors), one_sided: Some(one_sided) })
    }

    /// Whether the limits for these adapters are kept.
    pub(crate) fn is_allowed(&self) -> bool {
        self.limits().all(|limit| limit.is_kept())
    }

    /// The largest part of a limit that is used: 1 at the limit, more above it.
    pub(crate) fn of_limit(&self) -> f64 {
        self.limits().map(|limit| limit.used()).fold(0.0, f64::max)
    }

    pub(crate) fn nearest_to_limit(&self) -> Count {
        let nearest = self.limits().max_by(|one, other| one.part().total_cmp(&other.part()));
        nearest.map_or(self.counted, |limit| limit.count)
    }

    fn limits(&self) -> impl Iterator<Item = Limit> {
        let first = match self.machines {
            // No byte may differ.
            Machines::Same | Machines::Unknown => Count { visible: self.unequal, ..self.counted },
            _ => self.counted,
        };
        let limits = [Some(first), self.interiors, self.one_sided].into_iter().zip([None, Some(CONTRAST), None]);
        limits.filter_map(|(count, largest)| Some(Limit { count: count?, largest }))
    }
}

/// A count with its limits.
struct Limit {
    count: Count,
    largest: Option<u8>,
}

impl Limit {
    fn is_kept(&self) -> bool {
        self.count.visible <= self.count.allowed && self.largest.is_none_or(|largest| self.count.largest <= largest)
    }

    /// The part of the allowed number of pixels that differs.
    fn part(&self) -> f64 {
        match (self.count.visible, self.count.allowed) {
            (visible, 0) => visible as f64 * 2.0,
            (visible, allowed) => visible as f64 / allowed as f64,
        }
    }

    /// The used part of the limit on the number of pixels or on their largest difference, whichever is larger.
    fn used(&self) -> f64 {
        let strength = self.largest.map_or(0.0, |largest| f64::from(self.count.largest) / f64::from(largest));
        self.part().max(strength)
    }
}

/// Calls `each` for every pixel of two pictures of one size that is not equal, with its index and its largest difference of a
/// channel.
pub(super) fn differences(expected: &Pixels, actual: &Pixels, each: impl FnMut(usize, u8)) {
    match expected.channels {
        3 => unequal::<3>(&expected.bytes, &actual.bytes, each),
        _ => unequal::<4>(&expected.bytes, &actual.bytes, each),
    }
}

fn unequal<const CHANNELS: usize>(expected: &[u8], actual: &[u8], mut each: impl FnMut(usize, u8)) {
    const BLOCK: usize = 32;
    let blocks = expected.as_chunks::<CHANNELS>().0.chunks(BLOCK).zip(actual.as_chunks::<CHANNELS>().0.chunks(BLOCK));
    // Most pixels are equal, and whole blocks are compared quickly.
    for (block, (expected, actual)) in blocks.enumerate().filter(|(_, (expected, actual))| expected != actual) {
        for (at, (one, other)) in expected.iter().zip(actual).enumerate().filter(|(_, (one, other))| one != other) {
            each(block * BLOCK + at, seen(one, other));
        }
    }
}

/// The largest difference of a channel of two pixels as it is seen: on whatever ground, colours count as much as their opacity.
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
        let differ =
            |count: u64| if count == 1 { "1 pixel differs".to_owned() } else { format!("{count} pixels differ") };
        let may = |count: Count| match count.allowed {
            0 => "none may".to_owned(),
            allowed => format!("{allowed} may"),
        };
        let Count { visible, largest, .. } = self.counted;
        let strict = match self.machines {
            Machines::Same => Some("one machine drew both"),
            Machines::Unknown => Some("neither names its adapter"),
            Machines::OneKind | Machines::OtherKind => None,
        };
        if let Some(why) = strict {
            let pixels = differ(self.unequal);
            return write!(f, "{pixels}, by up to {largest} of 255; none may, because {why}");
        }
        let by = if largest > 0 { format!(", by up to {largest}") } else { String::new() };
        let pixels = format!("{} by more than {CHANNEL} of 255 ({}){by}", differ(visible), may(self.counted));
        let Some((inner, alone)) = self.interiors.zip(self.one_sided) else {
            return f.write_str(&pixels);
        };
        let mut told = [
            format!("along silhouettes {pixels}"),
            format!(
                "between them {} ({}), by up to {} ({CONTRAST} at most)",
                differ(inner.visible),
                may(inner),
                inner.largest
            ),
            format!("in objects of one picture only, {} ({})", differ(alone.visible), may(alone)),
        ];
        // Exceeded tolerances come first.
        let kept: Vec<bool> = self.limits().map(|limit| limit.is_kept()).collect();
        if let Some(wrong) = kept.iter().position(|&kept| !kept) {
            told[..=wrong].rotate_right(1);
        }
        write!(f, "another kind of adapter drew it; {}", told.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{Shown, Tags};

    /// Numbers below 256 that look random.
    struct Numbers(u32);

    impl Numbers {
        fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            self.0 >> 24
        }
    }

    /// A picture of smooth ground with spots, drawn by an adapter.
    fn picture(size: [u32; 2], channels: u32, adapter: &str, seed: u32) -> Pixels {
        // Spots that all pictures have, and some of its own.
        let [mut common, mut own] = [Numbers(7), Numbers(seed)];
        let bytes = (0..size[0] * size[1]).flat_map(|_| {
            let spot = if common.next() < 12 || own.next() < 3 { 90 } else { 0 };
            let faint = u32::from(own.next() < 20) * (own.next() % 5);
            (0..channels).map(move |channel| if channel == 3 { 255 } else { (100 + spot + channel + faint) as u8 })
        });
        let tags = Tags {
            shows: Shown::Frame { frame: 3, time: 0.05 },
            scenes: vec!["1".repeat(64)],
            states: vec![("0".repeat(64), "run".to_owned())],
            version: "0".to_owned(),
            adapter: adapter.to_owned(),
        };
        Pixels { size, channels: channels as usize, bytes: bytes.collect(), label: Some(tags) }
    }

    /// How far pictures of different kinds of adapters are apart, pixel by pixel as it is written in the documentation:
    /// unequal pixels, then those that count and the largest difference along silhouettes, between them, and in one picture
    /// only; and how many pixels lie along silhouettes.
    fn naive(pictures: [&Pixels; 2]) -> ([u64; 4], [u8; 3], u64) {
        let [width, height] = pictures[0].size.map(i64::from);
        let channels = pictures[0].channels;
        let around = |x: i64, y: i64| {
            let near = |at: i64, end: i64| (at - 1).max(0)..(at + 2).min(end);
            near(y, height).flat_map(move |y| near(x, width).map(move |x| (x, y)))
        };
        let byte = |picture: &Pixels, (x, y): (i64, i64), channel: usize| {
            picture.bytes[(y * width + x) as usize * channels + channel]
        };
        let has = |side: usize, x: i64, y: i64| {
            (0..channels).any(|channel| {
                let all = || around(x, y).map(|at| byte(pictures[side], at, channel));
                all().max().unwrap() - all().min().unwrap() > CONTRAST
            })
        };
        let both = |x: i64, y: i64| has(0, x, y) && has(1, x, y);
        let (mut counts, mut largest, mut silhouettes) = ([0; 4], [0; 3], 0);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            silhouettes += u64::from(both(x, y));
            let of = |channel| byte(pictures[0], (x, y), channel).abs_diff(byte(pictures[1], (x, y), channel));
            let difference = (0..channels).map(of).max().unwrap();
            if difference == 0 {
                continue;
            }
            let alone = has(0, x, y) != has(1, x, y) && !around(x, y).any(|(x, y)| both(x, y));
            let (class, least) = match (has(0, x, y) || has(1, x, y)) && !alone {
                true => (0, 2),
                false if alone && difference > 8 => (2, 8),
                false => (1, 2),
            };
            counts[0] += 1;
            counts[class + 1] += u64::from(difference > least);
            if !(alone && class == 1) {
                largest[class] = difference.max(largest[class]);
            }
        }
        (counts, largest, silhouettes)
    }

    #[test]
    fn the_distance_is_what_single_pixels_say() {
        let mut seen = [0; 4];
        let sizes = [[1, 1], [1, 5], [2, 33], [31, 1], [70, 50]];
        for (size, channels) in sizes.into_iter().flat_map(|size| [(size, 3), (size, 4)]) {
            let [expected, actual] = [("soft (1)", 1), ("hard (1)", 2 + size[0])]
                .map(|(adapter, seed)| picture(size, channels, adapter, seed));
            let distance = Distance::new(&expected, &actual).unwrap();
            let (counts, largest, silhouettes) = naive([&expected, &actual]);
            if distance.unequal > 0 {
                let three = [distance.counted, distance.interiors.unwrap(), distance.one_sided.unwrap()];
                let told = [distance.unequal, three[0].visible, three[1].visible, three[2].visible];
                assert_eq!(told, counts, "{size:?} {channels}");
                assert_eq!(three.map(|count| count.largest), largest, "{size:?} {channels}");
                assert_eq!(three[0].allowed, (silhouettes / 4).max(8.min(silhouettes / 100)));
            }
            (0..4).for_each(|at| seen[at] += counts[at]);
        }
        assert!(seen.iter().all(|&count| count > 10), "each kind of pixel occurs: {seen:?}");
    }

    #[test]
    fn adapters_are_told_apart() {
        let [old, new] = ["llvmpipe (LLVM 15, 256 bits) (cpu, vulkan)", "llvmpipe (LLVM 19, 128 bits) (cpu, vulkan)"];
        assert_eq!(Machines::of(Some(old), Some(old)), Machines::Same);
        assert_eq!(Machines::of(Some(old), Some(new)), Machines::OneKind);
        assert_eq!(Machines::of(Some(old), Some("NVIDIA H200 (discrete gpu, vulkan)")), Machines::OtherKind);
        assert_eq!(Machines::of(Some(old), None), Machines::OneKind);
        assert_eq!(Machines::of(None, None), Machines::Unknown);
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
