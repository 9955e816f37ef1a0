//! Where a body is, as a camera sees it.

use super::framing::spread;
use super::view::{View, axes};
use crate::sim::body::Dimension;
use crate::sim::contact::Obstacle;
use glam::DVec3;

/// Where a body is drawn at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// The mean of its nodes (m).
    pub(crate) centre: DVec3,
    /// The box around it, from the centre along the camera's axes: to the right, up and towards the camera (m).
    pub(crate) low: DVec3,
    /// Its highest corner (m).
    pub(crate) high: DVec3,
}

impl Place {
    /// The place of a body whose nodes are at positions (m); `None` if it has none, or not all are finite.
    pub(crate) fn new(view: &View, dimension: Dimension, obstacles: &[Obstacle], position: &[DVec3]) -> Option<Self> {
        let position = spread(position, view.explode, obstacles);
        let [right, up, towards] = match dimension {
            Dimension::Space => axes(view.camera.azimuth, view.camera.elevation),
            Dimension::Plane => DVec3::AXES,
        };
        let centre = position.iter().sum::<DVec3>() / position.len() as f64;
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for way in position.iter().map(|&at| at - centre) {
            let seen = DVec3::new(way.dot(right), way.dot(up), way.dot(towards));
            (low, high) = (low.min(seen), high.max(seen));
        }
        (centre.is_finite() && low.is_finite() && high.is_finite()).then_some(Self { centre, low, high })
    }

    /// The larger of its width and height in the picture (m).
    pub(crate) fn size(&self) -> f64 {
        (self.high - self.low).truncate().max_element()
    }
}
