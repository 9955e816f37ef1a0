//! Coloured lines, and nodes in space.

use super::panel::limit;
use super::pass::Pass;
use super::pipeline::{PICTURE_FORMAT, Pipeline, Recipe, for_instances, shader};
use super::stage::Stage;
use super::target::Bodies;
use crate::gpu::GrowingBuffer;
use crate::picture::{Bead, Colour, Panel, Picture, Second, Stroke};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/stroke.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 5] {
    [super::PANEL_SHADER, super::SEGMENT_SHADER, super::BODIES_SHADER, super::TAPS_SHADER, SHADER]
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

/// Width (px in the reference picture) and opacity of the edges of plates.
const PLATE_EDGE: f32 = 1.35;
const PLATE_EDGE_ALPHA: u8 = 219;

/// The pipeline and the lines and discs of one picture. Made for the first picture that has any.
#[derive(Debug)]
pub(super) struct Strokes {
    pipeline: Pipeline,
    instances: GrowingBuffer<Instance>,
    /// The lines and discs of each panel, and the edges of plates.
    ranges: Vec<[Range<u32>; 2]>,
}

impl Strokes {
    /// Whether a picture has lines or discs.
    pub(super) fn are_in(picture: &Picture) -> bool {
        let are_in =
            |panel: &Panel| !panel.strokes.is_empty() || !panel.beads.is_empty() || !panel.obstacles.edges.is_empty();
        picture.panels.iter().any(are_in)
    }

    pub(super) fn new(stage: &Stage) -> Self {
        let module = shader(&stage.gpu, "stroke", &parts());
        let recipe = Recipe {
            groups: &[&stage.panels.layout, &stage.layouts.drawn],
            vertices: &[Some(for_instances::<Instance>(&ATTRIBUTES))],
            ..Recipe::rectangles("stroke", &module, ["stroke", "stroke_colour"], PICTURE_FORMAT)
        };
        Self {
            pipeline: recipe.build(&stage.gpu),
            instances: GrowingBuffer::new(&stage.gpu, "strokes", wgpu::BufferUsages::VERTEX, 1024),
            ranges: Vec::new(),
        }
    }

    /// Uploads the lines and discs of a picture.
    pub(super) fn write(&mut self, stage: &Stage, picture: &Picture) {
        let mut instances = Vec::new();
        self.ranges.clear();
        for panel in &picture.panels {
            let start = instances.len() as u32;
            instances.extend(panel.strokes.iter().map(line));
            instances.extend(panel.beads.iter().map(disc));
            let middle = instances.len() as u32;
            let colour = with_alpha(picture.palette.pane_edge, PLATE_EDGE_ALPHA);
            instances.extend(panel.obstacles.edges.iter().map(|&ends| Instance {
                ends,
                first: colour,
                second: colour,
                other: [0; 4],
                size: PLATE_EDGE * panel.sight.line_scale,
                kind: 0,
            }));
            self.ranges.push([start..middle, middle..instances.len() as u32]);
        }
        self.instances.write(&stage.gpu, instances);
    }

    /// Draws the lines and discs of all panels into the picture, or the edges of plates.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, stage: &Stage, bodies: &Bodies, picture: &Picture, of_plates: bool) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &bodies.drawn, &[]);
        pass.set_vertex_buffer(0, self.instances.buffer().slice(..));
        for (at, panel) in picture.panels.iter().enumerate() {
            limit(pass, panel.viewport);
            stage.panels.bind_whole(pass, at);
            pass.draw(0..4, self.ranges[at][usize::from(of_plates)].clone());
        }
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
