//! Putting a picture together.

use super::arrows::{self, Arrows};
use super::camera::{Lens, Middles, framing};
use super::caption::{Writer, numbers};
use super::ears::{Ears, bare_elements};
use super::field::{NOWHERE, Shades};
use super::grip::Hands;
use super::layout::{self, Rectangle, Scale};
use super::legend::{self, Legend};
use super::narrow::{narrow, narrow_point};
use super::obstacle::{self, Site, Staged, Staging};
use super::palette::Palette;
use super::plane::{Flat, LEVEL, node_radius};
use super::pointer::Pointers;
use super::ramp;
use super::shadow::{self, Plane};
use super::skin::Skin;
use super::surface::{Lines, Surroundings, boundary};
use super::tally::Tally;
use super::wire::{Edges, Wire};
use super::{Colour, Floor, Framing, Line, LineKind, Mark, Mesh, Panel, Picture, Sight, Stroke};
use crate::scene::{Camera, Follow, Scene};
use crate::sim::body::{Body, Dimension, bounds};
use crate::sim::contact::{self, Motion, Obstacle, Shape};
use crate::sim::snapshot::{Frame, RunFrame, Snapshot, Status};
use glam::{DVec2, DVec3};
use std::borrow::Cow;

/// The key light comes from this far to the left of the viewer (rad).
const KEY_AZIMUTH: f64 = 62.0 * std::f64::consts::PI / 180.0;
/// The slope at which it falls on a body near the floor: 50° up.
const KEY_SLOPE: f64 = 1.191_753_592_594_21;
/// How much steeper it falls for each distance of the camera that bodies have risen: the shadow stays in the panel.
const KEY_STEEPENING: f64 = 8.0;
/// Where floor, grid and shadow begin and end to fade (sizes of the body around the point looked at).
const FLOOR_FADE: [f64; 2] = [0.8, 2.7];
/// Distance of the camera above which the floor is drawn wider (sizes of the body).
const USUAL_DISTANCE: f64 = 12.0;
/// Over this height above the panel's lower side the floor fades (px at type of the reference size): captions stand
/// on clean ground.
const FADE_ABOVE: f64 = 94.0;
/// Bodies of more elements than this along a side have softer light, as if their elements were larger.
const SOFT_SHARE: f64 = 4.5;
/// The grid's lines are a side apart, or more if that were more cells than this beside a body.
const MOST_CELLS: f64 = 10.0;
/// How dark the shadow of a body without surfaces is, in parts of that of one with surfaces.
const SHEER: f64 = 0.38;
/// Coordinates of what blew up are kept within this (sides).
const FARTHEST: f64 = 1e12;
/// Bodies as wide as their panel and higher than this part of it are kept off the words.
const FILLED: f64 = 0.7;
/// Room for thick lines around a body (px in the reference picture).
const LINE_ROOM: f64 = 3.0;

/// Composes frames of one scene.
#[derive(Debug)]
pub struct Composer<'a> {
    scene: &'a Scene,
    palette: Palette,
    tally: Tally,
    /// The second line of each run.
    descriptions: Vec<String>,
    /// The signed area of each polygon of a body in the plane.
    rest_areas: Vec<f64>,
    skin: Skin,
    ears: Ears,
    /// Elements without faces.
    bare: Vec<usize>,
    /// The colours of a field, if one is shown.
    ramp: Vec<Colour>,
    /// The edges of the elements, if surfaces are not shown.
    edges: Edges,
    /// The nodes that get arrows.
    bearers: Vec<u32>,
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
        let middles = Middles::new(frame.runs.iter().filter_map(|run| middle(&run.snapshot)), self.start);
        let level = contact::ground(&self.scene.obstacles, frame.time).is_some_and(|(normal, _)| normal.y > LEVEL);
        let framing = framing(&view.camera, &middles, !level);
        let scale = panels.first().map_or(Scale { unit: 1.0 }, |&panel| Scale::new(size, panel));
        let mut writer = Writer { palette: &self.palette, scale, marks: Vec::new(), words: Vec::new() };
        writer.hairlines(&panels);
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
            .map(|(&viewport, run)| self.panel(viewport, run, &framing, scale, [&mut under, &mut marks]))
            .collect();
        Picture { size, palette: self.palette, ramp: self.ramp.clone(), panels, under, marks, words }
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

    fn panel(
        &self,
        viewport: Rectangle,
        run: &RunFrame,
        framing: &Framing,
        scale: Scale,
        [under, above]: [&mut Vec<Mark>; 2],
    ) -> Panel {
        let view = &self.scene.view;
        let body = &*self.scene.body;
        let (origin, side) = (framing.base, view.side);
        let edges = viewport.map(f64::from);
        let lens = Lens::new(view, framing, body.dimension, edges, scale.unit);
        let key = key_light(&lens, framing);
        // A body of which no node is known is drawn as nothing.
        let position = if run.snapshot.position.len() == body.len() { &run.snapshot.position[..] } else { &[] };
        let position: Vec<_> = position.iter().map(|&at| finite(at, FARTHEST * side)).collect();
        let mut lines = Vec::new();
        let [mut sound, mut turned_over] = [Mesh::default(), Mesh::default()];
        let shades = view.colour.as_ref().map(|scale| Shades::new(body, scale, &run.snapshot.field));
        if !position.is_empty() && view.visible.surfaces {
            let surroundings = Surroundings {
                body,
                ears: &self.ears,
                position: &position,
                lens: &lens,
                origin,
                side,
                soft: self.soft * side,
                shades: shades.as_ref(),
            };
            let over = &run.snapshot.turned_over;
            let kinds = Lines { edge: LineKind::Edge, contour: LineKind::Contour };
            surroundings.add(&boundary(body, over, false), kinds, &mut sound, &mut lines);
            let kinds = Lines { edge: LineKind::AlarmEdge, contour: LineKind::AlarmContour };
            surroundings.add(&boundary(body, over, true), kinds, &mut turned_over, &mut lines);
            if shades.is_none() {
                self.add_bare(&position, over, origin, &mut lines);
            }
        }
        let flat = body.dimension == Dimension::Plane;
        let element = lens.focal * side / if flat { 1.0 } else { framing.distance };
        let diverged = matches!(run.snapshot.status, Status::Diverged(_));
        let of_nodes = match &shades {
            Some(shades) if !view.visible.surfaces || !self.bare.is_empty() => shades.of_nodes(body),
            _ => Vec::new(),
        };
        let wire = Wire {
            body,
            position: &position,
            origin,
            side,
            forward: lens.forward,
            palette: &self.palette,
            line: scale.line(),
            element,
            surfaces: view.visible.surfaces,
            shades: (!of_nodes.is_empty()).then_some((&self.ramp[..], &of_nodes[..])),
        };
        let strokes = self.strokes(run, &wire);
        let (mut beads, mut room) = (Vec::new(), LINE_ROOM * scale.line() + 2.0);
        if view.visible.nodes && !flat && !diverged {
            let radius = node_radius(scale, element);
            beads = wire.without_surfaces().beads(radius);
            room = room.max(radius + 2.0);
        }
        if flat {
            let flat = Flat {
                body,
                ears: &self.ears,
                position: &position,
                turned_over: &run.snapshot.turned_over,
                lens: &lens,
                viewport,
                scale,
                palette: &self.palette,
            };
            flat.floors(&self.scene.obstacles, run.snapshot.time, under);
            if !diverged {
                if view.visible.surfaces {
                    flat.signs(above);
                }
                if view.visible.nodes {
                    let colour = |node: usize| {
                        let place = of_nodes.get(node).copied().filter(|&place| place != NOWHERE);
                        place.filter(|_| !view.visible.surfaces).map(|place| ramp::colour(&self.ramp, place))
                    };
                    flat.nodes(element, &colour, above);
                }
            }
        }
        let pointers = Pointers { lens: &lens, viewport, scale, palette: &self.palette };
        let time = run.snapshot.time;
        let site = Site {
            obstacles: &self.scene.obstacles,
            time,
            frame: 1.0 / self.scene.frames_per_second,
            lens: &lens,
            origin,
            side,
            extent: self.extent,
            palette: &self.palette,
        };
        let (obstacles, staged) = if flat {
            let flat = obstacle::Flat { site, line_scale: scale.line() };
            flat.arrows(&pointers, above);
            flat.draw()
        } else {
            let staging = Staging {
                site,
                widening: self.widening(framing),
                cell: cell(self.extent / side),
                ground: contact::ground(&self.scene.obstacles, time),
                position: &position,
                start: self.start_box,
            };
            staging.arrows(&pointers, above);
            staging.pierced(&[&sound, &turned_over], &mut lines);
            staging.draw(&mut lines)
        };
        if !diverged {
            let hands = Hands {
                grips: &self.scene.grips,
                time,
                frame: 1.0 / self.scene.frames_per_second,
                position: &position,
                skin: &self.skin,
                element,
                viewport,
                scale,
                palette: &self.palette,
                pointers: &pointers,
            };
            hands.draw(above);
        }
        if view.visible.displacements && !diverged && !position.is_empty() {
            let has_springs = self.scene.runs.get(run.run).is_some_and(|run| !run.model.springs().is_empty());
            let arrows = Arrows {
                lens: &lens,
                room: layout::clear_of_words(viewport, scale),
                size: arrows::size(element, scale.unit),
                node: if view.visible.nodes { node_radius(scale, element) } else { 0.0 },
                times: view.arrow_scale,
                colour: self.palette.arrows[usize::from(has_springs)],
                halo: self.palette.background,
            };
            arrows.draw(&self.facing_bearers(&position, &lens), &body.rest, &position, &run.snapshot.placement, above);
        }
        let touched = position.iter().chain(&staged.outermost);
        let mut region = region(viewport, touched, &lens, room);
        let fills_panel = region[2] == viewport[2] && f64::from(region[3]) > FILLED * f64::from(viewport[3]);
        if diverged || fills_panel {
            // What blows up may lie across everything; the words that say so stay on clean ground.
            region = overlap(region, layout::clear_of_words(viewport, scale));
        }
        Panel {
            viewport,
            region,
            sight: Sight {
                clip: lens.clip(origin, side, edges),
                eye: narrow_point((lens.eye - origin) / side),
                near: narrow(lens.near_in(side)),
                focal: narrow(if flat { lens.focal * side } else { lens.focal }),
                key: narrow_point(key),
                flat,
                line_scale: narrow(scale.line()),
                soft: narrow(self.soft),
                element: narrow(element),
            },
            floor: if flat { None } else { self.floor(&position, &staged, time, framing, key, scale) },
            sound,
            turned_over,
            lines,
            obstacles,
            strokes,
            beads,
        }
    }

    /// Lines with colours of their own: springs, or the edges of elements where there would be nothing else to see, and
    /// what a field colours of elements without faces.
    fn strokes(&self, run: &RunFrame, wire: &Wire<'_>) -> Vec<Stroke> {
        let visible = self.scene.view.visible;
        let over = &run.snapshot.turned_over;
        let mut strokes = Vec::new();
        if wire.position.is_empty() {
            return strokes;
        }
        if visible.surfaces && wire.shades.is_some() {
            strokes.extend(wire.bare(&self.bare, over));
        }
        let springs = match self.scene.runs.get(run.run) {
            Some(run) if visible.springs => run.model.springs(),
            _ => &[],
        };
        if !visible.surfaces && springs.is_empty() {
            strokes.extend(wire.edges(&self.edges, over, false));
        }
        if !springs.is_empty() {
            strokes.extend(wire.without_surfaces().springs(springs));
            if !visible.surfaces {
                // Which elements have turned over is told in any case.
                strokes.extend(wire.edges(&self.edges, over, true));
            }
        }
        strokes
    }

    /// The nodes that get arrows, without those of which surfaces in space hide every face.
    fn facing_bearers(&self, position: &[DVec3], lens: &Lens) -> Vec<u32> {
        if !self.scene.view.visible.surfaces {
            return self.bearers.clone();
        }
        let visible = self.skin.visible(position, lens);
        let mut hidden = vec![false; position.len()];
        self.skin.nodes.iter().for_each(|&node| hidden[node as usize] = !visible[node as usize]);
        self.bearers.iter().copied().filter(|&node| !hidden[node as usize]).collect()
    }

    /// Elements without faces can be seen, too: by their edges, and those that have none by lines from their middle.
    fn add_bare(&self, position: &[DVec3], over: &[bool], origin: DVec3, lines: &mut Vec<Line>) {
        let body = &*self.scene.body;
        let relative = |point: DVec3| narrow_point((point - origin) / self.scene.view.side).to_array();
        for &element in &self.bare {
            let nodes = &body.elements[element];
            let over = over.get(element).copied().unwrap_or(false);
            let kind = if over { LineKind::AlarmEdge } else { LineKind::Edge };
            let mut line = |from, to| lines.push(Line { from: relative(from), to: relative(to), kind });
            let at = |node: u32| position[node as usize];
            let edges = body.topology().edges_of(element);
            for &[a, b] in &edges {
                line(at(a), at(b));
            }
            if edges.is_empty() {
                let middle = nodes.iter().map(|&node| at(node)).sum::<DVec3>() / nodes.len() as f64;
                nodes.iter().for_each(|&node| line(middle, at(node)));
            }
        }
    }

    /// How many times wider than usual the floor is drawn: what lies farther away fades at about the same place in the
    /// panel.
    fn widening(&self, framing: &Framing) -> f64 {
        let usual = self.scene.view.camera.distance.min(USUAL_DISTANCE * self.extent);
        (framing.distance / usual).sqrt()
    }

    fn floor(
        &self,
        position: &[DVec3],
        staged: &Staged,
        time: f64,
        framing: &Framing,
        key: DVec3,
        scale: Scale,
    ) -> Option<Floor> {
        let view = &self.scene.view;
        let (origin, side) = (framing.base, view.side);
        let (normal, height) = contact::ground(&self.scene.obstacles, time)?;
        let mut plane = Plane::new(normal, (height - normal.dot(origin)) / side);
        // The grid's lines go through the origin of the world, or through where a moving floor has brought it.
        let mut anchor = DVec3::ZERO;
        let moving = |one: &&Obstacle| one.motion != Motion::Still && one.floor(time) == Some((normal, height));
        if let Some(moving) = self.scene.obstacles.iter().find(moving)
            && let Shape::Floor { normal, .. } = moving.shape
        {
            let pose = moving.pose(time);
            plane.axes = Plane::new(normal, 0.0).axes.map(|axis| pose.turn * axis);
            anchor = pose.apply(moving.shape.pivot(), DVec3::ZERO);
        }
        let fade = FLOOR_FADE.map(|sizes| sizes * self.extent / side * self.widening(framing));
        let on_skin = self.skin.nodes.iter().filter_map(|&node| position.get(node as usize));
        let mut points: Vec<_> = on_skin.map(|&at| (at - origin) / side).collect();
        let mut triangles = Cow::Borrowed(if points.is_empty() { &[][..] } else { &self.skin.triangles });
        if !staged.shadow_triangles.is_empty() {
            let base = points.len() as u32;
            points.extend(staged.shadow_points.iter().map(|&at| (at - origin) / side));
            triangles.to_mut().extend(staged.shadow_triangles.iter().map(|triangle| triangle.map(|at| base + at)));
        }
        // Around the point looked at, which is the origin, projected onto the floor.
        let middle = DVec2::ZERO;
        let mut shades = if key.dot(plane.normal) > 0.05 {
            shadow::shades(&points, &triangles, &plane, key, middle, fade[1], self.soft)
        } else {
            std::array::from_fn(|_| shadow::Shade { corner: [0.0; 2], length: 1.0, cells: Vec::new() })
        };
        if !view.visible.surfaces {
            // What one sees through lets most of the light through.
            let cells = shades.iter_mut().flat_map(|shade| &mut shade.cells);
            cells.for_each(|cell| *cell = (f64::from(*cell) * SHEER).round() as u8);
        }
        let cell = cell(self.extent / side);
        let grid = plane.axes.map(|axis| narrow(((origin - anchor) / side).dot(axis).rem_euclid(cell)));
        Some(Floor {
            normal: narrow_point(plane.normal),
            axes: plane.axes.map(narrow_point),
            height: narrow(plane.height),
            middle: [narrow(middle.x), narrow(middle.y)],
            cell: narrow(cell),
            grid,
            fade: fade.map(narrow),
            fade_above: narrow(FADE_ABOVE * scale.unit),
            shades,
        })
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

/// The distance of the grid's lines (sides) beside a body of an extent (sides): 1, 2, 5, 10, 20, …
fn cell(extent: f64) -> f64 {
    let mut cells = 1.0;
    for factor in [2.0, 2.5, 2.0].into_iter().cycle().take(36) {
        if extent / cells <= MOST_CELLS {
            break;
        }
        cells *= factor;
    }
    cells
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

fn mean(points: &[DVec3]) -> Option<DVec3> {
    (!points.is_empty()).then(|| points.iter().sum::<DVec3>() / points.len() as f64)
}

/// Unit vector towards the key light.
fn key_light(lens: &Lens, framing: &Framing) -> DVec3 {
    let towards_viewer = lens.right.cross(DVec3::Y);
    let (left, towards) = libm::sincos(KEY_AZIMUTH);
    let level = towards * towards_viewer - left * lens.right;
    let slope = KEY_SLOPE + KEY_STEEPENING * framing.rise / framing.distance;
    (level + slope * DVec3::Y).normalize()
}

/// Coordinates beyond all bounds are brought to where arithmetic still works.
fn finite(point: DVec3, farthest: f64) -> DVec3 {
    let one = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-farthest, farthest) };
    DVec3::new(one(point.x), one(point.y), one(point.z))
}

/// What two rectangles share.
fn overlap([x, y, width, height]: Rectangle, [x2, y2, width2, height2]: Rectangle) -> Rectangle {
    let [left, top] = [x.max(x2), y.max(y2)];
    let right = (x + width).min(x2 + width2).max(left);
    let bottom = (y + height).min(y2 + height2).max(top);
    [left, top, right - left, bottom - top]
}

/// The part of a panel that points and what lies between them may touch, with `room` (px) around it.
fn region<'p>(viewport: Rectangle, points: impl Iterator<Item = &'p DVec3>, lens: &Lens, room: f64) -> Rectangle {
    let [left, top, width, height] = viewport;
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    for &point in points {
        match lens.project(point) {
            Some((pixel, _)) => {
                low = low.min(DVec2::from(pixel));
                high = high.max(DVec2::from(pixel));
            }
            // What reaches behind the viewer may appear anywhere.
            None => return viewport,
        }
    }
    let within = |at: f64, start: u32, length: u32| at.clamp(f64::from(start), f64::from(start + length)) as u32;
    if low.x > high.x {
        return [left, top, 0, 0];
    }
    let [x, y] = [within((low.x - room).floor(), left, width), within((low.y - room).floor(), top, height)];
    let [x2, y2] = [within((high.x + room).ceil(), left, width), within((high.y + room).ceil(), top, height)];
    [x, y, x2 - x, y2 - y]
}
