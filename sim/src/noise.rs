//! Pseudo-random numbers, for the start of a search and for tests.

use glam::DVec3;

/// Pseudo-random numbers from −1 to 1, by D. Knuth's linear congruential generator.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

#[cfg(test)]
impl Noise {
    /// From 0 to 1.
    pub(crate) fn share(&mut self) -> f64 {
        0.5 * self.next() + 0.5
    }

    /// An index of a list with so many entries.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.share() * count as f64) as usize
    }
}
