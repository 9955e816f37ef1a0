//! The results of a simulation: arrays of all frames, and their pictures.

use crate::interrupt::{Slices, in_pool};
use crate::made::Made;
#[cfg(feature = "render")]
use crate::picture::Picture;
use localshape::Runner;
use localshape::glam::DVec3;
use localshape::runner::{Frame, History};
use localshape::sim::{Diagnostic, Diagnostics, Divergence, Snapshot, Status, Value};
#[cfg(feature = "render")]
use numpy::PyUntypedArrayMethods;
use numpy::ndarray::Array;
use numpy::{IntoPyArray, PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::{PyKeyError, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
#[cfg(feature = "render")]
use std::path::PathBuf;

/// The number of the run with a name.
pub(crate) fn run_of(scene: &localshape::Scene, name: &str) -> PyResult<usize> {
    scene.runs.iter().position(|run| run.name == name).ok_or_else(|| {
        let names: Vec<_> = scene.runs.iter().map(|run| format!("“{}”", run.name)).collect();
        PyKeyError::new_err(format!("the scene has no run “{name}”; its runs are {}", names.join(", ")))
    })
}

/// The frames of a simulated scene: `result["NAME"]` has the arrays of a run, and `result.frame(t)` is a picture.
#[pyclass(frozen, module = "localshape")]
pub(crate) struct Result {
    /// The scene, and what it was made of.
    pub(crate) made: Made,
    /// The frames without positions and velocities, which are in the arrays of the runs.
    frames: Vec<Frame>,
    /// What pictures show of the course.
    #[cfg_attr(not(feature = "render"), expect(dead_code, reason = "pictures alone show it"))]
    pub(crate) history: History,
    runs: Vec<Py<RunResult>>,
}

/// One run in all frames.
#[pyclass(frozen, get_all, module = "localshape")]
pub(crate) struct RunResult {
    /// The name of the run.
    name: String,
    /// Time step (s).
    step: f64,
    /// Time of each frame (s): F, float64.
    time: Py<PyArray1<f64>>,
    /// Position of each node in each frame (m): F × N × 3, float64.
    position: Py<PyArray3<f64>>,
    /// Velocity of each node in each frame (m/s): F × N × 3, float64.
    velocity: Py<PyArray3<f64>>,
    /// The diagnostics by the names in `diagnostics.csv`: arrays of length R, of vectors R × 3, with R = F rows. With `time.every` there are
    /// more rows, whose `frame` is nan.
    diagnostics: Py<PyAny>,
    /// The same of each body by its name; empty if the run has one body.
    bodies: Py<PyDict>,
    /// Where and when the run diverged, if it did.
    divergence: Option<Py<PyAny>>,
}

/// Positions and velocities of a run, frame after frame.
type Nodes = [Vec<f64>; 2];
/// Time (s), diagnostics of all bodies of a run, and of each of several.
type Row = (f64, Diagnostics, Vec<Diagnostics>);

/// The frames of some runs; the nodes and the rows between frames of each; and what pictures show of the course.
struct Course {
    frames: Vec<Frame>,
    nodes: Vec<Nodes>,
    rows: Vec<Vec<Row>>,
    history: History,
}

/// Simulates some runs of a scene to its end.
pub(crate) fn simulate(py: Python<'_>, made: Made, runs: &[usize]) -> PyResult<Result> {
    if runs.is_empty() {
        return Err(PyValueError::new_err("there are no runs to simulate; expected the name of at least one"));
    }
    let scene = &*made.scene;
    let Course { frames, nodes, rows, history } = py.detach(|| in_pool(|go_on| course(scene, runs, go_on)))?;
    let of_run = |(place, of)| Py::new(py, RunResult::new(py, scene, &frames, place, of)?);
    let runs = nodes.into_iter().zip(rows).enumerate().map(of_run).collect::<PyResult<_>>()?;
    Ok(Result { made, frames, history, runs })
}

/// The course of some runs. An error of `go_on` ends it.
fn course(scene: &localshape::Scene, runs: &[usize], go_on: &dyn Fn() -> PyResult<()>) -> PyResult<Course> {
    let count = scene.last_frame() as usize + 1;
    let reserve = |run: &usize| -> PyResult<Nodes> {
        let mut nodes = Nodes::default();
        for numbers in &mut nodes {
            numbers.try_reserve_exact(3 * scene.runs[*run].body().len() * count).map_err(|_| {
                PyMemoryError::new_err(format!("{count} frames do not fit into memory; use fewer frames per second"))
            })?;
        }
        Ok(nodes)
    };
    let mut nodes = runs.iter().map(reserve).collect::<PyResult<Vec<_>>>()?;
    let (mut frames, mut slices) = (Vec::with_capacity(count), Slices::new());
    let mut runner = Runner::for_pictures(scene, runs).with_rows();
    for index in 0..count as u64 {
        slices.until(|steps| runner.advance_towards(scene.moment(index), steps), go_on)?;
        let mut frame = runner.frame(index);
        for (run, [position, velocity]) in frame.runs.iter_mut().zip(&mut nodes) {
            position.extend(std::mem::take(&mut run.snapshot.position).iter().flat_map(|at| at.to_array()));
            velocity.extend(std::mem::take(&mut run.snapshot.velocity).iter().flat_map(|at| at.to_array()));
        }
        frames.push(frame);
    }
    scene.check_recordings()?;
    Ok(Course { frames, nodes, rows: runner.take_rows(), history: runner.take_history() })
}

impl RunResult {
    /// The run at a place among those of some frames. Its arrays are the buffers of its nodes.
    fn new(
        py: Python<'_>,
        scene: &localshape::Scene,
        frames: &[Frame],
        place: usize,
        (nodes, between): (Nodes, Vec<Row>),
    ) -> PyResult<Self> {
        let of_run = || frames.iter().map(|frame| &frame.runs[place]);
        let run = &scene.runs[frames[0].runs[place].run];
        let shape = [frames.len(), run.body().len(), 3];
        let array = |numbers| {
            let array = Array::from_shape_vec(shape, numbers).expect("three numbers of each node in each frame");
            fixed(array.into_pyarray(py))
        };
        let [position, velocity] = nodes.map(array);
        let time: Vec<f64> = of_run().map(|run| run.snapshot.time).collect();
        // As in `diagnostics.csv`: between two frames the rows between them.
        let (mut between, mut numbers, mut rows) = (between.into_iter().peekable(), Vec::new(), Vec::new());
        for frame in frames {
            let Snapshot { time, diagnostics, of_bodies, .. } = &frame.runs[place].snapshot;
            rows.extend(std::iter::from_fn(|| between.next_if(|(before, ..)| before < time)));
            numbers.resize(rows.len(), f64::NAN);
            while between.next_if(|(same, ..)| same <= time).is_some() {}
            rows.push((*time, *diagnostics, of_bodies.clone()));
            numbers.push(frame.index as f64);
        }
        let times: Vec<f64> = rows.iter().map(|(time, ..)| *time).collect();
        let table = |of: Vec<Diagnostics>| tables(py, &numbers, &times, &of);
        let diagnostics = table(rows.iter().map(|(_, all, _)| *all).collect())?;
        let bodies = PyDict::new(py);
        for (at, &body) in run.of.iter().enumerate().filter(|_| run.of.len() > 1) {
            let of_body = table(rows.iter().map(|(.., of_bodies)| of_bodies[at]).collect())?;
            bodies.set_item(&scene.bodies[body].name, of_body)?;
        }
        let bodies = bodies.unbind();
        let divergence = match of_run().next_back().map(|last| last.snapshot.status) {
            Some(Status::Diverged(found)) => Some(divergence(py, scene, &run.of, found)?),
            _ => None,
        };
        let time = fixed(PyArray1::from_vec(py, time));
        Ok(Self { name: run.name.clone(), step: run.step, time, position, velocity, diagnostics, bodies, divergence })
    }
}

/// An array that cannot be changed: pictures show it.
fn fixed<T: numpy::Element, D: numpy::ndarray::Dimension>(
    array: Bound<'_, numpy::PyArray<T, D>>,
) -> Py<numpy::PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array.unbind()
}

/// Where and when a run of some bodies of a scene diverged, as `localshape.Divergence`.
pub(crate) fn divergence(
    py: Python<'_>,
    scene: &localshape::Scene,
    of: &[usize],
    found: Divergence,
) -> PyResult<Py<PyAny>> {
    let Divergence { time, step, part, element, is_end } = found;
    let body = of.get(part).map_or("", |&body| &*scene.bodies[body].name);
    let made = py.import("localshape._tables")?.getattr("Divergence")?;
    Ok(made.call1((time, step, body, element, is_end))?.unbind())
}

/// The diagnostics in some frames at some times (s) as `localshape.Diagnostics`: an array of each, with a row of three for a vector.
pub(crate) fn tables(py: Python<'_>, frames: &[f64], time: &[f64], rows: &[Diagnostics]) -> PyResult<Py<PyAny>> {
    let columns = PyDict::new(py);
    columns.set_item("frame", PyArray1::from_slice(py, frames))?;
    columns.set_item("time", PyArray1::from_slice(py, time))?;
    for diagnostic in Diagnostic::ALL {
        let values = || rows.iter().map(|row| diagnostic.value(row));
        let vectors: Option<Vec<DVec3>> =
            values().map(|value| if let Value::Vector(vector) = value { Some(vector) } else { None }).collect();
        match vectors {
            Some(vectors) => columns.set_item(diagnostic.key(), vectors_as_array(py, &vectors))?,
            None => columns.set_item(diagnostic.key(), PyArray1::from_iter(py, values().map(Value::size)))?,
        }
    }
    Ok(py.import("localshape._tables")?.getattr("Diagnostics")?.call1((columns,))?.unbind())
}

/// Vectors as an array of a row for each.
pub(crate) fn vectors_as_array<'py>(py: Python<'py>, vectors: &[DVec3]) -> Bound<'py, numpy::PyArray2<f64>> {
    let numbers = vectors.iter().flat_map(|vector| vector.to_array()).collect();
    Array::from_shape_vec([vectors.len(), 3], numbers).expect("three numbers of each").into_pyarray(py)
}

#[pymethods]
impl Result {
    /// The names of the runs.
    #[getter]
    fn runs(&self) -> Vec<String> {
        self.runs.iter().map(|run| run.get().name.clone()).collect()
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<RunResult>> {
        match self.runs.iter().find(|run| run.get().name == name) {
            Some(run) => Ok(run.clone_ref(py)),
            None => {
                run_of(&self.made.scene, name)?;
                let message = format!("the run “{name}” was not simulated; the result has {}", self.runs().join(", "));
                Err(PyKeyError::new_err(message))
            }
        }
    }

    fn __len__(&self) -> usize {
        self.runs.len()
    }

    fn __contains__(&self, name: &str) -> bool {
        self.runs.iter().any(|run| run.get().name == name)
    }

    /// The picture of the frame nearest to a time (s).
    ///
    /// Raises `ValueError` for a time before the start or after the last frame.
    #[cfg(feature = "render")]
    fn frame(&self, py: Python<'_>, t: f64) -> PyResult<Picture> {
        let (last, duration) = (self.frames.len() - 1, self.made.scene.duration);
        let number = (t * self.made.scene.frames_per_second).round();
        if !(t >= 0.0 && (number <= last as f64 || t <= duration)) {
            let end = self.made.scene.frame_time(last as u64);
            return Err(PyValueError::new_err(format!("there is no frame at {t} s; frames are from 0 to {end} s")));
        }
        self.picture(py, (number as usize).min(last))
    }

    /// Writes an animation of the frames, as `localshape animate` does. The ending of `path` chooses the format: `.gif`, `.apng`, or `.mp4` and
    /// `.webm`, which need `ffmpeg`.
    ///
    /// `frames` are numbers of frames (default: all), `speed` is a factor, `fps` a rate (1/s), `plays` a number of plays (0 for endless),
    /// `hold_last` a time (s), `width` that of the pictures (px). A file that was not made so is replaced only with `overwrite`. A bar
    /// shows progress if `tqdm` is installed.
    #[cfg(feature = "render")]
    #[pyo3(
        signature = (path, **options),
        text_signature = "($self, path, *, frames=None, speed=None, fps=None, plays=None, hold_last=None, width=None, overwrite=False)"
    )]
    fn animate(slf: &Bound<'_, Self>, path: PathBuf, options: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        slf.py().import("localshape._film")?.getattr("animate")?.call((slf, path), options).map(drop)
    }

    fn __repr__(&self) -> String {
        format!(
            "<localshape.Result “{}”: {} frames of {}>",
            self.made.scene.title,
            self.frames.len(),
            self.runs().join(", ")
        )
    }
}

#[cfg(feature = "render")]
impl Result {
    /// The picture of a frame.
    pub(crate) fn picture(&self, py: Python<'_>, index: usize) -> PyResult<Picture> {
        let frame = self.whole(py, index)?;
        self.check_compared()?;
        py.detach(|| Picture::compose(&self.made.scene, &self.history, frame)).map_err(PyValueError::new_err)
    }

    /// The number of frames.
    pub(crate) fn count(&self) -> usize {
        self.frames.len()
    }

    /// A frame with its positions and velocities.
    pub(crate) fn whole(&self, py: Python<'_>, index: usize) -> PyResult<Frame> {
        let mut frame = self.frames[index].clone();
        for (run, arrays) in frame.runs.iter_mut().zip(&self.runs) {
            let vectors = |array: &Py<PyArray3<f64>>| -> PyResult<Vec<DVec3>> {
                let array = array.bind(py).try_readonly()?;
                let numbers = 3 * array.shape()[1];
                let of_frame = &array.as_slice()?[index * numbers..][..numbers];
                Ok(of_frame.as_chunks::<3>().0.iter().map(|&vector| vector.into()).collect())
            };
            run.snapshot.position = vectors(&arrays.get().position)?;
            run.snapshot.velocity = vectors(&arrays.get().velocity)?;
        }
        Ok(frame)
    }

    /// Refuses pictures that compare runs with one that was not simulated.
    pub(crate) fn check_compared(&self) -> PyResult<()> {
        let is_missing = |run: usize| !self.frames[0].runs.iter().any(|simulated| simulated.run == run);
        match self.made.scene.view.compared().into_iter().flatten().find(|(_, run)| is_missing(*run)) {
            Some((key, run)) => {
                let name = &self.made.scene.runs[run].name;
                let message =
                    format!("the run “{name}”, which `view.{key}` needs, was not simulated; simulate it, too");
                Err(PyValueError::new_err(message))
            }
            None => Ok(()),
        }
    }
}
