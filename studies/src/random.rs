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
