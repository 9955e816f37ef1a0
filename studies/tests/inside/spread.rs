//! Quantiles.

use super::*;

#[test]
fn quantiles_are_those_of_other_programs() {
    // numpy.percentile([7, 1, 3, 2], [0, 25, 50, 75, 100])
    let spread = Spread::of([7.0, 1.0, 3.0, 2.0]);
    assert_eq!(spread, Spread { least: 1.0, lower: 1.75, median: 2.5, upper: 4.0, most: 7.0 });
    let one = Spread::of([5.0]);
    assert_eq!((one.least, one.median, one.most), (5.0, 5.0, 5.0));
    assert!(Spread::of([]).median.is_nan());
    // NaN is sorted as the greatest.
    let odd = Spread::of([1.0, f64::NAN, 2.0]);
    assert!((odd.least, odd.median) == (1.0, 2.0) && odd.most.is_nan());
}
