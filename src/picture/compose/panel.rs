//! Composes one panel from its parts.

use super::draft::{Draft, PixelBox};
use super::plane_body::PlaneBody;
use super::plane_marks::node_radius;
use crate::picture::arrows;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::{APART, CHART, FREE, RING};
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::obstacle::{self, Site, Staged, Staging};
use crate::picture::order::farthest_first;
use crate::picture::pointer::Pointers;
use crate::picture::shell::{boundaries, triangles};
use crate::picture::surface::SurfaceLines;
use crate::picture::{Item, Line, Obstacles, Panel, Sight, Solid};
use crate::sim::geometry;
use glam::DVec3;
use std::ops::Range;

/// Small bodies have narrower contours, down to this part of the width; otherwise they would be mostly outline.
const LEAST_CONTOUR: f64 = 0.4;

impl Draft<'_> {
    /// Draws the panel, with items below and above lit bodies.
    pub(super) fn panel(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        if self.flat { self.in_plane(under, above) } else { self.in_space(above) }
    }

    /// Draws a panel in the plane, which has no lit body.
    fn in_plane(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        let obstacles = obstacle::PlaneObstacles { site: self.site(), line_scale: self.scale.line() };
        let (mut items, outlines) = obstacles.draw();
        let region = self.region(&outlines.concat());
        items.extend(self.cover(&outlines, region));
        under.extend((!items.is_empty()).then(|| Item::inside(region, items)));
        self.floors(under);
        self.signs(above);
        self.nodes(above);
        obstacles.arrows(&self.pointers(self.viewport), above);
        under.push(PlaneBody::new(self, region).item());
        self.grips(above);
        self.displacements(above);
        self.without_body(region)
    }

    /// Draws a panel in space.
    fn in_space(&self, above: &mut Vec<Item>) -> Panel {
        let mut lines = SurfaceLines::default();
        let [sound, turned_over] = self.surfaces(&mut lines);
        let SurfaceLines { drawn: mut lines, borders } = lines;
        let of_body = lines.len();
        let (mut obstacles, staged) = self.obstacles(&mut lines, above);
        let corners = |solid: &Solid| solid.mesh.vertices.iter().map(|vertex| self.place(vertex.position)).collect();
        obstacles.fade = self.fading(&obstacles.solids.iter().map(corners).collect::<Vec<_>>());
        let borders = borders.into_iter().map(|border| border.line).chain(lines[of_body..].iter().copied()).collect();
        self.grips(above);
        self.displacements(above);
        Panel {
            floor: self.floor(&staged),
            sound,
            turned_over,
            dotted: self.run.snapshot.flat.contains(&true),
            greyed: self.greyed,
            lines,
            borders,
            obstacles,
            strokes: self.strokes(),
            beads: self.beads(),
            ..self.without_body(self.region(&staged.outermost))
        }
    }

    /// The panel without a lit body.
    fn without_body(&self, region: Rectangle) -> Panel {
        Panel { viewport: self.viewport, region, sight: self.sight(), is_cut: self.is_cut(), ..Panel::default() }
    }

    /// Camera and light.
    fn sight(&self) -> Sight {
        let Self { lens, origin, side, .. } = self;
        Sight {
            clip: lens.clip(*origin, *side, self.viewport.map(f64::from)),
            eye: narrow_point((lens.eye - origin) / side),
            near: narrow(lens.near_in(*side)),
            focal: narrow(if self.flat { lens.focal * side } else { lens.focal }),
            key: narrow_point(self.key),
            flat: self.flat,
            line_scale: narrow(self.scale.line()),
            soft: narrow(self.bodies.soft),
            element: narrow(self.element),
            contour_share: narrow(self.contour_share()),
            middle: self.middle(0..self.position.len()),
        }
    }

    /// The width of the body's contours, relative to the usual one.
    fn contour_share(&self) -> f64 {
        if self.diverged {
            return 1.0;
        }
        let of_bodies = self.boxes().iter().map(|PixelBox { corners: [low, high], .. }| (high - low).max_element());
        let widest = of_bodies.fold(f64::NEG_INFINITY, f64::max) / self.scale.line();
        let share = ((widest - APART) / (CHART - APART)).clamp(0.0, 1.0);
        1.0 - (1.0 - LEAST_CONTOUR) * (1.0 - share * share * (3.0 - 2.0 * share))
    }

    /// The pixel of the middle of some nodes.
    pub(super) fn middle(&self, nodes: Range<usize>) -> [f32; 2] {
        let middle = self.position[nodes.clone()].iter().sum::<DVec3>() / nodes.len().max(1) as f64;
        self.lens.project(middle).map_or([0.0; 2], |(pixel, _)| pixel.map(narrow))
    }

    /// The obstacles at the moment of the panel.
    fn site(&self) -> Site<'_> {
        Site {
            obstacles: &self.scene.obstacles,
            time: self.run.snapshot.time,
            frame: 1.0 / self.scene.frames_per_second,
            lens: &self.lens,
            origin: self.origin,
            side: self.side,
            extent: self.composer.extent,
            palette: &self.composer.palette,
        }
    }

    /// All obstacles in space but the ground, with their lines and marks.
    fn obstacles(&self, lines: &mut Vec<Line>, above: &mut Vec<Item>) -> (Obstacles, Staged) {
        let broken = &self.run.snapshot.broken;
        let left = || triangles(self.body, &boundaries(self.body, &[], broken)[0]);
        let staging = Staging {
            site: self.site(),
            cell: self.cell(),
            ground: geometry::ground(&self.scene.obstacles, self.run.snapshot.time),
            position: &self.position,
            skin: (self.scene.view.visible.surfaces && !self.diverged).then(|| self.bodies.cage()),
            left: broken.contains(&true).then(left),
            soft: self.bodies.soft * self.side,
            start: self.composer.start_box,
            reach: &self.composer.reach,
        };
        staging.arrows(&self.pointers(self.viewport), above);
        staging.draw(lines)
    }

    /// Displacements: an arrow for each node, the farthest first, in the colour of text as in the key: paths and fields have
    /// others. Arrows that would be specks on the nodes are left out.
    fn displacements(&self, above: &mut Vec<Item>) {
        let (view, palette) = (&self.scene.view, &self.composer.palette);
        if !view.visible.displacements || self.diverged || self.position.is_empty() {
            return;
        }
        let size = arrows::size(self.element, self.scale.unit);
        let node = if view.visible.nodes { node_radius(self.scale, self.element) } else { 0.0 };
        let shortest = (RING * size).max(FREE).max(2.0 * node);
        let arrows = self.facing_bearers().into_iter().filter_map(|(node, opacity)| {
            let placement = self.run.snapshot.placements[self.bodies.assembly().body_of_node(node as usize)];
            let start = placement.place(self.body.rest()[node as usize]);
            let end = start + view.arrow_scale * (self.position[node as usize] - start);
            let (to, depth) = self.lens.project(end)?;
            let (ends, part) = arrows::inside([self.pixel(start)?, to.into()], self.clear, shortest)?;
            Some((depth, arrows::arrow(ends, size, palette.text, palette.background).faded(opacity * part)?))
        });
        above.extend(farthest_first(arrows.collect()));
    }

    /// The nodes with arrows and their opacity: 0 if all faces of a node in space are turned away.
    fn facing_bearers(&self) -> Vec<(u32, f64)> {
        let (skin, bearers) = (self.bodies.cage(), &self.bodies.bearers);
        if !self.scene.view.visible.surfaces {
            return bearers.iter().map(|&node| (node, 1.0)).collect();
        }
        let on_skin = skin.visible(&self.position, &self.lens);
        let mut visible = vec![1.0; self.position.len()];
        skin.nodes.iter().for_each(|&node| visible[node as usize] = on_skin[node as usize]);
        bearers.iter().map(|&node| (node, visible[node as usize])).collect()
    }

    /// Draws the arrows of moving objects, in a room.
    pub(super) fn pointers(&self, room: Rectangle) -> Pointers<'_> {
        Pointers { lens: &self.lens, room, scale: self.scale, palette: &self.composer.palette }
    }
}
