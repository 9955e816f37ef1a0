//! Edges, contours and outlines of bodies, as opacities.

use super::RenderError;
use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{LINE_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::segment::{Kind, Segment, bind_lines, corners, lines_layout, parts, projected};
use super::target::Bodies;
use super::visibility::{Visibility, most_lines, most_samples};
use crate::gpu::{Gpu, GrowingBuffer};
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
    found: Option<wgpu::BindGroup>,
    visibility: Visibility,
    segments: GrowingBuffer<Segment>,
    lines_layout: wgpu::BindGroupLayout,
    lines: wgpu::BindGroup,
    /// The lines of each panel, by kind.
    ranges: Vec<[Range<u32>; Kind::ALL.len()]>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let segments = GrowingBuffer::new(gpu, "lines", wgpu::BufferUsages::STORAGE, 1024);
        let lines_layout = lines_layout(gpu);
        Self {
            module: shader(gpu, "line", &parts()),
            pipelines: [const { None }; Kind::ALL.len()],
            layout: group_layout(gpu, "visibility", &[texture_entry(4, false)]),
            found: None,
            visibility: Visibility::new(gpu),
            lines: bind_lines(gpu, &lines_layout, segments.buffer()),
            lines_layout,
            segments,
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines of a picture, and prepares to draw them, with or without solid obstacles.
    ///
    /// # Errors
    /// There are more lines than the device can test.
    pub(super) fn write(
        &mut self,
        gpu: &Gpu,
        panels: &Panels,
        bodies: &Bodies,
        picture: &Picture,
        among: bool,
    ) -> Result<(), RenderError> {
        let segments = self.sampled(picture, most_samples(gpu));
        let most = most_lines::<Segment>(gpu);
        if segments.len() > most {
            return Err(RenderError::Lines { count: segments.len(), most });
        }
        let is_new = self.segments.write(gpu, segments);
        if is_new {
            self.lines = bind_lines(gpu, &self.lines_layout, self.segments.buffer());
        }
        let lines = (self.segments.contents(), self.segments.buffer(), is_new);
        if self.visibility.write(gpu, panels, bodies, lines, &self.ranges, among) || self.found.is_none() {
            self.found = Some(bind_textures(gpu, "visibility", &self.layout, &[(4, &self.visibility.found())]));
        }
        for (at, kind) in Kind::ALL.into_iter().enumerate() {
            if self.ranges.iter().any(|ranges| !ranges[at].is_empty()) {
                self.prepare(gpu, panels, kind);
            }
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

    /// Makes the pipeline of a kind.
    fn prepare(&mut self, gpu: &Gpu, panels: &Panels, kind: Kind) {
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let build = || {
            let recipe = Recipe {
                groups: &[&panels.layout, &self.layout, &self.lines_layout],
                blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
                ..Recipe::lines(kind.entry(), &self.module, ["segment", kind.entry()], LINE_FORMAT)
            };
            recipe.build(gpu)
        };
        self.pipelines[kind as usize].get_or_insert_with(build);
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.visibility.retarget(gpu, bodies);
    }

    /// Tests the visibility of all lines, with solid obstacles if there are any. The bodies must have been drawn.
    pub(super) fn test(
        &self,
        gpu: &Gpu,
        commands: &mut wgpu::CommandEncoder,
        panels: &Panels,
        places: &[Rectangle],
        among: bool,
    ) {
        self.visibility.find(gpu, commands, panels, places, among);
    }

    /// Draws the lines of all panels. Their visibility must have been tested.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_bind_group(1, self.found.as_ref(), &[]);
        pass.set_bind_group(2, &self.lines, &[]);
        for (at, pipeline) in self.pipelines.iter().enumerate() {
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
                pass.draw(corners(&self.ranges[panel][at]), 0..1);
            });
        }
    }
}
