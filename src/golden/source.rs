//! Pictures of one side: files, or pictures drawn for a comparison.

use super::error::ComparisonError;
use super::picture::{PictureError, file};
use crate::output::OutputError;
use crate::reading::beside::entries;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A picture that is yet to be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    File(PathBuf),
    /// The bytes of a PNG file that was drawn.
    #[cfg_attr(not(feature = "render"), allow(dead_code, reason = "nothing is drawn"))]
    Memory(Vec<u8>),
}

impl Source {
    /// The bytes of the file.
    pub(super) fn bytes(&self) -> Result<Cow<'_, [u8]>, PictureError> {
        match self {
            Self::File(path) => file(path).map(Cow::Owned),
            Self::Memory(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// The expected picture of a name and the actual one; `None` where there is none.
pub(super) type Pair = [Option<Source>; 2];

/// The pictures of a side by name.
pub(super) type Pictures = BTreeMap<String, Source>;

/// The PNG files in a folder.
pub(super) fn pictures_in(folder: &Path) -> Result<Pictures, ComparisonError> {
    let mut pictures = Pictures::new();
    for path in entries(folder).map_err(OutputError::reading(folder))? {
        let Some(name) = path.file_name() else { continue };
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
            continue;
        }
        let Some(name) = name.to_str().map(str::to_owned) else {
            let source = std::io::Error::new(ErrorKind::InvalidData, "its name is not UTF-8; rename it");
            return Err(OutputError::Read { path, source }.into());
        };
        if !name.starts_with('.') {
            pictures.insert(name, Source::File(path));
        }
    }
    Ok(pictures)
}
