//! The three writers of a picture's items: SVG and PDF, where text stays text in embedded parts of its fonts, and pixels.
//! In SVG and PDF, lit bodies are images from the renderer.
//!
//! Nothing here needs a graphics device. The same picture gives the same bytes.

mod font;
mod pdf;
mod pixels;
mod svg;

use crate::picture::{Face, Image, Item, Panel, Path, Pen, Picture, Rectangle, Step, TextRun};
use glam::Vec2;
pub(crate) use pixels::Painter;

/// The format of a vector file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Scalable Vector Graphics.
    Svg,
    /// Portable Document Format.
    Pdf,
}

impl Format {
    /// The format of a file name, if its ending is that of a vector file.
    pub(crate) fn of(path: &std::path::Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "pdf" => Some(Self::Pdf),
            _ => None,
        }
    }
}

/// A picture as a page.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// The pixels of the picture that [`bodies`] returns: red, green and blue of each, in rows from the top left; `None`
    /// without lit panels.
    pub bodies: Option<&'a [u8]>,
    /// Width and height (mm). By default a pixel is 1/96 of an inch.
    pub size_mm: Option<[f64; 2]>,
    /// Its title; empty for none.
    pub title: &'a str,
    /// The program and its version.
    pub maker: &'a str,
    /// Metadata: names without `localshape:`, and texts.
    pub tags: &'a [(&'static str, String)],
}

impl<'a> Page<'a> {
    /// A page without lit panels, title and metadata, where a pixel is 1/96 of an inch.
    pub fn new(picture: &'a Picture) -> Self {
        let maker = concat!("localshape ", env!("CARGO_PKG_VERSION"));
        Self { picture, bodies: None, size_mm: None, title: "", maker, tags: &[] }
    }
}

/// An error of writing a page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VectorError {
    /// A font cannot be embedded.
    #[error("the font cannot be embedded in SVG or PDF ({0}); write PNG, or use another `view.font`")]
    Font(String),
}

/// Half the width of the halo around words over bodies, in sizes of type.
const HALO: f32 = 0.14;

/// Pixels per inch of bodies on pages with a size in pixels, and of these pixels.
const DPI: [f32; 2] = [300.0, 96.0];
/// The largest number of pixels of a side for bodies on pages, unless their picture has more.
const MOST_PIXELS: f32 = 8192.0;

/// Pixels of lit bodies per pixel of their picture.
fn fineness(picture: &Picture, size_mm: Option<[f64; 2]>) -> f32 {
    let longest = picture.size[0].max(picture.size[1]) as f32;
    if size_mm.is_some() { 1.0 } else { (DPI[0] / DPI[1]).min(MOST_PIXELS / longest).max(1.0) }
}

/// A rectangle in a picture that is larger by a factor.
fn enlarged([left, top, width, height]: Rectangle, times: f32) -> Rectangle {
    let [left, top, right, bottom] =
        [left, top, left + width, top + height].map(|side| (side as f32 * times).round() as u32);
    [left, top, right - left, bottom - top]
}

/// The part of a picture that the renderer draws for a page of a size (mm): lit panels without flat items; `None` if there are
/// none. Without a size it is drawn with 300 pixels to an inch, that is, larger.
pub fn bodies(picture: &Picture, size_mm: Option<[f64; 2]>) -> Option<Picture> {
    let panels: Vec<_> = lit(picture).cloned().collect();
    if panels.is_empty() {
        return None;
    }
    let (fonts, ramp) = (picture.fonts.clone(), picture.ramp.clone());
    let (under, above) = Default::default();
    let mut bodies = Picture { fonts, ramp, panels, under, above, ..*picture };
    let times = fineness(picture, size_mm);
    let [_, _, width, height] = enlarged([0, 0, picture.size[0], picture.size[1]], times);
    bodies.size = [width, height];
    for panel in &mut bodies.panels {
        (panel.viewport, panel.region) = (enlarged(panel.viewport, times), enlarged(panel.region, times));
        // The opacity of edges stays that of the picture.
        panel.sight.line_scale *= times;
        panel.sight.focal *= times;
        panel.floor.iter_mut().for_each(|floor| floor.fade_at_words = floor.fade_at_words.map(|height| times * height));
        if let Some(fade) = &mut panel.obstacles.fade {
            fade.room = fade.room.map(|side| times * side);
            fade.distance = fade.distance.map(|length| times * length);
        }
        panel.strokes.iter_mut().for_each(|stroke| stroke.width *= times);
        panel.beads.iter_mut().for_each(|bead| bead.radius *= times);
    }
    Some(bodies)
}

/// The file of a page.
///
/// # Errors
/// A font that cannot be embedded.
pub fn write(page: &Page<'_>, format: Format) -> Result<Vec<u8>, VectorError> {
    let subsets = font::subsets(page.picture)?;
    let picture = page.picture;
    let ground = ground(picture);
    let images: Vec<_> = page.bodies.map_or_else(Vec::new, |pixels| {
        lit(picture).filter_map(|panel| image(page, panel, pixels)).map(Item::Image).collect()
    });
    let items = [&ground].into_iter().chain(&images).chain(&picture.under).chain(&picture.above);
    Ok(match format {
        Format::Svg => svg::file(page, items, &subsets),
        Format::Pdf => pdf::file(page, items, &subsets),
    })
}

/// The panels with a lit body.
fn lit(picture: &Picture) -> impl Iterator<Item = &Panel> {
    picture.panels.iter().filter(|panel| !panel.sight.flat)
}

/// The ground of a picture.
fn ground(picture: &Picture) -> Item {
    let whole = Path::rectangle(Vec2::ZERO, picture.size.map(|length| length as f32).into());
    Item::fill(whole, picture.palette.background)
}

/// The halo of a line of text, if it has one.
fn halo(picture: &Picture, run: &TextRun) -> Option<Item> {
    let pen = Pen::solid(2.0 * HALO * run.size);
    run.has_halo.then(|| Item::stroke(outlines(picture, run), pen, picture.palette.background))
}

/// The part of a lit panel that is not empty.
fn image(page: &Page<'_>, panel: &Panel, pixels: &[u8]) -> Option<Image> {
    let picture = page.picture;
    let times = fineness(picture, page.size_mm);
    let width = enlarged([0, 0, picture.size[0], 0], times)[2] as usize;
    let [left, top, wide, high] = enlarged(panel.viewport, times).map(|length| length as usize);
    let row = |y: usize| &pixels[3 * (y * width + left)..][..3 * wide];
    let is_empty = |pixel: &[u8]| pixel == picture.palette.background;
    let (mut low, mut far) = ([wide, high], [0, 0]);
    for y in 0..high {
        for (x, _) in row(top + y).chunks_exact(3).enumerate().filter(|(_, pixel)| !is_empty(pixel)) {
            (low, far) = ([low[0].min(x), low[1].min(y)], [far[0].max(x + 1), far[1].max(y + 1)]);
        }
    }
    if low[0] >= far[0] {
        return None;
    }
    let rows = (low[1]..far[1]).flat_map(|y| &row(top + y)[3 * low[0]..3 * far[0]]);
    let pixels = rows.copied().collect();
    let size = [far[0] - low[0], far[1] - low[1]];
    let corner = Vec2::new((left + low[0]) as f32, (top + low[1]) as f32);
    let place = [corner, Vec2::new(size[0] as f32, 0.0), Vec2::new(0.0, size[1] as f32)].map(|at| at / times);
    Some(Image { size: size.map(|length| length as u32), pixels, place })
}

/// The outlines of a line of text.
fn outlines(picture: &Picture, run: &TextRun) -> Path {
    let mut path = Path::default();
    for one in &run.glyphs {
        let font = picture.fonts.face(one.face);
        glyph(font, one.id, run.size, Vec2::new(one.x, run.baseline), &mut path);
    }
    path
}

/// Adds the outline of a glyph of a font, with its origin at a point (px).
fn glyph(font: &Face, id: u16, size: f32, origin: Vec2, path: &mut Path) {
    let face = font.parsed();
    let scale = size / f32::from(face.units_per_em());
    face.outline_glyph(ttf_parser::GlyphId(id), &mut Outline { path, origin, scale, last: Vec2::ZERO });
}

/// Collects the outline of a glyph.
struct Outline<'a> {
    path: &'a mut Path,
    origin: Vec2,
    scale: f32,
    last: Vec2,
}

impl Outline<'_> {
    fn at(&mut self, x: f32, y: f32) -> Vec2 {
        self.last = self.origin + self.scale * Vec2::new(x, -y);
        self.last
    }
}

impl ttf_parser::OutlineBuilder for Outline<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.0.push(Step::Move(to));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.0.push(Step::Line(to));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let from = self.last;
        let [control, to] = [[x1, y1], [x, y]].map(|[x, y]| self.at(x, y));
        let cubic = [from.lerp(control, 2.0 / 3.0), to.lerp(control, 2.0 / 3.0), to];
        self.path.0.push(Step::Cubic(cubic));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let points = [[x1, y1], [x2, y2], [x, y]].map(|[x, y]| self.at(x, y));
        self.path.0.push(Step::Cubic(points));
    }

    fn close(&mut self) {
        self.path.0.push(Step::Close);
    }
}
