//! The cameras of frames and of sheets: where they look, and the one scale of all panels.
//!
//! A camera follows the centre of mass of a body, or it stands still before several moments. At its scale all bodies have
//! room. Bodies become smaller, down to [`SMALLER`], where that shows obstacles near them.

use super::camera::{Framing, Lens};
use super::layout::{Rectangle, Scale};
use crate::look::{CameraBoxes, axes, azimuths};
use crate::scene::{Run, Scene};
use crate::sim::{Obstacle, Shape};
use glam::{DVec2, DVec3};
use std::borrow::Cow;

/// The least size of bodies that leave room to obstacles, relative to bodies without obstacles.
const SMALLER: f64 = 0.8;
/// Obstacles are near up to this distance (sizes of the body).
const REACH: f64 = 0.5;
/// Growing bodies count up to this many times their largest side at the start and at rest, and diverged ones up to the
/// largest one that has not diverged: otherwise all other bodies would be too small.
const MOST_GROWTH: f64 = 1.7;
/// Obstacles are looked for at this many moments.
const MOMENTS: usize = 100;

/// The bodies of a run at a moment.
#[derive(Clone, Debug)]
pub(super) struct SeenMoment<'a> {
    /// The time (s).
    pub(super) time: f64,
    pub(super) run: usize,
    /// The boxes around them.
    pub(super) seen: Cow<'a, CameraBoxes>,
    /// Whether the run never diverges.
    pub(super) is_sound: bool,
}

impl SeenMoment<'_> {
    /// The greatest distance of the centre of a body from that of all (m).
    fn spread(&self) -> f64 {
        let CameraBoxes { centre, bodies } = &*self.seen;
        bodies.iter().map(|body| body.centre.distance(*centre)).fold(0.0, f64::max)
    }
}

/// The boxes around bodies at several moments and around the obstacles near them, along the axes of the camera, from the
/// origin, or from the centre of mass for a camera that follows it (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Whether the camera follows the centre of mass.
    follows: bool,
    /// The azimuth of the camera (rad).
    pub(super) azimuth: f64,
    /// The camera's axes: to the right, up and towards it.
    axes: [DVec3; 3],
    bodies: [DVec3; 2],
    all: [DVec3; 2],
    /// The box around the centres of bodies, from that of all bodies of their run.
    apart: [DVec3; 2],
    /// The width of the widest body or, where a run has several, of the box around them (m).
    widest: f64,
}

/// The view that all panels of a picture have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// Whether the camera follows the centre of mass.
    pub(super) follows: bool,
    /// The target, from the centre of mass if that is followed, or else from the origin (m).
    pub(super) offset: DVec3,
    /// Pixels per metre at the target.
    pub(super) pixels: f64,
    /// The azimuth of the camera (rad).
    pub(super) azimuth: f64,
}

impl Seen {
    /// The boxes of moments of a scene, from an azimuth by its place among those of the camera; `None` without moments.
    pub(super) fn new(scene: &Scene, azimuth: usize, moments: &[SeenMoment<'_>], follows: bool) -> Option<Self> {
        let camera = &scene.view.camera;
        let usual = usual(scene, azimuth)?;
        let largest = |sizes: &[f64]| sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let sound = || moments.iter().filter(|moment| moment.is_sound);
        // The greatest size of each body of the scene.
        let mut most = vec![None; usual.len()];
        for SeenMoment { run, seen, .. } in sound() {
            for (&of, body) in scene.runs[*run].of.iter().zip(&seen.bodies) {
                most[of] = Some(most[of].map_or(body.size(azimuth), |most: f64| most.max(body.size(azimuth))));
            }
        }
        let limited =
            |(most, &usual): (&Option<f64>, &f64)| most.unwrap_or(f64::INFINITY).clamp(usual, MOST_GROWTH * usual);
        let most: Vec<f64> = most.iter().zip(&usual).map(limited).collect();
        let farthest = sound().map(SeenMoment::spread).reduce(f64::max).unwrap_or(f64::INFINITY);
        let chosen = azimuths(camera).nth(azimuth).unwrap_or(camera.azimuth);
        let axes = axes(chosen, camera.elevation);
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let mut all = Self {
            follows,
            azimuth: chosen,
            axes,
            bodies: none,
            all: none,
            apart: none,
            widest: 0.2 * largest(&usual),
        };
        for (at, moment) in moments.iter().enumerate() {
            let run = &scene.runs[moment.run];
            let CameraBoxes { centre: of_all, bodies } = &*moment.seen;
            let nearer = (farthest / moment.spread()).min(1.0);
            let of_bodies = run.of.iter().zip(bodies).map(|(&of, body)| {
                let away = nearer * all.along(body.centre - of_all);
                all.apart = union(all.apart, [away; 2]);
                body.corners(azimuth).map(|corner| away + (most[of] / body.size(azimuth)).min(1.0) * corner)
            });
            let Some(corners) = of_bodies.reduce(union) else { continue };
            let centre = all.along(*of_all);
            let place = |[low, high]: [DVec3; 2]| if follows { [low, high] } else { [low + centre, high + centre] };
            all.widest = all.widest.max(corners[1].x - corners[0].x);
            all.bodies = union(all.bodies, place(corners));
            if at % moments.len().div_ceil(MOMENTS) == 0 {
                let reach = REACH * run.largest();
                let beside = [corners[0] - reach, corners[1] + reach];
                let near = scene.obstacles.iter().filter_map(|obstacle| {
                    let [low, high] = all.around(obstacle, moment.time, beside.map(|corner| centre + corner))?;
                    let near = [(low - centre).max(beside[0]), (high - centre).min(beside[1])];
                    near[0].cmple(near[1]).all().then_some(place(near))
                });
                all.all = near.fold(all.all, union);
            }
        }
        all.all = union(all.all, all.bodies);
        (!moments.is_empty()).then_some(all)
    }

    /// The larger of the width and the height that bodies need (m).
    pub(super) fn size(&self) -> f64 {
        (self.bodies[1] - self.bodies[0]).truncate().max_element()
    }

    /// Gives each the heights and depths of all, so that one ground is at one height.
    pub(super) fn level(all: &mut [Self]) {
        let both = all.iter().map(|seen| [seen.bodies, seen.all]);
        let Some([bodies, of_all]) = both.reduce(|[a, b], [c, d]| [union(a, c), union(b, d)]) else { return };
        let apart = all.iter().map(|seen| seen.apart).reduce(union).unwrap_or_default();
        for seen in all {
            seen.apart = apart;
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

    /// How much larger the outline of a box with these half sides (m) is seen than its middle, for each pixel of its size
    /// there. The outline of a body lies half-way to its nearest corner, and a body may stand apart from the middle.
    fn nearness(&self, lens: &Lens, half: DVec3) -> f64 {
        let apart = 0.5 * (self.apart[1].z - self.apart[0].z);
        if lens.orthographic { 0.0 } else { 0.5 * (half.z + apart) / lens.focal }
    }

    /// The point that a camera looks at, as in [`Shot::offset`].
    fn target(&self, lens: &Lens, [left, top, width, height]: [f64; 4], pixels: f64) -> DVec3 {
        let [middle, of_all] = [self.bodies, self.all].map(|[low, high]| low.midpoint(high));
        let half = 0.5 * (self.bodies[1] - self.bodies[0]);
        // Obstacles take the room that bodies leave.
        let spare = 0.5 * (1.0 / pixels - self.nearness(lens, half)) * DVec2::new(width, height) - half.truncate();
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
    let fit = |seen: &Seen, [low, high]: [DVec3; 2]| {
        let half = 0.5 * (high - low);
        let least = |side: f64, room: f64| room / (2.0 * side + room * seen.nearness(lens, half));
        least(half.x, room[2]).min(least(half.y, room[3]))
    };
    let least = |scale: &dyn Fn(&Seen) -> f64| all.iter().map(scale).fold(f64::INFINITY, f64::min);
    let most = least(&|seen| fit(seen, seen.bodies).min(filled * room[2] / seen.widest));
    let pixels = least(&|seen| fit(seen, seen.all)).clamp(SMALLER * most, most);
    all.iter()
        .map(|seen| Shot {
            follows: seen.follows,
            offset: seen.target(lens, room, pixels),
            pixels,
            azimuth: seen.azimuth,
        })
        .collect()
}

/// The greatest side of each body of a scene at rest and at the start (m); `None` without a place of one of them.
fn usual(scene: &Scene, azimuth: usize) -> Option<Vec<f64>> {
    let mut usual = vec![f64::MIN_POSITIVE; scene.bodies.len()];
    for run in scene.distinct_bodies().0 {
        let Run { of, bodies, initial, .. } = &scene.runs[run];
        let start = CameraBoxes::new(&scene.view, bodies, &initial.position)?;
        for ((&of, body), seen) in of.iter().zip(bodies.bodies()).zip(&start.bodies) {
            usual[of] = usual[of].max(seen.size(azimuth)).max(body.extent());
        }
    }
    Some(usual)
}

/// The camera of a panel at a distance of a metre; its azimuth is of no interest.
pub(super) fn from_a_metre(scene: &Scene, viewport: Rectangle, scale: Scale) -> Lens {
    let framing = Framing { target: DVec3::ZERO, distance: 1.0, ..Framing::still(&scene.view.camera) };
    Lens::new(&scene.view, &framing, scene.dimension(), viewport.map(f64::from), scale.unit)
}

/// The box around two boxes.
fn union([low, high]: [DVec3; 2], [from, to]: [DVec3; 2]) -> [DVec3; 2] {
    [low.min(from), high.max(to)]
}
