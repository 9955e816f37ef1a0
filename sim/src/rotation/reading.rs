//! The methods that compute the rotation of an element in space, behind one interface.

use super::linearised::{iterate, rotation_by_arctangent, rotation_by_length, solve};
use super::{Followed, davenport1968, linear_update, robust};
use glam::{DMat3, DQuat};

/// How the rotation of an element is computed: three readings of the paper's Eqs. (15) and (16), and the optimum.
/// `docs/accuracy.md` compares their errors and their cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum RotationReading {
    /// Eq. (15), and a rotation about its solution `w` by the angle `atan |w|`, which is Eq. (9) about that axis.
    /// Rotations are accumulated as quaternions. With two passes the error is 5e-14 rad after a rotation by 0.01 rad in
    /// a step, and 2e-9 rad after 0.1 rad.
    Arctangent,
    /// Rotation about `w` by the angle `|w|`, accumulated as quaternions. It overshoots and can make a free body spin
    /// faster and faster.
    VectorLength,
    /// Eq. (16) as printed, `R + w × R`. The result is not a rotation: a spinning body grows.
    LinearUpdate,
    /// The optimal rotation to round-off: steps of higher order from the last rotation where they are certain to lead
    /// to it, else the eigenvector of Davenport's matrix. Faster than two passes of Eq. (15). Not in the paper. The
    /// default.
    #[default]
    Robust,
}

impl RotationReading {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arctangent => "arctangent",
            Self::VectorLength => "vector-length",
            Self::LinearUpdate => "linear-update",
            Self::Robust => "robust",
        }
    }

    /// Whether it is an iteration with a fixed number of passes, so that the result depends on the last rotation.
    pub fn has_passes(self) -> bool {
        self != Self::Robust
    }

    /// The rotation of an element from its last one, for `at_rest` = `Σ R0 rᵀ` (m²); methods without passes ignore their
    /// number. The result of Eq. (16), which is not a rotation, is replaced by the rotation nearest to it.
    pub fn follow(self, at_rest: DMat3, last: DQuat, passes: u32) -> Followed {
        match self {
            Self::Arctangent => iterate(at_rest, last, passes, |a| rotation_by_arctangent(solve(a))),
            Self::VectorLength => iterate(at_rest, last, passes, |a| rotation_by_length(solve(a))),
            Self::LinearUpdate => {
                let matrix = linear_update::update(at_rest, DMat3::from_quat(last), passes);
                davenport1968::optimum(matrix.transpose(), last).into()
            }
            Self::Robust => robust::follow(at_rest, last),
        }
    }
}
