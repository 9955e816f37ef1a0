//! Loads as typed.

use super::{Coordinates, NodesFile, Positive};
use crate::sim::Ease;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A load on each body: one of `force`, `traction`, `pressure`, `acceleration`, `torque` and `centrifugal`.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["nodes", "faces"] }))]
pub(in crate::scene) struct LoadFile {
    /// The name of the body. Default: all bodies, each with the whole load.
    pub(in crate::scene) body: Option<String>,
    /// The nodes that share the load equally, as in `[[hold]]`; nodes of a filled surface share it by their masses. Default: all.
    pub(in crate::scene) nodes: Option<NodesFile>,
    /// The faces that share the load by their areas at rest: `"all"` faces of the surface of the elements, or those with all corners among some nodes,
    /// named as in `[[hold]]`. Of a filled surface they are its own triangles, chosen by its points. In the plane faces are sides of elements. Not together with `nodes`. Default: all for `traction` and `pressure`.
    pub(in crate::scene) faces: Option<NodesFile>,
    /// A force of constant direction (N), which nodes or faces share.
    pub(in crate::scene) force: Option<Coordinates>,
    /// A force of constant direction on each area of faces at rest (Pa; in the plane N/m).
    pub(in crate::scene) traction: Option<Coordinates>,
    /// A pressure on faces as they are now, at right angles to them and towards the body (Pa; in the plane N/m). A negative one pulls, as air in a balloon does
    /// from within.
    pub(in crate::scene) pressure: Option<f64>,
    /// An acceleration of the masses of nodes (m/s²), beside gravity.
    pub(in crate::scene) acceleration: Option<Coordinates>,
    /// A torque about the centre of the nodes, wherever they are (N m). In space it is a vector, counter-clockwise when that points at the viewer; in the
    /// plane a number, counter-clockwise.
    pub(in crate::scene) torque: Option<AxialFile>,
    /// The rate at which the frame of the scene turns (rad/s), about an axis through `about`: the centrifugal force on the masses of nodes. In space it is a vector along
    /// the axis, in the plane a number. The Coriolis force on what moves is left out, so it is for rest and slow motion.
    pub(in crate::scene) centrifugal: Option<AxialFile>,
    /// A point of the axis of `centrifugal` (m). Default: the origin.
    pub(in crate::scene) about: Option<Coordinates>,
    /// Start (s).
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) from: f64,
    /// End (s). Default: never.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) until: Option<f64>,
    /// The time in which the load rises from nothing (s). Default: at once. Not together with `keys`.
    pub(in crate::scene) ramp: Option<Positive>,
    /// Shares of the load at rising times, such as `[{ time = 0, share = 0 }, { time = 0.5, share = 1 }]`. The first share holds before the first key,
    /// the last after the last. Default: the whole load.
    #[schemars(length(min = 1))]
    pub(in crate::scene) keys: Option<Vec<ShareFile>>,
    /// Interpolation of `ramp` and between `keys`.
    #[serde(default)]
    pub(in crate::scene) ease: Ease,
}

impl LoadFile {
    /// The time (s) until which it does nothing.
    pub(in crate::scene) fn begin(&self) -> f64 {
        let first = self.shares().first().filter(|key| key.share == 0.0);
        first.map_or(self.from, |key| self.from.max(key.time))
    }

    /// Its shares at times; none if it has no `keys`.
    pub(in crate::scene) fn shares(&self) -> &[ShareFile] {
        self.keys.as_deref().unwrap_or_default()
    }
}

/// A share of a load at a time.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ShareFile {
    /// Time (s).
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) time: f64,
    /// The share of the load, of any size and sign.
    pub(in crate::scene) share: f64,
}

/// A vector along an axis, which is a number in the plane.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum AxialFile {
    /// In the plane.
    Number(f64),
    /// In space.
    Vector(Coordinates),
}
