//! The kernel for any elements.

use super::*;
use crate::kernel::general::{SMALL, layout::parts};

/// Steps a body by the law of the shape model.
fn compare(name: &str, body: &Arc<Body>, start: State, model: &ShapeBased, scheme: Scheme, steps: u64) {
    let start = &with_rotations(body, start);
    let by_law = |conditions: &Conditions| model.by_law(body, conditions, None).stepper;
    Case { body, start, model, scheme, steps }.compare(name, Set::all(), &[1], by_law);
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
                compare(name, &body, start(&body, 1), &shape_based(rotation, damping), SEMI, STEPS);
            }
        }
    }
}

#[test]
fn any_scheme_steps_like_the_reference() {
    for (name, body) in [("anything", pieces([3, 2, 3], &[4, 5, 6, 8], 6)), ("flat", pieces([4, 3, 0], &[3, 4], 7))] {
        for scheme in SCHEMES {
            for damping in [0.0, 10.0] {
                compare(name, &body, start(&body, 2), &shape_based(TWICE, damping), scheme, STEPS);
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
        let (start, model) = (with_rotations(&body, start(&body, 3)), shape_based(TWICE, 10.0));
        let case = Case { body: &body, start: &start, model: &model, scheme: SEMI, steps };
        case.compare("several parts", Set::all().skip(1), &[1, 2, 3], |conditions| {
            model.by_law(&body, conditions, None).stepper
        });
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
        compare(name, &body, start, &shape_based(Rotation::Optimum, 10.0), SEMI, 20);
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
