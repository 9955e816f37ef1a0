//! Where two pictures have silhouettes: there adapters of different kinds differ, and nowhere else.

use super::picture::Pixels;
use rayon::prelude::*;

/// A pixel belongs to a silhouette if a channel changes by more than this within the pixels around it, in both pictures:
/// what is drawn new, or not any more, is none.
pub(super) const CONTRAST: u8 = 8;

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

/// For each pixel of two pictures of one size where it lies.
pub(super) fn silhouettes(pictures: [&Pixels; 2]) -> Vec<Place> {
    let (width, channels) = (pictures[0].size[0] as usize, pictures[0].channels);
    let mut places = vec![Place::Interior; pictures[0].bytes.len() / channels];
    places.par_chunks_mut(width).enumerate().for_each_init(
        || Finder::new(width, channels),
        |finder, (line, places)| {
            places.copy_from_slice(finder.places(pictures.map(|picture| &picture.bytes[..]), line));
        },
    );
    places
}

/// Finds silhouettes row by row, in plain loops over bytes, which compilers turn into vector code.
pub(super) struct Finder {
    channels: usize,
    low: Vec<u8>,
    high: Vec<u8>,
    /// Of each channel of each pixel one bit for each picture that changes there.
    marks: Vec<u8>,
    places: Vec<Place>,
}

impl Finder {
    /// For pictures so wide (px).
    pub(super) fn new(width: usize, channels: usize) -> Self {
        let row = || vec![0; width * channels];
        Self { channels, low: row(), high: row(), marks: row(), places: vec![Place::Interior; width] }
    }

    /// Where the pixels of a line lie, given some rows of both pictures: those above and below, or none if it is the first or
    /// last one.
    pub(super) fn places(&mut self, rows: [&[u8]; 2], line: usize) -> &[Place] {
        self.marks.fill(0);
        for (rows, bit) in rows.into_iter().zip([1, 2]) {
            extremes(rows, line, &mut self.low, &mut self.high);
            mark(&self.low, &self.high, self.channels, bit, &mut self.marks);
        }
        match self.channels {
            3 => gather::<3>(&self.marks, &mut self.places),
            _ => gather::<4>(&self.marks, &mut self.places),
        }
        &self.places
    }
}

/// Puts the channels of pixels together.
fn gather<const CHANNELS: usize>(marks: &[u8], places: &mut [Place]) {
    for (place, marks) in places.iter_mut().zip(marks.as_chunks::<CHANNELS>().0) {
        *place = match marks.iter().fold(0, |all, mark| all | mark) {
            0 => Place::Interior,
            3 => Place::Silhouette,
            _ => Place::HalfSilhouette,
        };
    }
}

/// The least and the greatest of each byte of a row, the one above and the one below.
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

/// Marks bytes where the greatest of three pixels side by side lies far above the least.
fn mark(low: &[u8], high: &[u8], channels: usize, bit: u8, marks: &mut [u8]) {
    let row = low.len();
    if row < 3 * channels {
        // One or two pixels in a row.
        for (at, mark) in marks.iter_mut().enumerate() {
            let beside = || (at % channels..row).step_by(channels);
            let least = beside().map(|at| low[at]).min().unwrap_or(0);
            let greatest = beside().map(|at| high[at]).max().unwrap_or(0);
            *mark |= if greatest - least > CONTRAST { bit } else { 0 };
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
}
