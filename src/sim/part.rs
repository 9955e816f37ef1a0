//! One body among those that are advanced together.

use super::body::Body;
use super::diagnose::Diagnose;
use super::model::ForceModel;
use super::state::Nodes;
use std::ops::Range;
use std::sync::Arc;

/// One body in a simulation, and where its nodes and its memory lie in the [`State`](super::State).
pub(crate) struct Part {
    /// The body.
    pub body: Arc<Body>,
    /// Its model's forces.
    pub forces: Box<dyn ForceModel>,
    /// Its nodes among all.
    pub nodes: Range<usize>,
    /// Its model's memory among [`Memory::model`](super::state::Memory::model).
    pub memory: Range<usize>,
    pub(super) diagnose: Diagnose,
}

impl Part {
    /// The part's own nodes.
    pub(super) fn nodes_of<'a>(&self, all: Nodes<'a>) -> Nodes<'a> {
        Nodes { position: &all.position[self.nodes.clone()], velocity: &all.velocity[self.nodes.clone()] }
    }
}
