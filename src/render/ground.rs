//! The floor with its grid and the soft shadows on it.

use super::panel::{Panels, linear};
use super::pipeline::{Recipe, bind, element, group_layout, shader, texture, texture_entry, uniform_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{CELLS, Floor, Panel, Picture, Rectangle, Shade};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

pub(super) const SHADER: &str = include_str!("../../shaders/ground.wgsl");

/// The struct `Ground` of the shader, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GroundUniform {
    pub(super) first: Vec4,
    pub(super) second: Vec4,
    pub(super) fade: [f32; 2],
    pub(super) fade_at_words: [f32; 2],
    pub(super) key: Vec4,
    pub(super) sky: Vec4,
    pub(super) background: Vec4,
    pub(super) floor: Vec4,
    pub(super) grid: Vec4,
    pub(super) shadow: Vec4,
    pub(super) viewport: Vec4,
}

/// The distance between the data of two panels in the buffer (bytes).
const STRIDE: usize = 256;
/// The most panels with shadows: a device need not have more layers in a texture.
const MOST_PANELS: usize = 128;

/// The pipeline of the floor and the floors of one picture.
#[derive(Debug)]
pub(super) struct Grounds {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    uniforms: GrowingBuffer,
    shades: wgpu::Texture,
    bind_group: Option<wgpu::BindGroup>,
}

impl Grounds {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "ground", &[super::PANEL_SHADER, SHADER]);
        let shades =
            texture_entry(1, wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2Array);
        let entries = [uniform_entry(0, size_of::<GroundUniform>(), true), shades];
        let layout = group_layout(gpu, "ground", &entries);
        let recipe = Recipe {
            groups: &[&panels.layout, &layout],
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            // Infinitely far away: a driver leaves out what bodies cover.
            depth: Some((wgpu::CompareFunction::Equal, false)),
            ..Recipe::new("ground", &module, ["corner", "floor_colour"])
        };
        Self {
            pipeline: recipe.build(gpu),
            layout,
            uniforms: GrowingBuffer::new(gpu, "grounds", wgpu::BufferUsages::UNIFORM, 4 * STRIDE),
            shades: create_shades(gpu, 2),
            bind_group: None,
        }
    }

    /// Uploads the floors of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut bytes = vec![0_u8; STRIDE * picture.panels.len()];
        let layers = (2 * picture.panels.len().clamp(1, MOST_PANELS)) as u32;
        if self.shades.depth_or_array_layers() < layers {
            self.shades = create_shades(gpu, layers);
            self.bind_group = None;
        }
        for (at, panel) in picture.panels.iter().enumerate() {
            let Some(floor) = &panel.floor else { continue };
            for (half, shade) in floor.shades.iter().enumerate() {
                if has_layer(at) && !shade.cells.is_empty() {
                    self.write_shade(gpu, 2 * at + half, shade);
                }
            }
            let uniform = uniform(picture, panel, floor, at);
            bytes[at * STRIDE..at * STRIDE + size_of::<GroundUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        if self.uniforms.write(gpu, &bytes) || self.bind_group.is_none() {
            self.bind_group = Some(self.bind(gpu));
        }
    }

    fn write_shade(&mut self, gpu: &Gpu, layer: usize, shade: &Shade) {
        let origin = wgpu::Origin3d { x: 0, y: 0, z: layer as u32 };
        gpu.queue().write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..self.shades.as_image_copy() },
            corners_of(&shade.cells).as_flattened(),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * CORNERS), rows_per_image: None },
            wgpu::Extent3d { width: CORNERS, height: CORNERS, depth_or_array_layers: 1 },
        );
    }

    fn bind(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let view = self.shades.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let uniform = element::<GroundUniform>(self.uniforms.buffer());
        let shades = wgpu::BindingResource::TextureView(&view);
        bind(gpu, "ground", &self.layout, &[(0, uniform), (1, shades)])
    }

    /// Draws the floors of all panels, behind all that was drawn.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, panels: &Panels, picture: &Picture) {
        for (at, panel) in picture.panels.iter().enumerate() {
            let Some(floor) = &panel.floor else { continue };
            panels.bind(pass, at, panel, panel.viewport);
            let [left, top, width, height] = panel.viewport.map(|length| length as f32);
            pass.set_viewport(left, top, width, height, 0.0, 0.0);
            pass.set_bind_group(1, self.bind_group.as_ref(), &[(at * STRIDE) as u32]);
            pass.set_pipeline(&self.pipeline);
            let [left, top, width, height] = visible(panel, floor);
            pass.set_scissor_rect(left, top, width, height);
            pass.draw(0..4, 0..1);
        }
    }
}

/// The part of a panel between the words, at which the floor has faded out.
fn visible(panel: &Panel, floor: &Floor) -> Rectangle {
    let [left, top, width, height] = panel.viewport;
    let [above, below] = floor.fade_at_words.map(|height| (0.55 * height) as u32);
    [left, top + above.min(height), width, height.saturating_sub(above + below)]
}

fn has_layer(panel: usize) -> bool {
    panel < MOST_PANELS
}

fn uniform(picture: &Picture, panel: &Panel, floor: &Floor, at: usize) -> GroundUniform {
    let palette = &picture.palette;
    let shade = |half: usize| {
        let shade = &floor.shades[half];
        let strength = if shade.cells.is_empty() || !has_layer(at) { 0.0 } else { palette.shadow_strength[half] };
        Vec4::new(shade.corner[0], shade.corner[1], 1.0 / shade.length, strength)
    };
    let filling = if floor.is_filled { palette.floor } else { palette.background };
    let grid = if floor.has_grid { palette.grid } else { filling };
    GroundUniform {
        first: floor.axes[0].extend(floor.grid[0]),
        second: floor.axes[1].extend(floor.grid[1]),
        fade: floor.fade,
        fade_at_words: floor.fade_at_words,
        key: shade(0),
        sky: shade(1),
        background: linear(palette.background).extend((2 * at) as f32),
        floor: linear(filling).extend((2 * at + 1) as f32),
        grid: linear(grid).extend(floor.cell),
        shadow: linear(palette.shadow).extend(0.0),
        viewport: Vec4::from_array(panel.viewport.map(|length| length as f32)),
    }
}

fn create_shades(gpu: &Gpu, layers: u32) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    texture(gpu, "shades", [CORNERS, CORNERS, layers], wgpu::TextureFormat::Rgba8Unorm, usage)
}

/// The number of corners of cells along each side of a shadow.
const CORNERS: u32 = CELLS as u32 + 1;

/// The four cells around each corner of the grid: left and right above it, then below it. The border cells continue
/// beyond the border.
fn corners_of(cells: &[u8]) -> Vec<[u8; 4]> {
    let (rows, rest) = cells.as_chunks::<CELLS>();
    debug_assert!(rows.len() == CELLS && rest.is_empty());
    let beside = |at: usize| [at.saturating_sub(1), at.min(CELLS - 1)];
    let mut corners = Vec::with_capacity((CELLS + 1) * (CELLS + 1));
    for row in 0..=CELLS {
        let [above, below] = beside(row).map(|row| &rows[row]);
        corners.extend((0..=CELLS).map(|column| {
            let [left, right] = beside(column);
            [above[left], above[right], below[left], below[right]]
        }));
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_corner_of_the_grid_has_the_cells_around_it() {
        let cells: Vec<u8> = (0..CELLS * CELLS).map(|at| (at % 251) as u8).collect();
        let corners = corners_of(&cells);
        let [at, corner] = [CELLS, CELLS + 1].map(|wide| move |row: usize, column: usize| row * wide + column);
        assert_eq!(corners[corner(0, 0)], [cells[0]; 4]);
        let inside = [at(4, 6), at(4, 7), at(5, 6), at(5, 7)].map(|at| cells[at]);
        assert_eq!(corners[corner(5, 7)], inside);
        let [last, before] = [at(9, CELLS - 1), at(8, CELLS - 1)].map(|at| cells[at]);
        assert_eq!(corners[corner(9, CELLS)], [before, before, last, last]);
        assert_eq!(corners.len(), (CELLS + 1) * (CELLS + 1));
    }
}
