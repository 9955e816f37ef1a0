//! Eq. (4) in lanes: the laws of elements in space and in the plane, with or without damping.
//!
//! With `w = k P + D V` the force of an element on a corner is `−w + w̄ + k M R0`. The first term is computed once for each node. As
//! `Σ R0 = 0` the moments need no centroid.

use super::ShapeBased;
use crate::body::Body;
use crate::element::Dimension;
use crate::kernel::rotation::{self, Arctangent, Matrix, Moments, Optimum, Solver, axial, turned_back};
use crate::kernel::shapes::{Shapes, square};
use crate::kernel::{Compiled, Conditions, Rotation, Stepper};
use crate::lanes::{Lanes, each};
use crate::law::{Corners, Element, Law};
use crate::model::Report;
use std::sync::Arc;

/// The code of a model by the law of its elements, or with a faster stepper, if there is one.
pub(super) fn compile(
    model: &ShapeBased,
    rotation: Rotation,
    body: &Arc<Body>,
    conditions: &Conditions,
    faster: Option<Box<dyn Stepper>>,
) -> Compiled {
    /// With a solver of rotations in space.
    fn in_space<S: Solver>(
        solver: S,
        &ShapeBased { stiffness, damping, .. }: &ShapeBased,
        body: &Arc<Body>,
        conditions: &Conditions,
        faster: Option<Box<dyn Stepper>>,
    ) -> Compiled {
        match damping > 0.0 {
            true => Compiled::by(InSpace::<S, true> { stiffness, damping, solver }, body, conditions, faster),
            false => Compiled::by(InSpace::<S, false> { stiffness, damping, solver }, body, conditions, faster),
        }
    }
    let &ShapeBased { stiffness, damping, .. } = model;
    match (body.dimension, rotation) {
        (Dimension::Plane, _) if damping > 0.0 => {
            Compiled::by(InPlane::<true> { stiffness, damping }, body, conditions, faster)
        }
        (Dimension::Plane, _) => Compiled::by(InPlane::<false> { stiffness, damping }, body, conditions, faster),
        (_, Rotation::Optimum) => in_space(Optimum, model, body, conditions, faster),
        (_, Rotation::Arctangent { passes }) => in_space(Arctangent { passes }, model, body, conditions, faster),
    }
}

/// Elements in space.
#[derive(Clone, Copy)]
pub(super) struct InSpace<S, const DAMPED: bool> {
    /// `k` (N/m).
    pub(super) stiffness: f64,
    /// `D` (N s/m).
    pub(super) damping: f64,
    pub(super) solver: S,
}

/// Elements in the plane, with the rotation of Eq. (9).
#[derive(Clone, Copy)]
pub(super) struct InPlane<const DAMPED: bool> {
    /// `k` (N/m).
    pub(super) stiffness: f64,
    /// `D` (N s/m).
    pub(super) damping: f64,
}

/// What an element in space knows.
#[derive(Clone, Copy)]
pub(super) struct Fit<L> {
    /// `w̄` (N).
    mean: [L; 3],
    /// `Σ r R0ᵀ` (m²), and after all passes `k M` (N/m).
    matrix: Matrix<L>,
    /// The rotation before a pass, if there are several.
    turn: [L; 4],
    /// The lanes that take part in the next pass.
    open: u32,
}

impl<S: Solver, const DAMPED: bool> Law for InSpace<S, DAMPED> {
    /// `1 / Σ |R0|²` (1/m²).
    const OF_ELEMENT: usize = 1;
    /// `R0` (m).
    const OF_CORNER: usize = 3;
    /// The rotation, a quaternion.
    const MEMORY: usize = 4;
    const RESIDUAL: Option<&'static str> = Some(Report::ROTATION);
    type Whole<L: Lanes> = Fit<L>;

    fn is_damped(&self) -> bool {
        DAMPED
    }

    fn of_node(&self) -> [f64; 2] {
        [self.stiffness, self.damping]
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        relative_to_mean::<L, 3>(rest, of_corner);
        let mut squares = zero;
        for corner in 0..rest.count() {
            let [x, y, z] = each!(3, axis => of_corner[3 * corner + axis]);
            squares = squares + (x * x + y * y + z * z);
        }
        of_element[0] = (one / squares).select(zero.lt(squares), one);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> Fit<L> {
        let corners = element.corners() as f64;
        let (zero, k) = (L::splat(0.0), L::splat(self.stiffness));
        let (k_mean, d_mean) = (L::splat(self.stiffness / corners), L::splat(self.damping / corners));
        let (mut position, mut velocity, mut a) = ([zero; 3], [zero; 3], [[zero; 3]; 3]);
        let mut first = [zero; 3];
        for corner in 0..element.corners() {
            let (p, v) = element.corner(corner);
            if corner == 0 {
                first = p;
            }
            // Relative to the first corner, so that an element with all corners at one point gives exactly zero.
            let p = each!(3, axis => p[axis] - first[axis]);
            for axis in 0..3 {
                position[axis] = position[axis] + p[axis];
                if DAMPED {
                    velocity[axis] = velocity[axis] + v[axis];
                }
                let rest = element.of_corner(corner, axis);
                a[axis] = each!(3, row => p[row].mul_add(rest, a[axis][row]));
            }
        }
        let mut mean = each!(3, axis => position[axis].mul_add(k_mean, first[axis] * k));
        if DAMPED {
            mean = each!(3, axis => velocity[axis].mul_add(d_mean, mean[axis]));
        }
        let (turn, open) = if S::ITERATES { (element.memory(), element.live()) } else { ([zero; 4], 0) };
        Fit { mean, matrix: a, turn, open }
    }

    fn passes(&self) -> u32 {
        self.solver.passes()
    }

    #[inline(always)]
    fn refine<L: Lanes>(&self, pass: u32, element: &Element<'_, L>, fit: &mut Fit<L>) {
        // A copy: values behind references are read again after each store.
        let a = fit.matrix;
        let of = Moments { a: &a, scale: element.of_element(0), tally: element.tally() };
        let is_last = pass + 1 == self.solver.passes();
        let (last, open) = if S::ITERATES { (fit.turn, fit.open) } else { (element.memory(), element.live()) };
        let (turn, open) = self.solver.step(of, last, open, is_last);
        if is_last {
            element.remember(turn);
            fit.matrix = rotation::matrix(turn, L::splat(self.stiffness));
        } else {
            (fit.turn, fit.open) = (turn, open);
        }
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, fit: &Fit<L>) -> [L; 3] {
        let Fit { mean, matrix: m, .. } = fit;
        let [x, y, z] = each!(3, axis => element.of_corner(corner, axis));
        each!(3, axis => z.mul_add(m[2][axis], y.mul_add(m[1][axis], x.mul_add(m[0][axis], mean[axis]))))
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let shapes = Shapes::new(element.corners, *rest);
        let m = shapes.in_space(self.solver, element.memory());
        energy(&shapes, &m, self.stiffness, shares)
    }
}

impl<const DAMPED: bool> Law for InPlane<DAMPED> {
    /// `R0` (m).
    const OF_CORNER: usize = 2;
    /// The rotation, (cos θ, sin θ).
    const MEMORY: usize = 2;
    const RESIDUAL: Option<&'static str> = Some(Report::ROTATION);
    /// `w̄` (N), and `k` times the rotation (N/m).
    type Whole<L: Lanes> = [[L; 2]; 2];

    fn is_damped(&self) -> bool {
        DAMPED
    }

    fn of_node(&self) -> [f64; 2] {
        [self.stiffness, self.damping]
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, _: &mut [L], of_corner: &mut [L]) {
        relative_to_mean::<L, 2>(rest, of_corner);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> [[L; 2]; 2] {
        let corners = element.corners() as f64;
        let (zero, k) = (L::splat(0.0), L::splat(self.stiffness));
        let (k_mean, d_mean) = (L::splat(self.stiffness / corners), L::splat(self.damping / corners));
        let (mut position, mut velocity, mut turn) = ([zero; 2], [zero; 2], [zero; 2]);
        let mut first = [zero; 2];
        for corner in 0..element.corners() {
            let (p, v) = element.corner_in_plane(corner);
            let [x, y] = each!(2, axis => element.of_corner(corner, axis));
            if corner == 0 {
                first = p;
            }
            let [px, py] = each!(2, axis => p[axis] - first[axis]);
            position = [position[0] + px, position[1] + py];
            if DAMPED {
                velocity = [velocity[0] + v[0], velocity[1] + v[1]];
            }
            turn[0] = y.mul_add(py, x.mul_add(px, turn[0]));
            turn[1] = y.neg_mul_add(px, x.mul_add(py, turn[1]));
        }
        let turn = rotation::in_plane(turn, element.memory());
        element.remember(turn);
        let mut mean = each!(2, axis => position[axis].mul_add(k_mean, first[axis] * k));
        if DAMPED {
            mean = each!(2, axis => velocity[axis].mul_add(d_mean, mean[axis]));
        }
        [mean, each!(2, axis => turn[axis] * k)]
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, fit: &[[L; 2]; 2]) -> [L; 3] {
        let [[wx, wy], [cosine, sine]] = *fit;
        let [x, y] = each!(2, axis => element.of_corner(corner, axis));
        let fx = y.neg_mul_add(sine, x.mul_add(cosine, wx));
        let fy = y.mul_add(cosine, x.mul_add(sine, wy));
        [fx, fy, L::splat(0.0)]
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let shapes = Shapes::new(element.corners, *rest);
        let m = shapes.in_plane(element.memory());
        energy(&shapes, &m, self.stiffness, shares)
    }
}

/// `R0` of each corner (m), corner by corner.
#[inline(always)]
fn relative_to_mean<L: Lanes, const AXES: usize>(rest: &Corners<'_, L>, of_corner: &mut [L]) {
    let mut sum = [L::splat(0.0); 3];
    for corner in 0..rest.count() {
        let place = rest.position(corner);
        sum = each!(3, axis => sum[axis] + place[axis]);
    }
    let count = L::splat(rest.count() as f64);
    let mean = each!(3, axis => sum[axis] / count);
    for corner in 0..rest.count() {
        let place = rest.position(corner);
        for axis in 0..AXES {
            of_corner[AXES * corner + axis] = place[axis] - mean[axis];
        }
    }
}

/// The energy of each corner (J) with rotations `m`, and α of Eq. (18) (rad/s²).
#[inline(always)]
fn energy<L: Lanes>(shapes: &Shapes<'_, L>, m: &Matrix<L>, stiffness: f64, shares: &mut [L]) -> L {
    let half_k = L::splat(0.5 * stiffness);
    let mut inertia = L::splat(0.0);
    for (corner, share) in shares.iter_mut().enumerate() {
        *share = half_k * square(shapes.displacement(corner, m));
        inertia = shapes.rest.mass(corner).mul_add(square(shapes.rest(corner)), inertia);
    }
    let torque = axial(&turned_back(&shapes.a, m));
    L::splat(stiffness) * square(torque).sqrt() / inertia
}
