//! The elastic models, one file each. The rest of the crate refers to them only through the list below.
//!
//! To add a model, write a file with three types: `Parameters`, the parameters in a scene file, which implements
//! `TypedModel`; the model with its parameters resolved, which implements [`ElasticModel`]; and the law of its elements, which
//! implements [`Law`] and may be the same type. Its forces are then [`ByLaw`], its steps and energies vectorised. Or write its forces
//! alone, which implement [`ForceModel`]. Then add it to the list.

pub(crate) mod blocks;
pub mod continuum;
pub mod corotational;
pub mod limited_springs;
pub mod linear;
pub mod mass_spring;
pub mod metric;
pub mod neo_hookean;
pub mod shape_based;
pub mod volume_springs;
pub mod xpbd;

use super::body::Body;
use super::element::Dimension;
pub use super::kernel::Vectorised;
pub use super::lanes::Lanes;
use super::law::{Breaking, Strained};
pub use super::law::{ByLaw, Corners, Element, Law};
use super::material::Material;
#[doc(hidden)]
pub use super::mode::Mode;
use super::rotation::RotationReading;
use super::state::Nodes;
use super::volume::volumes_at_rest;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::str::FromStr;
use std::sync::{Arc, LazyLock};

/// Defines [`ModelParameters`] from a list of models.
macro_rules! models {
    ($($(#[$doc:meta])* $name:ident => $module:ident,)*) => {
        /// A model as written in a scene file: `model = { kind = "…", … }`.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum ModelParameters {
            $($(#[$doc])* $name($module::Parameters),)*
        }

        $(
            impl From<$module::Parameters> for ModelParameters {
                fn from(parameters: $module::Parameters) -> Self {
                    Self::$name(parameters)
                }
            }
        )*

        impl ModelParameters {
            fn typed(&self) -> &dyn TypedModel {
                match self {
                    $(Self::$name(parameters) => parameters,)*
                }
            }
        }
    };
}

// The list of elastic models.
models! {
    /// Elasticity of volume elements that keep their shape (paper, section 3).
    ShapeBased => shape_based,
    /// Springs between pairs of nodes (paper, section 2).
    MassSpring => mass_spring,
    /// Springs whose elongation is limited (paper, Ref. 4; the formula is our own reading).
    LimitedSprings => limited_springs,
    /// Springs and a pressure that keeps the volume of each element (paper, Ref. 3).
    VolumeSprings => volume_springs,
    /// Finite elements of a material under small displacements: Hooke's law (paper, Ref. 5). Of tetrahedra and hexahedra, in the plane of
    /// triangles and quadrilaterals.
    Linear => linear,
    /// Finite elements of a material with Hooke's law for the strain without rotation. Of the same elements.
    Corotational => corotational,
    /// Finite elements of a stable neo-Hookean material, for large deformations. Of the same elements.
    NeoHookean => neo_hookean,
    /// Elastically deformable models: the energy of a changed metric, on lattices (paper, Ref. 1).
    Metric => metric,
    /// Extended position-based dynamics, with the shape of each element as a constraint. It steps itself, stably with any step, and damps what a
    /// step does not resolve: a body with the angular velocity `ω` (rad/s) loses the part `ω² ΔT` of its angular momentum each second.
    Xpbd => xpbd,
}

impl ModelParameters {
    /// The model for a body. `springs` are the springs that the scene lists for the body, if it lists any.
    ///
    /// # Errors
    /// Parameters that contradict each other or do not fit the body.
    pub fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        self.typed().resolve(body, springs)
    }

    /// An upper bound for the number of springs that the model makes. `elements` has the number of elements for each
    /// number of nodes; `listed` is the number of springs that the body lists, if it lists any.
    pub fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.typed().most_springs(elements, listed)
    }
}

/// The parameters of one model in a scene file.
trait TypedModel {
    /// See [`ModelParameters::resolve`].
    fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit>;

    /// See [`ModelParameters::most_springs`].
    fn most_springs(&self, _elements: &BTreeMap<usize, u128>, _listed: Option<u128>) -> u128 {
        0
    }
}

/// A parameter of the model that does not fit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Misfit {
    /// The parameter's key in a scene file.
    pub key: &'static str,
    /// The mistake and its remedy.
    pub message: String,
}

/// An elastic model with all its parameters in SI units. It is immutable; [`Self::prepare`] makes the object that
/// evaluates the forces.
pub trait ElasticModel: Debug + Send + Sync {
    /// Elastic constant `k` (N/m). Figures divide forces by it to draw them as lengths.
    fn stiffness(&self) -> f64;

    /// The shortest period (s) of a node of the body: `T = 2π√(m/k)` with its [lightest](Body::lightest) node. A scene can give time steps as
    /// fractions of this period.
    fn shortest_period(&self, body: &Body) -> f64 {
        std::f64::consts::TAU * (body.lightest() / self.stiffness()).sqrt()
    }

    /// An upper bound of the stiffness and the damping of any mode in any state, divided by the masses; `None` if none is known.
    /// Where it suffices to show that a step is stable, no eigenvalue is computed.
    #[doc(hidden)]
    fn bound(&self, body: &Body) -> Option<Mode> {
        let _ = body;
        None
    }

    /// This model with its stiffness and its damping multiplied; `None` for a model that cannot be scaled.
    #[doc(hidden)]
    fn scaled(&self, stiffness: f64, damping: f64) -> Option<Arc<dyn ElasticModel>> {
        let _ = (stiffness, damping);
        None
    }

    /// The material that the model is on a body, in uniform strain; `None` if it is none.
    fn material(&self, body: &Body) -> Option<Material> {
        let _ = body;
        self.typed_material()
    }

    /// The material that was given in place of an elastic constant.
    fn typed_material(&self) -> Option<Material> {
        None
    }

    /// How many times as much as its stiffness says a body gives way in uniform strain, with a step (s): 1 but for models that are
    /// [projected](Self::projection).
    fn softening(&self, body: &Body, step: f64) -> f64 {
        let _ = (body, step);
        1.0
    }

    /// A parameter that was given and has no effect on a body, with the reason and the remedy; `None` if all have one.
    #[doc(hidden)]
    fn without_effect(&self, body: &Body) -> Option<Misfit> {
        let _ = body;
        None
    }

    /// Whether damping brakes the rotation of a rigid body.
    fn brakes_rotation(&self) -> bool {
        false
    }

    /// Damping constant `D` (N s/m); 0 without damping. Captions show it as a ratio to `2√(km)` of the lightest node.
    fn damping(&self) -> f64 {
        0.0
    }

    /// The unusual choices of the model, which captions append to its damping, such as `, exact rotations`.
    fn unusual_choices(&self, body: &Body) -> String {
        let _ = body;
        String::new()
    }

    /// All choices of the model that change the result, such as `, rotation robust (exact)`.
    fn choices(&self, body: &Body) -> String {
        self.unusual_choices(body)
    }

    /// The two nodes of each spring; empty for models without springs.
    fn springs(&self) -> &[[u32; 2]] {
        &[]
    }

    /// This model, if it has vectorised steps; `None` for a model that has the reference code only.
    fn vectorised(&self) -> Option<&dyn Vectorised> {
        None
    }

    /// The constraints on positions by which the model moves the nodes of a body itself, in place of forces; `None` for a model that exerts
    /// forces. A world then steps all its bodies by semi-implicit Euler, with the projections at the end, whatever its integrator. The forces
    /// that the model [prepares](Self::prepare) are those of the energy of the constraints.
    fn projection(&self, body: &Arc<Body>) -> Option<Box<dyn Projection>> {
        let _ = body;
        None
    }

    /// This model with its rotations computed by another method; `None` for a model without that choice on a body.
    #[doc(hidden)]
    fn with_rotation(&self, body: &Body, rotation: RotationReading) -> Option<Arc<dyn ElasticModel>> {
        let _ = (body, rotation);
        None
    }

    /// Whether the last number of the memory counts the rotations that the
    /// [global solver](crate::rotation::davenport1968) has computed.
    fn counts_global(&self, body: &Body) -> bool {
        let _ = body;
        false
    }

    /// How many numbers of the memory belong to each spring, or to each element of a model without springs, if these can break: the last of
    /// them is 1 once it is broken, and 0 before. They are at the start of the memory.
    fn breaks(&self, body: &Body) -> Option<usize> {
        let _ = body;
        None
    }

    /// The memory at the start, with the nodes of `body` at `position` (m). Its length never changes.
    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        let _ = (body, position);
        Vec::new()
    }

    /// The evaluation of the forces on `body`. Vectorised steps make it, too, and may never use it.
    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel>;
}

/// The internal forces of a body, as a pure function: the same nodes and the same memory give the same forces and the
/// same next memory. So trial evaluations and rejected steps have no side effects. Forces and energies of an element are in
/// proportion to its [filled part](Body::fill) and to its [stiffness](Body::stiffness).
///
/// [`ByLaw`] makes them from the [`Law`] of the elements, which is less work and faster.
pub trait ForceModel: Send + Sync {
    /// Adds elastic and damping forces (N) to `forces`, one per node, and writes every entry of the `next` memory.
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]);

    /// Whether the forces depend on velocities.
    fn is_damped(&self) -> bool;

    /// Whether forces depend, beyond round-off, on the memory, that is, on the evaluation before. Methods that evaluate
    /// forces several times a step are of their order only if they do not.
    ///
    /// Broken elements do not count: they depend on the memory, but only once. Each evaluation passes its memory on to the next, so that an
    /// element that is strained too far at an inner stage of Runge–Kutta stays broken, even if the step ends without that strain.
    fn depends_on_history(&self) -> bool {
        false
    }

    /// Energy and residuals, from the same computation as the forces with these nodes and this memory. Calls `share`
    /// for each element or spring, in order.
    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report;

    /// α of Eq. (18) of each element (rad/s²) at the evaluation of the forces with the nodes at `position` (m) that
    /// returned this memory; empty for a model without rotations.
    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        let _ = (position, memory);
        Vec::new()
    }
}

/// Constraints on the nodes of a body, as a pure function of positions and memory. They move nodes in place of forces.
pub trait Projection: Send + Sync {
    /// Moves nodes that have gone freely for a step (s), none by more than its constraints demand in that step, from `position` (m) to the end of
    /// the step. `inverse_mass` (1/kg) is zero for nodes that a kinematic constraint holds. Writes every entry of the `next` memory of the model.
    fn project(&self, position: &mut [DVec3], inverse_mass: &[f64], step: f64, memory: &[f64], next: &mut [f64]);
}

/// Forces that are prepared at their first use. Vectorised steps need none, and forces of large bodies take several times the
/// memory of a state.
struct Late<F>(LazyLock<F, Box<dyn FnOnce() -> F + Send>>);

impl<F: ForceModel + 'static> Late<F> {
    fn boxed(prepare: impl FnOnce() -> F + Send + 'static) -> Box<dyn ForceModel> {
        Box::new(Self(LazyLock::new(Box::new(prepare))))
    }
}

impl<F: ForceModel> ForceModel for Late<F> {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.0.add_forces(at, memory, next, scratch, forces);
    }

    fn is_damped(&self) -> bool {
        self.0.is_damped()
    }

    fn depends_on_history(&self) -> bool {
        self.0.depends_on_history()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        self.0.report(at, memory, share)
    }

    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        self.0.residuals(position, memory)
    }
}

/// Called with the number of an element or spring, its nodes, and the part of its energy (J) that belongs to each node.
pub type Share<'a> = dyn FnMut(usize, &[u32], &[f64]) + 'a;

/// A buffer for intermediate results, kept to avoid allocations. Its contents do not survive from one evaluation to the
/// next.
#[derive(Debug, Default)]
pub struct Scratch(Vec<DVec3>);

impl Scratch {
    /// A slice of this many vectors, with unspecified values.
    pub fn vectors(&mut self, count: usize) -> &mut [DVec3] {
        if self.0.len() < count {
            self.0.resize(count, DVec3::ZERO);
        }
        &mut self.0[..count]
    }
}

/// Energy and residuals of a model in a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Elastic energy (J); its negative gradient is the elastic forces. `None` for a model without energy.
    pub energy: Option<f64>,
    /// The residuals of conditions that the model satisfies only approximately, by name.
    pub residuals: Vec<(&'static str, f64)>,
}

impl Report {
    /// The name of the residual that is the largest α of Eq. (18) over all elements (rad/s²).
    pub const ROTATION: &'static str = "rotation";

    /// The residual with this name; `None` for a model without it.
    pub fn residual(&self, name: &str) -> Option<f64> {
        self.residuals.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// The damping constant (N s/m), from either parameter: the constant, or the ratio `ζ = D / 2√(km)`; 0 if neither is
/// given. `m` is the mass of the [lightest](Body::lightest) node, as in [`ElasticModel::shortest_period`]: the masses of other nodes do
/// not decide whether a damping ratio and a step in periods are stable together.
fn damping(constant: Option<f64>, ratio: Option<f64>, stiffness: f64, body: &Body) -> Result<f64, Misfit> {
    match (constant, ratio) {
        (Some(_), Some(_)) => {
            let message = "both `damping` and `damping_ratio` are given; keep one of them";
            Err(Misfit { key: "damping_ratio", message: message.into() })
        }
        (Some(constant), None) => Ok(constant),
        (None, Some(ratio)) => Ok(2.0 * ratio * (stiffness * body.lightest()).sqrt()),
        (None, None) => Ok(0.0),
    }
}

/// The strain at which elements or springs break, if they do.
fn breaks_at(given: Option<f64>) -> Result<Option<f64>, Misfit> {
    // The schema has the same bound; scenes made in code pass it by.
    match given {
        Some(strain) if !(strain > 0.0 && strain.is_finite()) => {
            let message =
                format!("`breaks_at` is {strain}; expected a strain above 0, such as 0.1 for a tenth of the length");
            Err(Misfit { key: "breaks_at", message })
        }
        _ => Ok(given),
    }
}

/// The elastic constant (N/m), that of the stiffest element, from either parameter: the constant, or a material.
fn stiffness(
    constant: Option<f64>,
    young: Option<f64>,
    poisson: Option<f64>,
    body: &Body,
) -> Result<(f64, Option<Material>), Misfit> {
    match (constant, young) {
        (Some(constant), None) if poisson.is_none() => Ok((constant, None)),
        (Some(_), None) => {
            let message = "`poisson` is a property of a material; give `young` in place of `stiffness`";
            Err(Misfit { key: "poisson", message: message.into() })
        }
        (None, Some(_)) => {
            let material = material(young, poisson, body)?;
            Ok((material.stiffness(body).into_iter().fold(0.0, f64::max), Some(material)))
        }
        (Some(_), Some(_)) => {
            Err(Misfit { key: "young", message: "both `stiffness` and `young` are given; keep one of them".into() })
        }
        (None, None) => {
            let message = "neither `stiffness` (N/m) nor `young` (Pa) is given; give one of them";
            Err(Misfit { key: "stiffness", message: message.into() })
        }
    }
}

/// The material of a body whose elements all have a volume.
fn material(young: Option<f64>, poisson: Option<f64>, body: &Body) -> Result<Material, Misfit> {
    let Some(young) = young else {
        return Err(Misfit { key: "young", message: "give `young` (Pa), the modulus of the material".into() });
    };
    let poisson = poisson.unwrap_or(0.0);
    // The schema has the same bounds; scenes made in code pass them by.
    if !(0.0..0.5).contains(&poisson) {
        let message = format!("`poisson` is {poisson}; expected a number from 0 to less than 0.5");
        return Err(Misfit { key: "poisson", message });
    }
    if let Some(element) = volumes_at_rest(body).iter().position(|&volume| volume <= 0.0) {
        let measure = if body.dimension == Dimension::Plane { "area" } else { "volume" };
        let message = format!(
            "element {element} has no {measure}, so that a material gives it no stiffness; give `stiffness` (N/m) in place of `young`"
        );
        return Err(Misfit { key: "young", message });
    }
    Ok(Material { young, poisson })
}

/// A number from 0 to 1, in a scene file also as a fraction such as `"1/3"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "TypedRatio")]
pub struct Ratio(pub f64);

/// A [`Ratio`] as written in a scene file.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
enum TypedRatio {
    /// From 0 to 1.
    Number(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// A fraction of whole numbers.
    Fraction(#[schemars(extend("format" = "fraction"))] String),
}

impl TryFrom<TypedRatio> for Ratio {
    type Error = String;

    fn try_from(typed: TypedRatio) -> Result<Self, String> {
        match typed {
            TypedRatio::Number(number) => Ok(Self(number)),
            TypedRatio::Fraction(text) => text.parse(),
        }
    }
}

impl FromStr for Ratio {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = |text: &str| text.trim().parse::<u32>().ok().map(f64::from);
        let value = text.split_once('/').and_then(|(above, below)| Some(whole(above)? / whole(below)?));
        let expected = || "expected a number from 0 to 1, or a fraction such as \"1/3\"".to_owned();
        value.filter(|value| (0.0..=1.0).contains(value)).map(Self).ok_or_else(expected)
    }
}

impl JsonSchema for Ratio {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Ratio".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        TypedRatio::json_schema(generator)
    }
}

impl std::fmt::Display for Ratio {
    /// As a fraction, if its denominator is small.
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let below = (2..10).map(f64::from).find(|below| (self.0 * below - (self.0 * below).round()).abs() < 1e-12);
        match below.filter(|_| self.0 > 0.0 && self.0 < 1.0) {
            Some(below) => write!(formatter, "{}/{below}", (self.0 * below).round()),
            None => write!(formatter, "{}", self.0),
        }
    }
}

/// The value of an enum as written in a scene.
fn typed(choice: &impl Serialize) -> String {
    serde_json::to_value(choice).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}
