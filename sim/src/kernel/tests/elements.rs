//! The kernel for any elements.

use super::*;
use crate::kernel::general::{SMALL, layout::parts};

/// Steps a body with the lanes of every set, which must agree bit for bit, and with the reference.
fn compare(name: &str, body: &Arc<Body>, start: State, rotation: Rotation, damping: f64, scheme: Scheme) {
    let start = with_rotations(body, start);
    let (found, _) = same(Set::all(), &[1], |set, _| {
        let mut kernel = general(body, &start, rotation, damping, scheme, set);
        // The result does not depend on how steps are divided into calls.
        for steps in [1, 7, 100, STEPS - 108] {
            assert_eq!(kernel.advance(steps, FREE), Ok(()), "{name}");
        }
        kernel.stored(&start)
    });
    let model = shape_based(rotation, damping);
    let mut world = reference(body, &start.0, &model, scheme, Vec::new());
    world.advance(STEPS);
    let far = distance(&found, world.state());
    assert!(far <= 1e-12, "{name}, {rotation:?}, D = {damping}, {scheme:?}: {far:e}");
}

#[test]
fn any_elements_step_like_the_reference() {
    for (name, body) in [
        ("one hexahedron", whole([1, 1, 1], 0.2, 1)),
        ("a bar", whole([9, 1, 1], 0.2, 2)),
        ("a block", whole([3, 4, 2], 0.2, 3)),
        ("tetrahedra", pieces([3, 3, 3], &[4], 4)),
        ("one tetrahedron", pieces([1, 1, 1], &[4], 5)),
        ("anything", pieces([4, 3, 5], &[4, 5, 6, 7, 8], 6)),
        ("anything flat", pieces([4, 5, 0], &[3, 4], 7)),
        ("one triangle", pieces([1, 1, 0], &[3], 8)),
        ("squares", whole([9, 1, 0], 0.1, 9)),
        ("a lattice, filled in part", filled(whole([3, 4, 2], 0.0, 3))),
        ("anything, filled in part", filled(pieces([4, 3, 5], &[4, 5, 6, 7, 8], 6))),
        ("flat, filled in part", filled(pieces([4, 5, 0], &[3, 4], 7))),
        ("a lattice of unequal stiffness", stiffened(whole([3, 4, 2], 0.0, 3))),
        ("flat, of unequal stiffness", stiffened(pieces([4, 5, 0], &[3, 4], 7))),
        ("both", filled(stiffened(pieces([4, 3, 5], &[4, 5, 6, 7, 8], 6)))),
    ] {
        for rotation in [TWICE, Rotation::Optimum] {
            for damping in [0.0, 10.0] {
                compare(name, &body, start(&body, 1), rotation, damping, Scheme::SemiImplicitEuler);
            }
        }
    }
}

#[test]
fn any_scheme_steps_like_the_reference() {
    for (name, body) in [("anything", pieces([3, 2, 3], &[4, 5, 6, 8], 6)), ("flat", pieces([4, 3, 0], &[3, 4], 7))] {
        for scheme in [Scheme::ExplicitEuler, Scheme::VelocityVerlet, PEFRL] {
            for damping in [0.0, 10.0] {
                compare(name, &body, start(&body, 2), TWICE, damping, scheme);
            }
        }
    }
}

/// Several parts that share nodes, and blocks that are not full; then so many parts that what they need is prefetched.
#[test]
fn a_body_of_several_parts_steps_like_the_reference() {
    let some = || pieces([23, 17, 19], &[4, 6, 8], 11);
    let many = pieces([45, 33, 33], &[4, 6, 8], 11);
    for (body, steps, is_large) in [(some(), 50, false), (filled(stiffened(some())), 50, false), (many, 3, true)] {
        assert_eq!(parts(&body.elements) > SMALL, is_large);
        let start = with_rotations(&body, start(&body, 3));
        let mut world = reference(&body, &start.0, &shape_based(TWICE, 10.0), Scheme::SemiImplicitEuler, Vec::new());
        world.advance(steps);
        let (found, _) = same(Set::all().skip(1), &[1, 2, 3], |set, threads| {
            let kernel = shape_based(TWICE, 10.0).by_law(&body, &conditions(SEMI, set), None).stepper;
            let mut kernel = Moving::new(kernel, &start, SEMI, threads);
            assert_eq!(kernel.advance(steps, FREE), Ok(()));
            kernel.stored(&start)
        });
        let far = distance(&found, world.state());
        assert!(far <= 1e-12, "{far:e}");
    }
}

/// Elements turned inside out, flattened or collapsed to a point, in single lanes among others.
#[test]
fn elements_without_a_guide_step_like_the_reference() {
    let body = whole([3, 2, 2], 0.1, 12);
    for (name, element, crush) in [
        ("inside out", 5, DVec3::new(1.0, 1.0, -1.0)),
        ("flat", 7, DVec3::new(1.0, 1.0, 0.0)),
        ("a line", 2, DVec3::new(0.0, 1.0, 0.0)),
        ("a point", 11, DVec3::ZERO),
    ] {
        let mut start = State::at_rest(body.rest.clone());
        let middle = body.elements[element].iter().map(|&node| body.rest[node as usize]).sum::<DVec3>() / 8.0;
        for &node in &body.elements[element] {
            let place = &mut start.position[node as usize];
            *place = middle + (*place - middle) * crush;
        }
        let start = with_rotations(&body, start);
        let model = shape_based(Rotation::Optimum, 10.0);
        let mut world = reference(&body, &start.0, &model, Scheme::SemiImplicitEuler, Vec::new());
        world.advance(20);
        for set in Set::all() {
            let mut kernel = general(&body, &start, Rotation::Optimum, 10.0, SEMI, set);
            assert_eq!(kernel.advance(20, FREE), Ok(()), "{name}");
            let far = distance(&kernel.stored(&start).0, world.state());
            assert!(far <= 1e-12, "{name}: {far:e}");
        }
    }
    // In the plane all angles are equally good for a triangle at a point: the last one is kept.
    let body = pieces([1, 1, 0], &[3], 13);
    let start = (State::at_rest(vec![DVec3::ZERO; body.len()]), vec![0.6, 0.8]);
    for set in Set::all() {
        let mut kernel = general(&body, &start, TWICE, 0.0, SEMI, set);
        assert_eq!(kernel.advance(1, FREE), Ok(()));
        assert_eq!(kernel.stored(&start).1, [0.6, 0.8]);
    }
    assert_eq!(best(Dimension::Plane, DMat3::ZERO), DMat3::IDENTITY);
}
