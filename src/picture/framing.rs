//! The cameras of frames and of sheets: where they look, and the one scale of all panels.
//!
//! A camera follows the centre of mass of a body, or it stands still before several moments. At its scale all bodies have
//! room. Bodies become smaller, down to [`SMALLER`], where that shows obstacles near them.

use super::camera::{Framing, Lens};
use super::layout::{Rectangle, Scale};
use crate::look::{CameraBox, axes};
use crate::scene::Scene;
use crate::sim::{Obstacle, Shape};
use glam::{DVec2, DVec3};

/// The least size of bodies that leave room to obstacles, relative to bodies without obstacles.
const SMALLER: f64 = 0.8;
/// Obstacles are near up to this distance (sizes of the body).
const REACH: f64 = 0.5;
/// Growing bodies count up to this many times their largest side at the start and at rest, and diverged ones up to the
/// largest one that has not diverged: otherwise all other bodies would be too small.
const MOST_GROWTH: f64 = 1.7;
/// Obstacles are looked for at this many moments.
const MOMENTS: usize = 100;

/// A body at a moment: the time (s), the box around it, and whether its run never diverges.
pub(super) type Moment = (f64, CameraBox, bool);

/// The boxes around bodies at several moments and around the obstacles near them, along the axes of the camera, from the
/// origin, or from the centre of mass for a camera that follows it (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// The camera's axes: to the right, up and towards it.
    axes: [DVec3; 3],
    bodies: [DVec3; 2],
    all: [DVec3; 2],
    /// The width of the widest body (m).
    widest: f64,
}

/// The view that all panels of a picture have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// The target, from the centre of mass if that is followed, or else from the origin (m).
    pub(super) offset: DVec3,
    /// Pixels per metre at the target.
    pub(super) pixels: f64,
}

impl Seen {
    /// The boxes of moments of a scene; `None` without moments.
    pub(super) fn new(scene: &Scene, moments: &[Moment], follows: bool) -> Option<Self> {
        let (view, body) = (&scene.view, &**scene.runs[0].body());
        let start = CameraBox::new(view, body, &scene.runs[0].initial.position)?;
        let usual = start.size().max(body.extent()).max(f64::MIN_POSITIVE);
        let sound = moments.iter().filter(|(_, _, is_sound)| *is_sound).map(|(_, seen, _)| seen.size());
        let most = sound.reduce(f64::max).unwrap_or(f64::INFINITY).clamp(usual, MOST_GROWTH * usual);
        let axes = axes(view.camera.azimuth, view.camera.elevation);
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut all = Self { axes, bodies: none, all: none, widest: 0.2 * usual };
        for (at, (time, seen, _)) in moments.iter().enumerate() {
            let corners = seen.corners.map(|corner| (most / seen.size()).min(1.0) * corner);
            let centre = all.along(seen.centre);
            let place = |[low, high]: [DVec3; 2]| if follows { [low, high] } else { [low + centre, high + centre] };
            all.widest = all.widest.max(corners[1].x - corners[0].x);
            all.bodies = union(all.bodies, place(corners));
            if at % moments.len().div_ceil(MOMENTS) == 0 {
                let beside = [corners[0] - REACH * body.extent(), corners[1] + REACH * body.extent()];
                let near = scene.obstacles.iter().filter_map(|obstacle| {
                    let [low, high] = all.around(obstacle, *time, beside.map(|corner| centre + corner))?;
                    let near = [(low - centre).max(beside[0]), (high - centre).min(beside[1])];
                    near[0].cmple(near[1]).all().then_some(place(near))
                });
                all.all = near.fold(all.all, union);
            }
        }
        all.all = union(all.all, all.bodies);
        (!moments.is_empty()).then_some(all)
    }

    /// Gives each the heights and depths of all, so that one ground is at one height.
    pub(super) fn level(all: &mut [Self]) {
        let both = all.iter().map(|seen| [seen.bodies, seen.all]);
        let Some([bodies, of_all]) = both.reduce(|[a, b], [c, d]| [union(a, c), union(b, d)]) else { return };
        for seen in all {
            let across = |own: [DVec3; 2], common: [DVec3; 2]| [0, 1].map(|end| common[end].with_x(own[end].x));
            (seen.bodies, seen.all) = (across(seen.bodies, bodies), across(seen.all, of_all));
        }
    }

    /// The components of a vector along the axes.
    fn along(&self, way: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| way.dot(axis)))
    }

    /// The box around an obstacle at a time (s), or around the part of a plate within a box; `None` for floors, which are
    /// everywhere.
    fn around(&self, obstacle: &Obstacle, time: f64, [low, high]: [DVec3; 2]) -> Option<[DVec3; 2]> {
        let pose = obstacle.pose(time);
        let place = |point: DVec3| self.along(pose.apply(obstacle.pivot, point));
        let ball = |centre: DVec3, radius: f64| [place(centre) - radius, place(centre) + radius];
        match obstacle.shape {
            Shape::Floor { .. } => None,
            Shape::Plate { point, normal } => {
                let (out, point) = (self.along(pose.rotation * normal), place(point));
                let corners =
                    (0..8).map(|at| DVec3::select(glam::BVec3::new(at & 1 > 0, at & 2 > 0, at & 4 > 0), low, high));
                let beside = corners.map(|corner| corner - (corner - point).dot(out) * out);
                beside.map(|at| [at; 2]).reduce(union)
            }
            Shape::Sphere { centre, radius } => Some(ball(centre, radius)),
            Shape::Capsule { from, to, radius } => Some(union(ball(from, radius), ball(to, radius))),
            Shape::Box { centre, half, rotation } => {
                let sides = half.min(DVec3::splat(f64::MAX.sqrt())).to_array().into_iter().zip(DVec3::AXES);
                let half: DVec3 =
                    sides.map(|(half, axis)| half * self.along(pose.rotation * (rotation * axis)).abs()).sum();
                Some([place(centre) - half, place(centre) + half])
            }
        }
    }

    /// The point that a camera looks at, as in [`Shot::offset`].
    fn target(&self, lens: &Lens, [left, top, width, height]: [f64; 4], pixels: f64) -> DVec3 {
        let [middle, of_all] = [self.bodies, self.all].map(|[low, high]| low.midpoint(high));
        let half = 0.5 * (self.bodies[1] - self.bodies[0]);
        // Obstacles take the room that bodies leave.
        let spare = 0.5 * (1.0 / pixels - nearness(lens, half)) * DVec2::new(width, height) - half.truncate();
        let spare = spare.max(DVec2::ZERO).extend(0.0);
        let middle = middle + (of_all - middle).clamp(-spare, spare);
        let off = (DVec2::new(left + 0.5 * width, top + 0.5 * height) - DVec2::from(lens.centre)) / pixels;
        let [right, up, towards] = self.axes;
        (middle.x - off.x) * right + (middle.y + off.y) * up + middle.z * towards
    }
}

/// One scale for cameras in equal rooms: left, top, width and height (px). The widest body takes at most the `filled` share
/// of the width. The lens is a metre from its target.
pub(super) fn shots(all: &[Seen], lens: &Lens, room: [f64; 4], filled: f64) -> Vec<Shot> {
    let fit = |[low, high]: [DVec3; 2]| {
        let half = 0.5 * (high - low);
        let least = |side: f64, room: f64| room / (2.0 * side + room * nearness(lens, half));
        least(half.x, room[2]).min(least(half.y, room[3]))
    };
    let least = |scale: &dyn Fn(&Seen) -> f64| all.iter().map(scale).fold(f64::INFINITY, f64::min);
    let most = least(&|seen| fit(seen.bodies).min(filled * room[2] / seen.widest));
    let pixels = least(&|seen| fit(seen.all)).clamp(SMALLER * most, most);
    all.iter().map(|seen| Shot { offset: seen.target(lens, room, pixels), pixels }).collect()
}

/// How much larger the outline of a box with these half sides (m) is seen than its middle, for each pixel of its size
/// there: it lies half-way to the nearest corner.
fn nearness(lens: &Lens, half: DVec3) -> f64 {
    if lens.orthographic { 0.0 } else { 0.5 * half.z / lens.focal }
}

/// The camera of a panel at a distance of a metre.
pub(super) fn from_a_metre(scene: &Scene, viewport: Rectangle, scale: Scale) -> Lens {
    let framing = Framing { target: DVec3::ZERO, distance: 1.0, moves: false };
    Lens::new(&scene.view, &framing, scene.dimension(), viewport.map(f64::from), scale.unit)
}

/// The box around two boxes.
fn union([low, high]: [DVec3; 2], [from, to]: [DVec3; 2]) -> [DVec3; 2] {
    [low.min(from), high.max(to)]
}
