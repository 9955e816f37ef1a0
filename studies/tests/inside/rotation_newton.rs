//! Newton's method against an independent implementation.

use super::*;
use localshape::sim::rotation::moment;

#[test]
fn the_symmetric_matrix_has_the_errors_of_an_independent_implementation() {
    let sides = DVec3::new(1.0, 0.7, 0.4);
    let corner = |bit: u32| sides * DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1) - 0.5));
    let rest: Vec<_> = (0..8).map(corner).collect();
    for (degrees, independent) in [(10f64, &[4.1e-4, 4e-12][..]), (40.0, &[0.033, 1.9e-6])] {
        let turned = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), degrees.to_radians());
        let at_rest = moment(&rest, rest.iter().map(|&r| turned * r));
        for (passes, expected) in (1..).zip(independent) {
            let difference = symmetric(at_rest, DQuat::IDENTITY, passes) * turned.inverse();
            let error = 2.0 * difference.xyz().length().min(1.0).asin();
            // The independent values are for another axis; each pass raises a factor to its third power.
            let factor = 2f64.powi(3i32.pow(passes - 1));
            assert!((expected / factor..expected * factor).contains(&error), "{degrees}°, {passes}: {error:e}");
        }
    }
}
