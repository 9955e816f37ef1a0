//! Oklab (B. Ottosson, 2020): lightness and two opponent colours, in which equal distances look about equally large.

use super::{Colour, encoded, linear};

/// A colour in Oklab: lightness from 0 to 1, red minus green, yellow minus blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oklab(pub [f64; 3]);

pub(crate) fn oklab(colour: Colour) -> Oklab {
    let [r, g, b] = linear(colour);
    let l = libm::cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
    let m = libm::cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
    let s = libm::cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
    Oklab([
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    ])
}

/// An Oklab colour as sRGB bytes. Channels out of range are clamped.
pub(crate) fn from_oklab(Oklab([lightness, a, b]): Oklab) -> Colour {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    encoded([
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ])
}

#[cfg(test)]
impl Oklab {
    /// The perceived difference: 0 for equal colours, 1 for black and white.
    pub(crate) fn distance(self, other: Self) -> f64 {
        (0..3).map(|axis| (self.0[axis] - other.0[axis]) * (self.0[axis] - other.0[axis])).sum::<f64>().sqrt()
    }

    /// Chroma: 0 for greys.
    #[cfg(all(test, feature = "render"))]
    pub(crate) fn chroma(self) -> f64 {
        let Self([_, a, b]) = self;
        (a * a + b * b).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for colour in [[0; 3], [255; 3], [0xe2, 0x66, 0x1c], [0x93, 0xa5, 0xba], [1, 2, 3], [0, 0, 255]] {
            assert_eq!(from_oklab(oklab(colour)), colour);
        }
        assert!((oklab([255; 3]).distance(oklab([0; 3])) - 1.0).abs() < 1e-6);
    }
}
