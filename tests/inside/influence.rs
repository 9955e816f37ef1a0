//! The nodes that a point of a skin follows.

use super::*;
use crate::sim::Weights;

/// Points of a cube, by trilinear weights.
fn cube() -> (Carried, Vec<DVec3>) {
    let rest: Vec<_> =
        (0..8).map(|at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)))).collect();
    let (mut weights, mut points) = (Weights::default(), Vec::new());
    for at in 0..1000_u32 {
        let point = DVec3::from_array([at % 10, at / 10 % 10, at / 100].map(|place| f64::from(place) / 9.0));
        let weight = |corner: &DVec3| (0..3).map(|axis| 1.0 - (corner[axis] - point[axis]).abs()).product::<f64>();
        weights.push(&[0, 1, 2, 3, 4, 5, 6, 7], &rest.iter().map(weight).collect::<Vec<_>>());
        points.push(point);
    }
    (Carried { rest: points, triangles: Vec::new(), weights }, rest)
}

#[test]
fn points_stay_where_they_are_at_rest() {
    let (carried, rest) = cube();
    for (point, &at) in carried.rest.iter().enumerate() {
        let found = of(&carried, point, &rest);
        assert!(!found.is_empty() && found.len() <= MOST && found.iter().all(|(_, weight)| *weight > 0.0));
        let sum: f64 = found.iter().map(|(_, weight)| weight).sum();
        let there: DVec3 = found.iter().map(|&(node, weight)| rest[node as usize] * weight).sum();
        assert!((sum - 1.0).abs() < 1e-8 && there.distance(at) < 1e-8, "{at}: {found:?}");
    }
}

/// Two cubes side by side, whose lists of nodes run differently, divide their common face alike: a point of the face follows the
/// same nodes with the same weights in both, and points on both sides of it stay together.
#[test]
fn the_surface_has_no_cracks() {
    let rest: Vec<_> = (0..12).map(|at| DVec3::from_array([at / 4, at / 2 % 2, at % 2].map(f64::from))).collect();
    // The common face is bent, so that its two halves tell how it is divided.
    let moved: Vec<_> = rest.iter().map(|at| *at + DVec3::splat(0.5 * (at.x - at.y * at.z))).collect();
    let cubes: [[u32; 8]; 2] = [[0, 1, 2, 3, 4, 5, 6, 7], [11, 7, 9, 5, 10, 6, 8, 4]];
    let follow = |nodes: &[u32; 8], at: DVec3| {
        let corner =
            |&node: &u32| (0..3).map(|axis| 1.0 - (rest[node as usize][axis] - at[axis]).abs()).product::<f64>();
        let mut weights = Weights::default();
        weights.push(nodes, &nodes.iter().map(corner).collect::<Vec<f64>>());
        let mut found = of(&Carried { rest: vec![at], triangles: Vec::new(), weights }, 0, &rest);
        found.sort_by_key(|(node, _)| *node);
        found
    };
    let place =
        |found: &[(u32, f64)]| -> DVec3 { found.iter().map(|&(node, weight)| moved[node as usize] * weight).sum() };
    let beside = 1e-5;
    for at in 0..400 {
        let at = DVec3::new(1.0, f64::from(at % 20) / 19.0, f64::from(at / 20) / 19.0);
        assert_eq!(follow(&cubes[0], at), follow(&cubes[1], at), "{at}");
        let [low, high] = [follow(&cubes[0], at - DVec3::X * beside), follow(&cubes[1], at + DVec3::X * beside)];
        assert!(place(&low).distance(place(&high)) < 20.0 * beside, "{at}: {low:?} {high:?}");
    }
}

/// However the corners move, points near each other stay near each other.
#[test]
fn points_of_a_cube_stay_together() {
    let (carried, rest) = cube();
    let moved: Vec<_> =
        rest.iter().map(|at| *at + DVec3::splat(0.5 * (at.x - at.y * at.z + at.x * at.y * at.z))).collect();
    let place = |point: usize| -> DVec3 {
        of(&carried, point, &rest).into_iter().map(|(node, weight)| moved[node as usize] * weight).sum()
    };
    for point in (0..1000).filter(|at| at % 10 < 9) {
        assert!(place(point).distance(place(point + 1)) < 4.0 / 9.0, "{point}");
    }
}

/// Trilinear weights outside of their cube are negative in part.
#[test]
fn a_point_outside_follows_the_largest_weights_with_the_sum_one() {
    let (_, rest) = cube();
    let at = DVec3::new(1.4, 0.7, 1.2);
    let own =
        |corner: &DVec3| (0..3).map(|axis| if corner[axis] > 0.5 { at[axis] } else { 1.0 - at[axis] }).product::<f64>();
    let own: Vec<_> = rest.iter().map(own).collect();
    let mut weights = Weights::default();
    weights.push(&[0, 1, 2, 3, 4, 5, 6, 7], &own);
    let found = of(&Carried { rest: vec![at], triangles: Vec::new(), weights }, 0, &rest);
    // The four above zero: 1.4 · 0.7 · 1.2 at (1, 1, 1), and so on.
    let mut positive: Vec<_> = (0..8).filter(|&node| own[node] > 0.0).map(|node| (node as u32, own[node])).collect();
    positive.sort_by(|one, other| other.1.total_cmp(&one.1));
    assert_eq!(found.iter().map(|one| one.0).collect::<Vec<_>>(), positive.iter().map(|one| one.0).collect::<Vec<_>>());
    let sum: f64 = found.iter().map(|(_, weight)| weight).sum();
    assert!((sum - 1.0).abs() < 1e-12, "{sum}");
    let before: f64 = positive.iter().map(|(_, weight)| weight).sum();
    assert!(before > 1.1 && found.iter().zip(&positive).all(|(a, b)| (a.1 - b.1 / before).abs() < 1e-12));
}
