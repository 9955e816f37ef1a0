//! What contact sees of the end of a step.

use super::Impulses;
use super::rule::Timing;
use crate::motion::Interval;
use crate::state::Nodes;
use glam::DVec3;

/// The end of a step, as contact sees and changes it. Only the nodes of surfaces count.
pub(crate) struct End<'a> {
    pub(crate) interval: Interval,
    /// At the start of the step.
    pub(crate) before: Nodes<'a>,
    pub(crate) position: &'a mut [DVec3],
    pub(crate) velocity: &'a mut [DVec3],
    pub(crate) timing: Timing,
    /// Takes the nodes that contact changes.
    pub(crate) changed: &'a mut Vec<u32>,
    /// Where impulses are added up, if anywhere.
    pub(crate) impulses: Option<&'a Impulses>,
}
