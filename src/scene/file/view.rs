//! The view as typed.

use super::Coordinates;
use crate::scene::view::Theme;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a scene is drawn.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::scene) struct ViewFile {
    /// Width and height of the picture (px).
    #[schemars(inner(range(min = 16, max = 16384)))]
    pub(in crate::scene) size: [u32; 2],
    /// The colours.
    pub(in crate::scene) theme: Theme,
    /// What the clock counts from, in the words shown under the time.
    #[schemars(length(max = 80))]
    pub(in crate::scene) clock: String,
    /// How many panels stand beside each other. Default: all of them, up to 3; never more than there are runs.
    #[schemars(range(min = 1, max = 64))]
    pub(in crate::scene) columns: Option<u32>,
    /// From where the scene is seen.
    pub(in crate::scene) camera: CameraFile,
}

impl Default for ViewFile {
    fn default() -> Self {
        Self {
            size: [1280, 720],
            theme: Theme::default(),
            clock: "after release".into(),
            columns: None,
            camera: CameraFile::default(),
        }
    }
}

/// A perspective camera that looks at a point. A body in the plane is looked at straight from the front.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::scene) struct CameraFile {
    /// Turn to the right around the vertical, from looking along −z (rad). Default: 0.541, which is 31°. Not in the
    /// plane.
    pub(in crate::scene) azimuth: Option<f64>,
    /// Height above the horizon (rad), less than a quarter turn (1.57) either way. Default: 0.297, which is 17°. Not in
    /// the plane.
    #[schemars(extend("exclusiveMinimum" = -1.57, "exclusiveMaximum" = 1.57))]
    pub(in crate::scene) elevation: Option<f64>,
    /// Vertical field of view (rad). Default: 0.349, which is 20°.
    #[schemars(range(min = 0.001, max = 3.0))]
    pub(in crate::scene) field_of_view: Option<f64>,
    /// The point looked at (m). Default: the middle of the body as it would stand on the first floor below it, or
    /// where it starts if there is none.
    pub(in crate::scene) target: Option<Coordinates>,
    /// Distance from that point (m). Default: 8.5 times the largest side of the box around the body at the start, and
    /// more if the body starts higher than that shows.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) distance: Option<f64>,
    /// Whether the camera rises and draws back with the highest body shown, alike in all panels. Where there is no
    /// floor to stand on, it sinks with the lowest.
    pub(in crate::scene) follow: bool,
}
