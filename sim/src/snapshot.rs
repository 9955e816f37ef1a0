//! A [`Snapshot`] of a run: the view of a simulation for drawing, diagnostics and files.

use super::diagnostics::Diagnostics;
use super::integrate::Unsolved;
use super::placement::Placement;
use super::state::Status;
use glam::DVec3;

/// The state of all bodies of one run at one moment, with its diagnostics.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Number of steps taken (0: the start).
    pub step: u64,
    /// Time of that step (s). The clock of a diverged run keeps counting: its last state is shown at later times.
    pub time: f64,
    /// Position of each node (m), body after body.
    pub position: Vec<DVec3>,
    /// Velocity of each node (m/s).
    pub velocity: Vec<DVec3>,
    /// Whether each element has turned over: its signed volume is below −0.1 % of that at rest; see
    /// [`Diagnostics::turned_over`].
    pub turned_over: Vec<bool>,
    /// Whether each element is flat: its volume is below a hundredth of that at rest, and it has not turned over.
    pub flat: Vec<bool>,
    /// Whether each element is broken; empty if no model of the run breaks.
    pub broken: Vec<bool>,
    /// Whether each spring is broken, body after body; empty if no springs of the run break.
    pub broken_springs: Vec<bool>,
    /// The best rigid placement of the rest shape of each body.
    pub placements: Vec<Placement>,
    /// The values of the requested field, one for each node or each element; empty if no field was requested.
    pub field: Vec<f64>,
    /// The requested energies, momenta and measures of shape of all bodies together. The others are zero.
    pub diagnostics: Diagnostics,
    /// The same of each body.
    pub of_bodies: Vec<Diagnostics>,
    /// Whether the run has diverged.
    pub status: Status,
    /// The steps until then that an implicit method has not solved; `None` if there are none.
    pub unsolved: Option<Unsolved>,
}

/// One frame of a scene: the requested runs at the same moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Number of the frame (0: the start).
    pub index: u64,
    /// Time of the step that the frame shows (s), by the clock of the first run. Frames do not change the steps, so
    /// this is the time of the step nearest to the frame's nominal time.
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
    /// The last state of a diverging run that fits a picture, from then on; `None` before, and without pictures.
    pub last_fit: Option<Box<LastFit>>,
}

impl RunFrame {
    /// A run whose present state is shown.
    pub fn new(run: usize, snapshot: Snapshot) -> Self {
        Self { run, snapshot, last_fit: None }
    }

    /// Makes the distance of each node from the same node of another run (m) the field, [`Field::Distance`]. The other run
    /// has no values itself. No run has values once the other run has diverged or its present state is not shown.
    ///
    /// [`Field::Distance`]: crate::Field::Distance
    pub fn measure(&mut self, other: &Self) {
        let is_known = other.run != self.run && other.shown().status == Status::Ok;
        let nodes = self.snapshot.position.iter().zip(&other.snapshot.position);
        self.snapshot.field = nodes.filter(|_| is_known).map(|(one, other)| one.distance(*other)).collect();
    }

    /// The state that pictures show.
    pub fn shown(&self) -> &Snapshot {
        self.last_fit.as_ref().map_or(&self.snapshot, |last_fit| &last_fit.snapshot)
    }
}

/// The last state of a diverging run with a body not much wider than at rest or at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct LastFit {
    /// That state, with its own time and the status at the end.
    pub snapshot: Snapshot,
    /// How many times wider the body is when the run stops.
    pub times_wider: f64,
}
