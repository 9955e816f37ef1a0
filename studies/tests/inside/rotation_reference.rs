//! References of rotations.

use super::*;

#[test]
fn what_is_refined_is_known_to_the_last_digits() {
    // A quarter turn of a stretched element is exact in doubles, so the optimum is, too.
    let quarter = DQuat::from_xyzw(0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2);
    let turn = DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z);
    for least in [1.0, 1e-3, -0.899] {
        let at_rest = (turn * DMat3::from_diagonal(DVec3::new(1.0, 0.9, least))).transpose();
        let near = (DQuat::from_xyzw(1e-9, -2e-9, 1e-9, 1.0) * quarter).normalize();
        assert!(angle(refined(at_rest, near), quarter) < 3e-16, "{least}");
        assert!(angle(by_svd(at_rest).expect("it converges"), quarter) < 1e-12, "{least}");
    }
}
