//! Pseudo-random numbers, which do not depend on the machine.

use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Pseudo-random numbers: Knuth's linear congruential generator.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From 0 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector, uniformly distributed.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sine, cosine) = libm::sincos(TAU * self.next());
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cosine, radius * sine, z)
    }

    /// A rotation, uniformly distributed (K. Shoemake, Graphics Gems III, 1992, p. 124).
    pub(crate) fn rotation(&mut self) -> DQuat {
        let share = self.next();
        let [(a, b), (c, d)] = [1.0 - share, share].map(|part| {
            let (sine, cosine) = libm::sincos(TAU * self.next());
            (part.sqrt() * sine, part.sqrt() * cosine)
        });
        DQuat::from_xyzw(a, b, c, d).normalize()
    }
}

/// A number from 0 to below 1 for an index and its use, independent of numbers drawn before: the finaliser of
/// SplitMix64 (Steele, Lea, Flood 2014), applied to both.
pub(crate) fn unit(seed: u32, index: u64, usage: u64) -> f64 {
    let mixed = [u64::from(seed), index, usage].into_iter().fold(0u64, |state, part| mix(state.wrapping_add(part)));
    // A double holds 53 bits.
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

/// One number of SplitMix64 from its state.
fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
#[path = "../tests/inside/random.rs"]
mod tests;
