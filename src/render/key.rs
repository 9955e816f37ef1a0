//! The maps of what is nearest to the key light, one for each panel: so bodies and obstacles cast shadows on each other.

use super::panel::{MAP_SIDE, Panels, map_layer};
use super::pipeline::{DEPTH_FORMAT, Recipe, for_vertices, shader, texture};
use super::surface::{Corner, Surfaces};
use super::target::{FAR, begin};
use crate::gpu::Gpu;
use crate::picture::Picture;
use wgpu::TextureUsages as Usage;

/// The maps of one picture.
#[derive(Debug)]
pub(super) struct KeyMaps {
    /// All maps, to be read, and each, to be drawn.
    pub(super) view: wgpu::TextureView,
    each: Vec<wgpu::TextureView>,
    /// Made when first needed.
    pipeline: Option<wgpu::RenderPipeline>,
}

impl KeyMaps {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let maps = made(gpu, [1, 1, 1]);
        Self { view: view(&maps), each: Vec::new(), pipeline: None }
    }

    /// Prepares the maps that a picture needs. Returns whether they are other textures than before.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) -> bool {
        let layers = (0..picture.panels.len()).filter_map(|at| map_layer(picture, at)).count();
        if layers == 0 {
            return false;
        }
        self.pipeline.get_or_insert_with(|| {
            let module = shader(gpu, "key light", &[super::PANEL_SHADER, super::KEY_SHADER]);
            let position = &wgpu::vertex_attr_array![0 => Float32x3];
            let vertices = &[Some(for_vertices::<Corner>(position))];
            let recipe = Recipe::new("key light", &module, ["caster_corner", ""]);
            Recipe { groups: &[&panels.alone], vertices, targets: 0, ..recipe }.build(gpu)
        });
        let is_new = self.each.len() < layers;
        if is_new {
            let maps = made(gpu, [MAP_SIDE, MAP_SIDE, layers as u32]);
            self.view = view(&maps);
            self.each = (0..layers as u32).map(|at| layer_view(&maps, at)).collect();
        }
        is_new
    }

    /// Draws the maps of a picture, whose surfaces have been uploaded.
    pub(super) fn draw(
        &self,
        commands: &mut wgpu::CommandEncoder,
        panels: &Panels,
        surfaces: &Surfaces,
        picture: &Picture,
    ) {
        let Some(pipeline) = &self.pipeline else { return };
        let layers = (0..picture.panels.len()).filter_map(|at| map_layer(picture, at).map(|layer| (at, layer)));
        for (at, layer) in layers {
            let mut pass = begin(commands, &[], Some((&self.each[layer], FAR)));
            pass.set_pipeline(pipeline);
            panels.bind_alone(&mut pass, at);
            surfaces.draw_all(&mut pass, at);
        }
    }
}

fn made(gpu: &Gpu, size: [u32; 3]) -> wgpu::Texture {
    texture(gpu, "key light", size, DEPTH_FORMAT, Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING)
}

fn layer_view(maps: &wgpu::Texture, layer: u32) -> wgpu::TextureView {
    maps.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

fn view(maps: &wgpu::Texture) -> wgpu::TextureView {
    let dimension = Some(wgpu::TextureViewDimension::D2Array);
    maps.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
}
