//! Coloured lines, and nodes in space.

use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{
    PICTURE_FORMAT, Pipeline, Recipe, bind_textures, for_instances, group_layout, shader, texture_entry,
};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Bead, Colour, Picture, Second, Stroke};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/stroke.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 5] {
    [super::PANEL_SHADER, super::SEGMENT_SHADER, super::TAPS_SHADER, super::BODIES_SHADER, SHADER]
}

/// One line or disc as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Instance {
    ends: [[f32; 3]; 2],
    first: [u8; 4],
    second: [u8; 4],
    /// The second colour, and the opacity behind surfaces.
    other: [u8; 4],
    size: f32,
    kind: u32,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Unorm8x4, 4 => Unorm8x4, 5 => Float32, 6 => Uint32
];

/// The pipeline and the lines and discs of one picture. Made for the first picture that has any.
#[derive(Debug)]
pub(super) struct Strokes {
    pipeline: Pipeline,
    layout: wgpu::BindGroupLayout,
    depth: wgpu::BindGroup,
    instances: GrowingBuffer<Instance>,
    ranges: Vec<Range<u32>>,
}

impl Strokes {
    /// Whether a picture has lines or discs.
    pub(super) fn are_in(picture: &Picture) -> bool {
        picture.panels.iter().any(|panel| !panel.strokes.is_empty() || !panel.beads.is_empty())
    }

    pub(super) fn new(gpu: &Gpu, panels: &Panels, bodies: &Bodies) -> Self {
        let module = shader(gpu, "stroke", &parts());
        let layout = group_layout(gpu, "depth of bodies", &[texture_entry(1, true)]);
        let recipe = Recipe {
            groups: &[&panels.layout, &layout],
            vertices: &[Some(for_instances::<Instance>(&ATTRIBUTES))],
            ..Recipe::rectangles("stroke", &module, ["stroke", "stroke_colour"], PICTURE_FORMAT)
        };
        Self {
            pipeline: recipe.build(gpu),
            depth: bind_textures(gpu, "depth of bodies", &layout, &[(1, &bodies.depth)]),
            layout,
            instances: GrowingBuffer::new(gpu, "strokes", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.depth = bind_textures(gpu, "depth of bodies", &self.layout, &[(1, &bodies.depth)]);
    }

    /// Uploads the lines and discs of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut instances = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let start = instances.len() as u32;
            instances.extend(panel.strokes.iter().map(line));
            instances.extend(panel.beads.iter().map(disc));
            self.ranges.push(start..instances.len() as u32);
        }
        self.instances.write(gpu, instances);
    }

    /// Draws the lines and discs of all panels into the picture.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, picture: &Picture) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.depth, &[]);
        pass.set_vertex_buffer(0, self.instances.buffer().slice(..));
        panels.draw_regions(pass, picture.panels.iter().map(|panel| panel.region), |pass, panel| {
            pass.draw(0..4, self.ranges[panel].clone());
        });
    }
}

fn with_alpha([red, green, blue]: Colour, alpha: u8) -> [u8; 4] {
    [red, green, blue, alpha]
}

fn line(stroke: &Stroke) -> Instance {
    let [first, second] = stroke.colours.map(|colour| with_alpha(colour, 255));
    let (kind, other) = match stroke.second {
        Second::None => (0, Colour::default()),
        Second::OnBody(colour) => (1, colour),
        Second::Casing(colour) => (3, colour),
    };
    Instance { ends: stroke.ends, first, second, other: with_alpha(other, stroke.behind), size: stroke.width, kind }
}

fn disc(bead: &Bead) -> Instance {
    Instance {
        ends: [bead.at; 2],
        first: with_alpha(bead.colour, 255),
        second: with_alpha(bead.rim, 255),
        other: [0; 4],
        size: bead.radius,
        kind: 2,
    }
}
