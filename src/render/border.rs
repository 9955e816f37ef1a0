//! Smooth borders of surfaces, in pixels that a line between two colours crosses.

use super::RenderError;
use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{BORDER_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::segment::{self, Segment, bind_lines, corners, lines_layout};
use super::target::Bodies;
use super::visibility::most_bound;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Line, Picture, Rectangle};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/border.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 7] {
    let [panel, segment, line] = segment::parts();
    [panel, segment, super::TAPS_SHADER, super::BODIES_SHADER, super::TURNED_OVER_SHADER, line, SHADER]
}

/// The pipelines and the borders of one picture.
#[derive(Debug)]
pub(super) struct Borders {
    module: wgpu::ShaderModule,
    /// Pipelines for turned-over sets and for others, made when they are first needed. With one for both, a software
    /// driver would read both depths for each border.
    pipelines: [Option<Pipeline>; 2],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
    segments: GrowingBuffer<Segment>,
    lines_layout: wgpu::BindGroupLayout,
    lines: wgpu::BindGroup,
    /// The borders of each panel, in runs that share a pipeline.
    runs: Vec<Vec<(usize, Range<u32>)>>,
}

impl Borders {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let entries = [texture_entry(0, false), texture_entry(1, true), texture_entry(2, true)];
        let layout = group_layout(gpu, "bodies", &entries);
        let segments = GrowingBuffer::new(gpu, "borders", wgpu::BufferUsages::STORAGE, 1024);
        let lines_layout = lines_layout(gpu);
        let lines = bind_lines(gpu, &lines_layout, segments.buffer());
        let module = shader(gpu, "border", &parts());
        let pipelines = [None, None];
        Self { module, pipelines, layout, textures: None, segments, lines_layout, lines, runs: Vec::new() }
    }

    /// Makes a pipeline.
    fn prepare(&mut self, gpu: &Gpu, panels: &Panels, at: usize) {
        let sum = wgpu::BlendComponent { dst_factor: wgpu::BlendFactor::One, ..wgpu::BlendComponent::REPLACE };
        let entry = ["border_colour", "alarm_border_colour"][at];
        let build = || {
            let recipe = Recipe {
                groups: &[&panels.layout, &self.layout, &self.lines_layout],
                blend: Some(wgpu::BlendState { color: sum, alpha: sum }),
                ..Recipe::lines(entry, &self.module, ["segment", entry], BORDER_FORMAT)
            };
            recipe.build(gpu)
        };
        self.pipelines[at].get_or_insert_with(build);
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(0, &bodies.colour), (1, &bodies.depth), (2, &bodies.alarm_depth)];
        self.textures = Some(bind_textures(gpu, "bodies", &self.layout, &views));
    }

    /// Uploads the borders of a picture.
    ///
    /// # Errors
    /// There are more borders than the device can bind.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) -> Result<(), RenderError> {
        let mut segments = Vec::new();
        self.runs.clear();
        for panel in &picture.panels {
            let projected = segment::projected(panel);
            let mut run = |borders: &[Line]| {
                let start = segments.len() as u32;
                segments.extend(borders.iter().filter_map(&projected));
                (usize::from(borders[0].kind.is_alarm()), start..segments.len() as u32)
            };
            let of_one = panel.borders.chunk_by(|one, other| one.kind.is_alarm() == other.kind.is_alarm());
            self.runs.push(of_one.map(&mut run).filter(|(_, lines)| !lines.is_empty()).collect());
        }
        let most = most_bound::<Segment>(gpu);
        if segments.len() > most {
            return Err(RenderError::Lines { count: segments.len(), most });
        }
        for at in 0..self.pipelines.len() {
            if self.runs.iter().flatten().any(|(pipeline, _)| *pipeline == at) {
                self.prepare(gpu, panels, at);
            }
        }
        if self.segments.write(gpu, segments) {
            self.lines = bind_lines(gpu, &self.lines_layout, self.segments.buffer());
        }
        Ok(())
    }

    /// Draws the borders of all panels.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_bind_group(1, self.textures.as_ref(), &[]);
        pass.set_bind_group(2, &self.lines, &[]);
        panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
            for (pipeline, lines) in &self.runs[panel] {
                pass.set_pipeline(self.pipelines[*pipeline].as_ref().expect("prepared"));
                pass.draw(corners(lines), 0..1);
            }
        });
    }
}
