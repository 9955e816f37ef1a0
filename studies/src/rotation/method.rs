//! The methods that are compared: solvers with numbers of passes, and that of a library.

use super::reference::by_svd;
use super::sample::Sample;
use crate::solver::Solver;
use glam::{DMat3, DQuat};
use localshape::sim::rotation::{linear_update, robust};
use std::hint::black_box;

/// A solver with a number of passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Method {
    /// `None` for the library's.
    pub(super) solver: Option<Solver>,
    /// The number of passes; `None` for a solver without passes.
    pub(crate) passes: Option<u32>,
}

/// All of them, in the order of their families.
pub(crate) fn all() -> Vec<Method> {
    use Solver::{Cayley, ClosedForm, Davenport, Kugelstadt, Mueller, Quintic, Symmetric};
    let iterations = [Solver::LINEAR, Solver::LENGTH, Solver::PRINTED, Symmetric, Cayley, Quintic, Kugelstadt, Mueller];
    let mut methods = Vec::new();
    for solver in iterations {
        let passes: &[u32] = if solver == Mueller { &[1, 2, 5, 20] } else { &[1, 2, 3] };
        methods.extend(passes.iter().map(|&passes| Method { solver: Some(solver), passes: Some(passes) }));
    }
    let global = [None, Some(Davenport), Some(ClosedForm), Some(Solver::DEFAULT)];
    methods.extend(global.map(|solver| Method { solver, passes: None }));
    methods
}

impl Method {
    /// Its name in scenes, if it has one, or that of the library's.
    pub(crate) fn name(&self) -> &'static str {
        self.solver.map_or("SVD (library)", Solver::name)
    }

    /// Its name with the number of passes.
    pub(crate) fn title(&self) -> String {
        match self.passes {
            Some(1) => format!("{}, 1 pass", self.name()),
            Some(passes) => format!("{}, {passes} passes", self.name()),
            None => self.name().to_owned(),
        }
    }

    /// Whether it is the one that scenes use if they name none.
    pub(crate) fn is_default(&self) -> bool {
        self.solver == Some(Solver::DEFAULT)
    }

    /// Whether it is the paper's, with so many passes as the paper advises.
    pub(super) fn is_printed(&self) -> bool {
        self.solver == Some(Solver::PRINTED) && self.passes == Some(2)
    }

    /// The rotation of a sample; not a number where the library does not converge.
    #[inline]
    pub(crate) fn rotation(&self, sample: &Sample) -> DQuat {
        match self.solver {
            Some(solver) => solver.follow(sample.at_rest, sample.last, self.passes.unwrap_or(0)),
            None => by_svd(sample.at_rest).unwrap_or(DQuat::NAN),
        }
    }

    /// Does the same work as in a simulation, where the result of Eq. (16) stays a matrix.
    #[inline]
    pub(super) fn work(&self, sample: &Sample) {
        match (self.solver, self.passes) {
            (Some(Solver::LINEAR), Some(passes)) => {
                black_box(linear_update::update(sample.at_rest, DMat3::from_quat(sample.last), passes));
            }
            _ => {
                black_box(self.rotation(sample));
            }
        }
    }

    /// The same solver with another number of passes, if it has any.
    pub(crate) fn with_passes(&self, passes: u32) -> Self {
        Self { passes: self.passes.map(|_| passes), ..*self }
    }

    /// Whether the default needed its global solver for a sample; `None` for other methods.
    pub(crate) fn is_global(&self, sample: &Sample) -> Option<bool> {
        self.is_default().then(|| robust::follow(sample.at_rest, sample.last).is_global)
    }
}
