//! Settings of graphics drivers, for the same pictures on every machine, and of the memory that drawing takes.

#[cfg(target_os = "linux")]
use super::failure::note;

/// The vector width (bits) of the software driver, unless the user has set another one that it can work with.
#[cfg(target_os = "linux")]
const VECTOR_WIDTH: [&str; 2] = ["LP_NATIVE_VECTOR_WIDTH", "256"];

/// Those that it can work with: Mesa 22.3 writes beyond its memory with less, its choice on processors without wider vectors.
#[cfg(target_os = "linux")]
const WIDTHS: [&str; 2] = [VECTOR_WIDTH[1], "512"];

/// Heaps of the C library (glibc), unless the user has set it. With one for each thread, several megabytes are held that no
/// thread uses.
#[cfg(target_os = "linux")]
const HEAPS: [&str; 2] = ["MALLOC_ARENA_MAX", "1"];

/// Restarts the program (`exec`) with one heap, and with the vector width of the software driver fixed, so that pictures are
/// the same on every processor. If the restart fails, pictures are drawn with the driver's own choice.
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
    // `info` names the driver as it is when pictures are drawn.
    let draws = draws || command == "info";
    let is_quiet = |word: &std::ffi::OsString| word == "--quiet" || word.to_string_lossy().starts_with("-q");
    let width = var_os(VECTOR_WIDTH[0]).filter(|width| !width.is_empty());
    let is_possible = width.as_ref().is_some_and(|width| WIDTHS.iter().any(|possible| width == possible));
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

/// Nothing needs to be settled here.
#[cfg(not(target_os = "linux"))]
pub fn settle(_words: &[std::ffi::OsString]) {}
