//! Blending bodies and their lines over the ground.

use super::panel::Panels;
use super::pass::Pass;
use super::pipeline::{PICTURE_FORMAT, Pipeline, Recipe, bind_textures, group_layout, shader, texture_entry};
use super::target::Bodies;
use crate::gpu::Gpu;
use crate::picture::Picture;

pub(super) const SHADER: &str = include_str!("../../shaders/composite.wgsl");

/// The pipelines that blend them: where solid obstacles do not fade at the sides of their room, and where they do.
#[derive(Debug)]
pub(super) struct Composite {
    pipelines: [Pipeline; 2],
    layout: wgpu::BindGroupLayout,
    textures: Option<wgpu::BindGroup>,
}

impl Composite {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "composite", &[super::PANEL_SHADER, super::BODIES_SHADER, SHADER]);
        let layout = group_layout(gpu, "bodies", &[0, 2, 3].map(|binding| texture_entry(binding, false)));
        let pipelines = ["layered", "layered_fading"].map(|fragment| {
            let recipe = Recipe {
                groups: &[&panels.layout, &layout],
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                ..Recipe::rectangles("composite", &module, ["corner", fragment], PICTURE_FORMAT)
            };
            recipe.build(gpu)
        });
        Self { pipelines, layout, textures: None }
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
            pass.set_pipeline(&self.pipelines[usize::from(picture.panels[at].obstacles.fade.is_some())]);
            pass.draw(0..4, 0..1);
        });
    }
}
