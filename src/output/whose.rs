//! The scene to which results belong.

use crate::scene::Scene;
use std::path::PathBuf;

/// The scene to which results belong.
#[derive(Clone, Debug)]
pub(crate) struct Whose {
    /// Digest of the scene's meaning.
    pub digest: String,
    pub title: String,
    /// Its file, as a full path.
    pub file: Option<PathBuf>,
}

impl Whose {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self { digest: scene.digest.clone(), title: scene.title.clone(), file: scene.file.clone() }
    }

    /// Whether results with this digest belong to the scene. A scene with a model made in code has no digest, so no
    /// results belong to it.
    pub(super) fn owns(&self, digest: &str) -> bool {
        !digest.is_empty() && digest == self.digest
    }
}
