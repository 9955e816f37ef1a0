//! Solid obstacles, drawn with the bodies, and transparent ones, drawn below and above the bodies. Pipelines are made
//! when they are first needed.

use super::panel::{Panels, is_visible, limit, linear};
use super::pass::Pass;
use super::pipeline::{
    PICTURE_FORMAT, Pipeline, Recipe, bind_textures, for_instances, for_vertices, group_layout, shader, texture_entry,
};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Pane, Picture, Rectangle};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/obstacle.wgsl");
const PANE_SHADER: &str = include_str!("../../shaders/pane.wgsl");

/// The parts of the shader of slabs.
pub(super) fn pane_parts() -> [&'static str; 5] {
    [super::PANEL_SHADER, super::SEGMENT_SHADER, super::TAPS_SHADER, super::BODIES_SHADER, PANE_SHADER]
}

/// A corner of a solid as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct SolidVertex {
    position: [f32; 3],
    normal: [f32; 3],
    colour: [f32; 3],
    /// The share of ambient light that the body occludes.
    near: f32,
}

const SOLID: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32];

/// A corner of a pane as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct PaneVertex {
    position: [f32; 3],
    /// 0 at the border and 1 in the middle.
    inward: f32,
    grid: [f32; 2],
    from_middle: [f32; 2],
    /// Colour with opacity.
    colour: [f32; 4],
    /// Colour of the grid, and 1 if there is one.
    lined: [f32; 4],
}

const PANE: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Float32, 2 => Float32x2, 3 => Float32x2, 4 => Float32x4, 5 => Float32x4
];

/// An edge of a slab as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct EdgePiece {
    from: [f32; 3],
    to: [f32; 3],
    colour: [f32; 3],
    /// Size, left and top of the panel in the picture (px).
    size: [f32; 2],
    viewport: [f32; 2],
}

const EDGE: [wgpu::VertexAttribute; 5] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x2, 4 => Float32x2];

/// The solid obstacles of one picture.
#[derive(Debug)]
pub(super) struct Solids {
    pipeline: Pipeline,
    vertices: GrowingBuffer<SolidVertex>,
    indices: GrowingBuffer<u32>,
    ranges: Vec<Range<u32>>,
}

impl Solids {
    /// Whether a picture has solid obstacles.
    pub(super) fn are_in(picture: &Picture) -> bool {
        picture.panels.iter().any(|panel| !panel.obstacles.solids.is_empty())
    }

    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        // The light is that of bodies.
        let module = shader(gpu, "obstacle", &[&super::surface::parts(0)[..], &[SHADER]].concat());
        let recipe = Recipe {
            groups: &[&panels.layout],
            vertices: &[Some(for_vertices::<SolidVertex>(&SOLID))],
            ..Recipe::bodies("solid_surface", &module, ["solid_corner", "solid_surface"])
        };
        Self {
            pipeline: recipe.build(gpu),
            vertices: GrowingBuffer::new(gpu, "corners of obstacles", wgpu::BufferUsages::VERTEX, 4096),
            indices: GrowingBuffer::new(gpu, "triangles of obstacles", wgpu::BufferUsages::INDEX, 16384),
            ranges: Vec::new(),
        }
    }

    /// Uploads the solids of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        self.ranges.clear();
        for panel in &picture.panels {
            let start = indices.len() as u32;
            for solid in &panel.obstacles.solids {
                let (base, colour) = (vertices.len() as u32, linear(solid.colour).to_array());
                let vertex = |(at, &crate::picture::Vertex { position, normal, .. })| {
                    let near = solid.near.get(at).copied().unwrap_or(0.0);
                    SolidVertex { position, normal, colour, near }
                };
                vertices.extend(solid.mesh.vertices.iter().enumerate().map(vertex));
                indices.extend(solid.mesh.triangles.iter().flatten().map(|at| base + at));
            }
            self.ranges.push(start..indices.len() as u32);
        }
        self.vertices.write(gpu, vertices);
        self.indices.write(gpu, indices);
    }

    /// Draws the solids of all panels, after the bodies in their pass.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, places: &[Rectangle]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.vertices.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        panels.draw_regions(pass, places.iter().copied(), |pass, panel| {
            pass.draw_indexed(self.ranges[panel].clone());
        });
    }
}

/// The transparent obstacles of one picture.
#[derive(Debug)]
pub(super) struct Slabs {
    /// The pipelines below and above the bodies.
    panes: [Pipeline; 2],
    edges: [Pipeline; 2],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
    corners: GrowingBuffer<PaneVertex>,
    pieces: GrowingBuffer<EdgePiece>,
    /// The corners and edges of each slab, for each panel.
    ranges: Vec<Vec<[Range<u32>; 2]>>,
}

impl Slabs {
    /// Whether a picture has transparent obstacles.
    pub(super) fn are_in(picture: &Picture) -> bool {
        picture.panels.iter().any(|panel| !panel.obstacles.slabs.is_empty())
    }

    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "pane", &pane_parts());
        let entries = [texture_entry(1, true), texture_entry(2, false)];
        let group = group_layout(gpu, "pane", &entries);
        let build = |entries: [&'static str; 2], vertices, topology| {
            let recipe = Recipe {
                groups: &[&panels.layout, &group],
                vertices: &[Some(vertices)],
                topology,
                ..Recipe::rectangles(entries[1], &module, entries, PICTURE_FORMAT)
            };
            recipe.build(gpu)
        };
        let pane = |fragment| {
            let corners = for_vertices::<PaneVertex>(&PANE);
            build(["pane_corner", fragment], corners, wgpu::PrimitiveTopology::TriangleList)
        };
        let edge = |fragment| {
            let pieces = for_instances::<EdgePiece>(&EDGE);
            build(["edge_corner", fragment], pieces, wgpu::PrimitiveTopology::TriangleStrip)
        };
        Self {
            panes: [pane("pane_below"), pane("pane_above")],
            edges: [edge("edge_below"), edge("edge_above")],
            textures: None,
            corners: GrowingBuffer::new(gpu, "panes", wgpu::BufferUsages::VERTEX, 256),
            pieces: GrowingBuffer::new(gpu, "edges of panes", wgpu::BufferUsages::VERTEX, 256),
            ranges: Vec::new(),
            layout: group,
        }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(1, &bodies.depth), (2, &bodies.lines)];
        self.textures = Some(bind_textures(gpu, "pane", &self.layout, &views));
    }

    /// Uploads the slabs of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let (mut corners, mut pieces) = (Vec::new(), Vec::new());
        self.ranges.clear();
        let colour = linear(picture.palette.pane_edge).to_array();
        let grid = linear(picture.palette.grid);
        for panel in &picture.panels {
            let [left, top, width, height] = panel.viewport.map(|length| length as f32);
            let mut ranges = Vec::new();
            for slab in &panel.obstacles.slabs {
                let start = [corners.len() as u32, pieces.len() as u32];
                slab.panes.iter().for_each(|pane| add_fan(pane, grid, &mut corners));
                pieces.extend(slab.edges.iter().map(|&[from, to]| EdgePiece {
                    from,
                    to,
                    colour,
                    size: [width, height],
                    viewport: [left, top],
                }));
                ranges.push([start[0]..corners.len() as u32, start[1]..pieces.len() as u32]);
            }
            self.ranges.push(ranges);
        }
        self.corners.write(gpu, corners);
        self.pieces.write(gpu, pieces);
    }

    /// Draws the slabs of all panels below the bodies, or above them where the slabs are nearer.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, picture: &Picture, above: bool) {
        pass.set_bind_group(1, self.textures.as_ref(), &[]);
        for (at, (panel, slabs)) in picture.panels.iter().zip(&self.ranges).enumerate() {
            let touched = if above { panel.region } else { panel.viewport };
            if slabs.is_empty() || !is_visible(touched) {
                continue;
            }
            limit(pass, panel.viewport);
            let [left, top, width, height] = touched;
            pass.set_scissor_rect(left, top, width, height);
            panels.bind_whole(pass, at);
            for [corners, pieces] in slabs {
                if !corners.is_empty() {
                    pass.set_pipeline(&self.panes[usize::from(above)]);
                    pass.set_vertex_buffer(0, self.corners.buffer().slice(..));
                    pass.draw(corners.clone(), 0..1);
                }
                if !pieces.is_empty() {
                    pass.set_pipeline(&self.edges[usize::from(above)]);
                    pass.set_vertex_buffer(0, self.pieces.buffer().slice(..));
                    pass.draw(0..4, pieces.clone());
                }
            }
        }
    }
}

/// Adds the triangles of a pane, around its middle.
fn add_fan(pane: &Pane, grid: glam::Vec3, corners: &mut Vec<PaneVertex>) {
    let count = pane.corners.len() as f32;
    let mean = |of: fn(&crate::picture::PaneCorner) -> glam::Vec3| {
        pane.corners.iter().map(of).sum::<glam::Vec3>() / count.max(1.0)
    };
    let position = mean(|corner| corner.position.into()).to_array();
    let on_grid = mean(|corner| glam::Vec2::from(corner.grid).extend(0.0)).truncate().to_array();
    let from_middle = mean(|corner| glam::Vec2::from(corner.from_middle).extend(0.0)).truncate().to_array();
    let colour = linear(pane.colour).extend(pane.alpha).to_array();
    let lined = grid.extend(if pane.grid { 1.0 } else { 0.0 }).to_array();
    let middle = PaneVertex { position, inward: 1.0, grid: on_grid, from_middle, colour, lined };
    let next = pane.corners.iter().cycle().skip(1);
    for (one, other) in pane.corners.iter().zip(next) {
        corners.push(middle);
        corners.extend([one, other].map(|corner| PaneVertex {
            position: corner.position,
            inward: 0.0,
            grid: corner.grid,
            from_middle: corner.from_middle,
            ..middle
        }));
    }
}
