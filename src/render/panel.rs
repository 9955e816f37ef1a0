//! The data of a panel for all passes.

use super::pipeline::{bind, element, group_layout, texture_entry, uniform_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::look::BODIES;
use crate::picture::measures::edging;
use crate::picture::{Colour, MOST_OCCLUDERS, Occluder, Palette, Panel, Picture, Rectangle, SHADES};
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec2Swizzles as _, Vec3, Vec4};

/// The struct `Panel` of `shaders/panel.wgsl`, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct PanelUniform {
    pub(super) clip: Mat4,
    pub(super) eye: Vec3,
    pub(super) near: f32,
    pub(super) key: Vec3,
    pub(super) edging: f32,
    pub(super) up: Vec3,
    pub(super) floor: f32,
    pub(super) alarm: Vec3,
    pub(super) contour_share: f32,
    pub(super) alarm_line: Vec3,
    pub(super) soft: f32,
    pub(super) edge: Vec3,
    pub(super) key_texel: f32,
    pub(super) obstacle: Vec4,
    pub(super) key_map: Mat4,
    pub(super) middle: Vec2,
    pub(super) key_layer: f32,
    pub(super) line_scale: f32,
    pub(super) bodies: [Vec4; BODIES],
    pub(super) fade_distance: Vec4,
    pub(super) fade_room: Vec4,
    pub(super) fade_strength: Vec4,
    pub(super) occluders: [OccluderUniform; MOST_OCCLUDERS],
}

/// The struct `Occluder` of `shaders/panel.wgsl`, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct OccluderUniform {
    pub(super) first: Vec4,
    pub(super) second: Vec4,
    pub(super) rotation: Vec4,
}

impl OccluderUniform {
    /// An unused entry without effect.
    const NONE: Self = Self { first: Vec4::new(0.0, 0.0, 0.0, -1e9), second: Vec4::ZERO, rotation: Vec4::W };

    fn new(occluder: &Occluder) -> Self {
        let Occluder { centre, half, rotation, radius, is_clear } = *occluder;
        let clear = if is_clear { 1.0 } else { 0.0 };
        Self { first: centre.extend(radius), second: half.extend(clear), rotation: Vec4::from(rotation) }
    }
}

/// An sRGB colour as linear light.
pub(super) fn linear(colour: Colour) -> Vec3 {
    let one = |byte: u8| {
        let encoded = f32::from(byte) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(one(colour[0]), one(colour[1]), one(colour[2]))
}

/// Whether something is visible through surfaces of elements that are not turned over, or these surfaces are dotted.
/// One pipeline draws both.
pub(super) fn has_behind(panel: &Panel) -> bool {
    panel.dotted || !panel.turned_over.triangles.is_empty()
}

fn uniform(picture: &Picture, panel: &Panel, layer: Option<usize>) -> PanelUniform {
    let (sight, palette) = (&panel.sight, palette(picture, panel));
    PanelUniform {
        clip: sight.clip,
        eye: sight.eye,
        near: sight.near,
        key: sight.key,
        edging: edging(sight.element),
        up: panel.floor.as_ref().map_or(Vec3::Y, |floor| floor.normal),
        // Without a floor, it lies far below everything.
        floor: panel.floor.as_ref().map_or(-1e6, |floor| floor.height),
        alarm: linear(palette.alarm),
        contour_share: sight.contour_share,
        alarm_line: linear(palette.alarm_line),
        soft: sight.soft,
        edge: linear(palette.edge),
        key_texel: sight.key_map.map_or(0.0, texel),
        obstacle: linear(palette.obstacle).extend(1.0),
        key_map: sight.key_map.unwrap_or_default(),
        middle: Vec2::from(sight.middle),
        key_layer: layer.map_or(-1.0, |layer| layer as f32),
        line_scale: sight.line_scale,
        bodies: palette.bodies.map(|colour| linear(colour).extend(1.0)),
        fade_room: Vec4::from_array(panel.obstacles.fade.map_or([0.0; 4], |fade| fade.room)),
        fade_distance: panel.obstacles.fade.map_or(Vec4::ONE, |fade| Vec2::from(fade.distance).xyxy()),
        fade_strength: Vec4::from_array(panel.obstacles.fade.map_or([0.0; 4], |fade| fade.strength)),
        occluders: std::array::from_fn(|at| {
            panel.obstacles.occluders.get(at).map_or(OccluderUniform::NONE, OccluderUniform::new)
        }),
    }
}

/// The colours of a panel.
pub(super) fn palette(picture: &Picture, panel: &Panel) -> Palette {
    let palette = if panel.greyed { picture.palette.greyed() } else { picture.palette };
    // On the dark end of a scale, vermilion is more visible.
    let alarm_line = if picture.ramp.is_empty() { palette.alarm_line } else { palette.alarm };
    Palette { alarm_line, ..palette }
}

/// The width and height of a map of the key light (texels).
pub(super) const MAP_SIDE: u32 = 256;
/// The most maps: a device need not have more layers in a texture. Surfaces of further panels do not shade each other.
const MOST_MAPS: usize = 256;

/// The layer of the map of a panel, if it has one.
pub(super) fn map_layer(picture: &Picture, at: usize) -> Option<usize> {
    let has_map = |panel: &Panel| panel.sight.key_map.is_some();
    let layer = picture.panels[..at].iter().filter(|panel| has_map(panel)).count();
    (has_map(&picture.panels[at]) && layer < MOST_MAPS).then_some(layer)
}

/// The width of a texel, as a depth of the map.
fn texel(map: Mat4) -> f32 {
    let length = |row: usize| map.row(row).truncate().length();
    2.0 / MAP_SIDE as f32 * length(2) / length(0)
}

/// The distance between the data of two panels in the buffer (bytes): a multiple of 256, to which devices may align it.
const STRIDE: usize = 768;

/// The data of all panels, the scale of a field, and the maps of the key light.
#[derive(Debug)]
pub(super) struct Panels {
    buffer: GrowingBuffer,
    ramp: GrowingBuffer,
    /// All of them, and the data of panels alone, which draw the maps.
    bind_groups: Option<[wgpu::BindGroup; 2]>,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) alone: wgpu::BindGroupLayout,
}

impl Panels {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let scale = uniform_entry(1, SHADES * size_of::<Vec4>(), false);
        let data = uniform_entry(0, size_of::<PanelUniform>(), true);
        let maps = texture_entry(2, wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array);
        let layout = group_layout(gpu, "panel", &[data, scale, maps]);
        let uniform = wgpu::BufferUsages::UNIFORM;
        let buffer = GrowingBuffer::new(gpu, "panels", uniform, 4 * STRIDE);
        let ramp = GrowingBuffer::new(gpu, "scale", uniform, SHADES * size_of::<Vec4>());
        Self { bind_groups: None, buffer, ramp, layout, alone: group_layout(gpu, "panel alone", &[data]) }
    }

    /// Uploads the data of all panels of a picture, and binds the maps of the key light, if they are new.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture, maps: &wgpu::TextureView, are_new: bool) {
        let mut bytes = vec![0_u8; STRIDE * picture.panels.len()];
        for (at, (place, panel)) in bytes.chunks_exact_mut(STRIDE).zip(&picture.panels).enumerate() {
            let uniform = uniform(picture, panel, map_layer(picture, at));
            place[..size_of::<PanelUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        let ramp: Vec<_> = picture.ramp.iter().take(SHADES).map(|&colour| linear(colour).extend(1.0)).collect();
        self.ramp.write(gpu, &ramp);
        if self.buffer.write(gpu, &bytes) || are_new || self.bind_groups.is_none() {
            self.bind_groups = Some(self.bound(gpu, maps));
        }
    }

    fn bound(&self, gpu: &Gpu, maps: &wgpu::TextureView) -> [wgpu::BindGroup; 2] {
        let data = || (0, element::<PanelUniform>(self.buffer.buffer()));
        let view = (2, wgpu::BindingResource::TextureView(maps));
        let ramp = (1, self.ramp.buffer().as_entire_binding());
        let all = bind(gpu, "panel", &self.layout, &[data(), ramp, view]);
        [all, bind(gpu, "panel alone", &self.alone, &[data()])]
    }

    /// Binds a panel, and limits drawing to a part of it.
    pub(super) fn bind(&self, pass: &mut wgpu::RenderPass<'_>, at: usize, panel: &Panel, part: Rectangle) {
        let [left, top, width, height] = panel.viewport.map(|length| length as f32);
        pass.set_viewport(left, top, width, height, 0.0, 1.0);
        pass.set_scissor_rect(part[0], part[1], part[2], part[3]);
        self.bind_group(pass, at, 0);
    }

    /// Binds the data of a panel alone.
    pub(super) fn bind_alone(&self, pass: &mut wgpu::RenderPass<'_>, at: usize) {
        self.bind_group(pass, at, 1);
    }

    fn bind_group(&self, pass: &mut wgpu::RenderPass<'_>, at: usize, which: usize) {
        pass.set_bind_group(0, self.bind_groups.as_ref().map(|groups| &groups[which]), &[(at * STRIDE) as u32]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_linear() {
        assert_eq!(linear([0, 0, 0]), Vec3::ZERO);
        assert_eq!(linear([255, 255, 255]), Vec3::ONE);
        assert!((linear([188, 188, 188]).x - 0.5).abs() < 0.005);
    }
}
