//! What graphics drivers say on standard error is not said by this program, and mostly says nothing to its user.

/// Complaints that mean nothing to a program without a window.
#[cfg(unix)]
const NOISE: [&str; 2] = ["XDG_RUNTIME_DIR", "DISPLAY"];

/// Opens a device, or looks for some, while what the driver says is held back. What is left of it without the noise
/// is told afterwards, as the driver's words.
#[cfg(unix)]
pub(super) fn hushed<T>(open: impl FnOnce() -> T) -> T {
    use std::io::{Read, Seek, Write};
    // Where this cannot be done, the noise does no harm.
    let Some((mut words, ears)) = Held::take() else { return open() };
    let result = open();
    drop(ears);
    let mut text = Vec::new();
    if words.rewind().and_then(|()| words.read_to_end(&mut text)).is_ok() {
        let text = String::from_utf8_lossy(&text);
        for line in text.lines().filter(|line| !NOISE.iter().any(|noise| line.contains(noise))) {
            let _ = writeln!(std::io::stderr(), "graphics driver: {line}");
        }
    }
    result
}

/// Opens a device, or looks for some.
#[cfg(not(unix))]
pub(super) fn hushed<T>(open: impl FnOnce() -> T) -> T {
    open()
}

/// Standard error as it was; put back when dropped, also by a panic.
#[cfg(unix)]
struct Held(std::os::fd::OwnedFd);

#[cfg(unix)]
impl Held {
    /// Leads standard error into a file without a name.
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
