//! The contents of the key of a picture: colours, lines, marks and arrows.

use super::Composer;
use super::overlay::{self, KeyPlace};
use crate::look::{BODIES, ColourScale};
use crate::picture::chart::axis::{Kind, Stretch};
use crate::picture::compose::wire::spring_strain;
use crate::picture::legend::{Bar, MOST_TICKS, Sample, SampleKind};
use crate::runner::{Frame, RunFrame};

impl Composer<'_> {
    /// Samples of overlays and bodies with their meanings.
    pub(super) fn samples(&self, place: &KeyPlace) -> Vec<Sample> {
        overlay::samples(self, place).chain(self.samples_of_bodies()).collect()
    }

    /// A sample of each colour of bodies and regions, with their names. A single body needs none.
    fn samples_of_bodies(&self) -> impl Iterator<Item = Sample> {
        let (names, palette) = (self.scene.view.coloured_bodies(), &self.palette);
        let colours = if self.scene.is_lit() { palette.bodies } else { palette.bodies_flat };
        colours.into_iter().enumerate().take(names.len()).filter_map(move |(at, colour)| {
            let names = names.iter().skip(at).step_by(BODIES).map(String::as_str);
            let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
            let kind = SampleKind::Body([colour, palette.outline]);
            (!names.is_empty()).then(|| Sample { names: vec![names.join(", ")], kind })
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
            _ => "springs: change of length over length; others: RMS distance over size",
        };
        let name = match colour.to {
            Some(to) => format!("{} to {}", field.name(), self.scene.runs[to].name),
            None => field.name().to_owned(),
        };
        // The other run itself is plain.
        let is_shown = colour.to.is_some_and(|to| frame.runs.iter().any(|run| run.run == to));
        let definition = if is_shown { "between equal nodes; that run is plain" } else { definition };
        let [low, high] = colour.range;
        let beyond = values.fold([false; 2], |[below, above], value| [below || value < low, above || value > high]);
        let axis = Stretch::new(Kind::Fixed, colour.range, field.unit(), self.extent, MOST_TICKS);
        Some(Bar { name, definition, axis, ramp: &self.ramp, beyond })
    }

    /// The strains of a run's springs on a scale.
    fn strains(&self, run: &RunFrame, scale: &ColourScale) -> Vec<f64> {
        let (body, position) = (self.bodies(run.run).body(), &run.shown().position);
        if position.len() != body.len() {
            return Vec::new();
        }
        self.springs[run.run].iter().map(|&ends| scale.of_spring(spring_strain(body, position, ends))).collect()
    }
}
