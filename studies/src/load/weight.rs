//! Bodies that load the ground, and one that hangs.

use super::{Case, reactions};
use crate::contact::obstacle;
use crate::material::{Bar, Model, hold, rest_of};
use glam::DVec3;
use localshape::sim::{Body, Contacts, Material, Shape, Surroundings};
use std::sync::Arc;

const MATERIAL: Material = Material { young: 2e5, poisson: 0.0 };
const GRAVITY: f64 = 9.8;
/// Bodies in the stack, each a cube with this side (m), and what is between them at first (m).
const COUNT: usize = 2;
const SIDE: f64 = 0.2;
const GAP: f64 = 0.005;

pub(super) const STACK: Case = Case {
    name: "A stack on the ground",
    what: "The force of the ground on a stack of two bodies at rest, over `n m g`, with friction 0.3: the mean over a hundred steps from rest.",
    measure: stack,
    levels: 2,
    with_springs: true,
};

pub(super) const SCALE: Case = Case {
    name: "A spring scale",
    what: "A bar hangs from a hold, with an upper half of a tenth of the modulus: the force of the hold over the weight.",
    measure: scale,
    ..STACK
};

fn stack(model: &Model, refined: u32) -> Option<f64> {
    let cells = 1 << refined;
    let body = model.elements.block(&[cells; 3], SIDE / f64::from(cells), (0.0, 1), 1000.0);
    let made = model.on(&body, MATERIAL, SIDE / f64::from(cells))?;
    let low = body.rest().iter().fold(f64::INFINITY, |low, at| low.min(at.y));
    let lift = |at: usize| DVec3::Y * (GAP - low + at as f64 * (SIDE + GAP));
    let place = |at: usize| body.rest().iter().map(move |&rest| rest + lift(at));
    let ground = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 }, [0.0, 0.3]);
    let contacts = Some(Contacts { friction: 0.3, ..Contacts::default() });
    let gravity = DVec3::NEG_Y * GRAVITY;
    let around = Surroundings { gravity, obstacles: vec![ground], contacts, ..Surroundings::default() };
    let parts = vec![(Arc::clone(&body), made.as_ref()); COUNT];
    let position = rest_of(&parts, (0..COUNT).flat_map(place).collect(), &around, 1.0)?;
    let force: DVec3 = reactions(&parts, position, around, 100)?.into_iter().sum();
    Some(force.y / (COUNT as f64 * weight(&body)))
}

fn scale(model: &Model, refined: u32) -> Option<f64> {
    let bar =
        Bar::new(model.elements, [1 << refined, 1 << refined, 4 << refined], SIDE / f64::from(1 << refined), 1000.0);
    let is_above = |nodes: &[u32]| nodes.iter().map(|&node| bar.body.rest()[node as usize].z).sum::<f64>() < 0.0;
    let soft = bar.body.elements().iter().map(|nodes| if is_above(nodes) { 0.1 } else { 1.0 }).collect();
    let body = Arc::new(Body::clone(&bar.body).with_modulus(soft).expect("one for each element"));
    let made = model.on(&body, MATERIAL, SIDE / f64::from(1 << refined))?;
    let around =
        Surroundings { gravity: DVec3::Z * GRAVITY, grips: vec![hold(&bar.ends[0])], ..Surroundings::default() };
    let parts = [(Arc::clone(&body), made.as_ref())];
    let position = rest_of(&parts, body.rest().to_vec(), &around, 1.0)?;
    let force: DVec3 = reactions(&parts, position, around, 1)?.into_iter().sum();
    Some(-force.z / weight(&body))
}

/// (N).
fn weight(body: &Body) -> f64 {
    GRAVITY * body.mass().iter().sum::<f64>()
}
