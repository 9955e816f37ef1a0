//! Cameras that follow: one scale for all panels and frames of a scene, from its time series.
//!
//! At that scale the widest moment of all runs takes [`FILLED`] of the width of a panel, if its height leaves room for
//! the words. Where the whole course of all runs stays in view the camera stands still. Otherwise it goes along with the
//! centre of each run's body, smoothed over a symmetric window that is the same for all runs.

use super::camera::{Framing, Lens};
use super::layout::{self, Rectangle, Scale};
use crate::history::{Course, History};
use crate::look::{Place, axes};
use crate::scene::Scene;
use crate::sim::body::Dimension;
use crate::sim::snapshot::{RunFrame, Status};
use glam::{DVec2, DVec3};

/// The part of a panel's width that the widest moment takes.
const FILLED: f64 = 0.55;
/// A camera stands still if everything stays in view at this part of that scale.
const STILL: f64 = 0.82;
/// Moments of diverged runs count while they are no larger than this many times the largest moment of the others, or than
/// the second number of times the start if there are no others.
const BEYOND: [f64; 2] = [1.25, 2.0];
/// Bodies that grow count up to this many times their largest side at the start and at rest: others, which do not grow,
/// would be too small.
const MOST_GROWTH: f64 = 1.7;
/// How far smoothing may move a body from its place in the panel (parts of its width at the widest moment).
const SLACK: f64 = 0.06;
/// The longest window of smoothing, to either side (s), and into how many parts it is cut.
const LONGEST: f64 = 0.25;
const PARTS: i32 = 6;

/// How a camera follows the runs of a scene.
#[derive(Debug)]
pub(super) struct Tracking {
    /// None if the time series are not known: only the start is, then.
    pub(super) paths: Vec<Path>,
    /// The camera's axes: to the right, up and towards it.
    axes: [DVec3; 3],
    /// The box that holds the body at any time, from its centre along the axes (m).
    low: DVec3,
    high: DVec3,
    /// Its width at its widest moment (m).
    pub(super) widest: f64,
    /// The box around all that all runs ever reach, along the axes (m).
    all: [DVec3; 2],
    /// Half the window of smoothing (s).
    window: f64,
}

/// The course of the centre of a body.
#[derive(Debug)]
pub(super) struct Path {
    pub(super) run: usize,
    /// Times (s), rising.
    times: Vec<f64>,
    /// The centre at each of them (m).
    pub(super) centres: Vec<DVec3>,
}

/// How one panel is seen; all panels of a picture alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// Distance from the point looked at (m).
    distance: f64,
    /// The point looked at, from the centre that is followed, or from the origin if none is (m).
    offset: DVec3,
    pub(super) is_still: bool,
    /// Pixels of a metre at the point looked at.
    pub(super) pixels: f64,
}

impl Tracking {
    /// For a scene and its time series; `None` if nothing is known of where its body is.
    pub(super) fn new(scene: &Scene, history: &History) -> Option<Self> {
        let (view, dimension) = (&scene.view, scene.body.dimension);
        let start = Place::new(view, dimension, &scene.obstacles, &scene.initial.position)?;
        let usual = start.size().max((1.0 + view.explode) * scene.body.extent()).max(f64::MIN_POSITIVE);
        let largest = |course: &Course| course.places.iter().map(|(_, place)| place.size()).fold(0.0, f64::max);
        let sound = history.courses.iter().filter(|course| course.divergence.is_none());
        let largest = sound.map(largest).reduce(f64::max);
        let limit = largest.map_or(BEYOND[1] * usual, |largest| BEYOND[0] * largest.max(usual));
        let paths: Vec<_> = history.courses.iter().map(|course| Path::new(course, limit)).collect();
        let counted = history.courses.iter().zip(&paths).flat_map(|(course, path)| &course.places[..path.times.len()]);
        let places: Vec<_> = counted.map(|(_, place)| *place).chain([start]).collect();
        let most = MOST_GROWTH * usual;
        let axes = match dimension {
            Dimension::Space => axes(view.camera.azimuth, view.camera.elevation),
            Dimension::Plane => DVec3::AXES,
        };
        let mut all = Self {
            paths,
            axes,
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            widest: 0.0,
            all: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            window: 0.0,
        };
        for Place { centre, low, high } in places {
            // As much of a body that grows as counts, around its centre.
            let times = (most / (high - low).truncate().max_element()).min(1.0);
            let [low, high] = [times * low, times * high];
            (all.low, all.high) = (all.low.min(low), all.high.max(high));
            all.widest = all.widest.max(high.x - low.x);
            let centre = all.along(centre);
            all.all = [all.all[0].min(centre + low), all.all[1].max(centre + high)];
        }
        // A body seen as a point or a line has some width all the same.
        all.widest = all.widest.max(0.2 * usual);
        all.window = all.longest_window(scene.frames_per_second);
        Some(all)
    }

    /// A vector along the axes.
    fn along(&self, way: DVec3) -> DVec3 {
        let [right, up, towards] = self.axes;
        DVec3::new(way.dot(right), way.dot(up), way.dot(towards))
    }

    /// A vector given along the axes.
    fn across(&self, way: DVec3) -> DVec3 {
        let [right, up, towards] = self.axes;
        way.x * right + way.y * up + way.z * towards
    }

    fn slack(&self) -> f64 {
        SLACK * self.widest
    }

    /// Half the longest window (s) that leaves bodies at their place.
    fn longest_window(&self, frames_per_second: f64) -> f64 {
        let fits = |window: f64| {
            let mut moments = self.paths.iter().flat_map(|path| path.times.iter().map(move |&time| (path, time)));
            moments.all(|(path, time)| path.smooth(time, window).distance(path.at(time)) <= self.slack())
        };
        let halved = std::iter::successors(Some(LONGEST), |window| Some(0.5 * window));
        halved.take_while(|window| *window > 0.25 / frames_per_second).find(|&window| fits(window)).unwrap_or(0.0)
    }

    /// How a panel of a picture with type of a scale is seen. The part of it that is `taken` at its upper right is kept
    /// free, if that is possible (px: left, top, width and height).
    pub(super) fn shot(&self, scene: &Scene, viewport: Rectangle, scale: Scale, taken: Option<[f64; 4]>) -> Shot {
        let (view, dimension) = (&scene.view, scene.body.dimension);
        let near = Framing { target: DVec3::ZERO, distance: 1.0, rise: 0.0, moves: false };
        let lens = Lens::new(view, &near, dimension, viewport.map(f64::from), scale.unit);
        let room = layout::clear_of_words(viewport, scale, layout::rooms(view)).map(|length| f64::from(length).max(1.0));
        // What is nearer than the point looked at is seen larger.
        let depth = |[low, high]: [DVec3; 2]| match dimension {
            Dimension::Space => high.z.max(0.5 * (high.z - low.z)) / lens.focal,
            Dimension::Plane => 0.0,
        };
        let fit = |[low, high]: [DVec3; 2], [beside, above]: [f64; 2]| {
            let depth = depth([low, high]);
            let [across, along] = [high.x - low.x + beside, high.y - low.y + above];
            (room[2] / (across + room[2] * depth)).min(room[3] / (along + room[3] * depth))
        };
        let slack = 2.0 * self.slack();
        let following = (FILLED * f64::from(viewport[2]) / self.widest).min(fit([self.low, self.high], [slack; 2]));
        let [low, high] = self.all;
        let middle = low.midpoint(high);
        let standing = fit([low - middle, high - middle], [0.0; 2]).min(following);
        let is_still = !self.paths.is_empty() && standing >= STILL * following;
        let pixels = if is_still { standing } else { following };
        // The middle of the box stands in the middle of the room.
        let middle = if is_still { middle } else { self.low.midpoint(self.high).with_z(0.0) };
        let mut at = DVec2::new(room[0] + 0.5 * room[2], room[1] + 0.5 * room[3]);
        if let Some([left, top, _, height]) = taken.filter(|_| !is_still) {
            let half = 0.5 * pixels * (self.high - self.low).truncate();
            if at.y - half.y < top + height {
                at.x -= (at.x + half.x - left).clamp(0.0, (at.x - half.x - room[0]).max(0.0));
            }
        }
        let off = (at - DVec2::from(lens.centre)) / pixels;
        Shot { distance: lens.focal / pixels, offset: self.across(middle + DVec3::new(-off.x, off.y, 0.0)), is_still, pixels }
    }

    /// What the camera of a run looks at, whose body is at `place` now.
    pub(super) fn framing(&self, shot: &Shot, run: &RunFrame, place: Option<Place>) -> Framing {
        let target = if shot.is_still { shot.offset } else { self.centre(run, place) + shot.offset };
        Framing { target, distance: shot.distance, rise: 0.0, moves: !shot.is_still }
    }

    /// The point that the camera of a run follows (m).
    fn centre(&self, run: &RunFrame, place: Option<Place>) -> DVec3 {
        let path = self.paths.iter().find(|path| path.run == run.run && !path.times.is_empty());
        let (Some(path), now) = (path, place.map(|place| place.centre)) else {
            return place.map_or(DVec3::ZERO, |place| place.centre);
        };
        let smooth = path.smooth(run.snapshot.time, self.window);
        match now {
            // Between moments of a sparse series the body may be elsewhere.
            Some(now) if run.snapshot.status == Status::Ok && path.holds(run.snapshot.time) => {
                now + (smooth - now).clamp_length_max(self.slack())
            }
            _ => smooth,
        }
    }
}

impl Path {
    /// The course of a run, for a diverged one up to the first moment at which its body is larger than a limit (m).
    fn new(course: &Course, limit: f64) -> Self {
        let count = match course.divergence {
            Some(_) => course.places.iter().take_while(|(_, place)| place.size() <= limit).count(),
            None => course.places.len(),
        };
        let (times, centres) = course.places[..count].iter().map(|(time, place)| (*time, place.centre)).unzip();
        Self { run: course.run, times, centres }
    }

    /// Whether it is known at a time (s).
    fn holds(&self, time: f64) -> bool {
        self.times.last().is_some_and(|&last| time <= last)
    }

    /// The centres up to a time (s), and where it is then.
    pub(super) fn until(&self, time: f64) -> impl Iterator<Item = DVec3> + '_ {
        let count = self.times.partition_point(|&at| at < time);
        self.centres[..count].iter().copied().chain([self.at(time)])
    }

    /// The centre at a time (s); before and after the path, at its ends (m).
    fn at(&self, time: f64) -> DVec3 {
        let after = self.times.partition_point(|&at| at <= time);
        match (after.checked_sub(1), self.centres.get(after)) {
            (None, first) => first.copied().unwrap_or_default(),
            (Some(before), None) => self.centres[before],
            (Some(before), Some(&next)) => {
                let [from, to] = [self.times[before], self.times[after]];
                self.centres[before].lerp(next, (time - from) / (to - from))
            }
        }
    }

    /// The mean of the centres around a time, weighted by a parabola over half a window (s) to either side. Near the ends
    /// of the path the window is narrower, so that the camera starts and ends at the body.
    fn smooth(&self, time: f64, half: f64) -> DVec3 {
        let (Some(&first), Some(&last)) = (self.times.first(), self.times.last()) else { return DVec3::ZERO };
        let half = half.min(time - first).min(last - time);
        if half <= 0.0 {
            return self.at(time);
        }
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for part in 1 - PARTS..PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            let weight = 1.0 - share * share;
            sum += weight * self.at(time + share * half);
            weights += weight;
        }
        sum / weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that falls and rebounds off the ground.
    fn bouncing() -> Path {
        let times: Vec<_> = (0..=600).map(|at| f64::from(at) / 200.0).collect();
        let height = |time: f64| {
            let phase = time - time.floor();
            4.0 * phase * (1.0 - phase)
        };
        let centres = times.iter().map(|&time| DVec3::new(0.3 * time, height(time), 0.0)).collect();
        Path { run: 0, times, centres }
    }

    #[test]
    fn smoothing_moves_no_faster_than_the_body_and_bends_less() {
        let path = bouncing();
        let frame = 1.0 / 60.0;
        let turns = |half: f64| {
            let at: Vec<_> = (0..=180).map(|at| path.smooth(f64::from(at) * frame, half)).collect();
            let steps: Vec<_> = at.windows(2).map(|two| two[1] - two[0]).collect();
            // The body's greatest speed is that of a rebound.
            assert!(steps.iter().all(|step| step.length() <= 4.02 * frame), "{half}");
            steps.windows(2).map(|two| two[0].distance(two[1])).fold(0.0, f64::max)
        };
        let rough = turns(0.0);
        for half in [0.03, 0.06, 0.12] {
            let bound = rough * 1.6 * frame / (half + frame);
            assert!(turns(half) < bound, "{half}: {} of {rough}", turns(half));
        }
        // It begins and ends with the body, and stays there.
        for half in [0.0, 0.1, 9.0] {
            for time in [-1.0, 0.0, 3.0, 7.0] {
                assert_eq!(path.smooth(time, half), path.at(time));
            }
        }
    }
}
