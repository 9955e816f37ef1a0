//! Cameras that follow: one scale for all panels and frames of a scene, from its time series.
//!
//! At that scale the widest moment of all runs takes [`FILLED`] of the width of a panel, if its height leaves room for
//! the words. Where the whole course of all runs stays in view the camera stands still, and shows what comes near them as
//! long as that makes them little smaller. Otherwise it goes along with the middle of each run's body, smoothed over a
//! symmetric window that is the same for all runs.

use super::camera::{Framing, Lens};
use super::layout::{self, Rectangle, Scale};
use crate::look::{Place, axes};
use crate::runner::history::{History, TimeSeries};
use crate::scene::Scene;
use crate::sim::body::Dimension;
use crate::sim::snapshot::{RunFrame, Status};
use glam::{DVec2, DVec3};

/// The part of a panel's width that the widest moment takes.
const FILLED: f64 = 0.62;
/// A camera stands still if everything stays in view at a scale at which the widest moment takes this part of that width, or
/// as much as it can take.
const LEAST_FILLED: f64 = 0.45;
/// At the highest moment bodies come this much nearer to the words than other things that words are kept clear of, above
/// and below (px in the reference picture).
pub(super) const NEARER: [f64; 2] = [5.0, 11.0];
/// Moments of diverged runs count while they are no larger than the largest moment of the others, or than this many times
/// the start if there are no others.
const BEYOND: f64 = 2.0;
/// Bodies that grow count up to this many times their largest side at the start and at rest: others, which do not grow,
/// would be too small.
const MOST_GROWTH: f64 = 1.7;
/// How far smoothing may move a body from its place in the panel (parts of its width at the widest moment).
const SLACK: f64 = 0.03;
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
    /// Half the sides of the box that holds the body at any time, along the axes (m).
    half: DVec3,
    /// Its width at its widest moment (m).
    pub(super) widest: f64,
    /// The box around all that all runs ever reach, and the same with what comes near them, along the axes (m).
    all: [[DVec3; 2]; 2],
    /// Half the window of smoothing (s).
    window: f64,
}

/// The course of a body.
#[derive(Debug)]
pub(super) struct Path {
    pub(super) run: usize,
    /// Times (s), rising.
    times: Vec<f64>,
    /// The mean of its nodes at each of them (m).
    pub(super) centres: Vec<DVec3>,
    /// The middle of the box around it at each of them (m).
    middles: Vec<DVec3>,
}

/// How one panel is seen; all panels of a picture alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot {
    /// The point looked at, from the body's middle if that is followed, or else from the origin (m).
    offset: DVec3,
    pub(super) is_still: bool,
    /// Pixels of a metre at the point looked at.
    pub(super) pixels: f64,
}

impl Tracking {
    /// For a scene and its time series; `None` if nothing is known of where its body is.
    pub(super) fn new(scene: &Scene, history: &History) -> Option<Self> {
        let (view, dimension) = (&scene.view, scene.body.dimension);
        let start = Place::new(view, dimension, &scene.initial.position)?;
        let usual = start.size().max(scene.body.extent()).max(f64::MIN_POSITIVE);
        let largest = |course: &TimeSeries| course.places.iter().map(|(_, place)| place.size()).fold(0.0, f64::max);
        let sound = history.series.iter().filter(|course| course.divergence.is_none());
        let largest = sound.map(largest).reduce(f64::max);
        let limit = largest.map_or(BEYOND * usual, |largest| largest.max(usual));
        let paths: Vec<_> = history.series.iter().map(|course| Path::new(course, limit)).collect();
        let counted = history.series.iter().zip(&paths).flat_map(|(course, path)| &course.places[..path.times.len()]);
        let places: Vec<_> = counted.map(|(_, place)| *place).chain([start]).collect();
        let most = MOST_GROWTH * usual;
        let axes = match dimension {
            Dimension::Space => axes(view.camera.azimuth, view.camera.elevation),
            Dimension::Plane => DVec3::AXES,
        };
        let mut all = Self {
            paths,
            axes,
            half: DVec3::ZERO,
            widest: 0.0,
            all: [[DVec3::INFINITY, DVec3::NEG_INFINITY]; 2],
            window: 0.0,
        };
        for place in places {
            // As much of a body that grows as counts.
            let half = (most / place.size()).min(1.0) * place.half;
            all.half = all.half.max(half);
            all.widest = all.widest.max(2.0 * half.x);
            let (middle, [low, high]) = (all.along(place.middle), all.all[0]);
            all.all[0] = [low.min(middle - half), high.max(middle + half)];
        }
        let near = view.camera.near.iter().map(|&point| all.along(point));
        all.all[1] = near.fold(all.all[0], |[low, high], at| [low.min(at), high.max(at)]);
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
            moments.all(|(path, time)| path.smooth(time, window).distance(path.middle(time)) <= self.slack())
        };
        let halved = std::iter::successors(Some(LONGEST), |window| Some(0.5 * window));
        halved.take_while(|window| *window > 0.25 / frames_per_second).find(|&window| fits(window)).unwrap_or(0.0)
    }

    /// How a panel is seen, in a picture with type of a scale. The part of it that is `taken` at its upper right is kept
    /// free, if that is possible (px: left, top, width and height).
    pub(super) fn shot(&self, scene: &Scene, (viewport, scale): (Rectangle, Scale), taken: Option<[f64; 4]>) -> Shot {
        let (view, dimension) = (&scene.view, scene.body.dimension);
        let lens = near(scene, viewport, scale);
        let [left, top, wide, high] =
            layout::clear_of_words(viewport, view, scale).map(|length| f64::from(length).max(1.0));
        let [above, below] = NEARER.map(|length| length * scale.unit);
        let room = [left, top - above, wide, high + above + below];
        // What is nearer than the point looked at is seen larger; the outline lies on the way to the nearest.
        let depth = |half: DVec3| if dimension == Dimension::Space { 0.5 * half.z / lens.focal } else { 0.0 };
        let fit = |half: DVec3| {
            let depth = depth(half);
            (room[2] / (2.0 * half.x + room[2] * depth)).min(room[3] / (2.0 * half.y + room[3] * depth))
        };
        let part = |part: f64| part * f64::from(viewport[2].max(1)) / self.widest;
        let (filled, least) = (part(FILLED), part(LEAST_FILLED));
        let following = filled.min(fit(self.half + self.slack()));
        let least = least.min(following);
        let standing = |[low, high]: [DVec3; 2]| (fit(0.5 * (high - low)).min(following), low.midpoint(high));
        let [body, with_near] = self.all;
        let all = [with_near, body].map(standing);
        let standing = all.into_iter().find(|(pixels, _)| *pixels >= least).map(|(pixels, middle)| {
            // Room that bodies leave above and below is for what comes near them. Their lowest corner is their nearest one.
            let half = 0.5 * (body[1] - body[0]);
            let spare = (0.5 * room[3] * (1.0 / pixels - 2.0 * depth(half)) - half.y).max(0.0);
            (pixels, middle + DVec3::Y * (all[0].1.y - middle.y).clamp(-spare, spare))
        });
        let standing = standing.filter(|_| !self.paths.is_empty());
        let is_still = standing.is_some();
        // The middle of the box stands in the middle of the room.
        let (pixels, middle) = standing.unwrap_or((following, DVec3::ZERO));
        let mut at = DVec2::new(room[0] + 0.5 * room[2], room[1] + 0.5 * room[3]);
        if let Some([left, top, _, height]) = taken.filter(|_| !is_still) {
            let half = pixels * self.half.truncate();
            if at.y - half.y < top + height {
                at.x -= (at.x + half.x - left).clamp(0.0, (at.x - half.x - room[0]).max(0.0));
            }
        }
        let off = (at - DVec2::from(lens.centre)) / pixels;
        Shot { offset: self.across(middle + DVec3::new(-off.x, off.y, 0.0)), is_still, pixels }
    }

    /// What the camera of a run looks at, whose body is at `place` now, in a panel.
    pub(super) fn framing(
        &self,
        scene: &Scene,
        shot: &Shot,
        run: &RunFrame,
        place: Option<Place>,
        (viewport, scale): (Rectangle, Scale),
    ) -> Framing {
        let target = if shot.is_still { shot.offset } else { self.middle(run, place) + shot.offset };
        // Panels may differ by a pixel in width; their scale does not.
        let distance = near(scene, viewport, scale).focal / shot.pixels;
        Framing { target, distance, rise: 0.0, moves: !shot.is_still }
    }

    /// The point that the camera of a run follows (m).
    fn middle(&self, run: &RunFrame, place: Option<Place>) -> DVec3 {
        let path = self.paths.iter().find(|path| path.run == run.run && !path.times.is_empty());
        let (Some(path), now) = (path, place.map(|place| place.middle)) else {
            return place.map_or(DVec3::ZERO, |place| place.middle);
        };
        let smooth = path.smooth(run.shown().time, self.window);
        match now {
            // Between moments of a sparse series the body may be elsewhere.
            Some(now) if run.snapshot.status == Status::Ok && path.holds(run.shown().time) => {
                now + (smooth - now).clamp_length_max(self.slack())
            }
            _ => smooth,
        }
    }
}

/// The camera of a panel at a distance of a metre.
fn near(scene: &Scene, viewport: Rectangle, scale: Scale) -> Lens {
    let framing = Framing { target: DVec3::ZERO, distance: 1.0, rise: 0.0, moves: false };
    Lens::new(&scene.view, &framing, scene.body.dimension, viewport.map(f64::from), scale.unit)
}

impl Path {
    /// The course of a run, for a diverged one up to the first moment at which its body is larger than a limit (m).
    fn new(course: &TimeSeries, limit: f64) -> Self {
        let count = match course.divergence {
            Some(_) => course.places.iter().take_while(|(_, place)| place.size() <= limit).count(),
            None => course.places.len(),
        };
        let places = &course.places[..count];
        Self {
            run: course.run,
            times: places.iter().map(|(time, _)| *time).collect(),
            centres: places.iter().map(|(_, place)| place.centre).collect(),
            middles: places.iter().map(|(_, place)| place.middle).collect(),
        }
    }

    /// Whether it is known at a time (s).
    fn holds(&self, time: f64) -> bool {
        self.times.last().is_some_and(|&last| time <= last)
    }

    /// The centres up to a time (s), and where it is then.
    pub(super) fn until(&self, time: f64) -> impl Iterator<Item = DVec3> + '_ {
        let count = self.times.partition_point(|&at| at < time);
        self.centres[..count].iter().copied().chain([self.at(&self.centres, time)])
    }

    /// Which of the points of a path (m) belongs to a time (s); before and after the path, those at its ends.
    fn at(&self, points: &[DVec3], time: f64) -> DVec3 {
        let after = self.times.partition_point(|&at| at <= time);
        match (after.checked_sub(1), points.get(after)) {
            (None, first) => first.copied().unwrap_or_default(),
            (Some(before), None) => points[before],
            (Some(before), Some(&next)) => {
                let [from, to] = [self.times[before], self.times[after]];
                points[before].lerp(next, (time - from) / (to - from))
            }
        }
    }

    /// The middle at a time (m).
    fn middle(&self, time: f64) -> DVec3 {
        self.at(&self.middles, time)
    }

    /// The mean of the middles around a time, weighted by a parabola over half a window (s) to either side. Near the ends
    /// of the path the window is narrower, so that the camera starts and ends at the body.
    fn smooth(&self, time: f64, half: f64) -> DVec3 {
        let (Some(&first), Some(&last)) = (self.times.first(), self.times.last()) else { return DVec3::ZERO };
        let half = half.min(time - first).min(last - time);
        if half <= 0.0 {
            return self.middle(time);
        }
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for part in 1 - PARTS..PARTS {
            let share = f64::from(part) / f64::from(PARTS);
            let weight = 1.0 - share * share;
            sum += weight * self.middle(time + share * half);
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
        let middles: Vec<_> = times.iter().map(|&time| DVec3::new(0.3 * time, height(time), 0.0)).collect();
        Path { run: 0, times, centres: middles.clone(), middles }
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
                assert_eq!(path.smooth(time, half), path.middle(time));
            }
        }
    }

    /// Over a whole scene with hard impacts.
    #[test]
    fn a_camera_stays_with_its_body_and_never_jumps() {
        let text = include_str!("../../scenes/fig4b.toml");
        let scene = Scene::parse(text, "fig4b.toml", &crate::scene::Limits::default()).unwrap();
        let tracking = Tracking::new(&scene, &History::new(&scene, &[0, 1])).unwrap();
        let (viewport, scale) = ([0, 0, 640, 600], Scale::at(1.0));
        let shot = tracking.shot(&scene, (viewport, scale), None);
        assert!(!shot.is_still && tracking.window > 0.0, "{shot:?} {}", tracking.window);
        let (mut runner, mut last) = (crate::runner::Runner::new(&scene, &[0, 1]), None);
        for index in 0..=scene.last_frame() {
            let frame = runner.frame(index);
            let now: Vec<_> = frame
                .runs
                .iter()
                .map(|run| {
                    let place = Place::new(&scene.view, scene.body.dimension, &run.snapshot.position);
                    let seen = tracking.framing(&scene, &shot, run, place, (viewport, scale));
                    assert!((seen.target - shot.offset).distance(place.unwrap().middle) <= 1.0001 * tracking.slack());
                    (seen.target, seen.distance)
                })
                .collect();
            // The body arrives at 9.9 m/s, and nothing is faster.
            let bound = 9.9 / scene.frames_per_second + 2.0 * tracking.slack();
            for (now, last) in now.iter().zip(last.iter().flatten()) {
                let (now, last): (&(DVec3, f64), &(DVec3, f64)) = (now, last);
                assert!(now.0.distance(last.0) < bound && now.1 == last.1, "{index}: {now:?} after {last:?}");
            }
            last = Some(now);
        }
    }
}
