//! Surfaces coloured by a scalar field.

use super::panel::{Panels, linear};
use super::pipeline::{Recipe, bind, for_vertices, group_layout, shader, uniform_entry};
use super::surface::{self, Colouring, ForOccluders, Pipelines};
use super::target::Bodies;
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Picture, SHADES};
use glam::Vec4;

pub(super) const SHADER: &str = include_str!("../../shaders/tint.wgsl");

const ATTRIBUTES: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![3 => Float32];

/// The pipelines of coloured surfaces with their scale, and the places of corners on it. Made for the first picture
/// that has a field.
#[derive(Debug)]
pub(super) struct Tint {
    pipelines: ForOccluders<Pipelines>,
    alarm_layout: wgpu::BindGroupLayout,
    /// The bindings: for turned-over sets the scale, for others also the items behind them.
    alarm_group: wgpu::BindGroup,
    sound_group: wgpu::BindGroup,
    sound_layout: wgpu::BindGroupLayout,
    ramp: GrowingBuffer<Vec4>,
    shades: GrowingBuffer<f32>,
}

impl Tint {
    pub(super) fn new(gpu: &Gpu, bodies: &Bodies) -> Self {
        let scale = || uniform_entry(4, SHADES * size_of::<Vec4>(), false);
        let alarm_layout = group_layout(gpu, "scale", &[scale()]);
        let [depth, colour] = surface::behind_entries();
        let behind = [depth, colour, scale()];
        let sound_layout = group_layout(gpu, "scale, turned over", &behind);
        let ramp = GrowingBuffer::new(gpu, "scale", wgpu::BufferUsages::UNIFORM, SHADES);
        Self {
            pipelines: ForOccluders::default(),
            alarm_group: bind(gpu, "scale", &alarm_layout, &[(4, ramp.buffer().as_entire_binding())]),
            alarm_layout,
            sound_group: sound_group(gpu, &sound_layout, &ramp, bodies),
            sound_layout,
            ramp,
            shades: GrowingBuffer::new(gpu, "shades", wgpu::BufferUsages::VERTEX, 1024),
        }
    }

    fn made(gpu: &Gpu, panels: &Panels, layouts: [&wgpu::BindGroupLayout; 2], occluders: usize) -> Pipelines {
        let module = shader(gpu, "tint", &[&surface::parts(occluders)[..], &[SHADER]].concat());
        let vertices = [Some(surface::vertices()), Some(for_vertices::<f32>(&ATTRIBUTES))];
        let build = |label, entries, layout, targets| {
            let recipe = Recipe {
                groups: &[&panels.layout, layout],
                vertices: &vertices,
                targets,
                ..Recipe::bodies(label, &module, entries)
            };
            recipe.build(gpu)
        };
        let [of_alarm, of_sound] = layouts;
        Pipelines {
            alarm: build("turned over, coloured", ["tinted_alarm_corner", "tinted_alarm"], of_alarm, 2),
            sound: build("sound, coloured", ["tinted_corner", "tinted_sound"], of_sound, 1),
            before: build("sound, coloured, before others", ["tinted_corner", "tinted_before"], of_sound, 1),
        }
    }

    /// Prepares to draw a picture.
    pub(super) fn prepare(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) {
        let count = surface::occluders(picture);
        let layouts = [&self.alarm_layout, &self.sound_layout];
        self.pipelines[count].get_or_insert_with(|| Self::made(gpu, panels, layouts, count));
    }

    /// The pipelines of the field, prepared for a number of obstacles near a body.
    pub(super) fn colouring(&self, occluders: usize) -> Colouring<'_> {
        Colouring {
            pipelines: self.pipelines[occluders].as_ref().expect("prepared"),
            groups: [Some(&self.sound_group), Some(&self.alarm_group)],
            shades: Some(self.shades.buffer()),
        }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        self.sound_group = sound_group(gpu, &self.sound_layout, &self.ramp, bodies);
    }

    /// Uploads the scale of a picture and the places of corners, in the order of its vertices.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let colours: Vec<_> = picture.ramp.iter().take(SHADES).map(|&colour| linear(colour).extend(1.0)).collect();
        self.ramp.write(gpu, colours);
        let meshes = picture.panels.iter().flat_map(|panel| [&panel.sound, &panel.turned_over]);
        self.shades.write(gpu, meshes.flat_map(|mesh| mesh.shades.iter().copied()).collect());
    }
}

fn sound_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    ramp: &GrowingBuffer<Vec4>,
    bodies: &Bodies,
) -> wgpu::BindGroup {
    let [depth, colour] = [&bodies.alarm_depth, &bodies.alarm_colour].map(wgpu::BindingResource::TextureView);
    bind(gpu, "scale, turned over", layout, &[(2, depth), (3, colour), (4, ramp.buffer().as_entire_binding())])
}
