//! Fonts of a page.

use super::*;

/// A browser then looks for the character in other fonts.
#[test]
fn characters_without_a_glyph_are_not_in_the_table() {
    const MISSING: char = '\u{10ffff}';
    let fonts = Fonts::default();
    let whole = ttf_parser::Face::parse(fonts.face(0).bytes(), 0).expect("a font");
    let glyph = whole.glyph_index('a').expect("its glyph").0;
    let part = Subset::new(&fonts, 0, &BTreeMap::from([(0, vec![MISSING]), (glyph, vec!['a'])])).expect("a font");
    assert_eq!(part.characters, BTreeMap::from([('a', part.glyph(glyph))]));
    let bytes = part.for_browsers();
    let read = ttf_parser::Face::parse(&bytes, 0).expect("a font");
    assert_eq!(
        (read.glyph_index(MISSING), read.glyph_index('a').map(|glyph| glyph.0)),
        (None, Some(part.glyph(glyph)))
    );
}
