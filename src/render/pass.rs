//! Passes of drawing.

use super::pipeline::Pipeline;
use crate::gpu::{Gpu, Work};
use std::ops::{Deref, DerefMut, Range};

/// A pass that skips empty draws and notes the others.
pub(super) struct Pass<'a> {
    pass: wgpu::RenderPass<'a>,
    gpu: &'a Gpu,
    label: &'static str,
}

impl<'a> Pass<'a> {
    pub(super) fn begin(
        gpu: &'a Gpu,
        commands: &'a mut wgpu::CommandEncoder,
        label: &'static str,
        targets: &[(&wgpu::TextureView, wgpu::LoadOp<wgpu::Color>)],
        depth: Option<(&wgpu::TextureView, wgpu::LoadOp<f32>)>,
    ) -> Self {
        let target = |&(view, load)| {
            let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
            Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
        };
        let targets: Vec<_> = targets.iter().map(target).collect();
        let pass = commands.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(label),
            color_attachments: &targets,
            depth_stencil_attachment: depth.map(|(view, load)| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        Self { pass, gpu, label }
    }

    pub(super) fn set_pipeline(&mut self, pipeline: &Pipeline) {
        self.label = pipeline.label;
        self.pass.set_pipeline(&pipeline.pipeline);
    }

    pub(super) fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        if !vertices.is_empty() && !instances.is_empty() {
            self.gpu.note(Work::Draw(self.label));
            self.pass.draw(vertices, instances);
        }
    }

    pub(super) fn draw_indexed(&mut self, indices: Range<u32>) {
        if !indices.is_empty() {
            self.gpu.note(Work::Draw(self.label));
            self.pass.draw_indexed(indices, 0, 0..1);
        }
    }
}

impl<'a> Deref for Pass<'a> {
    type Target = wgpu::RenderPass<'a>;

    fn deref(&self) -> &Self::Target {
        &self.pass
    }
}

impl DerefMut for Pass<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.pass
    }
}
