//! What one run looks like at one moment: all that drawing, diagnostics and files ever see of a simulation.

use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where and when a run blew up. That is a result, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Time of the first step whose result could not be kept (s).
    pub time: f64,
    /// Number of that step, counted from 1.
    pub step: u64,
    /// The first element that holds a node which left all bounds; `None` if that node belongs to no element.
    pub element: Option<usize>,
}

/// Whether a run goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Status {
    /// All is well.
    #[default]
    Ok,
    /// It blew up; the snapshot shows its last finite state.
    Diverged(Divergence),
}

/// One run at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// The step after which this is (0: the start).
    pub step: u64,
    /// Time of that step (s). A diverged run keeps the clock of the scene: its last state is shown at later times.
    pub time: f64,
    /// Position of each node (m).
    pub position: Vec<DVec3>,
    /// Velocity of each node (m/s).
    pub velocity: Vec<DVec3>,
    /// Whether each element has changed sign by more than round-off, to below −1e-9 of the value at rest; see
    /// [`Diagnostics::turned_over`].
    pub turned_over: Vec<bool>,
    /// Where the best rigid placement of the rest shape is.
    pub placement: Placement,
    /// The field that was asked for, a number for each node or each element; empty if none was.
    pub field: Vec<f64>,
    /// Energies, momenta and measures of shape.
    pub diagnostics: Diagnostics,
    /// Whether the run goes on.
    pub status: Status,
}

/// The rigid placement of a body's rest shape that is nearest to its nodes (least squares).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Mean of the nodes at rest (m).
    pub rest_centre: DVec3,
    /// Mean of the nodes (m).
    pub centre: DVec3,
    /// The rotation.
    pub turn: DMat3,
}

impl Placement {
    /// Where a point of the rest shape (m) is placed.
    pub fn place(&self, rest: DVec3) -> DVec3 {
        self.centre + self.turn * (rest - self.rest_centre)
    }
}

/// Numbers that describe a state. SI units; in the plane volumes are areas.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Kinetic energy (J).
    pub kinetic: f64,
    /// Elastic energy (J); NaN for a model without one.
    pub elastic: f64,
    /// Potential energy in the field of gravity (J), zero at the origin.
    pub gravitational: f64,
    /// Momentum (kg m/s).
    pub momentum: DVec3,
    /// Angular momentum about the origin (kg m²/s).
    pub angular_momentum: DVec3,
    /// The largest angular acceleration that approximation errors of the rotations amount to, α of Eq. (18)
    /// (rad/s²); NaN for a model without rotations.
    pub residual: f64,
    /// How many elements have changed sign by more than round-off, to below −1e-9 of the value at rest: signed area in
    /// the plane, signed volume in space, for elements of other kinds the determinant of `Σ r R0ᵀ`.
    pub turned_over: usize,
    /// Total signed volume over the rest value; NaN for a body without any volume, such as a cloth.
    pub volume_ratio: f64,
    /// RMS distance of the nodes from the best rigid placement of the rest shape (m).
    pub shape_error: f64,
}

impl Diagnostics {
    /// The sum of all energies (J); NaN for a model without an elastic one.
    pub fn energy(&self) -> f64 {
        self.kinetic + self.elastic + self.gravitational
    }
}

/// A number that describes a state, to be shown over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Diagnostic {
    /// How many elements have turned over.
    TurnedOver,
    /// Total signed volume over the rest value; in the plane, area.
    VolumeRatio,
    /// RMS distance of the nodes from the best rigid placement of the rest shape (m).
    ShapeError,
    /// Kinetic energy (J).
    Kinetic,
    /// Elastic energy (J).
    Elastic,
    /// Potential energy in the field of gravity (J), zero at the origin.
    Gravitational,
    /// The sum of all energies (J).
    Energy,
    /// Length of the momentum (kg m/s).
    Momentum,
    /// Length of the angular momentum about the origin (kg m²/s).
    AngularMomentum,
    /// The largest angular acceleration that approximation errors of the rotations amount to (rad/s²).
    Residual,
}

impl Diagnostic {
    /// Its value; NaN where a model or a body has none.
    pub fn of(self, all: &Diagnostics) -> f64 {
        match self {
            Self::TurnedOver => all.turned_over as f64,
            Self::VolumeRatio => all.volume_ratio,
            Self::ShapeError => all.shape_error,
            Self::Kinetic => all.kinetic,
            Self::Elastic => all.elastic,
            Self::Gravitational => all.gravitational,
            Self::Energy => all.energy(),
            Self::Momentum => all.momentum.length(),
            Self::AngularMomentum => all.angular_momentum.length(),
            Self::Residual => all.residual,
        }
    }

    /// What a reader calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::TurnedOver => "turned over",
            Self::VolumeRatio => "volume ratio",
            Self::ShapeError => "shape error",
            Self::Kinetic => "kinetic energy",
            Self::Elastic => "elastic energy",
            Self::Gravitational => "energy in gravity",
            Self::Energy => "total energy",
            Self::Momentum => "momentum",
            Self::AngularMomentum => "angular momentum",
            Self::Residual => "residual α",
        }
    }

    /// Its unit; empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::TurnedOver | Self::VolumeRatio => "",
            Self::ShapeError => "m",
            Self::Kinetic | Self::Elastic | Self::Gravitational | Self::Energy => "J",
            Self::Momentum => "kg m/s",
            Self::AngularMomentum => "kg m²/s",
            Self::Residual => "rad/s²",
        }
    }
}

/// One frame of a scene: every run asked for, at the same moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Number of the frame (0: the start).
    pub index: u64,
    /// Time of the step that the frame shows (s), by the first run's clock: drawing never changes the steps, so it is
    /// the nearest one to the frame's nominal time.
    pub time: f64,
    /// The runs shown, in the scene's order.
    pub runs: Vec<RunFrame>,
}

/// One run in a [`Frame`].
#[derive(Clone, Debug, PartialEq)]
pub struct RunFrame {
    /// Index of the run in the scene.
    pub run: usize,
    /// Its state.
    pub snapshot: Snapshot,
}
