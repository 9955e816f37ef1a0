//! One of the bodies that are advanced together.

use super::body::Body;
use super::diagnose::Diagnose;
#[cfg(doc)]
use super::diagnostics::Diagnostics;
use super::model::ForceModel;
use super::state::Nodes;
use std::ops::Range;
use std::sync::Arc;

/// One body in a simulation, and the ranges of its nodes and its memory in the [`State`](super::State).
pub(crate) struct Part {
    /// Its number, counted from 0.
    pub number: usize,
    /// The body.
    pub body: Arc<Body>,
    /// The forces of its model.
    pub forces: Box<dyn ForceModel>,
    /// The range of its nodes.
    pub nodes: Range<usize>,
    /// The range of its model's memory in [`Memory::model`](super::state::Memory::model).
    pub memory: Range<usize>,
    /// Whether the last number of that memory is [`Diagnostics::global_rotations`].
    pub(super) counts_global: bool,
    pub(super) diagnose: Diagnose,
}

impl Part {
    /// The nodes of the part.
    pub(super) fn nodes_of<'a>(&self, all: Nodes<'a>) -> Nodes<'a> {
        Nodes { position: &all.position[self.nodes.clone()], velocity: &all.velocity[self.nodes.clone()] }
    }

    /// [`Diagnostics::global_rotations`] by the memory of all models.
    pub(super) fn global_rotations(&self, memory: &[f64]) -> f64 {
        memory[self.memory.clone()].last().copied().filter(|_| self.counts_global).unwrap_or(f64::NAN)
    }
}
