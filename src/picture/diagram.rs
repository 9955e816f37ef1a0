//! Pictures made by hand, such as plots of measurements.

use super::caption::Writer;
use super::chart::{Chart, PlotArea};
use super::layout::Scale;
use super::text::{Fonts, Weight};
use super::{Item, Picture};
use crate::colour::Colour;
use crate::look::{Lined, Palette, Style, Theme};

/// A picture made by hand: charts and text, in the fonts of the program and on the ground of its light theme.
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

/// The colours of families of curves on light ground: those of runs with the models of these keys, and colours that are left for other keys.
pub fn colours(families: &[&str]) -> Vec<Colour> {
    let palette = Palette::of(Theme::Light);
    let lined: Vec<_> = families.iter().map(|&key| Lined { model: Some(key), chosen: None }).collect();
    palette.places(&lined).into_iter().map(|place| palette.line(place, None).colour).collect()
}

/// The lengths of dashes and gaps (px) of the variants of a family of curves, the first of which is solid.
pub fn dashes(variant: usize) -> &'static [f64] {
    Palette::of(Theme::Light).dash(variant)
}

impl Diagram {
    /// An empty picture of a width and height (px).
    pub fn new(size: [u32; 2]) -> Self {
        let style = Style::of(Theme::Light);
        let (ramp, panels, under, above) = Default::default();
        let fonts = Fonts::new(&style.font);
        Self { picture: Picture { size, palette: style.palette(), fonts, ramp, panels, under, above } }
    }

    /// Adds a chart in a rectangle, with its numbers below and at the left: left, top, right and bottom.
    pub fn chart(&mut self, chart: &Chart, [left, top, right, bottom]: [f64; 4]) {
        let Picture { palette, fonts, under, above, .. } = &mut self.picture;
        let mut writer = Writer::new(palette, fonts, Scale::REFERENCE);
        let place = PlotArea { left, right, top, bottom, unit: 1.0, line: 1.0 };
        chart.ground(&mut writer, place, true);
        chart.curves(&mut writer, place);
        under.append(&mut writer.marks);
        above.extend(writer.items());
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
