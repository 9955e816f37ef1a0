//! An arc of 45° that is bent out of its plane.

use super::{Case, at_rest, dead};
use crate::material::{Elements, Model};
use glam::DVec3;
use localshape::sim::{Body, Material};
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

const MATERIAL: Material = Material { young: 1e7, poisson: 0.0 };
const RADIUS: f64 = 100.0;
const LOAD: f64 = 600.0;
/// The place of the end as printed by J. Simo, L. Vu-Quoc, Computer Methods in Applied Mechanics and Engineering 58, 79 (1986). K. Bathe, S.
/// Bolourchi, International Journal for Numerical Methods in Engineering 14, 961 (1979), print (15.9, 47.2, 53.4).
const END: DVec3 = DVec3::new(15.79, 47.23, 53.37);

pub(super) const CASE: Case = Case {
    name: "An arc of 45° bent out of its plane",
    what: "A cantilever that is an arc of 45° and radius 100 with a section of 1 × 1, `E = 1e7`, `ν = 0`, has a force of 600 on its end at right angles to its \
           plane. The way of the end beside that of the literature: from (29.29, 70.71, 0) to (15.79, 47.23, 53.37) by Simo and Vu-Quoc (1986), to \
           (15.9, 47.2, 53.4) by Bathe and Bolourchi (1979). One to three cells across.",
    measure,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let across = 1 + refined;
    let (body, ends) = arc(model.elements, across);
    let made = model.on(&body, MATERIAL, 1.0 / f64::from(across))?;
    let mut forces = vec![DVec3::ZERO; body.len()];
    ends[1].iter().for_each(|&(node, share)| forces[node] = DVec3::Z * (LOAD * share));
    let held: Vec<_> = ends[0].iter().map(|&(node, _)| node).collect();
    let found = at_rest(&body, made.as_ref(), &held, vec![dead(forces)])?;
    let mean = |position: &[DVec3]| ends[1].iter().map(|&(node, share)| position[node] * share).sum::<DVec3>();
    let start = DVec3::new(RADIUS * (1.0 - libm::cos(FRAC_PI_4)), RADIUS * libm::sin(FRAC_PI_4), 0.0);
    Some((mean(&found) - mean(body.rest())).length() / (END - start).length())
}

/// The nodes of an end, each with its share of the section.
type End = Vec<(usize, f64)>;

/// The arc, of which the first nodes are held, and both ends.
fn arc(elements: Elements, across: u32) -> (Arc<Body>, [End; 2]) {
    let along = (RADIUS * FRAC_PI_4).round() as u32 * across;
    let side = 1.0 / f64::from(across);
    let block = elements.block(&[across, across, along], side, (0.0, 1), 1.0);
    let (low, high) = (block.rest().iter().fold(f64::INFINITY, |low, at| low.min(at.z)), f64::from(along) * side);
    let bottom = block.rest().iter().fold(f64::INFINITY, |low, at| low.min(at.y));
    let place = |at: &DVec3| {
        let (sine, cosine) = libm::sincos((at.z - low) / high * FRAC_PI_4);
        let radius = RADIUS + at.x;
        DVec3::new(RADIUS - radius * cosine, radius * sine, at.y - bottom - 0.5)
    };
    let share = |at: &DVec3| {
        let inside = |place: f64| if (place.abs() - 0.5).abs() < 1e-6 { 0.5 } else { 1.0 };
        inside(at.x) * inside(at.y - bottom - 0.5) * side * side
    };
    let end = |height: f64| {
        let nodes = block.rest().iter().enumerate().filter(|(_, at)| (at.z - low - height).abs() < 1e-6);
        nodes.map(|(node, at)| (node, share(at))).collect()
    };
    let ends = [end(0.0), end(high)];
    let body = Body::builder(block.rest().iter().map(place).collect());
    let body = body.elements(block.elements().clone()).masses(block.mass().to_vec());
    (Arc::new(body.build().expect("an arc")), ends)
}
