//! Displacements: an arrow to each node from its place in the best fit of the rest shape.

use super::{KeyPlace, Overlay};
use crate::look::View;
use crate::picture::compose::Composer;
use crate::picture::compose::body::node_radius;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::steps::{FREE, RING};
use crate::picture::legend::{Sample, SampleKind};
use crate::picture::order::farthest_first;
use crate::picture::skin::Skin;
use crate::picture::{Item, arrows, number};
use crate::sim::Body;

/// Arrows of displacements.
pub(super) struct Displacements;

impl Overlay for Displacements {
    fn is_explained(&self, view: &View) -> bool {
        view.visible.displacements
    }

    /// An arrow with its length in words.
    fn sample<'c>(&self, composer: &'c Composer<'_>, place: &KeyPlace<'_>) -> Option<Sample<'c>> {
        let view = &composer.scene.view;
        let pixels = composer.pixels_a_metre(place.viewport, place.framing, place.scale);
        let metres = number::round_below(place.legend.arrow_length() / (pixels * view.arrow_scale));
        let size = arrows::size(pixels * view.side, place.scale.unit);
        let names = vec![format!("displacement {}", number::round_length(metres, composer.extent)).into()];
        Some(Sample { names, kind: SampleKind::Arrow([metres * pixels * view.arrow_scale, size]) })
    }

    /// The farthest first, in the colour of text as in the key: paths and fields have others. Arrows that would be specks on
    /// the nodes are left out.
    fn draw(&self, draft: &Draft<'_>, marks: &mut Vec<Item>) {
        let (view, palette) = (&draft.scene.view, &draft.composer.palette);
        if !view.visible.displacements || draft.diverged || draft.position.is_empty() {
            return;
        }
        let size = arrows::size(draft.element, draft.scale.unit);
        let node = if view.visible.nodes { node_radius(draft.scale, draft.element) } else { 0.0 };
        let shortest = (RING * size).max(FREE).max(2.0 * node);
        let arrows = draft.facing_bearers().into_iter().filter_map(|(node, opacity)| {
            let placement = draft.run.snapshot.placements[draft.bodies.assembly().body_of_node(node as usize)];
            let start = placement.place(draft.body.rest()[node as usize]);
            let end = start + view.arrow_scale * (draft.position[node as usize] - start);
            let (to, depth) = draft.lens.project(end)?;
            let (ends, part) = arrows::inside([draft.pixel(start)?, to.into()], draft.clear, shortest)?;
            Some((depth, arrows::arrow(ends, size, palette.text, palette.background).faded(opacity * part)?))
        });
        marks.extend(farthest_first(arrows.collect()));
    }
}

impl Draft<'_> {
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
}

/// The nodes with arrows: those on the surface, and those of elements without faces.
pub(in crate::picture::compose) fn bearers(body: &Body, skin: &Skin, bare: &[usize]) -> Vec<u32> {
    let of_bare = bare.iter().flat_map(|&element| &body.elements()[element]);
    let mut nodes: Vec<u32> = skin.nodes.iter().chain(of_bare).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    arrows::bearers(&nodes)
}
