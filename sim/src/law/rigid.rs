//! The rigid motion of an element that fits its velocities best, for damping that leaves it alone.

use super::Element;
use crate::kernel::rotation::cross;
use crate::lanes::{Lanes, each};

/// Sums over the corners of an element, from which the rigid motion that fits its velocities best follows. Positions and velocities are
/// relative to those of the first corner, to keep precision.
#[derive(Clone, Copy)]
pub(crate) struct Rigid<L> {
    position: [L; 3],
    velocity: [L; 3],
    turning: Turning<L>,
}

/// Sums over vectors `r` and `v`, from which the rotation follows that fits `v` best.
#[derive(Clone, Copy)]
pub(crate) struct Turning<L> {
    /// `Σ r rᵀ` (m²): xx, yy, zz, xy, xz, yz.
    pub(crate) squares: [L; 6],
    /// `Σ r × v` (m²/s).
    pub(crate) momentum: [L; 3],
}

impl<L: Lanes> Turning<L> {
    /// Corners are taken to lie on a line if the determinant of their matrix, relative to that of a ball, is below this.
    const LINE: f64 = 1e-12;

    #[inline(always)]
    pub(crate) fn new() -> Self {
        let zero = L::splat(0.0);
        Self { squares: [zero; 6], momentum: [zero; 3] }
    }

    /// Adds vectors `r` (m) and `v` (m/s), multiplied by any number: `some` is the product of `r` with it.
    #[inline(always)]
    pub(crate) fn add(&mut self, some: [L; 3], r: [L; 3], v: [L; 3]) {
        let ([x, y, z], [xx, yy, zz, xy, xz, yz]) = (some, self.squares);
        self.squares = [
            x.mul_add(r[0], xx),
            y.mul_add(r[1], yy),
            z.mul_add(r[2], zz),
            x.mul_add(r[1], xy),
            x.mul_add(r[2], xz),
            y.mul_add(r[2], yz),
        ];
        let [l, m, n] = self.momentum;
        self.momentum = [
            z.neg_mul_add(v[1], y.mul_add(v[2], l)),
            x.neg_mul_add(v[2], z.mul_add(v[0], m)),
            y.neg_mul_add(v[0], x.mul_add(v[1], n)),
        ];
    }

    /// The angular velocity `ω` (rad/s) with `Σ (r² I − r rᵀ) ω = Σ r × v`. It is the same for all sums multiplied by a number.
    #[inline(always)]
    pub(crate) fn spin(&self) -> [L; 3] {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (momentum, [xx, yy, zz, xy, xz, yz]) = (self.momentum, self.squares);
        let squares = xx + yy + zz;
        // The matrix is symmetric, and so are its cofactors.
        let (a, b, c, d, e, f) = (yy + zz, xx + zz, xx + yy, -xy, -xz, -yz);
        let (aa, bb, cc) = (b.mul_sub(c, f * f), a.mul_sub(c, e * e), a.mul_sub(b, d * d));
        let (dd, ee, ff) = (e.mul_sub(f, d * c), d.mul_sub(f, b * e), d.mul_sub(e, a * f));
        let determinant = e.mul_add(ee, d.mul_add(dd, a * aa));
        let is_solid = (L::splat(Self::LINE) * squares * squares * squares).lt(determinant);
        // Rotation about a line itself has no effect; across it the moment is the same about all axes.
        let inverse = one / determinant.select(is_solid, squares.select(zero.lt(squares), one));
        let [l, m, n] = momentum;
        let spin = [
            ee.mul_add(n, dd.mul_add(m, aa * l)),
            ff.mul_add(n, bb.mul_add(m, dd * l)),
            cc.mul_add(n, ff.mul_add(m, ee * l)),
        ];
        each!(3, axis => spin[axis].select(is_solid, momentum[axis]) * inverse)
    }
}

impl<L: Lanes> Rigid<L> {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        let zero = L::splat(0.0);
        Self { position: [zero; 3], velocity: [zero; 3], turning: Turning::new() }
    }

    /// Adds a corner by its position (m) and velocity (m/s).
    #[inline(always)]
    pub(crate) fn add(&mut self, p: [L; 3], v: [L; 3]) {
        self.position = each!(3, axis => self.position[axis] + p[axis]);
        self.velocity = each!(3, axis => self.velocity[axis] + v[axis]);
        self.turning.add(p, p, v);
    }

    /// The mean position (m), the mean velocity (m/s) and the angular velocity (rad/s) of so many corners. Forces in proportion to the
    /// velocities that remain exert no torque.
    #[inline(always)]
    pub(crate) fn motion(&self, corners: usize) -> [[L; 3]; 3] {
        let (count, part) = (L::splat(corners as f64), L::splat(1.0 / corners as f64));
        let middle = each!(3, axis => self.position[axis] * part);
        let drift = each!(3, axis => self.velocity[axis] * part);
        // The sums about the mean.
        let mut turning = self.turning;
        turning.add(each!(3, axis => -(middle[axis] * count)), middle, drift);
        [middle, drift, turning.spin()]
    }

    /// The same of a whole element, not relative to its first corner.
    #[inline(always)]
    pub(crate) fn of(element: &Element<'_, L>) -> [[L; 3]; 3] {
        let (mut sums, first) = (Self::new(), element.corner(0));
        for corner in 1..element.corners() {
            let (p, v) = element.corner(corner);
            sums.add(each!(3, axis => p[axis] - first.0[axis]), each!(3, axis => v[axis] - first.1[axis]));
        }
        let [middle, drift, spin] = sums.motion(element.corners());
        [each!(3, axis => middle[axis] + first.0[axis]), each!(3, axis => drift[axis] + first.1[axis]), spin]
    }
}

/// The velocity (m/s) at a point (m) relative to that of a rigid motion.
#[inline(always)]
pub(crate) fn off<L: Lanes>([middle, drift, spin]: [[L; 3]; 3], p: [L; 3], v: [L; 3]) -> [L; 3] {
    let turning = cross(&spin, &each!(3, axis => p[axis] - middle[axis]));
    each!(3, axis => v[axis] - drift[axis] - turning[axis])
}
