//! What charts plot.

use crate::reading::coordinates::Coordinates;
use crate::reading::words::short;
use crate::sim::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a chart plots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Plot {
    /// A diagnostic over time.
    Diagnostic(Diagnostic),
    /// What is measured of one thing, over time or against a displacement.
    Of(PlotOf),
    /// A diagnostic of each body over time, in place of that of all bodies of a run.
    ByBody(PlotByBody),
}

/// A diagnostic of each body of every run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotByBody {
    /// The diagnostic.
    pub plot: Diagnostic,
    /// What has a curve of its own.
    pub by: By,
}

/// A part of a run with a curve of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// Each body.
    Body,
}

/// What is measured of one thing of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotOf {
    /// The quantity.
    pub plot: Measure,
    /// Of what: the name of an obstacle, of a body or of a probe, or a place in the scene such as `"hold[0]"`, `"grab[0]"` and `"obstacle[0]"`.
    pub of: String,
    /// The body, one of several, on which a force or a torque acts. Default: all bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on: Option<String>,
    /// Whose displacement is the axis to the right: a probe, a hold, a grab or an obstacle. Its mean over nodes counts, along the direction.
    /// Default: the axis is that of time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<String>,
    /// The direction, of any length but zero, along which forces and displacements count, with a sign. Default: their magnitude over time;
    /// with `against` the direction from the start of its path to the farthest point of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<Coordinates>,
}

/// A quantity of one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Measure {
    /// The mean force on bodies (N), in the last interval between rows, or else frames.
    Force,
    /// Its torque about the origin (N m).
    Torque,
    /// The displacement of nodes from where they are placed (m): their mean, in a band from the least to the greatest one. Of an obstacle that of its pivot
    /// since the start.
    Displacement,
}

impl Measure {
    /// Its name and its unit.
    pub(crate) fn words(self) -> [&'static str; 2] {
        match self {
            Self::Force => ["force", "N"],
            Self::Torque => ["torque", "N m"],
            Self::Displacement => ["displacement", "m"],
        }
    }
}

impl From<Diagnostic> for Plot {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Diagnostic(diagnostic)
    }
}

impl From<PlotByBody> for Plot {
    fn from(all: PlotByBody) -> Self {
        Self::ByBody(all)
    }
}

impl From<PlotOf> for Plot {
    fn from(of: PlotOf) -> Self {
        Self::Of(of)
    }
}

impl Plot {
    /// All diagnostics.
    pub(crate) fn diagnostics() -> Vec<Self> {
        Diagnostic::ALL.iter().copied().map(Self::from).collect()
    }

    /// The diagnostic that it is, of all bodies or of each.
    pub(crate) fn diagnostic(&self) -> Option<Diagnostic> {
        match *self {
            Self::Diagnostic(one) | Self::ByBody(PlotByBody { plot: one, .. }) => Some(one),
            Self::Of(_) => None,
        }
    }

    /// What is measured of one thing.
    pub(crate) fn of(&self) -> Option<&PlotOf> {
        if let Self::Of(one) = self { Some(one) } else { None }
    }

    /// Whether its axis to the right is that of time.
    #[cfg(feature = "render")]
    pub(crate) fn is_over_time(&self) -> bool {
        self.of().is_none_or(|of| of.against.is_none())
    }

    /// Whether it needs forces of contact or of constraints.
    pub(crate) fn is_of_forces(&self) -> bool {
        self.diagnostic().is_some_and(Diagnostic::is_of_forces)
            || self.of().is_some_and(|of| of.plot != Measure::Displacement)
    }
}

impl PlotOf {
    /// A quantity of a thing with a name, over time, as a magnitude.
    pub fn new(plot: Measure, of: impl Into<String>) -> Self {
        Self { plot, of: of.into(), on: None, against: None, along: None }
    }

    /// What it shows, in words: `force of floor on ball`.
    pub(crate) fn name(&self) -> String {
        let on = self.on.as_ref().map_or_else(String::new, |body| format!(" on {body}"));
        format!("{} of {}{on}", self.plot.words()[0], self.of)
    }

    /// The name of its values in `run.json`.
    pub(crate) fn key(&self) -> String {
        let mean = if self.plot == Measure::Displacement { "_mean" } else { "" };
        let along =
            self.along.as_ref().map(|along| along.0.iter().map(|&one| short(one)).collect::<Vec<_>>().join(", "));
        let along = along.map_or_else(String::new, |along| format!(" along [{along}]"));
        format!("{}{mean}{along}", self.name())
    }

    /// The same on one of several bodies.
    #[must_use]
    pub fn on(self, body: impl Into<String>) -> Self {
        Self { on: Some(body.into()), ..self }
    }

    /// The same against the displacement of a thing.
    #[must_use]
    pub fn against(self, thing: impl Into<String>) -> Self {
        Self { against: Some(thing.into()), ..self }
    }

    /// The same along a direction.
    #[must_use]
    pub fn along(self, direction: impl Into<Coordinates>) -> Self {
        Self { along: Some(direction.into()), ..self }
    }
}
