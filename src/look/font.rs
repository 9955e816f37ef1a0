//! Reads the files of fonts.

use crate::reading::beside::bytes;
use crate::reading::collector::Collector;
use crate::reading::words::hexadecimal;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// The longest accepted file (bytes). Fonts of all Chinese characters have some 20 MiB.
const LONGEST: u64 = 64 << 20;
/// The extensions of font files.
const ENDINGS: [&str; 3] = ["ttf", "otf", "ttc"];
const EXPECTED: &str = "expected a TrueType or OpenType font (.ttf, .otf, .ttc)";

/// The built-in fonts of explanations, and of names and counts.
#[cfg(feature = "render")]
pub(crate) static REGULAR: &[u8] = include_bytes!("../../assets/fonts/LocalshapeSans-Regular.otf");
#[cfg(feature = "render")]
pub(crate) static SEMI_BOLD: &[u8] = include_bytes!("../../assets/fonts/LocalshapeSans-SemiBold.otf");

/// Invisible characters: marks of direction, joiners, variation selectors.
#[cfg(feature = "render")]
pub(crate) fn is_invisible(character: char) -> bool {
    matches!(
        character,
        '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2064}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}'
    )
}

/// Font files, TrueType or OpenType (.ttf, .otf, .ttc), beside the scene file.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FontFile {
    /// The font of all text, TrueType or OpenType (.ttf, .otf, .ttc), beside the scene file. It must have digits and
    /// Latin letters; other letters that it lacks come from the built-in font. Text is drawn from left to right, one
    /// glyph for each character, without shaping or kerning. So Latin, Greek, Cyrillic, Chinese, Japanese and Korean
    /// are supported; Arabic, Hebrew, Devanagari and other scripts that need shaping or run from right to left, and
    /// combining marks, are not.
    #[schemars(length(min = 1))]
    regular: String,
    /// The font of names and counts. Default: the `regular` font.
    #[schemars(length(min = 1))]
    semi_bold: Option<String>,
}

/// The fonts of a scene, as the bytes of checked files. The built-in font takes the place of missing ones.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct FontFiles {
    /// The font of all text.
    pub regular: Option<Arc<[u8]>>,
    /// The font of names and counts; the regular one by default.
    pub semi_bold: Option<Arc<[u8]>>,
}

impl fmt::Debug for FontFiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Lengths instead of millions of bytes.
        let bytes = |font: &Option<Arc<[u8]>>| font.as_ref().map(|font| font.len());
        let [regular, semi_bold] = [bytes(&self.regular), bytes(&self.semi_bold)];
        f.debug_struct("FontFiles").field("regular", &regular).field("semi_bold", &semi_bold).finish()
    }
}

/// The fonts of a scene, searched in its folder, or `None` after reporting mistakes in them.
pub(crate) fn read(folder: &Path, typed: &FontFile, report: &Collector<'_>) -> Option<FontFiles> {
    let one = |key: &str, name: &str| {
        let found = bytes(&folder.join(name), &ENDINGS, LONGEST, "a font", EXPECTED);
        let found = found.and_then(|bytes| check(&bytes).map(|()| Arc::from(bytes)).map_err(|message| (message, None)));
        let here = report.to("view").to("font").to(key);
        found.map_err(|(message, help)| here.wrong(format!("`{name}` {message}"), help)).ok()
    };
    let regular = one("regular", &typed.regular);
    let semi_bold = typed.semi_bold.as_ref().map(|name| one("semi_bold", name));
    Some(FontFiles { regular: Some(regular?), semi_bold: semi_bold.map_or(Some(None), |font| font.map(Some))? })
}

/// Why bytes are not a usable font.
fn check(bytes: &[u8]) -> Result<(), String> {
    match bytes.get(..4) {
        Some([0, 1, 0, 0] | b"true" | b"OTTO" | b"ttcf") => letters(bytes),
        Some(b"wOFF" | b"wOF2") => Err(format!("is a font packed for web pages (WOFF); {EXPECTED}")),
        _ if bytes.is_empty() => Err(format!("is empty; {EXPECTED}")),
        _ => Err(format!("is not a font; {EXPECTED}")),
    }
}

/// Why bytes that begin like a font are not a usable one.
#[cfg(feature = "render")]
fn letters(bytes: &[u8]) -> Result<(), String> {
    let font = ttf_parser::Face::parse(bytes, 0)
        .map_err(|_| format!("begins like a font but is damaged or cut short; {EXPECTED}"))?;
    let outline = |character: &char| font.glyph_bounding_box(font.glyph_index(*character)?);
    let needed = ('0'..='9').chain('A'..='Z').chain('a'..='z');
    let missing: Vec<char> = needed.filter(|character| outline(character).is_none()).collect();
    match missing[..] {
        [] => Ok(()),
        [first, ..] => Err(format!(
            "has no outline for {} of the digits and Latin letters, {first:?} among them, so numbers could not be written",
            missing.len()
        )),
    }
}

/// Builds that cannot draw check only the beginning of the file.
#[cfg(not(feature = "render"))]
fn letters(_: &[u8]) -> Result<(), String> {
    Ok(())
}

/// The characters of a text that neither a scene's fonts nor the built-in ones have, each once.
#[cfg(feature = "render")]
pub(crate) fn missing(files: &FontFiles, text: &str) -> Vec<char> {
    let own = [&files.regular, &files.semi_bold].into_iter().flatten().map(|file| &**file);
    let fonts = own.chain([REGULAR, SEMI_BOLD]).filter_map(|bytes| ttf_parser::Face::parse(bytes, 0).ok());
    let fonts: Vec<_> = fonts.collect();
    let is_drawn = |&c: &char| !c.is_whitespace() && !c.is_control() && !is_invisible(c);
    let is_missing = |c: &char| fonts.iter().all(|font| font.glyph_index(*c).is_none_or(|glyph| glyph.0 == 0));
    let mut missing = Vec::new();
    for character in text.chars().filter(is_drawn).filter(is_missing) {
        if !missing.contains(&character) {
            missing.push(character);
        }
    }
    missing
}

/// Builds that cannot draw have no fonts.
#[cfg(not(feature = "render"))]
pub(crate) fn missing(_: &FontFiles, _: &str) -> Vec<char> {
    Vec::new()
}

/// The digest of a file, which replaces its name in the digest of a scene.
pub(crate) fn digest(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}
