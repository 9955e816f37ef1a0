//! The colours of scalar fields.

use super::palette::Colour;
use crate::scene::Theme;

/// How many colours stand for a whole scale; between them a straight line cannot be told from the curve.
pub const SHADES: usize = 64;

/// Points of the scale at equal steps, from pale mint through teal to indigo: lightness and the two opponent colours of
/// Oklab (B. Ottosson, 2020), in which equal distances look about equally large.
///
/// Why these: lightness alone falls evenly over the scale, so that it reads in grey and by colour-blind eyes; hue turns
/// with it, so that mild shading is not taken for another value; nowhere is there more red than green or blue together,
/// so that nothing is taken for vermilion, "turned over"; and the dark end is light enough for edges to show on it.
const POINTS: [[f64; 3]; 9] = [
    [0.9550, -0.0193, 0.0230],
    [0.8853, -0.0516, 0.0162],
    [0.8150, -0.0785, 0.0059],
    [0.7420, -0.0848, -0.0180],
    [0.6692, -0.0882, -0.0422],
    [0.5979, -0.0751, -0.0682],
    [0.5265, -0.0613, -0.0936],
    [0.4558, -0.0350, -0.1092],
    [0.3850, -0.0087, -0.1247],
];

/// The colours of a scale, from its lowest to its highest value at equal steps. Large values stand out from the ground:
/// they are dark in the light theme and light in the dark one.
pub(super) fn ramp(theme: Theme) -> Vec<Colour> {
    let share = |at: usize| at as f64 / (SHADES - 1) as f64;
    let along = |at: usize| if theme == Theme::Light { share(at) } else { 1.0 - share(at) };
    (0..SHADES).map(|at| encoded(point(along(at)))).collect()
}

/// Placeholder
pub(super) fn diverging(theme: Theme) -> Vec<Colour> {
    ramp(theme)
}

/// The colour of a place on a scale, from 0 to 1.
pub(super) fn colour(ramp: &[Colour], place: f32) -> Colour {
    let last = ramp.len().saturating_sub(1);
    let at = (f64::from(place).clamp(0.0, 1.0) * last as f64).round() as usize;
    ramp.get(at).copied().unwrap_or_default()
}

/// A place on the scale, in Oklab.
fn point(share: f64) -> [f64; 3] {
    let at = share * (POINTS.len() - 1) as f64;
    let cell = (at as usize).min(POINTS.len() - 2);
    std::array::from_fn(|axis| {
        let [from, to] = [POINTS[cell][axis], POINTS[cell + 1][axis]];
        from + (to - from) * (at - cell as f64)
    })
}

/// An Oklab colour as sRGB bytes.
fn encoded([lightness, a, b]: [f64; 3]) -> Colour {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|light| {
        let light = light.clamp(0.0, 1.0);
        let encoded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An sRGB colour in Oklab.
    fn oklab(colour: Colour) -> [f64; 3] {
        let [r, g, b] = colour.map(|byte| {
            let encoded = f64::from(byte) / 255.0;
            if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
        });
        let l = libm::cbrt(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
        let m = libm::cbrt(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
        let s = libm::cbrt(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    fn apart(one: Colour, other: Colour) -> f64 {
        let (one, other) = (oklab(one), oklab(other));
        (0..3).map(|axis| (one[axis] - other[axis]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn equal_steps_look_equally_large() {
        for theme in [Theme::Light, Theme::Dark] {
            let ramp = ramp(theme);
            assert_eq!(ramp.len(), SHADES);
            // Over eight steps at a time the rounding to bytes does not count.
            let steps: Vec<_> = ramp.windows(9).map(|part| apart(part[0], part[8])).collect();
            let (least, most) = steps.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
            assert!(most / least < 1.12, "{least} {most}");
        }
    }

    #[test]
    fn lightness_tells_the_order_and_nothing_is_vermilion() {
        for (theme, sign) in [(Theme::Light, -1.0), (Theme::Dark, 1.0)] {
            let ramp = ramp(theme);
            assert!(ramp.windows(3).all(|part| sign * (oklab(part[2])[0] - oklab(part[0])[0]) > 0.005));
            for &shade in &ramp {
                let [red, green, blue] = shade;
                assert!(red <= green.max(blue), "{shade:x?}");
                for alarm in [[0xe2, 0x66, 0x1c], [0xf2, 0x7a, 0x2e]] {
                    assert!(apart(shade, alarm) > 0.2, "{shade:x?}");
                }
            }
        }
    }

    #[test]
    fn any_place_has_a_colour() {
        let ramp = ramp(Theme::Light);
        assert_eq!(colour(&ramp, 0.0), ramp[0]);
        assert_eq!(colour(&ramp, 1.0), ramp[SHADES - 1]);
        assert_eq!([colour(&ramp, -3.0), colour(&ramp, 9.0)], [ramp[0], ramp[SHADES - 1]]);
        assert_eq!(colour(&[], 0.5), [0; 3]);
    }
}
