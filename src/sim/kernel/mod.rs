//! Vectorised steps. The plain code of [`model`](super::model) and [`integrate`](super::integrate) is their reference.
//!
//! A kernel owns positions, velocities and rotations in arrays of its own, takes any number of steps, and hands them out
//! when somebody looks. Its results have the same bits for every vector set and every number of threads.

#![allow(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

mod drive;
pub(crate) mod floor;
pub(in crate::sim) mod general;
pub(in crate::sim) mod lattice;
mod memory;
pub(in crate::sim) mod motion;
mod rotation;
pub(in crate::sim) mod springs;
pub(in crate::sim) mod stepper;

#[cfg(test)]
mod tests;

pub(in crate::sim) use drive::ByKernel;

use crate::sim::contact::{Bound, Floor};
use glam::DVec3;
use std::ops::Range;

/// How the rotations of elements in space are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::sim) enum Rotation {
    /// Eq. (15) as printed, so many times, each solution a rotation by `atan |w|`.
    Arctangent {
        /// How often.
        passes: u32,
    },
    /// The optimum to round-off; see [`rotation::Optimum`].
    Optimum,
}

/// What a node meets at the end of a step of this number: its position (m) and velocity (m/s), and the acceleration with
/// which it has moved (m/s²), zero where it has moved at constant velocity.
pub(in crate::sim) type Resolve<'a> = dyn Fn(u64, &mut DVec3, &mut DVec3, DVec3) + Sync + 'a;

/// Is given a node, its position (m) and its velocity (m/s).
pub(in crate::sim) type Place<'a> = dyn FnMut(usize, DVec3, DVec3) + 'a;

/// Gives the nodes that grips hold at the end of a step of this number.
pub(in crate::sim) type Held<'a> = dyn Fn(u64, &mut Place<'_>) + Sync + 'a;

/// What acts on the nodes besides elements and gravity, in steps that are asked for by number.
#[derive(Clone, Copy)]
pub(in crate::sim) struct Around<'a> {
    /// Where obstacles may be at one time or another.
    pub(in crate::sim) bounds: &'a [Bound],
    /// Which of these count.
    pub(in crate::sim) row: &'a (dyn Fn(u64) -> Range<usize> + Sync),
    /// What happens to a node within one of the bounds.
    pub(in crate::sim) resolve: &'a Resolve<'a>,
    /// The only obstacle, if it is a floor that stays where it is: what `resolve` does to nodes that have moved at constant
    /// velocity is then done in lanes, with the same bits.
    pub(in crate::sim) floor: Option<Floor>,
    /// The nodes that grips hold, if there are grips that do.
    pub(in crate::sim) grips: Option<&'a Held<'a>>,
    /// The speed (m/s) beyond which a node is lost.
    pub(in crate::sim) speed_limit: &'a (dyn Fn(u64) -> f64 + Sync),
}

/// A node that would have become too fast, or whose velocity is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::sim) struct Lost {
    /// The number of the step.
    pub(in crate::sim) step: u64,
    /// The node.
    pub(in crate::sim) node: usize,
}
