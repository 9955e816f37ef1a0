//! Surfaces: first the turned-over elements, alone and as seen through the body, then the others and solid obstacles over
//! them, plain or coloured by a field.

use super::panel::has_behind;
use super::pass::Pass;
use super::pipeline::{Pipeline, Recipe, for_vertices, shader};
use super::stage::Stage;
use super::target::Bodies;
use crate::gpu::GrowingBuffer;
use crate::picture::{MOST_OCCLUDERS, Mesh, Picture, Rectangle};
use bytemuck::{Pod, Zeroable};
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/surface.wgsl");

/// A corner as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Corner {
    position: [f32; 3],
    normal: [f32; 3],
    hatch: f32,
    /// The place on the scale of a field.
    shade: f32,
    /// Coordinates that are whole at the edges of the element.
    edge: [u8; 4],
}

const ATTRIBUTES: [wgpu::VertexAttribute; 5] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32, 3 => Float32, 4 => Unorm8x4];

/// The constants of one variant of the shader. What a picture does not need is left out: a software driver would do it for
/// every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    /// The largest number of obstacles near a body: a loop of constant length is much faster.
    pub(super) occluders: usize,
    /// Whether a field colours surfaces.
    pub(super) tinted: bool,
    /// Whether surfaces draw the edges of their elements.
    pub(super) edged: bool,
}

impl Variant {
    fn of(picture: &Picture) -> Self {
        let panels = || picture.panels.iter();
        let occluders = panels().map(|panel| panel.obstacles.occluders.len()).max().unwrap_or(0);
        Self {
            occluders: occluders.min(MOST_OCCLUDERS),
            tinted: !picture.ramp.is_empty(),
            edged: panels().any(|panel| !panel.sound.edges.is_empty() || !panel.turned_over.edges.is_empty()),
        }
    }

    /// The parts of the shader.
    pub(super) fn parts(self) -> String {
        let Self { occluders, tinted, edged } = self;
        let constants = format!("const OCCLUDERS = {occluders}u;\nconst TINTED = {tinted};\nconst EDGED = {edged};\n");
        [&constants, super::PANEL_SHADER, super::BODIES_SHADER, SHADER].concat()
    }
}

/// The sets of surfaces of a panel, in stored order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Set {
    Sound,
    TurnedOver,
    Obstacles,
}

/// The pipelines of surfaces and the meshes of one picture.
#[derive(Debug)]
pub(super) struct Surfaces {
    /// Made when first needed.
    pipelines: HashMap<(&'static str, Variant), Pipeline>,
    variant: Variant,
    corners: GrowingBuffer<Corner>,
    indices: GrowingBuffer<u32>,
    /// The indices of the sets of each panel, and the label of the pipeline of each.
    ranges: Vec<[(&'static str, Range<u32>); 3]>,
}

impl Surfaces {
    pub(super) fn new(stage: &Stage) -> Self {
        Self {
            pipelines: HashMap::new(),
            variant: Variant { occluders: 0, tinted: false, edged: false },
            corners: GrowingBuffer::new(&stage.gpu, "vertices", wgpu::BufferUsages::VERTEX, 1024),
            indices: GrowingBuffer::new(&stage.gpu, "indices", wgpu::BufferUsages::INDEX, 4096),
            ranges: Vec::new(),
        }
    }

    /// Uploads the meshes of a picture, and makes the pipelines that it needs.
    pub(super) fn write(&mut self, stage: &Stage, picture: &Picture) {
        let (mut corners, mut indices) = (Vec::new(), Vec::new());
        let mut add = |label: &'static str, meshes: &mut dyn Iterator<Item = &Mesh>| {
            let start = indices.len() as u32;
            for mesh in meshes {
                let base = corners.len() as u32;
                corners.extend(mesh.vertices.iter().enumerate().map(|(at, vertex)| Corner {
                    position: vertex.position,
                    normal: vertex.normal,
                    hatch: vertex.hatch,
                    shade: mesh.shades.get(at).copied().unwrap_or(-1.0),
                    edge: mesh.edges.get(at).copied().unwrap_or([128; 4]),
                }));
                indices.extend(mesh.triangles.iter().flatten().map(|at| base + at));
            }
            (label, start..indices.len() as u32)
        };
        let ranges = picture.panels.iter().map(|panel| {
            let sound = if has_behind(panel) { "sound, before others" } else { "sound" };
            [
                add(sound, &mut std::iter::once(&panel.sound)),
                add("turned over", &mut std::iter::once(&panel.turned_over)),
                add("obstacles", &mut panel.obstacles.solids.iter().map(|solid| &solid.mesh)),
            ]
        });
        self.ranges = ranges.collect();
        self.corners.write(&stage.gpu, corners);
        self.indices.write(&stage.gpu, indices);
        self.variant = Variant::of(picture);
        let module = OnceCell::new();
        for (label, _) in self.ranges.iter().flatten().filter(|(_, range)| !range.is_empty()) {
            // Panels share pipelines.
            self.pipelines.entry((*label, self.variant)).or_insert_with(|| {
                let module = module.get_or_init(|| shader(&stage.gpu, "surface", &[&self.variant.parts()]));
                made(stage, module, label)
            });
        }
    }

    /// Draws a set of all panels. What lies behind must have been drawn.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, stage: &Stage, bodies: &Bodies, places: &[Rectangle], set: Set) {
        pass.set_vertex_buffer(0, self.corners.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        if set == Set::Sound {
            pass.set_bind_group(1, &bodies.behind, &[]);
        }
        stage.panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
            let (label, range) = &self.ranges[panel][set as usize];
            if let Some(pipeline) = self.pipelines.get(&(*label, self.variant)) {
                pass.set_pipeline(pipeline);
                pass.draw_indexed(range.clone());
            }
        });
    }
}

/// The pipeline of a label.
fn made(stage: &Stage, module: &wgpu::ShaderModule, label: &'static str) -> Pipeline {
    let (panel, behind) = (&stage.panels.layout, &stage.layouts.behind);
    let (entries, groups, targets) = match label {
        // As seen through the body, and as surfaces of it.
        "turned over" => (["alarm_corner", "alarm_surface"], &[panel][..], 2),
        "sound, before others" => (["sound_corner", "sound_before"], &[panel, behind][..], 1),
        "obstacles" => (["obstacle_corner", "obstacle_surface"], &[panel][..], 1),
        _ => (["sound_corner", "sound_surface"], &[panel][..], 1),
    };
    let vertices = &[Some(for_vertices::<Corner>(&ATTRIBUTES))];
    Recipe { groups, vertices, targets, ..Recipe::bodies(label, module, entries) }.build(&stage.gpu)
}
