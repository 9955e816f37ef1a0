//! Bodies and obstacles that overlap or touch at the start, and how they are moved apart.

use glam::{DQuat, DVec3};
use localshape_sim::{
    Body, BodyContact, Carried, Contacts, Dimension, IndexLists, Motion, Obstacle, Overlap, Shape, Side, Surfaces,
    Weights,
};
use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

/// A body of one row of boxes along x with a corner at the origin.
fn row(cells: u32, [x, y, z]: [f64; 3]) -> Arc<Body> {
    let corner = |at: u32| {
        let (along, aside) = (at / 4, at % 4);
        DVec3::new(x * f64::from(along), y * f64::from(aside & 1), z * f64::from(aside >> 1))
    };
    let rest = (0..4 * (cells + 1)).map(corner).collect();
    let cell = |at: u32| [0, 4, 1, 5, 2, 6, 3, 7].map(|corner| 4 * at + corner);
    let cells: Vec<_> = (0..cells).map(cell).collect();
    made(Dimension::Space, rest, cells.iter().map(|cell| &cell[..]))
}

fn made<'a>(dimension: Dimension, rest: Vec<DVec3>, elements: impl Iterator<Item = &'a [u32]>) -> Arc<Body> {
    Arc::new(Body::builder(rest).dimension(dimension).elements(elements.collect()).build().expect("a body"))
}

fn obstacle(shape: Shape) -> Obstacle {
    let pivot = shape.middle();
    let (restitution, friction) = (0.0, 0.0);
    Obstacle { shape, motion: Motion::Still, pivot, restitution, friction, friction_of: Default::default() }
}

/// The positions of all nodes of bodies that are moved.
fn moved(bodies: &[(&Arc<Body>, [f64; 3])]) -> Vec<DVec3> {
    bodies.iter().flat_map(|(body, by)| body.rest().iter().map(|&at| at + DVec3::from_array(*by))).collect()
}

/// What overlaps of two bodies, the second of which is moved. It is the same in the other order.
fn overlap(one: &Arc<Body>, other: &Arc<Body>, by: [f64; 3]) -> Option<Overlap> {
    let all = |of: [(&Arc<Body>, [f64; 3]); 2]| {
        let surfaces = Surfaces::new(&of.map(|(body, _)| Arc::clone(body)), &[], &Contacts::default());
        surfaces.overlaps(&moved(&of), 0.0, |_| true)
    };
    let found = all([(one, [0.0; 3]), (other, by)]);
    let swapped = all([(other, by), (one, [0.0; 3])]);
    assert_eq!(found.len(), swapped.len());
    assert!(found.iter().zip(&swapped).all(|(a, b)| (a.depth - b.depth).abs() < 1e-9), "{found:?} {swapped:?}");
    assert!(found.len() < 2);
    found.into_iter().next()
}

/// The depth, unless they are apart.
fn depth(one: &Arc<Body>, other: &Arc<Body>, by: [f64; 3]) -> Option<f64> {
    overlap(one, other, by).map(|overlap| overlap.depth).filter(|&depth| depth >= 0.0)
}

/// Blocks of equal cells have all corners on the faces of each other.
#[test]
fn blocks_touch_or_reach_into_each_other() {
    let block = row(3, [1.0; 3]);
    for axis in 0..3 {
        let size = if axis == 0 { 3.0 } else { 1.0 };
        for sign in [1.0, -1.0] {
            let by = |distance: f64| [0, 1, 2].map(|other| if other == axis { sign * distance } else { 0.0 });
            assert_eq!(depth(&block, &block, by(1.001 * size)), None);
            assert_eq!(depth(&block, &block, by(size)), Some(0.0), "axis {axis}");
            let deep = depth(&block, &block, by(0.95 * size)).expect("they overlap");
            assert!((deep - 0.05 * size).abs() < 1e-12, "axis {axis}: {deep}");
        }
    }
    assert!(depth(&block, &block, [0.0; 3]).expect("at one place") > 0.1);
    assert_eq!(depth(&block, &block, [0.1, 1.0, 0.2]), Some(0.0));
    // An edge on an edge, and a corner on a corner.
    assert_eq!(depth(&block, &block, [0.3, 1.0, 1.0]), Some(0.0));
    assert_eq!(depth(&block, &block, [3.0, 1.0, 1.0]), Some(0.0));
    assert!((depth(&block, &block, [0.1, 0.95, 0.2]).expect("they overlap") - 0.05).abs() < 1e-12);
}

#[test]
fn the_deepest_node_is_told() {
    let (block, tip) = (row(1, [1.0; 3]), row(1, [0.5; 3]));
    let found = overlap(&block, &tip, [0.9, 0.9, 0.2]).expect("they overlap");
    assert_eq!(found.of, [Side::Body(0), Side::Body(1)]);
    assert!((found.depth - 0.1).abs() < 1e-12);
    // Nodes 8 and 12 of all are the corners of the smaller block, at 0.9, 0.9 and 0.2 or 0.7.
    assert!(found.node == 8 || found.node == 10, "{found:?}");
}

#[test]
fn bodies_overlap_without_a_node_of_one_in_the_other() {
    // Two rods cross between their ends.
    let (rod, upright) = (row(1, [9.0, 1.0, 1.0]), row(1, [1.0, 9.0, 1.0]));
    assert!(depth(&rod, &upright, [4.0, -4.0, 0.3]).expect("they cross") > 0.2);
    assert_eq!(depth(&rod, &upright, [4.0, -4.0, 1.1]), None);
    // One lies in an element of the other.
    assert_eq!(depth(&row(1, [9.0; 3]), &row(1, [1.0; 3]), [4.0, 4.0, 4.0]), Some(4.0));
    // A cloth and a chain have no inside.
    let triangle = vec![DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 9.0)];
    let cloth = made(Dimension::Space, triangle, [&[0, 1, 2][..]].into_iter());
    let chain = made(Dimension::Space, vec![DVec3::ZERO, DVec3::Y], [&[0, 1][..]].into_iter());
    assert_eq!(depth(&cloth, &chain, [2.0, -0.5, 2.0]), Some(0.5));
    assert_eq!(depth(&cloth, &chain, [2.0, 0.0, 2.0]), Some(0.0));
    assert_eq!(depth(&cloth, &chain, [5.0, -0.5, 5.0]), None);
    assert!(depth(&cloth, &row(1, [1.0; 3]), [2.0, -0.5, 2.0]).is_some());
}

/// A thing in a hollow of another, in its box but not in its elements; and in a ring of bars in the plane.
#[test]
fn a_hollow_is_outside() {
    let corners = (0..4u32).flat_map(|ring| {
        let at = |x: f64, y: f64| DVec3::new(x, y, 3.0 * f64::from(ring >> 1));
        let out = if ring & 1 == 0 { 1.0 } else { 2.0 };
        [at(-out, -out), at(out, -out), at(out, out), at(-out, out)]
    });
    let wall = |at: u32| {
        let next = (at + 1) % 4;
        [at, next, 4 + at, 4 + next].into_iter().flat_map(|node| [node, 8 + node]).collect::<Vec<u32>>()
    };
    let walls: Vec<_> = (0..4).map(wall).collect();
    let tube = made(Dimension::Space, corners.collect(), walls.iter().map(Vec::as_slice));
    let cube = row(1, [1.0; 3]);
    assert_eq!(depth(&tube, &cube, [-0.5, -0.5, 1.0]), None);
    assert!(depth(&tube, &cube, [0.5, -0.5, 1.0]).is_some());
    let ring = [[-9.0, -9.0], [9.0, -9.0], [0.0, 9.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let ring = made(Dimension::Plane, ring, [&[0, 1][..], &[1, 2], &[2, 0]].into_iter());
    let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let triangle = made(Dimension::Plane, triangle, [&[0, 1, 2][..]].into_iter());
    assert_eq!(depth(&ring, &triangle, [0.0; 3]), None);
    assert!(depth(&ring, &triangle, [0.0, -9.5, 0.0]).is_some());
}

#[test]
fn bodies_in_the_plane() {
    let square = |size: f64| {
        let rest = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| size * DVec3::new(x, y, 0.0)).to_vec();
        made(Dimension::Plane, rest, [&[0, 1, 2, 3][..]].into_iter())
    };
    let one = square(1.0);
    for (by, expected) in [
        ([0.0, 1.1], None),
        ([0.0, 1.0], Some(0.0)),
        ([0.0, 0.95], Some(0.05)),
        ([0.5, 0.95], Some(0.05)),
        ([1.0, 0.0], Some(0.0)),
        ([1.0, 1.0], Some(0.0)),
    ] {
        let found = depth(&one, &one, [by[0], by[1], 0.0]);
        assert_eq!(found.is_some(), expected.is_some(), "{by:?}: {found:?}");
        assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-12, "{by:?}: {found:?}");
    }
    assert!(depth(&one, &one, [0.0; 3]).expect("at one place") > 0.1);
    assert_eq!(depth(&square(9.0), &one, [4.0, 4.0, 0.0]), Some(4.0));
    let bar = made(Dimension::Plane, vec![DVec3::ZERO, 9.0 * DVec3::X], [&[0, 1][..]].into_iter());
    assert!(depth(&one, &bar, [-4.0, 0.3, 0.0]).is_some());
    assert_eq!(depth(&one, &bar, [-4.0, 1.3, 0.0]), None);
}

/// Obstacles of all kinds under, in and around a block.
#[test]
fn bodies_and_obstacles() {
    let block = row(1, [1.0; 3]);
    let depth = |shape: Shape| {
        let surfaces = Surfaces::new(&[Arc::clone(&block)], &[obstacle(shape)], &Contacts::default());
        let found = surfaces.overlaps(block.rest(), 0.0, |_| true);
        assert!(found.iter().all(|found| found.of == [Side::Body(0), Side::Obstacle(0)] && found.node < 8));
        found.first().map(|found| found.depth)
    };
    let near = |found: Option<f64>, expected: f64| {
        assert!((found.expect("they overlap") - expected).abs() < 1e-12, "{found:?} {expected}");
    };
    let ball = |centre: [f64; 3], radius: f64| depth(Shape::Sphere { centre: centre.into(), radius });
    assert_eq!(ball([0.5, -1.0, 0.5], 0.9), None);
    // A way out is known where it touches a ball.
    assert_eq!(ball([0.5, -1.0, 0.5], 1.0), None);
    // Between its nodes.
    near(ball([0.5, -0.2, 0.5], 0.3), 0.1);
    near(ball([0.5, 0.25, 0.5], 0.1), 0.35);
    near(ball([0.5, 0.5, 0.5], 9.0), 9.5);
    let rod = |y: f64| {
        let ends = [[0.4, y, -5.0], [0.4, y, 5.0]].map(DVec3::from_array);
        depth(Shape::Capsule { from: ends[0], to: ends[1], radius: 0.1 })
    };
    assert_eq!(rod(-0.11), None);
    near(rod(-0.04), 0.06);
    assert!(rod(0.5).is_some());
    let stone = |y: f64, turn: f64| {
        let rotation = DQuat::from_rotation_z(turn);
        depth(Shape::Box { centre: DVec3::new(0.5, y, 0.5), half: DVec3::splat(0.25), rotation })
    };
    assert_eq!(stone(-0.25, 0.0), Some(0.0));
    assert_eq!(stone(-0.3, 0.0), None);
    // Nearer than the distance that is kept.
    near(stone(-0.26, 0.0), -0.01);
    near(stone(-0.2, 0.0), 0.05);
    assert_eq!(stone(-0.41, FRAC_PI_4), None);
    near(stone(-0.3, FRAC_PI_4), 0.25 * 2.0_f64.sqrt() - 0.3);
    let floor = |height: f64| depth(Shape::Floor { normal: DVec3::Y, height });
    assert_eq!((floor(-0.1), floor(0.0), floor(0.25)), (None, None, Some(0.25)));
    let plate = |x: f64| depth(Shape::Plate { point: DVec3::X * x, normal: -DVec3::X });
    assert_eq!((plate(1.0), plate(0.5)), (None, Some(0.5)));
}

/// A body that carries a fine surface meets others with it, and not with its cage.
#[test]
fn a_carried_surface_counts_in_place_of_its_cage() {
    let cage = row(1, [1.0; 3]);
    // A tetrahedron in the middle of the cage.
    let rest = [[0.4, 0.4, 0.4], [0.6, 0.4, 0.4], [0.4, 0.6, 0.4], [0.4, 0.4, 0.6]].map(DVec3::from_array);
    let mut weights = Weights::default();
    for point in rest {
        let share = |axis: usize, bit: bool| if bit { point[axis] } else { 1.0 - point[axis] };
        let of = (0..8u32).map(|node| share(0, node & 4 != 0) * share(1, node & 1 != 0) * share(2, node & 2 != 0));
        weights.push(&(0..8).collect::<Vec<_>>(), &of.collect::<Vec<_>>());
    }
    let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut elements = IndexLists::default();
    elements.push(&[0, 4, 1, 5, 2, 6, 3, 7]);
    let fine = Body::builder(cage.rest().to_vec())
        .elements(elements)
        .carried(Arc::new(Carried { rest: rest.to_vec(), triangles, weights }))
        .build();
    let fine = Arc::new(fine.expect("a body"));
    let small = row(1, [0.3; 3]);
    assert_eq!(depth(&fine, &small, [0.0; 3]), None);
    assert!(depth(&fine, &small, [0.3; 3]).is_some());
    let floor = |height: f64| {
        let shape = Shape::Floor { normal: DVec3::Y, height };
        let surfaces = Surfaces::new(&[Arc::clone(&fine)], &[obstacle(shape)], &Contacts::default());
        surfaces.overlaps(fine.rest(), 0.0, |_| true).first().map(|found| found.depth)
    };
    assert_eq!(floor(0.39), None);
    assert!((floor(0.5).expect("it reaches below") - 0.1).abs() < 1e-12);
}

/// Positions of a run that diverges are no numbers.
#[test]
fn pairs_are_in_order_and_only_the_wanted_ones_are_compared() {
    let cube = row(1, [1.0; 3]);
    let surfaces = Surfaces::new(&[0; 4].map(|_| Arc::clone(&cube)), &[], &Contacts::default());
    let mut position = moved(&[0.0, 2.5, 0.5, 3.0].map(|x| (&cube, [x, 0.0, 0.0])));
    let pairs = |position: &[DVec3], wanted: &dyn Fn([Side; 2]) -> bool| {
        let found = surfaces.overlaps(position, 0.0, wanted);
        found.iter().map(|found| found.of).collect::<Vec<_>>()
    };
    let [first, second] = [[0, 2], [1, 3]].map(|of| of.map(Side::Body));
    assert_eq!(pairs(&position, &|_| true), [first, second]);
    assert_eq!(pairs(&position, &|pair| pair != first), [second]);
    position[..8].fill(DVec3::NAN);
    assert_eq!(pairs(&position, &|_| true), [second]);
}

#[test]
fn a_body_that_crosses_itself() {
    // Two tetrahedra of one body, in each other.
    let four = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let rest: Vec<_> = four.into_iter().chain(four.map(|at| at + DVec3::splat(2.0))).collect();
    let body = made(Dimension::Space, rest, [&[0, 1, 2, 3][..], &[4, 5, 6, 7]].into_iter());
    let at = |by: f64| four.into_iter().chain(four.map(|at| at + DVec3::splat(by))).collect::<Vec<_>>();
    let count = |itself: bool, by: f64| {
        let contacts = Contacts { bodies: vec![BodyContact { itself, thickness: None }], ..Contacts::default() };
        let surfaces = Surfaces::new(&[Arc::clone(&body)], &[], &contacts);
        surfaces.overlaps(&at(by), 0.0, |_| true).len()
    };
    assert_eq!([count(true, 0.1), count(true, 2.0), count(false, 0.1)], [1, 0, 0]);
}

/// Each body is moved out of those before it and of all obstacles, by the shortest way, to the distance that is kept.
#[test]
fn bodies_are_moved_apart() {
    let block = row(3, [1.0; 3]);
    let bodies = [0; 4].map(|_| Arc::clone(&block));
    // Half of the usual distance of two blocks of equal cells, whose surfaces have diagonals.
    let thickness = 0.02;
    let own = BodyContact { thickness: Some(thickness), itself: false };
    let contacts = Contacts { bodies: vec![own; 4], ..Contacts::default() };
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.0 });
    let ball = obstacle(Shape::Sphere { centre: DVec3::new(20.0, 0.0, 0.0), radius: 1.0 });
    let surfaces = Surfaces::new(&bodies, &[floor, ball], &contacts);
    let offsets = [[0.0; 3], [0.5, 0.9, 0.1], [18.9, -0.2, -0.5], [9.0, 5.0, 0.0]];
    let before = moved(&[0, 1, 2, 3].map(|at| (&block, offsets[at])));
    let mut after = before.clone();
    let ways = surfaces.separate(&mut after, 0.0, |_| true);
    assert_eq!(surfaces.overlaps(&after, 0.0, |_| true), []);
    // The second one goes upwards, the fourth one stays.
    assert!((ways[0], ways[3]) == (DVec3::ZERO, DVec3::ZERO), "{ways:?}");
    let up = 0.1 + 2.0 * thickness;
    assert!((ways[1].y - up).abs() < 1e-3 * up && ways[1].x == 0.0 && ways[1].z == 0.0, "{ways:?}");
    assert!(ways[2].length() > 0.0 && ways[2].y >= 0.2 - 1e-6, "{ways:?}");
    for (at, way) in ways.iter().enumerate() {
        let nodes = 16 * at..16 * (at + 1);
        assert!(nodes.clone().all(|node| after[node] == before[node] + *way));
    }
    // Bodies of different runs do not meet.
    let mut apart = moved(&[(&block, [0.0; 3]), (&block, [0.5, 0.9, 0.1])]);
    let two = Surfaces::new(&bodies[..2], &[], &contacts);
    assert_eq!(two.separate(&mut apart, 0.0, |_| false), [DVec3::ZERO; 2]);
    // Bodies at one place.
    let mut apart = moved(&[(&block, [0.0; 3]), (&block, [0.0; 3])]);
    let ways = two.separate(&mut apart, 0.0, |_| true);
    assert!((ways[1].length() - (1.0 + 2.0 * thickness)).abs() < 1e-3, "{ways:?}");
    assert_eq!(two.overlaps(&apart, 0.0, |_| true), []);
}

/// Between a floor and a ceiling that are nearer to each other than a body is high there is no way out.
#[test]
fn a_body_without_a_way_stays() {
    let block = row(1, [1.0; 3]);
    let floor = obstacle(Shape::Floor { normal: DVec3::Y, height: 0.1 });
    let ceiling = obstacle(Shape::Plate { point: DVec3::Y, normal: -DVec3::Y });
    let surfaces = Surfaces::new(&[Arc::clone(&block)], &[floor, ceiling], &Contacts::default());
    let mut at = block.rest().to_vec();
    assert_eq!(surfaces.separate(&mut at, 0.0, |_| true), [DVec3::ZERO]);
    assert_eq!(surfaces.overlaps(&at, 0.0, |_| true).len(), 1);
}
