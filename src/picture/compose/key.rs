//! The contents of the key of a picture: colours, lines, marks and arrows.

use super::Composer;
use crate::look::{BODIES, ColourScale};
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::legend::{Bar, Legend, Sample, SampleKind};
use crate::picture::wire::spring_strain;
use crate::picture::{Framing, arrows, number};
use crate::runner::{Frame, RunFrame};
use std::borrow::Cow;

impl Composer<'_> {
    /// Samples of arrows, lines and marks with their meanings.
    pub(super) fn samples(&self, legend: Legend, viewport: Rectangle, seen: &Framing, scale: Scale) -> Vec<Sample<'_>> {
        let arrow = self.scene.view.visible.displacements.then(|| self.key_arrow(legend, viewport, seen, scale));
        let ghost =
            self.ghost().map(|(name, colour)| Sample { names: vec![name.into()], kind: SampleKind::Ghost(colour) });
        let path: Vec<_> = self.path_names().into_iter().map(Cow::from).collect();
        let path = Some(path).filter(|names| !names.is_empty());
        let colours = self.traced.iter().map(|series| self.scene.runs[series.run].line(&self.palette).colour).collect();
        let path = path.map(|names| Sample { names, kind: SampleKind::Path(colours) });
        arrow.into_iter().chain(ghost).chain(path).chain(self.samples_of_bodies()).collect()
    }

    /// A sample of each colour of bodies, with the names of its bodies.
    fn samples_of_bodies(&self) -> impl Iterator<Item = Sample<'_>> {
        let (names, palette) = (self.scene.view.coloured_bodies(), &self.palette);
        let colours = if self.scene.is_lit() { palette.bodies } else { palette.bodies_flat };
        colours.into_iter().enumerate().take(names.len()).map(move |(at, colour)| {
            let names: Vec<_> = names.iter().skip(at).step_by(BODIES).map(String::as_str).collect();
            Sample { names: vec![names.join(", ").into()], kind: SampleKind::Body([colour, palette.outline]) }
        })
    }

    /// The colour scale of a frame, if there is one.
    pub(super) fn bar(&self, frame: &Frame) -> Option<Bar<'_>> {
        let colour = self.scene.view.colour.as_ref()?;
        let of_springs: Vec<_> = frame.runs.iter().map(|run| self.strain_of_springs(run.run)).collect();
        let values = frame.runs.iter().zip(&of_springs).flat_map(|(run, of_springs)| match of_springs {
            Some(scale) => self.strains(run, scale),
            None => run.shown().field.clone(),
        });
        let (field, all) = (colour.field, of_springs.len());
        let definition = match of_springs.iter().flatten().count() {
            0 => field.definition(),
            count if count == all => "change of length over length at rest",
            _ => "of springs: change of length over length at rest",
        };
        let name = match colour.to {
            Some(to) => format!("{} to {}", field.name(), self.scene.runs[to].name),
            None => field.name().to_owned(),
        };
        // The other run itself is plain.
        let is_shown = colour.to.is_some_and(|to| frame.runs.iter().any(|run| run.run == to));
        let definition = if is_shown { "between equal nodes; that run is plain" } else { definition };
        Some(Bar::new(name, (field.unit(), definition), colour.range, self.extent, &self.ramp, values))
    }

    /// The strains of a run's springs on a scale.
    fn strains(&self, run: &RunFrame, scale: &ColourScale) -> Vec<f64> {
        let (body, position) = (self.bodies(run.run).body(), &run.shown().position);
        if position.len() != body.len() {
            return Vec::new();
        }
        self.springs[run.run].iter().map(|&ends| scale.of_spring(spring_strain(body, position, ends))).collect()
    }

    /// The key's arrow with its length in words.
    fn key_arrow(&self, legend: Legend, viewport: Rectangle, seen: &Framing, scale: Scale) -> Sample<'_> {
        let pixels = self.pixels_a_metre(viewport, seen, scale);
        let times = self.scene.view.arrow_scale;
        let metres = number::round_below(legend.arrow_length() / (pixels * times));
        let size = arrows::size(pixels * self.scene.view.side, scale.unit);
        let name = format!("displacement {}", number::round_length(metres, self.extent));
        Sample { names: vec![name.into()], kind: SampleKind::Arrow([metres * pixels * times, size]) }
    }
}
