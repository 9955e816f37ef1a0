//! The opacities of a picture without a background, recovered from two drawings on white and on black.

use crate::colour::linear;
use crate::picture::Rectangle;
use image::{Rgb, RgbImage, Rgba, RgbaImage};

/// The ground's light below this is ignored where obstacles are, whose opacity is 254/255 as a mark for shaders.
const UNSEEN: f64 = 1.6 / 255.0;

/// The colour and opacity of each pixel, recovered from two drawings of a picture on white and on black ground.
///
/// Where nothing was drawn the drawings are white and black, and the opacity is 0; where the ground is covered they are
/// equal, and it is exactly 255. Between, a pixel of opacity α shows `drawn + (1 − α) ground`. Blending as sRGB
/// values, as words are blended and pages are put together, that is the same α for all channels. Blending linear light,
/// as borders of bodies and soft shadows are, each channel would need one of its own. There is only one, so it is the
/// middle one, and the colour is the one that looks exactly as drawn on the ground that the picture is made for,
/// `on_light` or black; on the other one coloured borders are a little off.
///
/// In `solid` parts of the picture, pixels with an opacity of almost 1 count as opaque.
///
/// # Panics
/// If the drawings have different sizes.
pub(super) fn recover(on_white: &RgbImage, on_black: &RgbImage, on_light: bool, solid: &[Rectangle]) -> RgbaImage {
    assert_eq!(on_white.dimensions(), on_black.dimensions(), "two drawings of one picture");
    let (width, height) = on_white.dimensions();
    let recovered = on_white.enumerate_pixels().zip(on_black.pixels()).flat_map(|((x, y, white), black)| {
        let inside =
            |[left, top, width, height]: &Rectangle| x.wrapping_sub(*left) < *width && y.wrapping_sub(*top) < *height;
        let (Rgb(white), Rgb(black)) = (*white, *black);
        let solid = solid.iter().any(inside) && is_solid(white, black);
        let black = if solid && on_light { white } else { black };
        let white = if solid { black } else { white };
        pixel(white, black, on_light).0
    });
    RgbaImage::from_raw(width, height, recovered.collect()).expect("four bytes a pixel")
}

/// Whether hardly any of the ground's light shows through.
fn is_solid(white: [u8; 3], black: [u8; 3]) -> bool {
    let [light, dark] = [white, black].map(linear);
    (0..3).all(|at| white[at].saturating_sub(black[at]) <= 1 || light[at] - dark[at] <= UNSEEN)
}

/// One pixel, from what it looks like on white and on black.
fn pixel(white: [u8; 3], black: [u8; 3], on_light: bool) -> Rgba<u8> {
    // How much of the ground shows through in each channel.
    let seen: [u8; 3] = std::array::from_fn(|at| white[at].saturating_sub(black[at]));
    let [least, most] = [seen.iter().min(), seen.iter().max()].map(|end| end.copied().unwrap_or_default());
    let middle = least.midpoint(most);
    // The colour must stay in the range of bytes.
    let through = if on_light {
        middle.min(white.into_iter().min().unwrap_or_default())
    } else {
        middle.min(u8::MAX - black.into_iter().max().unwrap_or_default())
    };
    let alpha = u8::MAX - through;
    if alpha == 0 {
        return Rgba([0; 4]);
    }
    let colour = |at: usize| {
        let drawn = if on_light { white[at] - through } else { black[at] };
        let share = f64::from(drawn) / f64::from(alpha);
        (255.0 * share).round().min(255.0) as u8
    };
    Rgba([colour(0), colour(1), colour(2), alpha])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pixel laid on a ground the way pages are put together.
    fn laid([r, g, b, alpha]: [u8; 4], ground: u8) -> [i32; 3] {
        let share = f64::from(alpha) / 255.0;
        [r, g, b].map(|byte| (f64::from(byte) * share + f64::from(ground) * (1.0 - share)).round() as i32)
    }

    /// A colour blended over a ground, as sRGB values.
    fn blended(colour: [u8; 3], alpha: f64, ground: u8) -> [u8; 3] {
        colour.map(|byte| (f64::from(byte) * alpha + f64::from(ground) * (1.0 - alpha)).round() as u8)
    }

    #[test]
    fn nothing_is_nothing_and_opaque_is_opaque() {
        for on_light in [true, false] {
            assert_eq!(pixel([255; 3], [0; 3], on_light).0, [0; 4]);
            for colour in [[0; 3], [255; 3], [226, 102, 28]] {
                let [r, g, b] = colour;
                assert_eq!(pixel(colour, colour, on_light).0, [r, g, b, 255]);
            }
        }
    }

    #[test]
    fn what_is_blended_as_pages_are_comes_back_on_both_grounds() {
        for colour in [[0, 0, 0], [255, 255, 255], [226, 102, 28], [10, 200, 90]] {
            for alpha in (0..=40).map(|step| f64::from(step) / 40.0) {
                let [white, black] = [255, 0].map(|ground| blended(colour, alpha, ground));
                for on_light in [true, false] {
                    let found = pixel(white, black, on_light).0;
                    for (ground, drawn) in [(255, white), (0, black)] {
                        let apart = laid(found, ground).iter().zip(drawn).map(|(a, b)| a.abs_diff(b.into())).max();
                        assert!(apart <= Some(1), "{colour:?} × {alpha} on {ground}: {found:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn obstacles_are_opaque() {
        for byte in [5, 40, 120, 195, 250] {
            let light = crate::colour::encoded(linear([byte; 3]).map(|share| share + 1.0 / 255.0));
            let [white, black] = [light, [byte; 3]].map(|colour| RgbImage::from_pixel(3, 1, Rgb(colour)));
            for on_light in [true, false] {
                let found = recover(&white, &black, on_light, &[[1, 0, 1, 1]]);
                let [r, g, b] = if on_light { light } else { [byte; 3] };
                assert_eq!(found.get_pixel(1, 0).0, [r, g, b, 255]);
                assert!(light == [byte; 3] || found.get_pixel(0, 0)[3] < 255);
                assert_eq!(found.get_pixel(0, 0), found.get_pixel(2, 0));
            }
        }
    }

    /// Whatever was drawn, also what no blending makes.
    #[test]
    fn on_its_own_ground_every_pixel_is_as_drawn() {
        let channels = [0, 1, 40, 127, 128, 200, 254, 255];
        let all = |visit: &mut dyn FnMut([u8; 3])| {
            channels
                .iter()
                .for_each(|&r| channels.iter().for_each(|&g| channels.iter().for_each(|&b| visit([r, g, b]))));
        };
        all(&mut |white| {
            all(&mut |black| {
                for (on_light, ground, drawn) in [(true, 255, white), (false, 0, black)] {
                    let found = pixel(white, black, on_light).0;
                    let apart = laid(found, ground).iter().zip(drawn).map(|(a, b)| a.abs_diff(b.into())).max();
                    assert!(apart <= Some(1), "{white:?} {black:?}: {found:?}");
                }
            });
        });
    }
}
