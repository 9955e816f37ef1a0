//! A bar that is pulled and pressed far.

use super::{Case, reactions};
use crate::material::{Bar, Model, hold, rest_of};
use glam::DVec3;
use localshape::sim::{Material, Surroundings};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.3 };

pub(super) const STRETCHED: Case = Case {
    name: "A bar stretched to 1.5 of its length",
    what: "The force on the holds of a bar, `ν = 0.3`, whose ends are as thin as they are in uniaxial stretch `λ`, beside that of the law over the area at \
           rest, with the stretch across `m` at which there is no stress across. The stress is `E (λ − 1)`; of `metric` `E λ (λ² − 1)/2`; of `neo-hookean` \
           `μ λ + (μ + λ')(J − α) m²`; of `shape-based` `2 μ (λ − 1) + λ' (J − 1) m²`. It is uniform, so that any cells have it.",
    measure: |model, refined| measure(model, refined, 1.5),
    levels: 2,
    with_springs: false,
};

pub(super) const PRESSED: Case = Case {
    name: "A bar pressed to 0.8 of its length",
    what: "The same.",
    measure: |model, refined| measure(model, refined, 0.8),
    ..STRETCHED
};

fn measure(model: &Model, refined: u32, stretch: f64) -> Option<f64> {
    let bar = Bar::new(model.elements, [1 << refined, 1 << refined, 2 << refined], 0.1 / f64::from(1 << refined), 1.0);
    let (made, _) = bar.model(model, MATERIAL)?;
    let (stress, across) = law(model.kind, stretch);
    let mut start: Vec<_> = bar.body.rest().iter().map(|&rest| rest.with_z(rest.z * stretch)).collect();
    // Ends are as thin as the bar; a corner of the lattice is at y = 0, and the middle at x = 0.
    bar.ends.iter().flatten().for_each(|&node| start[node] *= DVec3::new(across, across, 1.0));
    let around = Surroundings { grips: bar.ends.iter().map(|end| hold(end)).collect(), ..Surroundings::default() };
    let parts = [(Arc::clone(&bar.body), made.as_ref())];
    let position = rest_of(&parts, start, &around, 1.0)?;
    let [below, above] = reactions(&parts, position, around, 1)?[..] else { return None };
    let [width, depth] = bar.section;
    Some(0.5 * (above - below).z / (stress * MATERIAL.young * width * depth))
}

/// The stress by the law, over the section at rest and over Young's modulus, and the stretch across.
fn law(kind: &str, stretch: f64) -> (f64, f64) {
    let Material { poisson, .. } = MATERIAL;
    let green = 0.5 * (stretch * stretch - 1.0);
    match kind {
        "metric" => (stretch * green, libm::sqrt(1.0 - 2.0 * poisson * green)),
        "neo-hookean" => neo_hookean(stretch),
        "shape-based" => shape_based(stretch),
        _ => (stretch - 1.0, 1.0 - poisson * (stretch - 1.0)),
    }
}

/// The same of the shape model's elements that are strained uniformly: `2 μ (F − 1) + λ (J − 1) cof F`.
fn shape_based(stretch: f64) -> (f64, f64) {
    let [shear, lame] = lame();
    let stress =
        |across: f64| 2.0 * shear * (across - 1.0) + lame * (stretch * across * across - 1.0) * stretch * across;
    // No stress across, by bisection.
    let (mut low, mut high) = (0.5, 1.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stress(middle) < 0.0 { low = middle } else { high = middle }
    }
    (2.0 * shear * (stretch - 1.0) + lame * (stretch * low * low - 1.0) * low * low, low)
}

/// `μ` and `λ` over Young's modulus.
fn lame() -> [f64; 2] {
    let Material { poisson, .. } = MATERIAL;
    [0.5 / (1.0 + poisson), poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))]
}

/// The same of the stable neo-Hookean law: `μ F + (λ + μ)(J − α) cof F` with `α = 1 + μ/(λ + μ)`.
fn neo_hookean(stretch: f64) -> (f64, f64) {
    let [shear, lame] = lame();
    let sum = shear + lame;
    let least = 1.0 + shear / sum;
    // No stress across: `μ m + (λ + μ)(λ m² − α) λ m = 0`.
    let square = (least - shear / (sum * stretch)) / stretch;
    (shear * stretch + sum * (stretch * square - least) * square, libm::sqrt(square))
}
