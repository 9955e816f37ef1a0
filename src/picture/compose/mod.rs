//! Putting a picture together. Each of its panels is a [`Draft`] first, whose parts have files of their own.

mod body;
mod ground;
mod panel;
mod region;

use super::arrows;
use super::camera::{Lens, Middles, framing};
use super::caption::{Writer, numbers};
use super::ears::{Ears, bare_elements};
use super::layout::{self, Rectangle, Scale};
use super::legend::{self, Legend};
use super::palette::Palette;
use super::plane::LEVEL;
use super::ramp;
use super::shell::Shell;
use super::skin::Skin;
use super::tally::Tally;
use super::wire::Edges;
use super::{Colour, Framing, Picture};
use crate::scene::{Camera, Follow, Scene};
use crate::sim::body::{Body, Dimension, bounds};
use crate::sim::contact;
use crate::sim::snapshot::{Frame, Snapshot, Status};
use glam::DVec3;
use panel::Draft;

/// Bodies of more elements than this along a side have softer light, as if their elements were larger.
const SOFT_SHARE: f64 = 4.5;

/// Composes frames of one scene.
#[derive(Debug)]
pub struct Composer<'a> {
    scene: &'a Scene,
    palette: Palette,
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
    /// The edges of the elements, if surfaces are not shown.
    edges: Edges,
    /// The nodes that get arrows.
    bearers: Vec<u32>,
    /// The size of the body (m).
    extent: f64,
    /// The middle of the nodes at the start (m).
    start: DVec3,
    /// The box around the nodes at the start (m).
    start_box: [DVec3; 2],
    /// The unit of soft distances (sides).
    soft: f64,
}

/// Composes a single frame of a scene. For many frames, a [`Composer`] does what they share only once.
pub fn compose(scene: &Scene, frame: &Frame) -> Picture {
    Composer::new(scene).compose(frame)
}

impl<'a> Composer<'a> {
    /// Prepares to compose frames of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        let body = &*scene.body;
        let areas = match body.dimension {
            Dimension::Plane => body.elements.iter().map(|nodes| area(nodes, &body.rest)).collect(),
            Dimension::Space => Vec::new(),
        };
        let extent = body.extent().max(f64::MIN_POSITIVE);
        let ears = Ears::new(body);
        let skin = Skin::new(body, &ears);
        let bare = bare_elements(body);
        let visible = scene.view.visible;
        Self {
            scene,
            ramp: scene.view.colour.map_or_else(Vec::new, |_| ramp::ramp(scene.view.theme)),
            edges: if visible.surfaces { Edges::default() } else { Edges::new(body) },
            bearers: if visible.displacements { bearers(body, &skin, &bare) } else { Vec::new() },
            palette: Palette::of(scene.view.theme),
            tally: Tally::new(body, scene.view.side),
            descriptions: scene.runs.iter().map(|run| run.model.describe(body)).collect(),
            rest_areas: areas,
            shell: if visible.surfaces { Shell::new(body) } else { Shell::default() },
            skin,
            ears,
            bare,
            extent,
            start_box: bounds(&scene.initial.position).into(),
            start: mean(&scene.initial.position).unwrap_or_default(),
            soft: (extent / scene.view.side / SOFT_SHARE).max(1.0),
        }
    }

    /// Composes one frame.
    pub fn compose(&self, frame: &Frame) -> Picture {
        let view = &self.scene.view;
        let size = view.size.map(|length| length.max(1));
        let legend = self.legend(size, frame.runs.len());
        // The key stands below all panels.
        let above_legend = [size[0], size[1] - legend.map_or(0, |legend| legend.height)];
        let panels = layout::panels(above_legend, frame.runs.len(), view.columns);
        let framing = self.framing(frame);
        let scale = panels.first().map_or(Scale { unit: 1.0 }, |&panel| Scale::new(size, panel));
        let mut writer = Writer { palette: &self.palette, scale, marks: Vec::new(), words: Vec::new() };
        writer.hairlines(&panels);
        self.write(frame, &panels, &mut writer);
        if let Some((legend, &viewport)) = legend.zip(panels.first()) {
            let arrow = view.visible.displacements.then(|| self.key_arrow(legend, viewport, &framing, scale));
            let colours = view.colour.as_ref().map(|colour| (colour, &self.ramp[..], legend::beyond(colour, frame)));
            legend.draw(&mut writer, size, arrow, colours);
        }
        let Writer { mut marks, words, .. } = writer;
        let mut under = Vec::new();
        let panels = panels
            .iter()
            .zip(&frame.runs)
            .map(|(&viewport, run)| Draft::new(self, viewport, run, &framing, scale).panel(&mut under, &mut marks))
            .collect();
        Picture { size, palette: self.palette, ramp: self.ramp.clone(), panels, under, marks, words }
    }

    /// What the camera of all panels looks at.
    fn framing(&self, frame: &Frame) -> Framing {
        let middles = Middles::new(frame.runs.iter().filter_map(|run| middle(&run.snapshot)), self.start);
        let level = contact::ground(&self.scene.obstacles, frame.time).is_some_and(|(normal, _)| normal.y > LEVEL);
        framing(&self.scene.view.camera, &middles, !level)
    }

    /// Writes the words of all panels.
    fn write(&self, frame: &Frame, panels: &[Rectangle], writer: &mut Writer<'_>) {
        let view = &self.scene.view;
        // One clock, upper right.
        let clock = view.columns.clamp(1, panels.len().max(1)) - 1;
        for (at, (&viewport, run)) in panels.iter().zip(&frame.runs).enumerate() {
            let taken = if at == clock { writer.clock_room(viewport, &view.clock) } else { [0.0; 2] };
            let name = self.scene.runs.get(run.run).map_or("", |run| &run.name);
            let second = self.descriptions.get(run.run).map_or("", String::as_str);
            writer.heading(viewport, name, second, taken);
            if at == clock {
                writer.clock(viewport, frame.time, &view.clock);
            }
            let numbers = numbers(self.scene, &run.snapshot, self.smallest_area_ratio(&run.snapshot));
            writer.count(viewport, &self.tally, &run.snapshot, &numbers);
        }
    }

    /// The key of colours and arrows, if there are any.
    fn legend(&self, size: [u32; 2], runs: usize) -> Option<Legend> {
        let view = &self.scene.view;
        let parts = [view.visible.displacements, view.colour.is_some()];
        if parts == [false; 2] {
            return None;
        }
        let panels = layout::panels(size, runs, view.columns);
        Legend::new(size, Scale::new(size, *panels.first()?), parts)
    }

    /// What the arrow of the key stands for (m), which no motion changes, its length in this frame (px), and
    /// how large it is beside those of the reference picture.
    fn key_arrow(&self, legend: Legend, viewport: Rectangle, seen: &Framing, scale: Scale) -> [f64; 3] {
        let Self { scene, .. } = self;
        let edges = viewport.map(f64::from);
        let pixels = |framing: &Framing| {
            let lens = Lens::new(&scene.view, framing, scene.body.dimension, edges, scale.unit);
            // In space, the key holds at the point looked at.
            lens.focal / if lens.orthographic { 1.0 } else { framing.distance }
        };
        let camera = Camera { follow: Follow::Nothing, ..scene.view.camera.clone() };
        let times = scene.view.arrow_scale;
        let metres = legend.arrow_metres(pixels(&framing(&camera, &Middles::new([], DVec3::ZERO), false)) * times);
        [metres, metres * pixels(seen) * times, arrows::size(pixels(seen) * scene.view.side, scale.unit)]
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

/// The middle of a body's nodes (m); `None` for a run that blew up, which no camera can follow.
fn middle(snapshot: &Snapshot) -> Option<DVec3> {
    let followed = !matches!(snapshot.status, Status::Diverged(_));
    mean(&snapshot.position).filter(|middle| followed && middle.is_finite())
}

/// The mean of points; `None` if there are none.
fn mean(points: &[DVec3]) -> Option<DVec3> {
    (!points.is_empty()).then(|| points.iter().sum::<DVec3>() / points.len() as f64)
}
