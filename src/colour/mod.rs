//! Colours as numbers: luminance, mixing, contrast and colour difference, also for colour-blind eyes. Independent of
//! scenes and pictures.
//!
//! CIEDE2000 and Oklab are written out here, 60 lines tested against published numbers: the small crates for them compute in
//! single precision, and `palette` adds four crates and some 5 s to a clean build.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod difference;
mod oklab;

#[cfg(test)]
pub(crate) use difference::{Lab, cie76, seen_by};
pub(crate) use difference::{Vision, difference, least_difference};
pub use difference::{ciede2000, lab};
pub(crate) use oklab::{Oklab, from_oklab, oklab};

/// An opaque colour: red, green, blue, as sRGB bytes.
pub type Colour = [u8; 3];

/// A colour as linear light, each channel from 0 to 1.
pub fn linear(colour: Colour) -> [f64; 3] {
    colour.map(|byte| {
        let encoded = f64::from(byte) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
    })
}

/// Linear light as the nearest sRGB bytes; values out of range are clamped.
pub(crate) fn encoded(linear: [f64; 3]) -> Colour {
    encoded_exactly(linear).map(|byte| byte.round() as u8)
}

/// Linear light as sRGB, from 0 to 255, without rounding; values out of range are clamped.
pub(crate) fn encoded_exactly(linear: [f64; 3]) -> [f64; 3] {
    linear.map(|light| {
        let light = light.clamp(0.0, 1.0);
        let encoded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
        255.0 * encoded
    })
}

/// The relative luminance of a colour, from 0 to 1 (WCAG 2.2).
pub(crate) fn luminance(colour: Colour) -> f64 {
    let [red, green, blue] = linear(colour);
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// A colour as digits: `#93a5ba`.
pub(crate) fn written([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The least contrast of words with their ground (WCAG 2.2, AA).
pub(crate) const LEAST_CONTRAST: f64 = 4.5;
/// The least contrast of lines with their ground (WCAG 2.2, 1.4.11).
pub(crate) const LINE_CONTRAST: f64 = 3.0;

/// The contrast of two colours, from 1 to 21 (WCAG 2.2).
pub(crate) fn contrast(one: Colour, other: Colour) -> f64 {
    let [a, b] = [luminance(one), luminance(other)];
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// A mix of two colours, linear in their sRGB bytes: the first colour at a share of 0, the other at 1.
pub(crate) fn mixed(one: Colour, other: Colour, share: f64) -> Colour {
    std::array::from_fn(|at| {
        let [from, to] = [one[at], other[at]].map(f64::from);
        (from + (to - from) * share.clamp(0.0, 1.0)).round() as u8
    })
}

/// The colour itself if its contrast with the ground is large enough. Otherwise the nearest colour of the same hue,
/// lighter or darker. Black or white if no such colour exists.
pub(crate) fn readable(colour: Colour, ground: Colour, least: f64) -> Colour {
    const STEPS: u32 = 200;
    let own = oklab(colour);
    let moved = |by: f64| {
        let Oklab([lightness, a, b]) = own;
        let moved = lightness + by;
        (0.0..=1.0).contains(&moved).then(|| from_oklab(Oklab([moved, a, b])))
    };
    let steps = (0..=STEPS).flat_map(|step| [1.0, -1.0].map(|sign| sign * f64::from(step) / f64::from(STEPS)));
    let found = steps.filter_map(moved).find(|&other| contrast(other, ground) >= least);
    found.unwrap_or_else(|| best_of(&[[0; 3], [255; 3]], ground))
}

/// The colour with most contrast with the ground; black if there are none.
pub(crate) fn best_of(colours: &[Colour], ground: Colour) -> Colour {
    let most = |a: &&Colour, b: &&Colour| contrast(**a, ground).total_cmp(&contrast(**b, ground));
    colours.iter().max_by(most).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_and_bytes_are_the_same_colour() {
        for byte in 0..=255 {
            assert_eq!(encoded(linear([byte, 0, 255 - byte])), [byte, 0, 255 - byte]);
        }
        assert_eq!(encoded([-1.0, 2.0, 0.5]), [0, 255, 188]);
    }

    #[test]
    fn contrast_runs_from_1_to_21() {
        assert_eq!(contrast([0; 3], [255; 3]), 21.0);
        assert_eq!(contrast([9, 99, 199], [9, 99, 199]), 1.0);
        // The grey of WCAG's own example that just fails on white.
        assert!(contrast([119; 3], [255; 3]) < 4.5 && contrast([118; 3], [255; 3]) >= 4.5);
    }

    #[test]
    fn colours_become_readable_on_any_ground_with_little_change() {
        assert_eq!(readable([0x1b, 0x23, 0x2e], [0xfb; 3], 4.5), [0x1b, 0x23, 0x2e]);
        for ground in [[0; 3], [0x80; 3], [255; 3], [0xff, 0xf1, 0xd0], [0x10, 0x20, 0x60], [0xc0, 0x20, 0x20]] {
            for colour in [[0xb8, 0x4a, 0], [0xff, 0x9b, 0x5c], [0x80; 3], [0x30, 0x60, 0xff]] {
                let readable = readable(colour, ground, 4.5);
                assert!(contrast(readable, ground) >= 4.5, "{colour:x?} on {ground:x?}: {readable:x?}");
            }
        }
        // No colour has so much contrast: the best one.
        assert_eq!(readable([0x80; 3], [0x80; 3], 20.0), [0; 3]);
    }
}
