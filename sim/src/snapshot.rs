//! A [`Snapshot`] of a run: the view of a simulation for drawing, diagnostics and files.

use super::contact::{ContactPoint, Reaction};
use super::diagnostics::Diagnostics;
use super::placement::Placement;
use super::state::{Status, Unsolved};
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
    /// The mean forces of contact and of constraints in the last interval that has ended; empty before, and in a world that
    /// [is not asked for them](super::World::keep_reactions).
    pub reactions: Vec<Reaction>,
    /// Where bodies touch now, in a world that is asked for the forces.
    pub contact_points: Vec<ContactPoint>,
    /// Whether the run has diverged.
    pub status: Status,
    /// The steps until then that an implicit method has not solved; `None` if there are none.
    pub unsolved: Option<Unsolved>,
}
