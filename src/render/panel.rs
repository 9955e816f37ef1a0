//! The data of a panel for all passes, and the places of bodies in their textures.

use super::pass::Pass;
use super::pipeline::{bind, element, group_layout, uniform_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::measures::edging;
use crate::picture::{Colour, MOST_OCCLUDERS, Occluder, Panel, Picture, Rectangle, SHADES};
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
    pub(super) sound: Vec3,
    pub(super) element: f32,
    pub(super) alarm: Vec3,
    pub(super) line_scale: f32,
    pub(super) alarm_line: Vec3,
    pub(super) outline_alpha: f32,
    pub(super) edge: Vec3,
    pub(super) focal: f32,
    pub(super) outline: Vec3,
    pub(super) soft: f32,
    pub(super) obstacle: Vec3,
    pub(super) contour_share: f32,
    pub(super) region: Vec4,
    pub(super) place: Vec4,
    pub(super) viewport: Vec4,
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

/// The place of each panel's region in the textures of bodies, and the size of these textures (px).
///
/// Regions are packed in rows, so that the textures have few empty pixels: every pixel costs time.
pub(super) fn place(picture: &Picture) -> (Vec<Rectangle>, [u32; 2]) {
    let widest = picture.panels.iter().map(|panel| panel.region[2]).max().unwrap_or(0).max(picture.size[0]);
    let (mut left, mut top, mut row) = (0, 0, 0);
    let mut size = [0, 0];
    let places = picture.panels.iter().map(|panel| {
        let [_, _, width, height] = panel.region;
        if left + width > widest {
            (left, top, row) = (0, top + row, 0);
        }
        let place = [left, top, width, height];
        left += width;
        row = row.max(height);
        size = [size[0].max(left), size[1].max(top + row)];
        place
    });
    (places.collect(), size)
}

/// The matrix from clip space of a viewport to clip space of a region in it.
fn crop(viewport: Rectangle, region: Rectangle) -> Mat4 {
    let [vx, vy, vw, vh] = viewport.map(|length| length as f32);
    let [rx, ry, rw, rh] = region.map(|length| (length as f32).max(1.0));
    let [rx, ry] = if region[2] == 0 { [vx, vy] } else { [rx.min(region[0] as f32), ry.min(region[1] as f32)] };
    let scale = [vw / rw, vh / rh];
    let shift = [(2.0 * (vx - rx) + vw) / rw - 1.0, 1.0 - (2.0 * (vy - ry) + vh) / rh];
    Mat4::from_cols(
        Vec4::new(scale[0], 0.0, 0.0, 0.0),
        Vec4::new(0.0, scale[1], 0.0, 0.0),
        Vec4::Z,
        Vec4::new(shift[0], shift[1], 0.0, 1.0),
    )
}

/// The matrix from a panel's coordinates to clip space of its body's region.
pub(super) fn cropped(panel: &Panel) -> Mat4 {
    crop(panel.viewport, panel.region) * panel.sight.clip
}

/// Whether something is visible through surfaces of elements that are not turned over, or these surfaces are dotted.
/// One pipeline draws both.
pub(super) fn has_behind(panel: &Panel) -> bool {
    panel.dotted || !panel.turned_over.triangles.is_empty()
}

fn uniform(picture: &Picture, panel: &Panel, clip: Mat4, region: Rectangle) -> PanelUniform {
    let sight = &panel.sight;
    let palette = &if panel.greyed { picture.palette.greyed() } else { picture.palette };
    let [left, top] = [0, 1].map(|axis| panel.region[axis] as f32 - region[axis] as f32);
    PanelUniform {
        clip,
        eye: sight.eye,
        near: sight.near,
        key: sight.key,
        edging: edging(sight.element),
        up: panel.floor.as_ref().map_or(Vec3::Y, |floor| floor.normal),
        // Without a floor, it lies far below everything.
        floor: panel.floor.as_ref().map_or(-1e6, |floor| floor.height),
        sound: linear(palette.sound),
        element: sight.element,
        alarm: linear(palette.alarm),
        line_scale: sight.line_scale,
        // On the dark end of a scale, vermilion is more visible.
        alarm_line: linear(if picture.ramp.is_empty() { palette.alarm_line } else { palette.alarm }),
        outline_alpha: palette.outline_alpha,
        edge: linear(palette.edge),
        focal: sight.focal,
        outline: linear(palette.outline),
        soft: sight.soft,
        obstacle: linear(palette.obstacle),
        contour_share: sight.contour_share,
        region: Vec4::from_array(region.map(|length| length as f32)),
        place: Vec4::new(left, top, sight.middle[0], sight.middle[1]),
        viewport: Vec4::from_array(panel.viewport.map(|length| length as f32)),
        fade_room: Vec4::from_array(panel.obstacles.fade.map_or([0.0; 4], |fade| fade.room)),
        fade_distance: panel.obstacles.fade.map_or(Vec4::ONE, |fade| Vec2::from(fade.distance).xyxy()),
        fade_strength: Vec4::from_array(panel.obstacles.fade.map_or([0.0; 4], |fade| fade.strength)),
        occluders: std::array::from_fn(|at| {
            panel.obstacles.occluders.get(at).map_or(OccluderUniform::NONE, OccluderUniform::new)
        }),
    }
}

/// The distance between the data of two panels in the buffer (bytes): a multiple of 256, to which devices may align it.
const STRIDE: usize = 768;

/// The data of all panels, for the bodies' regions and for whole panels, and the scale of a field.
#[derive(Debug)]
pub(super) struct Panels {
    buffer: GrowingBuffer<u8>,
    ramp: GrowingBuffer<Vec4>,
    bind_group: wgpu::BindGroup,
    pub(super) layout: wgpu::BindGroupLayout,
}

impl Panels {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let scale = uniform_entry(1, SHADES * size_of::<Vec4>(), false);
        let layout = group_layout(gpu, "panel", &[uniform_entry(0, size_of::<PanelUniform>(), true), scale]);
        let buffer = GrowingBuffer::new(gpu, "panels", wgpu::BufferUsages::UNIFORM, 4 * STRIDE);
        let ramp = GrowingBuffer::new(gpu, "scale", wgpu::BufferUsages::UNIFORM, SHADES);
        Self { bind_group: bound(gpu, &layout, &buffer, &ramp), buffer, ramp, layout }
    }

    /// Uploads the data of all panels of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture, places: &[Rectangle]) {
        let mut bytes = vec![0; 2 * STRIDE * picture.panels.len()];
        for (at, (panel, &place)) in picture.panels.iter().zip(places).enumerate() {
            for (half, clip) in [cropped(panel), panel.sight.clip].into_iter().enumerate() {
                let uniform = uniform(picture, panel, clip, place);
                let start = (2 * at + half) * STRIDE;
                bytes[start..start + size_of::<PanelUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
            }
        }
        self.ramp.write(gpu, picture.ramp.iter().take(SHADES).map(|&colour| linear(colour).extend(1.0)).collect());
        if self.buffer.write(gpu, bytes) {
            self.bind_group = bound(gpu, &self.layout, &self.buffer, &self.ramp);
        }
    }

    /// Draws the body of each panel in its rectangle, limited to that rectangle and bound for its body's region.
    pub(super) fn draw_regions(
        &self,
        pass: &mut Pass<'_>,
        rectangles: impl IntoIterator<Item = Rectangle>,
        draw: impl Fn(&mut Pass<'_>, usize),
    ) {
        for (panel, rectangle) in rectangles.into_iter().enumerate().filter(|(_, rectangle)| is_visible(*rectangle)) {
            limit(pass, rectangle);
            pass.set_bind_group(0, &self.bind_group, &[(2 * panel * STRIDE) as u32]);
            draw(pass, panel);
        }
    }

    /// Binds a panel for work on its body's region.
    pub(super) fn bind_region(&self, pass: &mut wgpu::ComputePass<'_>, panel: usize) {
        pass.set_bind_group(0, &self.bind_group, &[(2 * panel * STRIDE) as u32]);
    }

    /// Binds a panel for drawing into the whole of it.
    pub(super) fn bind_whole(&self, pass: &mut Pass<'_>, panel: usize) {
        pass.set_bind_group(0, &self.bind_group, &[((2 * panel + 1) * STRIDE) as u32]);
    }
}

fn bound(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    panels: &GrowingBuffer<u8>,
    ramp: &GrowingBuffer<Vec4>,
) -> wgpu::BindGroup {
    let uniform = element::<PanelUniform>(panels.buffer());
    bind(gpu, "panel", layout, &[(0, uniform), (1, ramp.buffer().as_entire_binding())])
}

/// Limits drawing to a rectangle of the target.
pub(super) fn limit(pass: &mut Pass<'_>, [left, top, width, height]: Rectangle) {
    pass.set_viewport(left as f32, top as f32, width as f32, height as f32, 0.0, 1.0);
    pass.set_scissor_rect(left, top, width, height);
}

/// Whether a rectangle is not empty.
pub(super) fn is_visible([_, _, width, height]: Rectangle) -> bool {
    width > 0 && height > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_is_cut_out_of_its_viewport() {
        let crop = crop([640, 0, 640, 720], [700, 200, 320, 360]);
        // The corners of the region, in clip space of the viewport, become those of clip space.
        for (pixel, corner) in [([700.0, 200.0], [-1.0, 1.0]), ([1020.0, 560.0], [1.0, -1.0])] {
            let at = Vec4::new((pixel[0] - 640.0) / 320.0 - 1.0, 1.0 - pixel[1] / 360.0, 0.0, 1.0);
            let there = crop * at;
            assert!((there.x - corner[0]).abs() < 1e-5 && (there.y - corner[1]).abs() < 1e-5, "{there}");
        }
    }

    #[test]
    fn colours_become_linear() {
        assert_eq!(linear([0, 0, 0]), Vec3::ZERO);
        assert_eq!(linear([255, 255, 255]), Vec3::ONE);
        assert!((linear([188, 188, 188]).x - 0.5).abs() < 0.005);
    }
}
