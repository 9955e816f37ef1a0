//! A square bar that is twisted.

use super::{Case, at_rest};
use crate::material::{Bar, Model, SQUARE};
use glam::DVec3;
use localshape::sim::{Course, Loading, Material};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.3 };
/// Length over the side of the section, and the twist over the length by the closed form.
const LENGTH: u32 = 4;
const TWIST: f64 = 1e-3;

pub(super) const CASE: Case = Case {
    name: "A square bar that is twisted",
    what: "A bar of 4 : 1 that is held at one end and has a torque on the other, `ν = 0.3`: the torque over the twist of a length, between a quarter and three \
           quarters, beside Saint-Venant's `0.1406 a⁴ G`. The coarsest bar has two cells across: one cell does not warp.",
    measure,
    levels: 3,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let across = 2 << refined;
    let bar = Bar::new(model.elements, [across, across, LENGTH * across], 1.0 / f64::from(across), 1.0);
    let (made, _) = bar.model(model, MATERIAL)?;
    let torque = TWIST / bar.length * SQUARE * MATERIAL.shear();
    let weights: Vec<f64> = bar.load(DVec3::X).iter().map(|force| force.x).collect();
    let (nodes, weights) = (0..).zip(weights).filter(|&(_, weight)| weight > 0.0).unzip();
    let load = Arc::new(Loading::torque(nodes, weights, DVec3::Z * torque, Course::ALWAYS));
    let found = at_rest(&bar.body, made.as_ref(), &bar.ends[0], vec![load])?;
    let [low, high] = [-0.25, 0.25].map(|share| turn(&bar, &found, bar.layer_at(share)));
    Some(0.5 * TWIST / (high - low))
}

/// The mean angle (rad) by which the nodes of a layer have turned about the bar.
fn turn(bar: &Bar, found: &[DVec3], layer: Vec<usize>) -> f64 {
    let rest = bar.body.rest();
    let middle = layer.iter().map(|&node| rest[node]).sum::<DVec3>() / layer.len() as f64;
    let arms = layer.iter().map(|&node| ((rest[node] - middle), found[node] - rest[node]));
    let (moment, size) = arms.fold((0.0, 0.0), |(moment, size), (arm, way)| {
        (moment + arm.cross(way).z, size + arm.truncate().length_squared())
    });
    moment / size
}
