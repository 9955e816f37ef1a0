//! The elastic models. One file each; the list below is all that the rest of the crate knows of them.
//!
//! To add a model, write a file with `Parameters`, what a scene types, which implement `TypedModel`, a resolved
//! description that implements [`ElasticModel`], and a worker that implements [`ForceModel`]; then name it in the list.

mod blocks;
pub mod mass_spring;
pub mod shape_based;

use super::body::{Body, State};
use super::census::Census;
use super::words;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
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
    pub fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        self.typed().resolve(body, springs)
    }

    /// What the model will need on a body, at most; asked before the body is made.
    pub fn needs(&self, census: &Census) -> Needs {
        self.typed().needs(census)
    }
}

/// What a scene types for one model.
trait TypedModel {
    /// See [`ModelParameters::resolve`].
    fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit>;

    /// See [`ModelParameters::needs`].
    fn needs(&self, census: &Census) -> Needs;
}

/// What one run needs of memory besides the state of its nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Springs, at most.
    pub springs: u128,
    /// While the model is resolved (bytes).
    pub making: u128,
    /// As long as the run lasts (bytes).
    pub working: u128,
}

/// A parameter that does not fit, said about one key of the model's table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Misfit {
    /// The key, as typed in the scene.
    pub key: &'static str,
    /// What was found, what was expected and what to do.
    pub message: String,
}

/// An elastic model with all its parameters in SI units. It does not change; the work is done by what
/// [`Self::prepare`] makes.
pub trait ElasticModel: Debug + Send + Sync {
    /// Elastic constant `k` (N/m), which sets the cycle `T = 2π√(m/k)`.
    fn stiffness(&self) -> f64;

    /// A few words for a picture's second line, such as `27 cubes, k = 10 kN/m, ζ = 0.1`.
    fn describe(&self, body: &Body) -> String;

    /// The two nodes of each spring, for models that are made of springs.
    fn springs(&self) -> &[[u32; 2]] {
        &[]
    }

    /// Makes the worker that evaluates the forces on `body`, starting at `initial`.
    fn prepare(&self, body: &Arc<Body>, initial: &State) -> Box<dyn ForceModel>;
}

/// The internal forces of a body. It may keep a memory, such as the last rotation of each element.
pub trait ForceModel: Send {
    /// Adds elastic and damping forces (N) to `forces`, one per node. The same state gives the same forces however often
    /// it is asked about: what an evaluation finds becomes the model's memory only with [`Self::commit`].
    fn add_forces(&mut self, state: &State, forces: &mut [DVec3]);

    /// Makes what the last evaluation of the forces found the memory from which the next one starts.
    fn commit(&mut self) {}

    /// Whether the forces depend on velocities.
    fn is_damped(&self) -> bool;

    /// Energy and errors at a state, with the rotations that an evaluation of the forces there finds.
    fn measure(&self, state: &State) -> Measure;

    /// Adds to each node its part of the elastic energy (J); see [`Field::ElasticEnergy`](super::field::Field).
    fn share_energy(&self, state: &State, energies: &mut [f64]);
}

/// What a model says about a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Elastic energy (J), of which the elastic forces are the negative gradient; `None` for a model without one.
    pub energy: Option<f64>,
    /// The largest α of Eq. (18) over all elements (rad/s²); `None` for a model without rotations.
    pub residual: Option<f64>,
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
    let mut text = format!("{parts}, k = {}", with_prefix(stiffness, "N/m"));
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

/// A number of a unit with the prefix that leaves one to three digits before the point, such as `10 kN/m`.
fn with_prefix(value: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 5] = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m")];
    let (scale, prefix) = PREFIXES.into_iter().find(|(scale, _)| value >= *scale).unwrap_or((1e-3, "m"));
    format!("{} {prefix}{unit}", words::rounded(value / scale, 3))
}
