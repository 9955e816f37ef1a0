//! The fonts of a page, reduced to the glyphs that it uses.

use super::VectorError;
use crate::picture::{Fonts, Picture};
use std::collections::BTreeMap;
use subsetter::GlyphRemapper;

/// A part of a font.
pub(super) struct Subset<'a> {
    /// The index of the whole font in the picture.
    pub(super) face: u8,
    /// The whole font.
    pub(super) whole: ttf_parser::Face<'a>,
    /// The part, an OpenType font without a table of characters.
    bytes: Vec<u8>,
    /// The number of each glyph in the part.
    glyphs: GlyphRemapper,
    /// The glyph of each character in the part.
    pub(super) characters: BTreeMap<char, u16>,
    /// The width of each glyph of the part (thousandths of the type's size).
    pub(super) widths: Vec<f32>,
}

/// The parts of all fonts that lines of text need, by index.
pub(super) fn subsets(picture: &Picture) -> Result<Vec<Subset<'_>>, VectorError> {
    let mut used: BTreeMap<u8, BTreeMap<u16, Vec<char>>> = BTreeMap::new();
    for run in picture.words() {
        for (glyph, character) in run.glyphs.iter().zip(run.text.chars()) {
            used.entry(glyph.face).or_default().entry(glyph.id).or_default().push(character);
        }
    }
    used.into_iter().map(|(face, used)| Subset::new(&picture.fonts, face, &used)).collect()
}

impl<'a> Subset<'a> {
    fn new(fonts: &'a Fonts, face: u8, used: &BTreeMap<u16, Vec<char>>) -> Result<Self, VectorError> {
        let data = fonts.face(face).bytes();
        let whole = ttf_parser::Face::parse(data, 0).map_err(|error| VectorError::Font(error.to_string()))?;
        let glyphs = GlyphRemapper::new_from_glyphs_sorted(&used.keys().copied().collect::<Vec<_>>());
        let bytes = subsetter::subset(data, 0, &glyphs)
            .map_err(|error| VectorError::Font(format!("{error:?}").to_lowercase()))?;
        let all = used.iter().flat_map(|(&glyph, characters)| characters.iter().map(move |&one| (one, glyph)));
        // The first glyph of a font is a box for missing characters.
        let known = all.filter(|(_, glyph)| *glyph != 0);
        let characters = known.map(|(character, glyph)| (character, glyphs.get(glyph).unwrap_or(0))).collect();
        let units = f32::from(whole.units_per_em());
        let width = |glyph: u16| f32::from(whole.glyph_hor_advance(ttf_parser::GlyphId(glyph)).unwrap_or(0));
        let widths = glyphs.remapped_gids().map(|glyph| 1000.0 * width(glyph) / units).collect();
        Ok(Self { face, whole, bytes, glyphs, characters, widths })
    }

    /// The number of a glyph in the part.
    pub(super) fn glyph(&self, glyph: u16) -> u16 {
        self.glyphs.get(glyph).unwrap_or(0)
    }

    /// A name of the font: 1 for its family, 6 for the whole of it in PostScript.
    pub(super) fn name(&self, kind: u16) -> Option<String> {
        self.whole.names().into_iter().filter(|name| name.name_id == kind).find_map(|name| name.to_string())
    }

    /// The part for PDF: outlines of PostScript alone, or a TrueType font.
    pub(super) fn for_pdf(&self) -> (&[u8], bool) {
        match self.tables().find(|(tag, _)| tag == b"CFF ") {
            Some((_, outlines)) => (outlines, true),
            None => (&self.bytes, false),
        }
    }

    /// The part as a font for browsers, with its table of characters.
    pub(super) fn for_browsers(&self) -> Vec<u8> {
        let characters = cmap(&self.characters);
        let metrics = self.whole.raw_face().table(ttf_parser::Tag::from_bytes(b"OS/2"));
        let more = [(*b"cmap", &characters[..])].into_iter().chain(metrics.map(|table| (*b"OS/2", table)));
        let mut tables: Vec<_> = self.tables().chain(more).collect();
        tables.sort_by_key(|(tag, _)| *tag);
        font_of(&self.bytes[..4], &tables)
    }

    /// The tables of the part.
    fn tables(&self) -> impl Iterator<Item = ([u8; 4], &[u8])> {
        let number = |at: usize| u32::from_be_bytes(self.bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        let count = usize::from(u16::from_be_bytes([self.bytes[4], self.bytes[5]]));
        (0..count).map(move |table| {
            let at = 12 + 16 * table;
            let tag = self.bytes[at..at + 4].try_into().expect("four bytes");
            (tag, &self.bytes[number(at + 8)..][..number(at + 12)])
        })
    }
}

/// The table of characters: a group for each (OpenType, cmap format 12).
fn cmap(characters: &BTreeMap<char, u16>) -> Vec<u8> {
    let length = 16 + 12 * characters.len() as u32;
    let mut table = Vec::new();
    // One subtable, for all of Unicode, 12 bytes from here.
    [0_u16, 1, 3, 10].iter().for_each(|number| table.extend(number.to_be_bytes()));
    table.extend(12_u32.to_be_bytes());
    [12_u16, 0].iter().for_each(|number| table.extend(number.to_be_bytes()));
    [length, 0, characters.len() as u32].iter().for_each(|number| table.extend(number.to_be_bytes()));
    for (&character, &glyph) in characters {
        let character = u32::from(character);
        [character, character, u32::from(glyph)].iter().for_each(|number| table.extend(number.to_be_bytes()));
    }
    table
}

/// An OpenType font of tables that are sorted by their tags.
fn font_of(kind: &[u8], tables: &[([u8; 4], &[u8])]) -> Vec<u8> {
    let count = tables.len() as u16;
    let entries = count.ilog2() as u16;
    let range = 16 << entries;
    let mut font = kind.to_vec();
    [count, range, entries, 16 * count - range].iter().for_each(|number| font.extend(number.to_be_bytes()));
    let mut at = 12 + 16 * tables.len();
    for (tag, table) in tables {
        font.extend(tag);
        [checksum(table), at as u32, table.len() as u32].iter().for_each(|number| font.extend(number.to_be_bytes()));
        at += table.len().next_multiple_of(4);
    }
    for (_, table) in tables {
        font.extend(*table);
        font.resize(font.len().next_multiple_of(4), 0);
    }
    font
}

/// The checksum of a table.
fn checksum(table: &[u8]) -> u32 {
    let number = |four: &[u8]| four.iter().enumerate().map(|(at, &byte)| u32::from(byte) << (24 - 8 * at)).sum::<u32>();
    table.chunks(4).map(number).fold(0, u32::wrapping_add)
}

#[cfg(test)]
#[path = "../../tests/inside/font.rs"]
mod tests;
