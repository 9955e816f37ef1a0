//! Digests by which states are compared bit for bit.

use crate::sim::Snapshot;
use sha2::{Digest, Sha256};

/// SHA-256 over all positions (m) and then all velocities (m/s) of a run's nodes, as little-endian double precision
/// numbers x, y, z: 64 hexadecimal digits.
pub(crate) fn state_digest(snapshot: &Snapshot) -> String {
    let mut hash = Sha256::new();
    for vector in snapshot.position.iter().chain(&snapshot.velocity) {
        hash.update(super::states::vector_bytes(vector));
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn every_bit_counts() {
        let one = Snapshot {
            position: vec![dvec3(1.0, 2.0, 3.0)],
            velocity: vec![dvec3(0.0, 0.0, 0.0)],
            ..Snapshot::default()
        };
        let mut other = one.clone();
        other.velocity[0].z = -0.0;
        assert_eq!(state_digest(&one), state_digest(&one.clone()));
        assert_ne!(state_digest(&one), state_digest(&other));
        // The SHA-256 digest of empty input.
        assert!(state_digest(&Snapshot::default()).starts_with("e3b0c44298fc1c14"));
    }
}
