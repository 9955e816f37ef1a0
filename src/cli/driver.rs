//! What graphics drivers say on standard error is not said by this program, and mostly says nothing to its user.

/// How many bits the software driver computes with at once, unless its user has said so.
#[cfg(target_os = "linux")]
const VECTOR_WIDTH: [&str; 2] = ["LP_NATIVE_VECTOR_WIDTH", "256"];

/// Starts the program anew with the software driver's vectors set to the width that all its pictures are drawn with:
/// then they are the same on every processor. Mesa 22.3 also crashes with 128 bits, which it takes where the processor
/// has no wider ones. Where it cannot be done, pictures are drawn as the driver likes.
///
/// To be called by the program alone, before it does anything else: the process becomes another one.
#[cfg(target_os = "linux")]
pub fn settle(words: &[std::ffi::OsString]) {
    use std::os::unix::process::CommandExt;
    let [program, command, rest @ ..] = words else { return };
    let [variable, width] = VECTOR_WIDTH;
    // A process environment can be changed safely only from outside, so a new image of the program gets it.
    let is_scene = |word: &std::ffi::OsString| word.to_string_lossy().ends_with(".toml");
    let draws = command == "render" || command == "figure" || command == "compare" && rest.iter().any(is_scene);
    if !draws || std::env::var_os(variable).is_some() {
        return;
    }
    let Ok(image) = std::env::current_exe() else { return };
    let _error = std::process::Command::new(image).arg0(program).arg(command).args(rest).env(variable, width).exec();
}

/// Nothing needs to be settled here.
#[cfg(not(target_os = "linux"))]
pub fn settle(_words: &[std::ffi::OsString]) {}

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
