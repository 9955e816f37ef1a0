//! Words: which glyphs they need and how wide they are. Rasterising them is the renderer's work.

use super::narrow::narrow;
use ab_glyph::{Font, FontRef, GlyphId};
use std::sync::LazyLock;

/// The two weights in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Weight {
    /// For everything that explains.
    Regular,
    /// For names and counts.
    SemiBold,
}

/// One glyph of a line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glyph {
    /// Its number in the font.
    pub id: u16,
    /// Where its origin stands, from the left of the picture (px).
    pub x: f32,
}

/// A line of text, laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct TextRun {
    /// What it says, after shortening.
    pub text: String,
    /// Its weight.
    pub weight: Weight,
    /// Size of the type (px).
    pub size: f32,
    /// Height of the baseline, down from the top of the picture (px).
    pub baseline: f32,
    /// Its colour.
    pub colour: super::palette::Colour,
    /// Left and right end (px).
    pub span: [f32; 2],
    /// Its glyphs from left to right.
    pub glyphs: Vec<Glyph>,
    /// Whether it lies over something that it must stand out from.
    pub has_halo: bool,
}

impl TextRun {
    /// Left, top, right and bottom of the box that it may fill (px): from its ascenders to its descenders.
    pub fn bounds(&self) -> [f32; 4] {
        let [left, right] = self.span;
        [left, self.baseline - ASCENT * self.size, right, self.baseline + DESCENT * self.size]
    }

    /// Whether it lies over a part of the picture (px).
    pub(super) fn touches(&self, [x, y, width, height]: super::Rectangle) -> bool {
        let [left, top, right, bottom] = self.bounds();
        let [x, y, x2, y2] = [x, y, x + width, y + height].map(|at| at as f32);
        width > 0 && height > 0 && left < x2 && right > x && top < y2 && bottom > y
    }
}

/// How far letters reach above and below the baseline, in parts of the type's size.
const ASCENT: f32 = 0.78;
const DESCENT: f32 = 0.22;

static REGULAR: LazyLock<FontRef<'static>> =
    LazyLock::new(|| load(include_bytes!("../../assets/fonts/LocalshapeSans-Regular.otf")));
static SEMI_BOLD: LazyLock<FontRef<'static>> =
    LazyLock::new(|| load(include_bytes!("../../assets/fonts/LocalshapeSans-SemiBold.otf")));

fn load(bytes: &'static [u8]) -> FontRef<'static> {
    FontRef::try_from_slice(bytes).expect("the font that comes with the program is whole")
}

/// The font of a weight.
pub fn font(weight: Weight) -> &'static FontRef<'static> {
    match weight {
        Weight::Regular => &REGULAR,
        Weight::SemiBold => &SEMI_BOLD,
    }
}

/// Stands for what was cut off.
const ELLIPSIS: char = '…';

/// The glyph of a character. The first glyph of the font is a box, which stands for all characters it does not have.
fn glyph(font: &FontRef<'static>, character: char) -> GlyphId {
    font.glyph_id(if character.is_whitespace() { ' ' } else { character })
}

/// How far a character moves the pen, in units of the type's size. All digits move it equally far, so that numbers
/// do not jump from frame to frame.
fn advance(font: &FontRef<'static>, character: char) -> f64 {
    let units = f64::from(font.units_per_em().unwrap_or(1000.0));
    let of = |character| f64::from(font.h_advance_unscaled(glyph(font, character))) / units;
    if character.is_ascii_digit() { ('0'..='9').map(of).fold(0.0, f64::max) } else { of(character) }
}

/// The width of a text set at a size (px).
pub fn width(text: &str, weight: Weight, size: f64) -> f64 {
    let font = font(weight);
    text.chars().map(|character| advance(font, character)).sum::<f64>() * size
}

/// The text itself if it is at most `room` wide (px), else its beginning and an ellipsis; nothing if even that is too
/// wide. Characters that take no place of their own, such as line breaks, become spaces.
pub fn shortened(text: &str, weight: Weight, size: f64, room: f64) -> String {
    let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let text = text.trim();
    if width(text, weight, size) <= room {
        return text.to_owned();
    }
    let font = font(weight);
    let mut used = advance(font, ELLIPSIS) * size;
    let mut kept = String::new();
    for character in text.chars() {
        used += advance(font, character) * size;
        if used > room {
            break;
        }
        kept.push(character);
    }
    if kept.is_empty() { String::new() } else { format!("{}{ELLIPSIS}", kept.trim_end()) }
}

/// Lays out one line that begins at `left` (px).
pub(super) fn lay_out(
    text: &str,
    weight: Weight,
    size: f64,
    colour: super::palette::Colour,
    left: f64,
    baseline: f64,
) -> TextRun {
    let font = font(weight);
    let units = f64::from(font.units_per_em().unwrap_or(1000.0));
    let mut pen = left;
    let mut glyphs = Vec::with_capacity(text.len());
    for character in text.chars() {
        let id = glyph(font, character);
        let own = f64::from(font.h_advance_unscaled(id)) / units * size;
        let moved = advance(font, character) * size;
        // A digit that is narrower than the widest one stands in the middle of its cell.
        glyphs.push(Glyph { id: id.0, x: narrow(pen + (moved - own) / 2.0) });
        pen += moved;
    }
    TextRun {
        text: text.to_owned(),
        weight,
        size: narrow(size),
        baseline: narrow(baseline),
        colour,
        span: [narrow(left), narrow(pen)],
        glyphs,
        has_halo: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_captions_need() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            for character in "AZaz09äöüßéñ ΑΩαωΔζων−–—…×°²³⁻∞≤≥≈→′√%/()".chars()
            {
                assert_ne!(font(weight).glyph_id(character).0, 0, "{character} in {weight:?}");
            }
        }
    }

    #[test]
    fn unknown_characters_get_a_visible_box() {
        let run = lay_out("龍", Weight::Regular, 16.0, [0; 3], 0.0, 0.0);
        let id = GlyphId(run.glyphs[0].id);
        assert!(font(Weight::Regular).outline(id).is_some_and(|outline| !outline.curves.is_empty()));
        assert!(run.span[1] > 4.0);
    }

    #[test]
    fn numbers_of_equal_length_are_equally_wide() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            assert_eq!(width("111 ms", weight, 26.0), width("888 ms", weight, 26.0));
        }
    }

    #[test]
    fn long_names_are_shortened_to_their_room() {
        let name = "A very long name that nobody would ever read to its end";
        for room in [0.0, 10.0, 30.0, 100.0, 300.0] {
            let short = shortened(name, Weight::SemiBold, 26.0, room);
            assert!(width(&short, Weight::SemiBold, 26.0) <= room, "{short}");
            assert!(short.is_empty() || short.ends_with('…'));
        }
        assert_eq!(shortened("Short", Weight::SemiBold, 26.0, 300.0), "Short");
        assert_eq!(shortened("two\nlines", Weight::Regular, 16.0, 300.0), "two lines");
    }
}
