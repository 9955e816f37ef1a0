//! Worlds: the bodies of one run, advanced step by step.

use crate::interrupt::{Slices, hear};
use crate::result::{divergence, tables, vectors_as_array};
use crate::{convert, error};
use localshape::glam::DVec3;
use localshape::sim::{self, Course, Ease, Key, Load, Loading, Motion, Offset, Path, Pose, State, Status};
use numpy::{PyArray2, PyUntypedArray};
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The bodies of one run of a scene, advanced step by step. `scene.world("NAME")` makes it.
///
/// Worlds in several threads run at once. Two threads cannot use one world at the same time: `RuntimeError`.
#[pyclass(frozen, module = "localshape")]
pub(crate) struct World {
    scene: Arc<localshape::Scene>,
    run: usize,
    world: Mutex<sim::World>,
    /// The obstacles that functions move, by their number.
    moved: Mutex<BTreeMap<usize, Arc<Moved>>>,
}

/// The path of an obstacle, which is a function in Python of the time (s).
struct Moved {
    function: Py<PyAny>,
    sampled: Arc<Sampled>,
}

/// A path between the begin and the end of a step.
#[derive(Default)]
struct Sampled(Mutex<Motion>);

impl Path for Sampled {
    fn pose(&self, time: f64) -> Pose {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pose(time)
    }
}

impl Moved {
    /// Calls the function for the begin and the end of a step (s).
    fn sample(&self, py: Python<'_>, times: [f64; 2], place: &str) -> PyResult<()> {
        let key = |time: f64| {
            let wrong = |found: String| {
                let expected = "expected three finite numbers (m), or six with a rotation vector (rad)";
                error::at(py, place, format!("the path of `{place}` at {time} s is {found}; {expected}"), None)
            };
            let at = self.function.bind(py).call1((time,))?;
            let numbers: Vec<f64> =
                at.extract().map_err(|_| wrong(at.repr().map_or_else(|_| "?".into(), |at| at.to_string())))?;
            let is_finite = numbers.iter().all(|number| number.abs() <= FARTHEST);
            match numbers[..] {
                [x, y, z] if is_finite => Ok(Offset { shift: DVec3::new(x, y, z), rotation: DVec3::ZERO }),
                [x, y, z, a, b, c] if is_finite => {
                    Ok(Offset { shift: DVec3::new(x, y, z), rotation: DVec3::new(a, b, c) })
                }
                _ => Err(wrong(format!("{numbers:?}"))),
            }
            .map(|offset| Key { time, offset })
        };
        let keys = times.into_iter().map(key).collect::<PyResult<_>>()?;
        *self.sampled.0.lock().unwrap_or_else(PoisonError::into_inner) =
            Motion::Keys { keys, ease: Ease::Linear, repeat: false };
        Ok(())
    }
}

/// Gives an obstacle of a world a motion.
fn along(world: &mut sim::World, number: usize, motion: Motion) -> PyResult<()> {
    let mut obstacles = world.surroundings().obstacles.clone();
    obstacles[number].motion = motion;
    world.set_obstacles(obstacles).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The farthest that an obstacle moves (m, rad).
const FARTHEST: f64 = 1e9;

impl World {
    /// The world of a run of a scene, at its start.
    pub(crate) fn new(scene: &Arc<localshape::Scene>, run: usize) -> Self {
        Self { scene: Arc::clone(scene), run, world: Mutex::new(scene.world(run)), moved: Mutex::default() }
    }

    /// The world, unless another thread uses it.
    fn now(&self) -> PyResult<MutexGuard<'_, sim::World>> {
        self.world
            .try_lock()
            .map_err(|_| PyRuntimeError::new_err("another thread is using this world; give it one of its own"))
    }

    /// The obstacles that functions move.
    fn moved(&self) -> MutexGuard<'_, BTreeMap<usize, Arc<Moved>>> {
        self.moved.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A row of three numbers for each node.
    fn rows(&self, array: &Bound<'_, PyUntypedArray>, place: &str) -> PyResult<Vec<DVec3>> {
        let nodes = self.scene.runs[self.run].body().len();
        let expected = format!("({nodes}, 3), one row for each node");
        let numbers = convert::numbers(array, place, &expected, |shape| shape == [nodes, 3])?;
        Ok(numbers.as_chunks::<3>().0.iter().map(|&vector| vector.into()).collect())
    }

    /// Sets positions or velocities, or both.
    fn set_nodes(&self, position: Option<Vec<DVec3>>, velocity: Option<Vec<DVec3>>) -> PyResult<()> {
        let mut world = self.now()?;
        let position = position.unwrap_or_else(|| world.state().position.clone());
        let velocity = velocity.unwrap_or_else(|| world.state().velocity.clone());
        world.set_nodes(position, velocity).map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

#[pymethods]
impl World {
    /// Advances by a number of steps. Other threads of Python go on meanwhile, and Ctrl-C is heard: the world is then between two
    /// steps. After a divergence only the clock advances.
    #[pyo3(signature = (steps=1))]
    fn step(&self, py: Python<'_>, steps: u64) -> PyResult<()> {
        let mut left = steps;
        let moved: Vec<_> = self.moved().iter().map(|(&number, one)| (number, Arc::clone(one))).collect();
        for _ in 0..if moved.is_empty() { 0 } else { steps } {
            // The functions may look at the world.
            let step = self.steps()?;
            let times = [step, step + 1].map(|step| step as f64 * self.dt());
            moved.iter().try_for_each(|(number, one)| one.sample(py, times, &self.scene.obstacle_names[*number]))?;
            py.detach(|| {
                let mut world = self.now()?;
                if world.steps() != step {
                    return Err(PyRuntimeError::new_err(
                        "the world was advanced while paths of its obstacles were asked",
                    ));
                }
                world.advance(1);
                left -= 1;
                Ok(())
            })?;
            py.check_signals()?;
        }
        py.detach(|| {
            let mut world = self.now()?;
            let advance = |most: u64| {
                let taken = left.min(most);
                world.advance(taken);
                left -= taken;
                left == 0
            };
            Slices::new().until(advance, hear)
        })?;
        Ok(self.scene.check_recordings()?)
    }

    /// Position of each node (m): N × 3, float64. A copy; assign an array to move the nodes.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(vectors_as_array(py, &self.now()?.state().position))
    }

    #[setter]
    fn set_position(&self, position: &Bound<'_, PyUntypedArray>) -> PyResult<()> {
        self.set_nodes(Some(self.rows(position, "position")?), None)
    }

    /// Velocity of each node (m/s): N × 3, float64. A copy; assign an array to set the velocities.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(vectors_as_array(py, &self.now()?.state().velocity))
    }

    #[setter]
    fn set_velocity(&self, velocity: &Bound<'_, PyUntypedArray>) -> PyResult<()> {
        self.set_nodes(None, Some(self.rows(velocity, "velocity")?))
    }

    /// The internal forces on each node in the present state (N): N × 3, float64.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(vectors_as_array(py, &self.now()?.forces()))
    }

    /// Sets the constant force on each node (N) from now on, beside the loads of the scene: N × 3; `None` for no forces.
    #[pyo3(signature = (forces))]
    fn set_forces(&self, forces: Option<&Bound<'_, PyUntypedArray>>) -> PyResult<()> {
        let forces = forces.map(|forces| self.rows(forces, "forces")).transpose()?;
        let of_scene = self.scene.runs[self.run].loads.iter().map(|load| Arc::clone(load) as Arc<dyn Load>);
        let dead = |forces: Vec<DVec3>| Loading::dead((0..forces.len() as u32).collect(), forces, Course::ALWAYS);
        let loads = of_scene.chain(forces.map(|forces| Arc::new(dead(forces)) as Arc<dyn Load>)).collect();
        self.now()?.set_loads(loads).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Sets the acceleration of gravity (m/s²) from now on: three numbers.
    fn set_gravity(&self, gravity: [f64; 3]) -> PyResult<()> {
        self.now()?.set_gravity(gravity.into()).map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Moves an obstacle, by its number or name, along a path from now on: `path(t)` is its displacement from its place in the scene at a
    /// time (s), three numbers (m), or six with a rotation vector (rad). It is called for the begin and the end of each step, between which
    /// the obstacle moves linearly. `None` gives it the motion of the scene again.
    ///
    /// What the function raises ends `step` between two steps.
    #[pyo3(signature = (obstacle, path))]
    fn set_path(&self, py: Python<'_>, obstacle: &Bound<'_, PyAny>, path: Option<Py<PyAny>>) -> PyResult<()> {
        let names = &self.scene.obstacle_names;
        let number = match obstacle.extract::<String>() {
            Ok(name) => names.iter().position(|other| *other == name),
            Err(_) => Some(obstacle.extract::<usize>()?),
        };
        let count = self.now()?.surroundings().obstacles.len();
        let Some(number) = number.filter(|&number| number < count) else {
            let message =
                format!("the run has no obstacle {}; it has {count}: {}", obstacle.repr()?, names[..count].join(", "));
            return Err(PyKeyError::new_err(message));
        };
        let Some(function) = path else {
            let _before = self.moved().remove(&number);
            return along(&mut *self.now()?, number, self.scene.obstacles[number].motion.clone());
        };
        let one = Moved { function, sampled: Arc::default() };
        let step = self.steps()?;
        one.sample(py, [step, step + 1].map(|step| step as f64 * self.dt()), &names[number])?;
        along(&mut *self.now()?, number, Motion::Along(one.sampled.clone()))?;
        // Python may run code as it forgets the earlier function.
        let _before = self.moved().insert(number, Arc::new(one));
        Ok(())
    }

    /// Mass of each node (kg): N, float64.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_slice(py, self.scene.runs[self.run].body().mass())
    }

    /// Time (s).
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.now()?.steps() as f64 * self.dt())
    }

    /// Time step (s).
    #[getter]
    fn dt(&self) -> f64 {
        self.scene.runs[self.run].step
    }

    /// Number of steps taken.
    #[getter]
    fn steps(&self) -> PyResult<u64> {
        Ok(self.now()?.steps())
    }

    /// The diagnostics of the present state, by the names in `diagnostics.csv`: numbers, and arrays of three for vectors.
    #[getter]
    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (time, diagnostics) = (self.time()?, self.now()?.diagnostics());
        tables(py, &[f64::NAN], &[time], &[diagnostics])?.bind(py).call_method0("_only_row")
    }

    /// Where and when the world diverged, if it did.
    #[getter]
    fn divergence(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        match self.now()?.status() {
            Status::Diverged(found) => divergence(py, &self.scene, &self.scene.runs[self.run].of, found).map(Some),
            Status::Ok => Ok(None),
        }
    }

    /// The whole state as bytes, to be assigned to this world or another one of the same run, which then goes on with the same
    /// bits.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.now()?.state().to_bytes()))
    }

    #[setter]
    fn set_state(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        let mut world = self.now()?;
        let state = State::from_bytes(state).filter(|state| world.takes(state)).ok_or_else(|| {
            error::at(
                py,
                "state",
                "`state` is not the state of a world of this run".to_owned(),
                Some("assign what `state` of such a world was"),
            )
        })?;
        world.set_state(state);
        Ok(())
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        let mut world = self.now()?.clone();
        let mut moved = BTreeMap::new();
        for (&number, one) in &*self.moved() {
            // Each world samples the function itself.
            let motion = one.sampled.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let sampled = Arc::new(Sampled(Mutex::new(motion)));
            along(&mut world, number, Motion::Along(sampled.clone()))?;
            moved.insert(number, Arc::new(Moved { function: one.function.clone_ref(py), sampled }));
        }
        Ok(Self { scene: Arc::clone(&self.scene), run: self.run, world: Mutex::new(world), moved: Mutex::new(moved) })
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("<localshape.World “{}” at {} s>", self.scene.runs[self.run].name, self.time()?))
    }
}
