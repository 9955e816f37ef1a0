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
    #[error("{} is a folder and {} is a file; expected two pictures or two folders of pictures", folder.display(), file.display())]
    Unlike { folder: PathBuf, file: PathBuf },
    #[error("neither {} nor {} has a PNG picture", expected.display(), actual.display())]
    Empty { expected: PathBuf, actual: PathBuf },
    #[error("{} is a golden, which is compared with its scene: localshape compare {} SCENE", path.display(), path.display())]
    Golden { path: PathBuf },
    #[cfg(feature = "render")]
    #[error("{} {what}", path.display())]
    NoGolden { path: PathBuf, what: String },
}
