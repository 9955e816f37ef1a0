//! Edges, contours and outlines of bodies, as opacities.

use super::RenderError;
use super::pass::Pass;
use super::pipeline::{LINE_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::segment::{Kind, LineBuffer, Segment, corners, parts, projected};
use super::stage::Stage;
use super::target::Bodies;
use super::visibility::{Visibility, most_lines, most_samples};
use crate::picture::{Panel, Picture, Rectangle};
use std::ops::Range;

/// Whether a panel has lines of turned-over elements.
pub(super) fn has_alarm(panel: &Panel) -> bool {
    panel.lines.iter().any(|line| line.kind.is_alarm())
}

/// The pipelines and the lines of one picture.
#[derive(Debug)]
pub(super) struct Lines {
    module: wgpu::ShaderModule,
    /// One pipeline for each kind, made when it is first needed.
    pipelines: [Option<Pipeline>; Kind::ALL.len()],
    layout: wgpu::BindGroupLayout,
    found: wgpu::BindGroup,
    visibility: Visibility,
    lines: LineBuffer,
    /// The lines of each panel, by kind.
    ranges: Vec<[Range<u32>; Kind::ALL.len()]>,
}

impl Lines {
    pub(super) fn new(stage: &Stage) -> Self {
        let gpu = &stage.gpu;
        let visibility = Visibility::new(gpu);
        let layout = group_layout(gpu, "visibility", &[texture_entry(4, false)]);
        Self {
            module: shader(gpu, "line", &parts()),
            pipelines: [const { None }; Kind::ALL.len()],
            found: bind_textures(gpu, "visibility", &layout, &[(4, &visibility.found())]),
            layout,
            visibility,
            lines: LineBuffer::new(gpu, "lines"),
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines of a picture, and prepares to draw them.
    ///
    /// # Errors
    /// There are more lines than the device can test.
    pub(super) fn write(&mut self, stage: &Stage, picture: &Picture) -> Result<(), RenderError> {
        let gpu = &stage.gpu;
        let segments = self.sampled(picture, most_samples(gpu));
        let most = most_lines::<Segment>(gpu);
        if segments.len() > most {
            return Err(RenderError::Lines { count: segments.len(), most });
        }
        let is_new = self.lines.write(gpu, segments);
        let among = picture.panels.iter().any(|panel| !panel.obstacles.solids.is_empty());
        if self.visibility.write(stage, (&self.lines, is_new), &self.ranges, among) {
            self.found = bind_textures(gpu, "visibility", &self.layout, &[(4, &self.visibility.found())]);
        }
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        for (at, kind) in Kind::ALL.into_iter().enumerate() {
            if self.ranges.iter().all(|ranges| ranges[at].is_empty()) {
                continue;
            }
            let build = || {
                let [_, entry] = kind.entries();
                let recipe = Recipe {
                    groups: &[&stage.panels.layout, &self.layout, &self.lines.layout],
                    blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
                    ..Recipe::lines(entry, &self.module, ["segment", entry], LINE_FORMAT)
                };
                recipe.build(gpu)
            };
            self.pipelines[at].get_or_insert_with(build);
        }
        Ok(())
    }

    /// The lines of a picture by panel and kind. Each line has a sample of its visibility for each pixel of its length,
    /// or fewer if the samples exceed `most`.
    fn sampled(&mut self, picture: &Picture, most: u64) -> Vec<Segment> {
        let mut segments: Vec<Segment> = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let projected = projected(panel);
            self.ranges.push(Kind::ALL.map(|kind| {
                let start = segments.len() as u32;
                segments.extend(panel.lines.iter().filter(|line| Kind::of(line) == kind).filter_map(&projected));
                start..segments.len() as u32
            }));
        }
        let length: f64 = segments.iter().map(|segment| f64::from(segment.length())).sum();
        let left = most.saturating_sub(2 * segments.len() as u64).max(1);
        let apart = (length / left as f64).max(1.0);
        let mut first = 0;
        for segment in &mut segments {
            let count = ((f64::from(segment.length()) / apart).ceil() as u32 + 1).max(2);
            segment.sample(first..first + count);
            first += count;
        }
        segments
    }

    /// Tests the visibility of all lines. The bodies must have been drawn.
    pub(super) fn test(
        &self,
        commands: &mut wgpu::CommandEncoder,
        stage: &Stage,
        bodies: &Bodies,
        places: &[Rectangle],
    ) {
        self.visibility.find(commands, stage, bodies, places);
    }

    /// Draws the lines of all panels. Their visibility must have been tested.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, stage: &Stage, places: &[Rectangle]) {
        pass.set_bind_group(1, &self.found, &[]);
        pass.set_bind_group(2, &self.lines.group, &[]);
        for (at, pipeline) in self.pipelines.iter().enumerate() {
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            stage.panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
                pass.draw(corners(&self.ranges[panel][at]), 0..1);
            });
        }
    }
}
