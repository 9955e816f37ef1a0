//! Flat curves over the finished picture.

use super::overlay::CanvasUniform;
use super::pass::Pass;
use super::pipeline::{ENCODED_FORMAT, Pipeline, Recipe, bind, for_instances, group_layout, shader, uniform_entry};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{Curve, Picture};
use bytemuck::{Pod, Zeroable};
use glam::Vec2;

pub(super) const SHADER: &str = include_str!("../../shaders/curve.wgsl");

/// One straight piece as the shader reads it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Piece {
    ends: [Vec2; 2],
    /// Normals of the lines between this piece and its neighbours, along the curve; zero at the ends of a curve.
    joints: [Vec2; 2],
    colour: [u8; 4],
    /// Width, start in the pattern, and length of the pattern: 0 for a solid curve.
    pattern: [f32; 3],
    /// The lengths of up to three dashes and of the gaps after them.
    dashes: [f32; 6],
}

const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x4, 1 => Float32x4, 2 => Unorm8x4, 3 => Float32x3, 4 => Float32x4, 5 => Float32x2
];

/// The pipeline and the curves of one picture. Made for the first picture that has any.
#[derive(Debug)]
pub(super) struct Curves {
    pipeline: Pipeline,
    canvas: wgpu::BindGroup,
    pieces: GrowingBuffer<Piece>,
}

impl Curves {
    /// The pipeline for pictures of a size (px).
    pub(super) fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let module = shader(gpu, "curve", &[SHADER]);
        let layout = group_layout(gpu, "curve", &[uniform_entry(0, size_of::<CanvasUniform>(), false)]);
        let recipe = Recipe {
            groups: &[&layout],
            vertices: &[Some(for_instances::<Piece>(&ATTRIBUTES))],
            ..Recipe::rectangles("curve", &module, ["piece", "piece_colour"], ENCODED_FORMAT)
        };
        let mut canvas = GrowingBuffer::new(gpu, "canvas of curves", wgpu::BufferUsages::UNIFORM, 1);
        canvas.write(gpu, vec![CanvasUniform { size: size.map(|length| length as f32), unused: [0.0; 2] }]);
        let canvas = bind(gpu, "curve", &layout, &[(0, canvas.buffer().as_entire_binding())]);
        Self {
            pipeline: recipe.build(gpu),
            canvas,
            pieces: GrowingBuffer::new(gpu, "curves", wgpu::BufferUsages::VERTEX, 1024),
        }
    }

    /// Uploads the curves of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        self.pieces.write(gpu, picture.curves.iter().flat_map(pieces).collect());
    }

    /// Draws the curves in their order.
    pub(super) fn draw(&self, pass: &mut Pass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.canvas, &[]);
        pass.set_vertex_buffer(0, self.pieces.buffer().slice(..));
        pass.draw(0..4, 0..self.pieces.len() as u32);
    }
}

/// The pieces of a curve, each with the lines between it and its neighbours.
fn pieces(curve: &Curve) -> Vec<Piece> {
    let mut points: Vec<Vec2> = curve.points.iter().copied().map(Vec2::from).collect();
    points.dedup();
    if let &[dot] = &points[..] {
        points.push(dot);
    }
    let way = |at: usize| (points[at + 1] - points[at]).normalize_or_zero();
    // The line halves the angle between both pieces; there is none where a curve turns back on itself.
    let joint = |at: usize| match at {
        0 => Vec2::ZERO,
        at if at + 1 >= points.len() => Vec2::ZERO,
        at => (way(at - 1) + way(at)).normalize_or_zero(),
    };
    let [red, green, blue] = curve.colour;
    let colour = [red, green, blue, (255.0 * curve.alpha.clamp(0.0, 1.0)).round() as u8];
    let mut dashes = [0.0; 6];
    dashes.iter_mut().zip(&curve.dash).for_each(|(own, &length)| *own = length);
    let period: f64 = dashes.iter().map(|&length| f64::from(length)).sum();
    let mut gone = 0.0_f64;
    let piece = |at: usize| {
        let ends = [points[at], points[at + 1]];
        let begun = if period > 0.0 { gone % period } else { 0.0 };
        gone += f64::from(ends[0].distance(ends[1]));
        let pattern = [curve.width, begun as f32, period as f32];
        Piece { ends, joints: [joint(at), joint(at + 1)], colour, pattern, dashes }
    };
    (0..points.len().saturating_sub(1)).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[[f32; 2]]) -> Curve {
        Curve { points: points.to_vec(), width: 2.0, dash: vec![7.0, 4.0], colour: [1, 2, 3], alpha: 0.5 }
    }

    #[test]
    fn pieces_meet_in_lines_that_both_know() {
        let pieces = pieces(&curve(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [10.0, 10.0], [20.0, 10.0]]));
        assert_eq!(pieces.len(), 3, "a point twice is one point");
        assert_eq!((pieces[0].joints[0], pieces[2].joints[1]), (Vec2::ZERO, Vec2::ZERO));
        for two in pieces.windows(2) {
            assert_eq!((two[0].ends[1], two[0].joints[1]), (two[1].ends[0], two[1].joints[0]));
        }
        assert!((pieces[0].joints[1] - Vec2::splat(0.5_f32.sqrt())).length() < 1e-6);
        // The pattern continues from the last piece.
        assert_eq!(pieces.iter().map(|piece| piece.pattern[1]).collect::<Vec<_>>(), [0.0, 10.0, 9.0]);
        assert_eq!(pieces[0].colour, [1, 2, 3, 128]);
    }

    #[test]
    fn a_point_is_a_dot_and_nothing_is_nothing() {
        assert_eq!(pieces(&curve(&[[3.0, 4.0]])).len(), 1);
        assert!(pieces(&curve(&[])).is_empty());
        let back = pieces(&curve(&[[0.0, 0.0], [10.0, 0.0], [0.0, 0.0]]));
        assert!(back.iter().flat_map(|piece| piece.joints).all(|joint| joint == Vec2::ZERO));
    }
}
