//! Long work outside the lock of the interpreter, which hears Ctrl-C.

use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// The time between two looks at signals.
const BETWEEN: Duration = Duration::from_millis(20);

/// Work in slices of steps.
pub(crate) struct Slices {
    /// The steps of the next slice.
    steps: u64,
    /// The last look at signals.
    heard: Instant,
}

impl Slices {
    pub(crate) fn new() -> Self {
        Self { steps: 1, heard: Instant::now() }
    }

    /// Calls `work` with a number of steps until it returns true. In between, the interpreter handles signals: Ctrl-C raises
    /// `KeyboardInterrupt`.
    pub(crate) fn until(&mut self, mut work: impl FnMut(u64) -> bool) -> PyResult<()> {
        loop {
            let begin = Instant::now();
            let is_done = work(self.steps);
            if self.heard.elapsed() >= BETWEEN {
                Python::attach(|py| py.check_signals())?;
                self.heard = Instant::now();
            }
            if is_done {
                return Ok(());
            }
            let is_short = begin.elapsed() < BETWEEN / 4;
            self.steps = if is_short { self.steps.saturating_mul(2) } else { (self.steps / 2).max(1) };
        }
    }
}
