//! The study of contact, with small protocols.

use super::*;
use crate::reading::documented;

#[test]
fn what_must_hold_holds_in_small() {
    let study = Contact { impacts: 2, rest: 0.2, refined: 1, periods: 2, starts: 1 };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert!(results.all.len() > 50);
    for (group, one) in &results.all {
        assert!(one.value.is_finite(), "{one:?}");
        // Coarse bars and balls have errors of their own, and a pile has no time to settle.
        if matches!(*group, "impacts" | "shapes") {
            assert_ne!(one.holds(), Some(false), "{one:?}");
        }
    }
    assert_eq!(results.table().heads, documented("contact.csv"));
    assert!(results.text().contains("## Impacts"));
    assert!(matches!(results.page().contents, Contents::Plots(plots) if plots.len() > 4));
}

#[test]
fn figures_hold_up_to_what_is_asked() {
    let most = |value: f64| Measured::most("one".to_owned(), value, 1e-3).holds();
    assert_eq!([1e-3, 2e-3, f64::NAN].map(most), [Some(true), Some(false), Some(false)]);
    let near = |value: f64| Measured::near("one".to_owned(), value, 2.0, 0.01).holds();
    assert_eq!([1.99, 2.01, 2.1, f64::NAN].map(near), [Some(true), Some(true), Some(false), Some(false)]);
    assert_eq!(Measured::shown("one".to_owned(), 1.0).holds(), None);
}
