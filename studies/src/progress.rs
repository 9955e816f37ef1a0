//! The progress of a study, on standard error: a bar in a terminal, else a line every few seconds.

use crate::failure::Status;
use indicatif::{ProgressBar, ProgressStyle};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::io::{self, IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Called with the amount of work just done, from any thread; `false` stops the measurement.
pub(crate) type Watch<'a> = dyn Fn(u64) -> bool + Sync + 'a;

/// The time between two lines.
const EVERY: Duration = Duration::from_secs(5);

/// Whether the user asks the study to end: by Ctrl-C or SIGTERM. A second Ctrl-C ends the program at once.
pub(crate) fn interrupt() -> Arc<AtomicBool> {
    let asked = Arc::new(AtomicBool::new(false));
    // Without handlers, signals end the program.
    let _ = flag::register_conditional_shutdown(SIGINT, Status::Interrupted as i32, Arc::clone(&asked));
    for signal in [SIGINT, SIGTERM] {
        let _ = flag::register(signal, Arc::clone(&asked));
    }
    asked
}

/// Calls `measure` with a watch, and shows the progress of `work` in all unless `is_quiet`.
pub(crate) fn shown<T>(name: &str, work: u64, is_quiet: bool, measure: impl FnOnce(&Watch<'_>) -> T) -> T {
    let asked = interrupt();
    let goes_on = || !asked.load(Ordering::SeqCst);
    if is_quiet {
        return measure(&|_| goes_on());
    }
    if io::stderr().is_terminal() {
        let style = ProgressStyle::with_template("{prefix}  {wide_bar}  {eta} left").expect("a template of known keys");
        let bar = ProgressBar::new(work).with_style(style).with_prefix(name.to_owned());
        let found = measure(&|more| {
            bar.inc(more);
            goes_on()
        });
        bar.finish_and_clear();
        return found;
    }
    told(name, work, EVERY, &mut io::stderr(), |done| measure(&|more| done(more) && goes_on()))
}

/// Calls `measure` with a function that takes the work just done and returns true. Writes a line after each interval.
fn told<T>(
    name: &str,
    work: u64,
    every: Duration,
    to: &mut (impl Write + Send),
    measure: impl FnOnce(&Watch<'_>) -> T,
) -> T {
    let (done, begun) = (AtomicU64::new(0), Instant::now());
    let (ended, wait) = channel::<()>();
    thread::scope(|scope| {
        let done = &done;
        scope.spawn(move || {
            loop {
                let percent = 100 * done.load(Ordering::Relaxed) / work.max(1);
                // A closed standard error does not stop the study.
                let _ = writeln!(to, "{name}: {percent} % after {} s", begun.elapsed().as_secs());
                if wait.recv_timeout(every) != Err(RecvTimeoutError::Timeout) {
                    return;
                }
            }
        });
        let found = measure(&|more| {
            done.fetch_add(more, Ordering::Relaxed);
            true
        });
        drop(ended);
        found
    })
}

#[cfg(test)]
#[path = "../tests/inside/progress.rs"]
mod tests;
