//! Parallel work whose results are consumed in order, computed a few ahead.

use super::AnimationError;
use std::sync::mpsc::sync_channel;

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

#[cfg(test)]
#[path = "../../tests/inside/order.rs"]
mod tests;
