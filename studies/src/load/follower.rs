//! A cantilever under a force that follows its end.

use super::{Case, at_rest};
use crate::material::{Bar, Model};
use glam::DVec3;
use localshape::sim::{Load, Material};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };
/// `P L²/EI`, and length over depth.
const LOAD: f64 = 2.0;
const SLENDERNESS: u32 = 20;

pub(super) const CASE: Case = Case {
    name: "An elastica under a force that follows its end",
    what: "The deflection across of the end of a cantilever of 20 : 1 under a force that stays at right angles to it, `P L²/EI = 2`, beside the elastica. \
           Seen from the end its slope obeys `φ'' = −(P L²/EI) cos φ` with `φ = φ' = 0` there, so that no end has to be guessed. The elastica is \
           thin: shear adds 0.1 %.",
    measure,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let across = 1 << refined;
    let bar = Bar::new(model.elements, [across, 1, SLENDERNESS * across], 1.0 / f64::from(across), 1.0);
    let (made, material) = bar.model(model, MATERIAL)?;
    let load = LOAD * bar.rigidity(material) / (bar.length * bar.length);
    let shares: Vec<f64> = bar.load(DVec3::X).iter().map(|force| force.x).collect();
    let [low, high] = bar.sides();
    let follows = move |_: f64, position: &[DVec3], forces: &mut [DVec3]| {
        let mean = |nodes: &[usize]| nodes.iter().map(|&node| position[node]).sum::<DVec3>() / nodes.len() as f64;
        let across = (mean(&high) - mean(&low)).normalize_or_zero();
        forces.iter_mut().zip(&shares).for_each(|(force, share)| *force += across * (load * share));
    };
    let load: Arc<dyn Load> = Arc::new(follows);
    let found = at_rest(&bar.body, made.as_ref(), bar.held(), vec![load])?;
    Some(bar.tip(&found).x / bar.length / elastica())
}

/// The deflection across over the length, from the end inwards, by Runge and Kutta's method.
fn elastica() -> f64 {
    const STEPS: u32 = 1000;
    let step = 1.0 / f64::from(STEPS);
    // Slope and curvature, then the way along the end's own direction and across it.
    let rate = |[slope, curvature, ..]: [f64; 4]| {
        let (sine, cosine) = libm::sincos(slope);
        [curvature, -LOAD * cosine, cosine, sine]
    };
    let moved = |from: [f64; 4], rate: [f64; 4], by: f64| [0, 1, 2, 3].map(|at| from[at] + by * rate[at]);
    let [slope, _, along, across] = (0..STEPS).fold([0.0; 4], |from, _| {
        let one = rate(from);
        let two = rate(moved(from, one, 0.5 * step));
        let three = rate(moved(from, two, 0.5 * step));
        let four = rate(moved(from, three, step));
        moved(from, [0, 1, 2, 3].map(|at| (one[at] + 2.0 * two[at] + 2.0 * three[at] + four[at]) / 6.0), step)
    });
    // Turned so that the bar begins along z.
    let (sine, cosine) = libm::sincos(slope);
    (along * sine - across * cosine).abs()
}
