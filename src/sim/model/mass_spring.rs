//! The model the paper improves on: springs between pairs of nodes (section 2, Eq. (1)).
//!
//! Force on node `i` from the spring to `j`: `−{k (1 − L/|p|) + D (v·p)/(p·p)} p`, with `p` and `v` the position and
//! velocity of `i` relative to `j` and `L` the natural length.
//!
//! Energy: `E = k/2 Σ (|p| − L)²`. A mirror image has the same energy, which is why a turned-over element stays so.

use super::{ElasticModel, ForceModel, Measure, Misfit, blocks};
use crate::sim::body::{Body, State};
use crate::sim::topology::{self, Springs};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a scene types for this model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
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

impl ElasticModel for MassSpring {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn describe(&self, body: &Body) -> String {
        let count = self.springs.len();
        let springs = format!("{count} spring{}", if count == 1 { "" } else { "s" });
        super::describe(&springs, self.stiffness, self.damping, body)
    }

    fn prepare(&self, body: &Arc<Body>, _initial: &State) -> Box<dyn ForceModel> {
        let length = |&[i, j]: &[u32; 2]| (body.rest[i as usize] - body.rest[j as usize]).length();
        Box::new(Lattice {
            natural_length: self.springs.iter().map(length).collect(),
            spring_forces: vec![DVec3::ZERO; self.springs.len()],
            gather: blocks::SignedGather::new(body.len(), &self.springs),
            model: self.clone(),
        })
    }
}

/// A body's springs at work.
struct Lattice {
    model: MassSpring,
    /// `L_ij` of each spring (m).
    natural_length: Vec<f64>,
    /// Force of each spring on its first node (N); its second node gets the opposite.
    spring_forces: Vec<DVec3>,
    gather: blocks::SignedGather,
}

impl ForceModel for Lattice {
    fn add_forces(&mut self, state: &State, forces: &mut [DVec3]) {
        let Self { model, natural_length, spring_forces, gather } = self;
        blocks::for_each_one(spring_forces, &|at, out| {
            let [i, j] = model.springs[at].map(|node| node as usize);
            *out = spring_force(
                state.position[i] - state.position[j],
                state.velocity[i] - state.velocity[j],
                natural_length[at],
                model.stiffness,
                model.damping,
            );
        });
        gather.add(spring_forces, forces);
    }

    fn measure(&self, state: &State) -> Measure {
        let energy = self.model.springs.iter().zip(&self.natural_length).map(|(&[i, j], &natural)| {
            let stretch = (state.position[i as usize] - state.position[j as usize]).length() - natural;
            0.5 * self.model.stiffness * stretch * stretch
        });
        Measure { energy: Some(energy.sum()), residual: None }
    }
}

/// Eq. (1), one spring: the force on node `i` (N) from its position `p` (m) and velocity `v` (m/s) relative to `j`,
/// the natural length `l` (m), `k` (N/m) and `d` (N s/m).
///
/// The formula is singular for coincident nodes, where a spring has no direction: there the force is zero.
#[doc(alias = "Eq. 1")]
fn spring_force(p: DVec3, v: DVec3, l: f64, k: f64, d: f64) -> DVec3 {
    let squared = p.dot(p);
    if squared == 0.0 {
        return DVec3::ZERO;
    }
    p * -(k * (1.0 - l / squared.sqrt()) + d * v.dot(p) / squared)
}
