//! Pictures for print: sizes in millimetres and type in points.

use crate::reading::collector::Here;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Millimetres and points in an inch.
const INCH_MM: f64 = 25.4;
const INCH_POINTS: f64 = 72.0;
/// The most pixels of a side.
const MOST_PIXELS: f64 = 16384.0;
/// The usual type of a picture (px at the reference size).
const TYPE: f64 = 16.0;
/// The range of scales of type in points: small pictures have large type.
const SCALES: [f64; 2] = [0.5, 4.0];

/// The size of a picture as typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum SizeFile {
    /// Width and height (px).
    Pixels(#[schemars(inner(range(min = 16, max = 16384)))] [u32; 2]),
    /// For print: width and height (mm), such as `{ mm = [180, 101] }`.
    Print(Print),
}

/// A size in print.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Print {
    /// Width and height (mm).
    #[schemars(inner(range(min = 5.0, max = 2000.0)))]
    pub mm: [f64; 2],
    /// Pixels per inch of PNG files, which record it, and of lit bodies in SVG and PDF files.
    #[serde(default = "dpi")]
    #[schemars(range(min = 72.0, max = 1200.0))]
    pub dpi: f64,
    /// The file with the size, for messages, with line and column; both are 0 for an option, and the name is empty for
    /// the scene's file.
    #[serde(skip)]
    pub(crate) file: String,
    #[serde(skip)]
    pub(crate) at: (usize, usize),
}

fn dpi() -> f64 {
    300.0
}

/// The scale of type as typed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub(crate) enum TextScaleFile {
    /// A multiple of the usual size.
    Times(#[schemars(range(min = 0.5, max = 3.0))] f64),
    /// In pictures for print: the size of most type, such as `{ pt = 7 }`. Names are larger, numbers at axes smaller.
    Points {
        /// Size of most type (pt).
        #[schemars(range(min = 5.0, max = 72.0))]
        pt: f64,
    },
}

impl Print {
    /// A size of type (px) in points.
    pub(crate) fn points(&self, pixels: f64) -> f64 {
        pixels / self.dpi * INCH_POINTS
    }
}

impl SizeFile {
    /// Width and height (px), and the size in print if it was typed.
    pub(crate) fn resolve(self, least: u32, here: &Here<'_>) -> Option<([u32; 2], Option<Print>)> {
        let print = match self {
            Self::Pixels(size) => return Some((size, None)),
            Self::Print(print) => Print { at: here.position(), ..print },
        };
        let Print { mm, dpi, .. } = print;
        let sides = mm.map(|length| (length / INCH_MM * dpi).round());
        if sides.iter().any(|&side| side < f64::from(least) || side > MOST_PIXELS) {
            let ([width, height], [wide, high]) = (sides, mm);
            let message = format!(
                "a picture of {wide} × {high} mm has {width} × {height} pixels at {dpi} dpi; expected {least} to \
                 {MOST_PIXELS} a side"
            );
            here.wrong(message, "change `mm` or `dpi`");
            return None;
        }
        Some((sides.map(|side| side as u32), Some(print)))
    }
}

impl TextScaleFile {
    /// The scale of type, in a picture with a number of pixels per reference pixel.
    pub(crate) fn resolve(self, print: Option<&Print>, unit: f64, here: &Here<'_>) -> Option<f64> {
        let pt = match self {
            Self::Times(times) => return Some(times),
            Self::Points { pt } => pt,
        };
        let Some(print) = print else {
            let message = format!("type of {pt} pt needs a size in print, but this picture has one in pixels");
            here.wrong(message, "give `size` in millimetres, such as { mm = [180, 101] }");
            return None;
        };
        let usual = print.points(TYPE * unit);
        let (times, [least, most]) = (pt / usual, SCALES);
        if !(least..=most).contains(&times) {
            // Limits that are told are within the true ones.
            let [low, high] = [(10.0 * least * usual).ceil() / 10.0, (10.0 * most * usual).floor() / 10.0];
            let message = format!("type of {pt} pt does not fit a picture of this size; expected {low} to {high} pt");
            here.wrong(message, "change `pt` or `size`");
            return None;
        }
        Some(times)
    }
}

/// Pixels per pixel of the reference picture, for a picture and panels of these sizes (px). It is one for a picture 720
/// high, or with panels of 540 × 460.
pub(crate) fn unit(size: [u32; 2], panel: [u32; 2]) -> f64 {
    const HEIGHT: f64 = 720.0;
    const PANEL: [f64; 2] = [540.0, 460.0];
    let [width, height] = panel.map(f64::from);
    (f64::from(size[1]) / HEIGHT).min(width / PANEL[0]).min(height / PANEL[1])
}

/// Pixels per pixel of the reference picture, for a sheet; one at 1600 × 900. It follows the root of the area, and in tall sheets the
/// width. Smaller sheets have fewer parts, not smaller type.
pub(crate) fn unit_of_sheet([width, height]: [u32; 2]) -> f64 {
    const SIZE: [f64; 2] = [1600.0, 900.0];
    const LEAST: f64 = 0.36;
    let [wide, high] = [f64::from(width) / SIZE[0], f64::from(height) / SIZE[1]];
    wide.min(libm::sqrt(wide * high)).max(LEAST)
}

#[cfg(test)]
mod tests {
    use super::unit_of_sheet;

    #[test]
    fn type_of_sheets_follows_their_area_and_in_narrow_ones_their_width() {
        assert_eq!([[1600, 900], [3200, 1800], [1600, 1800]].map(unit_of_sheet), [1.0, 2.0, 1.0]);
        assert_eq!([[1600, 400], [16, 16]].map(unit_of_sheet), [2.0 / 3.0, 0.36]);
    }
}
