//! Parallel work whose results are consumed in order, computed a few ahead.

use super::AnimationError;
use std::collections::VecDeque;
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of results for each thread that may wait.
const AHEAD: usize = 2;
/// Greatest number of threads: more would keep more frames in memory, and these keep up with any disk.
const MOST: usize = 4;

/// Calls `work` for each of `0..count` on `threads` threads and `take` with the results, in order. Stops at the first
/// error of either.
pub(super) fn in_order<T: Send>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> Result<T, AnimationError> + Sync,
    mut take: impl FnMut(usize, T) -> Result<(), AnimationError>,
) -> Result<(), AnimationError> {
    let threads = threads.clamp(1, MOST);
    std::thread::scope(|scope| {
        let work = &work;
        let start = |first: usize| {
            // In addition to the buffered results, each thread holds one that it is about to send.
            let (results, taken) = sync_channel(AHEAD - 1);
            scope.spawn(move || {
                for at in (first..count).step_by(threads) {
                    let result = work(at);
                    // The receiver is dropped after an error, or at the end.
                    let failed = result.is_err();
                    if results.send(result).is_err() || failed {
                        return;
                    }
                }
            });
            taken
        };
        let results: Vec<_> = (0..threads.min(count)).map(start).collect();
        for at in 0..count {
            // A thread that sends nothing has panicked; the scope then panics as well.
            let result = results[at % threads].recv().map_err(|_| AnimationError::Stopped)?;
            take(at, result?)?;
        }
        Ok(())
    })
}

/// A cache of computed values, which keeps the newest ones.
pub(super) struct Kept<T, F> {
    make: F,
    most: usize,
    places: Mutex<VecDeque<(usize, Place<T>)>>,
}

/// A value, once it is computed.
type Place<T> = Arc<Mutex<Option<Arc<T>>>>;

impl<T, F: Fn(usize) -> Result<T, AnimationError>> Kept<T, F> {
    /// A cache for this number of threads.
    pub(super) fn new(threads: usize, make: F) -> Self {
        Self { make, most: 2 * threads.clamp(1, MOST) + 2, places: Mutex::new(VecDeque::new()) }
    }

    /// A value. If another thread is computing it, waits for the result.
    pub(super) fn get(&self, key: usize) -> Result<Arc<T>, AnimationError> {
        let place = self.place(key);
        let mut made = place.lock().unwrap_or_else(PoisonError::into_inner);
        match &*made {
            Some(made) => Ok(Arc::clone(made)),
            None => Ok(Arc::clone(made.insert(Arc::new((self.make)(key)?)))),
        }
    }

    fn place(&self, key: usize) -> Place<T> {
        let mut places: MutexGuard<'_, VecDeque<_>> = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, place)) = places.iter().find(|(known, _)| *known == key) {
            return Arc::clone(place);
        }
        if places.len() == self.most {
            places.pop_front();
        }
        let place = Place::default();
        places.push_back((key, Arc::clone(&place)));
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn results_come_in_order_and_not_far_ahead() {
        for threads in [1, 3] {
            let (taken, mut seen) = (AtomicUsize::new(0), Vec::new());
            let work = |at| {
                assert!(at <= taken.load(Ordering::SeqCst) + threads * AHEAD + 1);
                Ok(at * at)
            };
            in_order(100, threads, work, |at, result| {
                taken.store(at, Ordering::SeqCst);
                seen.push(result);
                Ok(())
            })
            .unwrap();
            assert_eq!(seen, (0..100).map(|at| at * at).collect::<Vec<_>>());
        }
    }

    #[test]
    fn errors_of_either_side_end_it() {
        let wrong = || AnimationError::Wrong("no".to_owned());
        let mut taken = 0;
        let take = |_, ()| {
            taken += 1;
            Ok(())
        };
        assert!(in_order(100, 2, |at| if at < 7 { Ok(()) } else { Err(wrong()) }, take).is_err());
        assert_eq!(taken, 7);
        assert!(in_order(100, 2, |_| Ok(()), |at, ()| if at < 5 { Ok(()) } else { Err(wrong()) }).is_err());
        in_order(0, 2, |_| Ok(()), |_, ()| Ok(())).unwrap();
    }

    #[test]
    fn things_are_made_once() {
        let made = AtomicUsize::new(0);
        let kept = Kept::new(1, |key| {
            made.fetch_add(1, Ordering::SeqCst);
            Ok(key)
        });
        for key in 1..50 {
            assert_eq!((*kept.get(key - 1).unwrap(), *kept.get(key).unwrap()), (key - 1, key));
        }
        assert_eq!(made.load(Ordering::SeqCst), 50);
    }
}
