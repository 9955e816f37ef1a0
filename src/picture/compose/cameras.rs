//! The arrangement and the cameras of the panels of a frame.

use super::Composer;
use super::draft::PixelBox;
use crate::look::{CameraBoxes, Traced};
use crate::picture::Framing;
use crate::picture::camera::Lens;
use crate::picture::framing::{self, Seen, SeenMoment, Shot};
use crate::picture::layout::steps::{CLOSE, RING};
use crate::picture::layout::{Rectangle, Scale, clear_of_words};
use crate::runner::RunFrame;
use crate::runner::history::History;
use crate::scene::{Run, Scene};
use std::borrow::Cow;

/// The most columns of panels that a scene does not arrange itself, and how many times larger bodies must become for
/// fewer columns than possible.
const MOST_COLUMNS: usize = 64;
const LARGER: f64 = 1.02;
/// A camera that could follow stands still if bodies need at most this many times the space.
const MOST_SPACE: f64 = 2.0;
/// The share of the width of the room for bodies that the widest one takes, so that floors and shadows are seen.
const FILLED: f64 = 0.7;

impl Composer<'_> {
    /// The number of columns for the panels of some runs: that of the scene, or the one with the largest bodies.
    pub(super) fn columns(&self, runs: &[usize]) -> usize {
        let view = &self.scene.view;
        let pixels = |columns: usize| {
            let layout = self.around(runs, columns).layout;
            let panel = *layout.panels.first()?;
            let shot = self.shot(panel, layout.scale).map(|shot| shot.pixels);
            let still = || {
                let framing = Framing::still(&view.camera);
                let pixels = self.pixels_a_metre(panel, &framing, layout.scale);
                // What hardly fits into the width of its panel is not larger.
                let lens = Lens::new(view, &framing, self.scene.dimension(), panel.map(f64::from), layout.scale.unit);
                let nodes = self.scene.runs.iter().flat_map(|run| &run.initial.position);
                let [low, high] = PixelBox::new(&lens, nodes).corners;
                pixels * (FILLED * f64::from(panel[2]) / (high.x - low.x).max(1.0)).min(1.0)
            };
            Some(shot.unwrap_or_else(still))
        };
        let panels = runs.len();
        let most = panels.clamp(1, MOST_COLUMNS);
        let chosen = || {
            let mut best = (most, pixels(most).unwrap_or(0.0));
            // For each number of rows the columns are as even as possible. One row is preferred if bodies are nearly as
            // large.
            for columns in (2..=panels).map(|rows| panels.div_ceil(rows)).filter(|&columns| columns < most) {
                let pixels = pixels(columns).unwrap_or(0.0);
                best = if pixels > LARGER * best.1 { (columns, pixels) } else { best };
            }
            best.0
        };
        view.columns.map_or_else(chosen, |columns| columns.clamp(1, panels.max(1)))
    }

    /// The view of a camera that follows, in a panel.
    pub(super) fn shot(&self, viewport: Rectangle, scale: Scale) -> Option<Shot> {
        let [left, top, width, height] = clear_of_words(viewport, &self.scene.view, scale).map(f64::from);
        let [above, below] = [CLOSE, RING].map(|length| length * scale.unit);
        let room = [left, top - above, width.max(1.0), height.max(1.0) + above + below];
        let lens = framing::from_a_metre(self.scene, viewport, scale);
        framing::shots(self.seen.as_slice(), &lens, room, FILLED).pop()
    }

    /// The target and distance of the camera of a run in a panel.
    pub(super) fn framing(
        &self,
        shot: Option<&Shot>,
        run: &RunFrame,
        (viewport, scale): (Rectangle, Scale),
    ) -> Framing {
        let (view, body) = (&self.scene.view, self.scene.runs[run.run].body());
        let Some(shot) = shot else { return Framing::still(&view.camera) };
        let position = &run.shown().position;
        // Panels may differ by a pixel in width, but have one scale.
        let distance = framing::from_a_metre(self.scene, viewport, scale).focal / shot.pixels;
        if !shot.follows {
            return Framing { target: shot.offset, distance, azimuth: shot.azimuth, moves: false };
        }
        let centre = (position.len() == body.len()).then(|| Traced::Centre.of(body, position));
        let centre = centre.filter(|centre| centre.is_finite()).unwrap_or(view.camera.target);
        Framing { target: centre + shot.offset, distance, azimuth: shot.azimuth, moves: true }
    }
}

/// The view of a camera that chooses its own place, over the whole course of a scene; `None` if the scene places it, or without a place of
/// bodies. It follows the centre of mass. Where all simulated runs hold nodes it stands still, so that their panels can be compared, unless that makes
/// bodies much smaller.
pub(super) fn seen(scene: &Scene, history: &History) -> Option<Seen> {
    if !scene.view.camera.follow {
        return None;
    }
    let (distinct, _) = scene.distinct_bodies();
    let azimuth = history.azimuth();
    let start = |run: usize| {
        let Run { bodies, initial, .. } = &scene.runs[run];
        let seen = Cow::Owned(CameraBoxes::new(&scene.view, bodies, &initial.position)?);
        Some(SeenMoment { time: 0.0, run, seen, is_sound: true })
    };
    let courses = history.series.iter().flat_map(|course| {
        let (run, is_sound) = (course.run, !course.diverges());
        let boxes = course.times.iter().zip(&course.boxes);
        boxes.map(move |(&time, seen)| SeenMoment { time, run, seen: Cow::Borrowed(seen), is_sound })
    });
    let mut moments: Vec<_> = distinct.into_iter().filter_map(start).chain(courses).collect();
    let following = Seen::new(scene, azimuth, &moments, true)?;
    if !holds_nodes(scene) {
        return Some(following);
    }
    // Where a run that diverges goes is of no interest.
    moments.retain(|moment| moment.is_sound);
    let still = Seen::new(scene, azimuth, &moments, false);
    still.filter(|still| still.size() <= MOST_SPACE * following.size()).or(Some(following))
}

/// Whether all runs that are simulated, and at least one, hold or grab nodes from their start to their end.
fn holds_nodes(scene: &Scene) -> bool {
    let holds = |run: &Run| run.grips.iter().any(|grip| grip.from <= 0.0 && grip.until >= scene.duration);
    let mut simulated = scene.runs.iter().filter(|run| run.recording.is_none()).peekable();
    simulated.peek().is_some() && simulated.all(holds)
}
