//! Long work outside the lock of the interpreter, which hears Ctrl-C. The interpreter handles signals on its main thread alone.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

/// The time between two looks at signals.
const BETWEEN: Duration = Duration::from_millis(20);

/// Lets the interpreter handle signals: Ctrl-C raises `KeyboardInterrupt`.
pub(crate) fn hear() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}

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

    /// Calls `work` with a number of steps until it returns true. In between it calls `hear`, whose error ends the work.
    pub(crate) fn until(&mut self, mut work: impl FnMut(u64) -> bool, hear: impl Fn() -> PyResult<()>) -> PyResult<()> {
        loop {
            let begin = Instant::now();
            let is_done = work(self.steps);
            if self.heard.elapsed() >= BETWEEN {
                hear()?;
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

/// Does work on a thread of the pool, where parts of it need not wait for threads to wake, while this thread hears signals. The work
/// gets a function that fails once it has to end.
pub(crate) fn in_pool<T: Send>(
    work: impl FnOnce(&(dyn Fn() -> PyResult<()> + Sync)) -> PyResult<T> + Send,
) -> PyResult<T> {
    let is_stopped = AtomicBool::new(false);
    let go_on = || match is_stopped.load(Ordering::Relaxed) {
        true => Err(PyRuntimeError::new_err("interrupted")),
        false => Ok(()),
    };
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        scope.spawn(move || sender.send(rayon::scope(|_| work(&go_on))));
        loop {
            match receiver.recv_timeout(BETWEEN) {
                Ok(done) => return done,
                Err(RecvTimeoutError::Timeout) => {
                    hear().inspect_err(|_| is_stopped.store(true, Ordering::Relaxed))?;
                }
                // The thread has panicked, which ends the scope in the same way.
                Err(RecvTimeoutError::Disconnected) => return Err(PyRuntimeError::new_err("the work has failed")),
            }
        }
    })
}
