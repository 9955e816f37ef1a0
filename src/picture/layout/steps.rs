//! The distances of a page and of the words in its panels (px in the reference picture), which follow from the usual size
//! of type.

/// The sizes of type: names and counts, words, numbers in charts.
pub(in crate::picture) const NAME: f64 = 26.0;
pub(in crate::picture) const TEXT: f64 = 16.0;
pub(in crate::picture) const SMALL: f64 = 14.0;

/// Between words and bodies.
pub(in crate::picture) const NEAR: f64 = 8.0;
/// Between a mark and its words; inside the borders of panels.
pub(in crate::picture) const BESIDE: f64 = 12.0;
/// Between words of one line.
pub(in crate::picture) const GAP: f64 = 16.0;
/// Rows of words.
pub(in crate::picture) const ROW: f64 = 22.0;
/// Rows of words with rings, and rows of names and counts.
pub(in crate::picture) const TALL_ROW: f64 = 24.0;
pub(in crate::picture) const NAME_ROW: f64 = 34.0;
/// The margin of a picture; rows of its title; between parts of one row.
pub(in crate::picture) const MARGIN: f64 = 40.0;
/// The shortest bars; below the lowest words of a picture.
pub(in crate::picture) const SHORT: f64 = 20.0;
