//! A cell of a diagram of forces, drawn: the body, the rest shape behind it, arrows, vectors and numbers.

use super::cell::Cell;
use super::marks::{GHOST_LINE, bare, ghost_colour, outlined};
use crate::colour::Colour;
use crate::picture::arrows::arrow;
use crate::picture::caption::Writer;
use crate::picture::chart::NUMBERS;
use crate::picture::compose::draft::Draft;
use crate::picture::compose::figure::labels::Labels;
use crate::picture::compose::plane_body::path_of;
use crate::picture::layout::Scale;
use crate::picture::narrow::narrow;
use crate::picture::page::point;
use crate::picture::plane::is_inside;
use crate::picture::text::Weight;
use crate::picture::wire::Edges;
use crate::picture::{Item, Panel, Second, Stroke};
use crate::scene::figure::{Figure, Forces};
use glam::{DVec2, DVec3};

/// The distance of two lines of numbers at arrows (px in the reference picture).
const LINE: f64 = 18.0;
/// Width of the vectors (px in the reference picture).
const VECTOR: f64 = 1.5;
/// Dashes of the rest shape and gaps between them (px in the reference picture).
const DASH: [f64; 2] = [5.0, 4.0];
/// Radius of a node and of the centre (px in the reference picture).
const NODE: f64 = 5.2;
const CENTRE: f64 = 3.4;
/// Half of an arrow's width, for labels (px in the reference picture).
const ARROW: f64 = 5.0;
/// Arrows shorter than this (radii of a node) are drawn above smaller nodes: the radius in lengths of the arrow, and the
/// least one in usual radii.
const LONG: f64 = 2.5;
const SMALL_NODE: [f64; 2] = [0.3, 0.55];
/// Arrows shorter than this are not drawn (px in the reference picture).
const SHORTEST: f64 = 3.0;
/// An arrow that is closer than this to both sides of a corner (rad) has no halo there.
const NARROW: f64 = 0.5;
/// Forces that would move no node farther than this (sides) are round-off.
const NONE: f64 = 1e-9;
/// Opacity of nodes and arrows that a body hides.
const HIDDEN: f64 = 0.3;

/// A cell with its camera.
pub(super) struct Drawn<'a> {
    cell: &'a Cell<'a>,
    draft: Draft<'a>,
    scale: Scale,
    figure: &'a Figure,
}

impl<'a> Drawn<'a> {
    pub(super) fn new(cell: &'a Cell<'a>, pixels: f64, centre: DVec2, scale: Scale, figure: &'a Figure) -> Self {
        Self { cell, draft: cell.draft(scale, pixels, centre), scale, figure }
    }

    fn pixel(&self, at: DVec3) -> DVec2 {
        self.draft.lens.project(at).map_or(DVec2::ZERO, |(pixel, _)| DVec2::from(pixel))
    }

    /// The body with its rest shape behind it.
    pub(super) fn panel(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        // Ring arrows, nodes and displacements of usual panels are left out.
        if self.draft.flat {
            return self.draft.in_plane(Some(self.ghost_in_plane()), under, &mut Vec::new());
        }
        let mut panel = self.draft.panel(under, &mut Vec::new());
        self.draft.fade_obstacles(&mut panel.obstacles, above);
        panel.beads.clear();
        panel.strokes.extend(self.ghost_in_space());
        panel.region = panel.viewport;
        panel
    }

    fn ghost_in_plane(&self) -> Item {
        let triangles = self.cell.composer.skin.triangles.iter();
        let skin = &self.cell.composer.skin.nodes;
        let at = |at: u32| point(self.pixel(self.cell.ghost[skin[at as usize] as usize]));
        let path = path_of(triangles.map(|triangle| triangle.map(at).to_vec()));
        Item::fill(path, ghost_colour(&self.figure.look.palette()))
    }

    /// The edges of all elements, each once.
    fn edges(&self) -> Vec<[u32; 2]> {
        Edges::new(&self.cell.scene.body).all
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
        let palette = &self.figure.look.palette();
        let edges = self.edges().into_iter().map(|edge| edge.map(|node| self.cell.ghost[node as usize]));
        let strokes = edges.flat_map(|[from, to]| {
            let dashes = self.dashes([from, to].map(|at| self.pixel(at)));
            dashes.into_iter().map(move |dash| dash.map(|share| self.draft.relative(from.lerp(to, share))))
        });
        let stroke = |ends| Stroke {
            ends,
            colours: [palette.second_text; 2],
            second: Second::OnBody(palette.spring_on_body),
            behind: (255.0 * HIDDEN) as u8,
            width: narrow(GHOST_LINE * self.scale.line()),
        };
        strokes.map(stroke).collect()
    }

    /// The dashed outline of the ghost in the plane, outside of the body or complete.
    fn ghost_outline(&self, marks: &mut Vec<Item>, also_inside: bool) {
        let body = &self.cell.scene.body;
        let pixels: Vec<_> = self.cell.snapshot().position.iter().map(|&at| self.pixel(at)).collect();
        let polygons: Vec<Vec<DVec2>> =
            body.elements.iter().map(|nodes| nodes.iter().map(|&node| pixels[node as usize]).collect()).collect();
        for edge in self.edges() {
            let [from, to] = edge.map(|node| self.pixel(self.cell.ghost[node as usize]));
            for dash in self.dashes([from, to]) {
                let ends = dash.map(|share| from.lerp(to, share));
                let middle = ends[0].midpoint(ends[1]);
                let inside = polygons.iter().any(|polygon| is_inside(polygon, middle));
                if also_inside || !inside {
                    let palette = &self.figure.look.palette();
                    let colour = match also_inside {
                        true if inside => palette.spring_on_body,
                        true => palette.second_text,
                        false => palette.axis,
                    };
                    marks.push(Item::line(ends, GHOST_LINE * self.scale.line(), colour));
                }
            }
        }
    }

    /// Everything above the body.
    pub(super) fn draw(&self, forces: &Forces, writer: &mut Writer<'_>, above: &mut Vec<Item>) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette();
        let unit = scale.unit;
        let position = &cell.snapshot().position;
        // In the plane all nodes are visible; in space also nodes of elements without faces, but not nodes inside.
        let mut seen = cell.composer.skin.visible(position, &self.draft.lens);
        let body = &cell.scene.body;
        for node in (0..position.len()).filter(|&node| !cell.composer.skin.holds(node as u32)) {
            let is_bare = || cell.composer.bare.iter().any(|&element| body.elements[element].contains(&(node as u32)));
            seen[node] = if self.draft.flat || is_bare() { 1.0 } else { 0.0 };
        }
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
            for (node, ends) in arrows.iter().enumerate().filter(|(_, ends)| shown(ends)) {
                above.extend(outlined(*ends, *scale, colour, palette.background, !self.is_in_corner(node, *ends)));
            }
        }
        if forces.vectors {
            self.vectors(writer, &mut labels, &seen);
        }
        let mut order: Vec<usize> = (0..arrows.len()).filter(|&at| shown(&arrows[at])).collect();
        order.sort_by(|&a, &b| seen[a].total_cmp(&seen[b]));
        // Nodes would hide short arrows, which lie above smaller nodes instead.
        let length = |at: usize| arrows[at][0].distance(arrows[at][1]);
        let is_short = |&at: &usize| length(at) < LONG * NODE * scale.line();
        let (short, long): (Vec<_>, Vec<_>) = order.iter().copied().partition(is_short);
        for at in long {
            if self.is_in_corner(at, arrows[at]) {
                above.push(bare(arrows[at], scale.line(), own));
                continue;
            }
            let whole = arrow(arrows[at], scale.line(), own, palette.background);
            above.extend(whole.faded(HIDDEN + (1.0 - HIDDEN) * seen[at]));
        }
        for (node, (&at, &seen)) in position.iter().zip(&seen).enumerate() {
            if seen > 0.0 {
                let usual = NODE * scale.line();
                let [part, least] = SMALL_NODE;
                let radius = if short.contains(&node) { (part * length(node)).max(least * usual) } else { usual };
                above.extend(Item::rimmed(self.pixel(at), radius, palette.node, palette.edge).faded(seen));
            }
        }
        for at in short {
            above.extend(bare(arrows[at], scale.line(), own).faded(HIDDEN + (1.0 - HIDDEN) * seen[at]));
        }
        if order.is_empty() {
            let text = if cell.ways.iter().all(|way| way.length() < NONE * cell.scene.view.side) {
                "no forces"
            } else {
                "forces too small to be seen"
            };
            let size = scale.caption();
            let left = left + 0.5 * (width - writer.fonts.width(text, Weight::Regular, size));
            let lowest = position.iter().map(|&at| self.pixel(at).y).fold(0.0, f64::max);
            let baseline = lowest + NODE * scale.line() + 1.2 * size;
            writer.left(text, Weight::Regular, size, palette.second_text, left, baseline);
        }
        if forces.numbers {
            for &at in &order {
                self.number(at, arrows[at], writer, &mut labels, palette.text_like(own));
            }
        }
    }

    /// Whether a node's arrow in the plane lies in a narrow corner of an element, whose sides its halo would cover.
    fn is_in_corner(&self, node: usize, [from, to]: [DVec2; 2]) -> bool {
        let way = to - from;
        let nearly = |other: u32| {
            let side = self.pixel(self.cell.snapshot().position[other as usize]) - from;
            way.angle_to(side).abs() < NARROW
        };
        self.draft.flat
            && self.cell.scene.body.elements.iter().any(|nodes| {
                let at = nodes.iter().position(|&other| other as usize == node);
                let at = at.filter(|_| nodes.len() > 2);
                at.is_some_and(|at| [1, nodes.len() - 1].iter().all(|step| nearly(nodes[(at + step) % nodes.len()])))
            })
    }

    /// The size of a force at its arrow, and the angle to the force that it is compared with.
    fn number(&self, at: usize, [from, to]: [DVec2; 2], writer: &mut Writer<'_>, labels: &mut Labels, colour: Colour) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette();
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
        // Both lines are aligned at the side of the arrow.
        let on_left = corner.x + 0.5 * extent.x < if corner.x < from.x.min(to.x) { from.x } else { to.x };
        for (row, (text, colour)) in [(number, colour), (second, palette.second_text)].into_iter().enumerate() {
            let left = if on_left { corner.x + extent.x - wide(&text) } else { corner.x };
            let baseline = corner.y + size * 0.78 + row as f64 * line;
            over_lines(writer, |writer| writer.left(&text, Weight::Regular, size, colour, left, baseline));
        }
    }

    /// The centre, and the vectors from it to a node and to its place in the equilibrium shape.
    fn vectors(&self, writer: &mut Writer<'_>, labels: &mut Labels, seen: &[f64]) {
        let Self { cell, scale, .. } = self;
        let palette = &self.figure.look.palette();
        let unit = scale.unit;
        let position = &cell.snapshot().position;
        let centre = self.pixel(cell.middle());
        // The visible node with the largest displacement.
        let displaced = |node: &usize| self.pixel(position[*node]).distance(self.pixel(cell.ghost[*node]));
        let visible = (0..position.len()).filter(|&node| seen[node] > 0.5);
        let Some(node) = visible.max_by(|one, other| displaced(one).total_cmp(&displaced(other))) else { return };
        let [now, equilibrium] = [position[node], cell.ghost[node]].map(|at| self.pixel(at));
        let mut curve = |to: DVec2, dash: &[f64]| {
            let points = [centre, to].map(|at| at.to_array());
            writer.curves.push(Item::curve(&points, VECTOR * scale.line(), dash, (palette.text, 0.9)));
        };
        curve(now, &[]);
        curve(equilibrium, &DASH.map(|length| length * unit));
        for (radius, colour) in [(CENTRE + 1.6, palette.background), (CENTRE, palette.text)] {
            writer.curves.push(Item::disc(centre.to_array(), radius * unit, colour));
        }
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

/// The lines of an arrow that labels should not hide: its middle and both its sides.
fn wide([from, to]: [DVec2; 2], half: f64) -> [[DVec2; 2]; 3] {
    let across = (to - from).perp().normalize_or_zero() * half;
    [-1.0, 0.0, 1.0].map(|side| [from + side * across, to + side * across])
}

/// Writes text with a halo, as it may lie over lines.
fn over_lines(writer: &mut Writer<'_>, write: impl FnOnce(&mut Writer<'_>)) {
    let before = writer.words.len();
    write(writer);
    writer.words[before..].iter_mut().for_each(|word| word.has_halo = true);
}
