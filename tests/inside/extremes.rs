//! The least and the greatest values of a run.

use super::*;

#[test]
fn the_first_of_equal_values_counts_in_any_order() {
    let moments = [(0.0, 1.0), (0.1, 3.0), (0.2, 0.5), (0.3, 3.0), (0.4, 0.5), (0.5, f64::NAN)];
    let noted = |order: &[usize]| {
        let mut extremes = Extremes::default();
        for (time, elastic) in order.iter().map(|&at| moments[at]) {
            let all = Diagnostics { elastic, ..Diagnostics::default() };
            extremes.note(&[Diagnostic::Elastic], time, &all);
        }
        extremes
    };
    let there = noted(&[0, 1, 2, 3, 4, 5]);
    assert_eq!(there.least["elastic"], Extreme { value: 0.5, time: 0.2 });
    assert_eq!(there.greatest["elastic"], Extreme { value: 3.0, time: 0.1 });
    assert_eq!((there.least.len(), there.greatest.len()), (1, 1));
    assert_eq!(noted(&[5, 4, 3, 2, 1, 0]), there);
}
