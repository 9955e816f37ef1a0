//! The words near the beginning of each file for other programs that tell whose it is.

use crate::output::OutputError;
use crate::scene::Scene;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The mark stands within so many bytes from the beginning of a file.
const WITHIN: u64 = 1024;
const BEGIN: &str = "localshape ";
const SCENE: &str = ", scene ";
/// The hexadecimal digits of a digest.
const DIGITS: usize = 64;

/// The mark of a file of a scene: of a frame, or of its course.
pub(super) fn mark(scene: &Scene, frame: Option<u64>) -> String {
    let frame = frame.map_or(String::new(), |frame| format!(", frame {frame};"));
    format!("{BEGIN}{}{SCENE}{}{frame}", env!("CARGO_PKG_VERSION"), scene.digest)
}

/// The digest of the scene to which a file belongs; `None` if this program has not written it.
///
/// # Errors
/// If it cannot be read.
pub(in crate::output) fn scene_of(path: &Path) -> Result<Option<String>, OutputError> {
    let head = head(path)?;
    let digest = head.find(BEGIN).and_then(|at| {
        let rest = &head[at + BEGIN.len()..];
        let digest = rest.get(rest.find(SCENE)? + SCENE.len()..)?.get(..DIGITS)?;
        digest.bytes().all(|digit| digit.is_ascii_hexdigit()).then(|| digest.to_owned())
    });
    Ok(digest)
}

/// The beginning of a file.
fn head(path: &Path) -> Result<String, OutputError> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(WITHIN).read_to_end(&mut bytes));
    match read {
        // A link to a file that is gone.
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        read => read.map(|_| String::from_utf8_lossy(&bytes).into_owned()).map_err(OutputError::reading(path)),
    }
}
