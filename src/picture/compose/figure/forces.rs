//! Diagrams of forces: what each model does to the nodes at the start of a scene.

use super::NoRoom;
use super::header;
use super::labels::Labels;
use crate::colour::{Colour, mixed};
use crate::moments::{self, Moments};
use crate::picture::arrows::{HEAD, arrow};
use crate::picture::camera::{Framing, Lens};
use crate::picture::caption::Writer;
use crate::picture::chart::filled;
use crate::picture::compose::Composer;
use crate::picture::compose::panel::Draft;
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::number::round_below;
use crate::picture::plane::is_inside;
use crate::picture::text::{Fonts, Weight};
use crate::picture::{Curve, Mark, MarkShape, Mesh, Panel, Picture, Second, Solid, Stroke, Vertex};
use crate::scene::Scene;
use crate::scene::figure::{Figure, Forces};
use crate::sim::snapshot::{Placement, RunFrame, Snapshot};
use glam::{DVec2, DVec3};

/// Room inside a cell for labels at each side, and above and below what is drawn (px in the reference picture).
const LABEL_ROOM: f64 = 88.0;
const BARE_ROOM: f64 = 84.0;
const ROW_ROOM: [f64; 2] = [44.0, 22.0];
/// Heights of the heads of columns and of the key at the bottom (px in the reference picture).
const HEADS: f64 = 106.0;
const KEY: f64 = 74.0;
/// Baselines of a column's name, the part of that which its type takes, and baselines of its note and of a row's name
/// below its top (px in the reference picture).
const NAME: f64 = 60.0;
const NAME_TYPE: f64 = 20.0;
const NOTE: f64 = 86.0;
const ROW_NAME: f64 = 20.0;
/// Free below the figure's title and caption, below which heads stand so much higher (px in the reference picture).
const BELOW_HEADER: f64 = 16.0;
const UNDER_TITLE: f64 = 20.0;
/// Type of numbers at arrows, and the distance of two lines of it (px in the reference picture).
const NUMBERS: f64 = 14.0;
const LINE: f64 = 18.0;
/// Opacity of the ghost of the rest shape, and of arrows that are there to be compared: their inside and their outline.
const GHOST: f64 = 0.075;
const COMPARED: f64 = 0.16;
const OUTLINE_ALPHA: f64 = 0.75;
/// Widths of the ghost's outline, of an arrow's outline, and of the vectors (px in the reference picture).
const GHOST_LINE: f64 = 1.3;
const OUTLINE: f64 = 1.1;
const VECTOR: f64 = 1.5;
/// Dashes of the ghost and gaps between them (px in the reference picture).
const DASH: [f64; 2] = [5.0, 4.0];
/// Radius of a node and of the centre (px in the reference picture).
const NODE: f64 = 5.2;
const CENTRE: f64 = 3.4;
/// The key's arrow is about as long as this (px in the reference picture).
const KEY_ARROW: f64 = 60.0;
/// Half of an arrow's width, for labels (px in the reference picture).
const ARROW: f64 = 5.0;
/// Arrows shorter than this are not drawn (px in the reference picture).
const SHORTEST: f64 = 3.0;
/// Opacity of what a body hides.
const HIDDEN: f64 = 0.3;

/// What one cell shows.
struct Cell<'a> {
    composer: &'a Composer<'a>,
    scene: &'a Scene,
    frame: RunFrame,
    /// The displacement that each node's force would undo, over its stiffness (m): where its arrow points.
    ways: Vec<DVec3>,
    /// The same for the run that all are compared with.
    compared: Option<(usize, Vec<DVec3>)>,
    /// The nodes of the ghost (m).
    ghost: Vec<DVec3>,
    /// The camera of the scene, turned to the middle of the body.
    framing: Framing,
    /// Left, top, width and height (px).
    room: [f64; 4],
}

/// Composes a diagram.
pub(super) fn compose(figure: &Figure, forces: &Forces, moments: &Moments) -> Result<Picture, NoRoom> {
    let scenes: Vec<Scene> = forces.scenes.iter().map(|scene| bare(scene, figure)).collect();
    let composers: Vec<_> = scenes.iter().map(Composer::new).collect();
    let fonts = Fonts::new(&figure.look.font);
    let palette = figure.look.palette;
    let runs = scenes[0].runs.len();
    // Scenes of one run stand beside each other.
    let (columns, rows) = if runs > 1 { (runs, scenes.len()) } else { (scenes.len(), 1) };
    let [width, height] = figure.size.map(f64::from);
    let scale = Scale::new(figure.size, [0, 0, figure.size[0] / columns as u32, figure.size[1]]).with(&scenes[0].view);
    let (marks, curves, words) = Default::default();
    let mut writer = Writer { palette: &palette, fonts: &fonts, scale, marks, curves, words };
    let unit = scale.unit;
    let last = header::write(&mut writer, figure, &[]);
    let top = if last > 0.0 { last + BELOW_HEADER * unit } else { 0.0 };
    // Below a title, names need no margin above them.
    let raised = if top > 0.0 { UNDER_TITLE * unit } else { 0.0 };
    let has_notes = runs > 1 && forces.notes.iter().any(|note| !note.is_empty());
    let heads = scale.of_type(if has_notes { HEADS } else { HEADS - (NOTE - NAME) }) * unit - raised;
    let cells_top = top + heads;
    // The key's line grows upward, out of the margin.
    let cells_bottom = height - KEY * unit - (scale.caption() - Scale::at(unit).caption());
    let mut cells: Vec<Cell<'_>> = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (scene, run) = if runs > 1 { (row, column) } else { (column, 0) };
            let left = width * column as f64 / columns as f64;
            let room = [left, cells_top, width / columns as f64, cells_bottom - cells_top];
            let compare = forces.compare.filter(|&compare| compare != run);
            cells.push(Cell::new(&composers[scene], &moments.forces[scene], run, compare, room));
        }
    }
    let side_room = if forces.numbers { scale.of_type(LABEL_ROOM) } else { BARE_ROOM } * unit;
    let boxes = fit(&mut cells, columns, side_room, scale, runs > 1 && rows > 1);
    let (pixels, centres) = boxes.ok_or(NoRoom)?;

    let (mut panels, mut under, mut above) = (Vec::new(), Vec::new(), Vec::new());
    for (cell, &centre) in cells.iter().zip(&centres) {
        let view = Drawn::new(cell, pixels, centre, scale, figure);
        panels.push(view.panel(&mut under));
        view.draw(forces, &mut writer, &mut above);
    }
    for column in 0..columns {
        let left = width * column as f64 / columns as f64 + scale.margin();
        let room = width / columns as f64 - 2.0 * scale.margin();
        let run = &scenes[0].runs[if runs > 1 { column } else { 0 }];
        let (name, note) = if runs > 1 {
            (run.name.as_str(), forces.notes[column].as_str())
        } else {
            (scenes[column].title.as_str(), "")
        };
        let baseline = top + (NAME - NAME_TYPE + scale.of_type(NAME_TYPE)) * unit - raised;
        let name = fonts.shortened(name, Weight::SemiBold, scale.title(), room);
        writer.left(&name, Weight::SemiBold, scale.title(), palette.text, left, baseline);
        let note = fonts.shortened(note, Weight::Regular, scale.caption(), room);
        let below = baseline + scale.of_type(NOTE - NAME) * unit;
        writer.left(&note, Weight::Regular, scale.caption(), palette.second_text, left, below);
        if column > 0 {
            let x = (width * column as f64 / columns as f64).round();
            let thickness = unit.round().max(1.0);
            let from = top + scale.margin() - raised;
            let line = [x, from, thickness, cells_bottom - from];
            under.push(filled(line, palette.hairline));
        }
    }
    if runs > 1 && rows > 1 {
        for (at, cell) in cells.iter().enumerate() {
            let [left, top, width, _] = cell.room;
            let room = width - 2.0 * scale.margin();
            let name = fonts.shortened(&scenes[at / columns].title, Weight::SemiBold, scale.caption(), room);
            let baseline = top + scale.of_type(ROW_NAME) * unit;
            writer.left(&name, Weight::SemiBold, scale.caption(), palette.text, left + scale.margin(), baseline);
        }
    }
    Key { figure, forces, scene: &scenes[0], pixels, columns, scale }.draw(&mut writer, &mut above);
    let Writer { marks, curves, words, .. } = writer;
    above.extend(marks);
    Ok(Picture { size: figure.size, palette, fonts, ramp: Vec::new(), panels, under, marks: above, curves, words })
}

/// A scene as a diagram shows it: in the figure's colours, without what a film needs.
fn bare(scene: &Scene, figure: &Figure) -> Scene {
    let mut scene = scene.clone();
    let view = &mut scene.view;
    view.look = figure.look.clone();
    (view.colour, view.strip, view.spring_strain, view.explode) = (None, None, None, 0.0);
    view.visible.displacements = false;
    scene
}

/// The largest scale at which all cells fit (px/m), and the pixel of the middle of each cell's body. The cells of a
/// column, and those of a row, have their bodies below and beside each other; rows share the height as they need.
fn fit(
    cells: &mut [Cell<'_>],
    columns: usize,
    side_room: f64,
    scale: Scale,
    has_names: bool,
) -> Option<(f64, Vec<DVec2>)> {
    let rows = cells.len() / columns;
    let extents: Vec<_> = cells.iter().map(Cell::extent).collect();
    let join = |one: [DVec2; 2], other: [DVec2; 2]| [one[0].min(other[0]), one[1].max(other[1])];
    let of_row = |row: usize| extents[row * columns..][..columns].iter().copied().reduce(join);
    let of_rows: Vec<[DVec2; 2]> = (0..rows).map(of_row).collect::<Option<_>>()?;
    let whole = of_rows.iter().copied().reduce(join)?;
    let [_, top, width, height] = cells.first()?.room;
    let unit = scale.unit;
    let [above, below] = [ROW_ROOM[usize::from(!has_names)], ROW_ROOM[1]].map(|length| scale.of_type(length) * unit);
    let needed: f64 = of_rows.iter().map(|[low, high]| high.y - low.y).sum();
    let across = (width - 2.0 * side_room) / (whole[1].x - whole[0].x).max(1e-9);
    let down = (height - rows as f64 * (above + below)) / needed.max(1e-9);
    let pixels = across.min(down);
    if !(pixels > 0.0 && pixels.is_finite()) {
        return None;
    }
    // What is left over goes between the rows.
    let spare = ((height - rows as f64 * (above + below) - needed * pixels) / rows as f64).max(0.0);
    let mut at = top;
    let mut centres = Vec::new();
    for (row, [low, high]) in of_rows.iter().enumerate() {
        let taken = above + below + spare + (high.y - low.y) * pixels;
        for cell in &mut cells[row * columns..][..columns] {
            cell.room[1] = at;
            cell.room[3] = taken;
            let middle = cell.room[0] + 0.5 * width;
            let x = middle - 0.5 * (whole[0].x + whole[1].x) * pixels;
            let y = at + above + 0.5 * spare + high.y * pixels;
            centres.push(DVec2::new(x, y).round());
        }
        at += taken;
    }
    Some((pixels, centres))
}

impl<'a> Cell<'a> {
    fn new(
        composer: &'a Composer<'a>,
        runs: &[moments::Forces],
        run: usize,
        compare: Option<usize>,
        room: [f64; 4],
    ) -> Self {
        let scene = composer.scene;
        let snapshot = runs[run].snapshot.clone();
        let ways = |run: usize| {
            let stiffness = scene.runs[run].model.stiffness();
            runs[run].on_nodes.iter().map(|&force| force / stiffness).collect::<Vec<_>>()
        };
        Self {
            composer,
            scene,
            ways: ways(run),
            compared: compare.map(|run| (run, ways(run))),
            ghost: scene.body.rest.iter().map(|&at| snapshot.placement.place(at)).collect(),
            framing: {
                let middle = snapshot.placement.centre;
                Framing { target: middle, base: middle, ..Framing::still(&scene.view.camera) }
            },
            frame: RunFrame { run, snapshot },
            room,
        }
    }

    fn snapshot(&self) -> &Snapshot {
        &self.frame.snapshot
    }

    /// The middle of the nodes (m).
    fn middle(&self) -> DVec3 {
        let Placement { centre, .. } = self.snapshot().placement;
        centre
    }

    /// The axes of the picture to the right and up.
    fn axes(&self) -> [DVec3; 2] {
        let camera = Framing::still(&self.scene.view.camera);
        let lens = Lens::new(&self.scene.view, &camera, self.scene.body.dimension, [0.0, 0.0, 64.0, 64.0], 1.0);
        [lens.right, lens.up]
    }

    /// The box around all that is drawn, seen from far away: to the right and up from the middle of the body (m).
    fn extent(&self) -> [DVec2; 2] {
        let axes = self.axes();
        let position = &self.snapshot().position;
        let tips = |ways: &[DVec3]| position.iter().zip(ways).map(|(&at, &way)| at + way).collect::<Vec<_>>();
        let compared = self.compared.as_ref().map(|(_, ways)| tips(ways)).unwrap_or_default();
        let all = position.iter().chain(&self.ghost).copied().chain(tips(&self.ways)).chain(compared);
        let seen = all.map(|at| DVec2::from(axes.map(|axis| (at - self.middle()).dot(axis))));
        seen.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }
}

/// A cell with its camera.
struct Drawn<'a> {
    cell: &'a Cell<'a>,
    draft: Draft<'a>,
    pixels: f64,
    centre: DVec2,
    scale: Scale,
    figure: &'a Figure,
}

impl<'a> Drawn<'a> {
    fn new(cell: &'a Cell<'a>, pixels: f64, centre: DVec2, scale: Scale, figure: &'a Figure) -> Self {
        Self { cell, draft: draft(cell, scale, pixels, centre), pixels, centre, scale, figure }
    }

    fn pixel(&self, at: DVec3) -> DVec2 {
        self.draft.lens.project(at).map_or(DVec2::ZERO, |(pixel, _)| DVec2::from(pixel))
    }

    /// The body with the ghost of its rest shape behind it.
    fn panel(&self, under: &mut Vec<Mark>) -> Panel {
        let drawn = draft(self.cell, self.scale, self.pixels, self.centre);
        // Signs, nodes and arrows of the film have no place here.
        let mut panel = drawn.panel(under, &mut Vec::new());
        panel.floor = None;
        panel.beads.clear();
        if self.draft.flat {
            panel.obstacles.solids.insert(0, self.ghost_in_plane());
        } else {
            panel.strokes.extend(self.ghost_in_space());
        }
        panel.region = panel.viewport;
        panel
    }

    fn ghost_colour(&self) -> Colour {
        let palette = &self.figure.look.palette;
        mixed(palette.background, palette.edge_on_ground(), GHOST)
    }

    fn ghost_in_plane(&self) -> Solid {
        let skin = &self.cell.composer.skin;
        let relative = |at: DVec3| narrow_point((at - self.draft.origin) / self.draft.side).to_array();
        let vertex = |&node: &u32| Vertex {
            position: relative(self.cell.ghost[node as usize]),
            normal: [0.0, 0.0, 1.0],
            hatch: 0.0,
        };
        let mesh = Mesh {
            vertices: skin.nodes.iter().map(vertex).collect(),
            triangles: skin.triangles.clone(),
            shades: Vec::new(),
        };
        Solid { mesh, colour: self.ghost_colour(), rim: None, near: Vec::new() }
    }

    /// The edges of all elements, each once.
    fn edges(&self) -> Vec<[u32; 2]> {
        let body = &self.cell.scene.body;
        let mut edges: Vec<[u32; 2]> = (0..body.elements.len())
            .flat_map(|element| body.topology().edges_of(element))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The shares of an edge's length at which dashes begin and end.
    fn dashes(&self, ends: [DVec2; 2]) -> Vec<[f64; 2]> {
        let [dash, gap] = DASH.map(|length| length * self.scale.unit.max(0.5));
        let length = ends[0].distance(ends[1]);
        // A dash at both ends.
        let count = ((length - dash) / (dash + gap)).round().max(1.0);
        let period = (length - dash) / count;
        (0..=count as usize).map(|at| [at as f64 * period, at as f64 * period + dash].map(|at| at / length)).collect()
    }

    fn ghost_in_space(&self) -> Vec<Stroke> {
        let palette = &self.figure.look.palette;
        let relative = |at: DVec3| narrow_point((at - self.draft.origin) / self.draft.side).to_array();
        let edges = self.edges().into_iter().map(|edge| edge.map(|node| self.cell.ghost[node as usize]));
        let strokes = edges.flat_map(|[from, to]| {
            let dashes = self.dashes([from, to].map(|at| self.pixel(at)));
            dashes.into_iter().map(move |dash| dash.map(|share| relative(from.lerp(to, share))))
        });
        let stroke = |ends| Stroke {
            ends,
            colours: [palette.second_text; 2],
            second: Second::None,
            behind: (255.0 * HIDDEN) as u8,
            width: narrow(GHOST_LINE * self.scale.line()),
        };
        strokes.map(stroke).collect()
    }

    /// The dashed outline of the ghost in the plane: as far as the body does not cover it, or all of it.
    fn ghost_outline(&self, marks: &mut Vec<Mark>, also_inside: bool) {
        let body = &self.cell.scene.body;
        let pixels: Vec<_> = self.cell.snapshot().position.iter().map(|&at| self.pixel(at)).collect();
        let polygons: Vec<Vec<DVec2>> =
            body.elements.iter().map(|nodes| nodes.iter().map(|&node| pixels[node as usize]).collect()).collect();
        for edge in self.edges() {
            let [from, to] = edge.map(|node| self.pixel(self.cell.ghost[node as usize]));
            for dash in self.dashes([from, to]) {
                let ends = dash.map(|share| from.lerp(to, share));
                let middle = ends[0].midpoint(ends[1]);
                if also_inside || !polygons.iter().any(|polygon| is_inside(polygon, middle)) {
                    let palette = &self.figure.look.palette;
                    let colour = if also_inside { palette.second_text } else { palette.axis };
                    marks.push(line(ends, GHOST_LINE * self.scale.line(), colour));
                }
            }
        }
    }

    /// Everything above the body.
    fn draw(&self, forces: &Forces, writer: &mut Writer<'_>, above: &mut Vec<Mark>) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette;
        let unit = scale.unit;
        let position = &cell.snapshot().position;
        // In the plane all nodes are seen; in space those of no face are, too.
        let visible = cell.composer.skin.visible(position, &self.draft.lens);
        let on_skin = |node: usize| cell.composer.skin.holds(node as u32);
        let seen: Vec<_> = (0..position.len()).map(|at| if on_skin(at) { visible[at] } else { 1.0 }).collect();
        let [left, top, width, height] = cell.room;
        let inset = 6.0 * unit;
        let room = [left + inset, top + inset, left + width - inset, top + height - inset];
        let mut labels = Labels::new(room, unit);
        for [a, b] in self.edges() {
            labels.lines.push([a, b].map(|node| self.pixel(position[node as usize])));
            labels.lines.push([a, b].map(|node| self.pixel(cell.ghost[node as usize])));
        }
        let faces = cell.scene.body.faces.nodes.iter();
        labels.surfaces =
            faces.map(|nodes| nodes.iter().map(|&node| self.pixel(position[node as usize])).collect()).collect();
        if self.draft.flat {
            self.ghost_outline(above, forces.vectors);
        }
        let own = cell.scene.runs[cell.frame.run].line(palette).colour;
        let ends = |ways: &[DVec3]| -> Vec<[DVec2; 2]> {
            position.iter().zip(ways).map(|(&at, &way)| [self.pixel(at), self.pixel(at + way)]).collect()
        };
        let arrows = ends(&cell.ways);
        labels.lines.extend(arrows.iter().flat_map(|ends| wide(*ends, ARROW * unit)));
        let shown = |[from, to]: &[DVec2; 2]| from.distance(*to) >= SHORTEST * unit;
        if let Some((run, compared)) = &cell.compared {
            let arrows = ends(compared);
            labels.lines.extend(arrows.iter().flat_map(|ends| wide(*ends, ARROW * unit)));
            let colour = cell.scene.runs[*run].line(palette).colour;
            for ends in arrows.iter().filter(|ends| shown(ends)) {
                above.extend(outlined(*ends, *scale, colour, palette.background));
            }
        }
        if forces.vectors {
            self.vectors(writer, &mut labels, &seen);
        }
        let mut order: Vec<usize> = (0..arrows.len()).filter(|&at| shown(&arrows[at])).collect();
        order.sort_by(|&a, &b| seen[a].total_cmp(&seen[b]));
        for &at in &order {
            let whole = arrow(arrows[at], scale.line(), own, palette.halo);
            above.extend(whole.faded(HIDDEN + (1.0 - HIDDEN) * seen[at]));
        }
        for (&at, &seen) in position.iter().zip(&seen) {
            if seen > 0.0 {
                let disc = Mark::around(self.pixel(at), NODE * scale.line(), MarkShape::Node, palette.node);
                above.push(Mark { second: palette.edge, ..disc });
            }
        }
        if forces.numbers {
            for &at in &order {
                self.number(at, arrows[at], writer, &mut labels, palette.text_like(own));
            }
        }
    }

    /// The size of a force at its arrow, and the angle to the one that it is compared with.
    fn number(&self, at: usize, [from, to]: [DVec2; 2], writer: &mut Writer<'_>, labels: &mut Labels, colour: Colour) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette;
        let size = NUMBERS * scale.type_unit();
        let way = cell.ways[at];
        let number = format!("{:.3}", way.length() / cell.scene.view.side);
        let angle = cell.compared.as_ref().map(|(_, compared)| way.angle_between(compared[at]).to_degrees());
        let angle = angle.filter(|angle| angle.is_finite() && *angle >= 0.5);
        let second = angle.map_or(String::new(), |angle| format!("{angle:.0}° off"));
        let wide = |text: &str| writer.fonts.width(text, Weight::Regular, size);
        let line = scale.of_type(LINE * scale.unit);
        let lines = if second.is_empty() { 1.0 } else { 2.0 };
        let extent = DVec2::new(wide(&number).max(wide(&second)), size * 0.8 + (lines - 1.0) * line);
        let corner = labels.place_at_arrow([from, to], extent);
        // Towards the arrow, lines end or begin alike.
        let on_left = corner.x + 0.5 * extent.x < if corner.x < from.x.min(to.x) { from.x } else { to.x };
        for (row, (text, colour)) in [(number, colour), (second, palette.second_text)].into_iter().enumerate() {
            let left = if on_left { corner.x + extent.x - wide(&text) } else { corner.x };
            let baseline = corner.y + size * 0.78 + row as f64 * line;
            over_lines(writer, |writer| writer.left(&text, Weight::Regular, size, colour, left, baseline));
        }
    }

    /// The centre, and the vectors from there to a node and to its place in the equilibrium shape.
    fn vectors(&self, writer: &mut Writer<'_>, labels: &mut Labels, seen: &[f64]) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette;
        let unit = scale.unit;
        let position = &cell.snapshot().position;
        let centre = self.pixel(cell.middle());
        // The node that is displaced most among those that are seen.
        let displaced = |node: &usize| self.pixel(position[*node]).distance(self.pixel(cell.ghost[*node]));
        let visible = (0..position.len()).filter(|&node| seen[node] > 0.5);
        let Some(node) = visible.max_by(|one, other| displaced(one).total_cmp(&displaced(other))) else { return };
        let [now, equilibrium] = [position[node], cell.ghost[node]].map(|at| self.pixel(at));
        let curve = |to: DVec2, dash: &[f64]| Curve {
            points: [centre, to].map(|at| at.to_array().map(narrow)).to_vec(),
            width: narrow(VECTOR * scale.line()),
            dash: dash.iter().map(|length| narrow(length * unit)).collect(),
            colour: palette.text,
            alpha: 0.9,
        };
        writer.curves.push(curve(now, &[]));
        writer.curves.push(curve(equilibrium, &DASH));
        let dot = |at: DVec2, radius: f64, colour: Colour| Curve {
            points: vec![at.to_array().map(narrow)],
            width: narrow(2.0 * radius * unit),
            dash: Vec::new(),
            colour,
            alpha: 1.0,
        };
        writer.curves.push(dot(centre, CENTRE + 1.6, palette.halo));
        writer.curves.push(dot(centre, CENTRE, palette.text));
        labels.lines.extend([[centre, now], [centre, equilibrium]]);
        let across = |to: DVec2, other: DVec2| {
            let way = to - centre;
            let normal = way.perp().normalize_or_zero();
            if normal.dot(other - centre) > 0.0 { -normal } else { normal }
        };
        let texts = [
            (centre, centre - now.midpoint(equilibrium), "c", ""),
            (centre.lerp(now, 0.55), across(now, equilibrium), "r", "i"),
            (centre.lerp(equilibrium, 0.55), across(equilibrium, now), "R", "i"),
        ];
        for (at, away, letter, index) in texts {
            let (size, small) = (scale.caption() * 1.1, scale.caption() * 0.78);
            let [wide, narrow] =
                [(letter, size), (index, small)].map(|(text, size)| writer.fonts.width(text, Weight::SemiBold, size));
            let extent = DVec2::new(wide + narrow, size * 0.95);
            let corner = labels.place(at, away, extent);
            let baseline = corner.y + 0.76 * size;
            over_lines(writer, |writer| {
                writer.left(letter, Weight::SemiBold, size, palette.text, corner.x, baseline);
                writer.left(index, Weight::SemiBold, small, palette.text, corner.x + wide, baseline + 0.2 * size);
            });
        }
    }
}

/// A cell as a panel, seen at a scale (px/m) with the middle of its body at a pixel.
fn draft<'a>(cell: &'a Cell<'a>, scale: Scale, pixels: f64, centre: DVec2) -> Draft<'a> {
    let [left, top, width, height] = cell.room;
    let [right, bottom] = [left + width, top + height].map(|at| at.round() as u32);
    let [left, top] = [left, top].map(|at| at.round() as u32);
    let viewport: Rectangle = [left, top, right - left, bottom - top];
    let mut draft = Draft::new(cell.composer, viewport, &cell.frame, &cell.framing, scale);
    let lens = &mut draft.lens;
    lens.focal = if lens.orthographic { pixels } else { pixels * cell.framing.distance };
    lens.centre = centre.to_array();
    draft.element = pixels * draft.side;
    draft
}

/// The key at the bottom.
struct Key<'a> {
    figure: &'a Figure,
    forces: &'a Forces,
    scene: &'a Scene,
    pixels: f64,
    columns: usize,
    scale: Scale,
}

impl Key<'_> {
    fn draw(&self, writer: &mut Writer<'_>, marks: &mut Vec<Mark>) {
        let Self { figure, forces, scene, pixels, scale, .. } = *self;
        let (palette, unit) = (&figure.look.palette, scale.unit);
        let [width, height] = figure.size.map(f64::from);
        let size = scale.caption();
        let baseline = height - scale.margin() - 1.0 * unit;
        let middle = baseline - 0.33 * size;
        let gap = 12.0 * unit;
        let mut left = scale.margin();
        let column = width / self.columns as f64;
        // A letter after `_` is an index.
        let say = |text: &str, left: f64, writer: &mut Writer<'_>| {
            let mut left = left;
            for (at, part) in text.split('_').enumerate() {
                let index = if at > 0 { part.chars().next().map_or(0, char::len_utf8) } else { 0 };
                let (index, part) = part.split_at(index);
                let small = 0.72 * size;
                writer.left(index, Weight::Regular, small, palette.second_text, left, baseline + 0.2 * size);
                left += writer.fonts.width(index, Weight::Regular, small);
                let room = width - left - scale.margin();
                let part = if writer.fonts.width(part, Weight::Regular, size) <= room {
                    part.to_owned()
                } else {
                    String::new()
                };
                writer.left(&part, Weight::Regular, size, palette.second_text, left, baseline);
                left += writer.fonts.width(&part, Weight::Regular, size);
            }
            left
        };
        // Arrow.
        let side = scene.view.side * pixels;
        let share = round_below(1.3 * KEY_ARROW * unit / side);
        let ends = [DVec2::new(left, middle), DVec2::new(left + share * side, middle)];
        marks.push(arrow(ends, scale.line(), palette.text, palette.halo));
        let text = if forces.vectors {
            "from r_i to R_i: the force on the node over k".to_owned()
        } else {
            format!("{share} k × side")
        };
        left = say(&text, ends[1].x + gap, writer) + 3.0 * gap;
        // Ghost.
        let icon = 22.0 * unit;
        let rectangle = [left, middle - 0.5 * icon, icon, icon].map(f64::round);
        let ghost = mixed(palette.background, palette.edge_on_ground(), GHOST);
        marks.push(filled(rectangle, ghost));
        let [x, y, w, h] = rectangle;
        let corners = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]].map(DVec2::from);
        for at in 0..4 {
            let ends = [corners[at], corners[(at + 1) % 4]];
            for part in [[0.0, 0.2], [0.4, 0.6], [0.8, 1.0]] {
                let dash = part.map(|share| ends[0].lerp(ends[1], share));
                marks.push(line(dash, GHOST_LINE * scale.line(), palette.axis));
            }
        }
        left = say("rest shape, best fit", left + icon + gap, writer) + 3.0 * gap;
        let Some(compare) = forces.compare else { return };
        let second = column + scale.margin();
        if left <= second {
            left = second;
        }
        let ends = [DVec2::new(left, middle), DVec2::new(left + 54.0 * unit, middle)];
        let compared = &scene.runs[compare];
        marks.extend(outlined(ends, scale, compared.line(palette).colour, palette.background));
        say(&format!("forces of “{}”, for comparison", compared.name), ends[1].x + gap, writer);
    }
}

/// An arrow that is there to be compared: faintly filled, with an outline.
fn outlined(ends: [DVec2; 2], scale: Scale, colour: Colour, ground: Colour) -> Vec<Mark> {
    let points = outline(ends, HEAD * scale.line());
    let edge = mixed(ground, colour, OUTLINE_ALPHA);
    let sides = points.windows(2).map(|two| line([two[0], two[1]], OUTLINE * scale.line(), edge));
    std::iter::once(arrow(ends, scale.line(), mixed(ground, colour, COMPARED), ground)).chain(sides).collect()
}

/// The outline of an arrow with a head of a width (px), closed. The shader that draws arrows knows these shares, too.
fn outline([from, to]: [DVec2; 2], width: f64) -> Vec<DVec2> {
    /// Length of the head and depth of its notch, width of the shaft, and length of the head of a short arrow: in parts
    /// of the head's width, the last of the arrow's length.
    const SHAPE: [f64; 4] = [1.235, 0.2, 0.247, 0.62];
    let length = from.distance(to);
    let along = (to - from) / length.max(1e-9);
    let head = (SHAPE[0] * width).min(SHAPE[3] * length);
    let part = head / (SHAPE[0] * width);
    let [half_head, half_shaft, notch] = [0.5 * width * part, 0.5 * SHAPE[2] * width * part, SHAPE[1] * width * part];
    let back = length - head;
    let joint = back + notch * (1.0 - half_shaft / half_head.max(1e-9));
    let half = [(0.0, half_shaft), (joint, half_shaft), (back, half_head), (length, 0.0)];
    let at = |(x, y): (f64, f64)| from + x * along + y * along.perp();
    let other = half.iter().rev().skip(1).map(|&(x, y)| (x, -y));
    let mut points: Vec<_> = half.iter().copied().chain(other).map(at).collect();
    points.push(points[0]);
    points
}

/// What an arrow covers, for labels: its middle and both its sides.
fn wide([from, to]: [DVec2; 2], half: f64) -> [[DVec2; 2]; 3] {
    let across = (to - from).perp().normalize_or_zero() * half;
    [-1.0, 0.0, 1.0].map(|side| [from + side * across, to + side * across])
}

/// Writes what stands out from the lines that it may lie on.
fn over_lines(writer: &mut Writer<'_>, write: impl FnOnce(&mut Writer<'_>)) {
    let before = writer.words.len();
    write(writer);
    writer.words[before..].iter_mut().for_each(|word| word.has_halo = true);
}

/// A straight line with smooth borders.
fn line([from, to]: [DVec2; 2], thickness: f64, colour: Colour) -> Mark {
    let along = (to - from).try_normalize().unwrap_or(DVec2::X);
    // The border of the mark is a pixel wide, half of it outside.
    let corner = from - 0.5 * along - 0.5 * (thickness + 1.0) * along.perp();
    let rectangle = [corner.x, corner.y, from.distance(to) + 1.0, thickness + 1.0];
    Mark { along: along.to_array().map(narrow), ..Mark::upright(rectangle, MarkShape::Smooth, colour) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outlined_arrow_ends_at_its_tip() {
        let [from, to] = [DVec2::new(10.0, 20.0), DVec2::new(110.0, 20.0)];
        let points = outline([from, to], 17.0);
        assert!(points.iter().any(|at| at.distance(to) < 1e-9));
        assert_eq!(points.first(), points.last());
        assert!(
            points.iter().all(|at| at.x >= 10.0 - 1e-9 && at.x <= 110.0 + 1e-9 && (at.y - 20.0).abs() <= 8.5 + 1e-9)
        );
    }
}
