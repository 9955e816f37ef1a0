//! The errors of the library as exceptions.

use localshape::SceneError;
use localshape::scene::Mistake;
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::error::Error;

/// The exception for a scene that cannot be read: `SceneError` with its mistakes, or that of Python for files. A folder is left out.
pub(crate) fn of_scene(py: Python<'_>, error: &SceneError, folder: &str) -> PyErr {
    match error {
        SceneError::Missing { .. } => PyFileNotFoundError::new_err(error.to_string()),
        SceneError::Unreadable { .. } => PyOSError::new_err(with_causes(error)),
        _ => scene_error(py, &error.to_string().replace(folder, ""), error.mistakes(), folder),
    }
}

/// A `SceneError` about a value at a place of the keys.
pub(crate) fn at(py: Python<'_>, place: &str, message: String, help: Option<&str>) -> PyErr {
    let mistake = Mistake {
        line: 0,
        column: 0,
        place: place.to_owned(),
        message,
        help: help.map(str::to_owned),
        excerpt: String::new(),
        marked: 0..0,
    };
    let words = match &mistake.help {
        Some(help) => format!("{}; {help}", mistake.message),
        None => mistake.message.clone(),
    };
    scene_error(py, &words, &[mistake], "")
}

/// `localshape.SceneError`, which is made in Python.
fn scene_error(py: Python<'_>, words: &str, mistakes: &[Mistake], folder: &str) -> PyErr {
    let made = || {
        let mistakes = mistakes.iter().map(|mistake| as_dict(py, mistake, folder)).collect::<PyResult<Vec<_>>>()?;
        py.import("localshape._errors")?.getattr("SceneError")?.call1((words, mistakes))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// A mistake or warning as a dict: the arguments of `localshape.Mistake`. A folder is left out.
pub(crate) fn as_dict<'py>(py: Python<'py>, mistake: &Mistake, folder: &str) -> PyResult<Bound<'py, PyDict>> {
    let Mistake { line, column, place, message, help, .. } = mistake;
    let dict = PyDict::new(py);
    dict.set_item("place", place)?;
    dict.set_item("message", message.replace(folder, ""))?;
    dict.set_item("remedy", help.as_ref().map(|help| help.replace(folder, "")))?;
    dict.set_item("line", (*line > 0).then_some(line))?;
    dict.set_item("column", (*line > 0).then_some(column))?;
    Ok(dict)
}

/// `localshape.DeviceError`: there is no graphics device, or it failed.
#[cfg(feature = "render")]
pub(crate) fn of_device(py: Python<'_>, error: &dyn Error) -> PyErr {
    let words = with_causes(error);
    let made = || py.import("localshape._errors")?.getattr("DeviceError")?.call1((words,));
    made().map_or_else(|error| error, PyErr::from_value)
}

/// An error that the input does not explain.
pub(crate) fn unexpected(error: &dyn Error) -> PyErr {
    PyRuntimeError::new_err(with_causes(error))
}

/// An error with what caused it.
fn with_causes(error: &dyn Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words.push_str(&format!(": {error}"));
        cause = error.source();
    }
    words
}
