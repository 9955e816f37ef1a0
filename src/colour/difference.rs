//! Colour difference (CIEDE2000), also for colour-blind eyes.

use super::{Colour, linear};
use std::f64::consts::{PI, TAU};

/// Normal colour vision and two kinds of colour blindness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Vision {
    /// Three kinds of cones.
    Normal,
    /// No green cones: some 1 % of all men.
    Deuteranopia,
    /// No red cones: some 1 % of all men.
    Protanopia,
}

/// A matrix that simulates colour blindness on linear light.
type Loss = [[f64; 3]; 3];

/// Matrices without green and without red cones, by G. M. Machado, M. M. Oliveira, L. A. F. Fernandes: *A
/// Physiologically-based Model for Simulation of Color Vision Deficiency*, IEEE TVCG 15(6), 2009, at severity 1.
const MACHADO_2009: [Loss; 2] = [
    [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
    [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
];

/// Matrices without green and without red cones, by F. Viénot, H. Brettel, J. D. Mollon: *Digital Video Colourmaps for
/// Checking the Legibility of Displays by Dichromats*, Color Research & Application 24(4), 1999, for the primaries of
/// sRGB.
const VIENOT_1999: [Loss; 2] = [
    [[0.292_75, 0.707_25, 0.0], [0.292_75, 0.707_25, 0.0], [-0.022_34, 0.022_34, 1.0]],
    [[0.112_38, 0.887_62, 0.0], [0.112_38, 0.887_62, 0.0], [0.004_01, -0.004_01, 1.0]],
];

impl Vision {
    pub(crate) const ALL: [Self; 3] = [Self::Normal, Self::Deuteranopia, Self::Protanopia];

    /// Its name within a sentence, after *to*.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Normal => "eyes with all cones",
            Self::Deuteranopia => "eyes without green cones (deuteranopia)",
            Self::Protanopia => "eyes without red cones (protanopia)",
        }
    }
}

/// Linear light as perceived with a colour vision, by both models of colour blindness: Machado 2009 and Viénot 1999.
pub(crate) fn seen_by(vision: Vision, light: [f64; 3]) -> [[f64; 3]; 2] {
    let through = |loss: &Loss| loss.map(|row| (0..3).map(|at| row[at] * light[at]).sum::<f64>().clamp(0.0, 1.0));
    match vision {
        Vision::Normal => [light; 2],
        Vision::Deuteranopia => [&MACHADO_2009[0], &VIENOT_1999[0]].map(through),
        Vision::Protanopia => [&MACHADO_2009[1], &VIENOT_1999[1]].map(through),
    }
}

/// The difference of two colours for a colour vision: the smaller CIEDE2000 of both models. A difference of 1 is just
/// noticeable between adjacent colours. Colours that differ by 20 are not confused.
pub(crate) fn difference(one: Colour, other: Colour, vision: Vision) -> f64 {
    let [one, other] = [one, other].map(|colour| seen_by(vision, linear(colour)).map(lab));
    (0..2).map(|model| ciede2000(one[model], other[model])).fold(f64::INFINITY, f64::min)
}

/// The smallest difference of two colours for any colour vision (CIEDE2000).
pub(crate) fn least_difference(one: Colour, other: Colour) -> f64 {
    Vision::ALL.into_iter().map(|vision| difference(one, other, vision)).fold(f64::INFINITY, f64::min)
}

/// A colour in CIELAB: lightness from 0 to 100, red minus green, yellow minus blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lab(pub [f64; 3]);

/// Linear light of sRGB in CIELAB, for the white point of sRGB (D65).
pub fn lab([r, g, b]: [f64; 3]) -> Lab {
    const FOOT: f64 = 6.0 / 29.0;
    let x = (0.412_456_4 * r + 0.357_576_1 * g + 0.180_437_5 * b) / 0.950_47;
    let y = 0.212_672_9 * r + 0.715_152_2 * g + 0.072_175_0 * b;
    let z = (0.019_333_9 * r + 0.119_192_0 * g + 0.950_304_1 * b) / 1.088_83;
    let [x, y, z] = [x, y, z].map(|share| {
        if share > FOOT * FOOT * FOOT { libm::cbrt(share) } else { share / (3.0 * FOOT * FOOT) + 4.0 / 29.0 }
    });
    Lab([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])
}

/// The distance of two colours in CIELAB (CIE 1976).
#[cfg(test)]
pub(crate) fn cie76(Lab(one): Lab, Lab(other): Lab) -> f64 {
    (0..3).map(|axis| (one[axis] - other[axis]) * (one[axis] - other[axis])).sum::<f64>().sqrt()
}

/// The perceived difference of two colours (CIEDE2000). Names are those of G. Sharma, W. Wu and E. N. Dalal: *The
/// CIEDE2000 Color-Difference Formula*, Color Research & Application 30(1), 2005.
pub fn ciede2000(Lab([l1, a1, b1]): Lab, Lab([l2, a2, b2]): Lab) -> f64 {
    let root_of_7th = |c: f64| {
        let c7 = c * c * c * c * c * c * c;
        (c7 / (c7 + 6_103_515_625.0)).sqrt()
    };
    let length = |a: f64, b: f64| (a * a + b * b).sqrt();
    let g = 0.5 * (1.0 - root_of_7th((length(a1, b1) + length(a2, b2)) / 2.0));
    let [a1, a2] = [a1, a2].map(|a| (1.0 + g) * a);
    let [c1, c2] = [length(a1, b1), length(a2, b2)];
    let hue = |a: f64, b: f64| if a == 0.0 && b == 0.0 { 0.0 } else { libm::atan2(b, a).rem_euclid(TAU) };
    let [h1, h2] = [hue(a1, b1), hue(a2, b2)];
    let grey = c1 * c2 == 0.0;
    let hue_difference = match h2 - h1 {
        _ if grey => 0.0,
        angle if angle > PI => angle - TAU,
        angle if angle < -PI => angle + TAU,
        angle => angle,
    };
    let (dl, dc, dh) = (l2 - l1, c2 - c1, 2.0 * (c1 * c2).sqrt() * libm::sin(hue_difference / 2.0));
    let (l, c) = ((l1 + l2) / 2.0, (c1 + c2) / 2.0);
    let h = match h1 + h2 {
        sum if grey => sum,
        sum if (h1 - h2).abs() <= PI => sum / 2.0,
        sum if sum < TAU => (sum + TAU) / 2.0,
        sum => (sum - TAU) / 2.0,
    };
    let cosine = |times: f64, degrees: f64| libm::cos(times * h + degrees.to_radians());
    let t =
        1.0 - 0.17 * cosine(1.0, -30.0) + 0.24 * cosine(2.0, 0.0) + 0.32 * cosine(3.0, 6.0) - 0.20 * cosine(4.0, -63.0);
    let from_blue = (h.to_degrees() - 275.0) / 25.0;
    let rotation = -2.0 * root_of_7th(c) * libm::sin((60.0 * libm::exp(-from_blue * from_blue)).to_radians());
    let from_middle = (l - 50.0) * (l - 50.0);
    let dl = dl / (1.0 + 0.015 * from_middle / (20.0 + from_middle).sqrt());
    let dc = dc / (1.0 + 0.045 * c);
    let dh = dh / (1.0 + 0.015 * c * t);
    (dl * dl + dc * dc + dh * dh + rotation * dc * dh).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs from the data that Sharma, Wu and Dalal publish with their paper, chosen for the branches they take.
    #[test]
    fn ciede2000_gives_the_published_numbers() {
        for (one, other, expected) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, 2.49, -0.0010], [50.0, -2.49, 0.0009], 7.1792),
            ([50.0, 2.49, -0.0010], [50.0, -2.49, 0.0011], 7.2195),
            ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
            ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
            ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
        ] {
            let (one, other) = (Lab(one), Lab(other));
            assert!((ciede2000(one, other) - expected).abs() < 1e-4, "{one:?} {other:?}: {}", ciede2000(one, other));
            assert!((ciede2000(other, one) - expected).abs() < 1e-4);
        }
    }

    #[test]
    fn losses_keep_greys_and_take_red_from_green() {
        for vision in Vision::ALL {
            for seen in seen_by(vision, [0.5; 3]) {
                assert!(seen.iter().all(|light| (light - 0.5).abs() < 0.01), "{vision:?} {seen:?}");
            }
        }
        // A red and a green that are equally light with colour blindness.
        let [red, green] = [[0xb8, 0x60, 0x40], [0x80, 0x7c, 0x40]];
        assert!(difference(red, green, Vision::Normal) > 25.0);
        assert!(difference(red, green, Vision::Deuteranopia) < 12.0);
        assert_eq!(difference(red, red, Vision::Protanopia), 0.0);
    }
}
