//! Composes one panel from its parts.

use super::bodies::Bodies;
use super::draft::{Draft, PixelBox};
use super::overlay;
use crate::picture::compose::obstacle::Staging;
use crate::picture::compose::surface::SurfaceLines;
use crate::picture::flat::Flat;
use crate::picture::key_map::key_map;
use crate::picture::layout::steps::{APART, CHART};
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::shadow::Edge;
use crate::picture::{Item, Mesh, Obstacles, Panel, Sight, Solid};
use glam::{DVec3, Mat4};
use std::ops::Range;

/// Small bodies have narrower contours, down to this part of the width; otherwise they would be mostly outline.
const LEAST_CONTOUR: f64 = 0.4;
/// Less than this sine of the angle between two faces that are bent inwards, shadows of one on the other are too small to be seen.
const BENT: f64 = 0.1;
/// Folds inside the turned-over set of elements smaller than this (px) are fainter.
const SMALL_FOLDED: f32 = 8.0;

impl Draft<'_> {
    /// Draws the panel, with items below and above lit bodies.
    pub(super) fn panel(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        let mut lines = SurfaceLines::default();
        let [sound, turned_over] = self.surfaces(&mut lines);
        let SurfaceLines { drawn: mut lines, borders } = lines;
        let staging = Staging::new(self);
        let (mut obstacles, staged) = staging.draw();
        let corners = |solid: &Solid| solid.mesh.vertices.iter().map(|vertex| self.place(vertex.position)).collect();
        obstacles.fade = self.fading(&obstacles.solids.iter().map(corners).collect::<Vec<_>>());
        let borders = borders.into_iter().map(|border| border.line).chain(staged.lines.iter().copied()).collect();
        lines.extend(&staged.lines);
        let panel = Panel {
            viewport: self.viewport,
            region: self.region(&staged.outermost),
            sight: Sight { key_map: self.key_map([&sound, &turned_over], &obstacles), ..self.sight() },
            floor: self.floor(&staged),
            sound,
            turned_over,
            dotted: self.snapshot.flat.contains(&true),
            greyed: self.greyed,
            lines,
            borders,
            obstacles,
            strokes: self.strokes(),
            beads: self.beads(),
            is_cut: self.is_cut(),
        };
        if self.flat {
            let flat = Flat { panel: &panel, palette: &self.palette, ramp: &self.composer.ramp };
            under.extend(flat.obstacles());
            under.extend(self.floors());
            under.push(flat.body());
            self.signs(above);
            above.extend(flat.nodes());
        }
        staging.arrows(above);
        panel
    }

    /// Draws the overlays of the panel.
    pub(super) fn overlays(&self, marks: &mut Vec<Item>, curves: &mut Vec<Item>) {
        overlay::MARKS.iter().for_each(|draw| draw(self, marks));
        overlay::CURVES.iter().for_each(|draw| draw(self, curves));
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
            key_map: None,
            flat: self.flat,
            line_scale: narrow(self.scale.line()),
            soft: narrow(self.bodies.soft),
            element: narrow(self.element),
            contour_share: narrow(self.contour_share()),
            folds: if self.marks_outline() { 0.0 } else { (narrow(self.element) / SMALL_FOLDED).min(1.0).powi(2) },
            middle: lens.project(self.centre(0..self.position.len())).map_or([0.0; 2], |(pixel, _)| pixel.map(narrow)),
        }
    }

    /// The box of the shadows that surfaces cast on each other; `None` where they cannot.
    fn key_map(&self, surfaces: [&Mesh; 2], obstacles: &Obstacles) -> Option<Mat4> {
        if self.flat || !self.scene.view.shadow {
            return None;
        }
        let meets = !obstacles.solids.is_empty() || !obstacles.panes.is_empty() || self.bodies.parts.len() > 1;
        let solids = obstacles.solids.iter().map(|solid| &solid.mesh);
        (meets || self.is_hollow()).then(|| key_map(self.key, surfaces, solids)).flatten()
    }

    /// Whether the surface of bodies may shade itself: it is carried, open, broken, or bent inwards at an edge.
    fn is_hollow(&self) -> bool {
        let Bodies { skin, seams, .. } = self.bodies;
        let at = |place: u32| self.skin[place as usize];
        let is_bent_inwards = |edge: &Edge| {
            let [Some(one), Some(other)] = edge.triangles() else { return true };
            let [a, b, c] = skin.triangles[one as usize].map(at);
            let ([from, to], normal) = (edge.ends.map(at), (b - a).cross(c - a));
            let far = skin.triangles[other as usize].into_iter().find(|corner| !edge.ends.contains(corner));
            // The distance of that corner from the plane, relative to that from the edge: the sine of the angle of the two faces.
            let is_out = |far: DVec3| {
                let from_edge = (far - from).cross(to - from).length() / (to - from).length();
                normal.dot(far - from) > BENT * normal.length() * from_edge
            };
            far.is_some_and(|far| is_out(at(far)))
        };
        let is_whole = !self.skin.is_empty() && !self.snapshot.broken.contains(&true);
        !is_whole || !skin.fine.is_empty() || seams.iter().any(is_bent_inwards)
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

    /// The middle of some nodes (m).
    pub(super) fn centre(&self, nodes: Range<usize>) -> DVec3 {
        self.position[nodes.clone()].iter().sum::<DVec3>() / nodes.len().max(1) as f64
    }
}
