//! A cantilever under a force that follows its end.

use super::{Case, at_rest, slender};
use crate::material::{Model, Rod};
use glam::DVec3;
use localshape::sim::{Load, Material};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };
/// `P L²/EI`.
const LOAD: f64 = 2.0;

pub(super) const CASE: Case = Case {
    name: "An elastica under a force that follows its end",
    what: "A cantilever of 20 : 1 under a force that stays in the plane of its last section, `P L²/EI = 2`: the deflection across of a rod that bends, \
           shears and stretches (Reissner 1973) over that of its end.",
    measure,
    levels: 3,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let bar = slender(model, refined);
    let (made, material) = bar.model(model, MATERIAL)?;
    let load = LOAD * bar.rigidity(material) / (bar.length * bar.length);
    let shares: Vec<f64> = bar.load(DVec3::X).iter().map(|force| force.x).collect();
    let [low, high] = bar.sides();
    let follows = move |_: f64, position: &[DVec3], forces: &mut [DVec3]| {
        let mean = |nodes: &[usize]| nodes.iter().map(|&node| position[node]).sum::<DVec3>() / nodes.len() as f64;
        let across = (mean(&high) - mean(&low)).normalize_or_zero();
        forces.iter_mut().zip(&shares).for_each(|(force, share)| *force += across * (load * share));
    };
    let follower: Arc<dyn Load> = Arc::new(follows);
    let found = at_rest(&bar.body, made.as_ref(), &bar.ends[0], vec![follower])?;
    let rod = Rod::square(bar.length, DVec3::ZERO, material);
    Some(rod.followed(DVec3::X * load).x / bar.tip(&found).x)
}
