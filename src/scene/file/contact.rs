//! Contact as typed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the surfaces of bodies meet: each other, obstacles with an extent, and themselves ([contact](contact.md)).
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ContactFile {
    /// What meets. Default: `"surfaces"`.
    pub(in crate::scene) rule: Option<ContactRule>,
    /// Coefficient of restitution e between bodies, and of bodies with themselves. With obstacles it is that of the obstacle.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0, max = 1.0), extend("default" = 0.0))]
    pub(in crate::scene) restitution: f64,
    /// Coefficient of friction μ between bodies, and of bodies with themselves. With obstacles it is that of the obstacle.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[schemars(range(min = 0.0), extend("default" = 0.0))]
    pub(in crate::scene) friction: f64,
    /// Whether bodies that overlap or touch at the start are moved apart before it, as wholes and by the shortest straight way, until they
    /// keep their distances. Obstacles stay, and of two bodies the first. `check` tells the ways.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schemars(extend("default" = false))]
    pub(in crate::scene) separate: bool,
    /// Pairs that meet otherwise. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(in crate::scene) pair: Vec<PairFile>,
}

/// Scenes made in code are checked as written: beside `"nodes"` nothing may be.
fn is_zero(coefficient: &f64) -> bool {
    *coefficient == 0.0
}

/// What meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::scene) enum ContactRule {
    /// Points meet faces and edges meet edges, of bodies and of obstacles with an extent. Floors and plates are met by nodes,
    /// and by the points of a carried surface.
    #[default]
    Surfaces,
    /// Nodes meet obstacles, as in the paper, and nothing else meets: bodies go through each other.
    Nodes,
}

/// Two bodies, or a body and an obstacle, that meet otherwise than usual.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct PairFile {
    /// The names of the two: two bodies, or a body and an obstacle with an extent.
    pub(in crate::scene) of: [String; 2],
    /// Coefficient of restitution e. Default: as usual.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(in crate::scene) restitution: Option<f64>,
    /// Coefficient of friction μ. Default: as usual.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) friction: Option<f64>,
    /// The distance that they keep (m), at most a cell. Default: as usual.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) thickness: Option<f64>,
}
