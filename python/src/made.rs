//! What scenes are made of: files or keys, and their settings.

use crate::error;
use localshape::scene::{Limits, SceneKeys, Setting};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene as it is set.
#[derive(Clone)]
pub(crate) struct Made {
    pub(crate) origin: Arc<Origin>,
    pub(crate) settings: Vec<Setting>,
    pub(crate) scene: Arc<localshape::Scene>,
}

/// Where a scene comes from.
pub(crate) enum Origin {
    File(PathBuf),
    /// Keys, and the folder with the files of what they have in memory.
    Keys(Box<SceneKeys>, Held),
}

/// A folder of files, which Python removes with the object that holds it.
pub(crate) struct Held {
    /// Its path with a slash at the end; empty if there is none.
    pub(crate) folder: String,
    pub(crate) _holder: Py<PyAny>,
}

impl Origin {
    /// The scene with some settings. The interpreter goes on meanwhile.
    pub(crate) fn read(&self, py: Python<'_>, settings: &[Setting]) -> PyResult<Arc<localshape::Scene>> {
        let limits = Limits::default();
        let read = py.detach(|| match self {
            Self::File(path) => localshape::Scene::load_with(path, settings, &limits),
            Self::Keys(keys, _) => localshape::Scene::from_keys(keys, settings, &limits),
        });
        read.map(Arc::new).map_err(|error| error::of_scene(py, &error, self.folder()))
    }

    /// The folder that messages leave out before the names of files; empty if there is none.
    pub(crate) fn folder(&self) -> &str {
        match self {
            Self::Keys(_, held) => &held.folder,
            Self::File(_) => "",
        }
    }
}
