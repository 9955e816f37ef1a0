//! Filters messages of graphics drivers on standard error.

/// Lines to drop, which mean nothing to a program without a window. They come from libwayland, which Vulkan drivers of
/// Mesa load.
#[cfg(unix)]
const NOISE: [&str; 2] = [
    "error: XDG_RUNTIME_DIR is invalid or not set in the environment.",
    "error: XDG_RUNTIME_DIR not set in the environment.",
];

/// Calls a function while standard error is buffered, then writes its lines, also of other threads, except those to
/// drop.
///
/// Standard error belongs to the whole process, so only one thread does this at a time, and briefly.
#[cfg(unix)]
pub(super) fn hushed<T>(open: impl FnOnce() -> T) -> T {
    use std::io::{Read, Seek, Write};
    use std::sync::{Mutex, PoisonError};
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // If buffering fails, the noise is harmless.
    let Some((mut buffer, held)) = Held::take() else { return open() };
    let result = open();
    drop(held);
    let mut text = Vec::new();
    if buffer.rewind().and_then(|()| buffer.read_to_end(&mut text)).is_ok() {
        let is_noise = |line: &[u8]| NOISE.iter().any(|noise| line.trim_ascii_end() == noise.as_bytes());
        let kept: Vec<u8> =
            text.split_inclusive(|&byte| byte == b'\n').filter(|line| !is_noise(line)).flatten().copied().collect();
        let _ = std::io::stderr().write_all(&kept);
    }
    result
}

/// Calls a function: this system has no lines to drop.
#[cfg(not(unix))]
pub(super) fn hushed<T>(open: impl FnOnce() -> T) -> T {
    open()
}

/// The original standard error; restored when dropped, also by a panic.
#[cfg(unix)]
struct Held(std::os::fd::OwnedFd);

#[cfg(unix)]
impl Held {
    /// Redirects standard error to an unnamed temporary file.
    fn take() -> Option<(std::fs::File, Self)> {
        use std::os::fd::AsFd;
        let before = std::io::stderr().as_fd().try_clone_to_owned().ok()?;
        let file = tempfile::tempfile().ok()?;
        rustix::stdio::dup2_stderr(&file).ok()?;
        Some((file, Self(before)))
    }
}

#[cfg(unix)]
impl Drop for Held {
    fn drop(&mut self) {
        let _ = rustix::stdio::dup2_stderr(&self.0);
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::hushed;
    use std::io::Write;
    use std::process::Command;

    fn say(line: &str) {
        let _ = writeln!(std::io::stderr(), "{line}");
    }

    /// Ends this process if it hangs.
    fn end_in_time() {
        std::thread::spawn(|| {
            std::thread::sleep(std::time::Duration::from_secs(300));
            std::process::abort();
        });
    }

    /// Standard error belongs to the whole process, so this test has a process of its own.
    #[test]
    #[ignore = "started by the test below"]
    fn in_a_process_of_its_own() {
        end_in_time();
        let speak = |number: usize| {
            say("error: XDG_RUNTIME_DIR is invalid or not set in the environment.");
            say(&format!("kept {number}"));
            std::thread::sleep(std::time::Duration::from_millis(20));
            number
        };
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|number| scope.spawn(move || hushed(|| speak(number)))).collect();
            for (number, thread) in threads.into_iter().enumerate() {
                assert_eq!(thread.join().expect("no panic"), number);
            }
        });
        let panics = std::panic::catch_unwind(|| hushed(|| std::panic::resume_unwind(Box::new(()))));
        assert!(panics.is_err());
        hushed(|| {
            say("XDG_RUNTIME_DIR and DISPLAY of the host program");
            say("kept at the end");
        });
        say("heard again");
    }

    #[test]
    fn noise_is_held_back_and_nothing_else() {
        let mut command = Command::new(std::env::current_exe().expect("this test"));
        command.args(["--exact", "gpu::noise::tests::in_a_process_of_its_own", "--ignored", "--nocapture"]);
        let output = command.output().expect("this test starts");
        let text = String::from_utf8(output.stderr).expect("text");
        assert!(output.status.success() && !text.contains("error: XDG_RUNTIME_DIR"), "{text}");
        assert!(text.contains("XDG_RUNTIME_DIR and DISPLAY of the host program\n"), "{text}");
        for kept in ["kept 0\n", "kept 1\n", "kept 2\n", "kept 3\n", "kept at the end\nheard again\n"] {
            assert!(text.contains(kept), "{kept}{text}");
        }
    }
}
