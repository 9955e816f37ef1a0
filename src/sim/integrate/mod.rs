//! The ways of stepping through time (Eqs. 2–3 and their rivals).

use super::body::State;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How positions and velocities move from one step to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Eq. (2), then Eq. (3) with the new velocity: symplectic, of first order. As printed, Eq. (3) takes the old
    /// velocity, which gains energy without bound.
    #[default]
    SemiImplicitEuler,
}

/// A node whose new velocity is no number or beyond all reason: the step is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Runaway {
    /// The first such node.
    pub node: usize,
}

/// Eqs. (2) and (3), the second with the velocity of the first: `V += F/m ΔT`, then `P += V ΔT`.
///
/// `forces` (N) are overwritten with the new velocities.
///
/// # Errors
/// When a node would become faster than `speed_limit` (m/s); `state` is then as it was.
#[doc(alias = "Eq. 2")]
#[doc(alias = "Eq. 3")]
pub fn semi_implicit_euler(
    state: &mut State,
    forces: &mut [DVec3],
    mass: &[f64],
    step: f64,
    speed_limit: f64,
) -> Result<(), Runaway> {
    for ((force, &mass), &velocity) in forces.iter_mut().zip(mass).zip(&state.velocity) {
        *force = velocity + *force / mass * step;
    }
    let limit = speed_limit * speed_limit;
    // NaN is within no bounds.
    let within_bounds = |velocity: &DVec3| velocity.length_squared() <= limit;
    if let Some(node) = forces.iter().position(|velocity| !within_bounds(velocity)) {
        return Err(Runaway { node });
    }
    state.velocity.copy_from_slice(forces);
    for (position, &velocity) in state.position.iter_mut().zip(&state.velocity) {
        *position += velocity * step;
    }
    Ok(())
}
