//! The outline of another state over the body of a panel.

use super::KeyPlace;
use crate::colour::Colour;
use crate::look::Ghost;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::steps::{SHORT, STRONG, TICK};
use crate::picture::legend::{Sample, SampleKind};
use crate::picture::narrow::narrow;
use crate::picture::page::Pen;
use crate::picture::{Item, arrows, ghost};
use crate::sim::Status;
use glam::{DVec2, DVec3};

/// The opacity of the casing of outlines.
const HALO_ALPHA: f64 = 0.65;

/// A dashed line with the name of what it outlines.
pub(super) fn samples(composer: &Composer<'_>, _: &KeyPlace) -> Vec<Sample> {
    let sample = |(name, colour)| Sample { names: vec![name], kind: SampleKind::Ghost(colour) };
    look(composer).map(sample).into_iter().collect()
}

/// The outline of the rest shape, or of the body of another run at the same moment.
pub(super) fn draw(draft: &Draft<'_>, curves: &mut Vec<Item>) {
    let Some((_, colour)) = look(draft.composer) else { return };
    match draft.scene.view.ghost {
        Some(Ghost::Rest) => {
            let bodies = &draft.scene.runs[draft.run].bodies;
            draft.outline(&bodies.placed(&draft.snapshot.placements), colour, curves);
        }
        Some(Ghost::Run(run)) if run != draft.run => {
            let other = draft.others.iter().find(|other| other.run == run);
            if let Some(other) = other.filter(|other| other.snapshot.status == Status::Ok) {
                draft.outline(&other.snapshot.position, colour, curves);
            }
        }
        _ => {}
    }
}

/// The name and the colour of the scene's ghosts, if it has any.
fn look(composer: &Composer<'_>) -> Option<(String, Colour)> {
    Some(match composer.scene.view.ghost? {
        Ghost::Rest => ("rest shape, best fit".to_owned(), composer.palette.second_text),
        Ghost::Run(run) => {
            (composer.scene.runs[run].name.clone(), composer.scene.runs[run].line(&composer.palette).colour)
        }
    })
}

impl Draft<'_> {
    /// The outline of the body with its nodes at other positions (m).
    fn outline(&self, position: &[DVec3], colour: Colour, curves: &mut Vec<Item>) {
        if self.diverged || position.len() != self.body.len() {
            return;
        }
        let skin = &self.bodies.skin;
        let node = |at: u32| skin.nodes[at as usize];
        let mut triangles: Vec<_> = skin.triangles.iter().map(|corners| corners.map(node)).collect();
        // All nodes, and after them the points of carried surfaces.
        let mut points = position.to_vec();
        for fine in &skin.fine {
            let first = points.len() as u32;
            triangles.extend(fine.surface.triangles.iter().map(|triangle| triangle.map(|point| first + point)));
            fine.place(position, &mut points);
        }
        let pixels = points.iter().map(|&at| self.pixel(at)).collect::<Option<Vec<_>>>();
        let Some(pixels) = pixels else { return };
        if let Some(ends) = self.way_to_unseen(&pixels) {
            curves.extend(arrows::with_halo(ends, self.scale.unit, colour, self.composer.palette.background));
            return;
        }
        let bars = self.bodies.bare.iter().flat_map(|&element| self.body.topology().edges_of(element));
        let path = ghost::outline(&pixels, &triangles, &bars.collect::<Vec<_>>(), self.around(self.room));
        let [width, halo] = [STRONG, TICK].map(|width| narrow(width * self.scale.line()));
        let dash = ghost::DASH.map(|length| narrow(length * self.scale.line())).to_vec();
        let casing = Item::stroke(path.clone(), Pen::solid(halo), (self.composer.palette.background, HALO_ALPHA));
        let line = Item::stroke(path, Pen { dash, round: false, width }, colour);
        curves.push(Item::inside(self.room, vec![casing, line]));
    }

    /// The ends of an arrow at the border of the panel towards what lies wholly beyond it; `None` for what is seen.
    fn way_to_unseen(&self, pixels: &[DVec2]) -> Option<[DVec2; 2]> {
        let [left, top, width, height] = self.room.map(f64::from);
        let (low, high) = (DVec2::new(left, top), DVec2::new(left + width, top + height));
        let least = pixels.iter().copied().reduce(DVec2::min)?;
        let most = pixels.iter().copied().reduce(DVec2::max)?;
        if most.cmpge(low).all() && least.cmple(high).all() {
            return None;
        }
        let centre = low.midpoint(high);
        let way = pixels.iter().sum::<DVec2>() / pixels.len() as f64 - centre;
        let end = centre + way * ((high - centre) / way.abs()).min_element().min(1.0);
        way.is_finite().then(|| [end - way.normalize_or_zero() * SHORT * self.scale.line(), end])
    }
}
