//! States that were computed elsewhere, shown in place of steps.

use super::body::Body;
use super::crew::Crew;
use super::dynamics::Dynamics;
use super::limit::SpeedLimit;
use super::model::{ElasticModel, ForceModel, Properties, Report, Scratch, Share};
use super::part::Part;
use super::state::{Divergence, Nodes, Runaway, State, Status};
use super::system::System;
use glam::DVec3;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The states of a run that was computed elsewhere. A [`World`](super::World) that plays it shows its states after each
/// number of steps, and computes none. It is that of an earlier simulation or of another program.
pub trait Recording: Send + Sync {
    /// Where it ends, as a divergence: the first step without a state, and the time of its last state (s).
    fn end(&self) -> Divergence;

    /// Writes the positions (m) and velocities (m/s) after a number of steps, which is before the end, and the memory if
    /// it is recorded.
    fn show(&mut self, steps: u64, state: &mut State);
}

/// Takes states from a recording.
pub(super) struct ByRecording {
    /// Copies of a world take turns at it.
    recording: Arc<Mutex<Box<dyn Recording>>>,
    /// The code that would compute the states, and reports on them.
    reporting: Box<dyn Dynamics>,
    /// The number of steps after which the state is the present one.
    shown: Option<u64>,
}

impl ByRecording {
    pub(super) fn new(recording: Box<dyn Recording>, reporting: Box<dyn Dynamics>) -> Self {
        Self { recording: Arc::new(Mutex::new(recording)), reporting, shown: None }
    }

    fn recording(&self) -> MutexGuard<'_, Box<dyn Recording>> {
        self.recording.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Dynamics for ByRecording {
    fn advance(&mut self, _: &System, _: &SpeedLimit, state: &mut State, count: u64) -> Result<(), Runaway> {
        let steps = state.steps.saturating_add(count);
        let end = self.recording().end();
        if end.step <= steps {
            state.steps = end.step - 1;
            return Err(Runaway { node: 0 });
        }
        state.steps = steps;
        Ok(())
    }

    fn is_recorded(&self) -> bool {
        true
    }

    // States between moments are never looked at, and not read.
    fn settle(&mut self, state: &mut State) {
        if state.status == Status::Ok && self.shown != Some(state.steps) {
            self.recording().show(state.steps, state);
            self.shown = Some(state.steps);
        }
    }

    fn report(&self, part: &Part, state: &State, share: Option<&mut Share<'_>>, crew: &Crew) -> Report {
        self.reporting.report(part, state, share, crew)
    }

    fn divergence(&self, system: &System, _: &State, _: Runaway) -> Divergence {
        let end = self.recording().end();
        // A recording may be of other parts.
        let elements = system.parts.get(end.part).map_or(0, |part| part.body.elements.len());
        match end.element {
            Some(element) if element >= elements => Divergence { part: 0, element: None, ..end },
            None if end.part >= system.parts.len() => Divergence { part: 0, ..end },
            _ => end,
        }
    }

    fn copy(&self) -> Box<dyn Dynamics> {
        let (recording, reporting) = (Arc::clone(&self.recording), self.reporting.copy());
        Box::new(Self { recording, reporting, shown: None })
    }

    fn restart(&mut self) {
        self.shown = None;
    }
}

/// The forces of a run that was computed elsewhere, which nobody knows.
#[derive(Debug)]
pub(super) struct Unknown;

impl ElasticModel for Unknown {
    fn properties(&self, _: &Body) -> Properties {
        Properties::new("", 0.0)
    }

    fn prepare(&self, _: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(Self)
    }
}

impl ForceModel for Unknown {
    fn add_forces(&self, _: Nodes<'_>, _: &[f64], _: &mut [f64], _: &mut Scratch, _: &mut [DVec3]) {}

    fn is_damped(&self) -> bool {
        false
    }

    fn report(&self, _: Nodes<'_>, _: &[f64], _: &mut Share<'_>) -> Report {
        Report::default()
    }
}
