//! Ctrl-C and requests to terminate: frames that are being drawn are finished, the state between frames goes into a
//! checkpoint, and the command ends.

use super::failure::Status;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the handlers.
///
/// Ctrl-C a second or more after the first request ends the program at once; no file is then left half-written under its
/// final name. Signals within that second count as one request, since `timeout` sends its signal twice. Other signals
/// only request the end: they come from programs, which have SIGKILL.
pub(super) fn listen() {
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

/// Requests within this time from the first are one.
const MOMENT: Duration = Duration::from_secs(1);

/// Exit status of an immediate end by Ctrl-C.
const ENDED: i32 = Status::Interrupted as i32;

/// Calls `request` for each signal that asks to end the program, with whether it is Ctrl-C, until it returns that the
/// program shall end at once.
///
/// Only signals whose default action is in place get a handler: ignored ones, as with `nohup`, stay ignored, and a program
/// keeps handlers of its own.
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

/// Whether a signal does what it does by default: neither ignored nor handled.
#[cfg(unix)]
#[allow(unsafe_code, reason = "no crate asks for this in a safe way, and only Linux has it in a file")]
fn is_default(signal: std::ffi::c_int) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action, `sigaction` changes nothing but what the last pointer points to, which has room for
    // it, and which is read only if it was written.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_DFL
    }
}

/// Calls `request` for each request to end the program, all of which count as Ctrl-C, until it returns that the program
/// shall end at once.
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
pub(super) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
