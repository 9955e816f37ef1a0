//! Digests by which states are compared bit for bit.

use crate::reading::words::hexadecimal;
use crate::scene::Scene;
use crate::sim::Snapshot;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// The states of a run that pictures and goldens record: a name and the nodes of each. A run of one body has one state
/// with the given name, and others have one for each body: `NAME · BODY`.
pub(crate) fn recorded(name: &str, scene: &Scene, run: usize) -> Vec<(String, Range<usize>)> {
    let run = &scene.runs[run];
    let of_bodies: Vec<_> = run.several(scene).map(|(body, nodes)| (format!("{name} · {body}"), nodes)).collect();
    if of_bodies.is_empty() { vec![(name.to_owned(), 0..run.body().len())] } else { of_bodies }
}

/// SHA-256 over all positions (m) and then all velocities (m/s) of some nodes of a run, as little-endian double
/// precision numbers x, y, z: 64 hexadecimal digits.
pub(crate) fn state_digest(snapshot: &Snapshot, nodes: Range<usize>) -> String {
    let mut hash = Sha256::new();
    for vector in snapshot.position[nodes.clone()].iter().chain(&snapshot.velocity[nodes]) {
        hash.update(super::states::vector_bytes(vector));
    }
    hexadecimal(&hash.finalize())
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
        assert_eq!(state_digest(&one, 0..1), state_digest(&one.clone(), 0..1));
        assert_ne!(state_digest(&one, 0..1), state_digest(&other, 0..1));
        // The SHA-256 digest of empty input.
        assert!(state_digest(&one, 0..0).starts_with("e3b0c44298fc1c14"));
    }
}
