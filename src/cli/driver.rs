//! What graphics drivers need to draw the same everywhere.

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
