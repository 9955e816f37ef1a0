//! One of the bodies that are advanced together.

use super::body::Body;
use super::diagnose::Diagnose;
#[cfg(doc)]
use super::diagnostics::Diagnostics;
use super::model::ForceModel;
use super::state::Nodes;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

/// Forces that are prepared at their first use. Vectorised steps need none, and forces of large bodies take several times the memory
/// of a state.
pub(crate) type Forces = LazyLock<Box<dyn ForceModel>, Box<dyn FnOnce() -> Box<dyn ForceModel> + Send>>;

/// One body in a simulation, and the ranges of its nodes and its memory in the [`State`](super::State).
pub(crate) struct Part {
    /// The body.
    pub body: Arc<Body>,
    /// The forces of its model.
    pub forces: Forces,
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
