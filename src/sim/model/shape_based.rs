//! The paper's model: every element keeps its own shape (section 3, Eq. (4)).
//!
//! Force on node `i`: `−Σ_e (k d_ie + D v_ie)`, with `d_ie = r_i − R_i` its distance from the equilibrium shape of
//! element `e`, and `v_ie` its velocity relative to the mean velocity of the element's nodes.
//!
//! Energy: `E = k/2 Σ_e Σ_i |r_i − R_i|²`. With the exact rotation its negative gradient is the elastic force,
//! because moving along the optimum changes `E` only in second order.
//!
//! The centre of an element is the unweighted mean of its nodes: with any other, unequal masses would give a net
//! internal force.

use super::{ElasticModel, ForceModel, Measure, Misfit, Needs, TypedModel, blocks};
use crate::sim::body::{Body, Dimension, State};
use crate::sim::census::Census;
use crate::sim::rotation::{self, davenport1968, linear_update, linearised, planar};
use glam::{DMat3, DQuat, DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a scene types for this model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
pub struct Parameters {
    /// Elastic constant of each element, `k_e` of Eq. (4) (N/m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Damping constant of each element, `D_e` of Eq. (4) (N s/m). Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mass of the lightest node, as in `step = "T/50"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
    /// How often Eq. (15) is solved at each evaluation of the forces, each time from the last result (paper,
    /// section 4). Default: 2, as the paper advises.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100))]
    pub passes: Option<u32>,
    /// How Eq. (15) is solved and its solution becomes a rotation. In the plane Eq. (9) is exact and there is nothing
    /// to choose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationReading>,
    /// Which velocity the damping of Eq. (4) acts on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping_of: Option<DampingReading>,
}

/// How the rotation of an element is found. The paper's Eqs. (15) and (16) can be read in three ways; two better
/// solvers stand beside them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RotationReading {
    /// About `w` by the angle `atan |w|`, which is Eq. (9) about that axis; true rotations are accumulated. The default.
    #[default]
    Arctangent,
    /// About `w` by the angle `|w|`; true rotations are accumulated. It overshoots and can spin a free body up.
    VectorLength,
    /// Eq. (16) as printed, `R + w × R`. That is no rotation: a spinning body swells.
    LinearUpdate,
    /// Like `arctangent`, with the symmetric part of Eq. (15)'s matrix: each pass takes the error to its third power
    /// instead of its second. Not in the paper.
    Symmetric,
    /// The exact optimum at every evaluation, without Eq. (15) and without passes. Not in the paper.
    Exact,
}

/// Which velocity the damping of Eq. (4) acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum DampingReading {
    /// As printed: a node's velocity relative to the element's mean. It brakes the spin of a rigid body, too. The
    /// default.
    #[default]
    RelativeMotion,
    /// What is left of that velocity when the best-fitting rigid spin is taken away.
    Deformation,
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
    /// How the rotation of an element is found.
    pub rotation: RotationReading,
    /// Which velocity is damped.
    pub damping_of: DampingReading,
}

impl TypedModel for Parameters {
    fn resolve(&self, body: &Body, _springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        if body.dimension == Dimension::Plane {
            let given = [("rotation", self.rotation.is_some()), ("passes", self.passes.is_some())];
            if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
                let message = format!(
                    "`{key}` is about Eq. (15), but the body is in the plane, where Eq. (9) is exact; take it out"
                );
                return Err(Misfit { key, message });
            }
        }
        if self.rotation == Some(RotationReading::Exact) && self.passes.is_some() {
            let message = "`passes` is about Eq. (15), which `rotation = \"exact\"` does without; take it out";
            return Err(Misfit { key: "passes", message: message.into() });
        }
        Ok(Arc::new(ShapeBased {
            stiffness: self.stiffness,
            damping: super::damping(self.damping, self.damping_ratio, self.stiffness, body)?,
            passes: self.passes.unwrap_or(2),
            rotation: self.rotation.unwrap_or_default(),
            damping_of: self.damping_of.unwrap_or_default(),
        }))
    }

    fn needs(&self, census: &Census) -> Needs {
        /// For each corner of an element its place at rest, its force and its entry in the sum (bytes).
        const CORNER: u128 = 70;
        Needs { working: census.corners().saturating_mul(CORNER), ..Needs::default() }
    }
}

impl ElasticModel for ShapeBased {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn describe(&self, body: &Body) -> String {
        let mut text = super::describe(&super::elements_in_words(body), self.stiffness, self.damping, body);
        text.push_str(match self.rotation {
            RotationReading::Arctangent => "",
            RotationReading::VectorLength => ", θ = |w|",
            RotationReading::LinearUpdate => ", Eq. (16)",
            RotationReading::Symmetric => ", symmetric Eq. (15)",
            RotationReading::Exact => ", exact rotations",
        });
        if self.damping > 0.0 && self.damping_of == DampingReading::Deformation {
            text.push_str(" of deformation");
        }
        text
    }

    fn prepare(&self, body: &Arc<Body>, initial: &State) -> Box<dyn ForceModel> {
        Box::new(Elements::new(self.clone(), body, initial))
    }
}

impl ShapeBased {
    /// The rotation of an element in space from its last one, as read.
    fn follow(&self, at_rest: DMat3, last: DQuat) -> DQuat {
        use linearised::{follow, solve, solve_symmetric, turn, turn_by_length};
        match self.rotation {
            RotationReading::VectorLength => follow(at_rest, last, self.passes, |a| turn_by_length(solve(a))),
            RotationReading::Symmetric => follow(at_rest, last, self.passes, |a| turn(solve_symmetric(a))),
            RotationReading::Exact => davenport1968::optimum(at_rest, last),
            _ => follow(at_rest, last, self.passes, |a| turn(solve(a))),
        }
    }
}

/// The rotations of all elements: the model's memory from one evaluation to the next.
#[derive(Clone, Debug)]
enum Rotations {
    /// `(cos θ, sin θ)` of each element in the plane.
    Plane(Memory<DVec2>),
    /// The unit quaternion of each element in space.
    Space(Memory<DQuat>),
    /// The matrix of each element under Eq. (16), which is no rotation for long.
    Linear(Memory<DMat3>),
}

/// One entry per element.
#[derive(Clone, Debug)]
struct Memory<T> {
    /// From what an evaluation of the forces starts.
    last: Vec<T>,
    /// What the last evaluation found.
    found: Vec<T>,
}

impl<T: Clone> Memory<T> {
    fn new(start: impl Iterator<Item = T>) -> Self {
        let last: Vec<_> = start.collect();
        Self { found: last.clone(), last }
    }

    fn commit(&mut self) {
        std::mem::swap(&mut self.last, &mut self.found);
    }
}

/// A body's elements at work.
struct Elements {
    model: ShapeBased,
    body: Arc<Body>,
    /// `R0` of each corner (m), element after element.
    rest: Vec<DVec3>,
    /// `Σ m |R0|²` of each element (kg m²), Eq. (17).
    inertia: Vec<f64>,
    rotations: Rotations,
    /// Force on each corner (N), element after element; a node sums its own in this order.
    corner_forces: Vec<DVec3>,
    gather: blocks::Gather,
}

impl Elements {
    fn new(model: ShapeBased, body: &Arc<Body>, initial: &State) -> Self {
        let elements = &body.elements;
        let mut rest = Vec::with_capacity(elements.indices().len());
        for nodes in elements.iter() {
            let centre = mean(nodes, &body.rest);
            rest.extend(nodes.iter().map(|&node| body.rest[node as usize] - centre));
        }
        let inertia = (0..elements.len())
            .map(|element| inertia(&elements[element], &rest[elements.range(element)], &body.mass))
            .collect();
        // The start is the exact optimum of the initial positions, not the identity.
        let at_rest = |element: usize| {
            let nodes = &elements[element];
            moment_at_rest(&rest[elements.range(element)], nodes, mean(nodes, &initial.position), &initial.position)
        };
        let all = 0..elements.len();
        let rotations = match body.dimension {
            Dimension::Plane => Rotations::Plane(Memory::new(all.map(|e| planar::solve(at_rest(e), DVec2::X)))),
            Dimension::Space => {
                let turns = all.map(|e| davenport1968::optimum(at_rest(e), DQuat::IDENTITY));
                match model.rotation {
                    RotationReading::LinearUpdate => Rotations::Linear(Memory::new(turns.map(DMat3::from_quat))),
                    _ => Rotations::Space(Memory::new(turns)),
                }
            }
        };
        let corner_forces = vec![DVec3::ZERO; rest.len()];
        let gather = blocks::Gather::new(body.len(), elements.indices().iter().copied());
        Self { model, body: Arc::clone(body), rest, inertia, rotations, corner_forces, gather }
    }

    /// The rotation that an evaluation of the forces finds for one element.
    fn rotation(&self, element: usize, at_rest: DMat3) -> DMat3 {
        match &self.rotations {
            Rotations::Plane(memory) => planar::matrix(planar::solve(at_rest, memory.last[element])),
            Rotations::Space(memory) => DMat3::from_quat(self.model.follow(at_rest, memory.last[element])),
            Rotations::Linear(memory) => linear_update::follow(at_rest, memory.last[element], self.model.passes),
        }
    }

    /// Calls `visit` with each node of an element and its squared distance from the equilibrium shape (m²), and returns
    /// `Σ R rᵀ` (m²).
    fn distances(&self, element: usize, state: &State, mut visit: impl FnMut(u32, f64)) -> DMat3 {
        let nodes = &self.body.elements[element];
        let rest = &self.rest[self.body.elements.range(element)];
        let centre = mean(nodes, &state.position);
        let at_rest = moment_at_rest(rest, nodes, centre, &state.position);
        let turn = self.rotation(element, at_rest);
        for (&node, &rest) in nodes.iter().zip(rest) {
            visit(node, (state.position[node as usize] - centre - turn * rest).length_squared());
        }
        turn * at_rest
    }
}

impl ForceModel for Elements {
    fn add_forces(&mut self, state: &State, forces: &mut [DVec3]) {
        let Self { model, body, rest, rotations, corner_forces, gather, .. } = self;
        let evaluate = Evaluate { model, body, rest, state };
        match rotations {
            Rotations::Plane(Memory { last, found }) => {
                blocks::for_each(&body.elements, found, corner_forces, &|element, found, out| {
                    evaluate.element(element, out, |at_rest| {
                        *found = planar::solve(at_rest, last[element]);
                        planar::matrix(*found)
                    });
                });
            }
            Rotations::Space(Memory { last, found }) => {
                blocks::for_each(&body.elements, found, corner_forces, &|element, found, out| {
                    evaluate.element(element, out, |at_rest| {
                        *found = model.follow(at_rest, last[element]);
                        DMat3::from_quat(*found)
                    });
                });
            }
            Rotations::Linear(Memory { last, found }) => {
                blocks::for_each(&body.elements, found, corner_forces, &|element, found, out| {
                    evaluate.element(element, out, |at_rest| {
                        *found = linear_update::follow(at_rest, last[element], model.passes);
                        *found
                    });
                });
            }
        }
        gather.add(corner_forces, forces);
    }

    fn commit(&mut self) {
        match &mut self.rotations {
            Rotations::Plane(memory) => memory.commit(),
            Rotations::Space(memory) => memory.commit(),
            Rotations::Linear(memory) => memory.commit(),
        }
    }

    fn is_damped(&self) -> bool {
        self.model.damping > 0.0
    }

    fn measure(&self, state: &State) -> Measure {
        let (mut energy, mut residual) = (0.0, 0.0f64);
        for element in 0..self.body.elements.len() {
            let a = self.distances(element, state, |_, squared| energy += 0.5 * self.model.stiffness * squared);
            residual = residual.max(angular_acceleration(a, self.model.stiffness, self.inertia[element]));
        }
        Measure { energy: Some(energy), residual: Some(residual) }
    }

    fn share_energy(&self, state: &State, energies: &mut [f64]) {
        for element in 0..self.body.elements.len() {
            self.distances(element, state, |node, squared| {
                energies[node as usize] += 0.5 * self.model.stiffness * squared;
            });
        }
    }
}

/// What one evaluation of the forces reads.
struct Evaluate<'a> {
    model: &'a ShapeBased,
    body: &'a Body,
    rest: &'a [DVec3],
    state: &'a State,
}

impl Evaluate<'_> {
    /// Eq. (4) for one element: writes the force on each of its corners (N). `solve` turns `Σ R0 rᵀ` into the
    /// rotation matrix.
    #[doc(alias = "Eq. 4")]
    fn element(&self, element: usize, forces: &mut [DVec3], solve: impl FnOnce(DMat3) -> DMat3) {
        let Self { model: &ShapeBased { stiffness: k, damping: d, damping_of, .. }, body, state, .. } = *self;
        let nodes = &body.elements[element];
        let rest = &self.rest[body.elements.range(element)];
        let centre = mean(nodes, &state.position);
        let drift = mean(nodes, &state.velocity);
        let turn = solve(moment_at_rest(rest, nodes, centre, &state.position));
        let spin = match damping_of {
            DampingReading::RelativeMotion => None,
            DampingReading::Deformation => {
                let corners = nodes
                    .iter()
                    .map(|&node| (state.position[node as usize] - centre, state.velocity[node as usize] - drift));
                Some(best_spin(corners))
            }
        };
        for ((force, &node), &rest) in forces.iter_mut().zip(nodes).zip(rest) {
            let r = state.position[node as usize] - centre;
            let displacement = r - turn * rest;
            let mut relative_velocity = state.velocity[node as usize] - drift;
            if let Some(spin) = spin {
                relative_velocity -= spin.cross(r);
            }
            *force = -(displacement * k + relative_velocity * d);
        }
    }
}

/// `Σ R0 rᵀ` of an element (m²).
fn moment_at_rest(rest: &[DVec3], nodes: &[u32], centre: DVec3, position: &[DVec3]) -> DMat3 {
    rotation::moment(rest, nodes.iter().map(|&node| position[node as usize] - centre))
}

/// The unweighted mean of `values` over the nodes of an element.
fn mean(nodes: &[u32], values: &[DVec3]) -> DVec3 {
    let sum = nodes.iter().fold(DVec3::ZERO, |sum, &node| sum + values[node as usize]);
    sum / nodes.len() as f64
}

/// The spin `ω` (rad/s) that takes most away from velocities: `Σ (r² I − r rᵀ) ω = Σ r × v`, for corners given by place
/// (m) and velocity (m/s) relative to their means. Forces in proportion to what is left have no torque.
fn best_spin(corners: impl Iterator<Item = (DVec3, DVec3)>) -> DVec3 {
    /// Corners whose matrix has a determinant below this part of what it would be in a ball lie on a line.
    const LINE: f64 = 1e-12;
    let (mut matrix, mut momentum, mut squares) = (DMat3::ZERO, DVec3::ZERO, 0.0);
    for (r, v) in corners {
        let squared = r.length_squared();
        squares += squared;
        matrix += DMat3::from_diagonal(DVec3::splat(squared)) - DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        momentum += r.cross(v);
    }
    if squares == 0.0 {
        return DVec3::ZERO;
    }
    if matrix.determinant() <= LINE * squares * squares * squares {
        // A line has no spin about itself, and the same moment about all axes across.
        return momentum / squares;
    }
    matrix.inverse() * momentum
}

/// Eq. (17): the rough moment of inertia `I = Σ m |R0|²` of an element (kg m²); it overstates a cube's by half.
#[doc(alias = "Eq. 17")]
fn inertia(nodes: &[u32], rest: &[DVec3], mass: &[f64]) -> f64 {
    nodes.iter().zip(rest).map(|(&node, rest)| mass[node as usize] * rest.length_squared()).sum()
}

/// Eq. (18): `|α| = k |Σ r × R| / I` (rad/s²), what the error of an element's rotation amounts to. `a` is `Σ R rᵀ`.
#[doc(alias = "Eq. 18")]
fn angular_acceleration(a: DMat3, stiffness: f64, inertia: f64) -> f64 {
    stiffness * rotation::torque(a).length() / inertia
}
