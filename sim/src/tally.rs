//! The count of rotations that needed the global solver.

use std::sync::atomic::{AtomicU64, Ordering};

/// The number of stored rotations that the global solver has computed so far. Rotations that are not stored do not count, because
/// their number depends on how steps are divided into calls. Threads add in any order.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    now: AtomicU64,
    kept: u64,
}

impl Clone for Tally {
    fn clone(&self) -> Self {
        Self { now: self.get().into(), kept: self.kept }
    }
}

impl Tally {
    /// Adds the lanes whose bits are set.
    pub(crate) fn add(&self, lanes: u32) {
        self.now.fetch_add(lanes.count_ones().into(), Ordering::Relaxed);
    }

    /// The number.
    pub(crate) fn get(&self) -> u64 {
        self.now.load(Ordering::Relaxed)
    }

    /// Reads the number from the memory of a model, where it stands after all rotations; `None` counts from 0.
    pub(crate) fn load(&mut self, after: Option<&f64>) {
        *self.now.get_mut() = after.map_or(0, |&count| count as u64);
    }

    /// Writes the number where [`Self::load`] reads it.
    pub(crate) fn store(&self, after: Option<&mut f64>) {
        if let Some(count) = after {
            *count = self.get() as f64;
        }
    }

    /// Keeps a copy.
    pub(crate) fn keep(&mut self) {
        self.kept = self.get();
    }

    /// Restores the copy.
    pub(crate) fn restore(&mut self) {
        *self.now.get_mut() = self.kept;
    }
}
