//! Plates and walls: transparent slabs, sorted by depth.

use super::half_space::{HalfSpace, clipped_line, clipped_polygon};
use super::shapes::{FACES, corners, edges};
use super::space::Staging;
use crate::picture::layout::steps::{CLOSE, FREE};
use crate::picture::narrow::narrow;
use crate::picture::plane::around;
use crate::picture::shadow::Plane;
use crate::picture::{Item, Pane, PaneCorner};
use crate::runner::history::NearObstacles;
use crate::sim::{Motion, Obstacle, Pose, Shape};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Half the side of a plate, and its thickness (body sizes).
const PLATE: f64 = 0.85;
const THICKNESS: f64 = 0.042;
/// The margins of a plate around the start of the body, unless the start is farther away than the last one, and around
/// all places where nodes come near it at any time in any run, however far away (body sizes).
const START_MARGIN: f64 = 0.25;
const MARGIN: f64 = 0.12;
const FARTHEST_EDGE: f64 = 4.0;
/// Opacity of the two sides of a plate, and of the small faces around it.
const PLATE_ALPHA: [f32; 2] = [0.50, 0.80];
/// The extent of walls and slopes around the places where nodes come near them (body sizes).
const WALL: f64 = 2.1;
/// Opacity of a wall, seen from its front and from its solid back.
const WALL_ALPHA: [f32; 2] = [0.75, 0.38];
/// More slabs than this are sorted by distance alone.
const MANY_SLABS: usize = 64;

/// A slab before sorting.
pub(super) struct Loose {
    panes: Vec<Pane>,
    pub(super) edges: Vec<[[f32; 3]; 2]>,
    /// The plane of its surface (m).
    plane: HalfSpace,
    /// Its corners (m).
    corners: Vec<DVec3>,
}

impl Staging<'_> {
    /// The middle of the drawn part of a plate's surface (m), and half its sides (m), which are the same at all times.
    pub(super) fn span(&self, at: usize, pose: &Pose, normal: DVec3) -> (DVec3, DVec2) {
        let obstacle = &self.draft.scene.obstacles[at];
        let pivot = obstacle.pivot;
        let [first, second] = Plane::new(normal, 0.0).axes;
        let farthest = FARTHEST_EDGE * self.extent();
        let (mut low, mut high) = (DVec2::splat(-PLATE * self.extent()), DVec2::splat(PLATE * self.extent()));
        // The box, on the plate at the start, around the corners of a box.
        let around = |[from, to]: [DVec3; 2], before: &Pose| {
            let corners = corners(from.midpoint(to), DVec3::AXES, 0.5 * (to - from));
            let places = corners.map(|corner| {
                let own = before.undo(pivot, corner) - pivot;
                DVec2::new(own.dot(first), own.dot(second))
            });
            let low = places.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            [low, places.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max)]
        };
        // The plate covers the start of the body,
        let [from, to] = around(self.draft.composer.start_box, &obstacle.pose(0.0));
        if from.max_element() < farthest && to.min_element() > -farthest {
            let margin = START_MARGIN * self.extent();
            low = low.min(from - margin).max(DVec2::splat(-farthest));
            high = high.max(to + margin).min(DVec2::splat(farthest));
        }
        // and the places where nodes come near it.
        if let Some(reached) = self.draft.composer.reach.of(at) {
            let [from, to] = around(reached, &Pose::NONE);
            let margin = MARGIN * self.extent();
            low = low.min(from - margin);
            high = high.max(to + margin);
        }
        let middle = low.midpoint(high);
        (pose.apply(pivot, pivot + middle.x * first + middle.y * second), 0.5 * (high - low))
    }

    /// The arrows of moving plates, in the whole panel.
    pub(in crate::picture) fn arrows(&self, marks: &mut Vec<Item>) {
        for (at, obstacle) in self.draft.scene.obstacles.iter().enumerate() {
            let Shape::Plate { normal, .. } = obstacle.shape else { continue };
            if obstacle.motion == Motion::Still {
                continue;
            }
            let pose = obstacle.pose(self.time());
            let out = pose.rotation * normal;
            let (middle, half) = self.span(at, &pose, normal);
            let (velocity, greatest) = self.going(obstacle, middle, half.max_element());
            // The arrow is on the side without the body.
            let arriving = velocity.dot(out) > 0.0;
            // In the plane a plate is a line.
            let [thickness, gap] = if self.draft.flat { [0.0, CLOSE] } else { [THICKNESS * self.extent(), FREE] };
            let from = middle - thickness * out;
            marks.extend(self.draft.pointer((from, velocity, greatest), arriving, gap, self.draft.viewport));
        }
    }

    /// The velocity of an obstacle at one of its points (m), and its greatest speed within about `reach` (m) of its pivot (m/s).
    fn going(&self, obstacle: &Obstacle, point: DVec3, reach: f64) -> (DVec3, f64) {
        let (pivot, time) = (obstacle.pivot, self.time());
        let own = obstacle.pose(time).undo(pivot, point);
        let half = 0.25 * (1.0 / self.draft.scene.frames_per_second);
        let [before, after] = [time - half, time + half].map(|time| obstacle.pose(time).apply(pivot, own));
        ((after - before) / (2.0 * half), obstacle.motion.greatest_speed(reach))
    }

    /// A plate: a thin box that ends at floors.
    pub(super) fn plate(&self, at: usize, pose: &Pose, normal: DVec3, floors: &[HalfSpace]) -> Option<Loose> {
        let (middle, half) = self.span(at, pose, normal);
        let [first, second] = Plane::new(normal, 0.0).axes.map(|axis| pose.rotation * axis);
        let out = pose.rotation * normal;
        let thickness = THICKNESS * self.extent();
        // The axes are right-handed, like those of a box.
        let axes = [second, first, out];
        let behind = middle - 0.5 * thickness * out;
        let corners = corners(behind, axes, DVec3::new(half.y, half.x, 0.5 * thickness));
        let (mut panes, mut kept, mut seen, mut drawn) = (Vec::new(), Vec::new(), [false; 6], Vec::new());
        for (face, nodes) in FACES.iter().enumerate() {
            let normal = axes[face / 2] * if face % 2 == 0 { -1.0 } else { 1.0 };
            let polygon = nodes.map(|node| corners[node]);
            seen[face] = self.draft.lens.sees(polygon[0], normal);
            let polygon = clipped_polygon(&polygon, floors);
            if seen[face] && polygon.len() > 2 {
                // The thin faces around it stand out, like the edges of glass.
                let alpha = PLATE_ALPHA[usize::from(face < 4)];
                let colour = if face < 4 { self.palette().plate_side } else { self.palette().plate };
                let corner = |&at: &DVec3| PaneCorner { position: self.draft.relative(at), ..PaneCorner::default() };
                panes.push(Pane { corners: polygon.iter().map(corner).collect(), colour, alpha, grid: false });
            }
            if seen[face] {
                // At a floor it has an edge, too.
                let on = |point: DVec3, (out, height): HalfSpace| {
                    (out.dot(point) - height).abs() < 1e-9 * (self.extent() + height.abs())
                };
                let cut = around(&polygon).filter(|&(&a, &b)| floors.iter().any(|&at| on(a, at) && on(b, at)));
                drawn.extend(cut.map(|(&a, &b)| [a, b].map(|end| self.draft.relative(end))));
            }
            kept.extend(polygon);
        }
        for ([a, b], [one, other]) in edges() {
            if seen[one] || seen[other] {
                let edge = clipped_line([corners[a], corners[b]], floors);
                drawn.extend(edge.map(|ends| ends.map(|end| self.draft.relative(end))));
            }
        }
        (!panes.is_empty()).then(|| Loose { panes, edges: drawn, plane: (out, out.dot(middle)), corners: kept })
    }

    /// A floor that is not the ground, with a grid: the part around all places where nodes come near it at any time in
    /// any run, or around the start of the body if none does.
    pub(super) fn wall(&self, at: usize, normal: DVec3, floor: HalfSpace, others: &[HalfSpace]) -> Option<Loose> {
        const CORNERS: usize = 16;
        let obstacle = &self.draft.scene.obstacles[at];
        let (out, height) = floor;
        let pose = obstacle.pose(self.time());
        let [from, to] = self
            .draft
            .composer
            .reach
            .of(at)
            .unwrap_or([self.draft.composer.start_box[0].midpoint(self.draft.composer.start_box[1]); 2]);
        let middle = pose.apply(obstacle.pivot, from.midpoint(to));
        let mut middle = middle + (height - out.dot(middle)) * out;
        // Along the slope to the place where it leaves the others.
        for &(other, level) in others {
            let depth = level - other.dot(middle);
            let along = other - other.dot(out) * out;
            if depth > 0.0 && along.length_squared() > 0.01 {
                middle += depth / along.length_squared() * along;
            }
        }
        let axes = Plane::new(normal, 0.0).axes.map(|axis| pose.rotation * axis);
        let reach = WALL * self.extent() + 0.5 * from.distance(to);
        // The polygon is circumscribed about the circle in which it fades.
        let around = (0..CORNERS).map(|at| {
            let (sine, cosine) = libm::sincos(TAU * at as f64 / CORNERS as f64);
            middle + reach / libm::cos(PI / CORNERS as f64) * (cosine * axes[0] + sine * axes[1])
        });
        let polygon = clipped_polygon(&around.collect::<Vec<_>>(), others);
        if polygon.len() < 3 {
            return None;
        }
        let seen = self.draft.lens.sees(middle, out);
        let anchor = pose.apply(obstacle.pivot, DVec3::ZERO);
        let cell = self.draft.cell();
        let shift = axes.map(|axis| {
            // The grid's lines go through the origin of the world, moved with the floor.
            ((middle - anchor) / self.draft.side).dot(axis).rem_euclid(cell) / cell
        });
        let corner = |&at: &DVec3| {
            let from_middle = axes.map(|axis| (at - middle).dot(axis));
            let grid = [0, 1].map(|axis| from_middle[axis] / (self.draft.side * cell) + shift[axis]);
            PaneCorner {
                position: self.draft.relative(at),
                grid: grid.map(narrow),
                from_middle: from_middle.map(|at| narrow(at / reach)),
            }
        };
        let pane = Pane {
            corners: polygon.iter().map(corner).collect(),
            colour: self.palette().wall,
            alpha: WALL_ALPHA[usize::from(!seen)],
            grid: true,
        };
        Some(Loose { panes: vec![pane], edges: Vec::new(), plane: floor, corners: polygon })
    }

    /// The faces of slabs from the farthest to the nearest.
    pub(super) fn in_order(&self, mut slabs: Vec<Loose>) -> Vec<Pane> {
        let distance = |loose: &Loose| {
            let count = loose.corners.len().max(1) as f64;
            (loose.corners.iter().sum::<DVec3>() / count - self.draft.lens.eye).length()
        };
        slabs.sort_by(|one, other| distance(other).total_cmp(&distance(one)));
        if slabs.len() > MANY_SLABS {
            return slabs.into_iter().flat_map(|loose| loose.panes).collect();
        }
        // A slab is drawn when none of the others lies behind it. If slabs cross, the farthest is drawn first.
        let mut ordered = Vec::with_capacity(slabs.len());
        while !slabs.is_empty() {
            let covers_none = |at: &usize| {
                slabs.iter().enumerate().all(|(other, loose)| other == *at || !self.covers(&slabs[*at], loose))
            };
            let next = (0..slabs.len()).find(covers_none).unwrap_or(0);
            ordered.extend(slabs.remove(next).panes);
        }
        ordered
    }

    /// Whether one slab lies before another, and not also behind it.
    fn covers(&self, front: &Loose, back: &Loose) -> bool {
        self.is_before(front, back) && !self.is_before(back, front)
    }

    /// Whether one slab lies wholly on the eye's side of another's plane, or has the other wholly behind its own.
    fn is_before(&self, front: &Loose, back: &Loose) -> bool {
        let room = 1e-6 * self.extent();
        let on_eyes_side = |(normal, height): HalfSpace, point: DVec3| {
            (normal.dot(point) - height) * (normal.dot(self.draft.lens.eye) - height).signum()
        };
        front.corners.iter().all(|&at| on_eyes_side(back.plane, at) >= -room)
            || back.corners.iter().all(|&at| on_eyes_side(front.plane, at) <= room)
    }
}

impl NearObstacles {
    /// Adds the boxes of another run.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.0.resize(self.0.len().max(other.0.len()), None);
        for (one, other) in self.0.iter_mut().zip(&other.0) {
            *one = match (*one, *other) {
                (Some([low, high]), Some(other)) => Some([low.min(other[0]), high.max(other[1])]),
                (one, other) => one.or(other),
            };
        }
    }

    /// The box of an obstacle, by its index.
    pub(crate) fn of(&self, obstacle: usize) -> Option<[DVec3; 2]> {
        self.0.get(obstacle).copied().flatten()
    }
}
