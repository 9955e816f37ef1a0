//! The distance of two pictures, and the tolerances.
//!
//! One machine draws the same bytes every time. Machines of one kind round differently, and in rare cases take another sample
//! where a silhouette passes through the corner of a pixel. Another kind of adapter has other sample positions: pixels
//! differ a little along all silhouettes, but those between them must be the same.

#[cfg(test)]
use super::picture::Pixels;
use super::silhouettes::{CONTRAST, Finder, Place};
use crate::output::Tags;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

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

/// What is known of the machines that drew two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Machines {
    /// The same adapter with the same driver, for software on the same type of processor: not a byte may differ.
    Same,
    /// Neither picture says who drew it, so that nothing excuses a difference.
    Unknown,
    /// Adapters of one kind, or one of the pictures does not say.
    OneKind,
    /// Adapters of different kinds.
    OtherKind,
}

impl Machines {
    /// What two adapters, as pictures name them, are to each other.
    pub(crate) fn of(expected: Option<&str>, actual: Option<&str>) -> Self {
        match (expected, actual) {
            (None, None) => Self::Unknown,
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
    /// What the limits are made for.
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
    /// That of two pictures; `None` if their sizes or channels are not alike.
    #[cfg(test)]
    pub(crate) fn new(expected: &Pixels, actual: &Pixels) -> Option<Self> {
        if expected.size != actual.size || expected.channels != actual.channels {
            return None;
        }
        let labels = [expected.label.as_ref(), actual.label.as_ref()];
        let mut tally = Tally::new(expected.size, expected.channels, labels);
        tally.count([&expected.bytes, &actual.bytes], 0..expected.size[1] as usize);
        Some(tally.distance())
    }

    /// Whether it is no more than such machines differ.
    pub(crate) fn is_allowed(&self) -> bool {
        self.limits().all(|limit| limit.is_kept())
    }

    /// How much of what is allowed is used: 1 at the limit, and more if there is too much.
    pub(crate) fn of_limit(&self) -> f64 {
        self.limits().map(|limit| limit.used()).fold(0.0, f64::max)
    }

    /// Pixels that differ and how many may, of those of which most that may differ do.
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

/// How many pixels may differ, and by how much if that is limited.
struct Limit {
    count: Count,
    largest: Option<u8>,
}

impl Limit {
    fn is_kept(&self) -> bool {
        self.count.visible <= self.count.allowed && self.largest.is_none_or(|largest| self.count.largest <= largest)
    }

    /// How many of the pixels that may differ do.
    fn part(&self) -> f64 {
        match (self.count.visible, self.count.allowed) {
            (visible, 0) => visible as f64 * 2.0,
            (visible, allowed) => visible as f64 / allowed as f64,
        }
    }

    /// How much is used of what is allowed, be it their number or their largest difference.
    fn used(&self) -> f64 {
        let strength = self.largest.map_or(0.0, |largest| f64::from(self.count.largest) / f64::from(largest));
        self.part().max(strength)
    }
}

/// Counts how far two pictures are apart while their rows come: whole pictures are large.
pub(super) struct Tally {
    machines: Machines,
    size: [u32; 2],
    channels: usize,
    /// Lines that were given.
    given: u32,
    counts: Counts,
    /// Pixels along silhouettes, which are looked for if the machines are of different kinds.
    of_silhouettes: u64,
    finder: Option<Finder>,
}

#[derive(Default)]
struct Counts {
    unequal: u64,
    counted: Count,
    interiors: Count,
    one_sided: Count,
}

impl Tally {
    /// For pictures of one size, by what they say of themselves.
    pub(super) fn new(size: [u32; 2], channels: usize, labels: [Option<&Tags>; 2]) -> Self {
        let [expected, actual] = labels.map(|label| label.map(|label| label.adapter.as_str()));
        let machines = Machines::of(expected, actual);
        let finder = (machines == Machines::OtherKind).then(|| Finder::new(size[0] as usize, channels));
        Self { machines, size, channels, given: 0, counts: Counts::default(), of_silhouettes: 0, finder }
    }

    /// Adds some lines, given the same rows of both pictures: these lines, and those just above and below if there are any.
    pub(super) fn count(&mut self, rows: [&[u8]; 2], lines: Range<usize>) {
        let row = self.size[0] as usize * self.channels;
        let part = |line: usize| rows.map(|rows| &rows[line * row..(line + 1) * row]);
        for line in lines {
            self.given += 1;
            let Some(finder) = &mut self.finder else {
                self.counts.add(part(line), self.channels, |_| Place::Silhouette);
                continue;
            };
            self.of_silhouettes += finder.advance(rows, line);
            if self.given > 1 {
                self.counts.add(part(line - 1), self.channels, |at| finder.place(at));
            }
            if self.given == self.size[1] {
                finder.end();
                self.counts.add(part(line), self.channels, |at| finder.place(at));
            }
        }
    }

    /// How far apart they are.
    pub(super) fn distance(self) -> Distance {
        let Self { machines, size, of_silhouettes, counts, .. } = self;
        let Counts { unequal, mut counted, mut interiors, mut one_sided } = counts;
        let all = u64::from(size[0]) * u64::from(size[1]);
        // In very small pictures the tolerance is smaller.
        let part = |part: f64, of: u64| AT_LEAST.min(of / 100).max((part * of as f64) as u64);
        if machines == Machines::OtherKind && unequal > 0 {
            counted.allowed = part(PART_OF_SILHOUETTES, of_silhouettes);
            interiors.allowed = part(PART_OF_INTERIORS, all - of_silhouettes);
            one_sided.allowed = part(0.0, all);
            return Distance { machines, unequal, counted, interiors: Some(interiors), one_sided: Some(one_sided) };
        }
        counted.allowed = if machines == Machines::OneKind { part(PART, all) } else { 0 };
        Distance { machines, unequal, counted, interiors: None, one_sided: None }
    }
}

impl Counts {
    /// Adds a line of both pictures.
    fn add(&mut self, [expected, actual]: [&[u8]; 2], channels: usize, place: impl Fn(usize) -> Place) {
        differences(expected, actual, channels, |at, difference| {
            self.unequal += 1;
            let (count, least) = match place(at) {
                Place::Silhouette => (&mut self.counted, CHANNEL),
                Place::OneSided if difference > CONTRAST => (&mut self.one_sided, CONTRAST),
                Place::OneSided => {
                    self.interiors.visible += u64::from(difference > CHANNEL);
                    return;
                }
                Place::Interior => (&mut self.interiors, CHANNEL),
            };
            count.visible += u64::from(difference > least);
            count.largest = difference.max(count.largest);
        });
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
