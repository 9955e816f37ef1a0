//! Cameras that follow: one scale for all panels and frames of a scene, from its time series.
//!
//! At that scale the widest moment of all runs takes [`FILLED`] of the width of a panel, if its height leaves room for
//! the words. If the whole course of all runs stays in view, the camera stands still, and also shows objects near them
//! unless bodies would become much smaller. Otherwise the centre of mass of each run's body stays at one place.

use super::camera::{Framing, Lens};
use super::layout::{self, Rectangle, Scale};
use crate::look::{CameraBox, axes};
use crate::runner::history::{History, TimeSeries};
use crate::scene::Scene;
use crate::sim::Dimension;
use glam::{DVec2, DVec3};

/// The share of a panel's width that the widest moment takes.
const FILLED: f64 = 0.62;
/// A camera stands still if everything stays in view at a scale at which the widest moment takes this share of that
/// width, or the most that it can take.
const LEAST_FILLED: f64 = 0.45;
/// The extra room of bodies at the highest moment, above and below, beyond the usual distance from words (px in the
/// reference picture).
pub(super) const NEARER: [f64; 2] = [5.0, 11.0];
/// Moments of diverged runs count while they are no larger than the largest moment of the others, or than this many times
/// the start if there are no others.
const BEYOND: f64 = 2.0;
/// Growing bodies count up to this many times their largest side at the start and at rest: otherwise bodies that do not
/// grow would be too small.
const MOST_GROWTH: f64 = 1.7;

/// The data of a camera that follows the runs of a scene.
#[derive(Debug)]
pub(super) struct Tracking {
    /// Whether the time series are known; if not, only the start is.
    is_known: bool,
    /// The camera's axes: to the right, up and towards it.
    axes: [DVec3; 3],
    /// The box that holds the body at any time, from its centre of mass, along the axes (m).
    around: [DVec3; 2],
    /// Its width at its widest moment (m).
    widest: f64,
    /// The box around the courses of all runs, and the same box with objects near them, along the axes (m).
    all: [[DVec3; 2]; 2],
}

/// The view of one panel; all panels of a picture have the same.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// The target, from the centre of mass if that is followed, or else from the origin (m).
    offset: DVec3,
    is_still: bool,
    /// Pixels per metre at the target.
    pub(super) pixels: f64,
}

impl Tracking {
    /// The tracking of a scene with its time series; `None` if the place of its body is unknown.
    pub(super) fn new(scene: &Scene, history: &History) -> Option<Self> {
        let (view, body) = (&scene.view, &*scene.body);
        let start = CameraBox::new(view, body, &scene.initial.position)?;
        let usual = start.size().max(body.extent()).max(f64::MIN_POSITIVE);
        let largest = |course: &TimeSeries| course.boxes.iter().map(CameraBox::size).fold(0.0, f64::max);
        let sound = history.series.iter().filter(|course| course.divergence.is_none());
        let largest = sound.map(largest).reduce(f64::max);
        let limit = largest.map_or(BEYOND * usual, |largest| largest.max(usual));
        let counted = history.series.iter().flat_map(|course| {
            let limit = if course.divergence.is_some() { limit } else { f64::INFINITY };
            course.boxes.iter().take_while(move |one| one.size() <= limit)
        });
        let most = MOST_GROWTH * usual;
        let axes = match body.dimension {
            Dimension::Space => axes(view.camera.azimuth, view.camera.elevation),
            Dimension::Plane => DVec3::AXES,
        };
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let is_known = !history.series.is_empty();
        let mut all = Self { is_known, axes, around: none, widest: 0.0, all: [none; 2] };
        for one in counted.copied().chain([start]) {
            // Only the counting part of a growing body.
            let corners = one.corners.map(|corner| (most / one.size()).min(1.0) * corner);
            let centre = all.along(one.centre);
            all.around = union(all.around, corners);
            all.widest = all.widest.max(corners[1].x - corners[0].x);
            all.all[0] = union(all.all[0], corners.map(|corner| centre + corner));
        }
        let near = view.camera.near.iter().map(|&point| [all.along(point); 2]);
        all.all[1] = near.fold(all.all[0], union);
        // A body seen as a point or a line still gets some width.
        all.widest = all.widest.max(0.2 * usual);
        Some(all)
    }

    /// The components of a vector along the axes.
    fn along(&self, way: DVec3) -> DVec3 {
        let [right, up, towards] = self.axes;
        DVec3::new(way.dot(right), way.dot(up), way.dot(towards))
    }

    /// The vector with components along the axes.
    fn across(&self, way: DVec3) -> DVec3 {
        let [right, up, towards] = self.axes;
        way.x * right + way.y * up + way.z * towards
    }

    /// The view of a panel, in a picture with type of a scale.
    pub(super) fn shot(&self, scene: &Scene, (viewport, scale): (Rectangle, Scale)) -> Shot {
        let (view, dimension) = (&scene.view, scene.body.dimension);
        let lens = near(scene, viewport, scale);
        let [left, top, wide, high] =
            layout::clear_of_words(viewport, view, scale).map(|length| f64::from(length).max(1.0));
        let [above, below] = NEARER.map(|length| length * scale.unit);
        let room = [left, top - above, wide, high + above + below];
        // Points nearer than the target are seen larger; the outline lies half-way to the nearest one.
        let depth = |half: DVec3| if dimension == Dimension::Space { 0.5 * half.z / lens.focal } else { 0.0 };
        let fit = |[low, high]: [DVec3; 2]| {
            let half = 0.5 * (high - low);
            let depth = depth(half);
            (room[2] / (2.0 * half.x + room[2] * depth)).min(room[3] / (2.0 * half.y + room[3] * depth))
        };
        let part = |part: f64| part * f64::from(viewport[2].max(1)) / self.widest;
        let (filled, least) = (part(FILLED), part(LEAST_FILLED));
        let following = filled.min(fit(self.around));
        let least = least.min(following);
        let [body, with_near] = self.all;
        let all = [with_near, body].map(|[low, high]| (fit([low, high]).min(following), low.midpoint(high)));
        let standing = all.into_iter().find(|(pixels, _)| *pixels >= least).map(|(pixels, middle)| {
            // The room above and below bodies is for objects near them. The lowest corner of bodies is the nearest one.
            let half = 0.5 * (body[1] - body[0]);
            let spare = (0.5 * room[3] * (1.0 / pixels - 2.0 * depth(half)) - half.y).max(0.0);
            (pixels, middle + DVec3::Y * (all[0].1.y - middle.y).clamp(-spare, spare))
        });
        let standing = standing.filter(|_| self.is_known);
        // The middle of the box is in the middle of the room.
        let (pixels, middle) = standing.unwrap_or((following, self.around[0].midpoint(self.around[1])));
        let at = DVec2::new(room[0] + 0.5 * room[2], room[1] + 0.5 * room[3]);
        let off = (at - DVec2::from(lens.centre)) / pixels;
        let offset = self.across(middle + DVec3::new(-off.x, off.y, 0.0));
        Shot { offset, is_still: standing.is_some(), pixels }
    }

    /// The target and distance of the camera of a run, whose body has a centre of mass (m), in a panel.
    pub(super) fn framing(
        &self,
        scene: &Scene,
        shot: &Shot,
        centre: DVec3,
        (viewport, scale): (Rectangle, Scale),
    ) -> Framing {
        let target = if shot.is_still { shot.offset } else { centre + shot.offset };
        // Panels may differ by a pixel in width, but have one scale.
        let distance = near(scene, viewport, scale).focal / shot.pixels;
        Framing { target, distance, moves: !shot.is_still }
    }
}

/// The box around two boxes.
fn union([low, high]: [DVec3; 2], [from, to]: [DVec3; 2]) -> [DVec3; 2] {
    [low.min(from), high.max(to)]
}

/// The camera of a panel at a distance of a metre.
fn near(scene: &Scene, viewport: Rectangle, scale: Scale) -> Lens {
    let framing = Framing { target: DVec3::ZERO, distance: 1.0, moves: false };
    Lens::new(&scene.view, &framing, scene.body.dimension, viewport.map(f64::from), scale.unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::Traced;
    use crate::runner::Runner;

    /// A whole scene with hard impacts.
    #[test]
    fn a_camera_that_follows_keeps_the_centre_of_mass_at_its_place() {
        let text = include_str!("../../scenes/fig4b.toml");
        let scene = Scene::parse(text, "fig4b.toml", &crate::scene::Limits::default()).unwrap();
        let tracking = Tracking::new(&scene, &History::new(&scene, &[0, 1])).unwrap();
        let panel = ([0, 0, 640, 600], Scale::at(1.0));
        let shot = tracking.shot(&scene, panel);
        assert!(!shot.is_still, "{shot:?}");
        let mut runner = Runner::new(&scene, &[0, 1]);
        let (mut places, mut distances) = (Vec::new(), Vec::new());
        for frame in (0..=scene.last_frame()).map(|index| runner.frame(index)) {
            for run in &frame.runs {
                let centre = Traced::Centre.of(&scene.body, &run.snapshot.position);
                let framing = tracking.framing(&scene, &shot, centre, panel);
                let lens = Lens::new(&scene.view, &framing, scene.body.dimension, panel.0.map(f64::from), 1.0);
                places.push(lens.project(centre).unwrap().0);
                distances.push(framing.distance);
            }
        }
        let (at, distance) = (places[0], distances[0]);
        assert!(places.iter().all(|[x, y]| (x - at[0]).abs() < 1e-6 && (y - at[1]).abs() < 1e-6));
        assert!(distances.iter().all(|other| *other == distance));
    }
}
