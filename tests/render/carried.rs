//! Bodies that carry fine surfaces.

use super::listed::Listed;
use super::{all, draw, gpu, parse, unknown};
use image::RgbImage;
use localshape::runner::Runner;
use localshape::scene::Scene;
use localshape::sim::{Assembly, Body, Carried, Weights};
use std::sync::Arc;

/// A scene whose bodies carry surfaces.
fn carrying(scene: &Scene, surface: impl Fn(&Body) -> Carried) -> Scene {
    let mut scene = scene.clone();
    for run in &mut scene.runs {
        let carry = |body: &Arc<Body>| Arc::new(Body { carried: Some(Arc::new(surface(body))), ..Body::clone(body) });
        run.bodies = Arc::new(Assembly::new(run.bodies.bodies().iter().map(carry).collect()));
    }
    scene
}

/// The outer faces of a body.
fn own(body: &Body) -> Carried {
    let mut weights = Weights::default();
    (0..body.len() as u32).for_each(|node| weights.push(&[node], &[1.0]));
    let outer = body.faces.nodes.iter().zip(&body.faces.outer).filter(|(_, outer)| outer.is_none());
    let triangles = outer.flat_map(|(face, _)| (2..face.len()).map(|at| [face[0], face[at - 1], face[at]])).collect();
    Carried { rest: body.rest.clone(), triangles, weights }
}

fn picture(scene: &Scene, index: u64) -> Listed {
    unknown(scene).compose(&Runner::new(scene, &all(scene)).frame(index))
}

/// The greatest difference of two images, and the number of channels that differ.
fn apart(one: &RgbImage, other: &RgbImage) -> (u8, usize) {
    let off: Vec<_> = one.as_raw().iter().zip(other.as_raw()).map(|(a, b)| a.abs_diff(*b)).collect();
    (off.iter().copied().max().unwrap_or(0), off.iter().filter(|&&off| off > 0).count())
}

#[test]
fn a_block_that_carries_its_own_faces_looks_the_same() {
    let Some(gpu) = gpu("a_block_that_carries_its_own_faces_looks_the_same") else { return };
    let plain = parse(
        "gravity = [0, -9.8, 0]
        time = { duration = 1, step = 'T/50' }
        [[body]]
        lattice = { cells = [3, 3, 3], side = 0.1 }
        rotation = { axis = [1, 0, 1], angle = 0.4 }
        lowest = 0.05
        [[obstacle]]
        kind = 'floor'
        [[run]]
        name = 'one'
        model = { kind = 'shape-based', stiffness = 1e6, damping_ratio = 0.1 }
        [view]
        edges = 'outline'",
    );
    for index in [0, 12] {
        let [one, other] = [plain.clone(), carrying(&plain, own)].map(|scene| draw(gpu, &picture(&scene, index)));
        // Contours of carried surfaces are joined at corners. Goldens tolerate differences of 1 % of the pixels.
        let (most, count) = apart(&one, &other);
        assert!(count < 9216, "{index}: {count} channels differ, by up to {most}");
    }
}
