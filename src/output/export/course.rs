//! The states of a run over its course, read back frame by frame.

use crate::output::StatesWriter;
use glam::DVec3;
use std::io;
use std::ops::Range;

/// The recorded frames of a run.
pub(super) struct Course<'c> {
    pub(super) states: &'c mut StatesWriter,
    /// The place of the run among the recorded ones.
    pub(super) place: usize,
    /// The places of the frames among the recorded ones, one for each time.
    pub(super) frames: Vec<usize>,
    /// The time of each frame (s), rising; at least one.
    pub(super) times: Vec<f64>,
}

impl Course<'_> {
    /// The positions (m) or velocities (m/s) of some nodes in a frame: `position` or `velocity`.
    pub(super) fn read(&mut self, quantity: &str, frame: usize, nodes: &Range<usize>) -> io::Result<Vec<DVec3>> {
        self.states.read(self.place, quantity, self.frames[frame], nodes)
    }
}
