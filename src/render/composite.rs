//! Blending bodies and their lines over the ground.

use super::pass::Pass;
use super::pipeline::{PICTURE_FORMAT, Pipeline, Recipe, shader};
use super::stage::Stage;
use super::target::Bodies;
use crate::picture::{Panel, Picture};

const SHADER: &str = include_str!("../../shaders/composite.wgsl");

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 3] {
    [super::PANEL_SHADER, super::BODIES_SHADER, SHADER]
}

/// The pipelines without and with the fading of solid obstacles at the sides of their room, made when they are first
/// needed.
#[derive(Debug, Default)]
pub(super) struct Composite([Option<Pipeline>; 2]);

impl Composite {
    /// Prepares to draw a picture.
    pub(super) fn write(&mut self, stage: &Stage, picture: &Picture) {
        for at in picture.panels.iter().map(way) {
            let [label, fragment] = [["composite", "layered"], ["composite_fading", "layered_fading"]][at];
            let build = || {
                let module = shader(&stage.gpu, "composite", &parts());
                let recipe = Recipe {
                    groups: &[&stage.panels.layout, &stage.layouts.drawn, &stage.layouts.over],
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    ..Recipe::rectangles(label, &module, ["corner", fragment], PICTURE_FORMAT)
                };
                recipe.build(&stage.gpu)
            };
            self.0[at].get_or_insert_with(build);
        }
    }

    /// Draws the bodies of all panels into the picture.
    pub(super) fn draw(&self, pass: &mut Pass<'_>, stage: &Stage, bodies: &Bodies, picture: &Picture) {
        pass.set_bind_group(1, &bodies.drawn, &[]);
        pass.set_bind_group(2, &bodies.over, &[]);
        stage.panels.draw_regions(pass, picture.panels.iter().map(|panel| panel.region), |pass, at| {
            pass.set_pipeline(self.0[way(&picture.panels[at])].as_ref().expect("prepared"));
            pass.draw(0..4, 0..1);
        });
    }
}

/// The pipeline of a panel.
fn way(panel: &Panel) -> usize {
    usize::from(panel.obstacles.fade.is_some())
}
