//! Rest shapes fitted to elements in lanes, and strains by them, tested against [`Field::Strain`](crate::field::Field::Strain).

use super::rotation::{self, Matrix, Moments, Optimum, Solver};
use crate::body::Body;
use crate::crew::Crew;
use crate::element::Dimension;
use crate::lanes::{Lanes, MOST, Set, Work, each};
use crate::law::{Corners, Reader, alike};
use glam::{DMat3, DQuat, DVec3};
use std::ops::Range;

/// The [strain](crate::field::Field::Strain) of each element with the nodes at `position` (m). Rotations are sought
/// from `near` on: the nearer it is, the faster they are found.
pub(crate) fn strains(set: Set, body: &Body, position: &[DVec3], near: DMat3, crew: &Crew) -> Vec<f64> {
    let near = match body.dimension {
        // Eq. (9) keeps the last angle only where all are equally good.
        Dimension::Plane => [1.0, 0.0, 0.0, 0.0],
        Dimension::Space => DQuat::from_mat3(&near).to_array(),
    };
    crew.map_chunks(body.elements.len(), |range| set.run(Strains { body, position, near, range })).concat()
}

/// Computes the strains of consecutive elements.
struct Strains<'a> {
    body: &'a Body,
    position: &'a [DVec3],
    near: [f64; 4],
    range: Range<usize>,
}

impl Work for Strains<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<f64> {
        let Self { body, position, near, range } = self;
        let near = each!(4, entry => L::splat(near[entry]));
        let mut reader = Reader::<L>::new();
        let mut strains = Vec::with_capacity(range.len());
        let mut at = range.start;
        while at < range.end {
            let (group, count) = alike::<L>(&body.elements, at..range.end);
            reader.read(&group, body, position, None, &[1.0; MOST]);
            let shapes = Shapes::new(reader.now(), reader.rest());
            let m = match body.dimension {
                Dimension::Plane => shapes.in_plane([near[0], near[1]]),
                Dimension::Space => shapes.in_space(Optimum, near),
            };
            let mut off = L::splat(0.0);
            for corner in 0..shapes.rest.count() {
                off = off + square(shapes.displacement(corner, &m));
            }
            strains.extend_from_slice(&(off / shapes.squares).sqrt().to_array()[..count]);
            at += count;
        }
        strains
    }
}

/// The corners of elements relative to their means, and sums over them.
pub(crate) struct Shapes<'a, L> {
    now: Corners<'a, L>,
    pub(crate) rest: Corners<'a, L>,
    middle_now: Middle<L>,
    middle_rest: Middle<L>,
    /// `Σ r R0ᵀ` (m²).
    pub(crate) a: Matrix<L>,
    /// `Σ |R0|²` (m²).
    squares: L,
}

/// The mean of corners, relative to the first, to keep precision far from the origin (m).
#[derive(Clone, Copy)]
struct Middle<L> {
    first: [L; 3],
    mean: [L; 3],
}

impl<L: Lanes> Middle<L> {
    #[inline(always)]
    fn of(corners: &Corners<'_, L>) -> Self {
        let first = corners.position(0);
        let mut sum = [L::splat(0.0); 3];
        for corner in 0..corners.count() {
            let vector = corners.position(corner);
            sum = each!(3, axis => sum[axis] + (vector[axis] - first[axis]));
        }
        let count = L::splat(corners.count() as f64);
        Self { first, mean: each!(3, axis => sum[axis] / count) }
    }

    /// A vector relative to the mean (m).
    #[inline(always)]
    fn to(&self, vector: [L; 3]) -> [L; 3] {
        each!(3, axis => (vector[axis] - self.first[axis]) - self.mean[axis])
    }
}

impl<'a, L: Lanes> Shapes<'a, L> {
    /// Elements now and at rest.
    #[inline(always)]
    pub(crate) fn new(now: Corners<'a, L>, rest: Corners<'a, L>) -> Self {
        let (zero, middle_now, middle_rest) = (L::splat(0.0), Middle::of(&now), Middle::of(&rest));
        let mut shapes = Self { now, rest, middle_now, middle_rest, a: [[zero; 3]; 3], squares: zero };
        let (mut a, mut squares) = (shapes.a, zero);
        for corner in 0..rest.count() {
            let (rest, r) = (shapes.rest(corner), shapes.now(corner));
            a = each!(3, column => each!(3, row => r[row].mul_add(rest[column], a[column][row])));
            squares = squares + square(rest);
        }
        (shapes.a, shapes.squares) = (a, squares);
        shapes
    }

    /// `R0` of a corner (m).
    #[inline(always)]
    pub(crate) fn rest(&self, corner: usize) -> [L; 3] {
        self.middle_rest.to(self.rest.position(corner))
    }

    /// `r` of a corner (m).
    #[inline(always)]
    fn now(&self, corner: usize) -> [L; 3] {
        self.middle_now.to(self.now.position(corner))
    }

    /// The rotations `M` from the last ones, quaternions.
    #[inline(always)]
    pub(crate) fn in_space(&self, solver: impl Solver, last: [L; 4]) -> Matrix<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let scale = (one / self.squares).select(zero.lt(self.squares), one);
        rotation::matrix(solver.follow(Moments { a: &self.a, scale, tally: None }, last, L::ALL), one)
    }

    /// The rotations `M` of Eq. (8) with the angle of Eq. (9), from the last (cos, sin).
    #[inline(always)]
    pub(crate) fn in_plane(&self, last: [L; 2]) -> Matrix<L> {
        let (a, zero, one) = (&self.a, L::splat(0.0), L::splat(1.0));
        let [cosine, sine] = rotation::in_plane([a[0][0] + a[1][1], a[0][1] - a[1][0]], last);
        [[cosine, sine, zero], [-sine, cosine, zero], [zero, zero, one]]
    }

    /// `r − M R0` of a corner (m).
    #[inline(always)]
    pub(crate) fn displacement(&self, corner: usize, m: &Matrix<L>) -> [L; 3] {
        let ([x, y, z], r) = (self.rest(corner), self.now(corner));
        each!(3, row => r[row] - z.mul_add(m[2][row], y.mul_add(m[1][row], x * m[0][row])))
    }
}

/// The square of the length of a vector.
#[inline(always)]
pub(crate) fn square<L: Lanes>([x, y, z]: [L; 3]) -> L {
    z.mul_add(z, y.mul_add(y, x * x))
}
