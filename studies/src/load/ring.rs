//! A thick ring under pressure from inside.

use super::{Case, at_rest};
use crate::material::{Elements, Model};
use glam::DVec3;
use localshape::sim::{Body, Course, Dimension, IndexLists, Loading, Material};
use std::f64::consts::TAU;
use std::sync::Arc;

const MATERIAL: Material = Material { young: 1.0, poisson: 0.3 };
/// Inner and outer radius (m), and the pressure.
const RADII: [f64; 2] = [1.0, 2.0];
const PRESSURE: f64 = 1e-6;

pub(super) const CASE: Case = Case {
    name: "A thick ring under pressure",
    what: "A free ring in the plane, of radii 1 : 2, `ν = 0.3`, under pressure from inside: how far its inside moves outwards by G. Lamé (1852), \
           `u = p a² / E (b² − a²) · ((1 − ν) a + (1 + ν) b² / a)` in plane stress, over how far it does.",
    measure,
    levels: 3,
    with_springs: false,
};

fn measure(model: &Model, refined: u32) -> Option<f64> {
    let (body, around) = ring(model.elements, 4 << refined);
    let [inner, outer] = RADII;
    let made = model.on(&body, MATERIAL, (outer - inner) / f64::from(4 << refined))?;
    // The body is at the left of each side.
    let inside: Vec<_> = (0..around).map(|at| vec![(at + 1) % around, at]).collect();
    let load = Arc::new(Loading::pressure(inside, PRESSURE, Course::ALWAYS));
    let found = at_rest(&body, made.as_ref(), &[], vec![load])?;
    let moved = (0..around as usize).map(|node| found[node].length() - body.rest()[node].length());
    let mean = moved.sum::<f64>() / f64::from(around);
    let Material { young, poisson } = MATERIAL;
    let (squares, ratio) = (outer * outer - inner * inner, inner * inner / young);
    Some(PRESSURE * ratio / squares * ((1.0 - poisson) * inner + (1.0 + poisson) * outer * outer / inner) / mean)
}

/// A ring of so many layers of quadrilaterals, or of two triangles for each, and the number of nodes around it; those inside come first.
fn ring(elements: Elements, layers: u32) -> (Arc<Body>, u32) {
    let around = 8 * layers;
    let [inner, outer] = RADII;
    // Cells have the same shape everywhere.
    let radius = |layer: u32| inner * libm::pow(outer / inner, f64::from(layer) / f64::from(layers));
    let place =
        |layer, at| DVec3::from((libm::cos(angle(at, around)), libm::sin(angle(at, around)), 0.0)) * radius(layer);
    let rest = (0..=layers).flat_map(|layer| (0..around).map(move |at| place(layer, at))).collect();
    let mut lists = IndexLists::default();
    for (layer, at) in (0..layers).flat_map(|layer| (0..around).map(move |at| (layer, at))) {
        let [a, b] = [at, (at + 1) % around].map(|at| layer * around + at);
        let [c, d] = [a, b].map(|node| node + around);
        match elements {
            Elements::Cells => lists.push(&[a, c, d, b]),
            Elements::Simplices => [[a, c, b], [c, d, b]].iter().for_each(|corners| lists.push(corners)),
        }
    }
    let body = Body::builder(rest).dimension(Dimension::Plane).elements(lists);
    (Arc::new(body.build().expect("a ring")), around)
}

fn angle(at: u32, around: u32) -> f64 {
    TAU * f64::from(at) / f64::from(around)
}
