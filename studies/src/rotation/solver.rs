//! The compared solvers: of scenes, of other papers, and of a library. Each is a function of `at_rest` = `Σ R0 rᵀ`
//! (m²), the last rotation and a number of passes, where `R0` are the corners at rest and `r` the corners now, relative
//! to their means.

use super::reference::by_svd;
use super::sample::Sample;
use super::{closed_form, mueller, newton};
use glam::{DMat3, DQuat};
use localshape::sim::model::shape_based::RotationReading;
use localshape::sim::rotation::davenport1968::optimum;
use localshape::sim::rotation::{linear_update, robust};
use std::hint::black_box;

/// A solver with a number of passes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solver {
    /// Its name, as in scenes if they have it.
    pub(crate) name: &'static str,
    /// The number of passes; `None` for a solver without passes.
    pub(crate) passes: Option<u32>,
    follow: fn(DMat3, DQuat, u32) -> DQuat,
}

/// The name of the paper's solver.
const PRINTED: &str = "arctangent";
/// The name of Eq. (16), which makes no rotation.
const LINEAR: &str = "linear-update";

/// All solvers, in the order of their families.
pub(crate) fn all() -> Vec<Solver> {
    use RotationReading::{Arctangent, LinearUpdate, Robust, VectorLength};
    // If the library does not converge, its result is not a number.
    let svd = |at_rest, _, _| by_svd(at_rest).unwrap_or(DQuat::NAN);
    type Row = (&'static str, &'static [u32], fn(DMat3, DQuat, u32) -> DQuat);
    let solvers: [Row; 12] = [
        (LINEAR, &[1, 2, 3], |at_rest, last, passes| LinearUpdate.follow(at_rest, last, passes).rotation),
        ("vector-length", &[1, 2, 3], |at_rest, last, passes| VectorLength.follow(at_rest, last, passes).rotation),
        (PRINTED, &[1, 2, 3], |at_rest, last, passes| Arctangent.follow(at_rest, last, passes).rotation),
        ("symmetric", &[1, 2, 3], newton::symmetric),
        ("cayley", &[1, 2, 3], newton::cayley),
        ("quintic", &[1, 2, 3], newton::quintic),
        ("kugelstadt", &[1, 2, 3], newton::kugelstadt),
        ("mueller", &[1, 2, 5, 20], mueller::relax),
        ("SVD (library)", &[], svd),
        ("davenport", &[], |at_rest, last, _| optimum(at_rest, last)),
        ("closed-form", &[], |at_rest, last, _| closed_form::rotation(at_rest, last)),
        ("robust", &[], |at_rest, last, _| Robust.follow(at_rest, last, 0).rotation),
    ];
    let of = |(name, passes, follow): Row| {
        let none = passes.is_empty().then_some(None);
        let each = none.into_iter().chain(passes.iter().copied().map(Some));
        each.map(move |passes| Solver { name, passes, follow })
    };
    solvers.into_iter().flat_map(of).collect()
}

impl Solver {
    /// Its name with the number of passes.
    pub(crate) fn title(&self) -> String {
        match self.passes {
            Some(1) => format!("{}, 1 pass", self.name),
            Some(passes) => format!("{}, {passes} passes", self.name),
            None => self.name.to_owned(),
        }
    }

    /// Whether it is the default of scenes.
    pub(crate) fn is_default(&self) -> bool {
        self.name == "robust"
    }

    /// Whether it is the paper's solver, with the number of passes that the paper advises.
    pub(super) fn is_printed(&self) -> bool {
        self.name == PRINTED && self.passes == Some(2)
    }

    /// The rotation of a sample; for Eq. (16), the rotation nearest to its result.
    pub(crate) fn rotation(&self, sample: &Sample) -> DQuat {
        (self.follow)(sample.at_rest, sample.last, self.passes.unwrap_or(0))
    }

    /// Does the work of a simulation, in which the result of Eq. (16) stays a matrix.
    pub(super) fn work(&self) -> impl Fn(&Sample) + use<> {
        let (follow, passes, is_linear) = (self.follow, self.passes.unwrap_or(0), self.name == LINEAR);
        move |sample: &Sample| match is_linear {
            true => drop(black_box(linear_update::update(sample.at_rest, DMat3::from_quat(sample.last), passes))),
            false => drop(black_box(follow(sample.at_rest, sample.last, passes))),
        }
    }

    /// This solver with another number of passes, if it has any.
    pub(crate) fn with_passes(&self, passes: u32) -> Self {
        Self { passes: self.passes.map(|_| passes), ..*self }
    }

    /// Whether the default needed its global solver for a sample; `None` for other solvers.
    pub(crate) fn is_global(&self, sample: &Sample) -> Option<bool> {
        self.is_default().then(|| robust::follow(sample.at_rest, sample.last).is_global)
    }
}
