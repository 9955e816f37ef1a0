//! The moments of a recording in an archive, read one at a time.

use super::flaw::Flaw;
use crate::scene::file::{LARGEST, Up};
use crate::scene::mesh;
use crate::scene::npz::{Array, Npz};
use glam::DVec3;
use sha2::{Digest, Sha256};

/// A quantity that is recorded in each moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) enum Quantity {
    Position,
    Velocity,
    Memory,
}

/// Bytes that are checked together when a recording is opened.
const BLOCK: usize = 1 << 23;

/// The axis of a file that points up, and the length of its unit (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct Axes {
    pub(in crate::scene) up: Up,
    pub(in crate::scene) scale: f64,
}

impl Default for Axes {
    /// The axes of scenes.
    fn default() -> Self {
        Self { up: Up::Y, scale: 1.0 }
    }
}

impl Axes {
    /// Brings vectors of the file into the axes and the unit of scenes. In those they keep every bit.
    pub(in crate::scene) fn place(self, vectors: &mut [DVec3]) {
        if self != Self::default() {
            mesh::place(vectors, self.up as usize, self.scale);
        }
    }
}

/// A row for each moment.
#[derive(Debug)]
pub(super) struct Track {
    pub(super) of: Quantity,
    pub(super) array: Array,
    /// The SHA-256 of each row.
    pub(super) digests: Vec<[u8; 32]>,
    /// Whether the third coordinate of the scene, if the file has three, is zero everywhere.
    pub(super) is_flat: bool,
}

/// The moments of an archive, read one at a time.
#[derive(Debug)]
pub(super) struct Rows {
    pub(super) npz: Npz,
    pub(super) tracks: Vec<Track>,
}

impl Rows {
    /// The numbers of a quantity in a moment: all coordinates of the first node, then those of the second, and so on.
    ///
    /// # Errors
    /// The row cannot be read, or has changed; the message is the rest of a sentence about it.
    pub(super) fn row(&mut self, of: Quantity, moment: usize) -> Result<Vec<f64>, String> {
        let track = self.tracks.iter().find(|track| track.of == of).ok_or("is not recorded")?;
        let mut bytes = vec![0; track.row()];
        self.npz.part(&track.array, (moment * bytes.len()) as u64, &mut bytes)?;
        if Sha256::digest(&bytes)[..] != track.digests[moment] {
            return Err("is damaged: its numbers differ from those that were written, or first read".to_owned());
        }
        Ok(track.array.numbers(&bytes).collect())
    }
}

impl Quantity {
    /// The name of its array, after that of the run.
    pub(super) fn key(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Memory => "memory",
        }
    }
}

impl Track {
    /// The length of a row (bytes).
    fn row(&self) -> usize {
        self.array.shape[1..].iter().product::<u64>() as usize * self.array.width()
    }

    /// Reads every number once.
    pub(super) fn check(&mut self, npz: &mut Npz, name: &str, axes: Axes) -> Result<(), Flaw> {
        let (row, columns) = (self.row(), self.array.shape[2] as usize);
        let depth = if axes.up == Up::Z { 1 } else { 2 };
        let Self { array, digests, is_flat, .. } = self;
        let mut beyond = None;
        let mut check = |bytes: &[u8]| {
            for bytes in bytes.chunks_exact(row) {
                let is_beyond =
                    |&(_, number): &(usize, f64)| number.is_nan() || number.abs() * axes.scale.max(1.0) > LARGEST;
                let found = array.numbers(bytes).enumerate().find(is_beyond);
                beyond = beyond.or(found.map(|(at, number)| (digests.len(), at, number)));
                if columns == 3 && *is_flat {
                    *is_flat = array.numbers(bytes).skip(depth).step_by(3).all(|z| z == 0.0);
                }
                digests.push(Sha256::digest(bytes).into());
            }
        };
        npz.blocks(array, (BLOCK / row).max(1) * row, &mut check).map_err(|what| Flaw::new(name, what))?;
        let Some((moment, at, number)) = beyond else { return Ok(()) };
        let expected = match number.is_finite() {
            true => format!("a magnitude up to {LARGEST:e}"),
            false => "a finite number; write only the moments before the motion failed".to_owned(),
        };
        let place = format!("{name}[{moment}][{}][{}]", at / columns, at % columns);
        Err(Flaw::new(place, format!("is {number}; expected {expected}")))
    }
}
