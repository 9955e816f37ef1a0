//! The rotations of as many elements as there are lanes.
//!
//! With the last rotation `R` and `A = Σ r R0ᵀ` (now × rest), everything follows from `B = RᵀA`, which is the transpose
//! of the matrix of Eq. (15) in the frame of the element: `g = (B32 − B23, B13 − B31, B21 − B12)` is the torque divided
//! by `k`, and `H = tr(B) I − (B + Bᵀ)/2` the Hessian of the energy. Quaternions are (x, y, z, w) and normalised.

use crate::lanes::{Lanes, MOST, each};
use crate::rotation::davenport1968;
use crate::rotation::robust::{MOST_PASSES, SERIES, SHORT, SOUND};
use crate::tally::Tally;
use glam::{DMat3, DQuat};

/// A vector in space, in every lane.
pub(crate) type Vector<L> = [L; 3];
/// The columns of a matrix, in every lane.
pub(crate) type Matrix<L> = [[L; 3]; 3];

/// The input of a rotation, besides the last rotation.
#[derive(Clone, Copy)]
pub(crate) struct Moments<'a, L> {
    /// `Σ r R0ᵀ`.
    pub(crate) a: &'a Matrix<L>,
    /// Makes the entries of `a` at rest about 1, such as `1 / Σ |R0|²`. The result depends on it in round-off only.
    pub(crate) scale: L,
    /// Counts the rotations that need the global solver.
    pub(crate) tally: Option<&'a Tally>,
}

/// A method that computes rotations in lanes.
pub(crate) trait Solver: Copy + Send + Sync + 'static {
    /// Whether most rotations need several passes.
    const ITERATES: bool;

    /// The rotations of elements from their last ones. Elements whose bit is not in `live` keep theirs.
    #[inline(always)]
    fn follow<L: Lanes>(self, of: Moments<'_, L>, last: [L; 4], live: u32) -> [L; 4] {
        let (mut q, mut open) = (last, live);
        for pass in 1..=self.passes() {
            (q, open) = self.step(of, q, open, pass == self.passes());
        }
        q
    }

    /// One pass of [`Self::follow`] from rotations `q`, in the lanes that are `open`. Returns the lanes that are open in
    /// the next pass, too. A caller with several vectors computes each pass for all of them before the next one: a pass
    /// is a long chain of dependent operations, and the processor overlaps those of several vectors.
    #[inline(always)]
    fn step<L: Lanes>(self, of: Moments<'_, L>, q: [L; 4], open: u32, is_last: bool) -> ([L; 4], u32) {
        let ([x, y, z, s], sound, done) = self.pass(&turned_back(of.a, &matrix(q, of.scale)));
        let (next, in_range) = turn(q, [x, y, z], s);
        let sound = open & L::bits(L::both(sound, in_range));
        let failed = open & !sound;
        let mut q = choose(L::mask(sound), next, q);
        let late = if is_last { sound & !L::bits(done) } else { 0 };
        if failed | late != 0 {
            q = self.go_on(of, q, late, failed);
        }
        (q, sound)
    }

    /// The number of passes that most rotations need.
    fn passes(self) -> u32;

    /// One pass for `b = RᵀA`. Returns the increment as a quaternion of any length, the lanes where it is valid as far
    /// as is known before [`turn`], and the lanes where it is the last pass needed.
    fn pass<L: Lanes>(self, b: &[[L; 3]; 3]) -> ([L; 4], L::Mask, L::Mask);

    /// Completes the rotations `q` of these passes: lanes that are `open` need more passes, lanes that
    /// have `failed` need the global solver.
    fn go_on<L: Lanes>(self, of: Moments<'_, L>, q: [L; 4], open: u32, failed: u32) -> [L; 4];
}

/// Eq. (15) as printed, solved in a number of passes, each solution a rotation by `atan |w|`:
/// [`linearised::iterate`](crate::rotation::linearised::iterate) in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arctangent {
    /// The number of passes.
    pub(crate) passes: u32,
}

/// The optimum to round-off, by as many passes of ninth order as needed:
/// [`robust::follow`](crate::rotation::robust::follow) in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Optimum;

impl Solver for Arctangent {
    const ITERATES: bool = true;

    #[inline(always)]
    fn passes(self) -> u32 {
        self.passes
    }

    #[inline(always)]
    fn pass<L: Lanes>(self, b: &[[L; 3]; 3]) -> ([L; 4], L::Mask, L::Mask) {
        (arctangent_turn(b), is_well_posed(b), L::mask(L::ALL))
    }

    #[inline(always)]
    fn go_on<L: Lanes>(self, of: Moments<'_, L>, q: [L; 4], _: u32, failed: u32) -> [L; 4] {
        global(of, q, failed)
    }
}

impl Solver for Optimum {
    const ITERATES: bool = false;

    #[inline(always)]
    fn passes(self) -> u32 {
        1
    }

    #[inline(always)]
    fn pass<L: Lanes>(self, b: &[[L; 3]; 3]) -> ([L; 4], L::Mask, L::Mask) {
        optimum_turn::<L, false>(b)
    }

    #[inline(always)]
    fn go_on<L: Lanes>(self, of: Moments<'_, L>, mut q: [L; 4], open: u32, failed: u32) -> [L; 4] {
        let (mut open, mut failed) = (open | failed, 0);
        for _ in 1..MOST_PASSES {
            let b = turned_back(of.a, &matrix(q, of.scale));
            let (next, sound, last) = optimum_pass(&b, q);
            let sound = L::bits(sound);
            failed |= open & !sound;
            open &= sound;
            // A lane that has converged is not changed, so that its bits do not depend on its neighbours.
            q = choose(L::mask(open), next, q);
            open &= !L::bits(last);
            if open == 0 {
                break;
            }
        }
        if failed | open != 0 {
            q = global(of, q, failed | open);
        }
        q
    }
}

/// Keeps the squares of homogeneous coordinates within the range of doubles.
const RANGE: (f64, f64) = (1e-200, 1e200);

/// `scale` times the matrix of a unit quaternion.
#[inline(always)]
pub(crate) fn matrix<L: Lanes>([x, y, z, w]: [L; 4], scale: L) -> Matrix<L> {
    let twice = scale + scale;
    let (x2, y2, z2) = (twice * x, twice * y, twice * z);
    let (xy, xz, yz) = (x2 * y, x2 * z, y2 * z);
    [
        [y2.neg_mul_add(y, z2.neg_mul_add(z, scale)), z2.mul_add(w, xy), y2.neg_mul_add(w, xz)],
        [z2.neg_mul_add(w, xy), x2.neg_mul_add(x, z2.neg_mul_add(z, scale)), x2.mul_add(w, yz)],
        [y2.mul_add(w, xz), x2.neg_mul_add(w, yz), x2.neg_mul_add(x, y2.neg_mul_add(y, scale))],
    ]
}

/// `RᵀA`, as rows: entry `[i][j]` is in row `i` and column `j`.
#[inline(always)]
pub(crate) fn turned_back<L: Lanes>(a: &Matrix<L>, r: &Matrix<L>) -> [[L; 3]; 3] {
    each!(3, i => each!(3, j => dot(&r[i], &a[j])))
}

/// The scalar product.
#[inline(always)]
pub(crate) fn dot<L: Lanes>(a: &Vector<L>, b: &Vector<L>) -> L {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// The torque divided by `k` (m²), in the frame of the element.
#[inline(always)]
pub(crate) fn axial<L: Lanes>(b: &[[L; 3]; 3]) -> Vector<L> {
    [b[2][1] - b[1][2], b[0][2] - b[2][0], b[1][0] - b[0][1]]
}

/// `q ⊗ (v, s)`, normalised, and whether that was possible.
#[inline(always)]
pub(crate) fn turn<L: Lanes>([x, y, z, w]: [L; 4], [a, b, c]: Vector<L>, s: L) -> ([L; 4], L::Mask) {
    let product = [
        z.neg_mul_add(b, y.mul_add(c, w.mul_add(a, s * x))),
        x.neg_mul_add(c, z.mul_add(a, w.mul_add(b, s * y))),
        y.neg_mul_add(a, x.mul_add(b, w.mul_add(c, s * z))),
        z.neg_mul_add(c, y.neg_mul_add(b, x.neg_mul_add(a, s * w))),
    ];
    let [x, y, z, w] = product;
    let square = w.mul_add(w, z.mul_add(z, y.mul_add(y, x * x)));
    let in_range = L::both(L::splat(RANGE.0).lt(square), square.lt(L::splat(RANGE.1)));
    let inverse = L::splat(1.0).div(square.sqrt());
    (each!(4, part => product[part] * inverse), in_range)
}

/// One solution of Eq. (15), `C w = g` with `C = tr(B) I − Bᵀ`, and the rotation by `atan |w|` about it: the increment as
/// a quaternion of any length.
#[inline(always)]
fn arctangent_turn<L: Lanes>(b: &[[L; 3]; 3]) -> [L; 4] {
    let g = axial(b);
    let c0 = [b[1][1] + b[2][2], -b[0][1], -b[0][2]];
    let c1 = [-b[1][0], b[0][0] + b[2][2], -b[1][2]];
    let c2 = [-b[2][0], -b[2][1], b[0][0] + b[1][1]];
    let c12 = cross(&c1, &c2);
    let determinant = dot(&c0, &c12);
    // Multiplied by the determinant.
    let w = [dot(&g, &c12), dot(&g, &cross(&c2, &c0)), dot(&g, &cross(&c0, &c1))];
    let root = determinant.mul_add(determinant, dot(&w, &w)).sqrt();
    [w[0], w[1], w[2], determinant + root]
}

#[inline(always)]
pub(crate) fn cross<L: Lanes>(a: &Vector<L>, b: &Vector<L>) -> Vector<L> {
    [a[1].mul_sub(b[2], a[2] * b[1]), a[2].mul_sub(b[0], a[0] * b[2]), a[0].mul_sub(b[1], a[1] * b[0])]
}

/// [`linearised::is_well_posed`](crate::rotation::linearised::is_well_posed).
#[inline(always)]
fn is_well_posed<L: Lanes>(b: &[[L; 3]; 3]) -> L::Mask {
    /// As in [`linearised`](crate::rotation::linearised).
    const WELL_POSED: f64 = 1e-9;
    let (hx, hy, hz) = (b[1][1] + b[2][2], b[0][0] + b[2][2], b[0][0] + b[1][1]);
    let half = L::splat(-0.5);
    let (xy, xz, yz) = (half * (b[0][1] + b[1][0]), half * (b[0][2] + b[2][0]), half * (b[1][2] + b[2][1]));
    let size = ((hx.abs() + hy.abs()) + (hz.abs() + xy.abs())) + (xz.abs() + yz.abs());
    let minor = hx.mul_sub(hy, xy * xy);
    let cofactors = [hy.mul_sub(hz, yz * yz), yz.mul_sub(xz, xy * hz), xy.mul_sub(yz, hy * xz)];
    let determinant = dot(&[hx, xy, xz], &cofactors);
    let least = L::splat(WELL_POSED) * size;
    let (second, third) = (least * size, least * size * size);
    L::both(least.lt(hx), L::both(second.lt(minor), third.lt(determinant)))
}

/// Eq. (9): `(cos θ, sin θ)` from numbers proportional to it. Where both are zero all angles are equally good, and the
/// last one is kept.
#[inline(always)]
pub(crate) fn in_plane<L: Lanes>(turn: [L; 2], last: [L; 2]) -> [L; 2] {
    let inverse = L::splat(1.0).div(turn[1].mul_add(turn[1], turn[0] * turn[0]).sqrt());
    let is_sound = L::both(L::splat(0.0).lt(inverse), inverse.le(L::splat(f64::MAX)));
    each!(2, entry => (turn[entry] * inverse).select(is_sound, last[entry]))
}

/// One pass of [`Optimum`], where it is valid, and where it is the last.
#[inline(always)]
fn optimum_pass<L: Lanes>(b: &[[L; 3]; 3], q: [L; 4]) -> ([L; 4], L::Mask, L::Mask) {
    let ([x, y, z, s], sound, short) = optimum_turn::<L, true>(b);
    let (next, in_range) = turn(q, [x, y, z], s);
    (next, L::both(sound, in_range), short)
}

/// The increment of a pass as a quaternion of any length, the lanes where it is valid if it can be normalised, and the
/// lanes where it is the last. From `ANYWHERE` or, which is less work, only where the series converge.
///
/// In homogeneous coordinates, without divisions: with `d = det 2H`, `w = adj(2H) g`, `x = adj(2H) w`, `y = adj(2H) x`,
/// `z = adj(2H) y`, `m = g·w` and `p = |w|²` the increment is
/// `(d⁶ w − m (d⁴ − d² p + p² + m w·x) x + m² (d² − 2 p) y − m³ z, d⁷)`, and far away `(d⁴ (d² + p) w, d⁵ (d² + 2 p))`.
#[inline(always)]
fn optimum_turn<L: Lanes, const ANYWHERE: bool>(b: &[[L; 3]; 3]) -> ([L; 4], L::Mask, L::Mask) {
    let g = axial(b);
    let sums = [b[1][1] + b[2][2], b[0][0] + b[2][2], b[0][0] + b[1][1]];
    // 2H; the off-diagonal entries are stored with opposite signs.
    let [hx, hy, hz] = each!(3, axis => sums[axis] + sums[axis]);
    let (xy, xz, yz) = (b[0][1] + b[1][0], b[0][2] + b[2][0], b[1][2] + b[2][1]);
    // Its adjugate, which is also symmetric.
    let (axx, ayy, azz) = (hy.mul_sub(hz, yz * yz), hx.mul_sub(hz, xz * xz), hx.mul_sub(hy, xy * xy));
    let (axy, axz, ayz) = (xz.mul_add(yz, xy * hz), xy.mul_add(yz, xz * hy), xy.mul_add(xz, yz * hx));
    let d = xz.neg_mul_add(axz, xy.neg_mul_add(axy, hx * axx));
    let adjugate = [[axx, axy, axz], [axy, ayy, ayz], [axz, ayz, azz]];
    let w = each!(3, row => dot(&adjugate[row], &g));
    let (m, square) = (dot(&g, &w), dot(&w, &w));
    let x = each!(3, row => dot(&adjugate[row], &w));
    let y = each!(3, row => dot(&adjugate[row], &x));
    let z = each!(3, row => dot(&adjugate[row], &y));
    let d2 = d * d;
    let d6 = d2 * d2 * d2;
    let first = m * m.mul_add(dot(&w, &x), (d2 - square).mul_add(d2, square * square));
    let m2 = m * m;
    let (second, third) = (m2 * (d2 - (square + square)), m2 * m);
    let v = each!(3, row => {
        third.neg_mul_add(z[row], second.mul_add(y[row], first.neg_mul_add(x[row], d6 * w[row])))
    });
    let near = square.le(L::splat(SERIES) * d2);
    let mut turn = [v[0], v[1], v[2], d6 * d];
    if ANYWHERE {
        let d4 = d2 * d2;
        let (long, scalar) = (d4 * (d2 + square), d4 * d * (d2 + (square + square)));
        turn = choose(near, turn, [long * w[0], long * w[1], long * w[2], scalar]);
    }
    let trace = (hx + hy) + hz;
    let cube = trace * trace * trace;
    let zero = L::splat(0.0);
    let definite = L::both(zero.lt(hx), L::both(zero.lt(azz), (L::splat(SOUND) * cube).lt(d)));
    let sound = if ANYWHERE { definite } else { L::both(definite, near) };
    // |v₀|² ≤ SHORT · 27 d / tr³, with v₀ = w/d.
    let short = (square * cube).le(L::splat(27.0 * SHORT) * d * d2);
    (turn, sound, short)
}

#[inline(always)]
pub(crate) fn choose<L: Lanes>(mask: L::Mask, a: [L; 4], b: [L; 4]) -> [L; 4] {
    each!(4, part => a[part].select(mask, b[part]))
}

/// The optimum nearest to `last`, in the lanes whose bits are set.
#[inline(always)]
fn global<L: Lanes>(of: Moments<'_, L>, last: [L; 4], lanes: u32) -> [L; 4] {
    let a = each!(3, column => each!(3, row => of.a[column][row].to_array()));
    let mut q = each!(4, part => last[part].to_array());
    global_of_arrays(&a, &mut q, lanes, of.tally);
    each!(4, part => L::from_array(q[part]))
}

#[cold]
#[inline(never)]
fn global_of_arrays(a: &[[[f64; MOST]; 3]; 3], q: &mut [[f64; MOST]; 4], lanes: u32, tally: Option<&Tally>) {
    tally.inspect(|tally| tally.add(lanes));
    for lane in (0..MOST).filter(|lane| lanes >> lane & 1 == 1) {
        // The solver takes the transpose of `a`.
        let at_rest = DMat3::from_cols_array_2d(&[0, 1, 2].map(|row| [0, 1, 2].map(|column| a[column][row][lane])));
        let last = DQuat::from_array([0, 1, 2, 3].map(|part| q[part][lane]));
        let found = davenport1968::optimum(at_rest, last).to_array();
        (0..4).for_each(|part| q[part][lane] = found[part]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Set, Work};
    use crate::noise::Noise;
    use crate::rotation::{linearised, robust};
    use glam::DVec3;

    /// Computes the rotations of elements, one vector after the other.
    struct Follow<'a, S>(S, &'a [(DMat3, DQuat)], &'a Tally);

    impl<S: Solver> Work for Follow<'_, S> {
        type Output = Vec<DQuat>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<DQuat> {
            let mut found = Vec::new();
            for some in self.1.chunks(L::WIDTH) {
                let lane = |of: &dyn Fn(&(DMat3, DQuat)) -> f64| {
                    L::from_array(std::array::from_fn(|at| some.get(at).map_or(0.0, of)))
                };
                // The columns of `Σ R0 rᵀ` are the rows of `a`.
                let a = [0, 1, 2].map(|column: usize| [0, 1, 2].map(|row: usize| lane(&|one| one.0.col(row)[column])));
                let q = [0, 1, 2, 3].map(|part: usize| lane(&|one| one.1.to_array()[part]));
                let of = Moments { a: &a, scale: L::splat(1.0), tally: Some(self.2) };
                let q = self.0.follow(of, q, (1 << some.len()) - 1).map(L::to_array);
                found.extend((0..some.len()).map(|at| DQuat::from_array([0, 1, 2, 3].map(|part: usize| q[part][at]))));
            }
            found
        }
    }

    /// Twice the sine of half the angle between two rotations.
    fn angle(a: DQuat, b: DQuat) -> f64 {
        2.0 * (a * b.conjugate()).xyz().length()
    }

    fn quaternion(random: &mut Noise, size: f64) -> DQuat {
        DQuat::from_vec4((random.vector() * size).extend(1.0)).normalize()
    }

    /// Moments of many kinds of elements, each with an initial rotation: well-shaped and rotated a little, rotated far,
    /// squeezed, turned inside out, flat, on a line, at a point.
    fn all_sorts(largest_turn: f64) -> Vec<(DMat3, DQuat)> {
        let mut random = Noise(3);
        let stretches = [
            DVec3::ONE,
            DVec3::new(1.0, 0.8, 0.6),
            DVec3::new(2.0, 0.5, 0.2),
            DVec3::new(1.0, 0.1, 0.1),
            DVec3::new(1.0, 1.0, -0.5),
            DVec3::new(1.0, 0.3, -0.25),
            DVec3::new(1.0, 0.9, -0.9),
            DVec3::new(1.0, 0.7, 0.0),
            DVec3::X,
            DVec3::ZERO,
            DVec3::ONE * 1e-60,
            DVec3::ONE * 1e-9,
        ];
        (0..4800)
            .map(|at| {
                let axes = DMat3::from_quat(quaternion(&mut random, 2.0));
                let stretch = axes * DMat3::from_diagonal(stretches[at % stretches.len()]) * axes.transpose();
                let turn = quaternion(&mut random, 3.0);
                let last = (turn * quaternion(&mut random, largest_turn)).normalize();
                ((DMat3::from_quat(turn) * stretch).transpose(), last)
            })
            .collect()
    }

    /// Whether the optimum is unique and not sensitive to small errors of `at_rest`.
    fn is_decided(at_rest: DMat3) -> bool {
        let s = DMat3::from_quat(davenport1968::optimum(at_rest, DQuat::IDENTITY)) * at_rest;
        let trace = s.x_axis.x + s.y_axis.y + s.z_axis.z;
        let hessian = DMat3::from_diagonal(DVec3::splat(trace)) - s;
        hessian.determinant() > 1e-3 * trace * trace * trace
    }

    /// The rotations, and how many of them needed the global solver.
    fn assert_same_for_all<S: Solver>(solver: S, elements: &[(DMat3, DQuat)]) -> (Vec<DQuat>, u64) {
        let run = |set: Set, elements: &[(DMat3, DQuat)]| {
            let tally = Tally::default();
            (set.run(Follow(solver, elements, &tally)), tally.get())
        };
        let found = run(Set::best(), elements);
        for set in Set::all() {
            assert_eq!(run(set, elements), found, "{set:?}");
        }
        // Neighbours have no influence either.
        let backwards: Vec<_> = elements.iter().copied().rev().collect();
        let mut again = run(Set::best(), &backwards);
        again.0.reverse();
        assert_eq!(again, found);
        assert!(found.0.iter().all(|q| (q.length_squared() - 1.0).abs() < 1e-15));
        found
    }

    #[test]
    fn eq_15_as_printed_is_that_of_the_reference() {
        for largest_turn in [0.01, 0.3, 3.0] {
            let elements = all_sorts(largest_turn);
            for passes in [1, 2, 3] {
                let (found, _) = assert_same_for_all(Arctangent { passes }, &elements);
                for (&(at_rest, last), found) in elements.iter().zip(found) {
                    let of = |a| linearised::rotation_by_arctangent(linearised::solve(a));
                    let reference = linearised::iterate(at_rest, last, passes, of).rotation;
                    let tolerance = if is_decided(at_rest) { 1e-13 } else { continue };
                    assert!(angle(found, reference) < tolerance, "{at_rest} {last}: {}", angle(found, reference));
                }
            }
        }
    }

    #[test]
    fn the_optimum_is_found_from_anywhere() {
        for largest_turn in [0.001, 0.003, 0.01, 0.1, 0.5, 3.0] {
            let elements = all_sorts(largest_turn);
            let (found, globals) = assert_same_for_all(Optimum, &elements);
            assert!(globals > 0);
            for (&(at_rest, last), found) in elements.iter().zip(found) {
                let optimum = davenport1968::optimum(at_rest, last);
                let trace = |q| {
                    let a = DMat3::from_quat(q) * at_rest;
                    a.x_axis.x + a.y_axis.y + a.z_axis.z
                };
                let size = at_rest.to_cols_array().iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
                assert!(trace(found) >= trace(optimum) - 1e-11 * size, "{at_rest} {last}");
                if is_decided(at_rest) {
                    assert!(angle(found, optimum) < 1e-13, "{at_rest} {last}: {}", angle(found, optimum));
                    let plain = robust::follow(at_rest, last).rotation;
                    assert!(angle(found, plain) < 1e-13, "{at_rest} {last}: {}", angle(found, plain));
                }
            }
        }
    }

    #[test]
    fn one_pass_takes_the_error_to_its_ninth_power() {
        /// One pass from a rotation (rad) about an oblique axis.
        struct Pass(DMat3, DQuat);
        impl Work for Pass {
            type Output = (DQuat, bool, bool);
            #[inline(always)]
            fn run<L: Lanes>(self) -> Self::Output {
                let a = [0, 1, 2].map(|column: usize| [0, 1, 2].map(|row: usize| L::splat(self.0.col(row)[column])));
                let q = self.1.to_array().map(L::splat);
                let (q, sound, last) = optimum_pass(&turned_back(&a, &matrix(q, L::splat(1.0))), q);
                (DQuat::from_array(q.map(|part| part.to_array()[0])), L::bits(sound) != 0, L::bits(last) != 0)
            }
        }
        let stretch = DMat3::from_cols_array(&[1.1, 0.05, -0.02, 0.05, 0.9, 0.03, -0.02, 0.03, 0.8]);
        for (turn, least, most, last) in
            [(0.3, 2e-7, 2e-6, false), (0.1, 1e-11, 1e-10, false), (0.03, 0.0, 3e-15, false), (0.01, 0.0, 3e-15, true)]
        {
            let axis = DVec3::new(1.0, 2.0, -0.5).normalize() * (0.5f64 * turn);
            let start = DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0).normalize();
            let (found, sound, is_last) = Set::best().run(Pass(stretch, start));
            let error = angle(found, DQuat::IDENTITY);
            assert!((least..=most).contains(&error) && sound && is_last == last, "{turn}: {error}");
        }
    }

    #[test]
    fn what_is_not_live_keeps_its_rotation() {
        struct Idle;
        impl Work for Idle {
            type Output = ();
            #[inline(always)]
            fn run<L: Lanes>(self) {
                let nan = [[L::splat(f64::NAN); 3]; 3];
                let q = [0.5, -0.5, 0.1, 0.7].map(L::splat);
                let of = Moments { a: &nan, scale: L::splat(1.0), tally: None };
                let found = [Optimum.follow(of, q, 0), Arctangent { passes: 2 }.follow(of, q, 0)];
                for found in found {
                    assert_eq!(found.map(L::to_array), q.map(L::to_array));
                }
            }
        }
        Set::all().for_each(|set| set.run(Idle));
    }
}
