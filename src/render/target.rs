//! The textures that pictures are drawn into, and their bindings for the passes that read them.

use super::pipeline::{
    BODY_FORMAT, BORDER_FORMAT, DEPTH_FORMAT, LINE_FORMAT, PICTURE_FORMAT, bind_textures, group_layout, texture_entry,
};
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
        let texture = texture(gpu, "picture", size, PICTURE_FORMAT, wgpu::TextureUsages::COPY_SRC);
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture }
    }
}

/// The layouts of the bindings of [`Bodies`], with the numbers of `shaders/bodies.wgsl`.
#[derive(Debug)]
pub(super) struct Layouts {
    /// The turned-over elements alone.
    pub(super) behind: wgpu::BindGroupLayout,
    /// The drawn bodies, and the depth of the turned-over elements alone.
    pub(super) drawn: wgpu::BindGroupLayout,
    /// Lines and borders over the bodies.
    pub(super) over: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let [colour, depth] = [false, true].map(|is_depth| move |binding| texture_entry(binding, is_depth));
        Self {
            behind: group_layout(gpu, "turned over", &[depth(2), colour(3)]),
            drawn: group_layout(gpu, "bodies", &[colour(0), depth(1), depth(2)]),
            over: group_layout(gpu, "over bodies", &[colour(4), colour(5)]),
        }
    }
}

/// The textures of bodies, with their regions side by side.
#[derive(Debug)]
pub(super) struct Bodies {
    size: [u32; 2],
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
    /// The bindings in the layouts of the same names.
    pub(super) behind: wgpu::BindGroup,
    pub(super) drawn: wgpu::BindGroup,
    pub(super) over: wgpu::BindGroup,
}

impl Bodies {
    /// Textures of a size, with or without the turned-over set alone.
    pub(super) fn new(gpu: &Gpu, layouts: &Layouts, size: [u32; 2], has_behind: bool) -> Self {
        let view = |label, size, format, copied| {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | copied;
            texture(gpu, label, size, format, usage).create_view(&wgpu::TextureViewDescriptor::default())
        };
        let none = wgpu::TextureUsages::empty();
        let small = if has_behind { size } else { [1; 2] };
        let colour = view("bodies", size, BODY_FORMAT, none);
        let depth = view("depth of bodies", size, DEPTH_FORMAT, wgpu::TextureUsages::COPY_DST);
        let alarm_colour = view("turned over", small, BODY_FORMAT, none);
        let alarm_depth = view("depth of turned over", small, DEPTH_FORMAT, wgpu::TextureUsages::COPY_SRC);
        let borders = view("borders", size, BORDER_FORMAT, none);
        let lines = view("lines", size, LINE_FORMAT, none);
        let drawn = [(0, &colour), (1, &depth), (2, &alarm_depth)];
        Self {
            behind: bind_textures(gpu, "turned over", &layouts.behind, &[(2, &alarm_depth), (3, &alarm_colour)]),
            drawn: bind_textures(gpu, "bodies", &layouts.drawn, &drawn),
            over: bind_textures(gpu, "over bodies", &layouts.over, &[(4, &lines), (5, &borders)]),
            size,
            colour,
            depth,
            has_behind,
            alarm_colour,
            alarm_depth,
            borders,
            lines,
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

/// A texture that is drawn into.
fn texture(
    gpu: &Gpu,
    label: &str,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
        view_formats: &[],
    })
}
