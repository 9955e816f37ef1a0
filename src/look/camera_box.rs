//! The boxes around bodies along the axes of a camera.

use super::azimuth::azimuths;
use super::camera::axes;
use super::view::{Traced, View};
use crate::sim::{Assembly, Body};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// So many points of a carried surface, evenly spread, stand for all.
const MANY_POINTS: usize = 10_000;

/// The box around a body at one moment, along the axes of a camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CameraBox {
    /// The centre of mass of the body (m).
    pub(crate) centre: DVec3,
    /// The corners of the box from each azimuth of the camera, relative to the centre of mass: to the right, up and towards the camera (m).
    corners: Vec<[DVec3; 2]>,
}

/// The boxes around the bodies of a run at one moment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CameraBoxes {
    /// The centre of mass of all bodies (m), which cameras follow.
    pub(crate) centre: DVec3,
    /// The box around each body.
    pub(crate) bodies: Vec<CameraBox>,
}

impl CameraBox {
    /// The box around a body whose nodes are at positions (m), or around the surface that it carries; `None` if it has
    /// none, or not all are finite.
    fn new(view: &View, body: &Body, position: &[DVec3]) -> Option<Self> {
        let all: Vec<_> = azimuths(&view.camera).map(|azimuth| axes(azimuth, view.camera.elevation)).collect();
        let centre = Traced::Centre.of(body, position);
        let mut corners = vec![[DVec3::ZERO; 2]; all.len()];
        let mut add = |at: DVec3| {
            for ([low, high], axes) in corners.iter_mut().zip(&all) {
                let seen = DVec3::from_array(axes.map(|axis| (at - centre).dot(axis)));
                (*low, *high) = (low.min(seen), high.max(seen));
            }
        };
        match &body.carried() {
            Some(surface) if view.visible.surfaces && !view.visible.cage => {
                let points = (0..surface.rest.len()).step_by(surface.rest.len().div_ceil(MANY_POINTS).max(1));
                points.for_each(|point| add(surface.weights.place(point, position)));
            }
            _ => position.iter().for_each(|&at| add(at)),
        }
        let are_finite = corners.iter().flatten().all(|corner| corner.is_finite());
        (centre.is_finite() && are_finite).then_some(Self { centre, corners })
    }

    /// The corners from an azimuth of the camera, by its place. Files may lack it.
    #[cfg(feature = "render")]
    pub(crate) fn corners(&self, azimuth: usize) -> [DVec3; 2] {
        self.corners.get(azimuth).copied().unwrap_or_default()
    }

    /// The larger of its width and height from there (m).
    #[cfg(feature = "render")]
    pub(crate) fn size(&self, azimuth: usize) -> f64 {
        let [low, high] = self.corners(azimuth);
        (high - low).truncate().max_element()
    }
}

impl CameraBoxes {
    /// The boxes around bodies whose nodes are at positions (m); `None` if there are none, or not all are finite.
    pub(crate) fn new(view: &View, bodies: &Assembly, position: &[DVec3]) -> Option<Self> {
        if position.len() != bodies.whole().len() {
            return None;
        }
        let of_body = |(at, body)| CameraBox::new(view, body, &position[bodies.nodes(at)]);
        let of_bodies: Option<_> = bodies.bodies().iter().map(|body| &**body).enumerate().map(of_body).collect();
        Some(Self { centre: Traced::Centre.of(bodies.whole(), position), bodies: of_bodies? })
    }
}
