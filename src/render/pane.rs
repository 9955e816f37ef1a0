//! Transparent obstacles: panes from the farthest to the nearest, over the finished bodies.

use super::panel::{Panels, linear};
use super::pipeline::{Recipe, for_vertices, shader};
use super::target::Layouts;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Palette, Pane, PaneCorner, Picture, around};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};
use std::ops::Range;

/// The parts of the shader.
pub(super) const PARTS: [&str; 3] = [super::PANEL_SHADER, super::KEY_SHADER, include_str!("../../shaders/pane.wgsl")];

/// A corner of a pane as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Corner {
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

const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x3, 1 => Float32, 2 => Float32x2, 3 => Float32x2, 4 => Float32x4, 5 => Float32x4
];

/// The pipeline and the panes of one picture. Made for the first picture that has any.
#[derive(Debug)]
pub(super) struct Panes {
    pipeline: wgpu::RenderPipeline,
    corners: GrowingBuffer,
    ranges: Vec<Range<u32>>,
}

impl Panes {
    /// Whether a picture has transparent obstacles.
    pub(super) fn are_in(picture: &Picture) -> bool {
        picture.panels.iter().any(|panel| !panel.obstacles.panes.is_empty())
    }

    pub(super) fn new(gpu: &Gpu, panels: &Panels, layouts: &Layouts) -> Self {
        let module = shader(gpu, "pane", &PARTS);
        let recipe = Recipe {
            groups: &[&panels.layout, &layouts.drawn],
            vertices: &[Some(for_vertices::<Corner>(&ATTRIBUTES))],
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            // Marks of bodies stay.
            writes: wgpu::ColorWrites::COLOR,
            depth: None,
            ..Recipe::new("pane", &module, ["pane_corner", "pane_colour"])
        };
        let corners = GrowingBuffer::new(gpu, "panes", wgpu::BufferUsages::VERTEX, 1 << 14);
        Self { pipeline: recipe.build(gpu), corners, ranges: Vec::new() }
    }

    /// Uploads the panes of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut corners = Vec::new();
        let ranges = picture.panels.iter().map(|panel| {
            let start = corners.len() as u32;
            panel.obstacles.panes.iter().for_each(|pane| add_fan(pane, &picture.palette, &mut corners));
            start..corners.len() as u32
        });
        self.ranges = ranges.collect();
        self.corners.write(gpu, &corners);
    }

    /// Draws the panes of all panels. The depths of bodies must be bound.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, picture: &Picture) {
        pass.set_pipeline(&self.pipeline);
        pass.set_vertex_buffer(0, self.corners.buffer().slice(..));
        for (at, (panel, range)) in picture.panels.iter().zip(&self.ranges).enumerate() {
            panels.bind(pass, at, panel, panel.viewport);
            pass.draw(range.clone(), 0..1);
        }
    }
}

/// Adds the triangles of a pane, around its middle.
fn add_fan(pane: &Pane, palette: &Palette, corners: &mut Vec<Corner>) {
    let share = 1.0 / (pane.corners.len() as f32).max(1.0);
    let mean = |of: fn(&PaneCorner) -> Vec3| pane.corners.iter().map(of).sum::<Vec3>() * share;
    let flat = |of: fn(&PaneCorner) -> Vec3| mean(of).truncate().to_array();
    let middle = Corner {
        position: mean(|corner| corner.position.into()).to_array(),
        inward: 1.0,
        grid: flat(|corner| Vec2::from(corner.grid).extend(0.0)),
        from_middle: flat(|corner| Vec2::from(corner.from_middle).extend(0.0)),
        colour: linear(pane.colour).extend(pane.alpha).to_array(),
        lined: linear(palette.grid).extend(if pane.grid { 1.0 } else { 0.0 }).to_array(),
    };
    for (one, other) in around(&pane.corners) {
        corners.push(middle);
        corners.extend([one, other].map(|&PaneCorner { position, grid, from_middle }| Corner {
            position,
            inward: 0.0,
            grid,
            from_middle,
            ..middle
        }));
    }
}
