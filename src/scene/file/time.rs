//! Times and time steps as typed.

use super::Positive;
use crate::scene::step::NamedStep;
use crate::sim::Integrator;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Duration, time step and frame rate of a scene.
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct TimeFile {
    /// Simulated time (s); 0 shows only the start. With `until` it is the longest.
    #[schemars(range(min = 0.0))]
    pub(in crate::scene) duration: f64,
    /// Where runs start. Default: where their bodies are placed.
    pub(in crate::scene) start: Option<StartFile>,
    /// The end, if it comes before the end of `duration`. The scene is simulated when it is read, to know when that is.
    pub(in crate::scene) until: Option<EndFile>,
    /// Time step ΔT: seconds, a fraction of the cycle T such as `"T/50"` or `"0.02 T"`, or `"auto"`. T = 2π√(m/k), with
    /// the mass of the lightest node and the largest stiffness of all bodies and runs; of `volume-springs` that of a spring or that of
    /// an element against changes of its volume. `"auto"` takes equal steps between two
    /// frames, at most half of the largest step that is predicted to be stable for every run without a step of its own.
    /// `localshape check` prints that prediction. `xpbd`, stable with any step, takes at most 1/1200 s.
    #[schemars(extend("default" = "T/50"))]
    pub(in crate::scene) step: Option<StepFile>,
    /// The error allowed in each step of `integrator = "dormand-prince"`, as a share of the size of the body, in place
    /// of `step`. Below 1e-11 round-off is larger. For a body at rest on an obstacle, a tenth of the tolerance takes three times as long. Default: 1e-6.
    #[schemars(range(min = 1e-11, max = 0.1))]
    pub(in crate::scene) tolerance: Option<f64>,
    /// Frames per second of simulated time (1/s). Frames lie within the duration: 1 s has frames 0 to 29 at 29.97 a second.
    #[serde(default = "sixty")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub(in crate::scene) frames_per_second: f64,
    /// Time between rows of `diagnostics.csv` (s), which then has rows between frames, of the nearest steps. With the time
    /// step or less each step has a row, which takes several times as long as a step. Default: only frames have rows.
    pub(in crate::scene) every: Option<Positive>,
    /// The integrator, which advances positions and velocities by one step.
    #[serde(default)]
    pub(in crate::scene) integrator: Integrator,
}

fn sixty() -> f64 {
    60.0
}

/// A start other than that of the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::scene) enum StartFile {
    /// At rest: each run starts where the forces of its model balance gravity, the loads at the start, and what holds or meets its bodies.
    /// Obstacles do not move before the start. Velocities are those of the bodies. `localshape check` tells what is left of the forces.
    Equilibrium,
}

/// An end other than that of the duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::scene) enum EndFile {
    /// At rest: the first frame at which nothing outside moves any more and all runs are at rest. Since the frame before, the kinetic energy is at most 1e-6 of
    /// the greatest so far, and the forces that are left 1e-3 of gravity and loads. `localshape check` tells when that is.
    Rest,
}

/// A time step as typed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(in crate::scene) enum StepFile {
    /// A time step in seconds, or a fraction of the cycle T such as `"T/50"`.
    Seconds(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// A fraction of the cycle T, or `auto`.
    Named(#[schemars(extend("format" = "fraction-of-T"))] NamedStep),
}

impl StepFile {
    /// The step of a scene that gives none.
    pub(in crate::scene) const DEFAULT: Self = Self::Named(NamedStep::Divided(50.0));
}
