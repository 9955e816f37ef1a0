//! The camera of a view.

use super::subject::{Subject, SubjectBody};
use crate::reading::captions::rounded;
use crate::reading::collector::{Collector, key_path};
use crate::reading::coordinates::{Coordinates, vector};
use crate::reading::words::quoted;
use crate::sim::geometry::is_inside;
use crate::sim::{Dimension, Obstacle};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Distance in body sizes at which a body fills a third of the picture's height and has room to jump.
const DISTANCE: f64 = 8.5;

/// A perspective camera that looks at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Azimuth to the right, from looking along −z (rad); the usual one, if it [turns](Self::turns).
    pub azimuth: f64,
    /// Elevation above the horizon (rad), less than a quarter turn either way.
    pub elevation: f64,
    /// Vertical field of view (rad).
    pub field_of_view: f64,
    /// The target (m).
    pub target: DVec3,
    /// Distance from it (m).
    pub distance: f64,
    /// Whether the camera follows the centre of mass of each run's bodies, in place of the target, from a distance at
    /// which they fill their panel at their widest moment.
    pub follow: bool,
    /// Whether pictures choose another azimuth where obstacles hide less of the bodies over the course of the scene.
    pub turns: bool,
}

/// A camera as typed. A body in the plane is seen from the front without perspective.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraFile {
    /// Azimuth to the right, from looking along −z (rad). Only in space. Default: 0.541, which is 31°; or, where spheres,
    /// capsules or boxes hide much of the bodies from there, the first of eleven others, 30° apart, from which they hide little. A camera with a
    /// `target` or `distance` does not turn.
    azimuth: Option<f64>,
    /// Elevation above the horizon (rad), below a quarter turn (1.57), so that the camera does not look along its
    /// up-axis. Only in space. Default: 0.297, which is 17°.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    field_of_view: Option<f64>,
    /// The point (m) that a fixed camera looks at. Default: the middle of the body at the start.
    target: Option<Coordinates>,
    /// Distance of a fixed camera from its target (m). In the plane it gives the scale together with `field_of_view`.
    /// Default: 8.5 times the longest side of the bounding box at the start.
    #[schemars(extend("exclusiveMinimum" = 0))]
    distance: Option<f64>,
}

impl CameraFile {
    /// The camera of a scene, or `None` after a mistake in its target.
    pub(super) fn resolve(&self, scene: &Subject<'_>, report: &mut Collector<'_>) -> Option<Camera> {
        let dimension = scene.dimension();
        let is_flat = dimension == Dimension::Plane;
        for (key, _) in [("azimuth", self.azimuth), ("elevation", self.elevation)]
            .into_iter()
            .filter(|(_, value)| is_flat && value.is_some())
        {
            let message = format!("`view.camera.{key}` is given, but a body in the plane is seen from the front");
            report.at_key(&key_path!["view", "camera", key], message, format!("remove `{key}`"));
        }
        let angle =
            |typed: Option<f64>, degrees: f64| if is_flat { 0.0 } else { typed.unwrap_or(degrees.to_radians()) };
        let (low, high) = scene.start();
        let target = match &self.target {
            Some(target) => vector(target, dimension, &key_path!["view", "camera", "target"], report)?,
            None => low.midpoint(high),
        };
        // Bodies that start as one point have the size of their rest shapes.
        let size = Some((high - low).max_element()).filter(|&size| size > 0.0).unwrap_or_else(|| scene.extent());
        let follow = self.target.is_none() && self.distance.is_none();
        let camera = Camera {
            azimuth: angle(self.azimuth, 31.0),
            elevation: angle(self.elevation, 17.0),
            field_of_view: self.field_of_view.unwrap_or(20_f64.to_radians()),
            target,
            distance: self.distance.unwrap_or(DISTANCE * size),
            follow,
            turns: follow && !is_flat && self.azimuth.is_none() && can_hide(scene.obstacles),
        };
        let [_, _, towards] = axes(camera.azimuth, camera.elevation);
        let eye = camera.target + camera.distance * towards;
        let holds = |one: &&SubjectBody<'_>| is_inside(eye, one.body, &one.initial.position);
        if !is_flat
            && !camera.follow
            && let Some(SubjectBody { name, .. }) = scene.bodies.iter().find(holds)
        {
            let [x, y, z] = eye.to_array().map(|length| rounded(length, 3));
            let body = if name.is_empty() { "the body".to_owned() } else { format!("the body {}", quoted(name)) };
            let message = format!("the camera is at [{x}, {y}, {z}], inside {body} at its start");
            let help = "move it out with a larger `view.camera.distance` or another `target`".to_owned();
            report.at(&key_path!["view", "camera"], message, help);
        }
        Some(camera)
    }
}

/// Whether obstacles can hide bodies from a camera. Grounds do not, and plates can be seen through.
fn can_hide(obstacles: &[Obstacle]) -> bool {
    obstacles.iter().any(|obstacle| !obstacle.shape.is_half_space())
}

/// The unit vectors of a camera with an azimuth and elevation (rad): right, up, and from its target to it.
pub(crate) fn axes(azimuth: f64, elevation: f64) -> [DVec3; 3] {
    let [(across, along), (rise, level)] = [azimuth, elevation].map(libm::sincos);
    let towards = DVec3::new(across * level, rise, along * level);
    let right = DVec3::new(along, 0.0, -across);
    [right, towards.cross(right), towards]
}
