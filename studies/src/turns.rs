//! Times of tasks that take turns, so that other load of the machine affects all alike.

use crate::progress::Watch;
use std::time::Instant;

/// The time of a thread: its processor time, or wall time if the system does not provide it.
pub(crate) struct Clock {
    wall: Instant,
    processor: Option<f64>,
}

impl Clock {
    /// Starts the clock.
    pub(crate) fn start() -> Self {
        Self { wall: Instant::now(), processor: processor_time() }
    }

    /// The time since the start (s).
    pub(crate) fn seconds(&self) -> f64 {
        match (self.processor, processor_time()) {
            (Some(before), Some(now)) => now - before,
            _ => self.wall_seconds(),
        }
    }

    /// The wall time since the start (s).
    pub(crate) fn wall_seconds(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }
}

/// The kind of time of [`Clock::seconds`].
pub(crate) fn kind_of_time() -> &'static str {
    if processor_time().is_some() { "processor" } else { "wall" }
}

/// The processor time of this thread (s), if the system provides it.
fn processor_time() -> Option<f64> {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    None
}

/// The times of a number of turns of each of `count` tasks, which `time` runs by their numbers; `None` if `watch`,
/// which is called after each turn, stops them. The order is rotated, so that no task always follows the same one.
pub(crate) fn take_turns(
    count: usize,
    rounds: u32,
    watch: &Watch<'_>,
    mut time: impl FnMut(usize) -> f64,
) -> Option<Vec<Vec<f64>>> {
    let mut times = vec![Vec::new(); count];
    for turn in 0..count * rounds as usize {
        let number = (turn / count + turn) % count;
        times[number].push(time(number));
        if !watch(1) {
            return None;
        }
    }
    Some(times)
}

/// The machine in a few words, for tables of times.
pub(crate) fn machine() -> String {
    // Only Linux has this file.
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = name.map_or(String::new(), |(_, name)| format!("{}, ", name.trim()));
    format!("{name}{} {}", std::env::consts::ARCH, std::env::consts::OS)
}
