//! Vectorised steps and energies. Their reference is the code of [`model`](super::model) and
//! [`integrate`](super::integrate).
//!
//! A kernel keeps positions, velocities and rotations in its own arrays, takes any number of steps, and writes the
//! state back when it is read. Its results have the same bits for every vector set and every number of threads.

#![allow(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

mod drive;
pub(crate) mod general;
mod held;
pub(crate) mod lattice;
mod memory;
pub mod peak;
pub(crate) mod rotation;
pub(crate) mod shapes;
pub(crate) mod springs;
mod stepper;
pub(crate) mod update;

#[cfg(test)]
mod tests;

pub(crate) use drive::ByKernel;
pub(crate) use shapes::strains;
pub(crate) use stepper::{Scheme, Stepper};

use crate::body::Body;
use crate::contact::{Bound, Impulses, Placed};
use crate::lanes::Set;
use crate::law::{ByLaw, Energy, Filled, Law};
use crate::state::{Nodes, State};
use crate::work::Work;
use general::General;
use glam::DVec3;
use held::Held;
use std::ops::Range;
use std::sync::Arc;

/// A model with vectorised steps and energies: every [`Law`], and models that choose among laws and faster code.
pub trait Vectorised {
    /// The code for a body.
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled;
}

impl<W: Law> Vectorised for W {
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
        Compiled::once(self.clone(), body, conditions)
    }
}

/// How a body is stepped.
#[derive(Clone, Copy)]
pub struct Conditions {
    /// How positions and velocities are advanced.
    pub(crate) scheme: Scheme,
    /// ΔT (s).
    pub(crate) step: f64,
    /// The vectors.
    pub(crate) set: Set,
}

/// The vectorised code of a model for a body.
pub struct Compiled {
    pub(crate) stepper: Box<dyn Stepper>,
    pub(crate) energy: Box<dyn Energy>,
}

impl Compiled {
    /// By a law that is compiled once: its relative stiffness is a constant, also where all are 1. Every other copy of a law takes
    /// seconds of the time to build this crate.
    pub(crate) fn once<W: Law>(law: W, body: &Arc<Body>, conditions: &Conditions) -> Self {
        let energy = Box::new(ByLaw::with(conditions.set, law.clone(), body));
        Self { stepper: Self::filled(law, body, conditions), energy }
    }

    /// Steps by a law with the relative stiffness of each element.
    pub(crate) fn filled<W: Law>(law: W, body: &Arc<Body>, conditions: &Conditions) -> Box<dyn Stepper> {
        Box::new(General::new(Filled(law), body, conditions))
    }

    /// Steps by a law, without the relative stiffness of elements if all are 1.
    pub(crate) fn full<W: Law>(law: W, body: &Arc<Body>, conditions: &Conditions) -> Box<dyn Stepper> {
        match law.relative_stiffness(body) {
            None => Box::new(General::new(law, body, conditions)),
            Some(_) => Self::filled(law, body, conditions),
        }
    }
}

/// How the rotations of elements in space are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rotation {
    /// Eq. (15) as printed, solved in a number of passes, each solution a rotation by `atan |w|`.
    Arctangent {
        /// The number of passes.
        passes: u32,
    },
    /// The optimum to round-off; see [`rotation::Optimum`].
    Optimum,
}

/// The velocity that elements damp, as a constant of code: none, the one relative to their mean, or that without the rigid motion that
/// fits best.
pub(crate) mod damped {
    pub(crate) const NONE: u8 = 0;
    pub(crate) const RELATIVE: u8 = 1;
    pub(crate) const DEFORMING: u8 = 2;
}

/// Contact of a node at the end of a step: takes the numbers of the step and of the node, and changes its position (m) and velocity (m/s).
/// The last argument is its constant acceleration in the step (m/s²), zero if it moved at constant velocity.
pub(crate) type Resolve<'a> = dyn Fn(u64, usize, &mut DVec3, &mut DVec3, DVec3) + Sync + 'a;

/// Changes the positions (m) and velocities (m/s) of nodes at the end of a step of this number that began at the given ones, and adds those that
/// it changes to a list.
pub(crate) type Meet<'a> = dyn Fn(u64, Nodes<'_>, &mut State, &mut Vec<u32>) + Sync + 'a;

/// How many of some steps nodes can take without meeting, from the step of this number on, and the speed (m/s) up to which they can.
pub(crate) type Alone<'a> = dyn Fn(u64, Nodes<'_>, u64) -> Option<(u64, f64)> + Sync + 'a;

/// Contact of surfaces.
#[derive(Clone, Copy)]
pub(crate) struct Meeting<'a> {
    pub(crate) meet: &'a Meet<'a>,
    pub(crate) alone: &'a Alone<'a>,
    /// The nodes of surfaces, in their order. Only they have to be given.
    pub(crate) nodes: &'a [u32],
}

/// Writes the forces from outside on all nodes (N) after a share of the step of this number.
pub(crate) type Push<'a> = dyn Fn(u64, f64, Nodes<'_>, &mut Forces) + Sync + 'a;

/// Forces from outside on all nodes (N).
#[derive(Clone, Debug, Default)]
pub(crate) struct Forces {
    pub(crate) vectors: Vec<DVec3>,
    /// Their x, y and z.
    columns: [Vec<f64>; 3],
}

impl Forces {
    /// No forces on so many nodes.
    pub(crate) fn zero(nodes: usize) -> Self {
        Self { vectors: vec![DVec3::ZERO; nodes], columns: [(); 3].map(|()| vec![0.0; nodes]) }
    }

    /// Writes the vectors of some nodes into the columns.
    pub(crate) fn spread(&mut self, nodes: impl Iterator<Item = usize>) {
        for node in nodes {
            let vector = self.vectors[node].to_array();
            self.columns.iter_mut().zip(vector).for_each(|(column, one)| column[node] = one);
        }
    }

    pub(crate) fn columns(&self) -> [&[f64]; 3] {
        self.columns.each_ref().map(|column| &column[..])
    }
}

/// What acts on the nodes besides elements. Its functions take the number of a step.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    /// Acceleration of gravity (m/s²).
    pub(crate) gravity: DVec3,
    /// Damping in proportion to masses (1/s).
    pub(crate) mass_damping: f64,
    /// x, y and z of the force from outside on each node (N); empty for none.
    pub(crate) forces: [&'a [f64]; 3],
    /// What makes these forces anew for each pass, if they change. Only positions of the nodes with loads are read.
    pub(crate) push: Option<&'a Push<'a>>,
    /// The nodes with loads, and their work.
    pub(crate) work: Option<&'a Work>,
    /// Bounds of the obstacles that nodes meet, in all steps.
    pub(crate) bounds: &'a [Bound],
    /// The range of the bounds of a step.
    pub(crate) row: &'a (dyn Fn(u64) -> Range<usize> + Sync),
    /// Contact of a node within one of the bounds.
    pub(crate) resolve: &'a Resolve<'a>,
    /// Where it adds up impulses, if anywhere.
    pub(crate) impulses: Option<&'a Impulses>,
    /// The only obstacle, if it is a floor that does not move. For nodes that moved at constant velocity the kernel
    /// then computes contact in lanes, with the same bits as `resolve`.
    pub(crate) floor: Option<&'a Placed<'a>>,
    /// The nodes of parts that meet no obstacle.
    pub(crate) apart: &'a [Range<usize>],
    /// The nodes that grips hold; `None` without grips.
    pub(crate) grips: Option<&'a Held<'a>>,
    /// Whether each node of the part is one of them, which has no speed of its own; empty if none is.
    pub(crate) held: &'a [bool],
    /// Contact of surfaces, if they can meet.
    pub(crate) meeting: Option<Meeting<'a>>,
    /// The greatest speed (m/s) in a step.
    pub(crate) speed_limit: &'a (dyn Fn(u64) -> f64 + Sync),
}

/// A node above the speed limit, or with a velocity that is NaN. The lesser of two is the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Lost {
    /// The number of the step.
    pub(crate) step: u64,
    /// The node.
    pub(crate) node: usize,
}
