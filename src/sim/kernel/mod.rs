//! Vectorised steps. The plain code of [`model`](super::model) and [`integrate`](super::integrate) is their reference.
//!
//! A kernel owns positions, velocities and rotations in arrays of its own, takes any number of steps, and hands them out
//! when somebody looks. Its results have the same bits for every vector set and every number of threads.

#![allow(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

mod array;
mod crew;
mod drive;
pub(crate) mod floor;
pub(in crate::sim) mod general;
mod lanes;
pub(in crate::sim) mod lattice;
mod memory;
pub(in crate::sim) mod motion;
mod rotation;
pub(in crate::sim) mod springs;

#[cfg(test)]
mod tests;

pub(in crate::sim) use drive::ByKernel;
pub(in crate::sim) use lanes::Set;

use glam::DVec3;

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

/// A region outside of which nothing has to be asked whether a node touches it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::sim) enum Bound {
    /// All points with `normal · x < height`.
    HalfSpace {
        /// Unit vector out of it.
        normal: DVec3,
        /// Distance of the surface from the origin along `normal` (m).
        height: f64,
    },
    /// All points strictly between two corners.
    Box {
        /// The corner with the least coordinates (m).
        low: DVec3,
        /// The corner with the greatest (m).
        high: DVec3,
    },
}

/// A half-space that nodes bounce off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::sim) struct Floor {
    /// Unit vector out of it.
    pub(in crate::sim) normal: DVec3,
    /// Distance of the surface from the origin along `normal` (m).
    pub(in crate::sim) height: f64,
    /// Restitution coefficient `e`.
    pub(in crate::sim) restitution: f64,
    /// Friction coefficient `μ`.
    pub(in crate::sim) friction: f64,
}

/// What a node meets at the end of a step: its index, its position (m) and velocity (m/s), and the acceleration with which
/// it has moved (m/s²), zero where it has moved at constant velocity.
pub(in crate::sim) type Resolve<'a> = dyn Fn(usize, &mut DVec3, &mut DVec3, DVec3) + Sync + 'a;

/// What acts on the nodes besides elements and gravity.
#[derive(Clone, Copy)]
pub(in crate::sim) struct Around<'a> {
    /// Where obstacles may be.
    pub(in crate::sim) bounds: &'a [Bound],
    /// What happens to a node within one of the bounds.
    pub(in crate::sim) resolve: &'a Resolve<'a>,
    /// The only obstacle, if it is a floor that stays where it is: what `resolve` does to nodes that have moved at constant
    /// velocity is then done in lanes, with the same bits.
    pub(in crate::sim) floor: Option<Floor>,
    /// The speed (m/s) beyond which a node is lost, in the step of this number; the first of a call has number 0.
    pub(in crate::sim) speed_limit: &'a (dyn Fn(u64) -> f64 + Sync),
}

/// A step that was not taken, because a node would have become too fast, or its velocity no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::sim) struct Runaway {
    /// The number of steps of the call that were taken.
    pub(in crate::sim) taken: u64,
    /// The first such node.
    pub(in crate::sim) node: usize,
}
