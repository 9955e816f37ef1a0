//! Loads: forces on the nodes and faces of bodies, as they change with time and with the motion of the bodies.

use super::carried::Weights;
use super::motion::{Ease, Interval};
use glam::{DMat3, DVec3};
use std::fmt;
use std::ops::Range;

/// Forces on nodes, such as a push, wind or a spring to a point outside. They may change with time and with positions. Closures with the
/// arguments of [`Self::add`] are loads, too.
pub trait Load: Send + Sync {
    /// Adds the forces (N) on all nodes, which are at `position` (m) at a time (s), to `forces`, one for each node. The same arguments add
    /// the same forces: a step may be evaluated more than once.
    fn add(&self, time: f64, position: &[DVec3], forces: &mut [DVec3]);

    /// The nodes whose positions it reads and on which its forces are, in rising order; `None` for all.
    fn nodes(&self) -> Option<&[u32]> {
        None
    }

    /// Adds the greatest forces that it can have at some positions, from which the speed is known above which a world has diverged. False if
    /// they are not known.
    fn add_greatest(&self, position: &[DVec3], forces: &mut [DVec3]) -> bool {
        let _ = (position, forces);
        false
    }

    /// Whether it adds the same forces at all times and positions in a step. A fast step then costs no more than without it.
    fn is_steady(&self, interval: Interval) -> bool {
        let _ = interval;
        false
    }
}

impl<F: Fn(f64, &[DVec3], &mut [DVec3]) + Send + Sync> Load for F {
    fn add(&self, time: f64, position: &[DVec3], forces: &mut [DVec3]) {
        self(time, position, forces);
    }
}

impl fmt::Debug for dyn Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Load")
    }
}

/// The share of a load that acts at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// When the load acts (s), without the end.
    pub during: Range<f64>,
    /// Times (s), which rise, and the shares then. Before the first and after the last the share is theirs; without keys it is 1.
    pub keys: Vec<[f64; 2]>,
    /// The interpolation between keys.
    pub ease: Ease,
}

impl Course {
    /// The whole load, always.
    pub const ALWAYS: Self = Self { during: 0.0..f64::INFINITY, keys: Vec::new(), ease: Ease::Linear };

    /// The share at a time (s).
    pub fn share(&self, time: f64) -> f64 {
        if !self.during.contains(&time) {
            return 0.0;
        }
        let after = self.keys.partition_point(|&[key, _]| key <= time);
        match (after.checked_sub(1).map(|before| self.keys[before]), self.keys.get(after)) {
            (Some([from, one]), Some(&[to, other])) => {
                one + (other - one) * self.ease.share((time - from) / (to - from))
            }
            (Some([_, share]), None) | (None, Some(&[_, share])) => share,
            (None, None) => 1.0,
        }
    }

    /// The greatest share, without its sign.
    pub fn greatest(&self) -> f64 {
        if self.keys.is_empty() {
            1.0
        } else {
            self.keys.iter().fold(0.0, |most: f64, [_, share]| most.max(share.abs()))
        }
    }

    /// The time (s) after which the share does not change.
    pub fn end(&self) -> f64 {
        let ends = [self.during.start, self.during.end].into_iter().filter(|end| end.is_finite());
        ends.chain(self.keys.last().map(|[time, _]| *time)).fold(0.0, f64::max)
    }

    /// Whether the share is the same during a step, with its ends.
    fn is_steady(&self, Interval { begin, end, .. }: Interval) -> bool {
        let starts_or_ends = [self.during.start, self.during.end].iter().any(|&at| begin < at && at <= end);
        let inside = self.keys.iter().filter(|&&[time, _]| begin < time && time < end);
        let share = self.share(begin);
        !starts_or_ends && self.share(end) == share && inside.into_iter().all(|&[_, at_key]| at_key == share)
    }
}

/// A load on some nodes over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Loading {
    /// The nodes, in rising order.
    nodes: Vec<u32>,
    pull: Pull,
    course: Course,
}

/// What a load does at its full share.
#[derive(Clone, Debug, PartialEq)]
pub enum Pull {
    /// A force of constant size and direction on each node (N).
    Dead(Vec<DVec3>),
    /// A torque (N m), with the weight of each node.
    Torque(DVec3, Vec<f64>),
    /// A pressure (Pa) on faces by their corners.
    Pressure(f64, Vec<Vec<u32>>),
    /// A pressure (Pa) on triangles of carried points.
    CarriedPressure(f64, Vec<[u32; 3]>, Weights),
    /// The centrifugal force of a frame that turns.
    Centrifugal(Turning),
}

/// A frame that turns, and the masses in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Turning {
    /// The angular velocity of the frame (rad/s).
    pub rate: DVec3,
    /// A point of its axis (m).
    pub about: DVec3,
    /// The mass of each node (kg).
    pub masses: Vec<f64>,
}

impl Loading {
    /// Forces of constant size and direction on nodes, in rising order (N): a push, a traction, a uniform acceleration of masses.
    pub fn dead(nodes: Vec<u32>, forces: Vec<DVec3>, course: Course) -> Self {
        Self { nodes, pull: Pull::Dead(forces), course }
    }

    /// A torque (N m) about the centre of nodes, in rising order, wherever they are. Each has a weight, and the weights have the sum 1. The
    /// forces, `w ω × r` for a weight w and a node at r from the centre, have no sum.
    pub fn torque(nodes: Vec<u32>, weights: Vec<f64>, torque: DVec3, course: Course) -> Self {
        Self { nodes, pull: Pull::Torque(torque, weights), course }
    }

    /// A pressure (Pa) on faces as they are now, towards the body: it stays at right angles to them. Faces are given by their corners,
    /// counter-clockwise seen from outside.
    ///
    /// A face of more than three corners is a fan of triangles about the mean of its corners. So on a closed surface the forces are the pressure
    /// times the gradient of the volume, and have neither a sum nor a torque. In the plane a face is a side of two corners with the body at its
    /// left, and the pressure is in N/m.
    pub fn pressure(faces: Vec<Vec<u32>>, pressure: f64, course: Course) -> Self {
        let mut nodes: Vec<u32> = faces.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, pull: Pull::Pressure(pressure, faces), course }
    }

    /// A pressure (Pa) as [`Self::pressure`], on triangles of points that nodes carry. The force on a point is shared by the nodes that carry it
    /// by their weights: with the virtual work of the pressure on the triangles.
    pub fn pressure_on_carried(triangles: Vec<[u32; 3]>, points: Weights, pressure: f64, course: Course) -> Self {
        let mut nodes: Vec<u32> = (0..points.len()).flat_map(|point| points.of(point).0).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, pull: Pull::CarriedPressure(pressure, triangles, points), course }
    }

    /// The centrifugal force on nodes, in rising order, in a frame that turns about an axis: `m ω² r` away from it. The Coriolis force on what
    /// moves in the frame is not part of it, so it is for rest and for motion that is slow beside that of the frame.
    pub fn centrifugal(nodes: Vec<u32>, turning: Turning, course: Course) -> Self {
        Self { nodes, pull: Pull::Centrifugal(turning), course }
    }

    /// What it does at its full share.
    pub fn pull(&self) -> &Pull {
        &self.pull
    }

    /// When it acts.
    pub fn course(&self) -> &Course {
        &self.course
    }

    /// Adds a share of its forces (N) on nodes at `position` (m).
    fn add_share(&self, share: f64, position: &[DVec3], forces: &mut [DVec3]) {
        match &self.pull {
            _ if share == 0.0 => {}
            Pull::Dead(pulls) => {
                let nodes = self.nodes.iter().zip(pulls);
                nodes.for_each(|(&node, &pull)| forces[node as usize] += pull * share);
            }
            Pull::Torque(torque, weights) => {
                let nodes: Vec<_> = self.nodes.iter().map(|&node| node as usize).zip(weights.iter().copied()).collect();
                turn(&nodes, *torque * share, position, forces);
            }
            Pull::Pressure(pressure, faces) => faces.iter().for_each(|face| {
                for_each_area(face, position, |node, area| forces[node as usize] -= area * (pressure * share));
            }),
            Pull::CarriedPressure(pressure, triangles, points) => {
                let at: Vec<DVec3> = (0..points.len()).map(|point| points.place(point, position)).collect();
                let mut areas = vec![DVec3::ZERO; at.len()];
                let triangles = triangles.iter();
                triangles.for_each(|face| for_each_area(face, &at, |point, area| areas[point as usize] += area));
                for (point, area) in areas.into_iter().enumerate() {
                    let (nodes, weights) = points.of(point);
                    let force = area * (pressure * share);
                    nodes.iter().zip(weights).for_each(|(&node, &weight)| forces[node as usize] -= force * weight);
                }
            }
            Pull::Centrifugal(Turning { rate, about, masses }) => {
                for (&node, mass) in self.nodes.iter().zip(masses) {
                    let arm = position[node as usize] - *about;
                    forces[node as usize] += rate.cross(arm).cross(*rate) * (mass * share);
                }
            }
        }
    }
}

impl Load for Loading {
    fn add(&self, time: f64, position: &[DVec3], forces: &mut [DVec3]) {
        self.add_share(self.course.share(time), position, forces);
    }

    fn nodes(&self) -> Option<&[u32]> {
        Some(&self.nodes)
    }

    fn is_steady(&self, interval: Interval) -> bool {
        let is_dead = matches!(self.pull, Pull::Dead(_)) || self.course.share(interval.begin) == 0.0;
        is_dead && self.course.is_steady(interval)
    }

    fn add_greatest(&self, position: &[DVec3], forces: &mut [DVec3]) -> bool {
        self.add_share(self.course.greatest(), position, forces);
        true
    }
}

/// Adds the forces (N) of a torque (N m) on nodes with weights.
fn turn(nodes: &[(usize, f64)], torque: DVec3, position: &[DVec3], forces: &mut [DVec3]) {
    /// Nodes lie on a line if the determinant of their inertia is below this share of the cube of their size.
    const ON_A_LINE: f64 = 1e-12;
    let centre: DVec3 = nodes.iter().map(|&(node, weight)| position[node] * weight).sum();
    let product = |arm: DVec3| DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
    let (mut inertia, mut size, mut longest) = (DMat3::ZERO, 0.0, DVec3::ZERO);
    for &(node, weight) in nodes {
        let arm = position[node] - centre;
        let square = arm.length_squared();
        inertia += (DMat3::from_diagonal(DVec3::splat(square)) - product(arm)) * weight;
        size += square * weight;
        longest = if square > longest.length_squared() { arm } else { longest };
    }
    if inertia.determinant() < ON_A_LINE * size * size * size {
        // Nothing can be turned about the line on which all nodes lie.
        inertia += product(longest.normalize_or_zero()) * size;
    }
    let rate = inertia.inverse() * torque;
    // Nodes at one point have no arm.
    for &(node, weight) in nodes.iter().filter(|_| rate.is_finite()) {
        forces[node] += rate.cross(position[node] - centre) * weight;
    }
}

/// Calls `visit` with each corner of a face and its share of the area as a vector along the outward normal (m², in the plane m).
pub fn for_each_area(face: &[u32], position: &[DVec3], mut visit: impl FnMut(u32, DVec3)) {
    let at = |corner: usize| position[face[corner % face.len()] as usize];
    match face {
        [_, _] => {
            let along = at(1) - at(0);
            face.iter().for_each(|&node| visit(node, 0.5 * DVec3::new(along.y, -along.x, 0.0)));
        }
        [_, _, _] => {
            let area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0));
            face.iter().for_each(|&node| visit(node, area / 3.0));
        }
        _ => {
            let count = face.len() as f64;
            let middle = (0..face.len()).map(at).sum::<DVec3>() / count;
            let triangle = |corner: usize| 0.5 * (at(corner) - middle).cross(at(corner + 1) - middle);
            let whole: DVec3 = (0..face.len()).map(triangle).sum();
            for (corner, &node) in face.iter().enumerate() {
                let beside = triangle(corner) + triangle(corner + face.len() - 1);
                visit(node, (beside + whole / count) / 3.0);
            }
        }
    }
}
