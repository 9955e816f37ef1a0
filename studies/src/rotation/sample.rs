//! The random elements for measuring solvers. They do not depend on the machine.

use super::reference::refined;
use crate::random::Random;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::PI;

/// An element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// `Σ R0 rᵀ`, of size 1.
    pub(crate) at_rest: DMat3,
    /// The last rotation.
    pub(crate) last: DQuat,
}

/// A kind of elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// Cubes with a largest strain, turned by an increment since their last rotation.
    Warm {
        /// The stretches are 1 plus the strain, 1 minus it, and one between. Beyond 1, elements are turned inside out.
        strain: f64,
        /// The angle from the last rotation to the optimum (rad), about any axis.
        increment: f64,
    },
    /// Any stretches, among them flat, thin and inverted ones, with any last rotation.
    Cold,
}

/// The least gap `(s₂ + sign(det) s₃) / s₁` of the singular values of any element.
pub(crate) const LEAST_GAP: f64 = 1e-3;

/// Elements of a kind with their optimal rotations, rounded once.
pub(crate) fn samples(kind: Kind, count: usize) -> Vec<(Sample, DQuat)> {
    let mut random = Random(9);
    let one = || {
        let stretch = loop {
            let stretch = stretch(kind, &mut random);
            if gap(stretch) >= LEAST_GAP {
                break stretch;
            }
        };
        let (axes, turn) = (DMat3::from_quat(random.rotation()), random.rotation());
        let at_rest = (DMat3::from_quat(turn) * axes * DMat3::from_diagonal(stretch) * axes.transpose()).transpose();
        // Only the stretch of the smallest size is negative, so this is `turn` up to the rounding of the moments.
        let sought = refined(at_rest, turn);
        let increment = match kind {
            Kind::Warm { increment, .. } => increment,
            Kind::Cold => PI * random.next(),
        };
        let (sine, cosine) = libm::sincos(0.5 * increment);
        let axis = random.direction() * sine;
        let last = (DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine) * sought).normalize();
        (Sample { at_rest, last }, sought)
    };
    std::iter::repeat_with(one).take(count).collect()
}

/// The stretches of an element along its axes.
fn stretch(kind: Kind, random: &mut Random) -> DVec3 {
    match kind {
        Kind::Warm { strain, .. } => {
            let third = 2.0 * random.next() - 1.0;
            // Only one stretch is negative.
            let third = if strain > 1.0 { third.abs() } else { third };
            DVec3::new(1.0 - strain, 1.0 + strain, 1.0 + strain * third)
        }
        Kind::Cold => {
            let second = libm::exp10(3.0 * (random.next() - 1.0));
            // The gap may have any size.
            let gap = libm::exp10(3.0 * (random.next() - 1.0)) * 2.0 * second;
            DVec3::new(1.0, second, (gap - second).clamp(-second, second))
        }
    }
}

/// The gap of the singular values, relative to the largest: the optimum is unique if it is positive.
fn gap(stretch: DVec3) -> f64 {
    let mut sizes = stretch.abs().to_array();
    sizes.sort_by(f64::total_cmp);
    (sizes[1] + stretch.to_array().iter().product::<f64>().signum() * sizes[0]) / sizes[2]
}
