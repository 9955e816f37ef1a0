//! Parallel work whose results come in order.

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
