//! Wall time and processor time by stage.

use serde::Serialize;
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// Time spent in a stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spent {
    /// Wall time (s).
    pub wall: f64,
    /// Processor time, summed over threads (s); `None` where the system does not provide it.
    pub cpu: Option<f64>,
}

impl AddAssign for Spent {
    fn add_assign(&mut self, other: Self) {
        self.wall += other.wall;
        // `None` is also the value before the first addition.
        self.cpu = [self.cpu, other.cpu].into_iter().flatten().reduce(|one, other| one + other);
    }
}

/// Times by stage. Stages overlap, so the sum of their wall times may exceed the total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timings {
    /// Advancing all runs and computing diagnostics.
    pub simulate: Spent,
    /// Laying out pictures; `None` without pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compose: Option<Spent>,
    /// Drawing and reading back. Its processor time is that of the thread that waits for the device and, with a
    /// software driver, of the driver's own threads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub draw: Option<Spent>,
    /// Compressing and writing frames, summed over the threads that do it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encode: Option<Spent>,
    /// Everything from the first step to the last file.
    pub total: Spent,
}

/// A moment from which wall time and processor time are measured.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    wall: Instant,
    cpu: Option<Duration>,
    read: fn() -> Option<Duration>,
}

impl Clock {
    /// Measures the processor time of the calling thread only; must be read on the same thread.
    pub fn thread() -> Self {
        Self::new(thread_time)
    }

    /// Measures the processor time of all threads.
    pub(crate) fn process() -> Self {
        Self::new(process_time)
    }

    fn new(read: fn() -> Option<Duration>) -> Self {
        Self { wall: Instant::now(), cpu: read(), read }
    }

    /// The time spent since.
    pub fn spent(&self) -> Spent {
        let cpu = self.cpu.zip((self.read)()).map(|(start, now)| now.saturating_sub(start).as_secs_f64());
        Spent { wall: self.wall.elapsed().as_secs_f64(), cpu }
    }
}

/// Processor time of the calling thread so far.
pub fn thread_time() -> Option<Duration> {
    #[cfg(unix)]
    return processor_clock(rustix::time::ClockId::ThreadCPUTime);
    #[cfg(not(unix))]
    None
}

/// Processor time of all threads so far.
fn process_time() -> Option<Duration> {
    #[cfg(unix)]
    return processor_clock(rustix::time::ClockId::ProcessCPUTime);
    #[cfg(not(unix))]
    None
}

#[cfg(unix)]
fn processor_clock(clock: rustix::time::ClockId) -> Option<Duration> {
    Duration::try_from(rustix::time::clock_gettime(clock)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_counts() {
        let clock = Clock::thread();
        let mut sum = clock.spent();
        assert!(sum.wall >= 0.0);
        sum = Spent { wall: 1.0, cpu: None };
        sum += Spent { wall: 0.5, cpu: Some(2.0) };
        sum += Spent { wall: 0.5, cpu: Some(1.0) };
        assert_eq!(sum, Spent { wall: 2.0, cpu: Some(3.0) });
    }
}
