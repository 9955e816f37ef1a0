//! Finds the silhouettes of two pictures: only there may adapters of different kinds differ.

use super::picture::Pixels;

/// A pixel belongs to a silhouette if a channel changes by more than this among the pixels around it in both pictures; objects
/// in one picture only have none.
pub(super) const CONTRAST: u8 = 8;

/// The location of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Location {
    /// Along a silhouette, a line or a letter of both pictures.
    Silhouette,
    /// Along one of a single picture, next to one of both: adapters disagree by a pixel about where it ends.
    Beside,
    /// Along one of a single picture, away from those of both.
    OneSided,
    /// Where both are smooth.
    Interior,
}

/// The location of each pixel of two pictures of one size.
pub(super) fn silhouettes(pictures: [&Pixels; 2]) -> Vec<Location> {
    let [width, height] = pictures[0].size.map(|side| side as usize);
    let channels = pictures[0].channels;
    let [mut low, mut high, mut marks] = [(); 3].map(|()| vec![0; width * channels]);
    let mut places = Vec::with_capacity(width * height);
    for line in 0..height {
        // Each channel of each pixel has one bit for each picture that changes there.
        marks.fill(0);
        for (picture, bit) in pictures.into_iter().zip([1, 2]) {
            extremes(&picture.bytes, line, &mut low, &mut high);
            mark(&low, &high, channels, bit, &mut marks);
        }
        places.extend(marks.chunks_exact(channels).map(|marks| match marks.iter().fold(0, |all, mark| all | mark) {
            0 => Location::Interior,
            3 => Location::Silhouette,
            _ => Location::OneSided,
        }));
    }
    for at in 0..places.len() {
        if places[at] == Location::OneSided {
            let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
            let mut rows = near(at / width, height).map(|y| y * width);
            if rows.any(|row| near(at % width, width).any(|x| places[row + x] == Location::Silhouette)) {
                places[at] = Location::Beside;
            }
        }
    }
    places
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
        assert!(silhouettes([&flat, &flat]).iter().all(|&place| place == Location::Interior));
        for (two, near) in [
            ([&flat, &spot], Location::OneSided),
            ([&spot, &flat], Location::OneSided),
            ([&spot, &spot], Location::Silhouette),
        ] {
            for (at, place) in silhouettes(two).into_iter().enumerate() {
                let is_near = (at / 9).abs_diff(3) <= 1 && (at % 9).abs_diff(4) <= 1;
                assert_eq!(place, if is_near { near } else { Location::Interior }, "{at}");
            }
        }
    }
}
