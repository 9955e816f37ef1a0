//! Compares pictures, and says whether the simulation or its drawing changed.
//!
//! Frames have digests of the states that they show. A golden, a folder with a few small pictures and a record of its scene,
//! also has rounded positions of nodes. So states are compared first, and then pixels.
//!
//! `Suite` tests scenes against goldens in `cargo test` (with the feature `render`).

mod comparison;
#[cfg(feature = "render")]
pub(crate) mod draw;
mod folder;
mod keys;
pub(crate) mod page;
mod picture;
mod record;
mod states;
#[cfg(feature = "render")]
mod suite;
mod tolerance;
mod verdict;

pub(crate) use comparison::Comparison;
pub(crate) use folder::{AcceptError, Drawn, Golden};
pub(crate) use picture::PictureError;
#[doc(hidden)]
pub use picture::Pixels;
pub(crate) use record::is_record;
#[cfg(feature = "render")]
pub use suite::Suite;

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
    #[error("{} {what}", path.display())]
    NoGolden { path: PathBuf, what: String },
}
