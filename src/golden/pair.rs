//! Two pictures of one name, read and compared.

use super::Compared;
use super::picture::{PictureError, Pixels};
use super::side::Source;
use super::verdict::Verdict;
use crate::output::Tags;
use std::borrow::Cow;
use std::error::Error;
use std::sync::Arc;

/// A pair of pictures, compared.
pub(super) struct Pair {
    /// The metadata of both.
    pub(super) labels: [Option<Tags>; 2],
    pub(super) compared: Compared,
}

impl Pair {
    /// Reads and compares the pictures of a name.
    pub(super) fn read(name: String, sources: [Option<Source>; 2]) -> Self {
        let [expected, actual] = sources.each_ref().map(|source| source.as_ref().map(Source::bytes));
        let decoded = |file: Result<Cow<'_, [u8]>, PictureError>| Pixels::from_bytes(&file?).map(Arc::new);
        // Most pairs that pass are equal files, which are decoded once.
        let are_equal = matches!((&expected, &actual), (Some(Ok(one)), Some(Ok(other))) if one == other);
        let expected = expected.map(decoded);
        let actual = match &expected {
            Some(Ok(pixels)) if are_equal => Some(Ok(Arc::clone(pixels))),
            _ => actual.map(decoded),
        };
        let read = [expected, actual];
        // Damage is reported even if there is only one picture.
        let message = |at: usize| {
            let error = read[at].as_ref()?.as_ref().err()?;
            Some(message(sources[at].as_ref()?, ["expected", "actual"][at], error))
        };
        let messages: Vec<String> = [0, 1].into_iter().filter_map(message).collect();
        let pixels = read.map(|side| side.and_then(Result::ok));
        let verdict = match &pixels {
            _ if !messages.is_empty() => Verdict::Unreadable { message: messages.join("; ") },
            [Some(expected), Some(actual)] => Verdict::new(expected, actual),
            [None, Some(_)] => Verdict::Extra,
            [_, None] => Verdict::Missing,
        };
        let labels = pixels.map(|pixels| pixels?.label.clone());
        let frame = labels.iter().flatten().find_map(Tags::frame);
        Self { labels, compared: Compared { name, frame, verdict } }
    }
}

fn message(source: &Source, side: &str, error: &PictureError) -> String {
    let place = match source {
        Source::File(path) => path.display().to_string(),
        Source::Memory(_) => format!("the {side} picture"),
    };
    error.source().map_or_else(|| format!("{place}: {error}"), |cause| format!("{place}: {error}: {cause}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{Compression, encode};

    #[test]
    fn damage_is_reported_for_both_pictures() {
        let good = encode([29, 50], &[9; 29 * 50 * 3], &[], Compression::High);
        let memory = |length: usize| Some(Source::Memory(good[..length].to_vec()));
        for (lengths, words) in [
            ([60, 70], &["the expected picture: ", "; the actual picture: "][..]),
            ([60, 60], &["the expected picture: ", "; the actual picture: "]),
            ([good.len(), good.len() - 1], &["the actual picture: "]),
        ] {
            let verdict = Pair::read("two.png".to_owned(), lengths.map(memory)).compared.verdict;
            let Verdict::Unreadable { message } = &verdict else { panic!("{verdict}") };
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        }
    }
}
