//! Edges, contours and outlines of bodies, as opacities.

use super::panel::{Panels, cropped};
use super::pipeline::{LINE_FORMAT, Recipe, bind_textures, for_instances, group_layout, shader, texture_entry};
use super::target::Bodies;
use super::visibility::{Visibility, most_samples};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Line, LineKind, Panel, Picture, Rectangle};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/line.wgsl");

/// One line as the shaders read it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    from: [f32; 3],
    to: [f32; 3],
    /// Its kind, its opacity (of 255), and the number of samples of its visibility.
    look: u32,
    /// The first of these.
    first: u32,
}

/// Where the opacity and the number of samples begin in [`Segment::look`].
const STRENGTH: u32 = 4;
const COUNT: u32 = 12;
/// The longest line in samples.
const MOST_OF_LINE: u32 = (1 << (32 - COUNT)) - 1;

pub(super) const ATTRIBUTES: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Uint32, 3 => Uint32];

impl Segment {
    /// A line whose visibility is not tested beforehand.
    pub(super) fn new(line: &Line) -> Self {
        Self::tested(line, 0..0)
    }

    fn tested(line: &Line, samples: Range<u32>) -> Self {
        let &Line { from, to, kind, strength } = line;
        let strength = (255.0 * strength).round() as u32;
        let look = kind as u32 | strength << STRENGTH | (samples.len() as u32) << COUNT;
        Self { from, to, look, first: samples.start }
    }

    /// The samples of its visibility.
    pub(super) fn samples(&self) -> Range<u32> {
        self.first..self.first + (self.look >> COUNT)
    }
}

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 3] {
    [super::PANEL_SHADER, super::SEGMENT_SHADER, SHADER]
}

/// Whether there are lines of turned-over elements.
pub(super) fn has_alarm(panel: &Panel) -> bool {
    panel.lines.iter().any(|line| matches!(line.kind, LineKind::AlarmEdge | LineKind::AlarmContour))
}

/// Lines that are drawn by one pipeline. A software driver would do the work of all kinds for each of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Edge,
    AlarmEdge,
    Contour,
    AlarmContour,
    /// Everything in the plane.
    Flat,
}

impl Kind {
    /// Those whose visibility is tested.
    pub(super) const TESTED: [Self; 4] = [Self::Edge, Self::AlarmEdge, Self::Contour, Self::AlarmContour];
    const ALL: [Self; 5] = [Self::Edge, Self::AlarmEdge, Self::Contour, Self::AlarmContour, Self::Flat];

    fn of(panel: &Panel, line: &Line) -> Self {
        match line.kind {
            _ if panel.sight.flat => Self::Flat,
            LineKind::Edge | LineKind::Bar | LineKind::ObstacleEdge => Self::Edge,
            LineKind::AlarmEdge => Self::AlarmEdge,
            LineKind::Contour | LineKind::ObstacleContour => Self::Contour,
            LineKind::AlarmContour => Self::AlarmContour,
        }
    }

    /// What draws them.
    fn entry(self) -> &'static str {
        match self {
            Self::Edge => "edge_opacity",
            Self::AlarmEdge => "alarm_edge_opacity",
            Self::Contour => "contour_opacity",
            Self::AlarmContour => "alarm_contour_opacity",
            Self::Flat => "flat_opacity",
        }
    }

    /// What tests them.
    pub(super) fn test(self) -> &'static str {
        match self {
            Self::AlarmEdge => "alarm_edges",
            Self::Contour => "contours",
            Self::AlarmContour => "alarm_contours",
            Self::Edge | Self::Flat => "edges",
        }
    }
}

/// The pipelines of the lines, and the lines of one picture.
#[derive(Debug)]
pub(super) struct Lines {
    module: wgpu::ShaderModule,
    /// For each kind, made when it is first needed.
    pipelines: [Option<wgpu::RenderPipeline>; Kind::ALL.len()],
    layout: wgpu::BindGroupLayout,
    found: Option<wgpu::BindGroup>,
    visibility: Visibility,
    segments: GrowingBuffer<Segment>,
    /// The lines of each panel, by kinds.
    ranges: Vec<[Range<u32>; Kind::ALL.len()]>,
}

impl Lines {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE;
        Self {
            module: shader(gpu, "line", &parts()),
            pipelines: [const { None }; Kind::ALL.len()],
            layout: group_layout(gpu, "visibility", &[texture_entry(4, false)]),
            found: None,
            visibility: Visibility::new(gpu),
            segments: GrowingBuffer::new(gpu, "lines", usage, 1024),
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines of a picture, and prepares to draw them, among solid obstacles or without any.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, bodies: &Bodies, picture: &Picture, among: bool) {
        let mut apart = 1.0;
        let mut segments = self.sampled(picture, apart);
        while segments.last().is_some_and(|last| u64::from(last.samples().end) > most_samples(gpu)) {
            apart *= 2.0;
            segments = self.sampled(picture, apart);
        }
        let is_new = self.segments.write(gpu, &segments);
        let tested: Vec<_> =
            self.ranges.iter().map(|ranges| std::array::from_fn(|kind| ranges[kind].clone())).collect();
        let lines = (&segments[..], self.segments.buffer(), is_new);
        if self.visibility.write(gpu, panels, bodies, lines, &tested, among) || self.found.is_none() {
            self.found = Some(bind_textures(gpu, "visibility", &self.layout, &[(4, &self.visibility.found())]));
        }
        for (at, kind) in Kind::ALL.into_iter().enumerate() {
            if self.ranges.iter().any(|ranges| !ranges[at].is_empty()) {
                self.prepare(gpu, panels, kind);
            }
        }
    }

    /// The lines of a picture by panels and kinds, with samples so far apart (px).
    fn sampled(&mut self, picture: &Picture, apart: f32) -> Vec<Segment> {
        let (mut segments, mut samples) = (Vec::new(), 0);
        self.ranges.clear();
        for panel in &picture.panels {
            let length = length_in(panel);
            self.ranges.push(Kind::ALL.map(|kind| {
                let start = segments.len() as u32;
                for line in panel.lines.iter().filter(|line| Kind::of(panel, line) == kind) {
                    let count = match kind {
                        Kind::Flat => 0,
                        _ => ((length(line) / apart).ceil() as u32 + 1).clamp(2, MOST_OF_LINE),
                    };
                    segments.push(Segment::tested(line, samples..samples + count));
                    samples += count;
                }
                start..segments.len() as u32
            }));
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
                groups: &[&panels.layout, &self.layout],
                vertices: &[Some(for_instances::<Segment>(&ATTRIBUTES))],
                blend: Some(wgpu::BlendState { color: largest, alpha: largest }),
                ..Recipe::rectangles("lines", &self.module, ["segment", kind.entry()], LINE_FORMAT)
            };
            recipe.build(gpu)
        };
        self.pipelines[kind as usize].get_or_insert_with(build);
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.visibility.retarget(gpu, bodies);
    }

    /// Tests the visibility of all lines, among solid obstacles if there are any. The bodies must have been drawn.
    pub(super) fn test(&self, commands: &mut wgpu::CommandEncoder, panels: &Panels, places: &[Rectangle], among: bool) {
        self.visibility.find(commands, panels, places, among);
    }

    /// Draws the lines of all panels, whose visibility was tested.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_bind_group(1, self.found.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.segments.buffer().slice(..));
        for (at, pipeline) in self.pipelines.iter().enumerate() {
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
                pass.draw(0..4, self.ranges[panel][at].clone());
            });
        }
    }
}

/// The length of a line of a panel, as far as it is before the eye (px).
fn length_in(panel: &Panel) -> impl Fn(&Line) -> f32 {
    let (clip, near) = (cropped(panel), panel.sight.near);
    let size = Vec2::new(panel.region[2] as f32, panel.region[3] as f32);
    let place = move |at: Vec4| at.truncate().truncate() / at.w * 0.5 * size;
    move |line| {
        let [mut a, mut b] = [line.from, line.to].map(|end| clip * Vec3::from(end).extend(1.0));
        if a.w < near && b.w < near {
            return 0.0;
        }
        if a.w < near {
            a = a.lerp(b, (near - a.w) / (b.w - a.w));
        } else if b.w < near {
            b = b.lerp(a, (near - b.w) / (a.w - b.w));
        }
        place(a).distance(place(b))
    }
}
