//! A page as pixels. Colours blend as bytes (sRGB). The same page gives the same bytes on every x86-64 processor with
//! the same C library: the painter is held to 128-bit vectors, because wider ones round some bytes differently.

use crate::picture::{Image, Item, Paint, Path, Pen, Picture, Step, TextRun};
use glam::Vec2;
use std::collections::HashMap;
use std::sync::Arc;
use vello_cpu::color::{AlphaColor, DynamicColor, PremulRgba8, Rgba8, Srgb};
use vello_cpu::kurbo::{Affine, BezPath, Cap, Join, PathEl, Point, Stroke, flatten};
use vello_cpu::peniko::{ColorStop, ColorStops, Extend, Gradient, ImageQuality, ImageSampler, LinearGradientPosition};
use vello_cpu::{
    Image as ImagePaint, ImageSource, Level, Pixmap, PixmapMut, RasterizerSettings, RenderContext, RenderSettings,
    Resources, TargetInit,
};

/// How far straight pieces may lie from the curves that they stand for (px). The painter's own limit is .25.
const FLATNESS: f64 = 0.03;
/// The number of places between two pixels at which glyphs may stand.
const PLACES: f32 = 4.0;

/// The key of the outline of a glyph: its font, of any scene, its number and the size of the type, as bits.
type GlyphKey = (u64, u16, u32);

/// Paints pages of one size.
#[derive(Debug)]
pub(crate) struct Painter {
    context: RenderContext,
    resources: Resources,
    /// Straight outlines of the glyphs that were used (px from the origin).
    glyphs: HashMap<GlyphKey, Arc<[PathEl]>>,
}

/// The vectors that pages are painted with: of all processors of a kind the same, so that the bytes of pictures are, too.
fn level() -> Level {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(level) = Level::try_detect().and_then(Level::as_sse4_2) {
        return Level::Sse4_2(level);
    }
    Level::baseline()
}

impl Painter {
    /// A painter of pages of a width and height (px).
    pub(crate) fn new(size: [u16; 2]) -> Self {
        let settings = RenderSettings { level: level(), num_threads: 0 };
        let context = RenderContext::new_with(size[0], size[1], settings);
        Self { context, resources: Resources::new(), glyphs: HashMap::new() }
    }

    /// Paints a picture over the pixels of its lit bodies, whose lines are given, or over its background: red, green, blue
    /// and full opacity of each, which the painter relies on, in rows from the top left.
    pub(crate) fn paint(&mut self, picture: &Picture, lines: &[Item], pixels: &mut [u8]) {
        self.context.reset();
        lines.iter().chain(&picture.under).chain(&picture.above).for_each(|item| self.item(item, picture));
        let settings = RasterizerSettings { target_init: TargetInit::SrcOver, ..RasterizerSettings::default() };
        let [width, height] = [self.context.width(), self.context.height()];
        let mut target = PixmapMut::new(width, height, pixels).expect("four bytes a pixel");
        target.set_may_have_transparency(false);
        self.context.render_with(target, &mut self.resources, settings);
    }

    fn item(&mut self, item: &Item, picture: &Picture) {
        match item {
            Item::Fill { path, paint } => {
                self.context.set_paint(colour(*paint));
                self.context.fill_path(&outline(path));
            }
            Item::Stroke { path, pen, paint } => {
                self.context.set_paint(colour(*paint));
                self.context.set_stroke(stroke(pen));
                self.context.stroke_path(&outline(path));
            }
            Item::Blend { path, ends, colours } => {
                let [start, end] = ends.map(point);
                let stops: Vec<_> = (0..)
                    .zip(colours)
                    .map(|(at, &one)| ColorStop {
                        offset: at as f32 / (colours.len() - 1) as f32,
                        color: DynamicColor::from_alpha_color(colour(one.into())),
                    })
                    .collect();
                self.context.set_paint(Gradient {
                    kind: LinearGradientPosition { start, end }.into(),
                    extend: Extend::Pad,
                    stops: ColorStops::from(&stops[..]),
                    ..Gradient::default()
                });
                self.context.fill_path(&outline(path));
            }
            Item::Image(image) => self.image(image),
            Item::Text(run) => {
                super::halo(picture, run).iter().for_each(|halo| self.item(halo, picture));
                self.text(run, &picture.fonts);
            }
            Item::Clip { path, items } => {
                self.context.push_clip_path(&outline(path));
                items.iter().for_each(|item| self.item(item, picture));
                self.context.pop_clip();
            }
            Item::Part { items, .. } => items.iter().for_each(|item| self.item(item, picture)),
        }
    }

    fn image(&mut self, image: &Image) {
        let [width, height] = image.size;
        let channels = image.pixels.len() / (width * height) as usize;
        let mut pixmap = Pixmap::new(width as u16, height as u16);
        for (to, from) in pixmap.data_mut().iter_mut().zip(image.pixels.chunks_exact(channels)) {
            let a = from.get(3).copied().unwrap_or(u8::MAX);
            let by = |channel: u8| ((u16::from(channel) * u16::from(a) + 127) / 255) as u8;
            *to = PremulRgba8 { r: by(from[0]), g: by(from[1]), b: by(from[2]), a };
        }
        let [corner, right, down] = image.place;
        let [x, y] = [right / width as f32, down / height as f32];
        let place = [x.x, x.y, y.x, y.y, corner.x, corner.y].map(f64::from);
        let sampler = ImageSampler { quality: ImageQuality::Medium, ..ImageSampler::default() };
        self.context.set_paint(ImagePaint { image: ImageSource::Pixmap(Arc::new(pixmap)), sampler });
        self.context.set_paint_transform(Affine::new(place));
        self.context.fill_path(&outline(&Path::polygon(&[
            corner,
            corner + right,
            corner + right + down,
            corner + down,
        ])));
        self.context.reset_paint_transform();
    }

    /// A line of text. Baselines on whole pixels make all lines equally sharp.
    fn text(&mut self, run: &TextRun, fonts: &crate::picture::Fonts) {
        let mut path = BezPath::new();
        for glyph in &run.glyphs {
            let face = fonts.face(glyph.face);
            let key = (face.key, glyph.id, run.size.to_bits());
            let new = || {
                let mut path = Path::default();
                super::glyph(face, glyph.id, run.size, Vec2::ZERO, &mut path);
                outline(&path).iter().collect()
            };
            let outline = self.glyphs.entry(key).or_insert_with(new);
            let at = [(glyph.x * PLACES).round() / PLACES, run.baseline.round()].map(f64::from);
            let moved = Affine::translate((at[0], at[1]));
            path.extend(outline.iter().map(|&element| moved * element));
        }
        self.context.set_paint(colour(run.colour.into()));
        self.context.fill_path(&path);
    }
}

fn colour(Paint { colour: [r, g, b], alpha }: Paint) -> AlphaColor<Srgb> {
    let opaque: AlphaColor<Srgb> = Rgba8 { r, g, b, a: u8::MAX }.into();
    opaque.with_alpha(alpha)
}

fn point(at: Vec2) -> Point {
    Point::new(at.x.into(), at.y.into())
}

fn stroke(pen: &Pen) -> Stroke {
    let cap = if pen.round { Cap::Round } else { Cap::Butt };
    let stroke = Stroke::new(pen.width.into()).with_caps(cap).with_join(Join::Round);
    stroke.with_dashes(0.0, pen.dash.iter().map(|&length| f64::from(length)))
}

fn element(step: &Step) -> PathEl {
    match *step {
        Step::Move(to) => PathEl::MoveTo(point(to)),
        Step::Line(to) => PathEl::LineTo(point(to)),
        Step::Cubic([one, other, to]) => PathEl::CurveTo(point(one), point(other), point(to)),
        Step::Close => PathEl::ClosePath,
    }
}

/// A path of straight lines.
fn outline(path: &Path) -> BezPath {
    let mut straight = BezPath::new();
    flatten(path.0.iter().map(element), FLATNESS, |element| straight.push(element));
    straight
}
