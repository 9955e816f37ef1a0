//! Edges, contours and outlines of bodies, as opacities.

use super::panel::{Panels, is_visible, limit};
use super::pipeline::{LINE_FORMAT, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Picture, Rectangle};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/line.wgsl");
pub(super) const ALARM_SHADER: &str = include_str!("../../shaders/line_alarm.wgsl");

/// One line as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Segment {
    from: [f32; 3],
    to: [f32; 3],
    kind: u32,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 3] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32];

/// The pipeline of the lines, and the lines of one picture.
#[derive(Debug)]
pub(super) struct Lines {
    pipeline: wgpu::RenderPipeline,
    depth_layout: wgpu::BindGroupLayout,
    depth: Option<wgpu::BindGroup>,
    segments: GrowingBuffer<Segment>,
    ranges: Vec<Range<u32>>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu, panels: &Panels, samples: u32) -> Self {
        let parts = [super::PANEL_SHADER, super::reading_shader(samples), ALARM_SHADER, SHADER];
        let module = shader(gpu, "line", &parts);
        let depth_layout = group_layout(gpu, "depth", &[texture_entry(1, true, samples), texture_entry(2, true, 1)]);
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let recipe = Recipe {
            label: "line",
            shader: &module,
            entries: ["segment", "opacity"],
            groups: &[&panels.layout, &depth_layout],
            vertices: &[Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<Segment>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: &ATTRIBUTES,
            })],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            target: LINE_FORMAT,
            blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
            depth: false,
            samples: 1,
        };
        Self {
            pipeline: recipe.build(gpu),
            depth_layout,
            depth: None,
            segments: GrowingBuffer::new(gpu, "lines", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut segments = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let start = segments.len() as u32;
            segments.extend(panel.lines.iter().map(|line| Segment {
                from: line.from,
                to: line.to,
                kind: line.kind as u32,
            }));
            self.ranges.push(start..segments.len() as u32);
        }
        self.segments.write(gpu, &segments);
    }

    /// Takes note of new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(1, &bodies.depth), (2, &bodies.alarm_depth)];
        self.depth = Some(bind_textures(gpu, "depth", &self.depth_layout, &views));
    }

    /// Draws the lines of all panels.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, self.depth.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.segments.buffer().slice(..));
        for (panel, (range, &place)) in self.ranges.iter().zip(places).enumerate() {
            if is_visible(place) && !range.is_empty() {
                limit(pass, place);
                panels.bind_region(pass, panel);
                pass.draw(0..4, range.clone());
            }
        }
    }
}
