//! Why no comparison can be made, or its result cannot be accepted.

use crate::output::OutputError;
use std::path::PathBuf;

/// Why no comparison can be made, or its result cannot be accepted.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ComparisonError {
    #[error("{} does not exist; expected a picture or a folder of pictures", path.display())]
    Absent { path: PathBuf },
    #[error(transparent)]
    File(#[from] OutputError),
    #[cfg(feature = "render")]
    #[error("nothing was accepted: without a graphics adapter there are no pictures")]
    Undrawn,
    /// The sides cannot be compared with each other.
    #[error("{0}")]
    Wrong(String),
}
