//! The ways of stepping through time (Eqs. 2–3 and their rivals).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How positions and velocities move from one step to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Eq. (2), then Eq. (3) with the new velocity: symplectic, of first order.
    #[default]
    SemiImplicitEuler,
}
