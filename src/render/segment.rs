//! Lines on the regions of their panels, for the passes that test, draw and smooth them.

use super::panel::cropped;
use super::pipeline::{bind, group_layout, storage_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Line, LineKind, Panel};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use std::ops::Range;

const SHADER: &str = include_str!("../../shaders/line.wgsl");

/// One line as the shaders read it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    /// The ends on the region of the panel (px), and their depths.
    ends: [f32; 4],
    depths: [f32; 2],
    /// The kind, the opacity (of 255), and the number of visibility samples.
    look: u32,
    /// The first visibility sample.
    first: u32,
}

/// Bits of the kind and of the opacity in [`Segment::look`].
pub(super) const KIND_BITS: u32 = 4;
pub(super) const STRENGTH_BITS: u32 = 8;

/// Lines in a buffer, bound for passes that draw three vertices for each.
#[derive(Debug)]
pub(super) struct LineBuffer {
    pub(super) buffer: GrowingBuffer<Segment>,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) group: wgpu::BindGroup,
}

impl LineBuffer {
    pub(super) fn new(gpu: &Gpu, label: &'static str) -> Self {
        let buffer = GrowingBuffer::new(gpu, label, wgpu::BufferUsages::STORAGE, 1024);
        let layout = group_layout(gpu, label, &[storage_entry(1)]);
        Self { group: bind(gpu, label, &layout, &[(1, buffer.buffer().as_entire_binding())]), buffer, layout }
    }

    /// Replaces the lines. Returns true if they are bound anew.
    pub(super) fn write(&mut self, gpu: &Gpu, segments: Vec<Segment>) -> bool {
        let is_new = self.buffer.write(gpu, segments);
        if is_new {
            self.group = bind(gpu, "lines", &self.layout, &[(1, self.buffer.buffer().as_entire_binding())]);
        }
        is_new
    }
}

/// The vertices of some lines.
pub(super) fn corners(lines: &Range<u32>) -> Range<u32> {
    3 * lines.start..3 * lines.end
}

impl Segment {
    /// Length (px).
    pub(super) fn length(&self) -> f32 {
        let [x, y, to_x, to_y] = self.ends;
        Vec2::new(x, y).distance(Vec2::new(to_x, to_y))
    }

    /// Gives the line samples of its visibility.
    pub(super) fn sample(&mut self, samples: Range<u32>) {
        self.look |= (samples.len() as u32) << (KIND_BITS + STRENGTH_BITS);
        self.first = samples.start;
    }

    /// The samples of the line's visibility.
    pub(super) fn samples(&self) -> Range<u32> {
        self.first..self.first + (self.look >> (KIND_BITS + STRENGTH_BITS))
    }
}

/// Lines of turned-over elements are this much nearer (sides), like their surfaces. With all lines so near, stubs of
/// hidden ones would show at corners.
const NEARER: f32 = 0.02;

/// The parts of lines on the region of a panel, or near enough to reach into it.
pub(super) fn projected(panel: &Panel) -> impl Fn(&Line) -> Option<Segment> {
    let (clip, near) = (cropped(panel), panel.sight.near);
    let size = Vec2::new(panel.region[2] as f32, panel.region[3] as f32);
    let around = 2.0 + 2.0 * panel.sight.line_scale;
    move |line| {
        let [mut a, mut b] = [line.from, line.to].map(|end| clip * Vec3::from(end).extend(1.0));
        if a.w < near && b.w < near {
            return None;
        }
        if a.w < near {
            a = a.lerp(b, (near - a.w) / (b.w - a.w));
        } else if b.w < near {
            b = b.lerp(a, (near - b.w) / (a.w - b.w));
        }
        let nearer = if line.kind.is_alarm() { NEARER } else { 0.0 };
        let place = |at: Vec4| (Vec2::new(at.x, -at.y) / at.w * 0.5 + 0.5) * size;
        // Depths are linear on the screen, like places.
        let [from, to] = [a, b].map(|at| place(at).extend(at.z / (at.w - nearer).max(near)));
        let [start, end] = shares_within(from.truncate(), to.truncate(), [Vec2::splat(-around), size + around])?;
        let [from, to] = [from.lerp(to, start), from.lerp(to, end)];
        let strength = (255.0 * line.strength).round() as u32;
        let look = line.kind as u32 | strength << KIND_BITS;
        Some(Segment { ends: [from.x, from.y, to.x, to.y], depths: [from.z, to.z], look, first: 0 })
    }
}

/// The ends of a line's part in a rectangle, as shares of the line.
fn shares_within(from: Vec2, to: Vec2, [low, high]: [Vec2; 2]) -> Option<[f32; 2]> {
    let way = to - from;
    let (mut start, mut end) = (0.0_f32, 1.0_f32);
    for axis in 0..2 {
        if way[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let [one, other] = [low, high].map(|side| (side[axis] - from[axis]) / way[axis]);
        (start, end) = (start.max(one.min(other)), end.min(one.max(other)));
    }
    (start <= end).then_some([start, end])
}

/// The parts of the shader.
pub(super) fn parts() -> [&'static str; 3] {
    [super::PANEL_SHADER, super::SEGMENT_SHADER, SHADER]
}

/// Lines of one pipeline. With one for all kinds, a software driver would do the work of all kinds for each line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Edge,
    AlarmEdge,
    Contour,
    AlarmContour,
}

impl Kind {
    pub(super) const ALL: [Self; 4] = [Self::Edge, Self::AlarmEdge, Self::Contour, Self::AlarmContour];

    /// The kind of a line.
    pub(super) fn of(line: &Line) -> Self {
        match line.kind {
            LineKind::Edge | LineKind::Bar | LineKind::ObstacleEdge => Self::Edge,
            LineKind::AlarmEdge => Self::AlarmEdge,
            LineKind::Contour | LineKind::ObstacleContour => Self::Contour,
            LineKind::AlarmContour => Self::AlarmContour,
        }
    }

    /// The entry points that test the visibility of the kind and that draw it.
    pub(super) fn entries(self) -> [&'static str; 2] {
        match self {
            Self::Edge => ["edges", "edge_opacity"],
            Self::AlarmEdge => ["alarm_edges", "alarm_edge_opacity"],
            Self::Contour => ["contours", "contour_opacity"],
            Self::AlarmContour => ["alarm_contours", "alarm_contour_opacity"],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_what_may_be_seen() {
        let room = [Vec2::ZERO, Vec2::new(10.0, 5.0)];
        let within = |from: [f32; 2], to: [f32; 2]| shares_within(from.into(), to.into(), room);
        assert_eq!(within([1.0, 1.0], [9.0, 4.0]), Some([0.0, 1.0]));
        assert_eq!(within([-10.0, 2.0], [30.0, 2.0]), Some([0.25, 0.5]));
        assert_eq!(within([3.0, -1e3], [3.0, -1.0]), None);
        assert_eq!(within([-1.0, 6.0], [12.0, 6.0]), None);
        assert_eq!(within([4.0, 4.0], [4.0, 4.0]), Some([0.0, 1.0]));
        // The line passes a corner.
        assert_eq!(within([-2.0, 4.0], [4.0, 10.0]), None);
    }
}
