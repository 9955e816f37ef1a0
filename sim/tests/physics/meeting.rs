//! Laws of pairs, and obstacles that move: each touch beside its right value.

use super::surfaces::{SIDE, block, still, with_contacts};
use super::touching::{flying, mean, obstacle, slab, steady, steps, world};
use glam::DVec3;
use localshape_sim::{Motion, Obstacle, PairContact, Shape, Side, Surroundings};
use std::sync::Arc;

/// A pair keeps the distance that it names, in whichever order it names the two, however slowly they approach.
#[test]
fn pairs_keep_their_own_distance() {
    let body = block([2; 3]);
    let far = 0.04;
    // Above the node in the middle of the upper face.
    let ball = Shape::Sphere { centre: DVec3::Y * 0.31, radius: 0.05 };
    for sides in [[Side::Body(0), Side::Body(1)], [Side::Body(0), Side::Obstacle(0)]] {
        for of in [sides, [sides[1], sides[0]]] {
            let pair = PairContact { of, restitution: None, friction: None, thickness: Some(far) };
            let is_ball = sides[1] == Side::Obstacle(0);
            let mut around = with_contacts(0.0, 0.0);
            around.contacts.as_mut().expect("contacts").pairs = vec![pair];
            around.obstacles.extend(is_ball.then(|| obstacle(ball.clone(), Motion::Still, 0.0)));
            let other = (Arc::clone(&body), still(DVec3::new(0.01, 0.36, 0.02)));
            let first = (Arc::clone(&body), flying(DVec3::ZERO, DVec3::Y * 0.3));
            let bodies = if is_ball { vec![first] } else { vec![first, other] };
            let mut world = world(&bodies, around);
            let mut least = f64::INFINITY;
            for _ in 0..steps(0.8) {
                world.advance(1);
                let (one, rest) = world.state().position.split_at(27);
                let top = one.iter().fold(f64::NEG_INFINITY, |most, at| most.max(at.y));
                let bottom = rest.iter().fold(f64::INFINITY, |least, at| least.min(at.y));
                let from_ball = one[1 + 3 * (2 + 3)].distance(DVec3::Y * 0.31) - 0.05;
                least = least.min(if is_ball { from_ball } else { bottom - top });
            }
            assert!((least - far).abs() < 0.02 * SIDE, "{of:?}: {least}");
        }
    }
}

/// A block slows down on a box with the friction of the box, unless a pair names another one.
#[test]
fn friction_is_that_of_the_obstacle_or_of_the_pair() {
    let body = block([2, 1, 2]);
    let [bodies, box_] = [Side::Body(0), Side::Obstacle(0)];
    for (of, expected) in [(None, 0.2), (Some([bodies, box_]), 0.4), (Some([box_, bodies]), 0.4)] {
        let pair = |of| PairContact { of, restitution: None, friction: Some(0.4), thickness: None };
        let mut around = with_contacts(0.0, 0.9);
        around.contacts.as_mut().expect("contacts").pairs = of.map(pair).into_iter().collect();
        around.gravity = DVec3::Y * -10.0;
        around.obstacles = vec![obstacle(slab([3.0, 0.1, 1.0], DVec3::Y * -0.153), Motion::Still, 0.2)];
        let mut world = world(&[(Arc::clone(&body), flying(DVec3::ZERO, DVec3::X * 2.0))], around);
        world.advance(steps(0.4));
        let speed = mean(&world.state().velocity).x;
        assert!((speed - (2.0 - expected * 10.0 * 0.4)).abs() < 0.05, "{of:?}: {speed}");
    }
}

/// A box that moves carries what lies on it, and pushes what is in its way, wherever it comes from.
#[test]
fn boxes_that_move_carry_and_push() {
    let body = block([2, 1, 2]);
    let mut around = with_contacts(0.0, 0.0);
    around.gravity = DVec3::Y * -10.0;
    let belt = slab([3.0, 0.1, 1.0], DVec3::Y * -0.153);
    around.obstacles = vec![obstacle(belt, steady(DVec3::X * 0.5, DVec3::ZERO), 0.5)];
    let mut carried = world(&[(Arc::clone(&body), still(DVec3::ZERO))], around);
    carried.advance(steps(0.6));
    let speed = mean(&carried.state().velocity).x;
    // It still shears a little.
    assert!((speed - 0.5).abs() < 0.05, "{speed}");
    // One comes straight, one on a circle.
    let straight = obstacle(slab([0.1; 3], DVec3::X * -2.0), steady(DVec3::X * 5.0, DVec3::ZERO), 0.0);
    let shape = slab([0.1; 3], DVec3::new(-2.0, 0.0, 2.0));
    let round = Obstacle { pivot: DVec3::Z * 2.0, ..obstacle(shape, steady(DVec3::ZERO, DVec3::Y * -3.0), 0.0) };
    for comes in [straight, round] {
        let around = Surroundings { obstacles: vec![comes.clone()], ..with_contacts(0.0, 0.0) };
        let mut hit = world(&[(Arc::clone(&body), still(DVec3::ZERO))], around);
        hit.advance(steps(0.6));
        let speed = mean(&hit.state().velocity);
        assert!(speed.length() > 3.0, "{comes:?}: {speed}");
        assert_eq!(hit.crossings(), Some(Vec::new()), "{comes:?}");
    }
}

/// Bodies that fly at each other are caught however far they are when their steps begin, though they move alone until they are near.
#[test]
fn bodies_that_come_from_afar_are_caught() {
    let body = block([2; 3]);
    for start in 0..30 {
        let far = 0.25 + 0.02 * f64::from(start);
        let placed =
            [-1.0, 1.0].map(|side| flying(DVec3::new(side * far, side * 0.03, 0.02), DVec3::X * (-5.0 * side)));
        let mut world = world(&placed.map(|placed| (Arc::clone(&body), placed)), with_contacts(0.0, 0.0));
        world.advance(200);
        assert_eq!(world.crossings(), Some(Vec::new()), "{far}");
        assert!(mean(&world.state().velocity[..27]).x < 1.0, "{far}");
    }
}
