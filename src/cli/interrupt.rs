//! Ctrl-C and requests to terminate: a frame on its way is given up, what was made before is finished, and the command
//! ends.

use super::failure::Status;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens from now on. The second request ends the program at once, with nothing half-written under its own name.
pub(super) fn listen() {
    // A program that has its own handler keeps it, and a second call in the same program changes nothing.
    let _ = ctrlc::try_set_handler(|| {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(Status::Interrupted as u8));
        }
    });
}

/// Whether the user asked to stop.
pub(super) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
