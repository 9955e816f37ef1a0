//! A column that buckles.

use super::{Case, slender};
use crate::material::{Bar, Model};
use glam::DVec3;
use localshape::sim::Material;
use localshape::sim::model::ElasticModel;
use std::f64::consts::PI;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };
/// The loads at which the stiffness across is measured, over the buckling load: first that of the closed form, then what follows from these.
const LOADS: [[f64; 2]; 2] = [[0.0, 0.5], [0.9, 0.95]];
/// The force across, over the buckling load.
const PUSH: f64 = 1e-4;

pub(super) const CASE: Case = Case {
    name: "A column that buckles",
    what: "The load at which a column of 20 : 1 that is held at its foot has no stiffness across, from its stiffness at 0.9 and 0.95 of it, beside Euler's \
           `P = π² E I / 4 L²`, with the shear of F. Engesser (1889), `P / (1 + 6 P / 5 G A)`, and the length under the load.",
    measure,
    levels: 3,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let bar = slender(model, refined);
    let (made, material) = bar.model(model, MATERIAL)?;
    let [width, depth] = bar.section;
    let thin = PI * PI * bar.rigidity(material) / (4.0 * bar.length * bar.length);
    // The column becomes shorter by `P/EA`.
    let short = 1.0 - thin / (material.young * width * depth);
    let critical = thin / (short * short) / (1.0 + 1.2 * thin / (material.shear() * width * depth));
    LOADS.iter().try_fold(1.0, |about, &[one, other]| {
        let stiffness = |load| across_stiffness(&bar, made.as_ref(), load * about * critical, PUSH * critical);
        let [first, second] = [stiffness(one)?, stiffness(other)?];
        // Where the line through both is zero.
        Some(about * (one + (other - one) * first / (first - second)))
    })
}

/// Force over way across (N/m) of a column under a load (N).
fn across_stiffness(bar: &Bar, model: &dyn ElasticModel, load: f64, push: f64) -> Option<f64> {
    let found = bar.bent(model, DVec3::new(push, 0.0, -load), bar.body.rest().to_vec())?;
    Some(push / bar.tip(&found).x)
}
