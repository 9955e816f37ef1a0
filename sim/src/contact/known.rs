//! What a step of contact knows of the step before.

use super::end::{Ends, Motion};
use super::extent::Extent;
use super::ground::Near;
use super::pair::{Look, Pair};
use super::shown::Shown;
use glam::DVec3;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is known of the last step.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Positions at the start of the last step, of nodes and of points of obstacles (m); empty if nothing is known.
    pub(super) last: Vec<DVec3>,
    /// Those of this one.
    pub(super) ends: Ends,
    /// For each half-space, and the feet of the points that touch one, at the end of the step (m).
    pub(super) near: Vec<Near>,
    pub(super) feet: Vec<(DVec3, Motion)>,
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

/// What is known of a world. A copy of the world knows nothing yet.
#[derive(Debug, Default)]
pub(super) struct Memory(Mutex<Known>);

impl Clone for Memory {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Memory {
    pub(super) fn lock(&self) -> MutexGuard<'_, Known> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
