//! The values of a scalar field as places on their scale of colours.

use super::narrow::narrow;
use crate::colour::Colour;
use crate::look::ColourScale;
use crate::sim::{Body, Support};

/// The place of a value that is not a number. Such parts have the body's colour.
pub(super) const NOWHERE: f32 = -1.0;

/// One run's field, as places on the scale: 0 at its low end, 1 at its high end, or [`NOWHERE`].
pub(super) struct Shades {
    support: Support,
    places: Vec<f32>,
}

impl Shades {
    /// The places of a field. Values beyond the scale, also infinite ones, are at its ends. NaN is nowhere, and so are
    /// all values if their number does not match the body.
    pub(super) fn new(body: &Body, scale: &ColourScale, values: &[f64]) -> Self {
        let support = scale.field.support();
        let expected = match support {
            Support::Nodes => body.len(),
            Support::Elements => body.elements().len(),
        };
        let places = match values.len() == expected {
            true => values.iter().map(|&value| place(value, scale.range)).collect(),
            false => vec![NOWHERE; expected],
        };
        Self { support, places }
    }

    /// Whether neighbouring elements differ at the edge between them.
    pub(super) fn jump(&self) -> bool {
        self.support == Support::Elements
    }

    /// The place of a node where it is a corner of an element.
    fn corner(&self, node: u32, element: Option<u32>) -> f32 {
        match self.support {
            Support::Nodes => self.places[node as usize],
            Support::Elements => element.map_or(NOWHERE, |element| self.places[element as usize]),
        }
    }

    /// The places of the corners of a face. If one of them is nowhere, all are, because places are interpolated.
    pub(super) fn corners(&self, nodes: &[u32], element: Option<u32>) -> Vec<f64> {
        let nowhere = f64::from(NOWHERE);
        let corners: Vec<_> = nodes.iter().map(|&node| f64::from(self.corner(node, element))).collect();
        if corners.contains(&nowhere) { vec![nowhere; nodes.len()] } else { corners }
    }

    /// A place for each node, for lines and discs: its own, or the mean of its elements' places.
    pub(super) fn of_nodes(&self, body: &Body) -> Vec<f32> {
        if self.support == Support::Nodes {
            return self.places.clone();
        }
        let mut sums = vec![(0.0, 0.0); body.len()];
        for (nodes, &place) in body.elements().iter().zip(&self.places).filter(|(_, place)| **place != NOWHERE) {
            for &node in nodes {
                let (sum, count) = &mut sums[node as usize];
                (*sum, *count) = (*sum + place, *count + 1.0);
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { NOWHERE }).collect()
    }
}

/// The place of a value between two others.
pub(super) fn place(value: f64, [low, high]: [f64; 2]) -> f32 {
    if value.is_nan() {
        return NOWHERE;
    }
    // Halves keep the width of the widest range finite.
    let share = (value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0);
    narrow(share.clamp(0.0, 1.0))
}

/// The colour of a place on a scale, from 0 to 1.
pub(super) fn colour(ramp: &[Colour], place: f32) -> Colour {
    let last = ramp.len().saturating_sub(1);
    let at = (f64::from(place).clamp(0.0, 1.0) * last as f64).round() as usize;
    ramp.get(at).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::ColourMap;
    use crate::sim::{Dimension, Field, IndexLists};
    use glam::DVec3;

    fn body() -> Body {
        let rest = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y].to_vec();
        let elements: IndexLists = [&[0, 1, 2][..], &[1, 3, 2]].into_iter().collect();
        Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a body")
    }

    #[test]
    fn values_stand_between_the_ends_of_the_scale() {
        let values = [0.0, 1.0, 2.0, 3.0, 9.0, -9.0, f64::INFINITY, f64::NEG_INFINITY];
        assert_eq!(values.map(|value| place(value, [1.0, 3.0])), [0.0, 0.0, 0.5, 1.0, 1.0, 0.0, 1.0, 0.0]);
        assert_eq!(place(f64::NAN, [1.0, 3.0]), NOWHERE);
        assert_eq!(place(0.0, [-f64::MAX, f64::MAX]), 0.5);
        assert_eq!(place(5.0, [0.0, 5e-324]), 1.0);
    }

    #[test]
    fn any_place_has_a_colour() {
        let ramp = [[1; 3], [2; 3], [3; 3]];
        assert_eq!(
            [-3.0, 0.0, 0.5, 1.0, 9.0].map(|place| colour(&ramp, place)),
            [[1; 3], [1; 3], [2; 3], [3; 3], [3; 3]]
        );
        assert_eq!(colour(&[], 0.5), [0; 3]);
    }

    #[test]
    fn nodes_and_elements_have_their_own_numbers() {
        let body = body();
        let scale = |field| ColourScale { field, to: None, range: [0.0, 4.0], map: ColourMap::default() };
        let speed = Shades::new(&body, &scale(Field::Speed), &[0.0, 1.0, 2.0, f64::NAN]);
        assert_eq!(speed.corners(&[0, 1, 2], Some(0)), [0.0, 0.25, 0.5]);
        assert_eq!(speed.corners(&[1, 3, 2], Some(1)), [-1.0; 3]);
        let strain = Shades::new(&body, &scale(Field::Strain), &[1.0, 3.0]);
        assert_eq!(strain.corners(&[1, 3, 2], Some(1)), [0.75; 3]);
        assert_eq!(strain.corners(&[1, 3, 2], None), [-1.0; 3]);
        assert_eq!(strain.of_nodes(&body), [0.25, 0.5, 0.5, 0.75]);
        // A snapshot without the field has no values.
        assert_eq!(Shades::new(&body, &scale(Field::Strain), &[]).of_nodes(&body), [NOWHERE; 4]);
    }
}
