//! Smooth borders of surfaces, in pixels that a line between two colours crosses.

use super::RenderError;
use super::pass::Pass;
use super::pipeline::{BORDER_FORMAT, Pipeline, Recipe, shader};
use super::segment::{self, LineBuffer, corners};
use super::stage::Stage;
use super::target::Bodies;
use super::visibility::most_bound;
use crate::picture::{Line, Picture, Rectangle};
use std::collections::HashMap;
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/border.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 6] {
    let [panel, segment, line] = segment::parts();
    [panel, segment, super::BODIES_SHADER, super::TAPS_SHADER, line, SHADER]
}

/// The pipelines and the borders of one picture.
#[derive(Debug)]
pub(super) struct Borders {
    module: wgpu::ShaderModule,
    /// Pipelines for turned-over sets and for others, made when they are first needed. With one for both, a software
    /// driver would read both depths for each border.
    pipelines: HashMap<&'static str, Pipeline>,
    lines: LineBuffer,
    /// The borders of each panel, in runs that share a pipeline.
    runs: Vec<Vec<(&'static str, Range<u32>)>>,
}

impl Borders {
    pub(super) fn new(stage: &Stage) -> Self {
        let module = shader(&stage.gpu, "border", &parts());
        let lines = LineBuffer::new(&stage.gpu, "borders");
        Self { module, pipelines: HashMap::new(), lines, runs: Vec::new() }
    }

    /// Uploads the borders of a picture.
    ///
    /// # Errors
    /// There are more borders than the device can bind.
    pub(super) fn write(&mut self, stage: &Stage, picture: &Picture) -> Result<(), RenderError> {
        let mut segments = Vec::new();
        self.runs.clear();
        for panel in &picture.panels {
            let projected = segment::projected(panel);
            let mut run = |borders: &[Line]| {
                let start = segments.len() as u32;
                segments.extend(borders.iter().filter_map(&projected));
                let entry = if borders[0].kind.is_alarm() { "alarm_border_colour" } else { "border_colour" };
                (entry, start..segments.len() as u32)
            };
            let of_one = panel.borders.chunk_by(|one, other| one.kind.is_alarm() == other.kind.is_alarm());
            self.runs.push(of_one.map(&mut run).filter(|(_, lines)| !lines.is_empty()).collect());
        }
        let most = most_bound::<segment::Segment>(&stage.gpu);
        if segments.len() > most {
            return Err(RenderError::Lines { count: segments.len(), most });
        }
        self.lines.write(&stage.gpu, segments);
        let sum = wgpu::BlendComponent { dst_factor: wgpu::BlendFactor::One, ..wgpu::BlendComponent::REPLACE };
        for &(entry, _) in self.runs.iter().flatten() {
            let build = || {
                let recipe = Recipe {
                    groups: &[&stage.panels.layout, &stage.layouts.drawn, &self.lines.layout],
                    blend: Some(wgpu::BlendState { color: sum, alpha: sum }),
                    ..Recipe::lines(entry, &self.module, ["segment", entry], BORDER_FORMAT)
                };
                recipe.build(&stage.gpu)
            };
            self.pipelines.entry(entry).or_insert_with(build);
        }
        Ok(())
    }

    /// Draws the borders of all panels.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, stage: &Stage, bodies: &Bodies, places: &[Rectangle]) {
        pass.set_bind_group(1, &bodies.drawn, &[]);
        pass.set_bind_group(2, &self.lines.group, &[]);
        stage.panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
            for (entry, lines) in &self.runs[panel] {
                pass.set_pipeline(&self.pipelines[entry]);
                pass.draw(corners(lines), 0..1);
            }
        });
    }
}
