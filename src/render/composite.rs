//! Blending bodies and their lines over the ground.

use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{PICTURE_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::Gpu;
use crate::picture::Picture;

pub(super) const SHADER: &str = include_str!("../../shaders/composite.wgsl");

/// The pipeline that blends them.
#[derive(Debug)]
pub(super) struct Composite {
    pipeline: Pipeline,
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

impl Composite {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "composite", &[super::PANEL_SHADER, super::BODIES_SHADER, SHADER]);
        let layout = group_layout(gpu, "bodies", &[0, 2, 3].map(|binding| texture_entry(binding, false)));
        let recipe = Recipe {
            groups: &[&panels.layout, &layout],
            blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            ..Recipe::rectangles("composite", &module, ["corner", "layered"], PICTURE_FORMAT)
        };
        Self { pipeline: recipe.build(gpu), layout, textures: None }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(0, &bodies.colour), (2, &bodies.lines), (3, &bodies.borders)];
        self.textures = Some(bind_textures(gpu, "bodies", &self.layout, &views));
    }

    /// Draws the bodies of all panels into the picture.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, picture: &Picture) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, self.textures.as_ref(), &[]);
        panels.draw_regions(pass, picture.panels.iter().map(|panel| panel.region), |pass, _| pass.draw(0..4, 0..1));
    }
}
