//! Error against time, with few cells and short turns.

use super::*;
use crate::reading::documented;

#[test]
fn every_model_has_an_error_and_a_time() {
    let study = Time { across: vec![1], fine: [1, 2], rounds: 1, turn: 50 };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert_eq!(results.timed.len(), MODELS.len());
    for one in &results.timed {
        assert!(one.step > 0.0 && one.time.median > 0.0 && one.error.is_finite(), "{one:?}");
        assert!((0.0..1.0).contains(&one.across_length), "{one:?}");
    }
    assert_eq!(results.table().heads, documented("beam-time.csv"));
    assert!(results.text().contains("| `mass-spring` | hexahedra | 1 | 8 |"));
}
