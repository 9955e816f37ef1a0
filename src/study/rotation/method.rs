//! The solvers that are compared.

use super::reference::by_svd;
use super::sample::Sample;
use crate::sim::rotation::{RotationReading, linear_update, robust};
use crate::sim::words::typed;
use glam::{DMat3, DQuat};
use std::hint::black_box;

/// A solver with a number of passes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Method {
    name: String,
    /// The number of passes; `None` for a solver without passes.
    pub(crate) passes: Option<u32>,
    solver: Solver,
}

/// What a method runs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Solver {
    /// As in a simulation.
    Reading(RotationReading),
    /// The library's.
    Svd,
}

/// All of them, in the order of their families.
pub(crate) fn all() -> Vec<Method> {
    use RotationReading::{
        Arctangent, Cayley, ClosedForm, Davenport, Kugelstadt, LinearUpdate, Mueller, Quintic, Robust, Symmetric,
        VectorLength,
    };
    let iterations = [LinearUpdate, VectorLength, Arctangent, Symmetric, Cayley, Quintic, Kugelstadt, Mueller];
    let mut methods = Vec::new();
    for reading in iterations {
        let passes: &[u32] = if reading == Mueller { &[1, 2, 5, 20] } else { &[1, 2, 3] };
        methods.extend(passes.iter().map(|&passes| Method::of(reading, Some(passes))));
    }
    methods.push(Method { name: "SVD (library)".to_owned(), passes: None, solver: Solver::Svd });
    methods.extend([Davenport, ClosedForm, Robust].map(|reading| Method::of(reading, None)));
    methods
}

/// The number of a solver's family: the paper's readings, Newton's methods, relaxation, global solvers, the default.
pub(crate) fn family(reading: RotationReading) -> usize {
    use RotationReading::{
        Arctangent, Cayley, ClosedForm, Davenport, Kugelstadt, LinearUpdate, Mueller, Quintic, Robust, Symmetric,
        VectorLength,
    };
    match reading {
        Arctangent | VectorLength | LinearUpdate => 0,
        Symmetric | Cayley | Quintic | Kugelstadt => 1,
        Mueller => 2,
        ClosedForm | Davenport => 3,
        Robust => 4,
    }
}

impl Method {
    fn of(reading: RotationReading, passes: Option<u32>) -> Self {
        Self { name: typed(&reading), passes, solver: Solver::Reading(reading) }
    }

    /// Its name in scenes, or that of the library's.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Its name with the number of passes.
    pub(crate) fn title(&self) -> String {
        match self.passes {
            Some(1) => format!("{}, 1 pass", self.name),
            Some(passes) => format!("{}, {passes} passes", self.name),
            None => self.name.clone(),
        }
    }

    /// Whether it is the one that scenes use if they name none.
    pub(crate) fn is_default(&self) -> bool {
        self.solver == Solver::Reading(RotationReading::default())
    }

    /// Whether it is one pass of an iteration.
    pub(crate) fn is_single(&self) -> bool {
        self.passes == Some(1)
    }

    /// Whether it is the paper's, with so many passes as the paper advises.
    pub(super) fn is_printed(&self) -> bool {
        self.solver == Solver::Reading(RotationReading::Arctangent) && self.passes == Some(2)
    }

    /// The number of its family.
    pub(crate) fn family(&self) -> usize {
        match self.solver {
            Solver::Reading(reading) => family(reading),
            Solver::Svd => family(RotationReading::Davenport),
        }
    }

    /// The rotation of a sample; not a number where the library does not converge.
    #[inline]
    pub(super) fn rotation(&self, sample: &Sample) -> DQuat {
        match self.solver {
            Solver::Reading(reading) => reading.follow(sample.at_rest, sample.last, self.passes.unwrap_or(0)).rotation,
            Solver::Svd => by_svd(sample.at_rest).unwrap_or(DQuat::NAN),
        }
    }

    /// Does the same work as in a simulation, where the result of Eq. (16) stays a matrix.
    #[inline]
    pub(super) fn work(&self, sample: &Sample) {
        match (self.solver, self.passes) {
            (Solver::Reading(RotationReading::LinearUpdate), Some(passes)) => {
                black_box(linear_update::update(sample.at_rest, DMat3::from_quat(sample.last), passes));
            }
            _ => {
                black_box(self.rotation(sample));
            }
        }
    }

    /// The same solver with another number of passes, if it has any.
    pub(super) fn with_passes(&self, passes: u32) -> Self {
        Self { passes: self.passes.map(|_| passes), ..self.clone() }
    }

    /// Whether the default needed its global solver for a sample; `None` for other methods.
    pub(super) fn is_global(&self, sample: &Sample) -> Option<bool> {
        self.is_default().then(|| robust::follow(sample.at_rest, sample.last).is_global)
    }
}
