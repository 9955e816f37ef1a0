//! The textures that pictures are drawn into.

use super::pipeline::{BODY_FORMAT, BORDER_FORMAT, DEPTH_FORMAT, LINE_FORMAT, PICTURE_FORMAT};
use crate::gpu::Gpu;

/// Textures of bodies grow in steps of this length (px), so that a moving body seldom needs new ones.
const STEP: u32 = 64;

/// The finished picture.
#[derive(Debug)]
pub(super) struct Canvas {
    pub(super) texture: wgpu::Texture,
    pub(super) view: wgpu::TextureView,
}

impl Canvas {
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PICTURE_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture }
    }
}

/// The textures of bodies, with their regions side by side.
#[derive(Debug)]
pub(super) struct Bodies {
    pub(super) size: [u32; 2],
    /// The whole bodies.
    pub(super) colour: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
    /// Whether the next two have the full size, or a single pixel that is never read.
    has_behind: bool,
    /// The turned-over elements alone.
    pub(super) alarm_colour: wgpu::TextureView,
    pub(super) alarm_depth: wgpu::TextureView,
    /// The light that borders add to pixels.
    pub(super) borders: wgpu::TextureView,
    /// Opacities of lines.
    pub(super) lines: wgpu::TextureView,
}

impl Bodies {
    /// Textures of a size, with or without the turned-over set alone.
    pub(super) fn new(gpu: &Gpu, size: [u32; 2], has_behind: bool) -> Self {
        let texture = |label, size, format, copied| {
            let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(size),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING | copied,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let none = wgpu::TextureUsages::empty();
        let behind = if has_behind { size } else { [1; 2] };
        Self {
            size,
            colour: texture("bodies", size, BODY_FORMAT, none),
            depth: texture("depth of bodies", size, DEPTH_FORMAT, wgpu::TextureUsages::COPY_DST),
            has_behind,
            alarm_colour: texture("turned over", behind, BODY_FORMAT, none),
            alarm_depth: texture("depth of turned over", behind, DEPTH_FORMAT, wgpu::TextureUsages::COPY_SRC),
            borders: texture("borders", size, BORDER_FORMAT, none),
            lines: texture("lines", size, LINE_FORMAT, none),
        }
    }

    /// Gives the bodies the depth of the turned-over elements.
    pub(super) fn copy_depth(&self, commands: &mut wgpu::CommandEncoder) {
        let [from, to] = [&self.alarm_depth, &self.depth].map(|view| view.texture().as_image_copy());
        commands.copy_texture_to_texture(from, to, extent(self.size));
    }

    /// Whether regions of a size fit, with space for items behind surfaces if there are any, and fill enough of the
    /// textures that smaller ones would hardly be quicker.
    pub(super) fn suit(&self, needed: [u32; 2], has_behind: bool) -> bool {
        let area = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
        let fits = needed[0] <= self.size[0] && needed[1] <= self.size[1];
        fits && (self.has_behind || !has_behind) && 2 * area(rounded(needed)) >= area(self.size)
    }
}

/// The size of textures for regions of a size (px).
pub(super) fn rounded(needed: [u32; 2]) -> [u32; 2] {
    needed.map(|length| length.max(1).next_multiple_of(STEP))
}

fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}
