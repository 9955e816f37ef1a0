//! Surfaces of bodies: the turned-over set by itself, then both sets with all samples.

use super::panel::{Panels, is_visible, limit};
use super::pipeline::{BODY_FORMAT, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use super::tint::Tint;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{MOST_OCCLUDERS, Mesh, Picture, Rectangle, Vertex};
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

/// What light knows of obstacles near a body, where there are none and where there are some.
const ALONE_SHADER: &str = include_str!("../../shaders/light_alone.wgsl");
const AMONG_SHADER: &str = include_str!("../../shaders/light_among.wgsl");

/// How many obstacles there are. A shader that knows it need not count, which saves drawing on a processor much time.
const COUNTS: [&str; MOST_OCCLUDERS + 1] = [
    "",
    "const OCCLUDERS = 1u;\n",
    "const OCCLUDERS = 2u;\n",
    "const OCCLUDERS = 3u;\n",
    "const OCCLUDERS = 4u;\n",
    "const OCCLUDERS = 5u;\n",
];

/// The parts of the shader, for a number of samples and of obstacles near a body.
pub(super) fn parts(samples: u32, occluders: usize) -> [&'static str; 6] {
    let obstacles = if occluders > 0 { AMONG_SHADER } else { ALONE_SHADER };
    let [samples, alarm] = [super::samples_shader(samples), super::alarm_shader(samples)];
    [super::PANEL_SHADER, samples, alarm, COUNTS[occluders], obstacles, SHADER]
}

/// How many obstacles take light away from a body of a picture at the most.
pub(super) fn occluders(picture: &Picture) -> usize {
    let counts = picture.panels.iter().map(|panel| panel.obstacles.occluders.len());
    counts.max().unwrap_or(0).min(MOST_OCCLUDERS)
}

/// A thing for each number of obstacles near a body, made when it is first needed.
pub(super) type ForOccluders<T> = [Option<T>; MOST_OCCLUDERS + 1];

/// How surfaces are drawn.
#[derive(Debug)]
pub(super) struct Ways {
    pub(super) alarm_behind: wgpu::RenderPipeline,
    pub(super) alarm: wgpu::RenderPipeline,
    pub(super) sound: wgpu::RenderPipeline,
}

/// What surfaces read of what lies behind them.
pub(super) fn behind_entries(samples: u32) -> [wgpu::BindGroupLayoutEntry; 2] {
    [texture_entry(2, true, samples), texture_entry(3, false, samples)]
}

/// The pipelines of the surfaces, and the meshes of one picture.
#[derive(Debug)]
pub(super) struct Surfaces {
    /// Made when they are first needed.
    ways: ForOccluders<Ways>,
    samples: u32,
    behind_layout: wgpu::BindGroupLayout,
    behind: Option<wgpu::BindGroup>,
    vertices: GrowingBuffer<Vertex>,
    indices: GrowingBuffer<u32>,
    /// The indices of each panel's two sets: sound, turned over.
    ranges: Vec<[Range<u32>; 2]>,
}

impl Surfaces {
    pub(super) fn new(gpu: &Gpu, samples: u32) -> Self {
        let behind_layout = group_layout(gpu, "turned over", &behind_entries(samples));
        Self {
            ways: ForOccluders::default(),
            samples,
            behind_layout,
            behind: None,
            vertices: GrowingBuffer::new(gpu, "vertices", wgpu::BufferUsages::VERTEX, 1024),
            indices: GrowingBuffer::new(gpu, "indices", wgpu::BufferUsages::INDEX, 4096),
            ranges: Vec::new(),
        }
    }

    fn made(gpu: &Gpu, panels: &Panels, behind: &wgpu::BindGroupLayout, samples: u32, occluders: usize) -> Ways {
        let module = shader(gpu, "surface", &parts(samples, occluders));
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
        Ways {
            alarm_behind: build("turned over, behind", ["alarm_corner", "alarm_behind"], &[&panels.layout]),
            alarm: build("turned over", ["alarm_corner", "alarm_surface"], &[&panels.layout]),
            sound: build("sound", ["sound_corner", "sound_surface"], &[&panels.layout, behind]),
        }
    }

    /// Prepares to draw a picture without a field.
    pub(super) fn prepare(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) {
        let count = occluders(picture);
        let made = || Self::made(gpu, panels, &self.behind_layout, self.samples, count);
        self.ways[count].get_or_insert_with(made);
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

    fn ways(&self, occluders: usize) -> &Ways {
        self.ways[occluders].as_ref().expect("prepared")
    }

    /// Draws the turned-over sets by themselves, coloured by a field if there is a tint.
    pub(super) fn draw_behind(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        tint: Option<&Tint>,
        occluders: usize,
    ) {
        let pipeline = match tint {
            Some(tint) => {
                pass.set_bind_group(1, &tint.alarm_group, &[]);
                pass.set_vertex_buffer(1, tint.shades.buffer().slice(..));
                &tint.ways(occluders).alarm_behind
            }
            None => &self.ways(occluders).alarm_behind,
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
        occluders: usize,
    ) {
        let Some(tint) = tint else {
            let ways = self.ways(occluders);
            self.draw(pass, &ways.alarm, panels, places, 1);
            pass.set_bind_group(1, self.behind.as_ref(), &[]);
            return self.draw(pass, &ways.sound, panels, places, 0);
        };
        let ways = tint.ways(occluders);
        pass.set_vertex_buffer(1, tint.shades.buffer().slice(..));
        pass.set_bind_group(1, &tint.alarm_group, &[]);
        self.draw(pass, &ways.alarm, panels, places, 1);
        pass.set_bind_group(1, &tint.sound_group, &[]);
        self.draw(pass, &ways.sound, panels, places, 0);
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
