//! One of the bodies that are advanced together.

use super::body::Body;
use super::broken::Broken;
use super::diagnose::Diagnose;
#[cfg(doc)]
use super::diagnostics::Diagnostics;
use super::model::{ForceModel, Projection};
use super::state::Nodes;
use std::ops::Range;
use std::sync::Arc;

/// One body in a simulation, and the ranges of its nodes and its memory in the [`State`](super::State).
#[derive(Clone)]
pub(crate) struct Part {
    /// Its number, counted from 0.
    pub number: usize,
    /// The body.
    pub body: Arc<Body>,
    /// The forces of its model.
    pub forces: Arc<dyn ForceModel>,
    /// What moves its nodes in place of the forces, if its model does so.
    pub(super) projection: Option<Arc<dyn Projection>>,
    /// The range of its nodes.
    pub nodes: Range<usize>,
    /// The range of its model's memory in [`Memory::model`](super::state::Memory::model).
    pub memory: Range<usize>,
    /// Whether the last number of that memory is [`Diagnostics::global_rotations`].
    pub(super) counts_fallbacks: bool,
    /// How its elements or springs break, if they do.
    pub(super) breaks: Option<Arc<Broken>>,
    /// The shortest period of its model (s).
    pub(super) period: f64,
    /// The number of its springs.
    pub(super) springs: usize,
    pub(super) diagnose: Arc<Diagnose>,
}

impl Part {
    /// The nodes of the part.
    pub(super) fn nodes_of<'a>(&self, all: Nodes<'a>) -> Nodes<'a> {
        Nodes { position: &all.position[self.nodes.clone()], velocity: &all.velocity[self.nodes.clone()] }
    }

    /// [`Diagnostics::broken`] by the memory of all models.
    pub(super) fn count_broken(&self, memory: &[f64]) -> f64 {
        let count =
            |breaks: &Arc<Broken>| breaks.of(&memory[self.memory.clone()]).filter(|&broken| broken).count() as f64;
        self.breaks.as_ref().map_or(f64::NAN, count)
    }

    /// Whether each element is broken, by the memory of all models; empty if none can be.
    pub(super) fn broken_elements(&self, memory: &[f64]) -> Vec<bool> {
        self.breaks.as_ref().map_or_else(Vec::new, |breaks| breaks.elements(&memory[self.memory.clone()]))
    }

    /// The same of each spring.
    pub(super) fn broken_springs(&self, memory: &[f64]) -> Vec<bool> {
        self.breaks.as_ref().map_or_else(Vec::new, |breaks| breaks.springs(&memory[self.memory.clone()]))
    }

    /// [`Diagnostics::global_rotations`] by the memory of all models.
    pub(super) fn global_rotations(&self, memory: &[f64]) -> f64 {
        memory[self.memory.clone()].last().copied().filter(|_| self.counts_fallbacks).unwrap_or(f64::NAN)
    }
}
