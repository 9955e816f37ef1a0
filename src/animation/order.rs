//! Work on many threads whose results are taken in order, a few ahead.

use super::AnimationError;
use std::collections::VecDeque;
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// So many results for each thread may wait to be taken.
const AHEAD: usize = 2;
/// Threads that work, at most: more would keep more frames in memory, and these keep up with any disk.
const MOST: usize = 4;

/// Does `work` for each of `0..count` on `threads` threads and hands the results to `take` in order. Ends with the first
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
            // Beside what waits here, a thread holds one more result, which it waits to hand over.
            let (results, taken) = sync_channel(AHEAD - 1);
            scope.spawn(move || {
                for at in (first..count).step_by(threads) {
                    let result = work(at);
                    // Nobody takes any more after an error, and without one only when all has ended.
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
            // A thread that sends nothing more has panicked, which the end of the scope tells.
            let result = results[at % threads].recv().map_err(|_| AnimationError::Stopped)?;
            take(at, result?)?;
        }
        Ok(())
    })
}

/// Things that are made when they are first asked for, and kept while they may be asked for again: the few newest.
pub(super) struct Kept<T, F> {
    make: F,
    most: usize,
    places: Mutex<VecDeque<(usize, Place<T>)>>,
}

/// One of them, once it is made.
type Place<T> = Arc<Mutex<Option<Arc<T>>>>;

impl<T, F: Fn(usize) -> Result<T, AnimationError>> Kept<T, F> {
    /// Kept for as many threads.
    pub(super) fn new(threads: usize, make: F) -> Self {
        Self { make, most: 2 * threads.clamp(1, MOST) + 2, places: Mutex::new(VecDeque::new()) }
    }

    /// One of them. Who asks for what another thread is making waits for it.
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
