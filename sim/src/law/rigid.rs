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
    /// `Σ p pᵀ` (m²): xx, yy, zz, xy, xz, yz.
    squares: [L; 6],
    /// `Σ p × v` (m²/s).
    momentum: [L; 3],
}

impl<L: Lanes> Rigid<L> {
    /// Corners are taken to lie on a line if the determinant of their matrix, relative to that of a ball, is below this.
    const LINE: f64 = 1e-12;

    #[inline(always)]
    pub(crate) fn new() -> Self {
        let zero = L::splat(0.0);
        Self { position: [zero; 3], velocity: [zero; 3], squares: [zero; 6], momentum: [zero; 3] }
    }

    /// Adds a corner by its position (m) and velocity (m/s).
    #[inline(always)]
    pub(crate) fn add(&mut self, p: [L; 3], v: [L; 3]) {
        self.position = each!(3, axis => self.position[axis] + p[axis]);
        self.velocity = each!(3, axis => self.velocity[axis] + v[axis]);
        let [x, y, z] = p;
        let [xx, yy, zz, xy, xz, yz] = self.squares;
        self.squares = [
            x.mul_add(x, xx),
            y.mul_add(y, yy),
            z.mul_add(z, zz),
            x.mul_add(y, xy),
            x.mul_add(z, xz),
            y.mul_add(z, yz),
        ];
        let turning = cross(&p, &v);
        self.momentum = each!(3, axis => self.momentum[axis] + turning[axis]);
    }

    /// The mean position (m), the mean velocity (m/s) and the angular velocity (rad/s) of so many corners: `Σ (r² I − r rᵀ) ω = Σ r × v`.
    /// Forces in proportion to the velocities that remain exert no torque.
    #[inline(always)]
    pub(crate) fn motion(&self, corners: usize) -> [[L; 3]; 3] {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (count, part) = (L::splat(corners as f64), L::splat(1.0 / corners as f64));
        let middle = each!(3, axis => self.position[axis] * part);
        let drift = each!(3, axis => self.velocity[axis] * part);
        let ([x, y, z], [xx, yy, zz, xy, xz, yz]) = (middle, self.squares);
        let [x_n, y_n, z_n] = each!(3, axis => middle[axis] * count);
        let (xx, yy, zz) = (x_n.neg_mul_add(x, xx), y_n.neg_mul_add(y, yy), z_n.neg_mul_add(z, zz));
        let (xy, xz, yz) = (x_n.neg_mul_add(y, xy), x_n.neg_mul_add(z, xz), y_n.neg_mul_add(z, yz));
        let of_middle = cross(&[x_n, y_n, z_n], &drift);
        let momentum = each!(3, axis => self.momentum[axis] - of_middle[axis]);
        let squares = xx + yy + zz;
        // The matrix is symmetric, and so are its cofactors.
        let (a, b, c, d, e, f) = (yy + zz, xx + zz, xx + yy, -xy, -xz, -yz);
        let (aa, bb, cc) = (b.mul_sub(c, f * f), a.mul_sub(c, e * e), a.mul_sub(b, d * d));
        let (dd, ee, ff) = (e.mul_sub(f, d * c), d.mul_sub(f, b * e), d.mul_sub(e, a * f));
        let determinant = e.mul_add(ee, d.mul_add(dd, a * aa));
        let is_solid = (L::splat(Self::LINE) * squares * squares * squares).lt(determinant);
        let inverse = one / determinant.select(is_solid, one);
        let [l, m, n] = momentum;
        let spin = [
            ee.mul_add(n, dd.mul_add(m, aa * l)) * inverse,
            ff.mul_add(n, bb.mul_add(m, dd * l)) * inverse,
            cc.mul_add(n, ff.mul_add(m, ee * l)) * inverse,
        ];
        // Rotation about the line itself has no effect; across it the moment is the same about all axes.
        let is_line = zero.lt(squares);
        let of_line = one / squares.select(is_line, one);
        let spin = each!(3, axis => spin[axis].select(is_solid, (momentum[axis] * of_line).select(is_line, zero)));
        [middle, drift, spin]
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
