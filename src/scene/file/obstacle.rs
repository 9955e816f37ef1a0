//! Obstacles as typed.

use super::{Coordinates, MotionPath, Rotation, Swing};
use crate::sim::FrictionOf;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rigid obstacle that bodies collide with. It is fixed unless a `path` or a `swing` moves it.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("not" = { "required": ["path", "swing"] }))]
pub(in crate::scene) struct ObstacleFile {
    #[serde(flatten)]
    pub(in crate::scene) shape: ShapeFile,
    /// Unique name, which `contact.pair` uses. No body has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: Option<String>,
    /// Coefficient of restitution e: the part of the normal velocity that a rebound keeps.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(in crate::scene) restitution: f64,
    /// Coefficient of friction μ.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) friction: f64,
    /// The motion that friction acts on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(in crate::scene) friction_of: Option<FrictionOf>,
    /// The point about which `path` and `swing` rotate (m). Default: the point named for this kind.
    pub(in crate::scene) about: Option<Coordinates>,
    /// Keyframes along which the obstacle moves. Not together with `swing`.
    pub(in crate::scene) path: Option<MotionPath>,
    /// An oscillation, such as `{ period = 1.2, shift = [0.1, 0, 0] }`. Not together with `path`.
    pub(in crate::scene) swing: Option<Swing>,
}

/// The shape of an obstacle.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(in crate::scene) enum ShapeFile {
    /// A half-space, drawn as ground. It rotates about its point nearest to the origin.
    Floor {
        /// Outward normal, of any length but zero. Default: up, along y.
        normal: Option<Coordinates>,
        /// Distance of the surface from the origin along `normal` (m).
        #[serde(default)]
        height: f64,
    },
    /// A half-space, drawn as a plate. It rotates about its `point`.
    Plate {
        /// A point of the surface (m).
        point: Coordinates,
        /// Outward normal, towards the body, of any length but zero.
        normal: Coordinates,
    },
    /// A ball; in the plane a disc. It rotates about its centre.
    Sphere {
        /// Centre (m).
        centre: Coordinates,
        /// Radius (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    },
    /// A rod with round ends: all points near a line segment. It rotates about its centre.
    Capsule {
        /// Centre of one round end (m).
        from: Coordinates,
        /// Centre of the other round end (m).
        to: Coordinates,
        /// Radius of rod and ends (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
    },
    /// A cuboid; in the plane a rectangle. It rotates about its centre.
    Box {
        /// Centre (m).
        centre: Coordinates,
        /// Lengths of its sides (m), each greater than zero.
        #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }))]
        size: Coordinates,
        /// Orientation of its sides. Default: along the axes.
        rotation: Option<Rotation>,
    },
}
