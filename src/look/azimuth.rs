//! The azimuth of a camera whose scene names none: the first one from which obstacles hide nearly as little of the bodies as from any.

use super::camera::{Camera, axes};
use crate::sim::{Obstacle, Pose, Shape};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// The azimuths that a camera may take, in twelfths of a turn from the usual one: the nearest first, and last those from which the sides of
/// boxes along the axes hide their depth.
const TURNS: [i8; 12] = [0, 1, -2, 3, -3, 4, -5, 6, -1, 2, -4, 5];
/// The share of hidden nodes that is worth no other azimuth than those before.
#[cfg(feature = "render")]
const LITTLE: f64 = 0.05;
/// So many nodes of a run are looked at, spread by the golden ratio: an even stride could be a row of a lattice.
const NODES: usize = 64;
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Nodes that are not farther inside of a box (sizes of the box, or m) only touch it.
const TOUCHING: f64 = 1e-9;

/// How much of the bodies obstacles hide in a course, from each of the azimuths in [`azimuths`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Hidden {
    /// The shares of hidden nodes, each weighted with its time (s).
    shares: [f64; TURNS.len()],
    /// The time (s).
    all: f64,
}

/// The azimuths of a camera (rad): its own, and for a camera that turns others, in the order of preference.
pub(crate) fn azimuths(camera: &Camera) -> impl Iterator<Item = f64> {
    let turns = &TURNS[..if camera.turns { TURNS.len() } else { 1 }];
    turns.iter().map(|&turn| camera.azimuth + TAU / TURNS.len() as f64 * f64::from(turn))
}

impl Hidden {
    /// Adds nodes at positions (m) at a time (s), which stand for a while (s).
    pub(crate) fn add(
        &mut self,
        camera: &Camera,
        obstacles: &[Obstacle],
        [time, lasting]: [f64; 2],
        position: &[DVec3],
    ) {
        let place = |at: usize| ((at as f64 * GOLDEN).fract() * position.len() as f64) as usize;
        let nodes: Vec<_> = (0..NODES).filter_map(|at| position.get(place(at))).collect();
        self.all += lasting;
        for (azimuth, share) in azimuths(camera).zip(&mut self.shares) {
            let [_, _, towards] = axes(azimuth, camera.elevation);
            let seen = obstacles.iter().map(|obstacle| {
                let pose = obstacle.pose(time);
                (obstacle, pose, pose.rotation.conjugate() * towards)
            });
            let seen: Vec<_> = seen.collect();
            let hides = |at: DVec3| {
                move |(obstacle, pose, ray): &(&Obstacle, Pose, DVec3)| {
                    is_before(&obstacle.shape, pose.undo(obstacle.pivot, at), *ray)
                }
            };
            let hidden = nodes.iter().filter(|&&&at| seen.iter().any(hides(at))).count();
            *share += lasting * hidden as f64 / nodes.len().max(1) as f64;
        }
    }

    /// Adds what was seen in another course.
    #[cfg(feature = "render")]
    pub(crate) fn merge(&mut self, other: &Self) {
        self.shares.iter_mut().zip(other.shares).for_each(|(share, more)| *share += more);
        self.all += other.all;
    }

    /// The place of the chosen azimuth among all.
    #[cfg(feature = "render")]
    pub(crate) fn choice(&self) -> usize {
        let least = self.shares.iter().copied().fold(f64::INFINITY, f64::min);
        let is_enough = |&share: &f64| share <= least + LITTLE * self.all;
        self.shares.iter().position(is_enough).unwrap_or_default()
    }
}

/// Whether a ray of a direction (a unit vector) from a point (m) outside meets a shape. Half-spaces hide nothing: they are drawn as grounds and
/// as plates that can be seen through.
fn is_before(shape: &Shape, from: DVec3, ray: DVec3) -> bool {
    match *shape {
        Shape::Floor { .. } | Shape::Plate { .. } => false,
        Shape::Sphere { centre, radius } => is_near([centre; 2], radius, from, ray),
        Shape::Capsule { from: one, to, radius } => is_near([one, to], radius, from, ray),
        Shape::Box { centre, half, rotation } => {
            let [from, ray] = [from - centre, ray].map(|vector| rotation.conjugate() * vector);
            // Where the ray enters and leaves the slab between each two sides; one along a slab is in it or never.
            let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
            for axis in 0..3 {
                let ends = [-half[axis], half[axis]].map(|side| (side - from[axis]) / ray[axis]);
                enters = enters.max(ends[0].min(ends[1]));
                leaves = leaves.min(ends[0].max(ends[1]));
            }
            // A node that touches a side is not behind it.
            from.is_finite() && enters < leaves && leaves > TOUCHING * half.max_element().min(1.0)
        }
    }
}

/// Whether a ray comes nearer to a segment than a radius (m).
fn is_near([one, to]: [DVec3; 2], radius: f64, from: DVec3, ray: DVec3) -> bool {
    // Seen along the ray, the point of the segment that is nearest to it.
    let across = |vector: DVec3| vector - vector.dot(ray) * ray;
    let (along, away) = (across(to - one), across(from - one));
    let share = (away.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let nearest = one + share * (to - one);
    (nearest - from).dot(ray) > 0.0 && across(nearest - from).length() < radius
}

#[cfg(all(test, feature = "render"))]
mod tests {
    use super::*;
    use crate::sim::Motion;
    use glam::DQuat;

    const CAMERA: Camera = Camera {
        azimuth: 0.5,
        elevation: 0.3,
        field_of_view: 0.3,
        target: DVec3::ZERO,
        distance: 10.0,
        follow: true,
        turns: true,
    };

    /// What stands a metre before bodies at the origin, seen from an azimuth.
    fn before(azimuth: f64, shape: impl Fn(DVec3) -> Shape) -> Obstacle {
        let [_, _, towards] = axes(azimuth, CAMERA.elevation);
        let (motion, pivot) = (Motion::Still, DVec3::ZERO);
        let shape = shape(towards);
        Obstacle { shape, motion, pivot, restitution: 0.0, friction: 0.0, friction_of: Default::default() }
    }

    fn chosen(obstacles: &[Obstacle]) -> usize {
        let mut hidden = Hidden::default();
        let nodes: Vec<_> = (0..27).map(|at| DVec3::new(f64::from(at % 3), f64::from(at / 3 % 3), 0.1) * 0.1).collect();
        hidden.add(&CAMERA, obstacles, [0.0, 1.0], &nodes);
        hidden.choice()
    }

    fn ball(at: DVec3) -> Shape {
        Shape::Sphere { centre: at, radius: 0.45 }
    }

    #[test]
    fn the_first_azimuth_is_chosen_from_which_little_is_hidden() {
        let all: Vec<_> = azimuths(&CAMERA).collect();
        assert_eq!((all[0], all.len()), (0.5, 12));
        let mut turns = TURNS;
        turns.sort();
        assert!(turns.into_iter().eq(-5..=6));
        assert_eq!(chosen(&[]), 0);
        let capsule = |at: DVec3| Shape::Capsule { from: at - DVec3::Y, to: at + DVec3::Y, radius: 0.45 };
        let cuboid = |at: DVec3| Shape::Box {
            centre: at,
            half: DVec3::new(0.45, 3.0, 0.1),
            rotation: DQuat::from_rotation_y(all[0]),
        };
        for shape in [&ball as &dyn Fn(DVec3) -> Shape, &capsule, &cuboid] {
            assert_eq!(chosen(&[before(all[0], shape)]), 1);
            assert_eq!(chosen(&[before(all[0] + std::f64::consts::PI, shape)]), 0);
        }
        assert_eq!(chosen(&[before(all[0], ball), before(all[1], ball)]), 2);
    }

    #[test]
    fn where_all_azimuths_are_as_good_the_usual_one_stays() {
        assert_eq!(chosen(&azimuths(&CAMERA).map(|azimuth| before(azimuth, ball)).collect::<Vec<_>>()), 0);
        let plate = |at: DVec3| Shape::Plate { point: at, normal: -at };
        assert_eq!(chosen(&[before(0.5, plate)]), 0);
    }

    /// Nodes of a lattice are looked at all over it: a ball before half of it hides about half.
    #[test]
    fn what_is_looked_at_is_spread_over_a_lattice() {
        let nodes: Vec<_> = (0..2048).map(|at| DVec3::new(f64::from(at % 32), 0.0, f64::from(at / 32))).collect();
        let [right, _, towards] = axes(CAMERA.azimuth, CAMERA.elevation);
        let middle = DVec3::new(15.5, 0.0, 31.5);
        let wall = Obstacle {
            shape: Shape::Sphere { centre: middle + 1e5 * right + 1e3 * towards, radius: 1e5 },
            ..before(0.0, ball)
        };
        let mut hidden = Hidden::default();
        hidden.add(&CAMERA, &[wall], [0.0, 1.0], &nodes);
        assert!((hidden.shares[0] - 0.5).abs() < 0.1, "{hidden:?}");
    }
}
