//! Smooth borders of surfaces: pixels that a line crosses at which colours change.

use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{
    BORDER_FORMAT, Pipeline, Recipe, bind_textures, for_instances, group_layout, shader, texture_entry,
};
use super::segment::{self, ATTRIBUTES, Segment};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Picture, Rectangle};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/border.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 7] {
    let [panel, segment, line] = segment::parts();
    [panel, segment, super::TAPS_SHADER, super::BODIES_SHADER, super::TURNED_OVER_SHADER, line, SHADER]
}

/// The pipeline, and the borders of one picture.
#[derive(Debug)]
pub(super) struct Borders {
    pipeline: Pipeline,
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
    segments: GrowingBuffer<Segment>,
    ranges: Vec<Range<u32>>,
}

impl Borders {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "border", &parts());
        let entries = [texture_entry(0, false), texture_entry(1, true), texture_entry(2, true)];
        let layout = group_layout(gpu, "bodies", &entries);
        let sum = wgpu::BlendComponent { dst_factor: wgpu::BlendFactor::One, ..wgpu::BlendComponent::REPLACE };
        let recipe = Recipe {
            groups: &[&panels.layout, &layout],
            vertices: &[Some(for_instances::<Segment>(&ATTRIBUTES))],
            blend: Some(wgpu::BlendState { color: sum, alpha: sum }),
            ..Recipe::rectangles("border", &module, ["segment", "border_colour"], BORDER_FORMAT)
        };
        let segments = GrowingBuffer::new(gpu, "borders", wgpu::BufferUsages::VERTEX, 1024);
        Self { pipeline: recipe.build(gpu), layout, textures: None, segments, ranges: Vec::new() }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(0, &bodies.colour), (1, &bodies.depth), (2, &bodies.alarm_depth)];
        self.textures = Some(bind_textures(gpu, "bodies", &self.layout, &views));
    }

    /// Uploads the borders of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut segments = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let start = segments.len() as u32;
            segments.extend(panel.borders.iter().filter_map(segment::projected(panel)));
            self.ranges.push(start..segments.len() as u32);
        }
        self.segments.write(gpu, segments);
    }

    /// Draws the borders of all panels.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, self.textures.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.segments.buffer().slice(..));
        panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
            pass.draw(0..4, self.ranges[panel].clone());
        });
    }
}
