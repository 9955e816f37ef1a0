//! The Python package `localshape`: scenes, their simulation and pictures, as in the library.
//!
//! Each class wraps one type of the library and adds no meaning. What is simpler in Python is in `localshape/*.py`.

// `cargo test --lib` asks for a program of tests, which would need the interpreter.
#![cfg(not(test))]

mod convert;
mod error;
#[cfg(feature = "render")]
mod film;
#[cfg(feature = "render")]
mod golden;
mod interrupt;
mod made;
#[cfg(feature = "render")]
mod picture;
mod result;
mod scene;
mod world;

/// The compiled part of the package `localshape`.
#[pyo3::pymodule]
mod _core {
    use pyo3::prelude::*;
    use std::ffi::OsString;

    #[cfg(feature = "render")]
    #[pymodule_export]
    use super::film::{_count, _film, _frame};
    #[cfg(feature = "render")]
    #[pymodule_export]
    use super::golden::{_compare, _index};
    #[cfg(feature = "render")]
    #[pymodule_export]
    use super::picture::Picture;
    #[pymodule_export]
    use super::result::{Result, RunResult};
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::world::World;

    /// Runs the program `localshape` with the words of a command line, and returns its exit status.
    #[pyfunction]
    fn _program(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
        #[cfg(feature = "render")]
        super::picture::prepare_driver(py)?;
        Ok(py.detach(|| localshape::internals::run(words) as u8))
    }

    /// The version of the package.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "the name that Python packages use")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
