//! Pictures made by hand, such as plots of measurements.

use super::caption::Writer;
use super::chart::{Chart, Place};
use super::layout::Scale;
use super::text::{Fonts, Weight};
use super::{Item, Picture};
use crate::look::{Style, Theme};

/// A picture made by hand: rectangles, then curves, then text, in the fonts of the program and on the ground of its light theme.
///
/// Places and lengths are in pixels, to the right and down. [`Renderer`](crate::Renderer) draws the [picture](Self::picture), and
/// [`vector::write`](crate::vector::write) writes it as SVG or PDF.
#[derive(Clone, Debug)]
pub struct Diagram {
    picture: Picture,
}

/// How text in a [`Diagram`] looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Size of the type (px).
    pub size: f64,
    /// Whether it is semi-bold.
    pub is_bold: bool,
    /// Red, green and blue (sRGB).
    pub colour: [u8; 3],
    /// Whether it has a halo in the colour of the ground, so that it can be read above lines.
    pub has_halo: bool,
}

impl TextStyle {
    fn weight(self) -> Weight {
        if self.is_bold { Weight::SemiBold } else { Weight::Regular }
    }
}

impl Diagram {
    /// An empty picture of a width and height (px).
    pub fn new(size: [u32; 2]) -> Self {
        let style = Style::of(Theme::Light);
        let (ramp, panels, under, above) = Default::default();
        let fonts = Fonts::new(&style.font);
        Self { picture: Picture { size, palette: style.palette(), fonts, ramp, panels, under, above } }
    }

    /// Adds a filled rectangle: left, top, width and height.
    pub fn rectangle(&mut self, rectangle: [f64; 4], colour: [u8; 3]) {
        self.picture.under.push(Item::rectangle(rectangle, colour));
    }

    /// Adds a curve through points, with round ends; a single point is a disc. `dash` has the lengths of dashes and
    /// gaps in turn, up to three of each, and is empty for a solid curve.
    pub fn curve(&mut self, points: &[[f64; 2]], width: f64, colour: [u8; 3], dash: &[f64]) {
        let below_text = self.picture.above.partition_point(|item| !matches!(item, Item::Text(_)));
        self.picture.above.insert(below_text, Item::curve(points, width, dash, colour));
    }

    /// Adds a chart in a rectangle, with its numbers below and at the left: left, top, right and bottom.
    pub fn chart(&mut self, chart: &Chart, [left, top, right, bottom]: [f64; 4]) {
        let Picture { palette, fonts, under, above, .. } = &mut self.picture;
        let (marks, curves, words) = Default::default();
        let mut writer = Writer { palette, fonts, scale: Scale::REFERENCE, marks, curves, words };
        let place = Place { left, right, top, bottom, unit: 1.0, line: 1.0 };
        chart.ground(&mut writer, place, true);
        chart.curves(&mut writer, place);
        let Writer { marks, curves, words, .. } = writer;
        under.extend(marks);
        above.splice(0..0, curves);
        above.extend(words.into_iter().map(Item::Text));
    }

    /// Adds a line of text from a place on its baseline.
    pub fn text(&mut self, text: &str, style: TextStyle, [left, baseline]: [f64; 2]) {
        let run = self.picture.fonts.lay_out(text, style.weight(), style.size, style.colour, left, baseline);
        self.picture.above.push(Item::Text(super::TextRun { has_halo: style.has_halo, ..run }));
    }

    /// The width of a line of text.
    pub fn text_width(&self, text: &str, style: TextStyle) -> f64 {
        self.picture.fonts.width(text, style.weight(), style.size)
    }

    /// The finished picture.
    pub fn picture(&self) -> &Picture {
        &self.picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{self, Format, Page};

    #[test]
    fn a_plot_is_made_by_hand() {
        let mut diagram = Diagram::new([320, 200]);
        let style = TextStyle { size: 16.0, is_bold: true, colour: [20, 30, 40], has_halo: true };
        let wide = diagram.text_width("energy", style);
        assert!((40.0..80.0).contains(&wide), "{wide}");
        diagram.rectangle([10.0, 10.0, 1.0, 150.0], [0; 3]);
        diagram.curve(&[[10.0, 20.0], [300.0, 150.0]], 2.0, [0, 114, 178], &[7.0, 4.0]);
        diagram.text("energy", style, [300.0 - wide, 40.0]);
        let picture = diagram.picture();
        assert_eq!((picture.under.len(), picture.above.len(), picture.words().count()), (1, 2, 1));
        assert!((picture.words().next().unwrap().span[1] - 300.0).abs() < 0.01);
        let page = Page { title: "Energy", size_mm: Some([80.0, 50.0]), ..Page::new(picture) };
        let svg = String::from_utf8(vector::write(&page, Format::Svg).unwrap()).unwrap();
        assert!(svg.contains("80mm") && svg.contains("Energy") && svg.contains("energy"), "{svg}");
    }
}
