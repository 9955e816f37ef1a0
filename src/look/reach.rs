//! The obstacles and grips that come near the body at any time of a scene, so that the camera can show them.

use super::subject::Subject;
use crate::sim::geometry::bounds;
use crate::sim::{Dimension, Grip, Motion, Obstacle, Shape};
use glam::DVec3;

/// Objects farther from the body than this (body sizes) do not affect the camera, so that bodies stay large.
const NEAR: f64 = 1.25;
/// Half the side of the shown part of a plate (body sizes).
const PLATE: f64 = 0.85;
/// The number of parts of the path between two keys, and of a swing.
const PARTS: usize = 24;
/// Of paths with more keys, only the keys are considered.
const MANY_KEYS: usize = 500;

/// The points (m) of obstacles and grips that come near the box around a body of a size (m) at any time.
pub(crate) fn near(scene: &Subject<'_>, [low, high]: [DVec3; 2], size: f64) -> Vec<DVec3> {
    let (low, high) = (low - NEAR * size, high + NEAR * size);
    let around = Neighbourhood { scene, size, middle: (low + high) / 2.0, corners: [low, high] };
    let mut points = Vec::new();
    scene.obstacles.iter().for_each(|obstacle| around.add_obstacle(obstacle, &mut points));
    scene.grips.iter().for_each(|grip| around.add_grip(grip, &mut points));
    points
}

struct Neighbourhood<'a> {
    scene: &'a Subject<'a>,
    size: f64,
    middle: DVec3,
    corners: [DVec3; 2],
}

impl Neighbourhood<'_> {
    fn add(&self, point: DVec3, points: &mut Vec<DVec3>) {
        let [low, high] = self.corners;
        let in_plane = self.scene.body.dimension == Dimension::Plane;
        let point = if in_plane { point.truncate().extend(0.0) } else { point };
        if point.cmpge(low).all() && point.cmple(high).all() {
            points.push(point);
        }
    }

    fn add_obstacle(&self, obstacle: &Obstacle, points: &mut Vec<DVec3>) {
        let outermost = self.outermost(&obstacle.shape);
        if outermost.is_empty() {
            return;
        }
        let pivot = obstacle.pivot;
        for time in times(&obstacle.motion, [0.0, self.scene.duration]) {
            let pose = obstacle.pose(time);
            outermost.iter().for_each(|&point| self.add(pose.apply(pivot, point), points));
            // Only the nearest part of a large obstacle may be in the picture.
            let nearest = nearest(&obstacle.shape, pose.undo(pivot, self.middle));
            nearest.into_iter().for_each(|point| self.add(pose.apply(pivot, point), points));
        }
    }

    /// The outermost points of an obstacle before it moves; none for floors, which are everywhere.
    fn outermost(&self, shape: &Shape) -> Vec<DVec3> {
        let around = |middle: DVec3, radius: f64| {
            DVec3::AXES.into_iter().flat_map(move |axis| [middle - radius * axis, middle + radius * axis])
        };
        match *shape {
            Shape::Floor { .. } => Vec::new(),
            Shape::Plate { point, normal } => {
                let first = (DVec3::X - normal.x * normal).try_normalize().unwrap_or(DVec3::Z);
                let second = first.cross(normal);
                let half = PLATE * self.size;
                [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]]
                    .map(|[a, b]| point + half * (a * first + b * second))
                    .to_vec()
            }
            Shape::Sphere { centre, radius } => around(centre, radius).collect(),
            Shape::Capsule { from, to, radius } => around(from, radius).chain(around(to, radius)).collect(),
            Shape::Box { centre, half, rotation } => {
                let half = DVec3::select(half.is_finite_mask(), half, DVec3::ZERO);
                let sign = |corner: u32, axis: u32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
                let corner = |at: u32| half * DVec3::new(sign(at, 0), sign(at, 1), sign(at, 2));
                (0..8).map(|at| centre + rotation * corner(at)).collect()
            }
        }
    }

    fn add_grip(&self, grip: &Grip, points: &mut Vec<DVec3>) {
        let start: Vec<_> =
            grip.nodes.iter().filter_map(|&node| self.scene.initial.position.get(node as usize).copied()).collect();
        let (low, high) = bounds(&start);
        let middle = start.iter().sum::<DVec3>() / start.len().max(1) as f64;
        for time in times(&grip.motion, [grip.from, grip.until.min(self.scene.duration)]) {
            let way = grip.pose(time);
            let corner = |at: u32| {
                let pick = |axis: usize| if at >> axis & 1 == 1 { high[axis] } else { low[axis] };
                DVec3::new(pick(0), pick(1), pick(2))
            };
            (0..8).for_each(|at| self.add(way.apply(middle, corner(at)), points));
        }
    }
}

/// The point of an obstacle that is nearest to another point; `None` for half-spaces.
fn nearest(shape: &Shape, to: DVec3) -> Option<DVec3> {
    let ball = |middle: DVec3, radius: f64| middle + (to - middle).clamp_length_max(radius);
    match *shape {
        Shape::Floor { .. } | Shape::Plate { .. } => None,
        Shape::Sphere { centre, radius } => Some(ball(centre, radius)),
        Shape::Capsule { from, to: end, radius } => {
            let along = end - from;
            let squared = along.length_squared();
            let share = if squared > 0.0 { ((to - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            Some(ball(from + share * along, radius))
        }
        Shape::Box { centre, half, rotation } => {
            let local = rotation.conjugate() * (to - centre);
            Some(centre + rotation * local.clamp(-half, half))
        }
    }
}

/// Times between two others (s) at which a motion is at all its extreme places.
fn times(motion: &Motion, [from, until]: [f64; 2]) -> Vec<f64> {
    let between =
        |from: f64, to: f64, parts: usize| (0..=parts).map(move |part| from + (to - from) * part as f64 / parts as f64);
    let times: Vec<_> = match motion {
        Motion::Still => vec![from],
        Motion::Keys { keys, .. } if keys.len() > MANY_KEYS => keys.iter().map(|key| key.time).collect(),
        Motion::Keys { keys, .. } => {
            keys.windows(2).flat_map(|two| between(two[0].time, two[1].time, PARTS)).chain([from]).collect()
        }
        Motion::Swing { period, .. } => between(from, until.min(from + period), 2 * PARTS).collect(),
    };
    times.into_iter().filter(|time| (from..=until).contains(time)).collect()
}
