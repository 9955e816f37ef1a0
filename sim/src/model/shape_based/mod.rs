//! The paper's model: every element keeps its own shape (section 3, Eq. (4)).
//!
//! Force on node `i`: `−Σ_e (k d_ie + D v_ie)`, with `d_ie = r_i − R_i` its displacement from the equilibrium shape of
//! element `e`, and `v_ie` its velocity relative to the mean velocity of the element's nodes.
//!
//! Energy: `E = k/2 Σ_e Σ_i |r_i − R_i|²`. With the exact rotation its negative gradient is the elastic force, because
//! `E` is stationary with respect to the rotation.
//!
//! Two options go beyond the paper. With `F` the linear map that fits `r` to `R0` best, [`bending`](ShapeBased::bending) `β` multiplies the
//! part of the displacement that is not affine, so that `d = β (r − F R0) + (F − R) R0`. A
//! [Poisson's ratio](ShapeBased::material) adds the energy `½ λ V (det F − 1)²`.
//!
//! Elements can break ([`breaks_at`](ShapeBased::breaks_at)), as springs do in Ref. 2 of the paper (Norton and others 1991, "Animation of fracture by
//! physical modeling"): an element whose [strain](crate::Field::Strain) exceeds a limit is taken out for good. They, too, let all springs of a cube
//! break at once (O'Brien and Hodgins 1999, "Graphical modeling and animation of brittle fracture").
//!
//! The centre of an element is the unweighted mean of its nodes: with a centre of mass, unequal masses would give a net
//! internal force.

mod affine;
mod in_lanes;
mod projection;

use super::{ElasticModel, ForceModel, Late, Properties, Report, Scratch, Setting, Share, Vectorised, blocks};
use crate::body::Body;
use crate::crew::Crew;
use crate::element::Dimension;
use crate::fill;
use crate::kernel::lattice::{self, LatticeStepper};
use crate::kernel::{Compiled, Conditions, Rotation, Stepper, damped};
use crate::material::Material;
use crate::mode::Mode;
pub use crate::rotation::RotationReading;
use crate::rotation::{self, davenport1968, linear_update, planar};
use crate::state::Nodes;
use affine::{AtRest, Stretch};
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The parameters of the model in a scene file.
#[cfg(feature = "scene")]
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
#[schemars(extend("oneOf" = [{ "required": ["stiffness"] }, { "required": ["young"] }]))]
#[schemars(extend("dependentRequired" = { "poisson": ["young"] }))]
pub struct Parameters {
    /// Elastic constant of each element, `k_e` of Eq. (4) (N/m). Or give `young`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: Option<f64>,
    /// Young's modulus of the material (Pa; N/m in the plane), in place of `stiffness`: each element has the elastic constant that its
    /// shape needs for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: Option<f64>,
    /// Poisson's ratio of the material, with `young`: an energy of the volume beside that of the shape. Default: 0, the paper's model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// A factor of the forces that resist bending, a number or a fraction such as `"1/3"`. With `"1/3"`, lattices of cubes bend like
    /// the material at any number of cells; the paper's model is stiffer. Default: 1, the paper's model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bending: Option<super::Ratio>,
    /// Damping constant of each element, `D_e` of Eq. (4) (N s/m). Where elements differ in stiffness, as with `young`, it is that of the stiffest
    /// one, and others have it in proportion. Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mass of the lightest node, as in `step = "T/50"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
    /// Number of passes of Eq. (15) at each evaluation of the forces. The first pass starts from the last rotation
    /// (paper, section 4). Without a `rotation` it selects `arctangent`. Default: 2, as the paper advises.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100))]
    pub passes: Option<u32>,
    /// The method that computes the rotation of an element. In the plane all use Eq. (9), which is exact. Default:
    /// `robust`; the paper's method is `arctangent`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<RotationReading>,
    /// The velocity that the damping of Eq. (4) acts on. Beside it, `mass_damping` of the scene brakes all motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping_of: Option<DampingReading>,
    /// The strain at which an element breaks: it is taken out for good. It is the `"strain"` that `view.colour` shows. Default: elements never break.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub breaks_at: Option<f64>,
}

/// The velocity that the damping of Eq. (4) acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum DampingReading {
    /// As printed: the velocity of a node relative to the element's mean. It also damps rigid rotation. The default.
    #[default]
    RelativeMotion,
    /// This relative velocity minus the best-fitting rigid rotation.
    Deformation,
}

impl DampingReading {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::RelativeMotion => "relative-motion",
            Self::Deformation => "deformation",
        }
    }
}

/// The model with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeBased {
    /// Elastic constant `k_e` of each element (N/m), with a material of the stiffest one.
    pub stiffness: f64,
    /// The material that decides the relative stiffness of the elements, in place of [`Body::stiffness`].
    pub material: Option<Material>,
    /// A factor `β` of the part of displacements that is not affine, from 0 to 1.
    pub bending: f64,
    /// Damping constant `D_e` of each element (N s/m), with a material of the stiffest one.
    pub damping: f64,
    /// Number of passes at each evaluation of the forces. A pass solves Eq. (15) once.
    pub passes: u32,
    /// How the rotation of an element is computed.
    pub rotation: RotationReading,
    /// Which velocity is damped.
    pub damping_of: DampingReading,
    /// The [strain](crate::Field::Strain) at which an element breaks; `None` if none does. Elements that break have exact rotations.
    pub breaks_at: Option<f64>,
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
        if body.dimension == Dimension::Plane {
            let given = [("rotation", self.rotation.is_some()), ("passes", self.passes.is_some())];
            if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
                let message = format!(
                    "`{key}` is about Eq. (15), but the body is in the plane, where Eq. (9) is exact; take it out"
                );
                return Err(super::Misfit { key, message });
            }
        }
        if let Some(rotation) = self.rotation.filter(|rotation| self.passes.is_some() && !rotation.has_passes()) {
            let rotation = rotation.name();
            let message = format!(
                "`passes` is the number of steps of an iteration, which `rotation = \"{rotation}\"` does without; take it out"
            );
            return Err(super::Misfit { key: "passes", message });
        }
        let rotation = self.rotation.unwrap_or(match self.passes {
            Some(_) => RotationReading::Arctangent,
            None => RotationReading::default(),
        });
        if self.breaks_at.is_some() && rotation != RotationReading::Robust {
            let rotation = rotation.name();
            let message = format!(
                "`breaks_at` compares strains, which need exact rotations, but the rotation is \"{rotation}\"; take \"robust\" without `passes`"
            );
            return Err(super::Misfit { key: "breaks_at", message });
        }
        let (stiffness, material) = super::stiffness(self.stiffness, self.young, self.poisson, body)?;
        Ok(Arc::new(ShapeBased {
            stiffness,
            material,
            bending: self.bending.map_or(1.0, |bending| bending.0),
            damping: super::damping(self.damping, self.damping_ratio, stiffness, body)?,
            passes: self.passes.unwrap_or(2),
            rotation,
            damping_of: self.damping_of.unwrap_or_default(),
            breaks_at: super::breaks_at(self.breaks_at)?,
        }))
    }

    fn without_effect(&self, body: &Body) -> Option<super::Misfit> {
        let bends = |nodes: &[u32]| !affine::is_simplex(&at_rest(nodes, body).collect::<Vec<_>>());
        let is_given = self.bending.is_some_and(|bending| bending.0 != 1.0);
        (is_given && !body.elements.iter().any(bends)).then(|| {
            let [simplices, others] = match body.dimension {
                Dimension::Plane => ["segments and triangles", "quadrilaterals"],
                Dimension::Space => ["segments, triangles and tetrahedra", "hexahedra"],
            };
            let message = format!(
                "`bending` has no effect on this body: {simplices} do not bend, because a linear map fits any of their displacements; take it \
                 out, or take elements of more nodes, such as {others}"
            );
            super::Misfit { key: "bending", message }
        })
    }
}

impl ElasticModel for ShapeBased {
    /// In the plane the rotation is `planar`, by Eq. (9), whatever `rotation` says.
    fn properties(&self, body: &Body) -> Properties {
        let mut own = Properties::new("shape-based", self.stiffness).of_material(self.material, body.dimension);
        own = own.damped(self.damping).with("damping_of", Setting::Choice(self.damping_of.name()));
        own = match body.dimension {
            Dimension::Plane => own.fixed("rotation", Setting::Choice("planar")),
            Dimension::Space => own.with("rotation", Setting::Choice(self.rotation.name())),
        };
        if body.dimension == Dimension::Space && self.rotation.has_passes() {
            own = own.with("passes", Setting::Count(self.passes));
        }
        own = own.with("bending", Setting::Number(self.bending, ""));
        if let Some(strain) = self.breaks_at {
            own = own.with("breaks_at", Setting::Number(strain, ""));
        }
        let (breakable, counts_fallbacks) = (self.breakable(body), self.counts_fallbacks(body));
        Properties { breakable, counts_fallbacks, ..own }
    }

    fn material(&self, body: &Body) -> Option<Material> {
        let stiffness = || {
            let parts =
                fill::product(None, body.stiffness.as_deref()).unwrap_or_else(|| vec![1.0; body.elements.len()]);
            parts.into_iter().map(|part| self.stiffness * part).collect::<Vec<_>>()
        };
        self.material.or_else(|| Material::of_shapes(body, &stiffness()))
    }

    /// An element adds at most `k` and `D` to a node, because its forces are a projection of displacements. Those of the volume grow
    /// without a bound.
    fn bound(&self, body: &Body) -> Option<Mode> {
        if self.volume(body.dimension) > 0.0 {
            return None;
        }
        let mut parts = vec![0.0; body.len()];
        let of_elements = self.relative_stiffness(body);
        for (element, nodes) in body.elements.iter().enumerate() {
            let part = of_elements.as_ref().map_or(1.0, |parts| parts[element]);
            nodes.iter().for_each(|&node| parts[node as usize] += part);
        }
        let most = parts.iter().zip(&body.mass).map(|(parts, mass)| parts / mass).fold(0.0, f64::max);
        Some(Mode { stiffness: self.stiffness * most, damping: self.damping * most })
    }

    /// The readings for comparison have the reference code only.
    fn vectorised(&self) -> Option<&dyn Vectorised> {
        let is_vectorised = match self.rotation {
            RotationReading::Robust => true,
            RotationReading::Arctangent => !self.fits_maps(),
            RotationReading::VectorLength | RotationReading::LinearUpdate => false,
        };
        is_vectorised.then_some(self)
    }

    /// The rotations that are optimal for the initial positions, which need not be the identity. In space they are followed by the
    /// number of rotations that the global solver has computed since then. Those of elements that break are each followed by whether it is broken.
    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        let solver = self.solver(body.dimension);
        let width = self.breakable(body).unwrap_or(solver.width());
        let mut memory = vec![0.0; width * body.elements.len() + usize::from(self.counts_fallbacks(body))];
        let mut rest = Vec::new();
        for (nodes, memory) in body.elements.iter().zip(memory.chunks_exact_mut(width)) {
            let memory = &mut memory[..solver.width()];
            rest.clear();
            rest.extend(at_rest(nodes, body));
            let at_rest = moment_at_rest(&rest, nodes, mean(nodes, position), position);
            let optimum = || davenport1968::optimum(at_rest, DQuat::IDENTITY);
            match solver {
                Solver::Plane => planar::solve(at_rest, DVec2::X).write_to_slice(memory),
                Solver::Space => optimum().write_to_slice(memory),
                Solver::Linear => DMat3::from_quat(optimum()).write_cols_to_slice(memory),
            }
        }
        memory
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        let (model, body) = (self.clone(), Arc::clone(body));
        Late::boxed(move || Elements::new(model, &body))
    }
}

impl Vectorised for ShapeBased {
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
        if let Some(limit) = self.breaks_at {
            return in_lanes::compile_breaking(self, limit, body, conditions);
        }
        let (&Self { stiffness, bending, damping, .. }, &Conditions { scheme, step, set }) = (self, conditions);
        let (volume, damped, rotation) = (self.volume(body.dimension), self.damped(), self.rotation_in_lanes());
        let parameters = lattice::Parameters { stiffness, bending, volume, damping, damped, rotation, step };
        let is_uniform = self.relative_stiffness(body).is_none();
        let lattice = is_uniform.then(|| LatticeStepper::new(body, parameters, scheme, set)).flatten();
        self.by_law(body, conditions, lattice.map(|lattice| -> Box<dyn Stepper> { Box::new(lattice) }))
    }
}

impl ShapeBased {
    /// The code by the law of the elements, or with a faster stepper, if there is one.
    pub(crate) fn by_law(
        &self,
        body: &Arc<Body>,
        conditions: &Conditions,
        faster: Option<Box<dyn Stepper>>,
    ) -> Compiled {
        in_lanes::compile(self, self.rotation_in_lanes(), body, conditions, faster)
    }

    fn rotation_in_lanes(&self) -> Rotation {
        match self.rotation {
            RotationReading::Arctangent => Rotation::Arctangent { passes: self.passes },
            _ => Rotation::Optimum,
        }
    }
}

/// How the rotation of an element is computed and stored.
#[derive(Clone, Copy, Debug)]
enum Solver {
    /// Eq. (9); stored as `(cos θ, sin θ)`.
    Plane,
    /// Eq. (15) and the alternatives to it; stored as a unit quaternion.
    Space,
    /// Eq. (16); stored as a matrix, which drifts away from a rotation.
    Linear,
}

impl Solver {
    /// How many numbers are stored for each element.
    fn width(self) -> usize {
        match self {
            Self::Plane => 2,
            Self::Space => 4,
            Self::Linear => 9,
        }
    }

    /// Whether the rotations that the global solver has computed are counted.
    fn counts(self) -> bool {
        matches!(self, Self::Space)
    }

    /// The stored rotation as a matrix.
    fn matrix(self, memory: &[f64]) -> DMat3 {
        match self {
            Self::Plane => planar::matrix(DVec2::from_slice(memory)),
            Self::Space => DMat3::from_quat(DQuat::from_slice(memory)),
            Self::Linear => DMat3::from_cols_slice(memory),
        }
    }
}

impl ShapeBased {
    /// An undamped model with this elastic constant (N/m) and exact rotations.
    pub fn new(stiffness: f64) -> Self {
        let (rotation, damping_of) = (RotationReading::Robust, DampingReading::RelativeMotion);
        Self { stiffness, material: None, bending: 1.0, damping: 0.0, passes: 2, rotation, damping_of, breaks_at: None }
    }

    /// `λ/μ`: 0 without an energy of the volume.
    fn volume(&self, dimension: Dimension) -> f64 {
        self.material.map_or(0.0, |material| material.lame_over_shear(dimension))
    }

    /// The velocity that is damped, as a constant of code.
    fn damped(&self) -> u8 {
        match (self.damping > 0.0, self.damping_of) {
            (false, _) => damped::NONE,
            (true, DampingReading::RelativeMotion) => damped::RELATIVE,
            (true, DampingReading::Deformation) => damped::DEFORMING,
        }
    }

    /// Whether forces depend on the linear map that fits an element best.
    fn fits_maps(&self) -> bool {
        self.bending != 1.0 || self.material.is_some_and(|material| material.poisson != 0.0)
    }

    /// The relative stiffness of each element, as far as it is filled; `None` if all are 1.
    pub(in crate::model) fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        /// Equal stiffnesses differ by round-off only.
        const EQUAL: f64 = 1e-10;
        let own = self.material.map(|material| {
            let parts: Vec<_> = material.stiffness(body).into_iter().map(|own| own / self.stiffness).collect();
            let differ = parts.iter().any(|part| (part - 1.0).abs() > EQUAL).then_some(parts);
            fill::product(differ.as_deref(), body.modulus.as_deref())
        });
        let relative = own.as_ref().map_or(body.stiffness.as_deref(), |own| own.as_deref());
        fill::product(body.fill.as_deref(), relative)
    }

    /// See [`Properties::breakable`].
    fn breakable(&self, body: &Body) -> Option<usize> {
        self.breaks_at.map(|_| self.solver(body.dimension).width() + 1)
    }

    /// See [`Properties::counts_fallbacks`]: it counts the rotations that the [global solver](davenport1968) has computed.
    fn counts_fallbacks(&self, body: &Body) -> bool {
        self.solver(body.dimension).counts() && self.breaks_at.is_none()
    }

    fn solver(&self, dimension: Dimension) -> Solver {
        match (dimension, self.rotation) {
            (Dimension::Plane, _) => Solver::Plane,
            (Dimension::Space, RotationReading::LinearUpdate) if self.breaks_at.is_none() => Solver::Linear,
            (Dimension::Space, _) => Solver::Space,
        }
    }

    /// The rotation of an element from its last one, by the method chosen, and whether the global solver computed it.
    /// `at_rest` is `Σ R0 rᵀ` (m²).
    fn rotation(&self, solver: Solver, at_rest: DMat3, last: &[f64], next: &mut [f64]) -> (DMat3, bool) {
        let mut is_global = false;
        match solver {
            Solver::Plane => planar::solve(at_rest, DVec2::from_slice(last)).write_to_slice(next),
            Solver::Space => {
                let reading = if self.breaks_at.is_some() { RotationReading::Robust } else { self.rotation };
                let found = reading.follow(at_rest, DQuat::from_slice(last), self.passes);
                found.rotation.write_to_slice(next);
                is_global = found.is_global;
            }
            Solver::Linear => {
                linear_update::update(at_rest, DMat3::from_cols_slice(last), self.passes).write_cols_to_slice(next);
            }
        }
        (solver.matrix(next), is_global)
    }
}

/// The elements of a body, prepared for evaluation.
struct Elements {
    model: ShapeBased,
    solver: Solver,
    /// Numbers in the memory for each element.
    width: usize,
    body: Arc<Body>,
    /// `R0` of each corner (m), element after element.
    rest: Vec<DVec3>,
    /// `Σ m |R0|²` of each element (kg m²), Eq. (17).
    inertia: Vec<f64>,
    /// The relative stiffness of each element; `None` if all are 1.
    parts: Option<Vec<f64>>,
    /// How the linear map of each element follows from its corners, if forces depend on it.
    maps: Option<Vec<AtRest>>,
    /// Adds up the forces on the corners of all elements for each node.
    gather: blocks::EntriesOfNode,
}

/// The position and rotation of the equilibrium shape of an element.
struct Fit {
    /// The unweighted mean of its nodes (m).
    centre: DVec3,
    /// `Σ R0 rᵀ` (m²).
    at_rest: DMat3,
    /// The rotation.
    rotation: DMat3,
    /// Whether the global solver computed it.
    is_global: bool,
}

impl Elements {
    fn new(model: ShapeBased, body: &Arc<Body>) -> Self {
        let elements = &body.elements;
        let mut rest = Vec::with_capacity(elements.indices().len());
        elements.iter().for_each(|nodes| rest.extend(at_rest(nodes, body)));
        let inertia = (0..elements.len())
            .map(|element| inertia(&elements[element], &rest[elements.range(element)], &body.mass))
            .collect();
        let gather = blocks::EntriesOfNode::new(body.len(), (0..).zip(elements.indices().iter().copied()));
        let at_rest = |element: usize| AtRest::new(&rest[elements.range(element)], body.dimension);
        let maps = model.fits_maps().then(|| (0..elements.len()).map(at_rest).collect());
        let (solver, parts) = (model.solver(body.dimension), model.relative_stiffness(body));
        let width = model.breakable(body).unwrap_or(solver.width());
        Self { solver, width, model, body: Arc::clone(body), rest, inertia, parts, maps, gather }
    }

    /// The nodes of an element and its shape at rest (m).
    fn element(&self, element: usize) -> (&[u32], &[DVec3]) {
        (&self.body.elements[element], &self.rest[self.body.elements.range(element)])
    }

    /// The memory of an element.
    fn of<'a>(&self, element: usize, memory: &'a [f64]) -> &'a [f64] {
        &memory[element * self.width..][..self.width]
    }

    /// Computes the rotation of an element from the last one.
    fn fit(&self, element: usize, position: &[DVec3], last: &[f64], next: &mut [f64]) -> Fit {
        let (nodes, rest) = self.element(element);
        let centre = mean(nodes, position);
        let at_rest = moment_at_rest(rest, nodes, centre, position);
        let (rotation, is_global) = self.model.rotation(self.solver, at_rest, last, next);
        Fit { centre, at_rest, rotation, is_global }
    }

    /// `k` (N/m) and `D` (N s/m) of an element.
    fn constants(&self, element: usize) -> [f64; 2] {
        let part = self.parts.as_ref().map_or(1.0, |parts| parts[element]);
        [self.model.stiffness, self.model.damping].map(|full| full * part)
    }

    /// The linear map that fits an element best, from its `Σ R0 rᵀ` (m²); `None` if forces do not depend on it.
    fn stretch(&self, element: usize, at_rest: DMat3) -> Option<Stretch> {
        let volume = self.model.volume(self.body.dimension);
        Some(self.maps.as_ref()?[element].stretch(at_rest, volume))
    }

    /// α of Eq. (18) of an element with a rotation (rad/s²), from its `Σ R0 rᵀ` (m²).
    fn residual(&self, element: usize, at_rest: DMat3, rotation: DMat3) -> f64 {
        let [k, _] = self.constants(element);
        angular_acceleration(rotation * at_rest, k, self.inertia[element])
    }

    /// Whether an element is broken: it was before, or is strained too far.
    fn is_broken(&self, element: usize, position: &[DVec3], fit: &Fit, last: &[f64]) -> bool {
        let (Some(limit), (nodes, rest)) = (self.model.breaks_at, self.element(element)) else { return false };
        let off = |(&node, &rest): (&u32, &DVec3)| position[node as usize] - fit.centre - fit.rotation * rest;
        let off: f64 = nodes.iter().zip(rest).map(|corner| off(corner).length_squared()).sum();
        let squares: f64 = rest.iter().map(|rest| rest.length_squared()).sum();
        last.last() == Some(&1.0) || (off / squares).sqrt() > limit
    }

    /// Eq. (4) for one element: writes the force on each of its corners (N). Returns whether the global solver computed its
    /// rotation.
    #[doc(alias = "Eq. 4")]
    fn forces(&self, element: usize, at: Nodes<'_>, last: &[f64], next: &mut [f64], forces: &mut [DVec3]) -> bool {
        let ([k, d], (nodes, rest)) = (self.constants(element), self.element(element));
        let fit = self.fit(element, at.position, last, next);
        let is_broken = self.is_broken(element, at.position, &fit, last);
        let Fit { centre, at_rest, rotation, is_global } = fit;
        if let (Some(_), Some(told)) = (self.model.breaks_at, next.last_mut()) {
            *told = f64::from(u8::from(is_broken));
        }
        if is_broken {
            forces.fill(DVec3::ZERO);
            return is_global;
        }
        let stretch = self.stretch(element, at_rest);
        let drift = mean(nodes, at.velocity);
        let spin = match self.model.damping_of {
            DampingReading::RelativeMotion => None,
            DampingReading::Deformation => {
                let corners =
                    nodes.iter().map(|&node| (at.position[node as usize] - centre, at.velocity[node as usize] - drift));
                Some(best_spin(corners))
            }
        };
        for ((force, &node), &rest) in forces.iter_mut().zip(nodes).zip(rest) {
            let r = at.position[node as usize] - centre;
            let mut displacement = r - rotation * rest;
            if let Some(Stretch { map, pressure, .. }) = stretch {
                displacement += (r - map * rest) * (self.model.bending - 1.0) + pressure * rest;
            }
            let mut relative_velocity = at.velocity[node as usize] - drift;
            if let Some(spin) = spin {
                relative_velocity -= spin.cross(r);
            }
            *force = -(displacement * k + relative_velocity * d);
        }
        is_global
    }
}

impl ForceModel for Elements {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        let ((crew, corners), globals) = (scratch.parts(self.rest.len()), AtomicU64::new(0));
        blocks::for_each(crew, &self.body.elements, self.width, next, corners, &|element, next, corners| {
            if self.forces(element, at, self.of(element, memory), next, corners) {
                globals.fetch_add(1, Ordering::Relaxed);
            }
        });
        if self.model.counts_fallbacks(&self.body)
            && let (Some(before), Some(after)) = (memory.last(), next.last_mut())
        {
            *after = before + globals.into_inner() as f64;
        }
        self.gather.add(crew, corners, forces);
    }

    fn is_damped(&self) -> bool {
        self.model.damping > 0.0
    }

    /// A fixed number of passes leaves an error that depends on the rotation from which they start.
    fn depends_on_history(&self) -> bool {
        matches!(self.solver, Solver::Space | Solver::Linear) && self.model.rotation.has_passes()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        let mut shares = vec![0.0; self.rest.len()];
        let mut alphas = vec![0.0; self.body.elements.len()];
        blocks::for_each(
            &Crew::default(),
            &self.body.elements,
            1,
            &mut alphas,
            &mut shares,
            &|element, alpha, shares| {
                let ([k, _], (nodes, rest)) = (self.constants(element), self.element(element));
                let (last, mut next) = (self.of(element, memory), [0.0; 9]);
                let fit = self.fit(element, at.position, last, &mut next[..last.len()]);
                if self.is_broken(element, at.position, &fit, last) {
                    return;
                }
                let Fit { centre, at_rest, rotation, .. } = fit;
                let stretch = self.stretch(element, at_rest);
                for ((share, &node), &rest) in shares.iter_mut().zip(nodes).zip(rest) {
                    let r = at.position[node as usize] - centre;
                    let squared = match stretch {
                        None => (r - rotation * rest).length_squared(),
                        Some(Stretch { map, volume, .. }) => {
                            let bent = self.model.bending * (r - map * rest).length_squared();
                            bent + (map * rest - rotation * rest).length_squared() + volume / nodes.len() as f64
                        }
                    };
                    *share = 0.5 * k * squared;
                }
                alpha[0] = self.residual(element, at_rest, rotation);
            },
        );
        for (element, nodes) in self.body.elements.iter().enumerate() {
            share(element, nodes, &shares[self.body.elements.range(element)]);
        }
        // In the order of the corners, for any number of threads.
        let energy = shares.iter().sum();
        let residual = alphas.into_iter().fold(0.0, f64::max);
        Report { energy: Some(energy), residual: Some(residual) }
    }

    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        let residual = |element: usize| {
            let (nodes, rest) = self.element(element);
            let (last, at_rest) =
                (self.of(element, memory), moment_at_rest(rest, nodes, mean(nodes, position), position));
            if self.model.breaks_at.is_some() && last.last() == Some(&1.0) {
                return 0.0;
            }
            self.residual(element, at_rest, self.solver.matrix(last))
        };
        (0..self.body.elements.len()).map(residual).collect()
    }
}

/// `R0` of each corner of an element (m).
fn at_rest(nodes: &[u32], body: &Body) -> impl Iterator<Item = DVec3> {
    let centre = mean(nodes, &body.rest);
    nodes.iter().map(move |&node| body.rest[node as usize] - centre)
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

/// The angular velocity `ω` (rad/s) of the rigid rotation that fits velocities best: `Σ (r² I − r rᵀ) ω = Σ r × v`.
/// Corners are given by position (m) and velocity (m/s) relative to their means. Forces proportional to the remaining
/// velocities exert no torque.
fn best_spin(corners: impl Iterator<Item = (DVec3, DVec3)>) -> DVec3 {
    /// Corners are taken to lie on a line if the determinant of their matrix, relative to that of a ball, is below
    /// this.
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
        // Rotation about the line itself has no effect; across it the moment is the same about all axes.
        return momentum / squares;
    }
    matrix.inverse() * momentum
}

/// Eq. (17): the approximate moment of inertia `I = Σ m |R0|²` of an element (kg m²); for a cube it is 1.5 times the
/// true one.
#[doc(alias = "Eq. 17")]
fn inertia(nodes: &[u32], rest: &[DVec3], mass: &[f64]) -> f64 {
    nodes.iter().zip(rest).map(|(&node, rest)| mass[node as usize] * rest.length_squared()).sum()
}

/// Eq. (18): `|α| = k |Σ r × R| / I` (rad/s²), the angular acceleration that the error of an element's rotation causes.
/// `a` is `Σ R rᵀ`.
#[doc(alias = "Eq. 18")]
fn angular_acceleration(a: DMat3, stiffness: f64, inertia: f64) -> f64 {
    stiffness * rotation::torque(a).length() / inertia
}
