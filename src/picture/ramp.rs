//! The colours of scalar fields, which the scene's maps name.

use crate::colour::Colour;
use crate::look::ramp;
pub(super) use crate::look::ramp::ramp;

/// How many colours stand for a whole scale; between them a straight line cannot be told from the curve.
pub(crate) const SHADES: usize = ramp::SHADES;

/// The colour of a place on a scale, from 0 to 1.
pub(super) fn colour(ramp: &[Colour], place: f32) -> Colour {
    let last = ramp.len().saturating_sub(1);
    let at = (f64::from(place).clamp(0.0, 1.0) * last as f64).round() as usize;
    ramp.get(at).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::{ColourMap, Theme};

    #[test]
    fn any_place_has_a_colour() {
        let ramp = ramp(ColourMap::MintIndigo, Theme::Light);
        assert_eq!(colour(&ramp, 0.0), ramp[0]);
        assert_eq!(colour(&ramp, 1.0), ramp[SHADES - 1]);
        assert_eq!([colour(&ramp, -3.0), colour(&ramp, 9.0)], [ramp[0], ramp[SHADES - 1]]);
        assert_eq!(colour(&[], 0.5), [0; 3]);
    }
}
