//! Results beside their goldens, for the plug-in of pytest.

use crate::made::Origin;
use crate::result::Result;
use localshape::internals::{Listed, Outcome, Simulated, TestDevice, Told, index, write_whole};
use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The device of all tests of this process.
static DEVICE: Mutex<Option<TestDevice>> = Mutex::new(None);

/// Compares a result with the golden in a folder, which is made or renewed on request. Returns the verdict, whether it passes, all
/// findings, and what was accepted. The page, if it has a path, is written.
#[pyfunction]
pub(crate) fn _compare(
    py: Python<'_>,
    result: &Bound<'_, Result>,
    golden: PathBuf,
    told: (String, String),
    accepts: bool,
    page: Option<PathBuf>,
) -> PyResult<(&'static str, bool, String, Vec<String>)> {
    crate::picture::prepare_driver(py)?;
    let result = result.get();
    result.check_compared()?;
    let (title, command) = told;
    py.detach(|| {
        let outcome = outcome(result, &golden, Told { title, command }, accepts).map_err(PyRuntimeError::new_err)?;
        if let Some(page) = page {
            write(&page, &outcome.page())?;
        }
        let accepted = if accepts { outcome.accept().map_err(PyRuntimeError::new_err)? } else { Vec::new() };
        Ok((outcome.verdict(), outcome.passes(), outcome.words(), accepted))
    })
}

fn outcome(result: &Result, golden: &Path, told: Told, accepts: bool) -> std::result::Result<Outcome, String> {
    let mut device = DEVICE.lock().unwrap_or_else(PoisonError::into_inner);
    let keys = match &*result.made.origin {
        Origin::Keys(keys, _) => Some(keys.without_folder(result.made.origin.folder())),
        Origin::File(_) => None,
    };
    let frame = |number| Python::attach(|py| result.whole(py, number as usize)).map_err(|error| error.to_string());
    let Result { made, history: course, .. } = result;
    let simulated =
        Simulated { scene: &made.scene, keys: keys.as_ref(), settings: &made.settings, course, frame: &frame };
    simulated.compare(golden, told, device.get_or_insert_default(), accepts)
}

/// Writes the page of all comparisons: title, address of the page, verdict, whether it passes, and findings of each.
#[pyfunction]
pub(crate) fn _index(page: PathBuf, all: Vec<(String, String, String, bool, String)>) -> PyResult<()> {
    let listed = |(title, page, verdict, passes, words)| Listed { title, page, passes, verdict, words };
    write(&page, &index(&all.into_iter().map(listed).collect::<Vec<_>>()))
}

fn write(page: &Path, text: &str) -> PyResult<()> {
    write_whole(page, text.as_bytes()).map_err(|error| PyOSError::new_err(error.to_string()))
}
