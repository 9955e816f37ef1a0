//! Predicted limits of steps.

use super::support::{lattice, shape_based};
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{Grip, Integrator, Motion};

/// Nodes that are held all the time vibrate no more; those that are let go, or taken later, do.
#[test]
fn a_hold_counts_if_it_lasts() {
    let body = lattice(1, 0.1);
    let model = shape_based(1e4, 0.0);
    let limit = |grips: &[(f64, f64)]| {
        let hold = |&(from, until): &(f64, f64)| Grip { nodes: (0..7).collect(), from, until, motion: Motion::Still };
        let grips: Vec<_> = grips.iter().map(hold).collect();
        let restraint = Restraint { grips: &grips, duration: 1.0, mass_damping: 0.0 };
        Stability::of(&body, &model, Integrator::VelocityVerlet, restraint).largest
    };
    let free = limit(&[]);
    assert!(limit(&[(0.0, 1.0)]) > 1.01 * free && limit(&[(0.0, f64::INFINITY)]) > 1.01 * free);
    assert_eq!([limit(&[(0.0, 0.999)]), limit(&[(0.001, 1.0)])], [free; 2]);
}
