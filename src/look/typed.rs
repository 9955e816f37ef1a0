//! Colours as typed.

use crate::colour::{Colour, written};
use crate::reading::words::{nearest, quoted};
use csscolorparser::NAMED_COLORS;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The expected colours, for messages.
const EXPECTED: &str = "; expected digits such as \"#93a5ba\" or a name of CSS such as \"steelblue\"";

/// An opaque colour: `#rgb`, `#rrggbb`, a name of CSS such as `steelblue`, or a function of CSS such as
/// `hsl(210, 40%, 50%)`. It is written back as digits, so that a name and its digits are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(extend("format" = "colour"))]
pub(crate) struct TypedColour(pub(crate) Colour);

impl TypedColour {
    /// Reads a colour.
    ///
    /// # Errors
    /// The continuation of a message about a text that is not a colour, and the remedy.
    pub(crate) fn read(text: &str) -> Result<Self, (String, Option<String>)> {
        let text = text.trim();
        let known: Vec<&str> = NAMED_COLORS.keys().map(|name| name.as_str()).collect();
        let is_named = known.iter().any(|name| name.eq_ignore_ascii_case(text));
        // Some programs take digits without a `#` for a colour, but `add` is more likely a slip than a green.
        if !is_named && [3, 4, 6, 8].contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Err((EXPECTED.to_owned(), Some(format!("write \"#{text}\""))));
        }
        match csscolorparser::parse(text).map(|colour| colour.to_rgba8()) {
            Ok([red, green, blue, u8::MAX]) => Ok(Self([red, green, blue])),
            Ok(_) => Err((", which is transparent; expected an opaque colour".to_owned(), None)),
            Err(_) if text.starts_with('#') || text.contains('(') => {
                Err(("; expected three or six digits, such as \"#93a5ba\"".to_owned(), None))
            }
            Err(_) => {
                let near = nearest(text, &known).map(|name| format!("did you mean {}?", quoted(name)));
                Err((EXPECTED.to_owned(), near))
            }
        }
    }
}

impl TryFrom<String> for TypedColour {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        Self::read(&text).map_err(|(wrong, _)| format!("{} is {wrong}", quoted(&text)))
    }
}

impl From<TypedColour> for String {
    fn from(colour: TypedColour) -> Self {
        written(colour.0)
    }
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
            let read = TypedColour::read(text).unwrap();
            assert_eq!((read.0, TypedColour::read(&String::from(read))), (colour, Ok(read)), "{text}");
        }
    }

    #[test]
    fn mistakes_say_what_is_near() {
        let (digits, opaque) = ("three or six digits", "an opaque colour");
        for (text, expected) in [
            ("", "a name of CSS"),
            ("steelblu", "did you mean \\\"steelblue\\\"?"),
            ("fff", "write \\\"#fff\\\""),
            ("decade", "write \\\"#decade\\\""),
            ("#12", digits),
            ("#ggg", digits),
            ("rgb(1, 2)", digits),
            ("#ffffff80", opaque),
            ("transparent", opaque),
            ("rgb(0 0 0 / 50%)", opaque),
            ("é#", "a name of CSS"),
        ] {
            let told = format!("{:?}", TypedColour::read(text).unwrap_err());
            assert!(told.contains(expected), "{text}: {told}");
        }
    }
}
