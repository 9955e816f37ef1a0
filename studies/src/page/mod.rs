//! Pages of plots or maps below a title and a caption, as SVG and as PNG.

mod map;
mod plot;

pub(crate) use map::Map;
pub(crate) use plot::{Line, Plot};

use image::ImageFormat;
use localshape::picture::{Diagram, TextStyle};
use localshape::render::Renderer;
use localshape::vector::{self, VectorError};
use std::io::Cursor;

/// Red, green and blue (sRGB).
type Colour = [u8; 3];
/// A rectangle: left, top, right and bottom (px).
type Area = [f64; 4];

/// The colours of the program's light theme.
const TEXT: Colour = [0x1b, 0x23, 0x2e];
const SECOND_TEXT: Colour = [0x5c, 0x66, 0x72];

/// Styles of text: of the title, of names, of captions and legends, of numbers and axes.
const TITLE: TextStyle = style(26.0, true, TEXT);
const NAME: TextStyle = style(16.0, true, TEXT);
const USUAL: TextStyle = style(16.0, false, SECOND_TEXT);
const SMALL: TextStyle = style(14.5, false, SECOND_TEXT);

const fn style(size: f64, is_bold: bool, colour: Colour) -> TextStyle {
    TextStyle { size, is_bold, colour, has_halo: false }
}

/// The middle of small letters above their baseline, in sizes of type.
const MIDDLE: f64 = 0.34;
/// Width of a page in print (mm), and in pixels; its margins, and the gap between its parts (px).
const WIDE_MM: f64 = 180.0;
const WIDE: f64 = 1280.0;
const MARGIN: f64 = 40.0;
const BETWEEN: f64 = 34.0;
/// The baselines of the title and of the caption's first line, and the distance of its lines (px).
const TITLE_AT: f64 = 56.0;
const CAPTION_AT: f64 = 84.0;
const LINE: f64 = 21.0;

/// A page.
pub(crate) struct Page {
    pub(crate) title: String,
    /// Lines below the title.
    pub(crate) caption: Vec<String>,
    pub(crate) contents: Contents,
}

/// The parts of a page.
pub(crate) enum Contents {
    /// Plots, of which two stand beside each other.
    Plots(Vec<Plot>),
    /// Maps, and how many stand beside each other.
    Maps(Vec<Map>, usize),
}

/// The room around each part of a page: left, above, right and below (px); its height relative to its width, and the
/// height of a legend above all (px).
struct Room {
    around: [f64; 4],
    shape: f64,
    legend: f64,
}

impl Page {
    /// The number of parts, how many stand beside each other, and the room of each.
    fn parts(&self) -> (usize, usize, Room) {
        match &self.contents {
            Contents::Plots(plots) => (plots.len(), 2, plot::ROOM),
            Contents::Maps(maps, columns) => (maps.len(), *columns, map::ROOM),
        }
    }

    /// The places of the parts, and the height of the page.
    fn areas(&self) -> (Vec<Area>, f64) {
        let (count, across, Room { around: [left, above, right, below], shape, legend }) = self.parts();
        let (columns, rows) = (across as f64, count.div_ceil(across) as f64);
        let wide = (WIDE - 2.0 * MARGIN - columns * (left + right) - (columns - 1.0) * BETWEEN) / columns;
        let (high, top) = (shape * wide, CAPTION_AT + LINE * (self.caption.len() as f64 - 0.4) + legend);
        let area = |at: usize| {
            let (column, row) = ((at % across) as f64, (at / across) as f64);
            let x = MARGIN + left + column * (left + wide + right + BETWEEN);
            let y = top + above + row * (above + high + below);
            [x, y, x + wide, y + high]
        };
        ((0..count).map(area).collect(), (top + rows * (above + high + below)).round())
    }

    /// The whole page.
    fn diagram(&self) -> Diagram {
        let (areas, high) = self.areas();
        let mut diagram = Diagram::new([WIDE as u32, high as u32]);
        write(&mut diagram, &self.title, TITLE, 0.0, [MARGIN, TITLE_AT]);
        for (at, line) in self.caption.iter().enumerate() {
            write(&mut diagram, line, USUAL, 0.0, [MARGIN, CAPTION_AT + LINE * at as f64]);
        }
        match &self.contents {
            Contents::Plots(plots) => plot::draw(plots, &areas, &mut diagram),
            Contents::Maps(maps, _) => {
                map::legend(&mut diagram, CAPTION_AT + LINE * self.caption.len() as f64);
                maps.iter().zip(areas).for_each(|(map, area)| map.draw(&mut diagram, area));
            }
        }
        diagram
    }

    /// The files of the page: SVG, then PNG.
    pub(crate) fn files(&self) -> Result<[Vec<u8>; 2], VectorError> {
        let (diagram, (_, high)) = (self.diagram(), self.areas());
        let page = vector::Page {
            size_mm: Some([WIDE_MM, WIDE_MM * high / WIDE]),
            title: &self.title,
            ..vector::Page::new(diagram.picture())
        };
        let svg = vector::write(&page, vector::Format::Svg)?;
        let size = [WIDE as u32, high as u32];
        let image = Renderer::new(None, size)
            .and_then(|mut renderer| renderer.draw(diagram.picture()))
            .expect("a size that can be drawn, and no lit bodies");
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).expect("writing to memory");
        Ok([svg, png.into_inner()])
    }
}

/// Writes a text with its begin (0), its middle (0.5) or its end (1) at a place (px).
fn write(diagram: &mut Diagram, text: &str, style: TextStyle, share: f64, [x, baseline]: [f64; 2]) {
    let left = x - share * diagram.text_width(text, style);
    diagram.text(text, style, [left, baseline]);
}

#[cfg(test)]
#[path = "../../tests/inside/page.rs"]
mod tests;
