//! Obstacles as typed.

use super::Coordinates;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Something rigid that nodes bounce off.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(in crate::scene) enum ObstacleFile {
    /// A plane with everything behind it filled.
    Floor(FloorFile),
}

/// A plane with everything behind it filled.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct FloorFile {
    /// Direction out of the floor, of any length but zero. Default: up, along y.
    pub(in crate::scene) normal: Option<Coordinates>,
    /// Distance of the surface from the origin along `normal` (m).
    #[serde(default)]
    pub(in crate::scene) height: f64,
    /// Restitution coefficient e: the part of the normal velocity that a rebound gives back.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(in crate::scene) restitution: f64,
    /// Friction coefficient μ.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) friction: f64,
}
