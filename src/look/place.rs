//! Where a body is, as a camera sees it.

use super::view::{View, axes};
use crate::sim::body::Dimension;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Where a body is drawn at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Place {
    /// The mean of its nodes (m).
    pub(crate) centre: DVec3,
    /// The middle of the box around it (m), whose sides lie along the camera's axes.
    pub(crate) middle: DVec3,
    /// Half the sides of that box: to the right, up and towards the camera (m).
    pub(crate) half: DVec3,
}

impl Place {
    /// The place of a body whose nodes are at positions (m); `None` if it has none, or not all are finite.
    pub(crate) fn new(view: &View, dimension: Dimension, position: &[DVec3]) -> Option<Self> {
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
        let (off, half) = (low.midpoint(high), 0.5 * (high - low));
        let middle = centre + off.x * right + off.y * up + off.z * towards;
        (middle.is_finite() && half.is_finite()).then_some(Self { centre, middle, half })
    }

    /// The larger of its width and height in the picture (m).
    pub(crate) fn size(&self) -> f64 {
        2.0 * self.half.truncate().max_element()
    }
}
