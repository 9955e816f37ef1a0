//! A comparison as one HTML file, which works offline.
//!
//! The page is made from `page.html`, `page.css`, `strip.js` (charts) and `page.js` (viewer and list). Its data and pictures are embedded as JSON; the
//! overall verdict is plain HTML, so that it can be read without scripts.

use super::states::RunDifference;
use crate::colour::written;
use crate::look::{LineStyle, Palette, Theme};
use crate::reading::words::escaped;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::{Serialize, Serializer};
use sha2::{Digest, Sha256};
use std::fmt::Write;

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(include_str!("strip.js"), include_str!("page.js"));

/// So many runs have lines of their own; those of more begin again.
const MOST_RUNS: usize = 64;

/// The colours of a picture of differences: along silhouettes, elsewhere, and for differences that are not visible.
pub(super) const SILHOUETTE: [u8; 3] = [230, 159, 0];
pub(super) const INTERIOR: [u8; 3] = [213, 60, 0];
pub(super) const FAINT: [u8; 3] = [150, 196, 232];

/// The contents of a page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The name of the scene or folder.
    pub title: String,
    /// The path of the expected pictures, as typed.
    pub expected: String,
    /// The path of the actual pictures, as typed.
    pub actual: String,
    /// Whether everything is as expected.
    pub passes: bool,
    /// The overall verdict: "state moved".
    pub verdict: String,
    /// Further sentences: which run moved first, at which node and how far.
    pub findings: Vec<String>,
    /// The command that accepts the actual pictures; `None` if there is nothing to accept.
    pub accept: Option<String>,
    /// The graphics adapters that drew the expected and the actual pictures, if recorded.
    pub drawn_by: [Option<String>; 2],
    /// The runs whose states were compared; there may be none.
    pub runs: Vec<RunDifference>,
    /// The pictures in the order of the sequence.
    pub pictures: Vec<PicturePair>,
    /// The index of the picture that is shown first.
    pub first: usize,
}

/// An actual picture and the expected one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PicturePair {
    /// Its file's name, or its path in the folder.
    pub name: String,
    /// The frame that it shows, if recorded.
    pub frame: Option<u64>,
    /// That frame's time (s).
    pub time: Option<f64>,
    /// One of: `identical`; `same state, pixels within tolerance`; `same state, drawn differently`; `state moved`;
    /// `missing`; `extra`; `no state recorded`; `unreadable`.
    pub verdict: String,
    /// The verdict as a sentence, with the distance to the limit.
    pub words: String,
    /// Whether nothing is wrong with it.
    pub passes: bool,
    /// The number of differing pixels, by the count nearest to its limit; `None` if they could not be compared.
    pub visible: Option<u64>,
    /// How many may differ.
    pub allowed: Option<u64>,
    /// Width and height (px).
    pub size: Option<[u32; 2]>,
    /// The expected picture as a PNG file; `None` if it does not exist or is not embedded.
    #[serde(serialize_with = "address")]
    pub expected: Option<Vec<u8>>,
    /// The actual picture as a PNG file; `None` if it does not exist or is not embedded.
    #[serde(serialize_with = "address")]
    pub actual: Option<Vec<u8>>,
    /// A picture of their differences as a PNG file; `None` if there is none or it is not embedded.
    #[serde(serialize_with = "address")]
    pub difference: Option<Vec<u8>>,
    /// The actual state, coloured by the distance of each node from its expected place, as a PNG file; `None` if it has not moved,
    /// or where the expected nodes are not known.
    #[serde(serialize_with = "address")]
    pub distances: Option<Vec<u8>>,
}

/// A PNG file as a data URL.
fn address<S: Serializer>(file: &Option<Vec<u8>>, serializer: S) -> Result<S::Ok, S::Error> {
    let address = file.as_ref().map(|bytes| {
        let mut address = String::from("data:image/png;base64,");
        BASE64_STANDARD.encode_string(bytes, &mut address);
        address
    });
    address.serialize(serializer)
}

impl Report {
    /// The whole HTML document.
    pub fn page(&self) -> String {
        // Browsers hash the text between the tags with LF line ends.
        let [style, script] = [&run_styles(), SCRIPT].map(|text| text.replace("\r\n", "\n"));
        // Only these scripts and styles are executed, whatever the names of files and runs contain.
        let policy = format!(
            "default-src 'none'; img-src data:; style-src '{}'; script-src '{}'; base-uri 'none'; form-action 'none'",
            hash(&style),
            hash(&script)
        );
        let sign = if self.passes { "✓" } else { "✕" };
        filled(
            PAGE,
            &[
                ("policy", &policy),
                ("heading", &escaped(&format!("{sign} {}: {}", self.title, self.verdict))),
                ("style", &style),
                ("outcome", if self.passes { "passes" } else { "fails" }),
                ("sign", if self.passes { "#passed" } else { "#failed" }),
                ("sign in words", if self.passes { "Passed:" } else { "Failed:" }),
                ("title", &escaped(&self.title)),
                ("verdict", &escaped(&self.verdict)),
                (
                    "findings",
                    &self.findings.iter().map(|text| format!("<p>{}</p>\n", with_numbers(text))).collect::<String>(),
                ),
                ("sides", &self.sides()),
                ("accept", &self.accept_box()),
                ("difference key", &difference_key()),
                ("pictures", &self.list()),
                ("data", &inert(&serde_json::to_string(self).expect("numbers and words are JSON"))),
                ("script", &script),
            ],
        )
    }

    /// The paths of both sides, and the adapters that drew them.
    fn sides(&self) -> String {
        let mut html = String::new();
        let paths = [("Expected", &self.expected), ("Actual", &self.actual)];
        for ((side, path), adapter) in paths.into_iter().zip(&self.drawn_by) {
            let adapter = adapter.as_ref().map_or_else(|| "not recorded".into(), |adapter| escaped(adapter));
            let path = escaped(path);
            let _ = writeln!(html, "<dt>{side}</dt><dd><code>{path}</code> <span>drawn by: {adapter}</span></dd>");
        }
        html
    }

    /// The command that accepts the actual side, if there is one.
    fn accept_box(&self) -> String {
        self.accept.as_ref().map_or_else(String::new, |command| {
            format!(
                "<div class=\"accept\"><p id=\"accept-label\">If this is what you meant, accept it:</p>\n\
                 <div class=\"command\"><code id=\"command\" tabindex=\"0\" aria-labelledby=\"accept-label\">{}</code>\
                 <button type=\"button\" id=\"copy\" hidden>Copy</button></div></div>",
                escaped(command)
            )
        })
    }

    /// The pictures with their verdicts, for readers without scripts.
    fn list(&self) -> String {
        let mut html = String::new();
        for PicturePair { name, words, passes, .. } in &self.pictures {
            let sign = if *passes { "✓" } else { "✕" };
            let _ = writeln!(html, "<li>{sign} <code>{}</code> {}</li>", escaped(name), escaped(words));
        }
        html
    }
}

/// The style of the page, with the colours and the dashes that runs have in pictures.
fn run_styles() -> String {
    let of = |theme| {
        let palette = Palette::of(theme);
        let rule = |run: usize| {
            let LineStyle { colour, dash } = palette.line(run, None);
            let dash: Vec<_> = dash.iter().map(f64::to_string).collect();
            let (place, colour, dash) = (run + 1, written(colour), dash.join(" "));
            let dash = if dash.is_empty() { "none" } else { &dash };
            format!(".run-{place} {{ stroke: {colour}; stroke-dasharray: {dash}; }}\n")
        };
        (0..MOST_RUNS).map(rule).collect::<String>()
    };
    let [light, dark] = [Theme::Light, Theme::Dark].map(of);
    format!("{STYLE}\n{light}@media (prefers-color-scheme: dark) {{\n{dark}}}\n")
}

/// The legend of a picture of differences.
fn difference_key() -> String {
    let all = [
        (SILHOUETTE, "along silhouettes, lines and letters"),
        (INTERIOR, "on smooth ground, or in one picture only"),
        (FAINT, "by 2 of 255 or less"),
    ];
    let swatch = |([red, green, blue], words): ([u8; 3], &str)| {
        // The policy does not allow inline styles.
        format!(
            "<span><svg class=\"square\" aria-hidden=\"true\"><rect width=\"100%\" height=\"100%\" \
             fill=\"rgb({red} {green} {blue})\" /></svg> {words}</span>\n"
        )
    };
    all.map(swatch).concat()
}

/// A template with its `{{names}}` replaced. Inserted text is not searched for names.
fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut page = String::with_capacity(template.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut left = template;
    while let Some((before, (name, after))) =
        left.split_once("{{").and_then(|(before, rest)| Some((before, rest.split_once("}}")?)))
    {
        page.push_str(before);
        let part = parts.iter().find(|(known, _)| *known == name);
        page.push_str(part.unwrap_or_else(|| panic!("the page asks for {name}")).1);
        left = after;
    }
    page + left
}

/// Text as HTML with an element around each number and its unit: browsers break lines before units, and even in `3.1e-4`.
fn with_numbers(text: &str) -> String {
    let is_unit = |word: &&str| ["%", "m", "s"].contains(&word.trim_end_matches([',', ';', ':', '.', ')']));
    let mut words = text.split(' ').peekable();
    let mut parts = Vec::new();
    while let Some(word) = words.next() {
        let is_number = word.trim_start_matches(['(', '−']).starts_with(|first: char| first.is_ascii_digit());
        parts.push(match words.next_if(|next| is_number && is_unit(next)) {
            Some(unit) => format!("<span class=\"number\">{} {}</span>", escaped(word), escaped(unit)),
            None if is_number => format!("<span class=\"number\">{}</span>", escaped(word)),
            None => escaped(word),
        });
    }
    parts.join(" ")
}

/// JSON escaped so that it cannot end the element around it. The escaped characters occur in strings only.
fn inert(json: &str) -> String {
    let mut inert = String::with_capacity(json.len() + json.len() / 64);
    let mut left = json;
    while let Some(at) = left.find(['<', '>', '&', '\u{2028}', '\u{2029}']) {
        let letter = left[at..].chars().next().expect("the letter that was found");
        inert.push_str(&left[..at]);
        let _ = write!(inert, "\\u{:04x}", letter as u32);
        left = &left[at + letter.len_utf8()..];
    }
    inert + left
}

/// The hash of an inline style or script for a content security policy.
fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_marked_together_with_their_units() {
        let number = |text: &str| format!("<span class=\"number\">{text}</span>");
        let expected = format!("node {} by {}; < x", number("12"), number("3.1e-4 m"));
        assert_eq!(with_numbers("node 12 by 3.1e-4 m; < x"), expected.replace("m</span>; <", "m;</span> &lt;"));
    }

    #[test]
    fn inserted_text_is_not_searched_for_names() {
        assert_eq!(filled("a {{one}} {{two}} }}", &[("one", "{{two}}"), ("two", "{{")]), "a {{two}} {{ }}");
    }

    #[test]
    fn json_stays_the_same_and_ends_nothing() {
        let hostile = "</script><!-- & \u{2028}\u{2029} \\u003c ü";
        let json = inert(&serde_json::to_string(hostile).expect("JSON"));
        assert!(!json.contains(['<', '>', '&', '\u{2028}', '\u{2029}']), "{json}");
        assert_eq!(serde_json::from_str::<String>(&json).expect("JSON"), hostile);
        assert_eq!(escaped("<a b='\"&'>"), "&lt;a b='&quot;&amp;'&gt;");
    }
}
