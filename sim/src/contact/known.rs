//! What a step of contact knows of the step before.

use super::end::Ends;
use super::extent::Extent;
use super::pair::{Look, Pair};
use super::shown::Shown;
use glam::DVec3;

/// What is known of the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Known {
    /// Positions at the start of the last step, of nodes and of points of obstacles (m); empty if nothing is known.
    pub(super) last: Vec<DVec3>,
    /// Those of this one.
    pub(super) ends: Ends,
    pub(super) pairs: Vec<Pair>,
    /// The way (m) of any two surfaces until others than the pairs may meet.
    pub(super) left: f64,
    pub(super) shown: Vec<Shown>,
    /// Whether each surface is in a pair.
    pub(super) is_near: Vec<bool>,
    /// What pairs lend each other.
    pub(super) looks: Vec<Look>,
    /// Places, boxes around the surfaces, and the order in which they begin, while bodies are asked whether they can go alone.
    pub(super) now: Vec<DVec3>,
    pub(super) extents: Vec<Extent>,
    pub(super) order: Vec<usize>,
}
