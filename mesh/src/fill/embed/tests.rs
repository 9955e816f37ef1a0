//! Points carried by elements of several kinds.

use super::fan::{Place, Simplex, weights};
use super::*;

/// A cube, half of the next one, and a prism on the rest of it.
fn cage() -> Cage {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let square = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 0.1), (1.7, 0.8), (2.3, 1.0)];
    let nodes = [0.0, 1.0].iter().flat_map(|&z| square.map(|(x, y)| at(x, y, z))).collect();
    let elements = [&[0, 1, 2, 3, 7, 8, 9, 10][..], &[1, 3, 4, 5, 8, 10, 11, 12], &[4, 5, 6, 11, 12, 13]];
    Cage { nodes, elements: elements.into_iter().collect(), convex: true, ..Cage::default() }
}

/// The weight of each node.
fn dense(fan: &Fan, simplex: &Simplex, point: DVec3) -> Vec<f64> {
    let weights = weights(fan.corners(simplex), point);
    let place = Place { simplex: *simplex, weights, distance: 0.0 };
    let mut all = vec![0.0; fan.nodes];
    let (nodes, own) = fan.spread(&place);
    nodes.iter().zip(own).for_each(|(&node, weight)| all[node as usize] += weight);
    all
}

#[test]
fn weights_are_continuous_across_faces() {
    let body = body(&cage());
    let fan = Fan::new(&body);
    let shared: Vec<_> = (0..body.faces().nodes.len()).filter(|&face| body.faces().outer[face].is_some()).collect();
    assert_eq!(shared.len(), 2);
    let mut compared = 0;
    for one in &fan.simplices {
        for other in
            fan.simplices.iter().filter(|other| other.element > one.element && other.corners[1..] == one.corners[1..])
        {
            let [_, a, b, c] = fan.corners(one);
            for point in [a, b, c, 0.5 * (a + b), 0.2 * a + 0.5 * b + 0.3 * c, (a + b + c) / 3.0] {
                let [from_one, from_other] = [one, other].map(|simplex| dense(&fan, simplex, point));
                assert!(from_one.iter().zip(&from_other).all(|(one, other)| (one - other).abs() < 1e-14));
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 8, "four parts of each shared face");
}

#[test]
fn points_follow_the_first_element_that_holds_them_or_the_nearest() {
    let body = body(&cage());
    let fan = Fan::new(&body);
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.5);
    let points = [at(0.5, 0.5), at(1.0, 0.5), at(1.3, 0.5), at(1.3, -0.4), at(1.3, -0.9), at(1.3, -9.0)];
    let found = fan.locate(&points, 1.0, VERY_FAR);
    let elements: Vec<_> =
        found.iter().map(|place| place.map(|place| (place.simplex.element, place.distance > FAR))).collect();
    let expected = [(0, false), (0, false), (1, false), (1, false), (1, true)];
    assert_eq!(elements[..5], expected.map(Some));
    assert_eq!(elements[5], None);
}

#[test]
fn the_nearest_face_may_lie_in_a_later_ring() {
    // A tetrahedron in the cell of the point, and a nearer one beyond the side of that cell.
    let near = [[0.0, 0.0, 0.0], [0.3, 0.4, 0.5], [0.3, 0.6, 0.5], [0.3, 0.5, 0.6]];
    let nearer = [[1.05, 0.4, 0.4], [1.05, 0.7, 0.4], [1.05, 0.4, 0.7], [1.5, 0.5, 0.5]];
    let nodes = near.into_iter().chain(nearer).map(DVec3::from_array).collect();
    let elements = [&[0, 1, 2, 3][..], &[4, 5, 6, 7]].into_iter().collect();
    let body = body(&Cage { nodes, elements, convex: true, ..Cage::default() });
    let found = Fan::new(&body).locate(&[DVec3::new(0.95, 0.5, 0.5)], 1.0, VERY_FAR);
    assert_eq!(found[0].map(|place| place.simplex.element), Some(1));
}
