//! Overlays: marks and curves over the bodies of panels, with their samples in the key. A new one is one file here, one line
//! in [`MARKS`] or [`CURVES`], one in [`SAMPLES`] and [`View::explained`] if it has samples, and its key in [`View`].

mod contacts;
mod displacements;
mod ghost;
mod grips;
mod height;
mod loads;
mod paths;

use super::Composer;
use super::draft::Draft;
use crate::colour::Colour;
use crate::look::{Ghost, View};
use crate::picture::arrows::{self, DrawArrow};
use crate::picture::layout::steps::{FREE, RING};
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::legend::{Legend, Sample, SampleKind};
use crate::picture::{Framing, Item};
use glam::DVec3;

/// Radius of a dot, in radii of a ring; its least one (px).
const DOT: f64 = 0.5;
const LEAST_DOT: f64 = 0.6;

/// Draws an overlay over a panel.
type Draw = fn(&Draft<'_>, &mut Vec<Item>);

/// The overlays below hairlines and the words of panels, in the order in which they are drawn.
pub(super) const MARKS: [Draw; 5] = [height::draw, grips::draw, displacements::draw, loads::draw, contacts::draw];
/// The overlays above them.
pub(super) const CURVES: [Draw; 2] = [ghost::draw, paths::draw];

/// The samples of an overlay in a key.
type Samples = fn(&Composer<'_>, &KeyPlace) -> Vec<Sample>;

/// Those of the overlays that keys explain, in the order of [`View::explained`].
const SAMPLES: [Samples; 5] =
    [displacements::samples, loads::samples, contacts::samples, ghost::samples, paths::samples];

/// A key, and the scale of the panels that it explains.
pub(in crate::picture) struct KeyPlace {
    legend: Legend,
    /// Pixels per metre at the target of a panel.
    pixels: f64,
    /// The size of arrows, relative to the reference picture.
    size: f64,
}

impl KeyPlace {
    /// A key, with the first panel that it explains.
    pub(super) fn new(
        composer: &Composer<'_>,
        legend: Legend,
        viewport: Rectangle,
        framing: &Framing,
        scale: Scale,
    ) -> Self {
        let pixels = composer.pixels_a_metre(viewport, framing, scale);
        Self { legend, pixels, size: arrows::size(pixels * composer.scene.view.side, scale.unit) }
    }

    /// The sample of an arrow of a length (px), with wordings of its meaning.
    fn arrow(&self, composer: &Composer<'_>, names: Vec<String>, length: f64, draw: DrawArrow) -> Sample {
        Sample { names, kind: SampleKind::Arrow([length, self.size], composer.palette.text, draw) }
    }
}

impl Draft<'_> {
    /// An arrow between two points (m), with its depth; `None` if it would be a speck, or is not longer than `shortest` (px). Where it leaves the
    /// room between words, its shaft has a break: it is longer than it is drawn.
    fn arrow(&self, [start, end]: [DVec3; 2], shortest: f64, opacity: f64, draw: DrawArrow) -> Option<(f64, Item)> {
        let size = arrows::size(self.element, self.scale.unit);
        let (to, depth) = self.lens.project(end)?;
        let shortest = shortest_arrow(size).max(shortest);
        let whole = [self.pixel(start)?, to.into()];
        let is_short = whole[0].distance(whole[1]) < arrows::SHORT * size;
        let (ends, part) = arrows::inside(whole, if is_short { self.viewport } else { self.room }, size, shortest)?;
        let palette = &self.composer.palette;
        let arrow = draw(ends, size, palette.text, palette.background).into_iter();
        let item = match ends == whole {
            true => Item::part("arrow", arrow.collect::<Vec<_>>()),
            false => {
                let broken = arrows::broken(ends, size, palette.text, palette.background);
                Item::part("broken arrow", arrow.chain(broken).collect::<Vec<_>>())
            }
        };
        Some((depth, item.faded(opacity * part)?))
    }

    /// A dot at a point (m), where it is seen, not larger than `most` (px).
    fn dot(&self, point: DVec3, most: f64, colour: Colour) -> Option<Item> {
        let radius = (DOT * RING * arrows::size(self.element, self.scale.unit)).min(most).max(LEAST_DOT);
        let pixel = self.pixel(point).filter(|&pixel| self.holds(pixel, radius))?;
        Some(Item::rimmed(pixel, radius, colour, self.composer.palette.background))
    }
}

/// The length that arrows of a size exceed (px).
fn shortest_arrow(size: f64) -> f64 {
    (RING * size).max(FREE)
}

/// The samples of overlays in a key.
pub(super) fn samples(composer: &Composer<'_>, place: &KeyPlace) -> impl Iterator<Item = Sample> {
    let explained = SAMPLES.into_iter().zip(composer.scene.view.explained()).filter(|&(_, is_explained)| is_explained);
    explained.flat_map(move |(samples, _)| samples(composer, place))
}

/// Whether overlays of a view have the colours of runs.
pub(super) fn have_colours_of_runs(view: &View) -> bool {
    matches!(view.ghost, Some(Ghost::Run(_))) || !view.paths.is_empty()
}
