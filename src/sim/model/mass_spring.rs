//! The model the paper improves on: springs between pairs of nodes (section 2, Eq. (1)).

use super::Misfit;
use crate::sim::body::Body;
use crate::sim::topology::{self, Springs};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a scene types for this model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// Elastic constant of each spring, `k_ij` of Eq. (1) (N/m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Damping constant of each spring, `D_ij` of Eq. (1) (N s/m). Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mean mass of a node.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
    /// Where the springs are. Default: those that the body lists, else `edges+face-diagonals`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub springs: Option<Springs>,
}

/// The model with its parameters resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpring {
    /// Elastic constant `k_ij` of each spring (N/m).
    pub stiffness: f64,
    /// Damping constant `D_ij` of each spring (N s/m).
    pub damping: f64,
    /// The two nodes of each spring; the natural length is their distance at rest.
    pub springs: Vec<[u32; 2]>,
}

impl Parameters {
    /// # Errors
    /// Both kinds of damping at once, or no spring at all.
    pub fn resolve(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<MassSpring, Misfit> {
        let springs = match (self.springs, listed) {
            (None, Some(listed)) => listed.to_vec(),
            (named, _) => topology::springs(named.unwrap_or(Springs::EdgesFaceDiagonals), &body.elements, &body.kinds),
        };
        if springs.is_empty() {
            let message = "this topology puts no spring on the body's elements; list the springs in [body]";
            return Err(Misfit { key: "springs", message: message.into() });
        }
        let damping = super::damping(self.damping, self.damping_ratio, self.stiffness, body)?;
        Ok(MassSpring { stiffness: self.stiffness, damping, springs })
    }
}

impl super::ElasticModel for MassSpring {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }
    fn describe(&self, _body: &Body) -> String {
        unimplemented!()
    }
    fn prepare(&self, _body: &std::sync::Arc<Body>, _initial: &crate::sim::body::State) -> Box<dyn super::ForceModel> {
        unimplemented!()
    }
}
