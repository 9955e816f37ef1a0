//! The floor with its grid and the soft shadows on it.

use super::panel::{Panels, linear};
use super::pipeline::{Recipe, bind, element, group_layout, shader, texture, textures_entry, uniform_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{CELLS, Floor, Panel, Picture, Rectangle, Shade};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec4};

pub(super) const SHADER: &str = include_str!("../../shaders/ground.wgsl");

/// The struct `Ground` of the shader, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GroundUniform {
    pub(super) first: Vec4,
    pub(super) second: Vec4,
    pub(super) middle: [f32; 2],
    pub(super) fade: [f32; 2],
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
    /// The pipelines without shadows and with them.
    pipelines: [wgpu::RenderPipeline; 2],
    layout: wgpu::BindGroupLayout,
    uniforms: GrowingBuffer,
    shades: wgpu::Texture,
    bind_group: Option<wgpu::BindGroup>,
}

impl Grounds {
    pub(super) fn new(gpu: &Gpu, panels: &Panels) -> Self {
        let module = shader(gpu, "ground", &[super::PANEL_SHADER, SHADER]);
        let shades = textures_entry(1, wgpu::TextureSampleType::Float { filterable: false });
        let entries = [uniform_entry(0, size_of::<GroundUniform>(), true), shades];
        let layout = group_layout(gpu, "ground", &entries);
        let build = |fragment| {
            let recipe = Recipe {
                groups: &[&panels.layout, &layout],
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                // Infinitely far away: a driver leaves out what bodies cover.
                depth: Some((wgpu::CompareFunction::Equal, false)),
                ..Recipe::new(fragment, &module, ["corner", fragment])
            };
            recipe.build(gpu)
        };
        Self {
            pipelines: ["floor_colour", "shadowed_colour"].map(build),
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
            let shadowed = if has_layer(at) { shadowed(panel, floor) } else { None };
            let lit = shadowed.map_or(vec![visible(panel, floor)], |inner| around(visible(panel, floor), inner));
            for (pipeline, parts) in self.pipelines.iter().zip([lit, shadowed.into_iter().collect()]) {
                pass.set_pipeline(pipeline);
                for [left, top, width, height] in parts {
                    pass.set_scissor_rect(left, top, width, height);
                    pass.draw(0..4, 0..1);
                }
            }
        }
    }
}

/// The part of a panel above the lower side at which the floor has faded out.
fn visible(panel: &Panel, floor: &Floor) -> Rectangle {
    let [left, top, width, height] = panel.viewport;
    [left, top, width, height.saturating_sub((0.55 * floor.fade_above) as u32)]
}

/// The part of that in which shadows may lie.
fn shadowed(panel: &Panel, floor: &Floor) -> Option<Rectangle> {
    let [left, top, width, height] = panel.viewport;
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for shade in floor.shades.iter().filter(|shade| !shade.cells.is_empty()) {
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            let on_floor = Vec2::from(shade.corner) + shade.length * Vec2::from(corner);
            let point = floor.normal * floor.height + floor.axes[0] * on_floor.x + floor.axes[1] * on_floor.y;
            let at = panel.sight.clip * point.extend(1.0);
            if at.w < panel.sight.near {
                // The corner lies behind the eye.
                return Some(visible(panel, floor));
            }
            let pixel = (Vec2::new(at.x, -at.y) / at.w * 0.5 + 0.5) * Vec2::new(width as f32, height as f32);
            (low, high) = (low.min(pixel), high.max(pixel));
        }
    }
    let most = UVec2::from_slice(&visible(panel, floor)[2..]);
    let [low, high] = [(low - 1.0).floor(), (high + 1.0).ceil()].map(|at| at.max(Vec2::ZERO).as_uvec2().min(most));
    let size = high.saturating_sub(low);
    (size.min_element() > 0).then_some([left + low.x, top + low.y, size.x, size.y])
}

/// The parts of a rectangle around another one in it.
fn around([left, top, width, height]: Rectangle, [x, y, wide, high]: Rectangle) -> Vec<Rectangle> {
    let [right, bottom] = [left + width - x - wide, top + height - y - high];
    let parts = [
        [left, top, width, y - top],
        [left, y, x - left, high],
        [x + wide, y, right, high],
        [left, y + high, width, bottom],
    ];
    parts.into_iter().filter(|&[_, _, width, height]| width > 0 && height > 0).collect()
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
        middle: floor.middle,
        fade: floor.fade,
        key: shade(0),
        sky: shade(1),
        background: linear(palette.background).extend((2 * at) as f32),
        floor: linear(filling).extend((2 * at + 1) as f32),
        grid: linear(grid).extend(floor.cell),
        shadow: linear(palette.shadow).extend(floor.fade_above),
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

    #[test]
    fn the_parts_around_a_rectangle_and_itself_cover_each_pixel_once() {
        let outer = [3, 5, 7, 6];
        for inner in [[3, 5, 7, 6], [3, 5, 1, 1], [9, 10, 1, 1], [5, 7, 2, 3], [3, 6, 7, 1]] {
            let parts = [around(outer, inner), vec![inner]].concat();
            for (x, y) in (3..10).flat_map(|x| (5..11).map(move |y| (x, y))) {
                let holds = |[left, top, width, height]: &&Rectangle| {
                    (*left..left + width).contains(&x) && (*top..top + height).contains(&y)
                };
                assert_eq!(parts.iter().filter(holds).count(), 1, "{inner:?} {x} {y}");
            }
        }
    }
}
