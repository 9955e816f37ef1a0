//! Settings of graphics drivers, for the same pictures on every machine.

/// The vector width (bits) of the software driver, unless the user has set it.
#[cfg(target_os = "linux")]
const VECTOR_WIDTH: [&str; 2] = ["LP_NATIVE_VECTOR_WIDTH", "256"];

/// Restarts the program (`exec`) with the vector width of the software driver fixed, so that pictures are the same on every
/// processor. Mesa 22.3 also crashes with 128 bits, its choice on processors without wider vectors. If the restart fails,
/// pictures are drawn with the driver's own choice.
///
/// Only the program itself may call this, before anything else.
#[cfg(target_os = "linux")]
pub fn settle(words: &[std::ffi::OsString]) {
    use std::os::unix::process::CommandExt;
    let [program, command, rest @ ..] = words else { return };
    let [variable, width] = VECTOR_WIDTH;
    // A process cannot change its own environment safely, so the restarted one gets it.
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
