//! Colour scales of scalar fields, by name.

use super::file::ColourMap;
use super::palette::Theme;
use crate::colour::{Colour, Oklab, from_oklab};
use colorous::Gradient;

/// The number of colours of a scale; linear interpolation between them is visually exact.
pub(crate) const SHADES: usize = 64;

/// Points of the usual scale at equal steps, from pale mint through teal to indigo: lightness and the two opponent
/// colours of Oklab (B. Ottosson, 2020), in which equal distances look about equally large.
///
/// The reasons: lightness falls evenly over the scale, so that it reads in grey and by colour-blind eyes. Hue turns
/// with it, so that mild shading does not look like another value. There is never more red than green and blue
/// together, so that nothing looks like vermilion, "turned over". The dark end is light enough for edges on it.
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

/// Ends and middle of the diverging scale, in Oklab, in the light and in the dark theme. The ends are equally strong,
/// with hues that differ for any colour vision; the middle is grey, and nearer to the background.
const DIVERGING: [[[f64; 3]; 3]; 2] = [
    [[0.4300, 0.0850, -0.1500], [0.7700, 0.0000, -0.0050], [0.4900, -0.1150, 0.0850]],
    [[0.7200, 0.0900, -0.1300], [0.5600, 0.0000, -0.0050], [0.7800, -0.1400, 0.1050]],
];

/// The part of `magma` that is omitted at its black end, where neither shading nor edges could be seen.
const BLACK_OF_MAGMA: f64 = 0.25;

/// The two ends of the scale of greys: as light as those of the usual one, for the same reasons.
const GREYS: [[f64; 3]; 2] = [[0.9550, 0.0, 0.0], [0.3850, 0.0, 0.0]];

/// The colours of a scale, from its lowest to its highest value at equal steps. On scales that depend on the theme,
/// large values stand out from the ground: they are dark in the light theme and light in the dark one.
pub(crate) fn ramp(map: ColourMap, theme: Theme) -> Vec<Colour> {
    let share = |at: usize| at as f64 / (SHADES - 1) as f64;
    let with_theme = |at: usize| if theme == Theme::Light { share(at) } else { 1.0 - share(at) };
    let own = |points: &[[f64; 3]], share: &dyn Fn(usize) -> f64| {
        (0..SHADES).map(|at| from_oklab(between(points, share(at)))).collect()
    };
    let published =
        |gradient: Gradient| (0..SHADES).map(|at| gradient.eval_rational(at, SHADES).into_array()).collect();
    match map {
        ColourMap::MintIndigo => own(&POINTS, &with_theme),
        ColourMap::Greys => own(&GREYS, &with_theme),
        ColourMap::Viridis => published(colorous::VIRIDIS),
        ColourMap::Cividis => published(colorous::CIVIDIS),
        ColourMap::Magma => {
            let from_black = |at: usize| BLACK_OF_MAGMA + (1.0 - BLACK_OF_MAGMA) * share(at);
            (0..SHADES).map(|at| colorous::MAGMA.eval_continuous(from_black(at)).into_array()).collect()
        }
        ColourMap::VioletGreen => own(&DIVERGING[usize::from(theme == Theme::Dark)], &share),
        ColourMap::PurpleGreen => published(colorous::PURPLE_GREEN),
    }
}

/// A place on a scale of points at equal steps.
fn between(points: &[[f64; 3]], share: f64) -> Oklab {
    let at = share * (points.len() - 1) as f64;
    let cell = (at as usize).min(points.len() - 2);
    Oklab(std::array::from_fn(|axis| {
        let [from, to] = [points[cell][axis], points[cell + 1][axis]];
        from + (to - from) * (at - cell as f64)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Vision, contrast, difference, oklab};
    use crate::look::Palette;

    const USUAL: ColourMap = ColourMap::MintIndigo;

    fn apart(one: Colour, other: Colour) -> f64 {
        oklab(one).distance(oklab(other))
    }

    fn lightness(colour: Colour) -> f64 {
        oklab(colour).0[0]
    }

    #[test]
    fn equal_steps_look_equally_large() {
        for theme in [Theme::Light, Theme::Dark] {
            let ramp = ramp(USUAL, theme);
            assert_eq!(ramp.len(), SHADES);
            // Over eight steps, rounding to bytes does not count.
            let steps: Vec<_> = ramp.windows(9).map(|part| apart(part[0], part[8])).collect();
            let (least, most) = steps.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
            assert!(most / least < 1.12, "{least} {most}");
        }
    }

    #[test]
    fn lightness_shows_the_order_and_nothing_is_vermilion() {
        for (theme, sign) in [(Theme::Light, -1.0), (Theme::Dark, 1.0)] {
            let ramp = ramp(USUAL, theme);
            assert!(ramp.windows(3).all(|part| sign * (lightness(part[2]) - lightness(part[0])) > 0.005));
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
    fn published_scales_begin_and_end_as_published_but_for_black() {
        for (map, low, high) in [
            (ColourMap::Viridis, [0x44, 0x01, 0x54], [0xfd, 0xe7, 0x25]),
            (ColourMap::Magma, [0x51, 0x12, 0x7c], [0xfc, 0xfd, 0xbf]),
            (ColourMap::Cividis, [0x00, 0x22, 0x4e], [0xfe, 0xe8, 0x38]),
            (ColourMap::PurpleGreen, [0x40, 0x00, 0x4b], [0x00, 0x44, 0x1b]),
        ] {
            let ramp = ramp(map, Theme::Light);
            assert_eq!((ramp.len(), &ramp), (SHADES, &super::ramp(map, Theme::Dark)));
            // The polynomials of Cividis are a few bytes off its table.
            assert!(apart(ramp[0], low) < 0.03 && apart(ramp[SHADES - 1], high) < 0.03, "{map:?}: {:x?}", ramp[0]);
        }
    }

    #[test]
    fn scales_of_one_direction_show_the_order_in_grey_and_the_other_has_its_middle_in_the_middle() {
        for map in [ColourMap::Viridis, ColourMap::Cividis, ColourMap::Magma, ColourMap::Greys] {
            let ramp = ramp(map, Theme::Dark);
            assert!(ramp.windows(3).all(|part| lightness(part[2]) > lightness(part[0])), "{map:?}");
        }
        let ramp = ramp(ColourMap::PurpleGreen, Theme::Light);
        let lightest = (0..SHADES).max_by(|&a, &b| lightness(ramp[a]).total_cmp(&lightness(ramp[b])));
        assert!(lightest.is_some_and(|at| at.abs_diff(SHADES / 2) <= 2), "{lightest:?}");
        assert!(oklab(ramp[SHADES / 2]).chroma() < 0.02);
    }

    #[test]
    fn shortened_and_lengthened_springs_differ_for_any_colour_vision() {
        for theme in [Theme::Light, Theme::Dark] {
            let ramp = ramp(ColourMap::VioletGreen, theme);
            let [low, middle, high] = [0, SHADES / 2, SHADES - 1].map(|at| ramp[at]);
            for vision in Vision::ALL {
                for (one, other) in [(low, high), (low, middle), (middle, high)] {
                    let found = difference(one, other, vision);
                    assert!(found >= 15.0, "{theme:?} {}: {one:x?} and {other:x?} differ by {found}", vision.name());
                }
            }
            // The middle is seen on the ground of its theme.
            assert!(contrast(middle, Palette::of(theme).background) >= 1.8);
        }
    }

    /// `magma` is the only exception, as its description tells.
    #[test]
    fn no_scale_looks_like_turned_over_elements() {
        use ColourMap::{Cividis, Greys, PurpleGreen, VioletGreen, Viridis};
        let maps = [USUAL, Viridis, Cividis, Greys, PurpleGreen, VioletGreen];
        for (map, theme) in maps.into_iter().flat_map(|map| [Theme::Light, Theme::Dark].map(|theme| (map, theme))) {
            let alarm = Palette::of(theme).alarm;
            for shade in ramp(map, theme) {
                assert!(apart(shade, alarm) > 0.12, "{map:?}: {shade:x?} is {}", apart(shade, alarm));
            }
        }
    }
}
