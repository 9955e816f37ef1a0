//! Surfaces of bodies: first the turned-over set, alone and as seen through the body, then the other set over it.

use super::panel::{Panels, has_behind};
use super::pass::Pass;
use super::pipeline::{Pipeline, Recipe, bind_textures, for_vertices, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{MOST_OCCLUDERS, Mesh, Picture, Rectangle, Vertex};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/surface.wgsl");

const ATTRIBUTES: [wgpu::VertexAttribute; 3] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32];

/// The layout of corners in their buffer.
pub(super) fn vertices() -> wgpu::VertexBufferLayout<'static> {
    for_vertices::<Vertex>(&ATTRIBUTES)
}

/// The part of the shader for occlusion by obstacles near a body, without obstacles and with some.
const ALONE_SHADER: &str = include_str!("../../shaders/light_alone.wgsl");
const AMONG_SHADER: &str = include_str!("../../shaders/light_among.wgsl");

/// The number of obstacles is a constant, so that the loop is unrolled: much faster with a software driver.
const COUNTS: [&str; MOST_OCCLUDERS + 1] = [
    "",
    "const OCCLUDERS = 1u;\n",
    "const OCCLUDERS = 2u;\n",
    "const OCCLUDERS = 3u;\n",
    "const OCCLUDERS = 4u;\n",
    "const OCCLUDERS = 5u;\n",
];

/// The parts of the shader, for a number of obstacles near a body.
pub(super) fn parts(occluders: usize) -> [&'static str; 5] {
    let obstacles = if occluders > 0 { AMONG_SHADER } else { ALONE_SHADER };
    [super::PANEL_SHADER, super::TURNED_OVER_SHADER, COUNTS[occluders], obstacles, SHADER]
}

/// The largest number of obstacles near one of the bodies of a picture.
pub(super) fn occluders(picture: &Picture) -> usize {
    let counts = picture.panels.iter().map(|panel| panel.obstacles.occluders.len());
    counts.max().unwrap_or(0).min(MOST_OCCLUDERS)
}

/// Pipelines by number of obstacles near a body, made when first needed.
pub(super) type ForOccluders<T> = [Option<T>; MOST_OCCLUDERS + 1];

/// The pipelines that draw surfaces.
#[derive(Debug)]
pub(super) struct Pipelines {
    /// Pipelines into two targets: as seen through the body, and as surfaces of it.
    pub(super) alarm: Pipeline,
    pub(super) sound: Pipeline,
    /// Pipelines where something lies behind, or elements are flat.
    pub(super) before: Pipeline,
}

/// The two sets of elements of a panel, in stored order.
const SOUND: usize = 0;
const TURNED_OVER: usize = 1;

/// The pipelines and bindings for the surfaces of panels, plain or coloured by a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colouring<'a> {
    pub(super) pipelines: &'a Pipelines,
    /// The bindings of each set, without the panel.
    pub(super) groups: [Option<&'a wgpu::BindGroup>; 2],
    /// The places of corners on the scale of a field, in a second vertex buffer.
    pub(super) shades: Option<&'a wgpu::Buffer>,
}

/// The textures of the turned-over set, seen through the other surfaces.
pub(super) fn behind_entries() -> [wgpu::BindGroupLayoutEntry; 2] {
    [texture_entry(2, true), texture_entry(3, false)]
}

/// The pipelines of surfaces and the meshes of one picture.
#[derive(Debug)]
pub(super) struct Surfaces {
    /// Made when first needed.
    pipelines: ForOccluders<Pipelines>,
    behind_layout: wgpu::BindGroupLayout,
    behind: Option<wgpu::BindGroup>,
    vertices: GrowingBuffer<Vertex>,
    indices: GrowingBuffer<u32>,
    /// The indices of the two sets of each panel.
    ranges: Vec<[Range<u32>; 2]>,
    /// Whether anything lies behind a panel's surfaces or is dotted.
    with_behind: Vec<bool>,
}

impl Surfaces {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let behind_layout = group_layout(gpu, "turned over", &behind_entries());
        Self {
            pipelines: ForOccluders::default(),
            behind_layout,
            behind: None,
            vertices: GrowingBuffer::new(gpu, "vertices", wgpu::BufferUsages::VERTEX, 1024),
            indices: GrowingBuffer::new(gpu, "indices", wgpu::BufferUsages::INDEX, 4096),
            ranges: Vec::new(),
            with_behind: Vec::new(),
        }
    }

    fn made(gpu: &Gpu, panels: &Panels, behind: &wgpu::BindGroupLayout, occluders: usize) -> Pipelines {
        let module = shader(gpu, "surface", &parts(occluders));
        let build = |label, entries, groups: &[&wgpu::BindGroupLayout], targets| {
            let vertices = &[Some(vertices())];
            let recipe = Recipe { groups, vertices, targets, ..Recipe::bodies(label, &module, entries) };
            recipe.build(gpu)
        };
        Pipelines {
            alarm: build("turned over", ["alarm_corner", "alarm_surface"], &[&panels.layout], 2),
            sound: build("sound", ["sound_corner", "sound_surface"], &[&panels.layout], 1),
            before: build("sound, before others", ["sound_corner", "sound_before"], &[&panels.layout, behind], 1),
        }
    }

    /// Prepares to draw a picture without a field.
    pub(super) fn prepare(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) {
        let count = occluders(picture);
        let made = || Self::made(gpu, panels, &self.behind_layout, count);
        self.pipelines[count].get_or_insert_with(made);
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
        self.with_behind = picture.panels.iter().map(has_behind).collect();
        self.vertices.write(gpu, vertices);
        self.indices.write(gpu, indices);
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(2, &bodies.alarm_depth), (3, &bodies.alarm_colour)];
        self.behind = Some(bind_textures(gpu, "turned over", &self.behind_layout, &views));
    }

    /// The pipelines without a field, prepared for a number of obstacles near a body.
    pub(super) fn plain(&self, occluders: usize) -> Colouring<'_> {
        let pipelines = self.pipelines[occluders].as_ref().expect("prepared");
        Colouring { pipelines, groups: [self.behind.as_ref(), None], shades: None }
    }

    /// Draws the turned-over sets, as seen through the bodies and as surfaces of them.
    pub(super) fn draw_turned_over(
        &self,
        pass: &mut Pass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        colouring: Colouring<'_>,
    ) {
        self.draw(pass, panels, places, colouring, |pipelines| &pipelines.alarm, (TURNED_OVER, true));
    }

    /// Draws the other sets over the turned-over ones.
    pub(super) fn draw_sound(
        &self,
        pass: &mut Pass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        colouring: Colouring<'_>,
    ) {
        self.draw(pass, panels, places, colouring, |pipelines| &pipelines.sound, (SOUND, false));
        self.draw(pass, panels, places, colouring, |pipelines| &pipelines.before, (SOUND, true));
    }

    fn draw(
        &self,
        pass: &mut Pass<'_>,
        panels: &Panels,
        places: &[Rectangle],
        colouring: Colouring<'_>,
        pipeline: fn(&Pipelines) -> &Pipeline,
        (set, with_behind): (usize, bool),
    ) {
        if !self.with_behind.contains(&with_behind) {
            return;
        }
        pass.set_vertex_buffer(0, self.vertices.buffer().slice(..));
        pass.set_index_buffer(self.indices.buffer().slice(..), wgpu::IndexFormat::Uint32);
        pass.set_pipeline(pipeline(colouring.pipelines));
        if let Some(group) = colouring.groups[set] {
            pass.set_bind_group(1, group, &[]);
        }
        if let Some(shades) = colouring.shades {
            pass.set_vertex_buffer(1, shades.slice(..));
        }
        let own = |(panel, &place): (usize, &Rectangle)| match self.with_behind[panel] == with_behind {
            true => place,
            false => [0; 4],
        };
        panels.draw_regions(pass, places.iter().enumerate().map(own), |pass, panel| {
            pass.draw_indexed(self.ranges[panel][set].clone());
        });
    }
}
