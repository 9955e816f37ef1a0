//! Times of tasks that take turns, so that other load of the machine affects all alike.

use crate::study::Watch;
use localshape::internals::{Clock, Spent, thread_time};

/// The time of this thread for a task (s): its processor time, or wall time if the system does not provide it.
pub(crate) fn seconds(task: impl FnOnce()) -> f64 {
    let Spent { wall, cpu } = spent(task);
    cpu.unwrap_or(wall)
}

/// The wall time and this thread's processor time for a task (s).
pub(crate) fn spent(task: impl FnOnce()) -> Spent {
    let clock = Clock::thread();
    task();
    clock.spent()
}

/// The kind of time of [`seconds`].
pub(crate) fn kind_of_time() -> &'static str {
    if thread_time().is_some() { "processor" } else { "wall" }
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
