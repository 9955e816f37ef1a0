//! Animation files: messages, and the rule for replacing files.

use super::failure::{Failure, Status, with_causes};
use crate::animation::{AnimationError, Written};
use crate::golden::PictureError;
use crate::output::{folder_of, is_folder};
use indicatif::DecimalBytes;
use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The beginning of the comment by which files of this program are recognised.
pub(super) const MARK: &str = "made by localshape ";

/// The result, on one line.
pub(super) fn summary(path: &Path, frames: usize, written: &Written) -> String {
    let bytes = path.metadata().map_or(0, |found| found.len());
    let (path, Written { pictures, duration, size: [width, height] }) = (path.display(), *written);
    let made = if pictures == 1 { "1 picture".to_owned() } else { format!("{pictures} pictures") };
    let of = if pictures == frames { String::new() } else { format!(" of {frames} frames") };
    format!("{path}  {width}×{height}, {made}{of} in {duration:.2} s, {}\n", DecimalBytes(bytes))
}

/// The comment of an animation. It is the same for a command that goes on after an interruption.
pub(super) fn comment(words: &[OsString], scene: &str) -> String {
    let command: Vec<_> = words.iter().map(|word| word.to_string_lossy()).filter(|word| word != "--resume").collect();
    let version = env!("CARGO_PKG_VERSION");
    let scene = if scene.is_empty() { String::new() } else { format!("scene {scene}; ") };
    format!("{MARK}{version}; {scene}command: {}", command.join(" "))
}

/// Refuses to replace files that this program did not make, and paths below a file.
pub(super) fn replaceable(path: &Path) -> Result<(), Failure> {
    /// Comments stand near the beginning; in films they follow the tables of all pictures.
    const BEGINNING: u64 = 1 << 20;
    is_folder(folder_of(path))?;
    let Ok(found) = path.metadata() else { return Ok(()) };
    let name = path.display();
    if !found.is_file() {
        bail!("{name} is not a file; choose another name with -o");
    }
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut bytes));
    read.map_err(|error| Failure::files(format!("cannot read {name}: {error}")))?;
    if is_ours(&bytes) {
        return Ok(());
    }
    bail!("{name} exists and was not made by this command; choose another name with -o, or replace it with --overwrite")
}

/// Whether this program made a file with this beginning: its format has the comment in the place where our mark stands.
fn is_ours(beginning: &[u8]) -> bool {
    /// For each kind: the position and the value of the first fixed bytes of its files, and the bytes before a comment.
    const KINDS: [(usize, &[u8], &[u8]); 6] = [
        (0, b"GIF89a", b"\x21\xfe"),
        (0, b"\x89PNG\r\n\x1a\n", b"iTXtComment\0"),
        (0, b"<svg ", b"<metadata>\n"),
        (0, b"%PDF-", b"/Producer ("),
        (4, b"ftyp", b"data\0\0\0\x01"),
        (0, b"\x1a\x45\xdf\xa3", b"\x44\x87"),
    ];
    /// The greatest length of the comment's length and language, which stand between these bytes and the comment
    /// (bytes).
    const BETWEEN: usize = 8;
    let after = |at: usize| beginning.get(at..).unwrap_or_default();
    KINDS.iter().any(|&(at, magic, before)| {
        let is_mark = |at: &usize| after(at + MARK.len()).first().is_some_and(u8::is_ascii_digit);
        let is_comment = |at: usize| {
            let head = &beginning[at.saturating_sub(before.len() + BETWEEN)..at];
            head.windows(before.len()).any(|part| part == before)
        };
        let places = beginning.windows(MARK.len()).enumerate().filter(|(_, part)| *part == MARK.as_bytes());
        after(at).starts_with(magic) && places.map(|(at, _)| at).filter(is_mark).any(is_comment)
    })
}

impl From<AnimationError> for Failure {
    fn from(error: AnimationError) -> Self {
        match error {
            AnimationError::File(error) => error.into(),
            AnimationError::Picture { source: PictureError::Read(_), .. }
            | AnimationError::Ffmpeg { .. }
            | AnimationError::Full(_)
            | AnimationError::Out(_) => Self::files(with_causes(&error)),
            AnimationError::Stopped => Self::silent(Status::Interrupted),
            error => Self::usage(with_causes(&error)),
        }
    }
}
