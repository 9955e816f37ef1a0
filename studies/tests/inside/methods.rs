//! Compositions.

use super::*;

/// Drifts and kicks add up to one step each.
#[test]
fn shares_add_up_to_the_step() {
    for Composition { drifts, kicks } in [FOREST_RUTH, BLANES_MOAN, KAHAN_LI] {
        let is_even = drifts.len() > kicks.len();
        let sum = |shares: &[f64], has_middle: bool| {
            let middle = if has_middle { shares[shares.len() - 1] } else { 0.0 };
            2.0 * shares.iter().sum::<f64>() - middle
        };
        let [drift, kick] = [sum(drifts, is_even), sum(kicks, !is_even)];
        assert!((drift - 1.0).abs() < 1e-14 && (kick - 1.0).abs() < 1e-14, "{drift} {kick}");
    }
}
