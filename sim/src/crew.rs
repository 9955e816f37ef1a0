//! A pool of threads for steps and diagnostics. The caller makes a [`Crew`] and passes it to a [`World`](super::World); the
//! simulation starts no threads by itself.

#![expect(unsafe_code, reason = "work that borrows is lent to threads that outlive it, and taken back before it ends")]

use std::fmt;
use std::hint::spin_loop;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

/// The number of times that a waiting thread polls before it yields its core after each poll: a few microseconds. Where there
/// are more threads than cores, another thread needs the core to finish what this one waits for.
const BUSY: u32 = 100;
/// The number of times that a helper polls for work before it sleeps: some hundred microseconds on an idle core.
const LOOKS: u32 = 1000;

/// The work of one thread of a crew, called with the number of the thread.
type Work<'a> = dyn Fn(usize) + Sync + 'a;

/// The calling thread and its helper threads, which wait for work between steps and end when the crew is dropped.
pub struct Crew {
    shared: Arc<Shared>,
    helpers: Vec<JoinHandle<()>>,
    /// Locked during a round, as there is one at a time.
    turn: Mutex<()>,
}

struct Shared {
    /// The work of the present round.
    work: Mutex<Option<&'static Work<'static>>>,
    /// The number of rounds of work; changes while `work` is locked.
    round: AtomicU64,
    wake: Condvar,
    /// Helpers that have not finished the present round.
    busy: AtomicUsize,
    panicked: AtomicBool,
    end: AtomicBool,
}

impl Crew {
    /// A crew of so many threads, including the calling one: 1 for no helpers.
    pub fn new(threads: usize) -> Self {
        let shared = Arc::new(Shared {
            work: Mutex::new(None),
            round: AtomicU64::new(0),
            wake: Condvar::new(),
            busy: AtomicUsize::new(0),
            panicked: AtomicBool::new(false),
            end: AtomicBool::new(false),
        });
        let helpers = (1..threads)
            .map_while(|number| {
                let shared = Arc::clone(&shared);
                std::thread::Builder::new().name("step".into()).spawn(move || shared.help(number)).ok()
            })
            .collect();
        Self { shared, helpers, turn: Mutex::default() }
    }

    /// The number of threads: at least one, and less than requested if the system refused to start some.
    pub fn threads(&self) -> usize {
        self.helpers.len() + 1
    }

    /// Calls `work` with each number below [`Self::threads`], in parallel, and returns when all have returned. The
    /// calling thread has number 0. `work` must not use the crew itself.
    ///
    /// # Panics
    /// If `work` panics on any thread.
    pub fn run(&self, work: &Work<'_>) {
        let Shared { busy, panicked, .. } = &*self.shared;
        if self.helpers.is_empty() {
            return work(0);
        }
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: helpers use it only while they are busy, and this function waits until none is, also after a panic.
        let lent = unsafe { std::mem::transmute::<&Work<'_>, &'static Work<'static>>(work) };
        busy.store(self.helpers.len(), Ordering::Relaxed);
        self.shared.announce(Some(lent));
        let own = catch_unwind(AssertUnwindSafe(|| work(0)));
        wait_until(|| busy.load(Ordering::Acquire) == 0);
        if let Err(panic) = own {
            panicked.store(false, Ordering::Relaxed);
            std::panic::resume_unwind(panic);
        }
        assert!(!panicked.swap(false, Ordering::Relaxed), "a thread that helped has panicked");
    }

    /// Calls `work` with the number of each item and the item, in parallel and in no order.
    ///
    /// # Panics
    /// If `work` panics on any thread.
    pub(crate) fn each<T: Send>(&self, items: &mut [T], work: impl Fn(usize, &mut T) + Sync) {
        if self.threads().min(items.len()) <= 1 {
            return items.iter_mut().enumerate().for_each(|(number, item)| work(number, item));
        }
        let queue = Mutex::new(items.iter_mut().enumerate());
        self.run(&|_| {
            let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            while let Some((number, item)) = next() {
                work(number, item);
            }
        });
    }

    /// The results of `work` for the chunks of `count` elements, in order. They depend on `count` alone, and so do sums over them.
    ///
    /// # Panics
    /// If `work` panics on any thread.
    pub(crate) fn map_chunks<T: Send>(&self, count: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
        /// Elements in one task of a thread.
        const CHUNK: usize = 1024;
        self.map(count.div_ceil(CHUNK), |chunk| work(chunk * CHUNK..count.min((chunk + 1) * CHUNK)))
    }

    /// The results of `work` for each number below `count`, in order; each thread computes a range of them.
    ///
    /// # Panics
    /// If `work` panics on any thread.
    pub(crate) fn map<T: Send>(&self, count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let threads = self.threads();
        if threads.min(count) <= 1 {
            return (0..count).map(work).collect();
        }
        let ranges: Vec<Mutex<Vec<T>>> = (0..threads).map(|_| Mutex::default()).collect();
        self.run(&|me| {
            let own = (me * count / threads..(me + 1) * count / threads).map(&work).collect();
            *ranges[me].lock().unwrap_or_else(PoisonError::into_inner) = own;
        });
        ranges.into_iter().flat_map(|range| range.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
    }
}

impl Default for Crew {
    /// The calling thread alone.
    fn default() -> Self {
        Self::new(1)
    }
}

impl fmt::Debug for Crew {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Crew").field("threads", &self.threads()).finish()
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Relaxed);
        self.shared.announce(None);
        for helper in self.helpers.drain(..) {
            // A helper catches the panics of its work, so joining succeeds.
            drop(helper.join());
        }
    }
}

impl Shared {
    fn announce(&self, work: Option<&'static Work<'static>>) {
        let mut place = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        *place = work;
        self.round.fetch_add(1, Ordering::Release);
        drop(place);
        self.wake.notify_all();
    }

    /// The main loop of a helper.
    fn help(&self, number: usize) {
        let mut round = 0;
        loop {
            let mut looks = 0;
            while looks < LOOKS && self.round.load(Ordering::Acquire) == round {
                pause(looks);
                looks += 1;
            }
            let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
            while self.round.load(Ordering::Acquire) == round {
                work = self.wake.wait(work).unwrap_or_else(PoisonError::into_inner);
            }
            round += 1;
            if self.end.load(Ordering::Relaxed) {
                return;
            }
            let own = *work;
            drop(work);
            if let Some(own) = own
                && catch_unwind(AssertUnwindSafe(|| own(number))).is_err()
            {
                self.panicked.store(true, Ordering::Relaxed);
            }
            self.busy.fetch_sub(1, Ordering::Release);
        }
    }
}

/// Waits until another thread has met a condition.
pub(super) fn wait_until(is_so: impl Fn() -> bool) {
    let mut looks = 0;
    while !is_so() {
        pause(looks);
        looks = (looks + 1).min(BUSY);
    }
}

/// Waits for a moment, after this many polls.
fn pause(looks: u32) {
    if looks < BUSY && !cfg!(miri) { spin_loop() } else { std::thread::yield_now() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everyone_works_once_in_each_round() {
        for threads in [1, 2, 5] {
            let crew = Crew::new(threads);
            let counts: Vec<_> = (0..threads).map(|_| AtomicUsize::new(0)).collect();
            for round in 1..50 {
                crew.run(&|number| {
                    counts[number].fetch_add(1, Ordering::Relaxed);
                });
                assert!(counts.iter().all(|count| count.load(Ordering::Relaxed) == round));
            }
        }
    }

    #[test]
    fn threads_wait_for_each_other_where_there_are_more_than_cores() {
        let crew = Crew::new(4 * std::thread::available_parallelism().map_or(1, usize::from));
        let count = AtomicUsize::new(0);
        for round in 1..20 {
            crew.run(&|_| {
                count.fetch_add(1, Ordering::Relaxed);
                wait_until(|| count.load(Ordering::Relaxed) == round * crew.threads());
            });
        }
    }

    #[test]
    fn results_are_in_order() {
        for (threads, count) in
            [1, 2, 5].into_iter().flat_map(|threads| [0, 1, 3, 5, 100].map(|count| (threads, count)))
        {
            assert_eq!(Crew::new(threads).map(count, |at| at), (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        let crew = Crew::new(3);
        for member in 0..3 {
            let run = catch_unwind(AssertUnwindSafe(|| crew.run(&|number| assert_ne!(number, member))));
            assert!(run.is_err());
            crew.run(&|_| ());
        }
    }
}
