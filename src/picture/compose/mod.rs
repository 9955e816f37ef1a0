//! Composes pictures. Each panel starts as a [`Draft`], whose parts are in separate files.

mod bodies;
mod body;
mod cameras;
mod carried;
mod cut;
mod draft;
mod edges;
mod figure;
mod fine;
mod ground;
mod key;
mod numbers;
mod obstacle;
mod overlay;
mod panel;
mod plane_marks;
mod pointer;
mod region;
mod rim;
mod skin;
mod surface;
mod wire;
mod words;

use super::camera::Lens;
use super::caption::{self, Writer};
use super::chart::event::Event;
use super::chart::timeline::Timeline;
use super::framing::{Seen, Shot};
use super::layout::tree::Solved;
use super::layout::{Part, Rectangle, Scale, WordsShown, baselines};
use super::number;
use super::text::Fonts;
use super::{Framing, Picture};
use crate::colour::{Colour, LINE_CONTRAST, readable};
use crate::look::ramp::ramp;
use crate::look::{BODIES, Palette};
use crate::runner::Frame;
use crate::runner::history::{History, NearObstacles, TimeSeries};
use crate::scene::{Run, Scene};
use crate::sim::geometry::bounds;
use crate::sim::{Dimension, Status};
use bodies::Bodies;
use draft::Draft;
pub(crate) use figure::compose_figure;
use glam::DVec3;
use numbers::NumberPart;
use overlay::KeyPlace;
use std::sync::OnceLock;
use words::PageWords;
pub(crate) use words::{left_out, type_left_out};

/// Composes frames of one scene.
#[derive(Debug)]
pub struct Composer<'a> {
    scene: &'a Scene,
    palette: Palette,
    fonts: Fonts,
    /// The bodies of runs. Runs that share them have one entry.
    bodies: Vec<Bodies<'a>>,
    /// The place of each run's bodies among them.
    bodies_of: Vec<usize>,
    /// The springs of each run, if they are shown.
    springs: Vec<Vec<[u32; 2]>>,
    /// The second line of each run.
    descriptions: Vec<String>,
    /// The colours of a field, if one is shown.
    ramp: Vec<Colour>,
    /// The size of the bodies (m).
    extent: f64,
    /// The box around the nodes of all runs at the start (m).
    start_box: [DVec3; 2],
    /// The charts below the panels, if the time series are known.
    timeline: Option<Timeline>,
    /// The paths of all runs, if the time series are known.
    traced: Vec<TimeSeries>,
    /// The course that a camera sees, if it follows.
    seen: Option<Seen>,
    /// The farthest shadow of a body ([`ground::shadow_way`]).
    shadow_way: Option<f64>,
    /// The boxes of nodes near plates and walls, if the time series are known.
    reach: NearObstacles,
    /// The arrangement of the panels of the first frame, which all frames of the same runs have.
    arranged: OnceLock<Arranged>,
}

/// The arrangement of the panels of some runs, in any frame.
#[derive(Debug)]
struct Arranged {
    runs: Vec<usize>,
    columns: usize,
    around: PageWords,
    /// The view of a camera that follows.
    shot: Option<Shot>,
    /// The part of panels' widths for tallies.
    numbers: Solved<NumberPart>,
}

impl<'a> Composer<'a> {
    /// Prepares to compose frames of a scene, with the time series of all runs in the frames
    /// ([`History::for_pictures`]).
    ///
    /// Charts and paths show the time series. A camera that follows takes its scale from them, and plates and walls
    /// their size. With an empty history there are no charts and paths, and all scales are those of the start.
    pub fn new(scene: &'a Scene, history: &History) -> Self {
        let (distinct, bodies_of) = scene.distinct_bodies();
        let bodies = distinct.iter().map(|&run| Bodies::new(scene, &scene.runs[run])).collect();
        let boxes = distinct.iter().map(|&run| <[DVec3; 2]>::from(bounds(&scene.runs[run].initial.position)));
        let start_box = boxes.reduce(|[low, high], [from, to]| [low.min(from), high.max(to)]);
        let springs = |run: &Run| if scene.view.visible.springs { run.springs() } else { Vec::new() };
        let map = scene.view.colour.map(|scale| scale.map);
        let mut reach = NearObstacles::default();
        history.series.iter().for_each(|series| reach.merge(&series.reach));
        let mut composer = Self {
            scene,
            ramp: map.map_or_else(Vec::new, |map| ramp(map, scene.view.look.theme)),
            palette: with_visible_lines(scene.view.look.palette(), scene),
            fonts: Fonts::new(&scene.view.look.font),
            bodies,
            bodies_of,
            springs: scene.runs.iter().map(springs).collect(),
            descriptions: scene
                .runs
                .iter()
                .map(|run| number::counted(caption::short_description(scene, run)))
                .collect(),
            extent: scene.extent().max(f64::MIN_POSITIVE),
            start_box: start_box.unwrap_or_default(),
            timeline: None,
            traced: if scene.view.paths.is_empty() { Vec::new() } else { history.series.clone() },
            seen: cameras::seen(scene, history),
            shadow_way: ground::shadow_way(scene, history),
            reach,
            arranged: OnceLock::new(),
        };
        composer.timeline = composer.charts(history);
        composer
    }

    /// The azimuth of the camera (rad); `None` in the plane.
    pub(crate) fn azimuth(&self) -> Option<f64> {
        let azimuth = self.seen.as_ref().map_or(self.scene.view.camera.azimuth, |seen| seen.azimuth);
        (self.scene.dimension() == Dimension::Space).then_some(azimuth)
    }

    /// The charts below the panels, if the scene has any and its time series are known.
    fn charts(&self, history: &History) -> Option<Timeline> {
        let scene = self.scene;
        if scene.view.charts.is_empty() || history.series.is_empty() {
            return None;
        }
        let runs: Vec<_> = history.series.iter().map(|series| series.run).collect();
        let layout = self.around(&runs, self.columns(&runs)).layout;
        let (panel, in_panel) = (layout.panels.first().filter(|_| layout.written.events), self.writer(layout.scale));
        let explained = |events: &[&Event]| panel.map_or(0, |&panel| in_panel.explained(panel, events));
        Some(Timeline::new(history, scene, || self.writer(layout.around), &layout, explained))
    }

    /// The bodies of a run.
    fn bodies(&self, run: usize) -> &Bodies<'a> {
        &self.bodies[self.bodies_of[run]]
    }

    /// An empty writer, with type and lines of a scale.
    fn writer(&self, scale: Scale) -> Writer<'_> {
        Writer::new(&self.palette, &self.fonts, scale)
    }

    /// The time of a frame in words.
    fn clock(&self, frame: &Frame) -> String {
        number::time(frame.time, self.scene.duration)
    }

    /// Composes one frame.
    pub fn compose(&self, frame: &Frame) -> Picture {
        let view = &self.scene.view;
        let size = view.size.map(|length| length.max(1));
        let runs: Vec<_> = frame.runs.iter().map(|run| run.run).collect();
        let others;
        let arranged = match self.arranged.get_or_init(|| self.arrange(&runs, self.columns(&runs))) {
            known if known.runs == runs => known,
            _ => {
                others = self.arrange(&runs, self.columns(&runs));
                &others
            }
        };
        let Arranged { around, shot, .. } = arranged;
        let PageWords { layout, titles, legend, clock_above } = around;
        let scale = layout.scale;
        let places = layout.panels.iter().zip(&frame.runs);
        let framings = places.map(|(&panel, run)| self.framing(shot.as_ref(), run, (panel, scale)));
        let framings: Vec<_> = framings.collect();
        let mut writer = self.writer(scale);
        writer.hairlines(layout);
        let hairlines = std::mem::take(&mut writer.marks);
        self.write(frame, arranged, framings.first(), &mut writer);
        self.timeline.iter().for_each(|timeline| timeline.draw(&mut writer, frame));
        // The title and the words of panels have the same left edge.
        let margin = scale.margin();
        for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(titles) {
            writer.lines(&layout.parts, part, layout.around, lines, margin);
        }
        let clock = clock_above.and_then(|part| baselines(&layout.parts, part, layout.around).next());
        if let Some(baseline) = clock {
            writer.clock_alone(layout.around, [f64::from(size[0]), baseline], &self.clock(frame), &view.clock);
        }
        let place = layout.parts.get(Part::Legend).zip(layout.panels.first());
        if let Some(((legend, ([_, top, width, _], &panel)), framing)) = legend.zip(place).zip(framings.first()) {
            let samples = self.samples(&KeyPlace::new(self, legend, panel, framing, scale));
            legend.draw(&mut writer, [width, top], &samples, self.bar(frame).as_ref());
        }
        let (mut under, mut marks, mut panels) = (Vec::new(), Vec::new(), Vec::with_capacity(runs.len()));
        let curves = std::mem::take(&mut writer.curves);
        for ((&panel, run), framing) in layout.panels.iter().zip(&frame.runs).zip(&framings) {
            let draft = Draft { others: &frame.runs, ..Draft::new(self, panel, run, framing, scale) };
            panels.push(draft.panel(&mut under, &mut marks));
            draft.overlays(&mut marks, &mut writer.curves);
        }
        marks.extend(hairlines);
        writer.curves.extend(curves);
        // Text and tallies lie above bodies; text over a body gets a halo.
        writer.over_bodies(&panels, plane_marks::have_slopes(self.scene));
        marks.extend(writer.items());
        let (fonts, ramp) = (self.fonts.clone(), self.ramp.clone());
        Picture { size, palette: self.palette, fonts, ramp, panels, under, above: marks }
    }

    /// Arranges the panels of some runs in columns.
    fn arrange(&self, runs: &[usize], columns: usize) -> Arranged {
        let around = self.around(runs, columns);
        let (layout, scale) = (&around.layout, around.layout.scale);
        let shot = layout.panels.first().and_then(|&panel| self.shot(panel, scale));
        let numbers = self.numbers(runs, layout, shot.as_ref());
        Arranged { runs: runs.to_vec(), columns, around, shot, numbers }
    }

    /// Writes the words of all panels.
    fn write(&self, frame: &Frame, arranged: &Arranged, framing: Option<&Framing>, writer: &mut Writer<'_>) {
        let &Arranged { ref runs, columns, ref around, ref numbers, .. } = arranged;
        let (layout, with_clock) = (&around.layout, around.clock_above.is_none());
        let (names, seconds) = (self.names(runs), self.seconds(runs, layout));
        for (at, (&viewport, run)) in layout.panels.iter().zip(&frame.runs).enumerate() {
            let &WordsShown { labels, events, .. } = &layout.written;
            let heading = self.heading(at, runs, &names, &seconds, layout);
            let has_clock = labels.clock && with_clock && at == words::clock_panel(layout.panels.len(), columns);
            let taken = if has_clock { writer.clock_room(viewport, self.clock_label(layout))[0] } else { 0.0 };
            writer.heading(viewport, &heading, taken);
            if let (Some(timeline), Some(shown)) =
                (self.timeline.as_ref().filter(|_| events), self.scene.runs.get(run.run))
            {
                let colour = shown.line(&self.palette).colour;
                writer.events(viewport, timeline.events_of(run.run), colour, frame.time);
            }
            if has_clock {
                writer.clock(viewport, &self.clock(frame), self.clock_label(layout));
            }
            let place = |numeral| numbers.get(numeral).map(|[left, _, width, _]| [left, left + width]);
            // The shown state of a run that diverges lacks the present number of turned-over elements.
            let is_counted = run.shown().status == Status::Ok;
            let count = place(NumberPart::Tally).zip(place(NumberPart::Count)).filter(|_| is_counted);
            // All panels have one scale, so there is one bar.
            let bar = framing.zip(place(NumberPart::Bar)).filter(|_| at == 0).and_then(|(framing, between)| {
                writer.scale_bar(viewport, between, self.bars(viewport, framing, writer.scale))
            });
            if let Some((place_of_tally, count)) = count {
                let tally = &self.bodies(run.run).tally;
                let next = bar.map(|bar| bar[0]).or(place(NumberPart::Number).map(|number| number[0]));
                let end = next.map_or(count[1], |left| (left - writer.scale.gap()).max(count[1]));
                let places = ([place_of_tally, count], end);
                writer.count(viewport, places, (tally, &self.names_of(run.run)), run.shown());
            }
            let taken = bar.or(count.map(|(_, count)| count)).map_or(0.0, |[_, end]| end);
            match caption::divergence(run, self.scene.duration) {
                // Without a row for numbers it would lie over the name.
                Some(_) if layout.written.left_out.contains(&Part::Numbers) => {}
                Some(divergence) => writer.number(viewport, taken, &divergence),
                None if labels.number && place(NumberPart::Number).is_some() => {
                    let ratio = self.bodies(run.run).smallest_area_ratio(&run.snapshot);
                    let usual = caption::number(self.extent, &run.snapshot, ratio);
                    writer.number(viewport, taken, &usual);
                }
                None => {}
            }
        }
    }

    /// Pixels per metre at the target.
    fn pixels_a_metre(&self, viewport: Rectangle, framing: &Framing, scale: Scale) -> f64 {
        let Self { scene, .. } = self;
        let lens = Lens::new(&scene.view, framing, scene.dimension(), viewport.map(f64::from), scale.unit);
        lens.focal / if lens.orthographic { 1.0 } else { framing.distance }
    }
}

/// The palette of a scene. Bodies of segments, such as chains, are lines: their colours are as visible as those of other lines.
fn with_visible_lines(mut palette: Palette, scene: &Scene) -> Palette {
    let is_line = |body: &usize| scene.bodies[*body].body.elements().iter().all(|nodes| nodes.len() == 2);
    for at in 0..BODIES {
        let mut bodies = scene.runs.iter().flat_map(|run| run.of.iter().skip(at).step_by(BODIES)).peekable();
        if bodies.peek().is_some() && bodies.all(is_line) {
            let visible = |colour: &mut Colour| *colour = readable(*colour, palette.background, LINE_CONTRAST);
            [&mut palette.bodies[at], &mut palette.bodies_flat[at]].into_iter().for_each(visible);
        }
    }
    palette
}
