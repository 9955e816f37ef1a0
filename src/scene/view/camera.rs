//! The camera of a view.

use crate::look::{Camera, CameraFile, axes};
use crate::reading::captions::rounded;
use crate::reading::collector::Collector;
use crate::reading::coordinates::vector;
use crate::scene::{Scene, SceneBody};
use crate::sim::Dimension;
use crate::sim::geometry::is_inside;

/// Distance in body sizes at which a body fills a third of the picture's height and has room to jump.
const DISTANCE: f64 = 8.5;

impl CameraFile {
    /// The camera of a scene, or `None` after a mistake in its target.
    pub(super) fn resolve(&self, scene: &Scene, report: &Collector<'_>) -> Option<Camera> {
        let dimension = scene.dimension();
        let is_flat = dimension == Dimension::Plane;
        for (key, _) in [("azimuth", self.azimuth), ("elevation", self.elevation)]
            .into_iter()
            .filter(|(_, value)| is_flat && value.is_some())
        {
            let message = format!("`view.camera.{key}` is given, but a body in the plane is seen from the front");
            report.to("view").to("camera").to(key).wrong_key(message, format!("remove `{key}`"));
        }
        let angle =
            |typed: Option<f64>, degrees: f64| if is_flat { 0.0 } else { typed.unwrap_or(degrees.to_radians()) };
        let (low, high) = scene.box_at_start();
        let target = match &self.target {
            Some(target) => vector(target, dimension, &report.to("view").to("camera").to("target"))?,
            None => low.midpoint(high),
        };
        // Bodies that start as one point have the size of their rest shapes.
        let size =
            Some((high - low).max_element()).filter(|&size| size > 0.0).unwrap_or_else(|| scene.largest_extent());
        let follow = self.target.is_none() && self.distance.is_none();
        let camera = Camera {
            azimuth: angle(self.azimuth, 31.0),
            elevation: angle(self.elevation, 17.0),
            field_of_view: self.field_of_view.unwrap_or(20_f64.to_radians()),
            target,
            distance: self.distance.unwrap_or(DISTANCE * size),
            follow,
            // Grounds hide no body, and plates can be seen through.
            turns: follow && !is_flat && self.azimuth.is_none() && scene.has_solids(),
        };
        let [_, _, towards] = axes(camera.azimuth, camera.elevation);
        let eye = camera.target + camera.distance * towards;
        let holds = |one: &&SceneBody| is_inside(eye, &one.body, &one.initial.position);
        if !is_flat
            && !camera.follow
            && let Some(body) = scene.bodies.iter().find(holds)
        {
            let [x, y, z] = eye.to_array().map(|length| rounded(length, 3));
            let message = format!("the camera is at [{x}, {y}, {z}], inside {} at its start", body.in_words());
            let help = "move it out with a larger `view.camera.distance` or another `target`".to_owned();
            report.to("view").to("camera").wrong(message, help);
        }
        Some(camera)
    }
}
