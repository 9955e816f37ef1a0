//! Settings of graphics drivers, for equal pictures on every machine and less memory.

#[cfg(target_os = "linux")]
use super::failure::note;

/// The vector width (bits) of the software driver, unless the user has set another one that works.
const VECTOR_WIDTH: [&str; 2] = ["LP_NATIVE_VECTOR_WIDTH", "256"];

/// The widths that work. With less, the default on processors without wide vectors, Mesa 22.3 writes beyond its memory.
const WIDTHS: [&str; 2] = [VECTOR_WIDTH[1], "512"];

/// The number of heaps of the C library (glibc), unless the user has set it. With a heap for each thread, several
/// megabytes are reserved that no thread uses.
#[cfg(target_os = "linux")]
const HEAPS: [&str; 2] = ["MALLOC_ARENA_MAX", "1"];

/// The variable of the environment with which a software driver draws the same on every processor, and its value; `None` if it has a
/// possible one. It is read when the driver is loaded.
pub fn width_to_set() -> Option<[&'static str; 2]> {
    let width = std::env::var_os(VECTOR_WIDTH[0]);
    let is_possible = width.is_some_and(|width| WIDTHS.iter().any(|possible| width == *possible));
    (cfg!(target_os = "linux") && !is_possible).then_some(VECTOR_WIDTH)
}

/// Restarts the program (`exec`) with one heap and a fixed vector width of the software driver, so that pictures are
/// equal on every processor. If the restart fails, the driver chooses the width.
///
/// Only the program itself may call this, before anything else.
#[cfg(target_os = "linux")]
pub fn settle(words: &[std::ffi::OsString]) {
    use std::env::var_os;
    use std::os::unix::process::CommandExt;
    let [program, command, rest @ ..] = words else { return };
    // A process cannot change its own environment safely, so the restarted one gets it.
    let is_scene = |word: &std::ffi::OsString| word.to_string_lossy().ends_with(".toml");
    let draws = command == "render" || command == "figure" || command == "compare" && rest.iter().any(is_scene);
    // `info` names the driver with the settings for drawing.
    let draws = draws || command == "info";
    let is_quiet = |word: &std::ffi::OsString| word == "--quiet" || word.to_string_lossy().starts_with("-q");
    let width = var_os(VECTOR_WIDTH[0]).filter(|width| !width.is_empty());
    let is_possible = width_to_set().is_none();
    let to_set = [(VECTOR_WIDTH, is_possible), (HEAPS, var_os(HEAPS[0]).is_some())];
    let to_set: Vec<_> =
        to_set.into_iter().filter_map(|([name, value], is_set)| (!is_set).then_some((name, value))).collect();
    if !draws || to_set.is_empty() {
        return;
    }
    if let Some(width) = width.filter(|_| !is_possible && !rest.iter().any(is_quiet)) {
        let ([name, usual], [_, other], width) = (VECTOR_WIDTH, WIDTHS, width.display());
        note(&format!(
            "{name} is {width}, with which software drivers may crash; expected {usual} or {other}, so {usual} is taken"
        ));
    }
    let Ok(image) = std::env::current_exe() else { return };
    let _error = std::process::Command::new(image).arg0(program).arg(command).args(rest).envs(to_set).exec();
}

/// Only Linux needs these settings.
#[cfg(not(target_os = "linux"))]
pub fn settle(_words: &[std::ffi::OsString]) {}
