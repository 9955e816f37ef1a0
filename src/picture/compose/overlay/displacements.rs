//! Displacements: an arrow to each node from its place in the best fit of the rest shape.

use super::KeyPlace;
use crate::picture::compose::Composer;
use crate::picture::compose::body::node_radius;
use crate::picture::compose::draft::Draft;
use crate::picture::legend::Sample;
use crate::picture::order::farthest_first;
use crate::picture::{Item, arrows, number};

/// An arrow with its length in words.
pub(super) fn samples(composer: &Composer<'_>, place: &KeyPlace) -> Vec<Sample> {
    let (pixels, scale) = (place.pixels, composer.scene.view.arrow_scale);
    let metres = number::round_below(place.legend.arrow_length() / (pixels * scale));
    let length = number::round_length(metres, composer.extent);
    vec![place.arrow(
        composer,
        vec![format!("displacement {length}"), length],
        metres * pixels * scale,
        arrows::with_halo,
    )]
}

/// Arrows of displacements, the farthest first, in the colour of text as in the key: paths and fields have others. Arrows
/// that would be specks on the nodes are left out.
pub(super) fn draw(draft: &Draft<'_>, marks: &mut Vec<Item>) {
    let view = &draft.scene.view;
    if !view.visible.displacements || draft.diverged || draft.position.is_empty() {
        return;
    }
    let node = if view.visible.nodes { node_radius(draft.scale, draft.element) } else { 0.0 };
    let arrows = draft.facing_bearers().into_iter().filter_map(|(bearer, opacity)| {
        let placement = draft.snapshot.placements[draft.bodies.assembly.body_of_node(bearer as usize)];
        let start = placement.place(draft.body.rest()[bearer as usize]);
        let end = start + view.arrow_scale * (draft.position[bearer as usize] - start);
        draft.arrow([start, end], 2.0 * node, opacity, arrows::with_halo)
    });
    marks.extend(farthest_first(arrows.collect()));
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
