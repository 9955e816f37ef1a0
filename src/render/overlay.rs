//! Marks and words on top of everything.

use super::glyphs::Glyphs;
use super::pass::Pass;
use super::pipeline::{
    ENCODED_FORMAT, Pipeline, Recipe, bind, for_instances, group_layout, shader, texture_entry, uniform_entry,
};
use crate::gpu::{Gpu, GrowingBuffer};
use crate::picture::{self, Colour, Fonts, MarkShape, Picture, TextRun};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

pub(super) const SHADER: &str = include_str!("../../shaders/overlay.wgsl");

/// Words over bodies have a halo of glyphs in the colour of the ground: the radii of rings, in sizes of type, and the
/// number of glyphs on each.
const HALO: [(f32, u32); 2] = [(0.07, 8), (0.14, 16)];

/// Offsets of whole pixels, roughly even on a circle: glyphs are read pixel by pixel.
fn ring(radius: f32, count: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..count).map(move |at| {
        let (sine, cosine) = (at as f32 / count as f32 * std::f32::consts::TAU).sin_cos();
        [(radius * cosine).round(), (radius * sine).round()]
    })
}

/// Shapes with pipelines of their own.
const RECTANGLE: u32 = 0;
const GLYPH: u32 = 2;

/// One mark or glyph as the shader reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Mark {
    rectangle: [f32; 4],
    along: [f32; 2],
    colour: [u8; 4],
    second: [u8; 4],
    glyph: [u32; 2],
    shape: u32,
}

const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
    0 => Float32x4, 1 => Float32x2, 2 => Unorm8x4, 3 => Unorm8x4, 4 => Uint32x2, 5 => Uint32
];

/// The struct `Canvas` of the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct CanvasUniform {
    pub(super) size: [f32; 2],
    pub(super) unused: [f32; 2],
}

/// The pipelines of the overlay, and the marks and glyphs of one picture.
#[derive(Debug)]
pub(super) struct Overlay {
    /// Pipelines for rectangles, for other marks, and for glyphs.
    pipelines: [Pipeline; 3],
    layout: wgpu::BindGroupLayout,
    canvas: GrowingBuffer<CanvasUniform>,
    glyphs: Glyphs,
    marks: GrowingBuffer<Mark>,
    /// Runs of marks that share a pipeline, in drawing order: below the bodies, above them, and words.
    runs: [Vec<(usize, Range<u32>)>; 3],
    bind_group: Option<wgpu::BindGroup>,
}

impl Overlay {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let module = shader(gpu, "overlay", &[SHADER]);
        let entries = [uniform_entry(0, size_of::<CanvasUniform>(), false), texture_entry(1, false)];
        let layout = group_layout(gpu, "overlay", &entries);
        let build = |fragment| {
            let recipe = Recipe {
                groups: &[&layout],
                vertices: &[Some(for_instances::<Mark>(&ATTRIBUTES))],
                ..Recipe::rectangles(fragment, &module, ["corner", fragment], ENCODED_FORMAT)
            };
            recipe.build(gpu)
        };
        Self {
            pipelines: ["rectangle_colour", "mark_colour", "glyph_colour"].map(build),
            layout,
            canvas: GrowingBuffer::new(gpu, "canvas", wgpu::BufferUsages::UNIFORM, 1),
            glyphs: Glyphs::new(gpu),
            marks: GrowingBuffer::new(gpu, "marks", wgpu::BufferUsages::VERTEX, 256),
            runs: Default::default(),
            bind_group: None,
        }
    }

    /// Uploads the marks and glyphs of a picture.
    pub(super) fn write(&mut self, gpu: &Gpu, picture: &Picture) {
        let mut marks: Vec<_> = picture.under.iter().chain(&picture.marks).map(plain).collect();
        let (under, above) = (picture.under.len() as u32, marks.len() as u32);
        for run in &picture.words {
            if run.has_halo {
                let offsets = HALO.iter().flat_map(|&(radius, count)| ring(radius * run.size, count));
                offsets.for_each(|offset| {
                    self.write_run(&picture.fonts, run, picture.palette.background, offset, &mut marks)
                });
            }
            self.write_run(&picture.fonts, run, run.colour, [0.0; 2], &mut marks);
        }
        self.runs = [0..under, under..above, above..marks.len() as u32].map(|range| runs(&marks, range));
        self.marks.write(gpu, marks);
        if self.glyphs.upload(gpu) || self.bind_group.is_none() {
            let size = picture.size.map(|length| length as f32);
            self.canvas.write(gpu, vec![CanvasUniform { size, unused: [0.0; 2] }]);
            self.bind_group = Some(self.bind(gpu));
        }
    }

    /// Adds the glyphs of a line of text in a colour, shifted (px).
    fn write_run(&mut self, fonts: &Fonts, run: &TextRun, colour: Colour, offset: [f32; 2], marks: &mut Vec<Mark>) {
        for glyph in &run.glyphs {
            if let Some((raster, [x, y])) = self.glyphs.raster(fonts, run, glyph) {
                let [width, height] = raster.size.map(|length| length as f32);
                let [left, top] = [x + raster.offset[0] + offset[0], y + raster.offset[1] + offset[1]];
                marks.push(Mark {
                    rectangle: [left, top, width, height],
                    along: picture::Mark::UPRIGHT,
                    colour: opaque(colour),
                    second: opaque(colour),
                    glyph: raster.at,
                    shape: GLYPH,
                });
            }
        }
    }

    fn bind(&self, gpu: &Gpu) -> wgpu::BindGroup {
        let (canvas, glyphs) = (self.canvas.buffer().as_entire_binding(), self.glyphs.view());
        bind(gpu, "overlay", &self.layout, &[(0, canvas), (1, wgpu::BindingResource::TextureView(&glyphs))])
    }

    /// Draws the marks below the bodies.
    pub(super) fn draw_under(&self, pass: &mut Pass<'_>) {
        self.draw_runs(pass, &self.runs[0]);
    }

    /// Draws the marks above the bodies.
    pub(super) fn draw_marks(&self, pass: &mut Pass<'_>) {
        self.draw_runs(pass, &self.runs[1]);
    }

    /// Draws the words.
    pub(super) fn draw_words(&self, pass: &mut Pass<'_>) {
        self.draw_runs(pass, &self.runs[2]);
    }

    fn draw_runs(&self, pass: &mut Pass<'_>, runs: &[(usize, Range<u32>)]) {
        pass.set_bind_group(0, self.bind_group.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.marks.buffer().slice(..));
        for (pipeline, range) in runs {
            pass.set_pipeline(&self.pipelines[*pipeline]);
            pass.draw(0..4, range.clone());
        }
    }
}

/// The pipeline of a mark, by its place in [`Overlay::pipelines`].
fn pipeline(mark: &Mark) -> usize {
    match mark.shape {
        RECTANGLE => 0,
        GLYPH => 2,
        _ => 1,
    }
}

/// The marks of a range, in runs that share a pipeline.
fn runs(marks: &[Mark], range: Range<u32>) -> Vec<(usize, Range<u32>)> {
    let mut start = range.start;
    let of_one =
        marks[range.start as usize..range.end as usize].chunk_by(|one, other| pipeline(one) == pipeline(other));
    let mut run = |marks: &[Mark]| {
        let first = start;
        start += marks.len() as u32;
        (pipeline(&marks[0]), first..start)
    };
    of_one.map(&mut run).collect()
}

fn opaque([red, green, blue]: Colour) -> [u8; 4] {
    [red, green, blue, 255]
}

/// A mark that is not a glyph, as the shader reads it.
fn plain(mark: &picture::Mark) -> Mark {
    let [red, green, blue] = mark.colour;
    Mark {
        rectangle: mark.rectangle,
        along: mark.along,
        colour: [red, green, blue, mark.opacity],
        second: opaque(mark.second),
        glyph: [0; 2],
        shape: match mark.shape {
            MarkShape::Filled => RECTANGLE,
            MarkShape::Struck => 1,
            MarkShape::Node => 3,
            MarkShape::CounterClockwise => 4,
            MarkShape::Clockwise => 5,
            MarkShape::Fading => 6,
            MarkShape::Shadow => 7,
            MarkShape::Smooth => 8,
            MarkShape::Arrow => 9,
            MarkShape::Blend => 10,
            MarkShape::Point => 11,
            MarkShape::Pin => 12,
            MarkShape::Hand => 13,
        },
    }
}
