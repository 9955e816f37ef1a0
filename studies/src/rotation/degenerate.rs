//! Elements whose rotation is hardly determined or undetermined, and the outcome of solvers for them.

use super::reference::angle;
use super::sample::Sample;
use super::solver::Solver;
use crate::random::Random;
use glam::{DMat3, DQuat, DVec3};
use localshape::sim::rotation::davenport1968::optimum;

/// A class of elements, which are deformed cubes: its name, the stretches along the axes, and the angle from the last
/// rotation to that of the deformation (rad), at most a half turn; `None` for any.
type Class = (&'static str, DVec3, Option<f64>);

/// The classes.
pub(crate) const CLASSES: [Class; 8] = [
    ("at a point", DVec3::ZERO, None),
    ("on a line", DVec3::X, None),
    ("in a plane", DVec3::new(1.0, 1.0, 0.0), None),
    ("mirrored", DVec3::new(1.0, 1.0, -1.0), None),
    ("point inversion", DVec3::NEG_ONE, None),
    ("rigid, turned by 90°", DVec3::ONE, Some(0.5 * std::f64::consts::PI)),
    ("rigid, turned by 180°", DVec3::ONE, Some(std::f64::consts::PI)),
    ("1e-90 times as large", DVec3::new(1e-90, 0.8e-90, 0.5e-90), None),
];

/// The worst outcome of a solver for the elements of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// The optimum; if there are several, the one nearest to the last rotation.
    Nearest,
    /// An optimum, but not the nearest.
    Some,
    /// A rotation that is not an optimum.
    Wrong,
    /// No numbers.
    NotANumber,
}

impl Outcome {
    /// In a few words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Nearest => "optimum",
            Self::Some => "an optimum",
            Self::Wrong => "stalls",
            Self::NotANumber => "NaN",
        }
    }
}

/// An excess over the optimum that counts as wrong, and the distance of rotations that count as different (rad).
const EQUAL: f64 = 1e-9;
const NEAR: f64 = 1e-6;
/// The number of elements of a class.
const ELEMENTS: usize = 200;

/// Elements of a class.
fn elements(&(_, stretch, turn_back): &Class) -> Vec<Sample> {
    let mut random = Random(5);
    let one = || {
        let (axes, turn) = (DMat3::from_quat(random.rotation()), random.rotation());
        let deformation = axes * DMat3::from_diagonal(stretch) * axes.transpose();
        let at_rest = (DMat3::from_quat(turn) * deformation).transpose();
        let last = match turn_back {
            Some(angle) => {
                let (sine, cosine) = libm::sincos(0.5 * angle);
                let axis = random.direction() * sine;
                (DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine) * turn).normalize()
            }
            None => random.rotation(),
        };
        Sample { at_rest, last }
    };
    std::iter::repeat_with(one).take(ELEMENTS).collect()
}

/// The outcome of a solver for a class.
pub(super) fn outcome(solver: &Solver, class: &Class) -> Outcome {
    elements(class).iter().map(|sample| outcome_of(solver, sample)).max().expect("some elements")
}

fn outcome_of(solver: &Solver, sample: &Sample) -> Outcome {
    let (found, sought) = (solver.rotation(sample), optimum(sample.at_rest, sample.last));
    if !found.is_finite() || (found.length_squared() - 1.0).abs() > 1e-12 {
        return Outcome::NotANumber;
    }
    let trace = |q: DQuat| {
        let a = DMat3::from_quat(q) * sample.at_rest;
        a.x_axis.x + a.y_axis.y + a.z_axis.z
    };
    let size: f64 = sample.at_rest.to_cols_array().iter().map(|entry| entry.abs()).sum();
    if trace(found) < trace(sought) - EQUAL * size {
        Outcome::Wrong
    } else if angle(found, sought) > NEAR {
        Outcome::Some
    } else {
        Outcome::Nearest
    }
}
