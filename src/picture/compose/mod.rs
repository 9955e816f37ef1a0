//! Composes pictures. Each panel starts as a [`Draft`], whose parts are in separate files.

mod body;
mod difference;
mod figure;
mod ghost;
mod ground;
mod panel;
mod paths;
mod region;

use super::arrows;
use super::camera::Lens;
use super::caption::{self, Heading, Writer, wrapped};
use super::ears::{Ears, bare_elements};
use super::exploded::Exploded;
use super::layout::{Layout, Rectangle, Scale};
use super::legend::{Bar, Legend, Sample, SampleKind};
use super::locator::{Located, Locator};
use super::shell::Shell;
use super::skin::Skin;
use super::strip::Strips;
use super::tally::Tally;
use super::text::{Fonts, Weight};
use super::tracking::{Shot, Tracking};
use super::wire::{Edges, spring_strain};
use super::{Framing, Picture, number};
use crate::colour::Colour;
use crate::history::{History, Reach, TimeSeries};
use crate::look::ramp::ramp;
use crate::look::{ColourMap, Ghost, LineStyle, Palette, Place, StrainScale};
use crate::scene::Scene;
use crate::sim::body::{Body, Dimension, bounds};
use crate::sim::contact;
use crate::sim::grip::Grip;
use crate::sim::snapshot::{Frame, RunFrame, Snapshot};
use difference::Compared;
pub(crate) use figure::{NoRoom, compose_figure};
use glam::DVec3;
use panel::Draft;
use std::borrow::Cow;

/// Bodies with more elements than this along a side get softer light, as if their elements were larger.
const SOFT_SHARE: f64 = 4.5;

/// Captions are never longer than this (lines).
const MOST_LINES: usize = 200;
/// The scale bar is at most this long (px in the reference picture).
const SCALE_BAR: f64 = 120.0;
/// Panels that a scene leaves to be arranged stand in at most so many columns, and in fewer than possible only where that
/// makes bodies so many times larger.
const MOST_COLUMNS: usize = 64;
const LARGER: f64 = 1.02;

/// Composes frames of one scene.
#[derive(Debug)]
pub struct Composer<'a> {
    scene: &'a Scene,
    palette: Palette,
    fonts: Fonts,
    /// The elements in rows.
    tally: Tally,
    /// The second line of each run.
    descriptions: Vec<String>,
    /// The signed area of each polygon of a body in the plane.
    rest_areas: Vec<f64>,
    /// Which faces lie on its outside, and which between elements.
    shell: Shell,
    /// The surface of the body.
    skin: Skin,
    /// How faces that are not convex are cut into triangles.
    ears: Ears,
    /// Elements without faces.
    bare: Vec<usize>,
    /// The colours of a field, if one is shown.
    ramp: Vec<Colour>,
    /// The colours of the strain of springs, if it is shown.
    spring_ramp: Vec<Colour>,
    /// The body with its elements apart, if that is how it is drawn. What follows is about that one, then.
    exploded: Option<Exploded>,
    /// The nodes that are held and dragged.
    grips: Cow<'a, [Grip]>,
    /// The edges of the elements, if surfaces are not shown.
    edges: Edges,
    /// The nodes that get arrows.
    bearers: Vec<u32>,
    /// The size of the body (m).
    extent: f64,
    /// How many times larger it is drawn where its elements are drawn apart.
    spread: f64,
    /// The box around the nodes at the start (m).
    start_box: [DVec3; 2],
    /// The unit of soft distances (sides).
    soft: f64,
    /// The curves below the panels, once the time series are set.
    strips: Option<Strips>,
    /// The difference of two runs over time, and the paths of all runs, likewise.
    course: Option<difference::Course>,
    traced: Vec<TimeSeries>,
    /// How the camera follows, if it does.
    tracking: Option<Tracking>,
    /// The overview of a camera that follows, once the time series are set.
    locator: Option<Locator>,
    /// Where nodes have come near plates and walls, once the time series are set.
    reach: Reach,
}

/// Composes a single frame of a scene. For many frames, a [`Composer`] does what they share only once.
///
/// The time series of the scene are not known ([`Composer::set_history`]): the places of strips stay empty, and a camera that
/// follows takes its scale from the start.
pub fn compose(scene: &Scene, frame: &Frame) -> Picture {
    Composer::new(scene).compose(frame)
}

impl<'a> Composer<'a> {
    /// Prepares to compose frames of a scene. A scene without a background gets that of its theme; see
    /// [`Self::on_ground`].
    ///
    /// A scene with strips ([`crate::look::View::strip`]), paths, a difference or a camera that follows
    /// ([`crate::look::Camera::follow`]) needs [`Composer::set_history`], too; without it their places stay empty, and the
    /// camera's scale is that of the start.
    pub fn new(scene: &'a Scene) -> Self {
        Self::with(scene, scene.view.look.palette)
    }

    /// The same on a plain background, into which the floor and what is far fade; everything else keeps its colours.
    /// [`Renderer::draw_transparent`](crate::render::Renderer::draw_transparent) needs pictures on white and on black.
    pub fn on_ground(scene: &'a Scene, ground: Colour) -> Self {
        Self::with(scene, scene.view.look.palette.on_ground(ground))
    }

    fn with(scene: &'a Scene, palette: Palette) -> Self {
        let body = &*scene.body;
        let areas = match body.dimension {
            Dimension::Plane => body.elements.iter().map(|nodes| area(nodes, &body.rest)).collect(),
            Dimension::Space => Vec::new(),
        };
        let extent = body.extent().max(f64::MIN_POSITIVE);
        let tally = Tally::new(body, scene.view.side);
        let descriptions = scene.runs.iter().map(|run| run.model.describe(body)).collect();
        let (apart, ground) = (scene.view.explode, contact::ground(&scene.obstacles, 0.0));
        let exploded = (apart > 0.0).then(|| Exploded::new(body, apart));
        let grips = match &exploded {
            Some(exploded) => {
                let apart = |grip: &Grip| Grip { nodes: exploded.copies(&grip.nodes), ..grip.clone() };
                Cow::Owned(scene.grips.iter().map(apart).collect())
            }
            None => Cow::Borrowed(&scene.grips[..]),
        };
        let start = match &exploded {
            Some(exploded) => Cow::Owned(exploded.positions(&scene.initial.position, ground.map(|(normal, _)| normal))),
            None => Cow::Borrowed(&scene.initial.position),
        };
        let body = exploded.as_ref().map_or(body, |exploded| &exploded.body);
        let ears = Ears::new(body);
        let skin = Skin::new(body, &ears);
        let bare = bare_elements(body);
        let visible = scene.view.visible;
        let map = scene.view.colour.map(|scale| scale.map);
        // Fields and differences share one scale of colours.
        let map = map.or(scene.view.difference.map(|_| ColourMap::default()));
        Self {
            scene,
            ramp: map.map_or_else(Vec::new, |map| ramp(map, scene.view.look.theme)),
            spring_ramp: scene.view.spring_strain.map_or_else(Vec::new, |scale| ramp(scale.map, scene.view.look.theme)),
            edges: if visible.surfaces { Edges::default() } else { Edges::new(body) },
            bearers: if visible.displacements { bearers(body, &skin, &bare) } else { Vec::new() },
            palette,
            fonts: Fonts::new(&scene.view.look.font),
            tally,
            descriptions,
            rest_areas: areas,
            shell: if visible.surfaces { Shell::new(body) } else { Shell::default() },
            skin,
            ears,
            bare,
            extent,
            spread: 1.0 + apart,
            start_box: bounds(&start).into(),
            soft: (extent / scene.view.side / SOFT_SHARE).max(1.0),
            strips: None,
            course: None,
            traced: Vec::new(),
            tracking: scene.view.camera.follow.then(|| Tracking::new(scene, &History::default())).flatten(),
            locator: None,
            reach: Reach::default(),
            grips,
            exploded,
        }
    }

    /// Sets the time series: those of all runs to be shown, over the whole scene. Strips, paths and a difference show them, a
    /// camera that follows takes its path and its scale from them, and plates and walls their size.
    pub fn set_history(&mut self, history: &History) {
        let scene = self.scene;
        self.strips = scene.view.strip.map(|diagnostic| Strips::new(diagnostic, history, scene));
        self.tracking = scene.view.camera.follow.then(|| Tracking::new(scene, history)).flatten();
        self.locator = self.tracking.as_ref().map(|tracking| Locator::new(scene, tracking));
        self.reach = Reach::default();
        history.series.iter().for_each(|series| self.reach.merge(&series.reach));
        self.course = self.scene.view.difference.map(|_| difference::Course::new(history));
        self.traced = if self.scene.view.paths.is_empty() { Vec::new() } else { history.series.clone() };
    }

    /// Composes one frame.
    pub fn compose(&self, frame: &Frame) -> Picture {
        let view = &self.scene.view;
        let size = view.size.map(|length| length.max(1));
        let compared = self.compared(frame);
        let (runs, panels) = (frame.runs.len(), frame.runs.len() + usize::from(compared.is_some()));
        let columns = self.columns(panels);
        let legend = self.legend(panels, columns);
        let caption = self.caption(panels, columns);
        let layout = Layout::new(view, panels, columns, legend.map_or(0, |legend| legend.height), caption.len());
        let legend = legend.filter(|_| layout.has_legend);
        let scale = layout.scale;
        let shot = layout.panels.first().and_then(|place| self.shot(place.viewport, scale));
        let places = layout.panels.iter().zip(&frame.runs);
        let framings: Vec<_> =
            places.map(|(place, run)| self.framing(shot.as_ref(), run, (place.viewport, scale))).collect();
        let (marks, curves, words) = Default::default();
        let mut writer = Writer { palette: &self.palette, fonts: &self.fonts, scale, marks, curves, words };
        writer.hairlines(&layout);
        let hairlines = std::mem::take(&mut writer.marks);
        self.write(frame, &layout, columns, framings.first(), &mut writer);
        let place = layout.panels.get(frame.runs.len()).map(|place| (place.viewport, place.strip));
        let compared = compared.as_ref().zip(place);
        if let Some((compared, place)) = compared {
            let has_clock = view.labels.clock && clock(&layout, columns) == frame.runs.len();
            let time = has_clock.then_some(frame.time);
            self.write_difference(compared, place, frame.runs.len(), time, &mut writer);
        }
        if let Some(strips) = &self.strips {
            for (place, run) in layout.panels.iter().zip(&frame.runs) {
                place.strip.iter().for_each(|&room| strips.draw(&mut writer, room, run));
            }
        }
        if layout.has_title {
            writer.title(layout.around, f64::from(size[0]), &view.title);
        }
        writer.caption(layout.around, &cut(caption, layout.caption_lines), layout.caption);
        if let Some(((legend, place), framing)) = legend.zip(layout.panels.first()).zip(framings.first()) {
            let arrow = view.visible.displacements.then(|| self.key_arrow(legend, place.viewport, framing, scale));
            let bars = self.bars(frame, compared.map(|(compared, _)| compared));
            legend.draw(&mut writer, f64::from(size[0]), f64::from(layout.legend), arrow, &self.samples(), &bars);
        }
        let (mut under, mut marks, mut panels) = (Vec::new(), hairlines, Vec::with_capacity(runs));
        let mut ghosts = Vec::new();
        for ((place, run), framing) in layout.panels.iter().zip(&frame.runs).zip(&framings) {
            let draft = Draft::new(self, place.viewport, run, framing, scale);
            let room = draft.between_words();
            draft.ghost(&frame.runs, room, &mut ghosts);
            draft.paths(&self.traced, room, &mut ghosts);
            panels.push(draft.panel(&mut under, &mut marks));
            draft.points(room, &mut marks);
            if let Some((shot, tracking)) = shot.as_ref().zip(self.tracking.as_ref()) {
                self.locate(&draft, shot, tracking, &mut writer);
            }
        }
        if let Some((compared, place)) = compared {
            let framing = self.framing(shot.as_ref(), compared.one, (place.0, scale));
            let marks = [&mut under, &mut marks];
            panels.push(self.draw_difference(compared, place, &framing, scale, marks, &mut ghosts));
        }
        let Writer { marks: above, curves, mut words, .. } = writer;
        let curves = [ghosts, curves].concat();
        // Text and tallies lie above bodies; text over a body gets a halo.
        marks.extend(above);
        for word in &mut words {
            word.has_halo = panels.iter().any(|panel| word.touches(panel.region));
        }
        let (fonts, ramp) = (self.fonts.clone(), self.ramp.clone());
        Picture { size, palette: self.palette, fonts, ramp, panels, under, marks, curves, words }
    }

    /// In how many columns panels stand: as the scene says, or so that bodies are largest.
    fn columns(&self, runs: usize) -> usize {
        let view = &self.scene.view;
        let pixels = |columns: usize| {
            let legend = self.legend(runs, columns).map_or(0, |legend| legend.height);
            let layout = Layout::new(view, runs, columns, legend, 0);
            let viewport = layout.panels.first()?.viewport;
            let shot = self.shot(viewport, layout.scale).map(|shot| shot.pixels);
            let still = || self.pixels_a_metre(viewport, &Framing::still(&view.camera), layout.scale);
            Some(shot.unwrap_or_else(still))
        };
        let most = runs.clamp(1, MOST_COLUMNS);
        let chosen = || {
            let mut best = (most, pixels(most).unwrap_or(0.0));
            // With as many rows, as even as possible; side by side unless that costs much.
            for columns in (2..=runs).map(|rows| runs.div_ceil(rows)).filter(|&columns| columns < most) {
                let pixels = pixels(columns).unwrap_or(0.0);
                best = if pixels > LARGER * best.1 { (columns, pixels) } else { best };
            }
            best.0
        };
        view.columns.map_or_else(chosen, |columns| columns.clamp(1, runs.max(1)))
    }

    /// How a camera that follows sees a panel.
    fn shot(&self, viewport: Rectangle, scale: Scale) -> Option<Shot> {
        let taken = self.locator.as_ref().and_then(|locator| locator.place(&self.scene.view, viewport, scale));
        Some(self.tracking.as_ref()?.shot(self.scene, viewport, scale, taken))
    }

    /// What the camera of a run looks at in a panel.
    fn framing(&self, shot: Option<&Shot>, run: &RunFrame, panel: (Rectangle, Scale)) -> Framing {
        let Some((tracking, shot)) = self.tracking.as_ref().zip(shot) else {
            return Framing::still(&self.scene.view.camera);
        };
        let Scene { view, body, obstacles, .. } = self.scene;
        let position = &run.shown().position;
        let is_known = position.len() == body.len();
        let place = is_known.then(|| Place::new(view, body.dimension, obstacles, position)).flatten();
        tracking.framing(self.scene, shot, run, place, panel)
    }

    /// Draws the overview of a panel, if its camera moves.
    fn locate(&self, draft: &Draft<'_>, shot: &Shot, tracking: &Tracking, writer: &mut Writer<'_>) {
        let (view, viewport) = (&self.scene.view, draft.viewport);
        let Some(locator) = self.locator.as_ref().filter(|_| !shot.is_still) else { return };
        let Some(place) = locator.place(view, viewport, writer.scale) else { return };
        if draft.position.is_empty() {
            return;
        }
        let at = |&node: &u32| draft.position[node as usize];
        let bars = self.bare.iter().flat_map(|&element| draft.body.topology().edges_of(element));
        let located = Located {
            points: self.skin.nodes.iter().map(at).collect(),
            triangles: &self.skin.triangles,
            bars: bars.map(|ends| ends.map(|node| at(&node))).collect(),
            shown: draft.lens.shown(viewport.map(f64::from), shot.pixels),
            colour: self.scene.runs.get(draft.run.run).map_or(self.palette.text, |run| run.line(&self.palette).colour),
        };
        let run = (draft.run.run, draft.run.snapshot.time);
        locator.draw(writer, place, tracking, run, &located);
    }

    /// The lines of the caption.
    fn caption(&self, runs: usize, columns: usize) -> Vec<String> {
        let view = &self.scene.view;
        let around = Layout::around(view, runs, columns);
        if !Scale::legible(around.caption()) {
            return Vec::new();
        }
        // Panels' margins are no wider than those around them.
        let room = f64::from(view.size[0]) - 2.0 * around.margin();
        let lines = wrapped(&self.fonts, &view.caption, Weight::Regular, around.caption(), room);
        lines.into_iter().take(MOST_LINES).collect()
    }

    /// Writes the words of all panels.
    fn write(
        &self,
        frame: &Frame,
        layout: &Layout,
        columns: usize,
        framing: Option<&Framing>,
        writer: &mut Writer<'_>,
    ) {
        let view = &self.scene.view;
        let labels = view.labels;
        let clock = clock(layout, columns);
        for (at, (place, run)) in layout.panels.iter().zip(&frame.runs).enumerate() {
            let viewport = place.viewport;
            let has_clock = labels.clock && at == clock;
            let taken = if has_clock { writer.clock_room(viewport, &view.clock) } else { [0.0; 2] };
            let shown = |is_shown: bool, text| if is_shown { text } else { "" };
            let heading = Heading {
                letter: if labels.letter { caption::letter(at) } else { String::new() },
                name: shown(labels.name, self.scene.runs.get(run.run).map_or("", |run| &run.name)),
                sample: self.sample(run.run, place.strip.is_some()),
                second: shown(labels.model, self.descriptions.get(run.run).map_or("", String::as_str)),
            };
            writer.heading(viewport, &heading, taken);
            if has_clock {
                writer.clock(viewport, frame.time, &view.clock);
            }
            let margin = writer.scale.margin();
            let mut from = f64::from(viewport[0]) + margin;
            let to = f64::from(viewport[0] + viewport[2]) - margin;
            if labels.count {
                from = writer.count(viewport, &self.tally, run.shown());
            }
            let usual = caption::number(self.scene, &run.snapshot, self.smallest_area_ratio(&run.snapshot));
            let to = to.min(writer.left_of_numbers(viewport, &usual));
            // One scale for all panels, and so one bar.
            if let Some(framing) = framing.filter(|_| view.scale_bar && at == 0) {
                let room = to - from - 2.0 * writer.scale.gap();
                let (metres, pixels) = self.scale_bar(viewport, framing, writer.scale, room);
                from = writer.scale_bar(viewport, [from, to], metres, pixels).unwrap_or(from);
            }
            match caption::divergence(run) {
                Some(divergence) => writer.number(viewport, from, &divergence),
                None if labels.number => writer.number(viewport, from, &usual),
                None => {}
            }
        }
    }

    /// The line that stands for a run in strips and among arrows, if there are any.
    fn sample(&self, run: usize, has_strip: bool) -> Option<LineStyle> {
        let view = &self.scene.view;
        let has_arrows = view.visible.displacements && view.colour.is_none();
        let has_ghost =
            matches!(view.ghost, Some(Ghost::Run(_))) || view.difference.is_some() || !view.paths.is_empty();
        (view.legend && (has_strip || has_arrows || has_ghost)).then(|| self.scene.runs.get(run)).flatten().map(|run| {
            let line = run.line(&self.palette);
            // Arrows are solid.
            if has_strip || has_ghost { line } else { LineStyle { dash: &[], ..line } }
        })
    }

    /// What a scale bar in a room (px) stands for (m), and how long it is (px).
    fn scale_bar(&self, viewport: Rectangle, framing: &Framing, scale: Scale, room: f64) -> (f64, f64) {
        let pixels = self.pixels_a_metre(viewport, framing, scale);
        let metres = number::round_below((SCALE_BAR * scale.unit).min(room).max(1.0) / pixels);
        (metres, metres * pixels)
    }

    /// The pixels of a metre at the point looked at.
    fn pixels_a_metre(&self, viewport: Rectangle, framing: &Framing, scale: Scale) -> f64 {
        let Self { scene, .. } = self;
        let lens = Lens::new(&scene.view, framing, scene.body.dimension, viewport.map(f64::from), scale.unit);
        lens.focal / if lens.orthographic { 1.0 } else { framing.distance }
    }

    /// The key of colours and arrows, if there are any.
    fn legend(&self, runs: usize, columns: usize) -> Option<Legend> {
        let view = &self.scene.view;
        let bars = [view.colour.is_some(), view.spring_strain.is_some(), view.difference.is_some()];
        let bars = bars.into_iter().filter(|&is_shown| is_shown).count();
        let (arrow, samples) = (view.visible.displacements, self.samples().len());
        if !view.legend || !arrow && samples + bars == 0 {
            return None;
        }
        let around = Layout::around(view, runs, columns);
        Legend::new(view.size.map(|length| length.max(1)), around, arrow, samples, bars)
    }

    /// What lines and marks mean.
    fn samples(&self) -> Vec<Sample<'_>> {
        let ghost = self.ghost().map(|(name, colour)| Sample { name: name.into(), colour, kind: SampleKind::Ghost });
        let path = Some(self.path_name()).filter(|name| !name.is_empty());
        let colour = self.palette.text;
        let path = path.map(|name| Sample { name: name.into(), colour, kind: SampleKind::Path });
        let points = self.scene.view.points.as_ref();
        let points = points.map(|_| Sample { name: "measured".into(), colour, kind: SampleKind::Ring });
        ghost.into_iter().chain(path).chain(points).collect()
    }

    /// The scales of colours in a frame.
    fn bars(&self, frame: &Frame, compared: Option<&Compared<'_>>) -> Vec<Bar<'_>> {
        let view = &self.scene.view;
        let of_field = view.colour.as_ref().map(|colour| {
            let values = frame.runs.iter().flat_map(|run| &run.shown().field).copied();
            let field = colour.field;
            Bar::new([field.name(), field.unit(), field.definition()], colour.range, &self.ramp, values)
        });
        let body = &*self.scene.body;
        let of_springs = view.spring_strain.map(|StrainScale { range, .. }| {
            let whole = frame.runs.iter().filter(|run| run.shown().position.len() == body.len());
            let strains = whole.flat_map(|run| {
                let springs = self.scene.runs.get(run.run).map_or(&[][..], |run| run.model.springs());
                springs.iter().map(|&ends| spring_strain(body, &run.shown().position, ends))
            });
            Bar::new(["spring strain", "", "change of length over length at rest"], range, &self.spring_ramp, strains)
        });
        let of_difference = view.difference.map(|_| {
            let values = self.distances(compared).iter().copied();
            Bar::new(
                ["distance", "m", "of the same node of the two runs"],
                self.distance_scale().range,
                &self.ramp,
                values,
            )
        });
        of_field.into_iter().chain(of_springs).chain(of_difference).collect()
    }

    /// What the arrow of the key stands for (m), its length (px), and how large it is beside those of the reference picture.
    fn key_arrow(&self, legend: Legend, viewport: Rectangle, seen: &Framing, scale: Scale) -> [f64; 3] {
        let pixels = self.pixels_a_metre(viewport, seen, scale);
        let times = self.scene.view.arrow_scale;
        let metres = legend.arrow_metres(pixels * times);
        let size = arrows::size(pixels * self.scene.view.side, scale.unit) * scale.line_factor;
        [metres, metres * pixels * times, size]
    }

    /// The smallest signed area of a polygon over its area at rest, for bodies in the plane.
    fn smallest_area_ratio(&self, snapshot: &Snapshot) -> Option<f64> {
        let body = &*self.scene.body;
        if self.rest_areas.is_empty() || snapshot.position.len() != body.len() {
            return None;
        }
        let areas = body.elements.iter().zip(&self.rest_areas).filter(|(_, rest)| **rest != 0.0);
        areas.map(|(nodes, rest)| area(nodes, &snapshot.position) / rest).reduce(f64::min)
    }
}

/// As many lines as there is room for; if that is not all of them, the last one ends in an ellipsis.
fn cut(mut lines: Vec<String>, room: usize) -> Vec<String> {
    let is_cut = lines.len() > room;
    lines.truncate(room);
    if let Some(last) = lines.last_mut().filter(|_| is_cut) {
        last.pop();
        last.push('…');
    }
    lines
}

/// The nodes that get arrows: those on the surface and those of elements without faces.
fn bearers(body: &Body, skin: &Skin, bare: &[usize]) -> Vec<u32> {
    let of_bare = bare.iter().flat_map(|&element| &body.elements[element]);
    let mut nodes: Vec<u32> = skin.nodes.iter().chain(of_bare).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    arrows::bearers(&nodes)
}

/// The signed area of a polygon in the xy-plane (m²).
fn area(nodes: &[u32], position: &[DVec3]) -> f64 {
    let at = |node: u32| position[node as usize].truncate() - position[nodes[0] as usize].truncate();
    nodes.windows(2).map(|two| 0.5 * at(two[0]).perp_dot(at(two[1]))).sum()
}

/// The panel with the only clock, upper right.
fn clock(layout: &Layout, columns: usize) -> usize {
    columns.clamp(1, layout.panels.len().max(1)) - 1
}
