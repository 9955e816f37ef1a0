//! A cell of a diagram of forces, drawn: the body, the rest shape behind it, arrows, vectors and numbers.

use super::cell::Cell;
use crate::colour::{Colour, mixed};
use crate::look::Palette;
use crate::picture::arrows::{arrow, bare, outlined};
use crate::picture::caption::Writer;
use crate::picture::compose::draft::Draft;
use crate::picture::compose::edges::Edges;
use crate::picture::compose::figure::labels::LabelPlaces;
use crate::picture::flat::path_of;
use crate::picture::ghost::DASH;
use crate::picture::layout::steps::{APART, CLOSE, FREE, NEAR, SMALL, THIN, TICK};
use crate::picture::layout::tree::Place;
use crate::picture::layout::{ASCENT, Scale};
use crate::picture::page::point;
use crate::picture::plane::sides;
use crate::picture::text::Weight;
use crate::picture::{Item, Panel};
use crate::scene::figure::Forces;
use glam::{DVec2, DVec3};

/// Opacity of the rest shape, of edges, nodes and arrows that a body hides, and of the casing of the edges of the rest
/// shape.
const GHOST: f64 = 0.075;
const HIDDEN: f64 = 0.3;
const CASING: f64 = 0.35;
/// The radius of nodes with short arrows, in lengths of the arrow, and the least one in usual radii.
const SMALL_NODE: [f64; 2] = [0.3, 0.55];
/// Forces that would move no node farther than this (sides) are round-off.
const NONE: f64 = 1e-9;

/// A cell with its camera.
pub(super) struct CellView<'a> {
    pub(super) cell: &'a Cell<'a>,
    pub(super) draft: Draft<'a>,
    pub(super) room: Place,
    pub(super) scale: Scale,
    pub(super) palette: &'a Palette,
}

impl CellView<'_> {
    fn pixel(&self, at: DVec3) -> DVec2 {
        self.draft.lens.project(at).map_or(DVec2::ZERO, |(pixel, _)| DVec2::from(pixel))
    }

    fn pixels(&self, all: &[DVec3]) -> Vec<DVec2> {
        all.iter().map(|&at| self.pixel(at)).collect()
    }

    /// The nodes of the body (m).
    fn position(&self) -> &[DVec3] {
        &self.cell.frame.snapshot.position
    }

    /// The body with its rest shape behind it.
    pub(super) fn panel(&self, under: &mut Vec<Item>) -> Panel {
        if self.draft.flat {
            let (skin, ghost) = (&self.draft.bodies.skin, self.pixels(&self.cell.ghost));
            let at = |at: u32| point(ghost[skin.nodes[at as usize] as usize]);
            let path = path_of(skin.triangles.iter().map(|triangle| triangle.map(at).to_vec()));
            under.push(Item::fill(path, mixed(self.palette.background, self.palette.edge_on_ground(), GHOST)));
        }
        // Ring arrows, nodes and displacements of usual panels are left out.
        let mut panel = self.draft.panel(under, &mut Vec::new());
        panel.beads.clear();
        panel.region = panel.viewport;
        panel
    }

    /// How well each node of the body or of its rest shape can be seen, from 0 to 1. In the plane all are visible; in
    /// space also nodes of elements without faces, but not nodes inside.
    fn seen(&self, position: &[DVec3]) -> Vec<f64> {
        let (skin, bare, body) = (self.draft.bodies.cage(), &self.draft.bodies.bare, self.draft.body);
        let mut seen = skin.visible(position, &self.draft.lens);
        for node in (0..position.len()).filter(|&node| !skin.holds(node as u32)) {
            let is_bare = || bare.iter().any(|&element| body.elements()[element].contains(&(node as u32)));
            seen[node] = if self.draft.flat || is_bare() { 1.0 } else { 0.0 };
        }
        seen
    }

    /// Everything above the body.
    pub(super) fn draw(&self, forces: &Forces, writer: &mut Writer<'_>, above: &mut Vec<Item>) {
        let Self { cell, scale, palette, .. } = self;
        let (unit, line, scene) = (scale.unit, scale.line(), cell.composer.scene);
        let (nodes, ghost, seen) = (self.pixels(self.position()), self.pixels(&cell.ghost), self.seen(self.position()));
        let [left, top, right, bottom] = sides(self.room);
        let inset = FREE * unit;
        let mut labels = LabelPlaces::new([left + inset, top + inset, right - inset, bottom - inset], unit);
        let faces = self.draft.body.faces().nodes.iter();
        labels.surfaces = faces.map(|face| face.iter().map(|&node| nodes[node as usize]).collect()).collect();
        let seen_ghost = self.seen(&cell.ghost);
        for edge in Edges::new(self.draft.body).all {
            let [a, b] = edge.map(|node| node as usize);
            labels.lines.extend([[nodes[a], nodes[b]], [ghost[a], ghost[b]]]);
            let opacity = HIDDEN + (1.0 - HIDDEN) * seen_ghost[a].min(seen_ghost[b]);
            let dash = DASH.map(|length| length * line);
            let ends = [ghost[a], ghost[b]].map(|end| end.to_array());
            // The casing makes the dashes visible on bodies of any colour.
            above.push(Item::curve(&ends, FREE * line, &[], (palette.background, CASING * opacity)));
            above.push(Item::curve(&ends, THIN * line, &dash, (palette.second_text, opacity)));
        }
        let own = scene.runs[cell.frame.run].line(palette).colour;
        let ends = |ways: &[DVec3]| -> Vec<[DVec2; 2]> {
            self.position().iter().zip(ways).map(|(&at, &way)| [self.pixel(at), self.pixel(at + way)]).collect()
        };
        let arrows = ends(&cell.ways);
        labels.lines.extend(arrows.iter().flat_map(|ends| wide(*ends, NEAR * unit)));
        let shown = |[from, to]: &[DVec2; 2]| from.distance(*to) >= FREE * unit;
        if let Some((run, compared)) = &cell.compared {
            let arrows = ends(compared);
            labels.lines.extend(arrows.iter().flat_map(|ends| wide(*ends, NEAR * unit)));
            let colour = scene.runs[*run].line(palette).colour;
            let all = arrows.iter().filter(|ends| shown(ends));
            above.extend(all.map(|&ends| Item::part("arrow", outlined(ends, line, colour, palette.background))));
        }
        if forces.vectors {
            self.vectors(writer, &mut labels, [&nodes, &ghost], &seen);
        }
        let mut order: Vec<usize> = (0..arrows.len()).filter(|&at| shown(&arrows[at])).collect();
        order.sort_by(|&a, &b| seen[a].total_cmp(&seen[b]));
        // Nodes would hide short arrows, which lie above smaller nodes instead.
        let length = |at: usize| arrows[at][0].distance(arrows[at][1]);
        let is_short = |&at: &usize| length(at) < APART * line;
        let (short, long): (Vec<_>, Vec<_>) = order.iter().copied().partition(is_short);
        let opacity = |at: usize| HIDDEN + (1.0 - HIDDEN) * seen[at];
        for at in long {
            above.extend(arrow(arrows[at], line, own, palette.background).faded(opacity(at)));
        }
        for (node, &seen) in seen.iter().enumerate().filter(|(_, seen)| **seen > 0.0) {
            let [part, least] = SMALL_NODE;
            let usual = CLOSE * line;
            let radius = if short.contains(&node) { (part * length(node)).clamp(least * usual, usual) } else { usual };
            above.extend(Item::rimmed(nodes[node], radius, palette.node, palette.edge).faded(seen));
        }
        above.extend(short.into_iter().filter_map(|at| bare(arrows[at], line, own).faded(opacity(at))));
        if order.is_empty() {
            let is_none = cell.ways.iter().all(|way| way.length() < NONE * scene.view.side);
            let text = if is_none { "no forces" } else { "forces too small to be seen" };
            let size = scale.caption();
            let left = 0.5 * (left + right - writer.fonts.width(text, Weight::Regular, size));
            let lowest = nodes.iter().map(|at| at.y).fold(0.0, f64::max);
            let baseline = lowest + CLOSE * line + 1.2 * size;
            writer.left(text, Weight::Regular, size, palette.second_text, left, baseline);
        }
        for &at in order.iter().filter(|_| forces.numbers) {
            self.number(at, arrows[at], writer, &mut labels, palette.text_like(own));
        }
    }

    /// The size of a force at its arrow, and the angle to the force that it is compared with.
    fn number(
        &self,
        at: usize,
        [from, to]: [DVec2; 2],
        writer: &mut Writer<'_>,
        labels: &mut LabelPlaces,
        colour: Colour,
    ) {
        let Self { cell, scale, palette, .. } = self;
        let size = SMALL * scale.type_unit();
        let line = 1.25 * size;
        let way = cell.ways[at];
        let angle = cell.compared.as_ref().map(|(_, compared)| way.angle_between(compared[at]).to_degrees());
        let angle = angle.filter(|angle| angle.is_finite() && *angle >= 0.5);
        let second = angle.map(|angle| (format!("{angle:.0}° off"), palette.second_text));
        let number = format!("{:.3}", way.length() / cell.composer.scene.view.side);
        let lines: Vec<_> = [(number, colour)].into_iter().chain(second).collect();
        let wide = |text: &str| writer.fonts.width(text, Weight::Regular, size);
        let widths: Vec<_> = lines.iter().map(|(text, _)| wide(text)).collect();
        let widest = widths.iter().copied().fold(0.0, f64::max);
        let extent = DVec2::new(widest, ASCENT * size + (lines.len() - 1) as f64 * line);
        let corner = labels.place([from, to], extent, true);
        // Both lines are aligned at the side of the arrow.
        let on_left = corner.x + 0.5 * extent.x < if corner.x < from.x.min(to.x) { from.x } else { to.x };
        for (row, ((text, colour), width)) in lines.iter().zip(widths).enumerate() {
            let left = if on_left { corner.x + widest - width } else { corner.x };
            let baseline = corner.y + ASCENT * size + row as f64 * line;
            over_lines(writer, text, Weight::Regular, size, *colour, [left, baseline]);
        }
    }

    /// The centre, and the vectors from it to a node and to its place in the equilibrium shape.
    fn vectors(&self, writer: &mut Writer<'_>, labels: &mut LabelPlaces, [nodes, ghost]: [&[DVec2]; 2], seen: &[f64]) {
        let Self { scale, palette, .. } = self;
        let line = scale.line();
        // The visible node with the largest displacement.
        let displaced = |node: usize| nodes[node].distance(ghost[node]);
        let visible = (0..nodes.len()).filter(|&node| seen[node] > 0.5);
        let Some(node) = visible.max_by(|&one, &other| displaced(one).total_cmp(&displaced(other))) else { return };
        let (now, equilibrium) = (nodes[node], ghost[node]);
        let body = self.draft.bodies.assembly.body_of_node(node);
        let centre = self.pixel(self.cell.frame.snapshot.placements[body].centre);
        for (to, dash) in [(now, &[][..]), (equilibrium, &DASH.map(|length| length * line))] {
            let points = [centre, to].map(|at| at.to_array());
            writer.curves.push(Item::curve(&points, THIN * line, dash, palette.text));
        }
        for (radius, colour) in [(CLOSE, palette.background), (TICK, palette.text)] {
            writer.curves.push(Item::disc(centre.to_array(), radius * line, colour));
        }
        labels.lines.extend([[centre, now], [centre, equilibrium]]);
        let across = |to: DVec2, other: DVec2| {
            let normal = (to - centre).perp().normalize_or_zero();
            if normal.dot(other - centre) > 0.0 { -normal } else { normal }
        };
        let size = scale.caption();
        for (at, away, letter) in [
            (centre, centre - now.midpoint(equilibrium), "c"),
            (centre.midpoint(now), across(now, equilibrium), "r"),
            (centre.midpoint(equilibrium), across(equilibrium, now), "R"),
        ] {
            let extent = DVec2::new(writer.fonts.width(letter, Weight::SemiBold, size), size);
            let corner = labels.place([at - away, at], extent, false);
            let place = [corner.x, corner.y + ASCENT * size];
            over_lines(writer, letter, Weight::SemiBold, size, palette.text, place);
        }
    }
}

/// The lines of an arrow that labels should not hide: its middle and both its sides.
fn wide([from, to]: [DVec2; 2], half: f64) -> [[DVec2; 2]; 3] {
    let across = (to - from).perp().normalize_or_zero() * half;
    [-1.0, 0.0, 1.0].map(|side| [from + side * across, to + side * across])
}

/// Writes text with a halo, as it may lie over lines.
fn over_lines(
    writer: &mut Writer<'_>,
    text: &str,
    weight: Weight,
    size: f64,
    colour: Colour,
    [left, baseline]: [f64; 2],
) {
    let before = writer.words.len();
    writer.left(text, weight, size, colour, left, baseline);
    writer.words[before..].iter_mut().for_each(|word| word.has_halo = true);
}
