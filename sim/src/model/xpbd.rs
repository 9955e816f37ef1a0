//! Extended position-based dynamics, with the shape of each element as a compliant constraint.
//!
//! The model moves its nodes itself: they go freely for a step, then constraints pull them back, and velocities follow from the displacements.
//! A constraint `C` of compliance `α` has the energy `C²/2α`, and with `α̃ = α/ΔT²`, `w = 1/m`
//!
//! `Δλ = −(C + α̃ λ) / (Σ w |∇C|² + α̃)`, `Δx = w ∇C Δλ`
//!
//! (M. Macklin, M. Müller, N. Chentanez, XPBD: Position-Based Simulation of Compliant Constrained Dynamics, Motion in Games 2016; J. Bender,
//! M. Müller, M. Macklin, A Survey on Position Based Dynamics, Eurographics 2017 tutorials). Multipliers `λ` add up over the iterations
//! within a step and begin at 0 in each. There is one iteration a step, with small steps in place of more (M. Macklin et al., Small Steps in
//! Physics Simulation, Symposium on Computer Animation 2019): the `step` of a run is their substep.
//!
//! The constraints of an element: `C = √(Σ |r − R|²)` with `α = 1/k`, whose energy is that of [`super::shape_based`] with
//! its material and its `bending`; and with a Poisson's ratio `det F − 1` with `α = 1/λV`. Of one element of equal masses the first one alone
//! is shape matching, `Δx = −s (r − R)` with `s = kΔT²/(m + kΔT²)` (M. Müller et al., Meshless Deformations Based on Shape Matching, SIGGRAPH
//! 2005). Elements come one after the other, each from the positions that the one before has left, in one thread. Their order breaks the symmetry
//! of a body by what a step does not resolve.
//!
//! A constraint pulls back by no more than to `C = 0`, which brings nodes nearer to every state without energy: stiff bodies do not diverge. In a
//! step in which nodes fly much farther than an element one iteration takes back less than they have gained, and the steps after it take back
//! the rest.
//!
//! Like backward Euler, the method damps what a step does not resolve, and with smaller steps it tends to the shape model: its forces and
//! energies are those. It has no other damping. Steps of any length keep the momentum. Projections have no torque at the places to which nodes
//! would go freely, but as changes of velocities they act a step earlier, so that each step loses `Σ m v × Δx` of the angular momentum: of a
//! body with the angular velocity `ω` the part `ω² ΔT` each second.
//!
//! The constraints `√tr FᵀF` and `det F − 1 − μ/λ` of neo-Hookean elements (M. Macklin, M. Müller, A Constraint-Based Formulation of Stable
//! Neo-Hookean Materials, Motion in Games 2021) were tried and left out. Neither is 0 at rest, where shear changes none of them to first
//! order, so that it is resisted explicitly: solved together (Q.-M. Ton-That, P. Kry, S. Andrews, Parallel Block Neo-Hookean XPBD Using Graph
//! Clustering, 2023), a tetrahedron at rest diverges from `ωΔT = √(4/3)` on, less than the 2 of semi-implicit Euler; one after the other, they
//! do not leave it at rest.

#[cfg(feature = "scene")]
use super::shape_based;
use super::shape_based::ShapeBased;
use super::{ElasticModel, ForceModel, Parameter, Projection, Properties, Setting};
use crate::body::Body;
use crate::material::Material;
use crate::mode::Mode;
use glam::DVec3;
use std::sync::Arc;

/// The parameters of the model in a scene file.
#[cfg(feature = "scene")]
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["stiffness"] }, { "required": ["young"] }]))]
#[schemars(extend("dependentRequired" = { "poisson": ["young"] }))]
pub struct Parameters {
    /// Elastic constant of each element, `k_e` of Eq. (4) (N/m). Or give `young`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: Option<f64>,
    /// Young's modulus of the material (Pa; N/m in the plane), in place of `stiffness`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<f64>,
    /// Poisson's ratio of the material, with `young`: a constraint on the volume beside that on the shape. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// A factor of what resists bending, as of `shape-based`. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending: Option<super::Ratio>,
}

/// The model with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Xpbd {
    /// What the constraints are made from, without damping and elements that break.
    shape: ShapeBased,
}

#[cfg(feature = "scene")]
impl Parameters {
    /// A model with this elastic constant (N/m); the other parameters have their defaults.
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness: Some(stiffness), ..Self::default() }
    }

    /// A model of a material with this Young's modulus (Pa); the other parameters have their defaults.
    pub fn of_material(young: f64) -> Self {
        Self { young: Some(young), ..Self::default() }
    }
}

#[cfg(feature = "scene")]
impl super::TypedModel for Parameters {
    fn resolve(&self, body: &Body, _springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, super::Misfit> {
        let (stiffness, material) = super::stiffness(self.stiffness, self.young, self.poisson, body)?;
        let bending = self.bending.map_or(1.0, |bending| bending.0);
        Ok(Arc::new(Xpbd::new(ShapeBased { material, bending, ..ShapeBased::new(stiffness) })))
    }

    fn without_effect(&self, body: &Body) -> Option<super::Misfit> {
        shape_based::Parameters { bending: self.bending, ..Default::default() }.without_effect(body)
    }
}

impl Xpbd {
    /// The constraints that have the energy of a shape model, without its damping, and without elements that break.
    pub fn new(shape: ShapeBased) -> Self {
        Self { shape: ShapeBased { damping: 0.0, breaks_at: None, ..shape } }
    }
}

impl ElasticModel for Xpbd {
    fn properties(&self, body: &Body) -> Properties {
        let of_shape = self.shape.properties(body);
        let Properties { stiffness, counts_fallbacks, parameters, fixed, .. } = of_shape;
        let is_own = |parameter: &Parameter| matches!(parameter.name, "stiffness" | "young" | "poisson" | "bending");
        let (parameters, others): (Vec<_>, Vec<_>) = parameters.into_iter().partition(is_own);
        let rotation = others.into_iter().filter(|parameter| parameter.name == "rotation").chain(fixed).collect();
        let own = Properties { counts_fallbacks, parameters, fixed: rotation, ..Properties::new("xpbd", stiffness) };
        own.fixed("iterations", Setting::Count(1))
    }

    fn material(&self, body: &Body) -> Option<Material> {
        self.shape.material(body)
    }

    /// It exerts no forces in a step.
    fn bound(&self, _: &Body) -> Option<Mode> {
        Some(Mode { stiffness: 0.0, damping: 0.0 })
    }

    fn projection(&self, body: &Arc<Body>) -> Option<Box<dyn Projection>> {
        Some(self.shape.constraints(body))
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        self.shape.start(body, position)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        self.shape.prepare(body)
    }
}
