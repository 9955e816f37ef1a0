//! What one run looks like at one moment: all that drawing, diagnostics and files ever see of a simulation.

pub(crate) use super::diagnostics::Diagnostic;
pub use super::diagnostics::Diagnostics;
use glam::{DMat3, DVec3};

/// Where and when a run blew up. That is a result, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// Time of the first step whose result could not be kept (s).
    pub time: f64,
    /// Number of that step, counted from 1.
    pub step: u64,
    /// The part of a node which left all bounds, counted from 0.
    pub part: usize,
    /// The first element of that part that holds the node; `None` if it belongs to no element.
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
