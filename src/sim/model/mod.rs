//! The elastic models. One file each; the list below is all that the rest of the crate knows of them.
//!
//! To add a model, write a file with `Parameters`, what a scene types, which implement `TypedModel`, a resolved
//! description that implements [`ElasticModel`], and its forces, which implement [`ForceModel`]; then name it in the list.

mod blocks;
pub mod mass_spring;
pub mod shape_based;

use super::body::Body;
use super::state::{Nodes, State};
use super::words;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::Arc;

/// Makes [`ModelParameters`] from a list of models.
macro_rules! models {
    ($($(#[$doc:meta])* $name:ident => $module:ident,)*) => {
        /// What a scene types for a model: `model = { kind = "…", … }`.
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
}

impl ModelParameters {
    /// The model for a body. `springs` are those that the body lists by hand, if it does.
    ///
    /// # Errors
    /// Parameters that contradict each other or do not fit the body.
    pub(crate) fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        self.typed().resolve(body, springs)
    }

    /// How many springs the model makes, at most, of so many elements of each number of nodes; `listed` is how many the
    /// body lists, if it does.
    pub(crate) fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.typed().most_springs(elements, listed)
    }
}

/// What a scene types for one model.
trait TypedModel {
    /// See [`ModelParameters::resolve`].
    fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit>;

    /// See [`ModelParameters::most_springs`].
    fn most_springs(&self, _elements: &BTreeMap<usize, u128>, _listed: Option<u128>) -> u128 {
        0
    }
}

/// A parameter that does not fit, said about one key of the model's table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Misfit {
    /// The key, as typed in the scene.
    pub key: &'static str,
    /// What was found, what was expected and what to do.
    pub message: String,
}

/// An elastic model with all its parameters in SI units. It does not change; the work is done by what
/// [`Self::prepare`] makes.
pub trait ElasticModel: Debug + Send + Sync {
    /// Elastic constant `k` (N/m), by which diagrams divide forces.
    fn stiffness(&self) -> f64;

    /// The shortest period (s) with which a node of the body swings: `T = 2π√(m/k)` of its lightest node. Steps may be
    /// given as a fraction of it.
    fn shortest_period(&self, body: &Body) -> f64 {
        std::f64::consts::TAU * (body.lightest() / self.stiffness()).sqrt()
    }

    /// A few words for a picture's second line, such as `27 cubes, k = 10 kN/m, ζ = 0.1`.
    fn describe(&self, body: &Body) -> String;

    /// The two nodes of each spring, for models that are made of springs.
    fn springs(&self) -> &[[u32; 2]] {
        &[]
    }

    /// Which model it is, for vectorised steps; `None` for one that has the plain code alone.
    #[doc(hidden)]
    fn known(&self) -> Option<Known<'_>> {
        None
    }

    /// Works out beforehand what evaluating the forces on `body` needs.
    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel>;
}

impl dyn ElasticModel + '_ {
    /// The internal forces (N) on each node of a body at a state with which the model starts.
    pub fn forces_at_start(&self, body: &Arc<Body>, state: &State) -> Vec<DVec3> {
        let model = self.prepare(body);
        let memory = model.start(&state.position);
        let mut forces = vec![DVec3::ZERO; body.len()];
        model.add_forces(state.nodes(), &memory, &mut memory.clone(), &mut Scratch::default(), &mut forces);
        forces
    }
}

/// Models that vectorised steps know.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub enum Known<'a> {
    /// Section 3 of the paper.
    ShapeBased(&'a shape_based::ShapeBased),
    /// Section 2 of the paper.
    MassSpring(&'a mass_spring::MassSpring),
}

/// The internal forces of a body, as a pure function: the same nodes and the same memory give the same forces and the same
/// next memory. So trial evaluations and steps that are given up leave nothing behind.
///
/// # Example
/// A whole model: between any two nodes of an element a rod with the energy `k/(8 L²) (|p|² − L²)²`.
/// ```
#[doc = include_str!("../../../tests/physics/example_model.rs")]
/// # use localshape::scene::{BodyBuilder, Limits, RunBuilder, Scene};
/// let rest = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let body = BodyBuilder::arrays(rest, [[0, 1, 2, 3]]).positions(rest.map(|node| node * 1.1));
/// let rods = RunBuilder::own(Arc::new(Rods { stiffness: 100.0 }));
/// let scene = Scene::builder("tetrahedron", body).step(1e-3).run("Rods", rods);
/// let mut world = scene.build(&Limits::default())?.world(0);
/// let energy = world.diagnostics().elastic;
/// world.advance(1000);
/// assert!(world.diagnostics().energy < energy * 1.01);
/// # Ok::<(), localshape::scene::SceneError>(())
/// ```
pub trait ForceModel: Send + Sync {
    /// The memory at the start, with the nodes at `position` (m); its length stays as it is.
    fn start(&self, position: &[DVec3]) -> Vec<f64> {
        let _ = position;
        Vec::new()
    }

    /// Adds elastic and damping forces (N) to `forces`, one per node, and writes the whole `next` memory.
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]);

    /// Whether the forces depend on velocities.
    fn is_damped(&self) -> bool;

    /// Energy and errors, as an evaluation of the forces with the same nodes and memory finds them. `share` is told of each
    /// element or spring in order.
    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report;

    /// α of Eq. (18) of each element (rad/s²) in an evaluation of the forces with the nodes at `position` (m) that has led
    /// to this memory; none for a model without rotations.
    fn residuals(&self, position: &[DVec3], memory: &[f64]) -> Vec<f64> {
        let _ = (position, memory);
        Vec::new()
    }
}

/// Is told the number of an element or spring, its nodes, and the part of its energy (J) that is each node's.
pub type Share<'a> = dyn FnMut(usize, &[u32], &[f64]) + 'a;

/// Room for intermediate results, kept from one evaluation to the next. What it holds in between means nothing.
#[derive(Debug, Default)]
pub struct Scratch(Vec<DVec3>);

impl Scratch {
    /// Room for so many vectors, with anything in them.
    pub fn vectors(&mut self, count: usize) -> &mut [DVec3] {
        if self.0.len() < count {
            self.0.resize(count, DVec3::ZERO);
        }
        &mut self.0[..count]
    }
}

/// What a model says about a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Elastic energy (J), of which the elastic forces are the negative gradient; `None` for a model without one.
    pub energy: Option<f64>,
    /// What is left of conditions that the model meets only approximately, by name.
    pub residuals: Vec<(&'static str, f64)>,
}

impl Report {
    /// The name of the largest α of Eq. (18) over all elements (rad/s²).
    pub const ROTATION: &'static str = "rotation";

    /// A residual by its name; `None` for a model without it.
    pub fn residual(&self, name: &str) -> Option<f64> {
        self.residuals.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// The damping constant (N s/m) from what was typed: itself, or a ratio `ζ = D / 2√(km)`, or nothing for 0. `m` is the
/// mass of the lightest node, as in the cycle of which a step is a fraction: so a ratio and a fraction that are stable
/// together stay so whatever the other masses are.
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

/// The second line of a picture: what the model is made of, its stiffness and, if it has any, its damping.
fn describe(parts: &str, stiffness: f64, damping: f64, body: &Body) -> String {
    let (factor, prefix) = words::prefix(stiffness);
    let mut text = format!("{parts}, k = {} {prefix}N/m", words::rounded(stiffness / factor, 3));
    if damping > 0.0 {
        let ratio = damping / (2.0 * (stiffness * body.lightest()).sqrt());
        text.push_str(&format!(", ζ = {}", words::rounded(ratio, 3)));
    }
    text
}

/// The elements of a body in a few words, such as `27 cubes`.
fn elements_in_words(body: &Body) -> String {
    match words::elements(body).as_slice() {
        [(count, name)] => format!("{count} {name}"),
        _ => format!("{} elements", body.elements.len()),
    }
}
