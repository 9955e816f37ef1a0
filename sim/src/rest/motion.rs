//! Motion that is brought to rest: whenever its kinetic energy has fallen, all nodes are stopped.
//!
//! A body that swings has then passed its balance, and starts again from near it. P. A. Cundall (1976); M. R. Barnes, Form finding and analysis of
//! tension structures by dynamic relaxation, International Journal of Space Structures 14, 89 (1999).

use super::{Forces, MOST, SOUGHT};
use glam::DVec3;

/// Stops without half the residual, after which it does not fall.
const IDLE: u32 = 200;
/// Nodes are stopped when the kinetic energy has fallen to this part of its greatest value. Contact of surfaces makes it jump.
const FALLEN: f64 = 0.7;

/// Moves nodes until the residual is small or does not fall, and returns where it was smallest (m). The forces that are left are means over `steps` steps from rest: contact of
/// surfaces, which resolves one touch after another, balances only in the mean.
pub(super) fn settle(forces: &mut Forces, steps: u32) -> Vec<DVec3> {
    let start = forces.world.state().position.clone();
    let (mut position, mut found, mut best, mut idle) = (start.clone(), start, f64::INFINITY, 0);
    while forces.evaluations < MOST && idle < IDLE {
        let Some(left) = forces.mean(&position, steps) else { break };
        let residual = forces.residual(&position, &left);
        idle = if residual < 0.5 * best { 0 } else { idle + 1 };
        if residual < best {
            best = residual;
            found.clone_from(&position);
        }
        if best <= SOUGHT {
            break;
        }
        let (mut energy, mut most) = (forces.kinetic_energy(), 0.0_f64);
        while energy > FALLEN * most && forces.evaluations < MOST {
            most = most.max(energy);
            position.clone_from(&forces.world.state().position);
            forces.evaluations += 1;
            if !forces.world.take_step() {
                break;
            }
            energy = forces.kinetic_energy();
        }
    }
    found
}
