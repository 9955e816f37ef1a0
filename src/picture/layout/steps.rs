//! The scale of all distances in pictures (px in the reference picture), which follow from the usual size of type.

/// The widths of strokes: hairlines and leaders, thin lines, curves, heavy lines.
pub(in crate::picture) const HAIR: f64 = 1.0;
pub(in crate::picture) const THIN: f64 = 1.3;
pub(in crate::picture) const STRONG: f64 = 2.0;
pub(in crate::picture) const BOLD: f64 = 2.5;

/// The sizes of type: names and counts, words, numbers in charts.
pub(in crate::picture) const NAME: f64 = 26.0;
pub(in crate::picture) const TEXT: f64 = 16.0;
pub(in crate::picture) const SMALL: f64 = 14.0;

/// Around words that lie on lines; from the end of a line to its leader.
pub(in crate::picture) const FREE: f64 = 3.0;
/// Ticks; half the size of small signs.
pub(in crate::picture) const TICK: f64 = 4.0;
/// The least distance of unlike things.
pub(in crate::picture) const CLOSE: f64 = 6.0;
/// Between words and bodies.
pub(in crate::picture) const NEAR: f64 = 8.0;
/// The radius of rings with letters.
pub(in crate::picture) const RING: f64 = 10.0;
/// Between a mark and its words; inside the borders of panels.
pub(in crate::picture) const BESIDE: f64 = 12.0;
/// Between words of one line.
pub(in crate::picture) const GAP: f64 = 16.0;
/// The shortest bars; below the lowest words of a picture.
pub(in crate::picture) const SHORT: f64 = 20.0;
/// Rows of words.
pub(in crate::picture) const ROW: f64 = 22.0;
/// Rows of words with rings, and rows of names and counts.
pub(in crate::picture) const TALL_ROW: f64 = 24.0;
pub(in crate::picture) const NAME_ROW: f64 = 34.0;
/// Between numbers along an axis and between charts; the lowest curves; samples of lines.
pub(in crate::picture) const APART: f64 = 30.0;
/// The margin of a picture; rows of its title; between parts of one row.
pub(in crate::picture) const MARGIN: f64 = 40.0;
/// The usual length of arrows in keys; the lowest bodies of sheets.
pub(in crate::picture) const BLOCK: f64 = 60.0;
/// Beside a body, for the words at its arrows.
pub(in crate::picture) const ROOM: f64 = 84.0;
/// The longest scale bars; a chart with its words.
pub(in crate::picture) const CHART: f64 = 120.0;
/// The width of a sample with its words in a key; a tile of a sheet with usual lines; the highest chart.
pub(in crate::picture) const TILE: f64 = 240.0;
