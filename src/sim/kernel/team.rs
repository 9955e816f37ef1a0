//! Threads that wait for work: a step is too short to start one, or to ask a pool.

#![expect(unsafe_code, reason = "what the threads work on lives as long as the call that hands it over")]

use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread::{self, JoinHandle, Thread};

/// Some threads, of which the caller's is the first. They end with it.
pub(in crate::sim) struct Team {
    shared: Arc<Shared>,
    others: Vec<JoinHandle<()>>,
    handles: Vec<Thread>,
}

type Work<'a> = dyn Fn(usize) + Sync + 'a;

struct Shared {
    /// What is to be done: it lives until `left` is 0.
    work: UnsafeCell<Option<*const Work<'static>>>,
    /// The number of the work, and `u64::MAX` to end.
    number: AtomicU64,
    /// Threads that are not done.
    left: AtomicUsize,
    /// Whether one of them panicked.
    failed: AtomicBool,
    asleep: Vec<AtomicBool>,
}

// SAFETY: `work` is written only while all threads wait, and published by `number`.
unsafe impl Sync for Shared {}
// SAFETY: as above; what it points to can be called from any thread.
unsafe impl Send for Shared {}

/// Looks for new work before a thread lets others run, or falls asleep: some tens of microseconds.
const PATIENCE: u32 = 2_000;

impl Team {
    /// So many threads in all, at least one.
    pub(in crate::sim) fn new(threads: usize) -> Self {
        let others = threads.saturating_sub(1);
        let shared = Arc::new(Shared {
            work: UnsafeCell::new(None),
            number: AtomicU64::new(0),
            left: AtomicUsize::new(0),
            failed: AtomicBool::new(false),
            asleep: (0..others).map(|_| AtomicBool::new(false)).collect(),
        });
        let start = |me| {
            let shared = Arc::clone(&shared);
            thread::spawn(move || shared.serve(me))
        };
        let others: Vec<_> = (0..others).map(start).collect();
        let handles = others.iter().map(|other| other.thread().clone()).collect();
        Self { shared, others, handles }
    }

    /// The number of threads.
    pub(in crate::sim) fn len(&self) -> usize {
        self.handles.len() + 1
    }

    /// Calls `work` on every thread with the thread's number, and waits for all.
    pub(in crate::sim) fn run(&mut self, work: &Work<'_>) {
        if self.handles.is_empty() {
            return work(0);
        }
        // SAFETY: no thread looks at it any more before this function returns. Nobody else writes: `self` is borrowed
        // mutably, and all threads are done with the work before.
        unsafe {
            *self.shared.work.get() =
                Some(std::mem::transmute::<*const Work<'_>, *const Work<'static>>(std::ptr::from_ref(work)));
        }
        self.shared.left.store(self.handles.len(), Ordering::Relaxed);
        self.hand_over(self.shared.number.load(Ordering::Relaxed) + 1);
        let own = catch_unwind(AssertUnwindSafe(|| work(0)));
        let mut looks = 0u32;
        while self.shared.left.load(Ordering::Acquire) > 0 {
            looks = looks.saturating_add(1);
            // With more threads than processors the others may need this one's.
            if looks > PATIENCE { thread::yield_now() } else { std::hint::spin_loop() }
        }
        if let Err(panic) = own {
            resume_unwind(panic);
        }
        assert!(!self.shared.failed.swap(false, Ordering::Relaxed), "a thread of the simulation panicked");
    }

    fn hand_over(&self, number: u64) {
        self.shared.number.store(number, Ordering::SeqCst);
        for (asleep, handle) in self.shared.asleep.iter().zip(&self.handles) {
            if asleep.load(Ordering::SeqCst) {
                handle.unpark();
            }
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.hand_over(u64::MAX);
        for other in self.others.drain(..) {
            // It has caught its panics.
            let _ = other.join();
        }
    }
}

impl Shared {
    /// What thread `me + 1` does all its life.
    fn serve(&self, me: usize) {
        let mut done = 0;
        loop {
            let number = self.next(me, done);
            if number == u64::MAX {
                return;
            }
            // SAFETY: the caller of `run` waits until this thread is done.
            let result = catch_unwind(AssertUnwindSafe(|| unsafe {
                if let Some(work) = *self.work.get() {
                    (*work)(me + 1);
                }
            }));
            if result.is_err() {
                self.failed.store(true, Ordering::Relaxed);
            }
            done = number;
            self.left.fetch_sub(1, Ordering::Release);
        }
    }

    /// Waits for work after that which is done.
    fn next(&self, me: usize, done: u64) -> u64 {
        for _ in 0..PATIENCE {
            let number = self.number.load(Ordering::Acquire);
            if number != done {
                return number;
            }
            std::hint::spin_loop();
        }
        self.asleep[me].store(true, Ordering::SeqCst);
        let number = loop {
            let number = self.number.load(Ordering::SeqCst);
            if number != done {
                break number;
            }
            thread::park();
        };
        self.asleep[me].store(false, Ordering::SeqCst);
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_thread_does_every_work_once() {
        for threads in [1, 2, 3] {
            let mut team = Team::new(threads);
            assert_eq!(team.len(), threads);
            let counts: Vec<_> = (0..threads).map(|_| AtomicUsize::new(0)).collect();
            for round in 1..50 {
                team.run(&|me| {
                    counts[me].fetch_add(1, Ordering::Relaxed);
                });
                assert!(counts.iter().all(|count| count.load(Ordering::Relaxed) == round));
                if round % 20 == 0 {
                    // Long enough to fall asleep.
                    thread::sleep(std::time::Duration::from_millis(2));
                }
            }
        }
    }

    #[test]
    fn a_panic_on_any_thread_is_the_callers_and_the_team_lives_on() {
        let mut team = Team::new(2);
        for culprit in 0..2 {
            let result = catch_unwind(AssertUnwindSafe(|| team.run(&|me| assert_ne!(me, culprit))));
            assert!(result.is_err());
        }
        team.run(&|_| ());
    }
}
