//! The paper's model: every element keeps its own shape (section 3).

use super::Misfit;
use crate::sim::body::Body;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a scene types for this model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parameters {
    /// Elastic constant of each element, `k_e` of Eq. (4) (N/m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Damping constant of each element, `D_e` of Eq. (4) (N s/m). Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mean mass of a node.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
    /// How often Eq. (15) is solved at each evaluation of the forces, each time from the last result (paper,
    /// section 4). Default: 2, as the paper advises.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100))]
    pub passes: Option<u32>,
}

/// The model with its parameters resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeBased {
    /// Elastic constant `k_e` of each element (N/m).
    pub stiffness: f64,
    /// Damping constant `D_e` of each element (N s/m).
    pub damping: f64,
    /// How often Eq. (15) is solved at each evaluation.
    pub passes: u32,
}

impl Parameters {
    /// # Errors
    /// Both kinds of damping at once.
    pub fn resolve(&self, body: &Body) -> Result<ShapeBased, Misfit> {
        Ok(ShapeBased {
            stiffness: self.stiffness,
            damping: super::damping(self.damping, self.damping_ratio, self.stiffness, body)?,
            passes: self.passes.unwrap_or(2),
        })
    }
}

impl super::ElasticModel for ShapeBased {
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
