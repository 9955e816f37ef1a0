//! Scenes: files or keys, and their settings.

use crate::made::{Held, Made, Origin};
use crate::result::{self, Result, run_of};
use crate::world::World;
use crate::{convert, error};
use localshape::scene::{SceneKeys, Setting};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A scene: bodies, their surroundings, and runs, each with an elastic model.
///
/// `Scene(**keys)` takes the keys of scene files: nested dicts and lists, and NumPy arrays for the lists of bodies, such as `nodes`
/// (N × 2 or N × 3, m) and `elements` (rows of nodes, with -1 at the end of shorter ones). The `mesh` of a body is a path, or a mesh
/// of meshio, trimesh or pyvista; the `states` of a run are a path or a `Recording`. `Scene.load(path)` reads a scene file.
#[pyclass(frozen, module = "localshape")]
pub(crate) struct Scene {
    state: Mutex<Made>,
}

impl Scene {
    fn made(py: Python<'_>, origin: Origin) -> PyResult<Self> {
        let scene = origin.read(py, &[])?;
        Ok(Self { state: Mutex::new(Made { origin: Arc::new(origin), settings: Vec::new(), scene }) })
    }

    fn state(&self) -> MutexGuard<'_, Made> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The scene as it is set now.
    fn now(&self) -> Arc<localshape::Scene> {
        Arc::clone(&self.state().scene)
    }
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let given = py.import("localshape._given")?.call_method1("files", (keys,))?;
        let (keys, folder, holder): (Bound<'_, PyDict>, String, Py<PyAny>) = given.extract()?;
        let (keys, lists) = convert::keys(&keys)?;
        let title = keys.get("title").and_then(|title| title.as_str()).filter(|title| !title.is_empty());
        let name = title.unwrap_or("scene").to_owned();
        let keys = Box::new(SceneKeys::new(name, keys, lists));
        Self::made(py, Origin::Keys(keys, Held { folder, _holder: holder }))
    }

    /// Reads a scene file.
    ///
    /// Raises `SceneError` for mistakes in it, and `OSError` if it cannot be read.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::made(py, Origin::File(path))
    }

    /// Sets the value of a key, such as `run[0].model.stiffness` or `run["Springs"].step`, and checks the scene with it. After a
    /// mistake the scene is what it was.
    fn set(&self, py: Python<'_>, key: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let wrong = |message: &str| error::at(py, key, format!("`{key}`: {message}"), None);
        let value = convert::value(value, key, 0)?;
        let setting: Setting = format!("{key}={value}").parse().map_err(wrong)?;
        if setting.key() != key {
            return Err(wrong("expected a key such as time.duration or run[0].model.stiffness"));
        }
        let (origin, mut settings) = {
            let state = self.state();
            (Arc::clone(&state.origin), state.settings.clone())
        };
        settings.retain(|other| other.key() != key);
        settings.push(setting);
        let scene = origin.read(py, &settings)?;
        let mut state = self.state();
        (state.settings, state.scene) = (settings, scene);
        Ok(())
    }

    /// What the scene contains, as `localshape check --json` says it. Mistakes are found when a scene is made or set.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Made { origin, scene, .. } = self.state().clone();
        let summary = serde_json::to_string(&scene.summary()).map_err(|error| error::unexpected(&error))?;
        py.import("json")?.call_method1("loads", (summary.replace(origin.folder(), ""),))
    }

    /// What is allowed but probably a mistake, in the scene and in its pictures: a list of `Mistake`.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Made { origin, scene, .. } = self.state().clone();
        #[cfg(feature = "render")]
        let doubts = py.detach(|| localshape::internals::doubts(&scene).0);
        #[cfg(not(feature = "render"))]
        let doubts = Vec::new();
        let found = scene.warnings.iter().chain(&doubts).map(|one| error::as_dict(py, one, origin.folder()));
        let found = found.collect::<PyResult<Vec<_>>>()?;
        py.import("localshape._errors")?.call_method1("mistakes", (PyList::new(py, found)?,))
    }

    /// The title.
    #[getter]
    fn title(&self) -> String {
        self.now().title.clone()
    }

    /// Digest of the meaning of the scene: 64 hexadecimal digits. Equal scenes have equal digests.
    #[getter]
    fn digest(&self) -> String {
        self.now().digest.clone()
    }

    /// The names of the runs.
    #[getter]
    fn runs(&self) -> Vec<String> {
        self.now().runs.iter().map(|run| run.name.clone()).collect()
    }

    /// Simulates the scene, or some of its runs by name, to its end.
    ///
    /// Other threads of Python go on meanwhile, and Ctrl-C is heard. A run that diverges is a result: see `RunResult.divergence`.
    #[pyo3(signature = (runs=None))]
    fn simulate(&self, py: Python<'_>, runs: Option<Vec<String>>) -> PyResult<Result> {
        let state = self.state().clone();
        let scene = &state.scene;
        let mut chosen = match runs {
            Some(names) => names.iter().map(|name| run_of(scene, name)).collect::<PyResult<Vec<_>>>()?,
            None => (0..scene.runs.len()).collect(),
        };
        chosen.sort_unstable();
        chosen.dedup();
        result::simulate(py, state, &chosen)
    }

    /// The bodies of a run at their start, to be advanced step by step. The name may be left out if there is one run.
    #[pyo3(signature = (run=None))]
    fn world(&self, run: Option<&str>) -> PyResult<World> {
        let scene = self.now();
        let run = match run {
            Some(name) => run_of(&scene, name)?,
            None if scene.runs.len() == 1 => 0,
            None => return Err(run_of(&scene, "").expect_err("no run has an empty name")),
        };
        Ok(World::new(&scene, run))
    }

    fn __repr__(&self) -> String {
        let scene = self.now();
        let names: Vec<_> = scene.runs.iter().map(|run| run.name.as_str()).collect();
        format!("<localshape.Scene “{}”: {}>", scene.title, names.join(", "))
    }
}
