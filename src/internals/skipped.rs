//! A visible count of tests that are skipped.

use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Reports that the calling test is skipped, and the number skipped so far in this program. `cargo test` captures the
/// output of macros, so this is written to standard error directly.
pub fn skipped(why: &str) {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed) + 1;
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    let _ = writeln!(std::io::stderr(), "SKIPPED {test}: {why} ({count} skipped so far)");
}
