//! Surfaces: first the turned-over elements, alone and as seen through the body, then the others and solid obstacles over
//! them, plain or coloured by a field.

use super::panel::{Panels, has_behind};
use super::pipeline::{Recipe, for_vertices, shader};
use super::target::Layouts;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{MOST_OCCLUDERS, Mesh, Picture};
use bytemuck::{Pod, Zeroable};
use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/surface.wgsl");

/// A corner as the shader reads it, its position first.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Corner {
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

/// The constants of one variant of the shader. Parts that a picture does not need are left out: a software driver would do them for
/// every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Variant {
    /// The largest number of obstacles near a body: a loop of constant length is much faster.
    pub(super) occluders: usize,
    /// Whether a field colours surfaces.
    pub(super) tinted: bool,
    /// Whether surfaces draw the edges of their elements.
    pub(super) edged: bool,
    /// Whether surfaces cast shadows on each other.
    pub(super) shadowed: bool,
}

impl Variant {
    fn of(picture: &Picture) -> Self {
        let panels = || picture.panels.iter();
        let occluders = panels().map(|panel| panel.obstacles.occluders.len()).max().unwrap_or(0);
        Self {
            occluders: occluders.min(MOST_OCCLUDERS),
            tinted: !picture.ramp.is_empty(),
            edged: panels().any(|panel| !panel.sound.edges.is_empty() || !panel.turned_over.edges.is_empty()),
            shadowed: panels().any(|panel| panel.sight.key_map.is_some()),
        }
    }

    /// The parts of the shader.
    pub(super) fn parts(self) -> String {
        let Self { occluders, tinted, edged, shadowed } = self;
        let constants = format!(
            "const OCCLUDERS = {occluders}u;\nconst TINTED = {tinted};\nconst EDGED = {edged};\nconst SHADOWED = {shadowed};\n"
        );
        [&constants, super::PANEL_SHADER, super::KEY_SHADER, SHADER].concat()
    }
}

/// The label of the pipeline of solid obstacles.
const OBSTACLES: &str = "obstacles";

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
    pipelines: HashMap<(&'static str, Variant), wgpu::RenderPipeline>,
    variant: Variant,
    corners: GrowingBuffer,
    indices: GrowingBuffer,
    /// The indices of the sets of each panel, and the label of the pipeline of each.
    ranges: Vec<[(&'static str, Range<u32>); 3]>,
}

impl Surfaces {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self {
            pipelines: HashMap::new(),
            variant: Variant { occluders: 0, tinted: false, edged: false, shadowed: false },
            corners: GrowingBuffer::new(gpu, "vertices", wgpu::BufferUsages::VERTEX, 1 << 16),
            indices: GrowingBuffer::new(gpu, "indices", wgpu::BufferUsages::INDEX, 1 << 14),
            ranges: Vec::new(),
        }
    }

    /// Uploads the meshes of a picture, and makes the pipelines that it needs.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, layouts: &Layouts, picture: &Picture) {
        let (mut corners, mut indices) = (Vec::new(), Vec::new());
        let mut add = |label: &'static str, meshes: &mut dyn Iterator<Item = &Mesh>| {
            let start = indices.len() as u32;
            let mut unseen = Vec::new();
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
                unseen.extend(mesh.unseen.iter().flatten().map(|at| base + at));
            }
            let end = indices.len() as u32;
            indices.append(&mut unseen);
            (label, start..end)
        };
        let ranges = picture.panels.iter().map(|panel| {
            let sound = if has_behind(panel) { "sound, before others" } else { "sound" };
            [
                add(sound, &mut std::iter::once(&panel.sound)),
                add("turned over", &mut std::iter::once(&panel.turned_over)),
                add(OBSTACLES, &mut panel.obstacles.solids.iter().map(|solid| &solid.mesh)),
            ]
        });
        self.ranges = ranges.collect();
        self.corners.write(gpu, &corners);
        self.indices.write(gpu, &indices);
        self.variant = Variant::of(picture);
        let module = OnceCell::new();
        for (label, _) in self.ranges.iter().flatten().filter(|(_, range)| !range.is_empty()) {
            // Panels share pipelines.
            self.pipelines.entry((*label, self.variant)).or_insert_with(|| {
                let module = module.get_or_init(|| shader(gpu, "surface", &[&self.variant.parts()]));
                made(gpu, [&panels.layout, &layouts.behind, &layouts.drawn], module, label)
            });
        }
    }

    /// Draws a set of all panels. What lies behind it must have been drawn, and be bound: turned-over elements, or bodies behind obstacles.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, picture: &Picture, set: Set) {
        pass.set_vertex_buffer(0, self.corners.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        for (at, (panel, ranges)) in picture.panels.iter().zip(&self.ranges).enumerate() {
            let (label, range) = &ranges[set as usize];
            if !range.is_empty() && panel.region[2] > 0 && panel.region[3] > 0 {
                pass.set_pipeline(&self.pipelines[&(*label, self.variant)]);
                panels.bind(pass, at, panel, panel.region);
                pass.draw_indexed(range.clone(), 0, 0..1);
            }
        }
    }

    /// Draws all surfaces of a panel, which must be bound, with their unseen triangles: these lie between the sets.
    pub(super) fn draw_all(&self, pass: &mut wgpu::RenderPass<'_>, at: usize) {
        pass.set_vertex_buffer(0, self.corners.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        let [(_, first), .., (_, last)] = &self.ranges[at];
        pass.draw_indexed(first.start..last.end, 0, 0..1);
    }
}

/// The pipeline of a label, with the layouts of panels, of turned-over elements behind surfaces, and of bodies behind obstacles.
fn made(
    gpu: &Gpu,
    [panels, turned_over, bodies]: [&wgpu::BindGroupLayout; 3],
    module: &wgpu::ShaderModule,
    label: &'static str,
) -> wgpu::RenderPipeline {
    // Opacities of obstacles stay in the picture, as marks.
    let over = wgpu::BlendState { alpha: wgpu::BlendComponent::REPLACE, ..wgpu::BlendState::ALPHA_BLENDING };
    let (entries, groups, targets, blend): (_, &[_], _, _) = match label {
        // As seen through the body, and as surfaces of it.
        "turned over" => (["alarm_corner", "alarm_surface"], &[panels], 2, None),
        "sound, before others" => (["sound_corner", "sound_before"], &[panels, turned_over], 1, None),
        OBSTACLES => (["obstacle_corner", "obstacle_surface"], &[panels, bodies], 1, Some(over)),
        _ => (["sound_corner", "sound_surface"], &[panels], 1, None),
    };
    // Of an obstacle that bodies are seen through, one layer lies over them.
    let cull = (label == OBSTACLES).then_some(wgpu::Face::Back);
    let vertices = &[Some(for_vertices::<Corner>(&ATTRIBUTES))];
    Recipe { groups, vertices, targets, blend, cull, ..Recipe::new(label, module, entries) }.build(gpu)
}
