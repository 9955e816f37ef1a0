//! Runs as typed.

use super::{LARGEST, Positive, StepFile, Up};
use crate::look::typed::TypedColour;
use crate::sim::model::{ElasticModel, Misfit, ModelParameters};
use crate::sim::{Body, Integrator, Kernel};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::Arc;

/// One run: bodies of the scene with their models.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["model"] }, { "required": ["models"] }, { "required": ["states"] }]))]
#[schemars(extend("allOf" = [
    { "not": { "required": ["states", "step"] } },
    { "not": { "required": ["states", "tolerance"] } },
    { "not": { "required": ["states", "integrator"] } },
    { "not": { "required": ["states", "kernel"] } },
]), extend("dependentRequired" = { "scale": ["states"], "up": ["states"] }))]
pub(in crate::scene) struct RunFile {
    /// Unique name, shown above the panel and used by `--only` and in result files.
    #[schemars(length(min = 1, max = 80))]
    pub(in crate::scene) name: String,
    /// The names of the bodies of this run, such as `["coarse"]`. So the same thing in another discretisation stands beside
    /// it. The order of names does not matter. Default: all bodies of the scene.
    #[schemars(length(min = 1))]
    pub(in crate::scene) bodies: Option<Vec<String>>,
    /// The elastic model of all bodies of the run, and its parameters. Each run has `model` or `models`.
    #[serde(skip_serializing_if = "is_unwritten")]
    #[schemars(with = "Option<ModelParameters>")]
    pub(in crate::scene) model: Option<ModelFile>,
    /// The elastic model of each body of the run by its name, in place of `model`: `{ cube = { kind = "shape-based",
    /// stiffness = 1e4 }, ball = { kind = "mass-spring", stiffness = 1e4 } }`.
    #[serde(serialize_with = "write_models")]
    #[schemars(with = "Option<BTreeMap<String, ModelParameters>>")]
    pub(in crate::scene) models: Option<BTreeMap<String, ModelFile>>,
    /// States that another program computed, in place of `model`: a NumPy archive beside the scene, such as
    /// `"mujoco.npz"`, or `{ file = "states.npz", run = "Local shape" }` for one of several runs in it. Also ParaView's lists of files,
    /// such as `"soft.pvd"`, and numbered files, such as `"frames/*.obj"`. Between recorded
    /// moments nodes move linearly in time. The run ends with the recording. `docs/recordings.md` tells what is in the files.
    pub(in crate::scene) states: Option<StatesFile>,
    /// Length of the unit of `states` (m), such as 0.001 for millimetres. Velocities are scaled, too.
    #[schemars(extend("default" = 1.0))]
    pub(in crate::scene) scale: Option<Positive>,
    /// The axis of `states` that points up. Scenes have y up, and MuJoCo, Isaac and Newton have z. Velocities are turned, too.
    #[schemars(extend("default" = "y"))]
    pub(in crate::scene) up: Option<Up>,
    /// Time step of this run, with the T of `[time]`. `"auto"` uses the prediction of this run alone. Default: that of
    /// `[time]`.
    pub(in crate::scene) step: Option<StepFile>,
    /// Tolerance of this run, in place of `step`. Default: that of `[time]`.
    #[schemars(range(min = 1e-11, max = 0.1))]
    pub(in crate::scene) tolerance: Option<f64>,
    /// Integrator of this run. Default: that of `[time]`.
    pub(in crate::scene) integrator: Option<Integrator>,
    /// The code that computes a step. The choice moves states by round-off, which chaotic motion enlarges. Default:
    /// `fast` where the model has it, else `reference`.
    pub(in crate::scene) kernel: Option<Kernel>,
    /// The colour of the run's curves, paths, forces and line beside its name: hexadecimal such as `"#0072b2"`, or a CSS name
    /// such as `"teal"`. Its contrast with the background must be at least 3, and its difference from turned-over
    /// elements at least 20 (CIEDE2000), also with colour blindness. Several runs may share a colour: names stand
    /// at the ends of curves. Default: the colour of its model; runs of one model differ in dashes. A recording, and a run with several models, have a colour that is left.
    pub(in crate::scene) colour: Option<TypedColour>,
}

/// The recorded states of a run.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum StatesFile {
    /// An archive beside the scene.
    File(#[schemars(length(min = 1))] String),
    /// One of several runs in an archive.
    OfRun(ChosenStates),
}

/// One of several runs in an archive.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct ChosenStates {
    /// The archive beside the scene.
    #[schemars(length(min = 1))]
    pub(in crate::scene) file: String,
    /// The run: NAME of the arrays `NAME.position` and so on. Default: the arrays without a name, the only run, or the one
    /// called like the run that shows it.
    pub(in crate::scene) run: Option<String>,
}

impl RunFile {
    /// Whether it has a model of the caller's own.
    pub(in crate::scene) fn has_own_model(&self) -> bool {
        self.model.iter().chain(self.models.iter().flat_map(BTreeMap::values)).any(ModelFile::is_own)
    }
}

/// Whether a file would have no model: none is given, or one of the caller's own.
fn is_unwritten(model: &Option<ModelFile>) -> bool {
    model.as_ref().is_none_or(ModelFile::is_own)
}

/// Writes models by name, without those of the caller's own.
fn write_models<S: Serializer>(models: &Option<BTreeMap<String, ModelFile>>, to: S) -> Result<S::Ok, S::Error> {
    match models {
        None => to.serialize_none(),
        Some(models) => to.collect_map(models.iter().filter(|(_, model)| !model.is_own())),
    }
}

/// The elastic model of a body.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged, from = "ModelParameters")]
pub(in crate::scene) enum ModelFile {
    /// A model of this crate.
    Typed(ModelParameters),
    /// A model of the caller's own, in a scene made in code.
    #[serde(skip)]
    Own(Arc<dyn ElasticModel>),
}

impl From<ModelParameters> for ModelFile {
    fn from(parameters: ModelParameters) -> Self {
        Self::Typed(parameters)
    }
}

impl ModelFile {
    /// Whether it is a model of the caller's own.
    pub(in crate::scene) fn is_own(&self) -> bool {
        matches!(self, Self::Own(_))
    }

    /// The Young's modulus that is given (Pa; N/m in the plane).
    pub(in crate::scene) fn young(&self) -> Option<f64> {
        match self {
            Self::Typed(parameters) => serde_json::to_value(parameters).ok()?.get("young")?.as_f64(),
            Self::Own(_) => None,
        }
    }

    /// The most springs of the model on a body, by the number of elements with each number of nodes and of listed
    /// springs.
    pub(in crate::scene) fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        match self {
            Self::Typed(parameters) => parameters.most_springs(elements, listed),
            Self::Own(model) => model.springs().len() as u128,
        }
    }

    /// The model for a body, with the springs that the scene lists.
    pub(in crate::scene) fn resolve(
        &self,
        body: &Body,
        springs: Option<&[[u32; 2]]>,
    ) -> Result<Arc<dyn ElasticModel>, Misfit> {
        match self {
            Self::Typed(parameters) => parameters.resolve(body, springs),
            Self::Own(model) => check_own(&**model, body).map(|()| Arc::clone(model)),
        }
    }

    /// A parameter that has no effect on a body.
    pub(in crate::scene) fn without_effect(&self, body: &Body) -> Option<Misfit> {
        match self {
            Self::Typed(parameters) => parameters.without_effect(body),
            Self::Own(_) => None,
        }
    }
}

/// Checks the properties of a model of the caller's own.
fn check_own(model: &dyn ElasticModel, body: &Body) -> Result<(), Misfit> {
    let misfit = |key, message: String| Err(Misfit { key, message });
    let (stiffness, nodes) = (model.properties(body).stiffness, body.len());
    if !(stiffness > 0.0 && stiffness <= LARGEST) {
        let message =
            format!("the stiffness of the model is {stiffness}; expected a number greater than 0, up to {LARGEST:e}");
        return misfit("stiffness", message);
    }
    match model.springs().iter().position(|spring| spring.iter().any(|&node| node as usize >= nodes)) {
        Some(at) => {
            let [a, b] = model.springs()[at];
            let message =
                format!("spring {at} of the model joins the nodes {a} and {b}; the body has nodes 0 to {}", nodes - 1);
            misfit("springs", message)
        }
        None => Ok(()),
    }
}
