//! Why no comparison can be made.

use std::io;
use std::path::PathBuf;

/// Why no comparison can be made.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ComparisonError {
    #[error("{} does not exist; expected a picture or a folder of pictures", path.display())]
    Absent { path: PathBuf },
    #[error("cannot read {}", path.display())]
    Read { path: PathBuf, source: io::Error },
    /// The sides cannot be compared with each other.
    #[error("{0}")]
    Wrong(String),
}
