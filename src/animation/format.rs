//! File formats.

use crate::reading::beside::ending;
use std::path::Path;

/// A file format, selected by the extension of the file name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Animated PNG: lossless.
    Apng,
    /// GIF with one palette of 255 colours.
    Gif,
    /// MP4 with H.264, encoded by `ffmpeg`.
    Mp4,
    /// WebM with VP9, encoded by `ffmpeg`.
    WebM,
}

impl Format {
    /// All extensions with their formats.
    const ENDINGS: [(&str, Self); 4] =
        [("gif", Self::Gif), ("apng", Self::Apng), ("mp4", Self::Mp4), ("webm", Self::WebM)];

    /// The format of a file name.
    ///
    /// # Errors
    /// If the extension is unknown, with the known ones.
    pub fn of(path: &Path) -> Result<Self, String> {
        let ending = ending(path);
        let known = Self::ENDINGS.iter().find(|(known, _)| *known == ending);
        known.map(|(_, format)| *format).ok_or_else(|| {
            let found = if ending.is_empty() { "no ending".to_owned() } else { format!("the ending .{ending}") };
            format!(
                "{} has {found}; the ending says what to make: .gif, .apng, .mp4 or .webm (both need ffmpeg); moments side \
                 by side are a figure (localshape figure)",
                path.display()
            )
        })
    }
}

#[cfg(test)]
#[path = "../../tests/inside/format.rs"]
mod tests;
