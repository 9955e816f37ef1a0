//! Text layout: glyphs and widths. The renderer rasterises them.

use super::narrow::narrow;
use crate::colour::Colour;
use crate::look::FontFiles;
use crate::look::font::{REGULAR, SEMI_BOLD, is_invisible};
use sha2::{Digest, Sha256};
use std::sync::Arc;
use ttf_parser::{Face as Parsed, GlyphId};

/// The two weights in use, in the order of the built-in fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Weight {
    /// For explanations.
    Regular,
    /// For names and counts.
    SemiBold,
}

/// One glyph of a line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Glyph {
    /// The number of its font.
    pub face: u8,
    /// Its number in the font.
    pub id: u16,
    /// The place of its origin, from the left of the picture (px).
    pub x: f32,
}

/// A line of text, laid out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TextRun {
    /// Its text, after shortening.
    pub text: String,
    /// Its weight.
    pub weight: Weight,
    /// Size of the type (px).
    pub size: f32,
    /// Height of the baseline, down from the top of the picture (px).
    pub baseline: f32,
    /// Its colour.
    pub colour: Colour,
    /// Left and right end (px).
    pub span: [f32; 2],
    /// Its glyphs from left to right.
    pub glyphs: Vec<Glyph>,
    /// Whether it has a halo, because it lies over a body.
    pub has_halo: bool,
}

impl TextRun {
    /// Left, top, right and bottom of the box that it may fill (px): from its ascenders to its descenders.
    pub(crate) fn bounds(&self) -> [f32; 4] {
        let [left, right] = self.span;
        [left, self.baseline - ASCENT * self.size, right, self.baseline + DESCENT * self.size]
    }

    /// Whether it lies over a part of the picture (px).
    pub(super) fn touches(&self, [x, y, width, height]: super::Rectangle) -> bool {
        let [left, top, right, bottom] = self.bounds();
        let [x, y, x2, y2] = [x, y, x + width, y + height].map(f64::from);
        let [left, top, right, bottom] = [left, top, right, bottom].map(f64::from);
        width > 0 && height > 0 && left < x2 && right > x && top < y2 && bottom > y
    }
}

/// The heights of letters above and below the baseline, in sizes of type.
const ASCENT: f32 = 0.78;
const DESCENT: f32 = 0.22;

/// The fonts of a picture: the scene's fonts, with the built-in ones as fallback. Cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Fonts {
    faces: Arc<[Face]>,
    /// The letters of ASCII, the most frequent ones, in each weight.
    ascii: Arc<[Vec<Letter>; 2]>,
}

/// A character of a text of some weight.
#[derive(Clone, Copy, Debug)]
struct Letter {
    /// The number of its font, and its glyph there.
    face: u8,
    glyph: u16,
    /// The distance by which the glyph moves the pen in its font, and here, in sizes of type.
    own: f64,
    advance: f64,
}

/// One font.
#[derive(Debug)]
pub(crate) struct Face {
    /// Its file, unless it is built in.
    own: Option<Arc<[u8]>>,
    /// Identifies a font, also among those of different scenes.
    pub key: u64,
}

/// Two collections are equal if they hold the same fonts.
impl PartialEq for Fonts {
    fn eq(&self, other: &Self) -> bool {
        self.faces.iter().map(|face| face.key).eq(other.faces.iter().map(|face| face.key))
    }
}

/// The space between thousands, and its width relative to the space between words.
pub(super) const THIN_SPACE: char = '\u{2009}';
const THIN: f64 = 0.6;
/// Replaces the omitted part of a text.
const ELLIPSIS: char = '…';
/// The share of the room that the beginning of a too long text gets. All but the first are for texts with equal
/// beginnings and ends.
const BEGINNINGS: [f64; 5] = [0.6, 1.0, 0.0, 0.8, 0.3];

impl Default for Fonts {
    /// The built-in fonts.
    fn default() -> Self {
        Self::new(&FontFiles::default())
    }
}

impl Fonts {
    /// The fonts of a scene. A file that is not a font is ignored; loaded scenes have none.
    pub(crate) fn new(files: &FontFiles) -> Self {
        let built_in = |key| Face { own: None, key };
        let own = |file: &Option<Arc<[u8]>>| {
            let bytes = file.as_ref()?;
            Parsed::parse(bytes, 0).ok()?;
            let digest = Sha256::digest(bytes);
            let key = digest.iter().take(8).fold(0, |key, &byte| key << 8 | u64::from(byte));
            Some(Face { own: Some(Arc::clone(bytes)), key })
        };
        let own = [&files.regular, &files.semi_bold].map(own);
        let faces = [built_in(0), built_in(1)].into_iter();
        let faces = match own {
            [Some(regular), Some(semi_bold)] => faces.chain([regular, semi_bold]).collect(),
            [Some(only), None] | [None, Some(only)] => faces.chain([only]).collect(),
            [None, None] => faces.collect(),
        };
        let blank = Self { faces, ascii: Arc::default() };
        let letters = |weight| ('\0'..='\x7f').map(|character| blank.look_up(weight, character)).collect();
        let ascii = Arc::new([Weight::Regular, Weight::SemiBold].map(letters));
        Self { ascii, ..blank }
    }

    /// One of the fonts, by the number in glyphs, or the first one if there is none of this number.
    pub(crate) fn face(&self, number: u8) -> &Face {
        self.faces.get(usize::from(number)).unwrap_or(&self.faces[0])
    }

    /// The fonts in which a text of a weight is looked up, in order.
    fn order(&self, weight: Weight) -> impl Iterator<Item = u8> {
        let built_in = weight as u8;
        // The scene's own are stored after the built-in ones; a single one serves both weights.
        let own = match self.faces.len() {
            2 => None,
            3 => Some(2),
            _ => Some(2 + built_in),
        };
        own.into_iter().chain([built_in])
    }

    /// The font and the glyph of a character; the first glyph of a font for characters that no font has.
    fn glyph(&self, weight: Weight, character: char) -> (u8, u16) {
        let character = if character.is_whitespace() { ' ' } else { character };
        let mut last = (0, 0);
        for number in self.order(weight) {
            last = (number, self.face(number).parsed().glyph_index(character).map_or(0, |glyph| glyph.0));
            if last.1 != 0 {
                break;
            }
        }
        last
    }

    /// A character with its data for a line.
    fn letter(&self, weight: Weight, character: char) -> Letter {
        let known = self.ascii[weight as usize].get(character as usize);
        known.copied().unwrap_or_else(|| self.look_up(weight, character))
    }

    /// A character from the fonts. All digits move the pen equally far, so that numbers do not jump between frames.
    fn look_up(&self, weight: Weight, character: char) -> Letter {
        let own = |(face, glyph): (u8, u16)| {
            let face = self.face(face).parsed();
            let advance = face.glyph_hor_advance(GlyphId(glyph)).unwrap_or_default();
            f64::from(advance) / f64::from(face.units_per_em())
        };
        let of = |character| own(self.glyph(weight, character));
        let (face, glyph) = self.glyph(weight, character);
        let advance = match character {
            '0'..='9' => ('0'..='9').map(of).fold(0.0, f64::max),
            THIN_SPACE => THIN * of(' '),
            _ => of(character),
        };
        Letter { face, glyph, own: own((face, glyph)), advance }
    }

    /// A character, or its code if no font has it: `[5F62]`.
    fn drawn(&self, weight: Weight, character: char) -> impl Iterator<Item = char> {
        let code = (self.letter(weight, character).glyph == 0).then(|| format!("[{:04X}]", u32::from(character)));
        let own = code.is_none().then_some(character);
        let code = code.filter(|_| !is_invisible(character));
        own.into_iter().chain(code.into_iter().flat_map(|code| code.into_bytes()).map(char::from))
    }

    /// The distance by which a character moves the pen, in sizes of type.
    fn advance(&self, weight: Weight, character: char) -> f64 {
        self.drawn(weight, character).map(|drawn| self.letter(weight, drawn).advance).sum()
    }

    /// The width of a text set at a size (px).
    pub(crate) fn width(&self, text: &str, weight: Weight, size: f64) -> f64 {
        text.chars().map(|character| self.advance(weight, character)).sum::<f64>() * size
    }

    /// The text if it is at most `room` wide (px), otherwise its beginning and its end with an ellipsis between them;
    /// empty if even that is too wide. Characters without a width, such as line breaks, become spaces.
    pub(crate) fn shortened(&self, text: &str, weight: Weight, size: f64, room: f64) -> String {
        self.cut_out(text, weight, size, room, BEGINNINGS[0])
    }

    /// One of several texts, shortened if they are too long. The part that distinguishes it from the others is kept as
    /// far as possible: what all end with is left out if they would be equal.
    pub(crate) fn told_apart(&self, text: &str, all: &[&str], weight: Weight, size: f64, room: f64) -> String {
        let ends = all.iter().filter(|&&other| other != text).map(|other| shared_end(text, other));
        let end = ends.min().filter(|&end| end < text.len()).unwrap_or_default();
        let without_end = |text: &str| format!("{}{ELLIPSIS}", text[..text.len() - end].trim_end());
        let cut = |text: &str, beginning: f64| self.cut_out(text, weight, size, room, beginning);
        let whole = BEGINNINGS.map(|beginning| (false, beginning));
        let of = |text: &str, (is_cut, beginning): (bool, f64)| {
            if is_cut { cut(&without_end(text), beginning) } else { cut(text, beginning) }
        };
        let is_own = |&way: &(bool, f64)| {
            let own = of(text, way);
            all.iter().all(|&other| other == text || of(other, way) != own)
        };
        let ways = whole.into_iter().chain(whole.map(|(_, beginning)| (true, beginning)));
        of(text, ways.into_iter().find(is_own).unwrap_or(whole[0]))
    }

    /// A text for a room (px) without the part between its beginning, which gets a share of the room, and its end.
    fn cut_out(&self, text: &str, weight: Weight, size: f64, room: f64, beginning: f64) -> String {
        let seen = text.chars().filter(|&c| !is_invisible(c));
        let text: String = seen.map(|c| if c.is_control() { ' ' } else { c }).collect();
        let text = text.trim();
        if self.width(text, weight, size) <= room {
            return text.to_owned();
        }
        let room = room - self.advance(weight, ELLIPSIS) * size;
        let letters: Vec<char> = text.chars().collect();
        let fitting = |letters: &mut dyn Iterator<Item = &char>, room: f64| {
            let mut used = 0.0;
            letters
                .take_while(|&&letter| {
                    used += self.advance(weight, letter) * size;
                    used <= room
                })
                .count()
        };
        let kept = fitting(&mut letters.iter(), beginning * room);
        let start: String = letters[..kept].iter().collect();
        let left = room - self.width(&start, weight, size);
        let end = letters.len() - fitting(&mut letters[kept..].iter().rev(), left);
        let end: String = letters[end..].iter().collect();
        if kept == 0 && end.is_empty() {
            String::new()
        } else {
            format!("{}{ELLIPSIS}{}", start.trim_end(), end.trim_start())
        }
    }

    /// Lays out one line that begins at `left` (px). Characters that no font has become their codes.
    pub(crate) fn lay_out(
        &self,
        text: &str,
        weight: Weight,
        size: f64,
        colour: Colour,
        left: f64,
        baseline: f64,
    ) -> TextRun {
        let text: String = text.chars().flat_map(|character| self.drawn(weight, character)).collect();
        let mut pen = left;
        let mut glyphs = Vec::with_capacity(text.len());
        for character in text.chars() {
            let Letter { face, glyph, own, advance } = self.letter(weight, character);
            let [own, moved] = [own, advance].map(|advance| advance * size);
            // A digit narrower than the widest one is centred in its cell.
            glyphs.push(Glyph { face, id: glyph, x: narrow(pen + (moved - own) / 2.0) });
            pen += moved;
        }
        TextRun {
            text,
            weight,
            size: narrow(size),
            baseline: narrow(baseline),
            colour,
            span: [narrow(left), narrow(pen)],
            glyphs,
            has_halo: false,
        }
    }
}

/// The length of the end that two texts have in common (bytes).
fn shared_end(one: &str, other: &str) -> usize {
    let letters = one.chars().rev().zip(other.chars().rev());
    letters.take_while(|(one, other)| one == other).map(|(letter, _)| letter.len_utf8()).sum()
}

impl Face {
    /// Its tables. Reading where they are takes less than a microsecond.
    pub(crate) fn parsed(&self) -> Parsed<'_> {
        Parsed::parse(self.bytes(), 0).expect("it was read before, or comes with the program")
    }

    /// Its file.
    pub(crate) fn bytes(&self) -> &[u8] {
        match &self.own {
            Some(bytes) => bytes,
            None if self.key == 0 => REGULAR,
            None => SEMI_BOLD,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_captions_need() {
        let fonts = Fonts::default();
        for weight in [Weight::Regular, Weight::SemiBold] {
            for character in "AZaz09äöüßéñ ΑΩαωΔζων−–—…×°²³⁻∞≤≥≈→′√%/()".chars()
            {
                assert_ne!(fonts.glyph(weight, character).1, 0, "{character} in {weight:?}");
            }
        }
    }

    #[test]
    fn unknown_characters_become_their_codes() {
        let fonts = Fonts::default();
        let run = fonts.lay_out("a龍b", Weight::Regular, 16.0, [0; 3], 0.0, 0.0);
        assert_eq!((run.text.as_str(), run.glyphs.len()), ("a[9F8D]b", 8));
        assert!(run.glyphs.iter().all(|glyph| glyph.id != 0));
        assert!((f64::from(run.span[1]) - fonts.width("a龍b", Weight::Regular, 16.0)).abs() < 1e-5);
    }

    #[test]
    fn numbers_of_equal_length_are_equally_wide() {
        for weight in [Weight::Regular, Weight::SemiBold] {
            let width = |text| Fonts::default().width(text, weight, 26.0);
            assert_eq!(width("111 ms"), width("888 ms"));
        }
    }

    #[test]
    fn long_names_are_shortened_to_their_room() {
        let fonts = Fonts::default();
        let name = "A very long name that nobody would ever read to its end";
        for room in [0.0, 10.0, 30.0, 100.0, 300.0] {
            let short = fonts.shortened(name, Weight::SemiBold, 26.0, room);
            assert!(fonts.width(&short, Weight::SemiBold, 26.0) <= room, "{short}");
            assert!(short.is_empty() || short.contains('…'));
        }
        let short = fonts.shortened(name, Weight::SemiBold, 26.0, 300.0);
        assert!(short.starts_with("A very") && short.ends_with("its end"), "{short}");
        assert_eq!(fonts.shortened("Short", Weight::SemiBold, 26.0, 300.0), "Short");
        assert_eq!(fonts.shortened("in\u{200b}vis\u{fe0f}ible", Weight::Regular, 16.0, 300.0), "invisible");
        assert_eq!(fonts.shortened("two\nlines", Weight::Regular, 16.0, 300.0), "two lines");
    }

    #[test]
    fn what_tells_names_apart_stays() {
        let fonts = Fonts::default();
        let end = "with accumulated rotations and the usual stiffness";
        for all in [
            ["Local shape", "Local shape, soft", "Local shape, stiff"].map(|name| format!("{name} {end}")),
            ["1", "2", "3"].map(|number| format!("{end} and number {number} {end}")),
            ["soft", "stiff", "usual"].map(|name| format!("{end} and {end}, {name}")),
        ] {
            let all = all.each_ref().map(String::as_str);
            let short = all.map(|name| fonts.told_apart(name, &all, Weight::SemiBold, 26.0, 330.0));
            assert!(short[0] != short[1] && short[1] != short[2] && short[0] != short[2], "{short:?}");
            assert!(short.iter().all(|name| fonts.width(name, Weight::SemiBold, 26.0) <= 330.0), "{short:?}");
        }
    }

    #[test]
    fn letters_come_from_the_scene_then_from_the_built_in_font_then_there_is_a_code() {
        // A font with an empty character map has no letters, like one of another script.
        let mut blank = REGULAR.to_vec();
        let tables = usize::from(u16::from_be_bytes([blank[4], blank[5]]));
        let entry = (0..tables).map(|at| 12 + 16 * at).find(|&at| &blank[at..at + 4] == b"cmap").unwrap();
        let start = u32::from_be_bytes(blank[entry + 8..entry + 12].try_into().unwrap()) as usize;
        blank[start + 2..start + 4].fill(0);
        let with = |regular: &[u8], semi_bold: Option<&[u8]>| {
            Fonts::new(&FontFiles { regular: Some(regular.into()), semi_bold: semi_bold.map(Into::into) })
        };
        let face = |fonts: &Fonts, weight, text: &str| fonts.lay_out(text, weight, 16.0, [0; 3], 0.0, 0.0).glyphs[0];
        let [own, other] = [with(SEMI_BOLD, None), with(&blank, Some(SEMI_BOLD))];
        assert_eq!(face(&own, Weight::Regular, "A").face, 2);
        assert_eq!(face(&own, Weight::SemiBold, "A").face, 2, "one font serves both weights");
        assert_eq!(face(&other, Weight::Regular, "A").face, 0);
        assert_eq!(face(&other, Weight::SemiBold, "A").face, 3);
        assert_eq!(face(&other, Weight::Regular, "A").id, face(&Fonts::default(), Weight::Regular, "A").id);
        let code = own.lay_out("[9F8D]", Weight::SemiBold, 16.0, [0; 3], 0.0, 0.0);
        assert_eq!(own.lay_out("龍", Weight::SemiBold, 16.0, [0; 3], 0.0, 0.0), code);
        assert_eq!(own.width("111", Weight::Regular, 26.0), own.width("888", Weight::Regular, 26.0));
        assert!(own == with(SEMI_BOLD, None) && own != other && own != Fonts::default());
    }
}
