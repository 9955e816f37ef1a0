//! The camera of a view.

use crate::reading::coordinates::Coordinates;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
pub(crate) struct CameraFile {
    /// Azimuth to the right, from looking along −z (rad). Only in space. Default: 0.541, which is 31°; or, where spheres,
    /// capsules or boxes hide much of the bodies from there, the first of eleven others, 30° apart, from which they hide little. A camera with a
    /// `target` or `distance` does not turn.
    pub(crate) azimuth: Option<f64>,
    /// Elevation above the horizon (rad), below a quarter turn (1.57), so that the camera does not look along its
    /// up-axis. Only in space. Default: 0.297, which is 17°.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(crate) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(crate) field_of_view: Option<f64>,
    /// The point (m) that a fixed camera looks at. Default: the middle of the body at the start.
    pub(crate) target: Option<Coordinates>,
    /// Distance of a fixed camera from its target (m). In the plane it gives the scale together with `field_of_view`.
    /// Default: 8.5 times the longest side of the bounding box at the start.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(crate) distance: Option<f64>,
}

/// The unit vectors of a camera with an azimuth and elevation (rad): right, up, and from its target to it.
pub(crate) fn axes(azimuth: f64, elevation: f64) -> [DVec3; 3] {
    let [(across, along), (rise, level)] = [azimuth, elevation].map(libm::sincos);
    let towards = DVec3::new(across * level, rise, along * level);
    let right = DVec3::new(along, 0.0, -across);
    [right, towards.cross(right), towards]
}
