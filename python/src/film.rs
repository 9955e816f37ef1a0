//! Animations of results, as the program makes them.

use crate::interrupt::in_pool;
use crate::picture::Picture;
use crate::result::Result;
use localshape::internals::{Status, animate, check_animation};
use pyo3::exceptions::{PyIndexError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::ffi::OsString;

/// The number of frames of a result.
#[pyfunction]
pub(crate) fn _count(result: &Bound<'_, Result>) -> usize {
    result.get().count()
}

/// The picture of a frame of a result.
#[pyfunction]
pub(crate) fn _frame(py: Python<'_>, result: &Bound<'_, Result>, number: usize) -> PyResult<Picture> {
    let (result, count) = (result.get(), result.get().count());
    if number >= count {
        return Err(PyIndexError::new_err(format!("there is no frame {number}; the last one is {}", count - 1)));
    }
    result.picture(py, number)
}

/// Makes an animation as the program does whose command has these words. Its file says what was called. Progress is called with completed
/// fractions; without it the words are only checked.
#[pyfunction]
pub(crate) fn _film(py: Python<'_>, words: Vec<OsString>, called: String, progress: Option<Py<PyAny>>) -> PyResult<()> {
    let Some(progress) = progress else {
        return check_animation(&words).map_err(|failure| as_exception(failure.told()));
    };
    let tell = |done: f64| {
        Python::attach(|py| {
            let told = progress.call1(py, (done,));
            told.map_or_else(|error| error.write_unraisable(py, None), drop);
        });
    };
    py.detach(|| {
        in_pool(|go_on| {
            let made = animate(&words, &called, &tell, &|| go_on().is_ok());
            made.map_err(|failure| as_exception(failure.told()))
        })
    })
}

fn as_exception((status, message): (Status, &str)) -> PyErr {
    match status {
        Status::Files => PyOSError::new_err(message.to_owned()),
        _ => PyValueError::new_err(message.to_owned()),
    }
}
