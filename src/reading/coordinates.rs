//! Points and vectors as typed.

use super::collector::Here;
use crate::sim::Dimension;
use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A point or a vector: three coordinates in space, two in the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Coordinates(#[schemars(length(min = 2, max = 3))] pub(crate) Vec<f64>);

impl<const N: usize> From<[f64; N]> for Coordinates {
    fn from(coordinates: [f64; N]) -> Self {
        Self(coordinates.into())
    }
}

impl From<DVec2> for Coordinates {
    fn from(point: DVec2) -> Self {
        point.to_array().into()
    }
}

impl From<DVec3> for Coordinates {
    fn from(point: DVec3) -> Self {
        point.to_array().into()
    }
}

/// Typed coordinates as a vector, with z = 0 in the plane. A wrong number of coordinates is a mistake.
pub(crate) fn vector(typed: &Coordinates, dimension: Dimension, here: &Here<'_>) -> Option<DVec3> {
    match (typed.0.as_slice(), dimension) {
        (&[x, y, z], Dimension::Space) => Some(DVec3::new(x, y, z)),
        (&[x, y], Dimension::Plane) => Some(DVec3::new(x, y, 0.0)),
        (other, dimension) => {
            let expected = match dimension {
                Dimension::Space => "3, because the body is in space",
                Dimension::Plane => "2, because the body is in the plane",
            };
            here.wrong(format!("`{here}` has {} coordinates; expected {expected}", other.len()), None);
            None
        }
    }
}

/// A vector scaled to unit length. A zero vector is a mistake.
pub(crate) fn direction(vector: DVec3, here: &Here<'_>) -> Option<DVec3> {
    // The largest coordinate is divided out first: squares of very small or large numbers leave the range of double
    // precision.
    let largest = vector.abs().max_element();
    let unit = (vector / largest).normalize();
    if largest > 0.0 && unit.is_finite() {
        return Some(unit);
    }
    here.wrong(format!("`{here}` is zero, so it has no direction"), None);
    None
}
