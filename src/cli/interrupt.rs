//! Ctrl-C and requests to terminate: frames that are being drawn are finished, the state between frames goes into a
//! checkpoint, and the command ends.

use super::failure::Status;
#[cfg(unix)]
use std::sync::Arc;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the handlers.
///
/// The first request only asks the command to end. Ctrl-C a second or more later ends the program at once; no file is
/// then left half-written under its final name. Signals within that second count as one request, since `timeout` sends
/// its signal twice. Other signals are never more than a request: they come from programs, which can send SIGKILL.
pub fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        let mut first: Option<Instant> = None;
        take_requests(move |is_ctrl_c| {
            REQUESTED.store(true, Ordering::SeqCst);
            let first = *first.get_or_insert_with(Instant::now);
            is_ctrl_c && first.elapsed() >= MOMENT
        });
    });
}

/// Makes a write fail that exceeds a limit on the size of files, in place of a signal that ends the program.
pub(super) fn outlive_file_limits() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default());
}

/// Signals within this time of the first are one request.
const MOMENT: Duration = Duration::from_secs(1);

/// Exit status of an immediate end by Ctrl-C.
const ENDED: i32 = Status::Interrupted as i32;

/// Calls `request` for each signal that asks the program to end, with whether it is Ctrl-C. Stops when `request`
/// returns that the program must end at once.
///
/// Only signals with their default action get a handler: ignored ones, as with `nohup`, stay ignored, and a program
/// keeps its own handlers.
#[cfg(unix)]
fn take_requests(mut request: impl FnMut(bool) -> bool + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ending = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| is_default(signal));
    // Without handlers, signals have their default action.
    let Ok(mut signals) = signal_hook::iterator::Signals::new(ending) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            if request(signal == SIGINT) {
                signal_hook::low_level::exit(ENDED);
            }
        }
    });
}

/// Whether a signal has its default action: neither ignored nor handled.
#[cfg(unix)]
#[allow(unsafe_code, reason = "no crate has a safe function for it, and only Linux has it in a file")]
fn is_default(signal: std::ffi::c_int) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action, `sigaction` changes only the value of the last pointer, which has room for it and
    // is read only if it was written.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_DFL
    }
}

/// Calls `request` for each request to end the program; each counts as Ctrl-C. Stops when `request` returns that the
/// program must end at once.
#[cfg(not(unix))]
fn take_requests(mut request: impl FnMut(bool) -> bool + Send + 'static) {
    // A program that has its own handler keeps it.
    let _ = ctrlc::try_set_handler(move || {
        if request(true) {
            std::process::exit(ENDED);
        }
    });
}

/// Whether an interruption was requested.
pub fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
