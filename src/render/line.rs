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
/// What lines know of solid obstacles, where there are none and where there are some.
pub(super) const ALONE_SHADER: &str = include_str!("../../shaders/line_alone.wgsl");
pub(super) const AMONG_SHADER: &str = include_str!("../../shaders/line_among.wgsl");

/// One line as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Segment {
    from: [f32; 3],
    to: [f32; 3],
    kind: u32,
    strength: f32,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32, 3 => Float32];

/// A pipeline and what it reads.
#[derive(Debug)]
struct Way {
    among: bool,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

/// The pipelines of the lines, and the lines of one picture.
#[derive(Debug)]
pub(super) struct Lines {
    alone: Way,
    /// Among solid obstacles, as soon as there are any.
    among: Option<Way>,
    samples: u32,
    segments: GrowingBuffer<Segment>,
    ranges: Vec<Range<u32>>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu, panels: &Panels, samples: u32) -> Self {
        Self {
            alone: Way::new(gpu, panels, samples, false),
            among: None,
            samples,
            segments: GrowingBuffer::new(gpu, "lines", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Prepares to draw lines among solid obstacles.
    pub(super) fn prepare_among(&mut self, gpu: &Gpu, panels: &Panels, bodies: &Bodies) {
        if self.among.is_none() {
            let mut way = Way::new(gpu, panels, self.samples, true);
            way.retarget(gpu, bodies);
            self.among = Some(way);
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
                strength: line.strength,
            }));
            self.ranges.push(start..segments.len() as u32);
        }
        self.segments.write(gpu, &segments);
    }

    /// Takes note of new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.alone.retarget(gpu, bodies);
        if let Some(among) = &mut self.among {
            among.retarget(gpu, bodies);
        }
    }

    /// Draws the lines of all panels, among solid obstacles if there are any.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, places: &[Rectangle], among: bool) {
        let way = self.among.as_ref().filter(|_| among).unwrap_or(&self.alone);
        pass.set_pipeline(&way.pipeline);
        pass.set_bind_group(1, way.textures.as_ref(), &[]);
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

impl Way {
    fn new(gpu: &Gpu, panels: &Panels, samples: u32, among: bool) -> Self {
        let obstacles = if among { AMONG_SHADER } else { ALONE_SHADER };
        let reading = super::reading_shader(samples);
        let places = super::samples_shader(samples);
        let parts = [super::PANEL_SHADER, super::STRIP_SHADER, places, reading, obstacles, ALARM_SHADER, SHADER];
        let module = shader(gpu, "line", &parts);
        let mut entries = vec![texture_entry(1, true, samples), texture_entry(2, true, 1)];
        if among {
            entries.push(texture_entry(0, false, samples));
        }
        let layout = group_layout(gpu, "depth", &entries);
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let recipe = Recipe {
            label: "line",
            shader: &module,
            entries: ["segment", "opacity"],
            groups: &[&panels.layout, &layout],
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
        Self { among, pipeline: recipe.build(gpu), layout, textures: None }
    }

    fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let all = [(1, &bodies.depth), (2, &bodies.alarm_depth), (0, &bodies.colour)];
        let views = if self.among { &all[..] } else { &all[..2] };
        self.textures = Some(bind_textures(gpu, "depth", &self.layout, views));
    }
}
