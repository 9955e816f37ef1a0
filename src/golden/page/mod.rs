//! A comparison as one HTML file, which works offline: every picture beside the expected one, the worst first. The file
//! `page.html` has its text, style and script. The findings are plain HTML, which can be read without scripts.

mod index;
mod template;

pub use index::{Listed, index};

use super::comparison::Comparison;
use super::picture::Pixels;
use super::tolerance::{FAINT, STRONG, differences};
use super::verdict::Compared;
use crate::output::{Compression, encode};
use crate::reading::words::escaped;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use rayon::prelude::*;
use std::cmp::Reverse;
use template::filled_page;

const TEMPLATE: &str = include_str!("page.html");
/// The most pictures on a page; further ones are only listed.
const MOST_SHOWN: usize = 24;
/// The colours of pixels that differ by more than [`STRONG`], by more than [`FAINT`], and by less.
const COLOURS: [[u8; 3]; 3] = [[213, 40, 0], [230, 159, 0], [150, 196, 232]];

/// The contents of a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The name of the scene or folder.
    pub title: String,
    /// Whether everything is as expected.
    pub passes: bool,
    /// The overall verdict.
    pub verdict: String,
    /// The findings: the run that moved first, its node and distance; the keys that changed.
    pub findings: Vec<String>,
    /// The command that accepts the actual pictures; `None` if there is nothing to accept.
    pub accept: Option<String>,
    /// The pictures, the worst first.
    pub pictures: Vec<PicturePair>,
    /// Pictures for which there is no room: names with verdicts.
    pub others: Vec<String>,
}

/// An actual picture and the expected one.
#[derive(Clone, Debug, PartialEq)]
pub struct PicturePair {
    /// Its file name.
    pub name: String,
    /// The verdict as a sentence.
    pub words: String,
    /// Whether nothing is wrong with it.
    pub passes: bool,
    /// PNG files: expected, difference, actual; `None` if there is none.
    pub files: [Option<Vec<u8>>; 3],
}

impl Comparison {
    /// The contents of its page.
    pub(crate) fn page(&self) -> Page {
        let how_bad = |picture: &Compared| {
            let [faint, strong] = picture.distance.map_or([0; 2], |distance| distance.differing);
            (picture.verdict, strong, faint)
        };
        let mut order: Vec<&Compared> = self.pictures.iter().collect();
        order.sort_by_key(|picture| Reverse(how_bad(picture)));
        let (shown, others) = order.split_at(order.len().min(MOST_SHOWN));
        let words = |picture: &&Compared| format!("{}: {picture}", picture.name);
        let mut findings = self.findings();
        if !self.pictures.is_empty() {
            findings.push(self.summary());
        }
        Page {
            title: self.title.clone(),
            passes: self.passes(),
            verdict: self.verdict().words().to_owned(),
            findings,
            accept: self.command_to_accept().map(str::to_owned),
            pictures: shown.par_iter().map(|picture| pair(picture)).collect(),
            others: others.iter().map(words).collect(),
        }
    }
}

fn pair(picture: &Compared) -> PicturePair {
    // Files that are not pictures are not shown.
    let read = picture.sources.each_ref().map(|source| {
        let bytes = source.as_ref()?.bytes().ok()?;
        Some((Pixels::from_bytes(&bytes).ok()?, bytes))
    });
    let difference = match &read {
        [Some((expected, _)), Some((actual, _))] => difference(expected, actual),
        _ => None,
    };
    let [expected, actual] = read.map(|read| read.map(|(_, bytes)| bytes.into_owned()));
    let (name, words, passes) = (picture.name.clone(), picture.to_string(), picture.verdict.passes());
    PicturePair { name, words, passes, files: [expected, difference, actual] }
}

/// The differences of two pictures over a faint copy of the expected one, as a PNG file; `None` if their sizes differ.
fn difference(expected: &Pixels, actual: &Pixels) -> Option<Vec<u8>> {
    let faint = |pixel: &[u8]| {
        let [red, green, blue] = [0, 1, 2].map(|at| u32::from(pixel[at]));
        let grey = (red * 54 + green * 183 + blue * 19) / 256;
        [(255 - (255 - grey) / 5) as u8; 3]
    };
    let mut bytes: Vec<u8> = expected.bytes.chunks_exact(3).flat_map(faint).collect();
    differences(expected, actual, |at, difference| {
        let colour = COLOURS[usize::from(difference <= STRONG) + usize::from(difference <= FAINT)];
        bytes[3 * at..3 * at + 3].copy_from_slice(&colour);
    })?;
    Some(encode(expected.size, &bytes, &[], Compression::Small))
}

impl Page {
    /// The whole HTML document.
    pub fn html(&self) -> String {
        let lines =
            |lines: &[String]| lines.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect::<String>();
        let accept = self
            .accept
            .iter()
            .map(|command| format!("<p>If this is what you meant, accept it: <code>{}</code></p>", escaped(command)));
        let others = (!self.others.is_empty()).then(|| {
            format!(
                "<details><summary>{} more</summary><ul>\n{}</ul></details>",
                self.others.len(),
                lines(&self.others)
            )
        });
        filled_page(
            TEMPLATE,
            &["style", "script"],
            &[
                ("outcome", if self.passes { "passed" } else { "failed" }),
                ("title", &escaped(&self.title)),
                ("verdict", &escaped(&self.verdict)),
                ("findings", &lines(&self.findings)),
                ("accept", &accept.collect::<String>()),
                ("pictures", &self.pictures.iter().map(PicturePair::section).collect::<String>()),
                ("others", &others.unwrap_or_default()),
            ],
        )
    }
}

impl PicturePair {
    fn section(&self) -> String {
        let (name, sign) = (escaped(&self.name), if self.passes { "✓" } else { "✕" });
        let figure = |(file, title): (&Option<Vec<u8>>, &str)| match file {
            Some(bytes) => {
                let data = BASE64_STANDARD.encode(bytes);
                format!(
                    "<figure><figcaption>{title}</figcaption><img alt=\"{title}: {name}\" \
                     src=\"data:image/png;base64,{data}\"></figure>\n"
                )
            }
            None => format!("<figure><figcaption>{title}</figcaption><p>none</p></figure>\n"),
        };
        let figures: String = self.files.iter().zip(["Expected", "Difference", "Actual"]).map(figure).collect();
        let words = escaped(&self.words);
        format!("<section>\n<h2>{sign} {name}</h2>\n<p>{words}</p>\n<div class=\"row\">\n{figures}</div>\n</section>\n")
    }
}
