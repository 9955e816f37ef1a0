//! The body of a panel: its surfaces, lines and nodes.

use super::Composer;
use super::draft::Draft;
use crate::look::ColourScale;
use crate::picture::compose::surface::{Hatch, SurfaceLines, Surfaces};
use crate::picture::compose::wire::Wire;
use crate::picture::layout::Scale;
use crate::picture::layout::steps::{CLOSE, RING, THIN};
use crate::picture::shell::{Side, boundaries, is_broken};
use crate::picture::{Bead, LineKind, Mesh, Stroke};
use crate::sim::Field;
use glam::DVec3;
use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

/// The period of the hatch in space (units of soft distances).
const HATCH_PERIOD: f64 = 0.30;
/// In bodies of more elements, edges of turned-over ones are not drawn.
const MANY_TO_MARK: usize = 200;
/// The largest radius of nodes in lengths of an element's edge.
const CROWDED: f64 = 0.14;

impl Composer<'_> {
    /// The colour scale for the strain of a run's springs, if they show it.
    pub(super) fn strain_of_springs(&self, run: usize) -> Option<ColourScale> {
        let view = &self.scene.view;
        let has_springs =
            self.scene.runs.get(run).is_some_and(|run| run.models.iter().any(|model| !model.springs().is_empty()));
        let are_shown = has_springs && view.visible.springs && !view.visible.surfaces;
        view.colour.filter(|scale| are_shown && scale.field == Field::Strain)
    }
}

impl Draft<'_> {
    /// The surfaces of sound and of turned-over elements, with their lines.
    pub(super) fn surfaces(&self, lines: &mut SurfaceLines) -> [Mesh; 2] {
        let [mut sound, mut turned_over] = [Mesh::default(), Mesh::default()];
        if self.position.is_empty() || !self.scene.view.visible.surfaces {
            return [sound, turned_over];
        }
        let hatch = |(soft, nodes): (&f64, Range<usize>)| match self.flat {
            true => Hatch { period: RING * self.scale.line() / self.lens.focal, middle: Some(self.centre(nodes)) },
            false => Hatch { period: HATCH_PERIOD * (soft * self.side), middle: None },
        };
        let hatches = self.bodies.soft_of.iter().zip(self.bodies.nodes()).map(hatch).collect();
        let surfaces = Surfaces { draft: self, hatches };
        let (over, broken) = (&self.snapshot.turned_over, &self.snapshot.broken);
        let fine = &self.bodies.skin.fine;
        let mut sets = boundaries(self.body, over, broken);
        let is_cage = |side: &Side| self.is_covered(side);
        let cages: [Vec<_>; 2] = match fine.is_empty() {
            true => Default::default(),
            false => sets.each_mut().map(|sides| sides.extract_if(.., |side| is_cage(side)).collect()),
        };
        // Turned-over elements inside a carried surface are drawn themselves, others move a part of it, which is drawn.
        if !cages[1].is_empty() {
            let inside =
                over.iter().zip(&self.bodies.inside).map(|(over, inside)| *over && *inside).collect::<Vec<_>>();
            let [_, inside] = boundaries(self.body, &inside, broken);
            sets[1].extend(inside.into_iter().filter(|side| is_cage(side)));
        }
        let total = sets.iter().map(Vec::len).sum();
        surfaces.add(&sets[0], total, LineKind::Edge, &mut sound, lines);
        let of_sound = lines.borders.len();
        surfaces.add(&sets[1], total, LineKind::AlarmEdge, &mut turned_over, lines);
        // A border of both sets counts once.
        let shared: HashSet<_> = lines.borders[of_sound..].iter().filter_map(|border| border.edge).collect();
        let mut at = 0;
        lines.borders.retain(|border| {
            at += 1;
            at > of_sound || border.edge.is_none_or(|edge| !shared.contains(&edge))
        });
        let of_nodes = match &self.shades {
            Some(shades) if !fine.is_empty() => shades.of_nodes(self.body),
            _ => Vec::new(),
        };
        let mut points = self.carried();
        for fine in fine {
            let (own, others) = points.split_at(fine.surface.rest.len());
            surfaces.add_carried(fine, own, [over, broken], &of_nodes, [&mut sound, &mut turned_over], lines);
            points = others;
        }
        if self.scene.view.visible.cage {
            surfaces.add_cage(&cages[0], LineKind::Edge, lines);
            surfaces.add_cage(&cages[1], LineKind::AlarmEdge, lines);
        }
        // Coloured strokes replace them.
        if self.of_nodes.is_empty() {
            lines.drawn.extend(self.bare_lines().into_iter().map(|(ends, over)| {
                let kind = if over { LineKind::AlarmEdge } else { LineKind::Bar };
                self.line(ends, kind, 1.0)
            }));
        }
        [sound, turned_over]
    }

    /// Whether only the outline of the turned-over set is drawn: the edges of many elements would be a scribble.
    pub(super) fn marks_outline(&self) -> bool {
        self.body.elements().len() > MANY_TO_MARK
    }

    /// Whether a carried surface is seen in place of a face. Faces that a broken element uncovers are seen themselves.
    pub(super) fn is_covered(&self, side: &Side) -> bool {
        let (face, faces, broken) = (side.face as usize, self.body.faces(), &self.snapshot.broken);
        let mut beside = [faces.inner[face], faces.outer[face]].into_iter().flatten();
        !beside.any(|element| is_broken(broken, element))
            && self.bodies.skin.fine.iter().any(|fine| fine.faces.contains(&face))
    }

    /// Lines for elements without faces, and whether the element turned over: their edges or, if they have none, lines
    /// from their middle (m).
    pub(super) fn bare_lines(&self) -> Vec<([DVec3; 2], bool)> {
        let mut lines = Vec::new();
        let broken = &self.snapshot.broken;
        for &element in self.bodies.bare.iter().filter(|&&element| !is_broken(broken, element as u32)) {
            let nodes = &self.body.elements()[element];
            let over = self.snapshot.turned_over.get(element).copied().unwrap_or(false);
            let at = |node: u32| self.position[node as usize];
            let edges = self.body.topology().edges_of(element);
            lines.extend(edges.iter().map(|edge| (edge.map(at), over)));
            if edges.is_empty() {
                let middle = nodes.iter().map(|&node| at(node)).sum::<DVec3>() / nodes.len() as f64;
                lines.extend(nodes.iter().map(|&node| ([middle, at(node)], over)));
            }
        }
        lines
    }

    /// Coloured lines: springs, the edges of elements if nothing else would be visible, and elements without faces that
    /// a field or their body colours.
    pub(super) fn strokes(&self) -> Vec<Stroke> {
        let visible = self.scene.view.visible;
        let (over, broken) = (&self.snapshot.turned_over, &self.snapshot.broken);
        let (wire, edges) = (Wire::new(self), &self.bodies.edges);
        let mut strokes = Vec::new();
        if self.position.is_empty() {
            return strokes;
        }
        if visible.surfaces && wire.shades.is_some() {
            strokes.extend(wire.bare(&self.bodies.bare, [over, broken]));
        }
        let springs = self.whole_springs();
        if !visible.surfaces && springs.is_empty() {
            strokes.extend(wire.edges(edges, [over, broken], false));
        }
        let strain = self.composer.strain_of_springs(self.run).map(|scale| (&self.composer.ramp[..], scale));
        let on_skin: Vec<_>;
        let springs = if wire.hides_inside() && !self.flat {
            let holds = |ends: &&[u32; 2]| ends.iter().all(|&node| self.bodies.cage().holds(node));
            on_skin = springs.iter().filter(holds).copied().collect();
            &on_skin[..]
        } else {
            &springs[..]
        };
        if !springs.is_empty() {
            strokes.extend(wire.without_surfaces().springs(springs, strain));
            if !visible.surfaces {
                // Turned-over elements are always marked.
                strokes.extend(wire.edges(edges, [over, broken], true));
            }
        }
        strokes
    }

    /// The springs of the run that are shown and not broken.
    fn whole_springs(&self) -> Cow<'_, [[u32; 2]]> {
        let (all, broken) = (&self.composer.springs[self.run], &self.snapshot.broken_springs);
        if !broken.contains(&true) {
            return Cow::Borrowed(all);
        }
        all.iter().zip(broken).filter(|&(_, broken)| !broken).map(|(&ends, _)| ends).collect()
    }

    /// Nodes.
    pub(super) fn beads(&self) -> Vec<Bead> {
        self.bead_radius().map_or_else(Vec::new, |radius| Wire::new(self).without_surfaces().beads(radius))
    }

    /// The radius of nodes (px), if they are drawn.
    pub(super) fn bead_radius(&self) -> Option<f64> {
        let drawn = self.scene.view.visible.nodes && !self.diverged;
        drawn.then(|| node_radius(self.scale, self.element))
    }
}

/// The radius of a node for elements with edges of a length (px), smaller than usual if they are short.
pub(super) fn node_radius(scale: Scale, element: f64) -> f64 {
    (CLOSE * scale.line()).min((CROWDED * element).max(THIN))
}
