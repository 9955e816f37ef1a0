//! Bodies made from anything: right ones, and wrong ones that are told.

use super::support::Noise;
use glam::DVec3;
use localshape_sim::geometry::volumes_at_rest;
use localshape_sim::model::shape_based::ShapeBased;
use localshape_sim::{
    Body, BodyError, Carried, Dimension, IndexLists, Integrator, Solids, State, Stepping, Surroundings, Weights, World,
};
use std::sync::Arc;

fn lists(lists: &[&[u32]]) -> IndexLists {
    lists.iter().copied().collect()
}

/// The corners of a cube.
fn corners() -> Vec<DVec3> {
    (0..8).map(|at| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)))).collect()
}

#[test]
fn every_mistake_names_its_place() {
    let of = |elements: &[&[u32]]| Body::builder(corners()).elements(lists(elements));
    let cube = || of(&[&[0, 1, 2, 3, 4, 5, 6, 7]]);
    let moved = |node: usize, to: DVec3| {
        let mut nodes = corners();
        nodes[node] = to;
        Body::builder(nodes)
    };
    let mut weights = Weights::default();
    weights.push(&[8], &[1.0]);
    let carried = |points: usize, triangles, weights: &Weights| {
        Arc::new(Carried { rest: vec![DVec3::ZERO; points], triangles, weights: weights.clone() })
    };
    for (made, expected) in [
        (Body::builder(Vec::new()), "a body needs at least one node"),
        (moved(3, DVec3::X * f64::NAN), "node 3 is at [NaN, NaN, NaN]; expected finite coordinates (m)"),
        (
            cube().dimension(Dimension::Plane),
            "node 4 of a body in the plane has z = 1 m; expected 0, or a body in space",
        ),
        (of(&[&[0, 1], &[7]]), "element 1 has 1 nodes; expected at least 2"),
        (of(&[&[0, 1], &[7, 8]]), "element 1 names node 8; the last one is 7"),
        (of(&[&[0, 1, 0]]), "element 0 names node 0 twice"),
        (cube().faces(lists(&[&[0, 1, 2], &[0, 1]])), "face 1 has 2 nodes; expected at least 3"),
        (cube().faces(lists(&[&[0, 1, 9]])), "face 0 names node 9; the last one is 7"),
        (cube().masses(vec![1.0; 7]), "there are 7 masses for 8 nodes; give one for each"),
        (cube().masses(vec![0.0; 8]), "the mass of node 0 is 0; expected a finite number above 0"),
        (cube().fill(vec![1.5]), "the filled part of element 0 is 1.5; expected a part above 0 and up to 1"),
        (cube().fill(vec![]), "there are 0 filled parts for 1 elements; give one for each"),
        (
            cube().stiffness(vec![-1.0]),
            "the relative stiffness of element 0 is -1; expected a finite number of 0 or more",
        ),
        (
            cube().carried(carried(2, Vec::new(), &weights)),
            "there are 1 weighted means for 2 points; give one for each",
        ),
        (cube().carried(carried(1, vec![[0, 1, 0]], &weights)), "triangle 0 names point 1; the last one is 0"),
        (cube().carried(carried(1, Vec::new(), &weights)), "point 0 names node 8; the last one is 7"),
    ] {
        assert_eq!(made.build().unwrap_err().to_string(), expected);
    }
    assert_eq!(cube().build().expect("a cube").faces().nodes.len(), 6);
}

/// Random lists of random nodes. What is made also takes a step.
#[test]
fn random_bodies_are_made_or_told() {
    let mut noise = Noise(3);
    let mut pick = move |below: usize| (noise.vector().x.abs() * 1e6) as usize % below;
    let odd = [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300, 1e-300];
    let mut made = 0;
    for _ in 0..4000 {
        let is_wild = pick(2) == 0;
        let number = |pick: &mut dyn FnMut(usize) -> usize| match pick(40) {
            at if is_wild && at < odd.len() => odd[at],
            _ => pick(7) as f64 * 0.5 + 0.5,
        };
        let count = pick(9) + usize::from(!is_wild);
        let dimension = if pick(3) == 0 { Dimension::Plane } else { Dimension::Space };
        let flat = |place: DVec3| if dimension == Dimension::Plane && !is_wild { place.with_z(0.0) } else { place };
        let nodes = (0..count).map(|_| flat(DVec3::from_array([0; 3].map(|_| number(&mut pick))))).collect();
        let mut elements = IndexLists::default();
        for _ in 0..pick(4) {
            let reach = if is_wild { count + 1 } else { count };
            let mut own: Vec<u32> = (0..pick(9)).map(|_| pick(reach.max(1)) as u32).collect();
            if !is_wild {
                own.sort_unstable();
                own.dedup();
            }
            elements.push(&own);
        }
        let mut values =
            |count: usize| (pick(2) == 0).then(|| (0..count).map(|_| number(&mut pick)).collect::<Vec<_>>());
        let masses = values(count).unwrap_or(vec![1.0; count]);
        let stiffness = values(elements.len());
        let solids = if pick(2) == 0 { Solids::Convex } else { Solids::Ordered };
        let body = Body::builder(nodes).dimension(dimension).elements(elements).solids(solids);
        let Ok(body) = body.masses(masses).stiffness(stiffness).build() else { continue };
        made += 1;
        let start = State::at_rest(body.rest().to_vec());
        let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-3);
        let body = Arc::new(body);
        let mut world = World::new(&body, start, &ShapeBased::new(1.0), Surroundings::default(), stepping);
        world.advance(2);
        assert_eq!(world.snapshot().position.len(), count);
        assert_eq!(volumes_at_rest(&body).len(), body.elements().len());
    }
    assert!(made > 500, "{made}");
}

#[test]
fn errors_can_be_told_apart() {
    let wrong = Body::builder(corners()).elements(lists(&[&[0, 99]])).build();
    assert!(matches!(wrong, Err(BodyError { of: "element", at: 0, .. })));
}
