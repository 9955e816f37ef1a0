//! Surfaces of bodies: the turned-over set by itself, then both sets with all samples.

use super::panel::{Panels, is_visible, limit};
use super::pipeline::{BODY_FORMAT, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use super::tint::Tint;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Mesh, Picture, Rectangle, Vertex};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/surface.wgsl");

const ATTRIBUTES: [wgpu::VertexAttribute; 3] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32];

/// How corners lie in their buffer.
pub(super) fn vertices() -> wgpu::VertexBufferLayout<'static> {
    wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &ATTRIBUTES,
    }
}

/// The parts of the shader, for a number of samples.
pub(super) fn parts(samples: u32) -> [&'static str; 4] {
    [super::PANEL_SHADER, super::samples_shader(samples), super::alarm_shader(samples), SHADER]
}

/// What surfaces read of what lies behind them.
pub(super) fn behind_entries(samples: u32) -> [wgpu::BindGroupLayoutEntry; 2] {
    [texture_entry(2, true, samples), texture_entry(3, false, samples)]
}

/// The pipelines of the surfaces, and the meshes of one picture.
#[derive(Debug)]
pub(super) struct Surfaces {
    alarm_behind: wgpu::RenderPipeline,
    alarm: wgpu::RenderPipeline,
    sound: wgpu::RenderPipeline,
    behind_layout: wgpu::BindGroupLayout,
    behind: Option<wgpu::BindGroup>,
    vertices: GrowingBuffer<Vertex>,
    indices: GrowingBuffer<u32>,
    /// The indices of each panel's two sets: sound, turned over.
    ranges: Vec<[Range<u32>; 2]>,
}

impl Surfaces {
    pub(super) fn new(gpu: &Gpu, panels: &Panels, samples: u32) -> Self {
        let module = shader(gpu, "surface", &parts(samples));
        let behind_layout = group_layout(gpu, "turned over", &behind_entries(samples));
        let build = |label, entries, groups: &[&wgpu::BindGroupLayout]| {
            let recipe = Recipe {
                label,
                shader: &module,
                entries,
                groups,
                vertices: &[Some(vertices())],
                topology: wgpu::PrimitiveTopology::TriangleList,
                target: BODY_FORMAT,
                blend: None,
                depth: true,
                samples,
            };
            recipe.build(gpu)
        };
        Self {
            alarm_behind: build("turned over, behind", ["alarm_corner", "alarm_behind"], &[&panels.layout]),
            alarm: build("turned over", ["alarm_corner", "alarm_surface"], &[&panels.layout]),
            sound: build("sound", ["sound_corner", "sound_surface"], &[&panels.layout, &behind_layout]),
            behind_layout,
            behind: None,
            vertices: GrowingBuffer::new(gpu, "vertices", wgpu::BufferUsages::VERTEX, 1024),
            indices: GrowingBuffer::new(gpu, "indices", wgpu::BufferUsages::INDEX, 4096),
            ranges: Vec::new(),
        }
    }

    /// Uploads the meshes of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let (mut vertices, mut indices) = (Vec::new(), Vec::new());
        let mut add = |mesh: &Mesh| {
            let (base, start) = (vertices.len() as u32, indices.len() as u32);
            vertices.extend_from_slice(&mesh.vertices);
            indices.extend(mesh.triangles.iter().flatten().map(|at| base + at));
            start..indices.len() as u32
        };
        self.ranges = picture.panels.iter().map(|panel| [add(&panel.sound), add(&panel.turned_over)]).collect();
        self.vertices.write(gpu, &vertices);
        self.indices.write(gpu, &indices);
    }

    /// Takes note of new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(2, &bodies.alarm_depth), (3, &bodies.alarm_colour)];
        self.behind = Some(bind_textures(gpu, "turned over", &self.behind_layout, &views));
    }

    /// Draws the turned-over sets by themselves, coloured by a field if there is a tint.
    pub(super) fn draw_behind(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        tint: Option<&Tint>,
    ) {
        let pipeline = match tint {
            Some(tint) => {
                pass.set_bind_group(1, &tint.alarm_group, &[]);
                pass.set_vertex_buffer(1, tint.shades.buffer().slice(..));
                &tint.alarm_behind
            }
            None => &self.alarm_behind,
        };
        self.draw(pass, pipeline, panels, places, 1);
    }

    /// Draws everything, coloured by a field if there is a tint.
    pub(super) fn draw_all(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        tint: Option<&Tint>,
    ) {
        let Some(tint) = tint else {
            self.draw(pass, &self.alarm, panels, places, 1);
            pass.set_bind_group(1, self.behind.as_ref(), &[]);
            return self.draw(pass, &self.sound, panels, places, 0);
        };
        pass.set_vertex_buffer(1, tint.shades.buffer().slice(..));
        pass.set_bind_group(1, &tint.alarm_group, &[]);
        self.draw(pass, &tint.alarm, panels, places, 1);
        pass.set_bind_group(1, &tint.sound_group, &[]);
        self.draw(pass, &tint.sound, panels, places, 0);
    }

    fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        panels: &Panels,
        places: &[Rectangle],
        set: usize,
    ) {
        pass.set_pipeline(pipeline);
        pass.set_vertex_buffer(0, self.vertices.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        for (panel, (ranges, &place)) in self.ranges.iter().zip(places).enumerate() {
            if is_visible(place) && !ranges[set].is_empty() {
                limit(pass, place);
                panels.bind_region(pass, panel);
                pass.draw_indexed(ranges[set].clone(), 0, 0..1);
            }
        }
    }
}
