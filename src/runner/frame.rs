//! Frames: the runs of a scene at one moment.

#[cfg(feature = "render")]
use crate::sim::Divergence;
use crate::sim::{Snapshot, Status};

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
    /// The last state of a diverging run whose bodies are not much wider than at rest or at the start, with its own time and
    /// the status at the end; from then on. `None` before, and without pictures.
    pub last_fit: Option<Box<Snapshot>>,
}

impl RunFrame {
    /// A run whose present state is shown.
    pub fn new(run: usize, snapshot: Snapshot) -> Self {
        Self { run, snapshot, last_fit: None }
    }

    /// Makes the distance of each node from the same node of another run (m) the field,
    /// [`Field::Distance`](crate::sim::Field::Distance). The other run has no values itself. No run has values once the other run has
    /// diverged or its present state is not shown.
    pub fn measure(&mut self, other: &Self) {
        let is_known = other.run != self.run && other.shown().status == Status::Ok;
        let nodes = self.snapshot.position.iter().zip(&other.snapshot.position);
        self.snapshot.field = nodes.filter(|_| is_known).map(|(one, other)| one.distance(*other)).collect();
    }

    /// Whether it has diverged. A recording that has ended has not.
    #[cfg(feature = "render")]
    pub(crate) fn has_diverged(&self) -> bool {
        matches!(self.snapshot.status, Status::Diverged(Divergence { is_end: false, .. }))
    }

    /// The state that pictures show.
    pub fn shown(&self) -> &Snapshot {
        self.last_fit.as_deref().unwrap_or(&self.snapshot)
    }
}
