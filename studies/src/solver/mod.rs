//! Solvers of the rotation of an element: those that scenes can choose, and others that are compared with them.
//!
//! All are functions of `at_rest` = `Σ R0 rᵀ` (m²), where `R0` are the corners at rest and `r` the corners now, relative to their
//! means, and of the last rotation of the element.

mod closed_form;
mod mueller;
mod newton;

use glam::{DMat3, DQuat};
use localshape::sim::model::shape_based::RotationReading;
use localshape::sim::rotation::davenport1968::optimum;

/// A solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solver {
    /// One of scenes.
    Scene(RotationReading),
    /// Eq. (15) with the symmetric part of its matrix, which is Newton's method.
    Symmetric,
    /// The same with the angle `2 atan(|w|/2)`.
    Cayley,
    /// The same with one more term: of fifth order.
    Quintic,
    /// The analytic polar decomposition of Kugelstadt et al. 2018.
    Kugelstadt,
    /// The relaxation of Müller et al. 2016.
    Mueller,
    /// The optimum in closed form.
    ClosedForm,
    /// The optimum as an eigenvector of Davenport's matrix.
    Davenport,
}

impl Solver {
    /// The paper's, as scenes have it.
    pub(crate) const PRINTED: Self = Self::Scene(RotationReading::Arctangent);
    pub(crate) const LENGTH: Self = Self::Scene(RotationReading::VectorLength);
    /// Eq. (16).
    pub(crate) const LINEAR: Self = Self::Scene(RotationReading::LinearUpdate);
    /// The default of scenes.
    pub(crate) const DEFAULT: Self = Self::Scene(RotationReading::Robust);

    /// All, with the default first.
    pub(crate) const ALL: [Self; 11] = [
        Self::DEFAULT,
        Self::ClosedForm,
        Self::Davenport,
        Self::PRINTED,
        Self::LENGTH,
        Self::LINEAR,
        Self::Symmetric,
        Self::Cayley,
        Self::Quintic,
        Self::Kugelstadt,
        Self::Mueller,
    ];

    /// Its name; that in scenes, if it has one.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Scene(RotationReading::Arctangent) => "arctangent",
            Self::Scene(RotationReading::VectorLength) => "vector-length",
            Self::Scene(RotationReading::LinearUpdate) => "linear-update",
            Self::Scene(_) => "robust",
            Self::Symmetric => "symmetric",
            Self::Cayley => "cayley",
            Self::Quintic => "quintic",
            Self::Kugelstadt => "kugelstadt",
            Self::Mueller => "mueller",
            Self::ClosedForm => "closed-form",
            Self::Davenport => "davenport",
        }
    }

    /// Whether it is an iteration with a fixed number of passes, so that the result depends on the last rotation.
    pub(crate) fn has_passes(self) -> bool {
        !matches!(self, Self::DEFAULT | Self::ClosedForm | Self::Davenport)
    }

    /// The number of its family, for plots: readings of the paper, Newton's methods, relaxation, global solvers, the default.
    #[cfg(feature = "render")]
    pub(crate) fn family(self) -> usize {
        match self {
            Self::DEFAULT => 4,
            Self::Scene(_) => 0,
            Self::Symmetric | Self::Cayley | Self::Quintic | Self::Kugelstadt => 1,
            Self::Mueller => 2,
            Self::ClosedForm | Self::Davenport => 3,
        }
    }

    /// The rotation of an element; solvers without passes ignore their number. Eq. (16) makes no rotation: the one nearest to its
    /// result is returned.
    pub(crate) fn follow(self, at_rest: DMat3, last: DQuat, passes: u32) -> DQuat {
        match self {
            Self::Scene(reading) => reading.follow(at_rest, last, passes).rotation,
            Self::Symmetric => newton::symmetric(at_rest, last, passes),
            Self::Cayley => newton::cayley(at_rest, last, passes),
            Self::Quintic => newton::quintic(at_rest, last, passes),
            Self::Kugelstadt => newton::kugelstadt(at_rest, last, passes),
            Self::Mueller => mueller::relax(at_rest, last, passes),
            Self::ClosedForm => closed_form::rotation(at_rest, last),
            Self::Davenport => optimum(at_rest, last),
        }
    }
}

/// `tr A`.
fn trace(a: DMat3) -> f64 {
    a.x_axis.x + a.y_axis.y + a.z_axis.z
}

/// The sum of the absolute values of all entries.
fn size(a: DMat3) -> f64 {
    a.to_cols_array().iter().fold(0.0, |size: f64, entry| size + entry.abs())
}
