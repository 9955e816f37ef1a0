//! A body that meets itself: the legs of a U fly at each other.

use super::bodies::{Placed, SIDE, Setting, cubes};
use super::{Measured, Trial};
use glam::DVec3;
use localshape::sim::{Body, BodyContact, IndexLists};
use std::collections::BTreeMap;
use std::sync::Arc;

pub(super) fn trials() -> Vec<Trial> {
    [(3.0, Some(0)), (10.0, None)]
        .into_iter()
        .flat_map(|(speed, most)| [0.0, 1.0].map(|restitution| (speed, restitution, most)))
        .map(|(speed, restitution, most)| Box::new(move || vec![closes(speed, restitution, most)]) as Trial)
        .collect()
}

/// The cells of a block of 5×6×2 without its inside.
fn u() -> Arc<Body> {
    let whole = cubes([5, 6, 2]);
    let mut numbers = BTreeMap::new();
    let (mut rest, mut mass, mut elements) = (Vec::new(), Vec::new(), IndexLists::default());
    for cell in whole.elements().iter() {
        let centre = cell.iter().map(|&node| whole.rest()[node as usize]).sum::<DVec3>() / 8.0;
        if centre.x.abs() < 1.6 * SIDE && centre.y > -2.4 * SIDE {
            continue;
        }
        let corners: Vec<u32> = cell
            .iter()
            .map(|&node| {
                *numbers.entry(node).or_insert_with(|| {
                    rest.push(whole.rest()[node as usize]);
                    mass.push(whole.mass()[node as usize]);
                    rest.len() as u32 - 1
                })
            })
            .collect();
        elements.push(&corners);
    }
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a U"))
}

/// The most pairs of its triangles that cross at any time.
fn closes(speed: f64, restitution: f64, most: Option<u64>) -> Measured {
    let body = u();
    let mut setting = Setting::new(1e4, [restitution, 0.0]);
    setting.around.contacts.as_mut().expect("contacts").bodies = vec![BodyContact { itself: true, thickness: None }];
    let mut world = setting.world(&[Placed::still(&body, DVec3::ZERO)]);
    let mut state = world.state().clone();
    for (velocity, rest) in state.velocity.iter_mut().zip(body.rest()) {
        if rest.y > -1.4 * SIDE {
            *velocity = DVec3::X * (-speed * rest.x.signum());
        }
    }
    world.set_state(state);
    let mut worst = 0;
    for _ in 0..150 {
        world.advance(2);
        let found = world.crossings().into_iter().flatten();
        worst = worst.max(found.map(|(_, count)| count).sum::<usize>());
    }
    let what = format!("a U that closes with {speed} m/s at each side, e = {restitution}: triangles that cross");
    match most {
        Some(most) => Measured::most(what, worst as f64, most as f64),
        None => Measured::shown(what, worst as f64),
    }
}
