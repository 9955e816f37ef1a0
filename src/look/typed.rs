//! Colours and fonts as typed.

use crate::colour::{Colour, UnknownColour, names, parse, written};
use crate::reading::words::{nearest, quoted};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The expected colours, for messages.
const EXPECTED: &str = "; expected digits such as \"#93a5ba\" or a name of CSS such as \"steelblue\"";

/// An opaque colour. It is written back as digits, so that a name and its digits are equal.
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
        parse(text).map(Self).map_err(|why| match why {
            UnknownColour::Unknown => {
                let known: Vec<_> = names().collect();
                let near = nearest(text.trim(), &known).map(|name| format!("did you mean {}?", quoted(name)));
                (EXPECTED.to_owned(), near)
            }
            UnknownColour::WithoutHash => (EXPECTED.to_owned(), Some(format!("write \"#{}\"", text.trim()))),
            UnknownColour::Digits => ("; expected three or six digits, such as \"#93a5ba\"".to_owned(), None),
            UnknownColour::Transparent => (", which is transparent; expected an opaque colour".to_owned(), None),
        })
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
    pub(crate) regular: String,
    /// The font of names and counts. Default: the `regular` font.
    #[schemars(length(min = 1))]
    pub(crate) semi_bold: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_say_what_is_near() {
        let told = |text: &str| TypedColour::read(text).err().map(|(message, help)| format!("{message} {help:?}"));
        assert_eq!(told("#abc"), None);
        assert!(told("steelblu").unwrap().contains("did you mean \\\"steelblue\\\"?"));
        assert!(told("93a5ba").unwrap().contains("write \\\"#93a5ba\\\""));
        assert!(told("#93a5b").unwrap().contains("three or six digits"));
        assert!(told("transparent").unwrap().contains("an opaque colour"));
    }

    #[test]
    fn a_name_and_its_digits_are_written_alike() {
        for text in ["steelblue", "#4682b4", "rgb(70, 130, 180)"] {
            assert_eq!(serde_json::to_string(&TypedColour::read(text).unwrap()).unwrap(), "\"#4682b4\"");
        }
    }
}
