//! Edges, contours and outlines of bodies, as opacities.

use super::panel::Panels;
use super::pipeline::{LINE_FORMAT, Recipe, bind_textures, for_instances, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Line, LineKind, Panel, Picture, Rectangle};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/line.wgsl");
/// The part of the shader about solid obstacles, without any and with some.
const ALONE_SHADER: &str = include_str!("../../shaders/line_alone.wgsl");
const AMONG_SHADER: &str = include_str!("../../shaders/line_among.wgsl");

/// One line as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    from: [f32; 3],
    to: [f32; 3],
    kind: u32,
    strength: f32,
}

pub(super) const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32, 3 => Float32];

impl Segment {
    pub(super) fn new(line: &Line) -> Self {
        let &Line { from, to, kind, strength } = line;
        Self { from, to, kind: kind as u32, strength }
    }
}

/// The parts of the shader, alone or among solid obstacles.
pub(super) fn parts(among: bool) -> [&'static str; 7] {
    let obstacles = if among { AMONG_SHADER } else { ALONE_SHADER };
    let [panel, segment] = [super::PANEL_SHADER, super::SEGMENT_SHADER];
    [panel, segment, super::TAPS_SHADER, super::BODIES_SHADER, obstacles, super::TURNED_OVER_SHADER, SHADER]
}

/// Whether there are lines of turned-over elements.
pub(super) fn has_alarm(panel: &Panel) -> bool {
    panel.lines.iter().any(|line| matches!(line.kind, LineKind::AlarmEdge | LineKind::AlarmContour))
}

/// Pipelines and their bindings.
#[derive(Debug)]
struct Variant {
    among: bool,
    /// For edges and for contours.
    pipelines: [wgpu::RenderPipeline; 2],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

/// The pipelines of the lines, and the lines of one picture.
#[derive(Debug)]
pub(super) struct Lines {
    alone: Variant,
    /// Among solid obstacles, as soon as there are any.
    among: Option<Variant>,
    segments: GrowingBuffer<Segment>,
    /// The edges and the contours of each panel.
    ranges: Vec<[Range<u32>; 2]>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        Self {
            alone: Variant::new(gpu, panels, false),
            among: None,
            segments: GrowingBuffer::new(gpu, "lines", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Prepares to draw lines among solid obstacles.
    pub(super) fn prepare_among(&mut self, gpu: &Gpu, panels: &Panels, bodies: &Bodies) {
        if self.among.is_none() {
            let mut among = Variant::new(gpu, panels, true);
            among.retarget(gpu, bodies);
            self.among = Some(among);
        }
    }

    /// Uploads the lines of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut segments = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let contour = |line: &&Line| {
                let kinds = [LineKind::Contour, LineKind::AlarmContour, LineKind::ObstacleContour];
                kinds.contains(&line.kind)
            };
            let mut add = |lines: &mut dyn Iterator<Item = &Line>| {
                let start = segments.len() as u32;
                segments.extend(lines.map(Segment::new));
                start..segments.len() as u32
            };
            let edges = add(&mut panel.lines.iter().filter(|line| !contour(line)));
            self.ranges.push([edges, add(&mut panel.lines.iter().filter(contour))]);
        }
        self.segments.write(gpu, &segments);
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.alone.retarget(gpu, bodies);
        if let Some(among) = &mut self.among {
            among.retarget(gpu, bodies);
        }
    }

    /// Draws the lines of all panels, among solid obstacles if there are any.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, places: &[Rectangle], among: bool) {
        let variant = self.among.as_ref().filter(|_| among).unwrap_or(&self.alone);
        pass.set_bind_group(1, variant.textures.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.segments.buffer().slice(..));
        for (at, pipeline) in variant.pipelines.iter().enumerate() {
            pass.set_pipeline(pipeline);
            panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
                pass.draw(0..4, self.ranges[panel][at].clone());
            });
        }
    }
}

impl Variant {
    fn new(gpu: &Gpu, panels: &Panels, among: bool) -> Self {
        let module = shader(gpu, "line", &parts(among));
        let mut entries = vec![texture_entry(1, true), texture_entry(2, true)];
        if among {
            entries.push(texture_entry(0, false));
        }
        let layout = group_layout(gpu, "depth", &entries);
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let build = |label, fragment| {
            let recipe = Recipe {
                groups: &[&panels.layout, &layout],
                vertices: &[Some(for_instances::<Segment>(&ATTRIBUTES))],
                blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
                ..Recipe::rectangles(label, &module, ["segment", fragment], LINE_FORMAT)
            };
            recipe.build(gpu)
        };
        let pipelines = [build("edges", "edge_opacity"), build("contours", "contour_opacity")];
        Self { among, pipelines, layout, textures: None }
    }

    fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let all = [(1, &bodies.depth), (2, &bodies.alarm_depth), (0, &bodies.colour)];
        let views = if self.among { &all[..] } else { &all[..2] };
        self.textures = Some(bind_textures(gpu, "depth", &self.layout, views));
    }
}
