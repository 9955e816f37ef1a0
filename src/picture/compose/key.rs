//! What the key of a picture says: colours, lines, marks and arrows.

use super::Composer;
use crate::look::StrainScale;
use crate::picture::layout::{Rectangle, Scale};
use crate::picture::legend::{Bar, Legend, Sample, SampleKind};
use crate::picture::wire::spring_strain;
use crate::picture::{Framing, arrows, number};
use crate::sim::snapshot::Frame;
use std::borrow::Cow;

impl Composer<'_> {
    /// What lines and marks mean.
    pub(super) fn samples(&self) -> Vec<Sample<'_>> {
        let ghost =
            self.ghost().map(|(name, colour)| Sample { names: vec![name.into()], kind: SampleKind::Ghost(colour) });
        let path: Vec<_> = self.path_names().into_iter().map(Cow::from).collect();
        let path = Some(path).filter(|names| !names.is_empty());
        let colours = self.traced.iter().map(|series| self.scene.runs[series.run].line(&self.palette).colour).collect();
        let path = path.map(|names| Sample { names, kind: SampleKind::Path(colours) });
        ghost.into_iter().chain(path).collect()
    }

    /// The scales of colours in a frame.
    pub(super) fn bars(&self, frame: &Frame) -> Vec<Bar<'_>> {
        let view = &self.scene.view;
        let of_field = view.colour.as_ref().map(|colour| {
            let values = frame.runs.iter().flat_map(|run| &run.shown().field).copied();
            let field = colour.field;
            let [name, definition] = self.field_name.unwrap_or([field.name(), field.definition()]);
            Bar::new([name, field.unit(), definition], colour.range, self.extent, &self.ramp, values)
        });
        let body = &*self.scene.body;
        let of_springs = view.spring_strain.map(|StrainScale { range, .. }| {
            let whole = frame.runs.iter().filter(|run| run.shown().position.len() == body.len());
            let strains = whole.flat_map(|run| {
                let springs = self.scene.runs.get(run.run).map_or(&[][..], |run| run.model.springs());
                springs.iter().map(|&ends| spring_strain(body, &run.shown().position, ends))
            });
            Bar::new(
                ["spring strain", "", "change of length over length at rest"],
                range,
                self.extent,
                &self.spring_ramp,
                strains,
            )
        });
        of_field.into_iter().chain(of_springs).collect()
    }

    /// What the arrow of the key stands for, in words, its length (px), and how large it is beside those of the reference picture.
    pub(super) fn key_arrow(
        &self,
        legend: Legend,
        viewport: Rectangle,
        seen: &Framing,
        scale: Scale,
    ) -> (String, [f64; 2]) {
        let pixels = self.pixels_a_metre(viewport, seen, scale);
        let times = self.scene.view.arrow_scale;
        let metres = legend.arrow_metres(pixels * times);
        let size = arrows::size(pixels * self.scene.view.side, scale.unit);
        (number::round_length(metres, self.extent), [metres * pixels * times, size])
    }
}
