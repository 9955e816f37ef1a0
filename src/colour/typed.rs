//! Colours as typed.

use super::Colour;
use csscolorparser::NAMED_COLORS;

/// Why a text is not a colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum UnknownColour {
    /// Neither a name nor digits.
    Unknown,
    /// Digits of a colour without the `#` before them.
    WithoutHash,
    /// `#` or a function with digits or numbers that no colour has.
    Digits,
    /// A colour that is not opaque.
    Transparent,
}

/// Reads an opaque colour: `#rgb`, `#rrggbb`, a name of CSS such as `steelblue`, or a function of CSS such as
/// `hsl(210, 40%, 50%)`.
///
/// # Errors
/// The text is none of these, or its colour is not opaque.
pub(crate) fn parse(text: &str) -> Result<Colour, UnknownColour> {
    let text = text.trim();
    let named = names().any(|name| name.eq_ignore_ascii_case(text));
    // Some programs take digits without a `#` for a colour, but `add` is more likely a slip than a green.
    if !named && [3, 4, 6, 8].contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return Err(UnknownColour::WithoutHash);
    }
    let like_digits = text.starts_with('#') || text.contains('(');
    let unknown = if like_digits { UnknownColour::Digits } else { UnknownColour::Unknown };
    let [red, green, blue, alpha] = csscolorparser::parse(text).map_err(|_| unknown)?.to_rgba8();
    if alpha < u8::MAX { Err(UnknownColour::Transparent) } else { Ok([red, green, blue]) }
}

/// A colour as digits: `#93a5ba`.
pub(crate) fn written([red, green, blue]: Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The names of colours in CSS.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    NAMED_COLORS.keys().map(|name| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_names_and_functions_are_colours() {
        for (text, colour) in [
            ("#fff", [255; 3]),
            ("#93A5ba", [0x93, 0xa5, 0xba]),
            (" steelblue ", [70, 130, 180]),
            ("SteelBlue", [70, 130, 180]),
            ("tan", [210, 180, 140]),
            ("rgb(1, 2, 3)", [1, 2, 3]),
            ("hsl(0, 0%, 100%)", [255; 3]),
            ("#ffffffff", [255; 3]),
        ] {
            assert_eq!(parse(text), Ok(colour), "{text}");
            assert_eq!(parse(&written(colour)), Ok(colour));
        }
    }

    #[test]
    fn other_texts_are_told_apart() {
        for (text, why) in [
            ("", UnknownColour::Unknown),
            ("steelblu", UnknownColour::Unknown),
            ("fff", UnknownColour::WithoutHash),
            ("decade", UnknownColour::WithoutHash),
            ("#12", UnknownColour::Digits),
            ("#ggg", UnknownColour::Digits),
            ("rgb(1, 2)", UnknownColour::Digits),
            ("#ffffff80", UnknownColour::Transparent),
            ("transparent", UnknownColour::Transparent),
            ("rgb(0 0 0 / 50%)", UnknownColour::Transparent),
            ("é#", UnknownColour::Unknown),
        ] {
            assert_eq!(parse(text), Err(why), "{text}");
        }
    }
}
