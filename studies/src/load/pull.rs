//! A bar that is pulled far.

use super::{Case, at_rest, dead};
use crate::material::{Bar, Model};
use glam::DVec3;
use localshape::sim::Material;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.3 };
/// The force over the section at rest and over Young's modulus.
const STRESS: f64 = 0.3;

pub(super) const CASE: Case = Case {
    name: "A bar that is pulled",
    what: "The stretch `λ` of a free bar under equal forces on both ends, which do not turn: `F/A = 0.3 E`, `ν = 0.3`. It is uniform, so that any cells \
           have the value of the law: `F/A = E (λ − 1)`, of `metric` `E λ (λ² − 1)/2`, and of `neo-hookean` that with the stretch across at which \
           there is no stress across.",
    measure,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let bar = Bar::new(model.elements, [1 << refined, 1 << refined, 2 << refined], 0.1 / f64::from(1 << refined), 1.0);
    let (made, _) = bar.model(model, MATERIAL)?;
    let [width, depth] = bar.section;
    let pull = DVec3::Z * (STRESS * MATERIAL.young * width * depth);
    let forces = bar.load(pull).into_iter().zip(bar.load_on(0, -pull)).map(|(one, other)| one + other).collect();
    let found = at_rest(&bar.body, made.as_ref(), &[], vec![dead(forces)])?;
    let stretch = 1.0 + (bar.tip(&found) - bar.foot(&found)).z / bar.length;
    Some(stretch / exact(model.kind))
}

/// The stretch by the law.
fn exact(kind: &str) -> f64 {
    match kind {
        "metric" => root(|stretch| 0.5 * stretch * (stretch * stretch - 1.0)),
        "neo-hookean" => root(neo_hookean),
        _ => 1.0 + STRESS,
    }
}

/// The stress over Young's modulus of the stable neo-Hookean law: `μ F + (λ + μ)(J − α) cof F` with `α = 1 + μ/(λ + μ)`.
fn neo_hookean(stretch: f64) -> f64 {
    let shear = 0.5 / (1.0 + MATERIAL.poisson);
    let sum = shear + MATERIAL.poisson / ((1.0 + MATERIAL.poisson) * (1.0 - 2.0 * MATERIAL.poisson));
    let least = 1.0 + shear / sum;
    // No stress across: `μ m + (λ + μ)(λ m² − α) λ m = 0`.
    let square = (least - shear / (sum * stretch)) / stretch;
    shear * stretch + sum * (stretch * square - least) * square
}

/// The stretch with the stress, by bisection.
fn root(stress: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (1.0, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stress(middle) < STRESS { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
