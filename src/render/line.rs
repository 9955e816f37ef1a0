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

/// What the shader calls the kinds of lines that have pipelines of their own.
const ENTRIES: [&str; 4] = ["edge_opacity", "alarm_edge_opacity", "contour_opacity", "alarm_contour_opacity"];

/// The kind of a line, by its place in [`ENTRIES`].
fn entry(kind: LineKind) -> usize {
    match kind {
        LineKind::AlarmEdge => 1,
        LineKind::Contour | LineKind::ObstacleContour => 2,
        LineKind::AlarmContour => 3,
        _ => 0,
    }
}

/// Pipelines and their bindings.
#[derive(Debug)]
struct Variant {
    among: bool,
    module: wgpu::ShaderModule,
    /// For each kind of [`ENTRIES`], made when it is first needed.
    pipelines: [Option<wgpu::RenderPipeline>; 4],
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
    /// The lines of each panel, by kinds.
    ranges: Vec<[Range<u32>; 4]>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            alone: Variant::new(gpu, false),
            among: None,
            segments: GrowingBuffer::new(gpu, "lines", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines of a picture, and prepares to draw them, among solid obstacles or without any.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, bodies: &Bodies, picture: &Picture, among: bool) {
        let mut segments = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            self.ranges.push(std::array::from_fn(|at| {
                let start = segments.len() as u32;
                let lines = panel.lines.iter().filter(|line| entry(line.kind) == at);
                segments.extend(lines.map(Segment::new));
                start..segments.len() as u32
            }));
        }
        self.segments.write(gpu, &segments);
        if among && self.among.is_none() {
            let mut variant = Variant::new(gpu, true);
            variant.retarget(gpu, bodies);
            self.among = Some(variant);
        }
        let variant = if among { self.among.as_mut().expect("made above") } else { &mut self.alone };
        let is_drawn = |at: usize| self.ranges.iter().any(|ranges| !ranges[at].is_empty());
        (0..ENTRIES.len()).filter(|&at| is_drawn(at)).for_each(|at| variant.prepare(gpu, panels, at));
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
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
                pass.draw(0..4, self.ranges[panel][at].clone());
            });
        }
    }
}

impl Variant {
    fn new(gpu: &Gpu, among: bool) -> Self {
        let mut entries = vec![texture_entry(1, true), texture_entry(2, true)];
        if among {
            entries.push(texture_entry(0, false));
        }
        Self {
            among,
            module: shader(gpu, "line", &parts(among)),
            pipelines: [const { None }; 4],
            layout: group_layout(gpu, "depth", &entries),
            textures: None,
        }
    }

    /// Makes the pipeline of a kind.
    fn prepare(&mut self, gpu: &Gpu, panels: &Panels, kind: usize) {
        let largest = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Max,
        };
        let build = || {
            let recipe = Recipe {
                groups: &[&panels.layout, &self.layout],
                vertices: &[Some(for_instances::<Segment>(&ATTRIBUTES))],
                blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
                ..Recipe::rectangles("lines", &self.module, ["segment", ENTRIES[kind]], LINE_FORMAT)
            };
            recipe.build(gpu)
        };
        self.pipelines[kind].get_or_insert_with(build);
    }

    fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let all = [(1, &bodies.depth), (2, &bodies.alarm_depth), (0, &bodies.colour)];
        let views = if self.among { &all[..] } else { &all[..2] };
        self.textures = Some(bind_textures(gpu, "depth", &self.layout, views));
    }
}
