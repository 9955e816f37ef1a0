//! Two pictures of one name: decoded together and compared in bands of rows, so that neither is in memory as a whole.

use super::Compared;
use super::distance::{Distance, Tally};
use super::picture::{Header, PictureError, Rows};
use super::side::{Source, frame_of};
use super::verdict::Verdict;
use crate::output::Label;
use std::error::Error;
use std::ops::Range;

/// Rows that are decoded before they are compared: few enough to stay in a processor's cache. Whole pictures of 1280×720 pixels
/// cause 1400 page faults, which take about as long as decoding both.
const BAND: usize = 16;

/// A pair of pictures as it was read.
pub(super) struct Pair {
    /// The name of the file, or of the actual one.
    pub(super) name: String,
    /// What both say of themselves.
    pub(super) labels: [Option<Label>; 2],
    verdict: Verdict,
}

impl Pair {
    /// Reads what there is of a pair, and judges it.
    pub(super) fn read(name: String, sources: [Option<Source>; 2]) -> Self {
        let files = sources.each_ref().map(|source| source.as_ref().map(Source::bytes));
        let (read, distance) = match files {
            [Some(Ok(expected)), Some(Ok(actual))] => {
                let (read, distance) = both([&expected, &actual]);
                (read.map(Some), distance)
            }
            // Damage is reported even if there is only one picture.
            files => (files.map(|file| file.map(|file| whole(&file?))), None),
        };
        let told = |at: usize| {
            let error = read[at].as_ref()?.as_ref().err()?;
            Some(told(sources[at].as_ref()?, ["expected", "actual"][at], error))
        };
        let message: Vec<String> = [0, 1].into_iter().filter_map(told).collect();
        let headers = read.map(|side| side.and_then(Result::ok));
        let verdict = match &headers {
            _ if !message.is_empty() => Verdict::Unreadable { message: message.join("; ") },
            [Some(expected), Some(actual)] => {
                let labels = [expected.label.as_ref(), actual.label.as_ref()];
                Verdict::of(labels, [expected.size, actual.size], distance)
            }
            [None, Some(_)] => Verdict::Extra,
            [_, None] => Verdict::Missing,
        };
        Self { name, labels: headers.map(|header| header?.label), verdict }
    }

    /// What is said of it.
    pub(super) fn compared(self) -> Compared {
        let frame = self.labels.iter().flatten().find_map(frame_of);
        Compared { name: self.name, frame, verdict: self.verdict }
    }
}

fn told(source: &Source, side: &str, error: &PictureError) -> String {
    let place = match source {
        Source::File(path) => path.display().to_string(),
        Source::Memory(_) => format!("the {side} picture"),
    };
    error.source().map_or_else(|| format!("{place}: {error}"), |cause| format!("{place}: {error}: {cause}"))
}

/// What a picture is that can be read to its end.
fn whole(bytes: &[u8]) -> Outcome {
    let mut stream = Stream::open(bytes)?;
    while stream.goes_on() {
        stream.advance();
    }
    stream.end()
}

/// What became of reading a picture.
type Outcome = Result<Header, PictureError>;

/// What two pictures are, and how far they are apart; nothing of that if their sizes or channels are not alike.
fn both(files: [&[u8]; 2]) -> ([Outcome; 2], Option<Distance>) {
    if files[0] == files[1] {
        // Most pairs that pass are equal files, which are read once. If one is damaged, so are both.
        return match whole(files[0]) {
            Ok(header) => {
                let distance = tally([&header, &header]).map(Tally::distance);
                ([Ok(header.clone()), Ok(header)], distance)
            }
            Err(error) => ([Err(error), whole(files[1])], None),
        };
    }
    let (mut one, mut other) = match files.map(Stream::open) {
        [Ok(one), Ok(other)] => (one, other),
        [Err(error), _] => return ([Err(error), whole(files[1])], None),
        [Ok(_), Err(error)] => return ([whole(files[0]), Err(error)], None),
    };
    let mut tally = tally([&one.rows.header, &other.rows.header]);
    while one.goes_on() || other.goes_on() {
        one.advance();
        other.advance();
        if let Some(tally) = tally.as_mut().filter(|_| one.error.is_none() && other.error.is_none()) {
            tally.count([one.band(), other.band()], one.lines());
        }
    }
    let read = [one.end(), other.end()];
    (read, tally.map(Tally::distance))
}

/// One for two pictures, if they can be compared.
fn tally([expected, actual]: [&Header; 2]) -> Option<Tally> {
    let are_alike = expected.size == actual.size && expected.channels == actual.channels;
    let labels = [expected.label.as_ref(), actual.label.as_ref()];
    are_alike.then(|| Tally::new(expected.size, expected.channels, labels))
}

/// A picture of which a few rows are there at a time.
struct Stream<'a> {
    rows: Rows<'a>,
    /// Room for rows one after another: the last two that were there before, and those that came.
    band: Vec<u8>,
    /// How many there are, and how many of them were there before.
    filled: usize,
    kept: usize,
    /// Rows that are still to come.
    left: usize,
    error: Option<PictureError>,
}

impl<'a> Stream<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, PictureError> {
        let rows = Rows::open(bytes)?;
        let (row, left) = (rows.header.row(), rows.header.rows());
        Ok(Self { rows, band: vec![0; (left.min(BAND) + 2) * row], filled: 0, kept: 0, left, error: None })
    }

    fn goes_on(&self) -> bool {
        self.left > 0
    }

    /// Reads the next rows.
    fn advance(&mut self) {
        if self.left == 0 {
            return;
        }
        let row = self.rows.header.row();
        self.kept = self.filled.min(2);
        self.band.copy_within((self.filled - self.kept) * row..self.filled * row, 0);
        let more = self.left.min(BAND);
        self.filled = self.kept + more;
        self.left -= more;
        let read = self.rows.read(&mut self.band[self.kept * row..self.filled * row]);
        let read = if self.left == 0 { read.and_then(|()| self.rows.finish()) } else { read };
        if let Err(error) = read {
            self.left = 0;
            self.error = Some(error);
        }
    }

    /// The rows that are there.
    fn band(&self) -> &[u8] {
        &self.band[..self.filled * self.rows.header.row()]
    }

    /// Those of them that are not compared yet and have both their neighbours there.
    fn lines(&self) -> Range<usize> {
        usize::from(self.kept > 0)..self.filled - usize::from(self.left > 0)
    }

    fn end(self) -> Outcome {
        debug_assert!(!self.goes_on(), "what is damaged may still come");
        self.error.map_or(Ok(self.rows.header), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::Pixels;
    use super::super::silhouettes::CONTRAST;
    use super::*;
    use crate::output::Tags;

    /// Numbers below 256 that look random.
    struct Numbers(u32);

    impl Numbers {
        fn next(&mut self) -> u32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            self.0 >> 24
        }
    }

    fn file(size: [u32; 2], adapter: &str, pixels: &[u8]) -> Vec<u8> {
        let tags = Tags {
            scene: "1".repeat(64),
            states: vec![("0".repeat(64), "run".to_owned())],
            frame: 3,
            time: 0.05,
            version: "0".to_owned(),
            adapter: adapter.to_owned(),
        };
        Label::Frame(tags).encode(size, pixels)
    }

    /// A picture of smooth ground with spots, as a PNG file of an adapter.
    fn picture(size: [u32; 2], channels: u32, adapter: &str, seed: u32) -> Vec<u8> {
        // Spots that all pictures have, and some of its own.
        let [mut common, mut own] = [Numbers(7), Numbers(seed)];
        let pixels = (0..size[0] * size[1]).flat_map(|_| {
            let spot = if common.next() < 12 || own.next() < 3 { 90 } else { 0 };
            let faint = u32::from(own.next() < 20) * (own.next() % 5);
            (0..channels).map(move |channel| if channel == 3 { 255 } else { (100 + spot + channel + faint) as u8 })
        });
        file(size, adapter, &pixels.collect::<Vec<_>>())
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
    fn bands_say_what_single_pixels_say() {
        let mut seen = [0; 4];
        for channels in [3, 4] {
            for width in [1, 2, 3, 31, 32, 33, 70] {
                for height in [1, 2, 3, 15, 16, 17, 18, 19, 33, 50] {
                    let size = [width, height];
                    let files =
                        [picture(size, channels, "soft (1)", 1), picture(size, channels, "hard (1)", 2 + width)];
                    let [expected, actual] = [0, 1].map(|at: usize| Pixels::from_bytes(&files[at]).unwrap());
                    let (read, distance) = both([&files[0], &files[1]]);
                    let distance = distance.unwrap();
                    assert_eq!(Some(distance), Distance::new(&expected, &actual), "{size:?} {channels}");
                    let (counts, largest, silhouettes) = naive([&expected, &actual]);
                    if distance.unequal > 0 {
                        let three = [distance.counted, distance.interiors.unwrap(), distance.one_sided.unwrap()];
                        let told = [distance.unequal, three[0].visible, three[1].visible, three[2].visible];
                        assert_eq!(told, counts, "{size:?} {channels}");
                        assert_eq!(three.map(|count| count.largest), largest, "{size:?} {channels}");
                        assert_eq!(three[0].allowed, (silhouettes / 4).max(8.min(silhouettes / 100)));
                    }
                    (0..4).for_each(|at| seen[at] += counts[at]);
                    assert_eq!(read.map(|header| header.unwrap().label), [expected.label, actual.label]);
                }
            }
        }
        assert!(seen.iter().all(|&count| count > 50), "each kind of pixel occurs: {seen:?}");
    }

    #[test]
    fn each_damage_is_found_wherever_it_is() {
        let good = picture([29, 50], 3, "soft (1)", 1);
        for at in [60, good.len() / 2, good.len() - 20, good.len() - 1] {
            let cut = &good[..at];
            let other = picture([29, 50], 3, "soft (1)", 2);
            let sound = |files: [&[u8]; 2]| both(files).0.map(|read| read.is_ok());
            assert_eq!(sound([cut, &other]), [false, true], "{at}");
            assert_eq!(sound([&other, cut]), [true, false], "{at}");
            assert_eq!(sound([cut, cut]), [false, false], "{at}");
            assert_eq!(sound([cut, &other[..other.len() - 9]]), [false, false], "{at}");
        }
        let memory = |file: &[u8]| Some(Source::Memory(file.to_vec()));
        let pair = Pair::read("two.png".to_owned(), [memory(&good[..60]), memory(&good[..70])]);
        let Verdict::Unreadable { message } = &pair.verdict else { panic!("{}", pair.verdict) };
        assert!(message.contains("the expected picture: ") && message.contains("; the actual picture: "), "{message}");
    }

    #[test]
    fn pictures_of_two_kinds_are_read_to_their_ends() {
        let [tall, low] = [50, 20].map(|height| picture([29, height], 3, "soft (1)", 1));
        let clear = picture([29, 50], 4, "soft (1)", 1);
        for other in [&low, &clear] {
            let (read, distance) = both([&tall, other]);
            assert!(read.iter().all(Result::is_ok) && distance.is_none());
            assert!(both([&tall[..tall.len() - 1], other]).0[0].is_err());
        }
    }
}
