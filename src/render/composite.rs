//! Blending bodies and their lines over the ground.

use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{PICTURE_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::Gpu;
use crate::picture::{Panel, Picture};

pub(super) const SHADER: &str = include_str!("../../shaders/composite.wgsl");

/// The pipelines without and with the fading of solid obstacles at the sides of their room, made when they are first
/// needed.
#[derive(Debug)]
pub(super) struct Composite {
    module: wgpu::ShaderModule,
    pipelines: [Option<Pipeline>; 2],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

impl Composite {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let module = shader(gpu, "composite", &[super::PANEL_SHADER, super::BODIES_SHADER, SHADER]);
        let layout = group_layout(gpu, "bodies", &[0, 2, 3].map(|binding| texture_entry(binding, false)));
        Self { module, pipelines: [None, None], layout, textures: None }
    }

    /// Prepares to draw a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, panels: &Panels, picture: &Picture) {
        for at in picture.panels.iter().map(way) {
            let [label, fragment] = [["composite", "layered"], ["composite_fading", "layered_fading"]][at];
            let build = || {
                let recipe = Recipe {
                    groups: &[&panels.layout, &self.layout],
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    ..Recipe::rectangles(label, &self.module, ["corner", fragment], PICTURE_FORMAT)
                };
                recipe.build(gpu)
            };
            self.pipelines[at].get_or_insert_with(build);
        }
    }

    /// Binds new textures.
    pub(super) fn retarget(&mut self, gpu: &Gpu, bodies: &Bodies) {
        let views = [(0, &bodies.colour), (2, &bodies.lines), (3, &bodies.borders)];
        self.textures = Some(bind_textures(gpu, "bodies", &self.layout, &views));
    }

    /// Draws the bodies of all panels into the picture.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, panels: &Panels, picture: &Picture) {
        pass.set_bind_group(1, self.textures.as_ref(), &[]);
        panels.draw_regions(pass, picture.panels.iter().map(|panel| panel.region), |pass, at| {
            pass.set_pipeline(self.pipelines[way(&picture.panels[at])].as_ref().expect("prepared"));
            pass.draw(0..4, 0..1);
        });
    }
}

/// The pipeline of a panel.
fn way(panel: &Panel) -> usize {
    usize::from(panel.obstacles.fade.is_some())
}
