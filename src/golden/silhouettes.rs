//! Finds the silhouettes of two pictures: only there may adapters of different kinds differ.

use super::picture::Pixels;

/// A pixel belongs to a silhouette if a channel changes by more than this among the pixels around it in both pictures; objects
/// in one picture only have none.
pub(super) const CONTRAST: u8 = 8;

/// The location of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Along a silhouette, a line or a letter of both pictures.
    Silhouette,
    /// Along one that only one of the pictures has, away from those of both.
    OneSided,
    /// Where both are smooth.
    Interior,
}

/// The location of each pixel of two pictures of one size.
pub(super) fn silhouettes(pictures: [&Pixels; 2]) -> Vec<Place> {
    let [width, height] = pictures[0].size.map(|side| side as usize);
    let mut finder = Finder::new(width, pictures[0].channels);
    let mut places = Vec::with_capacity(width * height);
    for line in 0..height {
        finder.advance(pictures.map(|picture| &picture.bytes[..]), line);
        if line > 0 {
            places.extend((0..width).map(|at| finder.place(at)));
        }
    }
    finder.end();
    places.extend((0..width).map(|at| finder.place(at)));
    places
}

/// Finds silhouettes row by row, in plain loops over bytes, which compilers turn into vector code.
pub(super) struct Finder {
    channels: usize,
    low: Vec<u8>,
    high: Vec<u8>,
    /// Of each channel of each pixel one bit for each picture that changes there.
    marks: Vec<u8>,
    /// The line before that which is asked about, that line, and the next one.
    lines: [Vec<Place>; 3],
}

impl Finder {
    /// For pictures so wide (px).
    pub(super) fn new(width: usize, channels: usize) -> Self {
        let row = || vec![0; width * channels];
        let lines = [(); 3].map(|()| vec![Place::Interior; width]);
        Self { channels, low: row(), high: row(), marks: row(), lines }
    }

    /// Adds a line, given its rows of both pictures and those above and below, if any. Afterwards locations are known for the
    /// line before it. Returns how many pixels of that line are along silhouettes.
    pub(super) fn advance(&mut self, rows: [&[u8]; 2], line: usize) -> u64 {
        self.marks.fill(0);
        for (rows, bit) in rows.into_iter().zip([1, 2]) {
            extremes(rows, line, &mut self.low, &mut self.high);
            mark(&self.low, &self.high, self.channels, bit, &mut self.marks);
        }
        self.lines.rotate_left(1);
        let places = &mut self.lines[2];
        match self.channels {
            3 => gather::<3>(&self.marks, places),
            _ => gather::<4>(&self.marks, places),
        }
        let count: u32 = places.iter().map(|&place| u32::from(place == Place::Silhouette)).sum();
        count.into()
    }

    /// Ends after the last line.
    pub(super) fn end(&mut self) {
        self.lines.rotate_left(1);
        self.lines[2].fill(Place::Interior);
    }

    /// Where a pixel of the line before that which was given last lies.
    pub(super) fn place(&self, at: usize) -> Place {
        match self.lines[1][at] {
            // Where drivers disagree about a silhouette, it continues one nearby.
            Place::OneSided if self.touches(at) => Place::Silhouette,
            place => place,
        }
    }

    fn touches(&self, at: usize) -> bool {
        let near = at.saturating_sub(1)..(at + 2).min(self.lines[1].len());
        self.lines.iter().any(|line| line[near.clone()].contains(&Place::Silhouette))
    }
}

/// Combines the channels of pixels.
fn gather<const CHANNELS: usize>(marks: &[u8], places: &mut [Place]) {
    for (place, marks) in places.iter_mut().zip(marks.as_chunks::<CHANNELS>().0) {
        *place = match marks.iter().fold(0, |all, mark| all | mark) {
            0 => Place::Interior,
            3 => Place::Silhouette,
            _ => Place::OneSided,
        };
    }
}

/// Minimum and maximum of each byte over a row, the one above and the one below.
fn extremes(rows: &[u8], line: usize, low: &mut [u8], high: &mut [u8]) {
    let row = low.len();
    let last = rows.len() / row - 1;
    let part = |line: usize| &rows[line * row..(line + 1) * row];
    let three = part(line.saturating_sub(1)).iter().zip(part(line)).zip(part((line + 1).min(last)));
    for ((low, high), ((&a, &b), &c)) in low.iter_mut().zip(high.iter_mut()).zip(three) {
        *low = a.min(b).min(c);
        *high = a.max(b).max(c);
    }
}

/// Marks bytes where the maximum of three adjacent pixels is far above the minimum.
fn mark(low: &[u8], high: &[u8], channels: usize, bit: u8, marks: &mut [u8]) {
    let row = low.len();
    if row < 2 * channels {
        // A single pixel in a row.
        for (mark, (low, high)) in marks.iter_mut().zip(low.iter().zip(high)) {
            *mark |= if high - low > CONTRAST { bit } else { 0 };
        }
        return;
    }
    let [inner, right] = [row - 2 * channels, 2 * channels];
    let three = low[..inner].iter().zip(&low[channels..]).zip(&low[right..]);
    let greatest = high[..inner].iter().zip(&high[channels..]).zip(&high[right..]);
    for ((mark, ((&a, &b), &c)), ((&d, &e), &f)) in marks[channels..].iter_mut().zip(three).zip(greatest) {
        *mark |= if d.max(e).max(f) - a.min(b).min(c) > CONTRAST { bit } else { 0 };
    }
    for at in (0..channels).chain(row - channels..row) {
        let beside = if at < channels { at + channels } else { at - channels };
        let contrast = high[at].max(high[beside]) - low[at].min(low[beside]);
        marks[at] |= if contrast > CONTRAST { bit } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silhouettes_are_where_colours_change() {
        let mut bytes = vec![100; 9 * 7 * 3];
        bytes[(3 * 9 + 4) * 3 + 1] = 100 + CONTRAST + 1;
        let flat = Pixels { size: [9, 7], channels: 3, bytes: vec![100; 9 * 7 * 3], label: None };
        let spot = Pixels { bytes, ..flat.clone() };
        assert!(silhouettes([&flat, &flat]).iter().all(|&place| place == Place::Interior));
        for (two, near) in
            [([&flat, &spot], Place::OneSided), ([&spot, &flat], Place::OneSided), ([&spot, &spot], Place::Silhouette)]
        {
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
}
