//! The textures that pictures are drawn into.

use super::pipeline::{DEPTH_FORMAT, PICTURE_FORMAT, bind, group_layout, texture, texture_entry};
use crate::gpu::Gpu;
use wgpu::{LoadOp, TextureSampleType as Sample, TextureUsages as Usage};

/// A texture and the view of the whole of it.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
}

impl Target {
    pub(super) fn new(gpu: &Gpu, label: &str, [width, height]: [u32; 2], format: wgpu::TextureFormat) -> Self {
        let usage = Usage::RENDER_ATTACHMENT | Usage::TEXTURE_BINDING | Usage::COPY_SRC | Usage::COPY_DST;
        let texture = texture(gpu, label, [width, height, 1], format, usage);
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture }
    }
}

/// The layouts of the bindings of targets.
#[derive(Debug)]
pub(super) struct Layouts {
    pub(super) drawn: wgpu::BindGroupLayout,
    pub(super) behind: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let flat = wgpu::TextureViewDimension::D2;
        let depth = texture_entry(0, Sample::Depth, flat);
        let colour = texture_entry(1, Sample::Float { filterable: false }, flat);
        Self { drawn: group_layout(gpu, "drawn", &[depth]), behind: group_layout(gpu, "turned over", &[depth, colour]) }
    }
}

/// The depths of bodies or, of another one, of bodies and of the solid obstacles before them.
#[derive(Debug)]
pub(super) struct Drawn {
    pub(super) depth: Target,
    /// The depth, bound to be read.
    pub(super) group: wgpu::BindGroup,
}

impl Drawn {
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 2]) -> Self {
        let depth = Target::new(gpu, "depth", size, DEPTH_FORMAT);
        let group = bind(gpu, "drawn", &layouts.drawn, &[(0, wgpu::BindingResource::TextureView(&depth.view))]);
        Self { depth, group }
    }
}

/// The turned-over elements alone.
#[derive(Debug)]
pub(super) struct Behind {
    pub(super) colour: Target,
    pub(super) depth: Target,
    /// Both, bound to be read.
    pub(super) group: wgpu::BindGroup,
}

impl Behind {
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 2]) -> Self {
        let colour = Target::new(gpu, "turned over", size, PICTURE_FORMAT);
        let depth = Target::new(gpu, "depth of turned over", size, DEPTH_FORMAT);
        let [first, second] = [&depth.view, &colour.view].map(wgpu::BindingResource::TextureView);
        Self { group: bind(gpu, "turned over", &layouts.behind, &[(0, first), (1, second)]), colour, depth }
    }
}

/// Infinitely far away.
pub(super) const FAR: LoadOp<f32> = LoadOp::Clear(0.0);

/// Begins to draw into textures, with the one for depths.
pub(super) fn begin<'a>(
    commands: &'a mut wgpu::CommandEncoder,
    targets: &[(&'a Target, LoadOp<wgpu::Color>)],
    depth: Option<(&wgpu::TextureView, LoadOp<f32>)>,
) -> wgpu::RenderPass<'a> {
    let store = wgpu::StoreOp::Store;
    let target = |&(target, load): &(&'a Target, _)| {
        let ops = wgpu::Operations { load, store };
        Some(wgpu::RenderPassColorAttachment { view: &target.view, depth_slice: None, resolve_target: None, ops })
    };
    let targets: Vec<_> = targets.iter().map(target).collect();
    commands.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &targets,
        depth_stencil_attachment: depth.map(|(view, load)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations { load, store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
