//! Settings of graphics drivers, for the same pictures on every machine, and of the memory that drawing takes.

/// The vector width (bits) of the software driver, unless the user has set it.
#[cfg(target_os = "linux")]
const VECTOR_WIDTH: [&str; 2] = ["LP_NATIVE_VECTOR_WIDTH", "256"];

/// Heaps of the C library (glibc), unless the user has set it. With one for each thread, several megabytes are held that no
/// thread uses.
#[cfg(target_os = "linux")]
const HEAPS: [&str; 2] = ["MALLOC_ARENA_MAX", "1"];

/// Restarts the program (`exec`) with one heap, and with the vector width of the software driver fixed, so that pictures are
/// the same on every processor. Mesa 22.3 also crashes with 128 bits, its choice on processors without wider vectors. If the
/// restart fails, pictures are drawn with the driver's own choice.
///
/// Only the program itself may call this, before anything else.
#[cfg(target_os = "linux")]
pub fn settle(words: &[std::ffi::OsString]) {
    use std::os::unix::process::CommandExt;
    let [program, command, rest @ ..] = words else { return };
    // A process cannot change its own environment safely, so the restarted one gets it.
    let is_scene = |word: &std::ffi::OsString| word.to_string_lossy().ends_with(".toml");
    let is_set = |setting: &[&str; 2]| std::env::var_os(setting[0]).is_some();
    let draws = command == "render" || command == "figure" || command == "compare" && rest.iter().any(is_scene);
    if !draws || is_set(&VECTOR_WIDTH) {
        return;
    }
    let Ok(image) = std::env::current_exe() else { return };
    let unset = [VECTOR_WIDTH, HEAPS].into_iter().filter(|setting| !is_set(setting)).map(|[name, value]| (name, value));
    let _error = std::process::Command::new(image).arg0(program).arg(command).args(rest).envs(unset).exec();
}

/// Nothing needs to be settled here.
#[cfg(not(target_os = "linux"))]
pub fn settle(_words: &[std::ffi::OsString]) {}
