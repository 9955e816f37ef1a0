//! Ctrl-C and requests to terminate: a frame on its way is given up, what was made before is finished, and the command
//! ends.

use super::failure::Status;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Listens from now on.
///
/// Ctrl-C a second or more after the first request, whatever that was, ends the program at once, with nothing half-written
/// under its own name. What follows within that second is the same request twice, as `timeout` sends it. Other signals
/// only ever ask, for they come from programs, which have SIGKILL when they are in a hurry.
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

/// What Ctrl-C ends the program with at once.
const ENDED: i32 = Status::Interrupted as i32;

/// Calls `request` for each signal that asks to end the program, saying whether it is Ctrl-C, until it says that the
/// program is to end at once.
///
/// Each signal is for itself, and only those are listened for that would end the program now: what is ignored, as by
/// `nohup`, stays ignored, and a program that has its own handler keeps it.
#[cfg(unix)]
fn take_requests(mut request: impl FnMut(bool) -> bool + Send + 'static) {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let ending = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&signal| is_default(signal));
    // Where nothing can be listened for, signals end the program as they would any other.
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
#[allow(unsafe_code, reason = "no crate asks for this in a safe way, and only Linux tells it in a file")]
fn is_default(signal: std::ffi::c_int) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: without a new action, `sigaction` changes nothing but what the last pointer points to, which has room for
    // it, and which is read only if it was written.
    unsafe {
        libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr()) == 0
            && action.assume_init().sa_sigaction == libc::SIG_DFL
    }
}

/// Calls `request` for each request to end the program, all of which are taken for Ctrl-C, until it says that the program
/// is to end at once.
#[cfg(not(unix))]
fn take_requests(mut request: impl FnMut(bool) -> bool + Send + 'static) {
    // A program that has its own handler keeps it.
    let _ = ctrlc::try_set_handler(move || {
        if request(true) {
            std::process::exit(ENDED);
        }
    });
}

/// Whether the user asked to stop.
pub(super) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
