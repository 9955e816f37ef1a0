//! Pages of plots and maps below a title and a caption, as SVG and as PNG.

mod map;
mod plot;
mod ranges;

pub(crate) use map::{Map, Maps, Tile};
pub(crate) use plot::{Line, Plot, Plots};
pub(crate) use ranges::{Ranges, RangesRow};

use crate::failure::Failure;
use localshape::gpu::Gpu;
use localshape::picture::{Diagram, TextStyle};
use localshape::render::Renderer;
use localshape::vector;

/// Red, green and blue (sRGB).
type Colour = [u8; 3];

/// The colours of the program's light theme.
const TEXT: Colour = [0x1b, 0x23, 0x2e];
const SECOND_TEXT: Colour = [0x5c, 0x66, 0x72];
const AXIS: Colour = [0x7a, 0x84, 0x91];
const HAIRLINE: Colour = [0xd8, 0xdc, 0xe1];
const GROUND: Colour = [0xfb, 0xfb, 0xfa];

/// Width of a page in print (mm), and in pixels.
const WIDE_MM: f64 = 180.0;
const WIDE: f64 = 1280.0;
/// Free at the left and the right of a page (px).
const MARGIN: f64 = 40.0;
/// The baselines of the title and of the caption's first line, and the distance of its lines (px).
const TITLE: f64 = 56.0;
const CAPTION: f64 = 84.0;
const LINE: f64 = 21.0;
/// Sizes of type (px).
const HEADING: f64 = 26.0;
const USUAL: f64 = 16.0;
const SMALL: f64 = 14.5;
/// How far the middle of small letters lies above their baseline, in parts of the type's size.
const MIDDLE: f64 = 0.34;

/// A page below its title.
pub(crate) trait Page: Send {
    /// The title.
    fn title(&self) -> &str;

    /// Lines below it.
    fn caption(&self) -> &[String];

    /// Width and height of the page (px).
    fn size(&self) -> [u32; 2];

    /// Draws what stands below the caption.
    fn draw(&self, sketch: &mut Sketch);

    /// The whole page.
    fn diagram(&self) -> Diagram {
        self.sketch().diagram
    }

    /// The same with all that is on it.
    fn sketch(&self) -> Sketch {
        let mut sketch = Sketch::new(self.size());
        sketch.left(self.title(), HEADING, true, TEXT, [MARGIN, TITLE]);
        for (at, line) in self.caption().iter().enumerate() {
            sketch.left(line, USUAL, false, SECOND_TEXT, [MARGIN, CAPTION + LINE * at as f64]);
        }
        self.draw(&mut sketch);
        sketch
    }
}

/// The files of a page: SVG, then PNG.
pub(crate) fn files(page: &dyn Page, gpu: &Gpu) -> Result<[Vec<u8>; 2], Failure> {
    let diagram = page.diagram();
    let [wide, high] = page.size().map(f64::from);
    let vectors = vector::Page {
        size_mm: Some([WIDE_MM, WIDE_MM * high / wide]),
        title: page.title(),
        ..vector::Page::new(diagram.picture())
    };
    let svg = vector::write(&vectors, vector::Format::Svg).map_err(|error| Failure::Files(error.to_string()))?;
    let image = Renderer::new(gpu, page.size())
        .and_then(|mut renderer| renderer.draw(diagram.picture()))
        .map_err(|error| Failure::Adapter(error.to_string()))?;
    Ok([svg, png(page.size(), &image)])
}

/// Pixels as PNG, with their number in a metre of print.
fn png([wide, high]: [u32; 2], pixels: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, wide, high);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let per_metre = (f64::from(wide) / (1e-3 * WIDE_MM)).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    let mut writer = encoder.write_header().expect("writing to memory");
    writer.write_image_data(pixels).expect("three bytes for each pixel");
    writer.finish().expect("writing to memory");
    bytes
}

/// A diagram that is being drawn.
pub(crate) struct Sketch {
    diagram: Diagram,
    /// What tests look at.
    #[cfg(test)]
    pub(crate) drawn: Vec<Drawn>,
}

/// What is on a page.
#[cfg(test)]
#[derive(Clone, Debug)]
pub(crate) enum Drawn {
    Rectangle,
    Curve(Vec<[f64; 2]>),
    Text { span: [f64; 2], baseline: f64, is_label: bool },
}

impl Sketch {
    fn new(size: [u32; 2]) -> Self {
        Self {
            diagram: Diagram::new(size),
            #[cfg(test)]
            drawn: Vec::new(),
        }
    }

    fn text(&mut self, text: &str, style: TextStyle, at: [f64; 2]) {
        #[cfg(test)]
        self.drawn.push(Drawn::Text {
            span: [at[0], at[0] + self.diagram.text_width(text, style)],
            baseline: at[1],
            is_label: style.has_halo,
        });
        self.diagram.text(text, style, at);
    }

    /// Text that begins at a place (px).
    fn left(&mut self, text: &str, size: f64, is_bold: bool, colour: Colour, at: [f64; 2]) {
        self.text(text, TextStyle { size, is_bold, colour, has_halo: false }, at);
    }

    /// Text that ends at a place (px).
    fn right(&mut self, text: &str, size: f64, colour: Colour, [right, baseline]: [f64; 2]) {
        self.left(text, size, false, colour, [right - self.width(text, size, false), baseline]);
    }

    /// Text with its middle at a place (px).
    fn centred(&mut self, text: &str, size: f64, colour: Colour, [middle, baseline]: [f64; 2]) {
        self.left(text, size, false, colour, [middle - 0.5 * self.width(text, size, false), baseline]);
    }

    /// Small semi-bold text that stands out from lines behind it.
    fn label(&mut self, text: &str, colour: Colour, at: [f64; 2]) {
        self.text(text, TextStyle { size: SMALL, is_bold: true, colour, has_halo: true }, at);
    }

    /// The width of a text (px).
    fn width(&self, text: &str, size: f64, is_bold: bool) -> f64 {
        self.diagram.text_width(text, TextStyle { size, is_bold, colour: TEXT, has_halo: false })
    }

    /// The text, without its end if it is wider than the room (px).
    fn shortened(&self, text: &str, size: f64, is_bold: bool, room: f64) -> String {
        if self.width(text, size, is_bold) <= room {
            return text.to_owned();
        }
        let ends = text.char_indices().map(|(at, _)| at).rev();
        let mut shorter = ends.map(|end| format!("{}…", text[..end].trim_end()));
        shorter.find(|text| self.width(text, size, is_bold) <= room).unwrap_or_default()
    }

    /// A filled rectangle: left, top, width and height (px).
    fn rectangle(&mut self, rectangle: [f64; 4], colour: Colour) {
        #[cfg(test)]
        self.drawn.push(Drawn::Rectangle);
        self.diagram.rectangle(rectangle, colour);
    }

    /// A line through points (px).
    fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        self.dashed(points, width, colour, &[]);
    }

    /// A line with dashes and gaps (px).
    fn dashed(&mut self, points: &[[f64; 2]], width: f64, colour: Colour, dash: &[f64]) {
        #[cfg(test)]
        self.drawn.push(Drawn::Curve(points.to_vec()));
        self.diagram.curve(points, width, colour, dash);
    }

    /// A disc.
    fn dot(&mut self, at: [f64; 2], radius: f64, colour: Colour) {
        self.line(&[at], 2.0 * radius, colour);
    }
}

/// A power of ten as one writes it.
pub(crate) fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let digits = power.to_string();
            let raised = digits.chars().map(|sign| sign.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
            format!("10{}", raised.collect::<String>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Drawn, Page, power_of_ten};

    #[test]
    fn powers_are_written_with_raised_digits() {
        assert_eq!([-12, -3, 0, 1, 4].map(power_of_ten), ["10⁻¹²", "10⁻³", "1", "10", "10⁴"]);
    }

    /// The points of all curves of a page, all of which are within its width, as all words are.
    pub(super) fn curves(page: &dyn Page) -> Vec<Vec<[f64; 2]>> {
        let (wide, drawn) = (f64::from(page.size()[0]), page.sketch().drawn);
        let curves = drawn.into_iter().filter_map(|one| match one {
            Drawn::Curve(points) => Some(points),
            Drawn::Text { span, .. } => {
                assert!(span[0] >= 0.0 && span[1] <= wide, "{span:?}");
                None
            }
            Drawn::Rectangle => None,
        });
        let curves: Vec<_> = curves.collect();
        assert!(curves.iter().flatten().all(|[x, _]| (0.0..=wide).contains(x)));
        curves
    }
}
