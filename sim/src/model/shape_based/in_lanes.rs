//! Eq. (4) in lanes: the laws of elements in space and in the plane, with or without damping, with or without linear maps.
//!
//! With `w = k P + D V` the force of an element on a corner is `−w + w̄ + k M R0`. The first term is computed once for each node. As
//! `Σ R0 = 0` the moments need no centroid. With maps `F` it is `−w + w̄ + k (M − (1 − β) F) R0` and a force of the volume, with `w = β k P + D V`:
//! they cost no more for each corner.

use super::ShapeBased;
use super::affine::AtRest;
use crate::body::Body;
use crate::element::Dimension;
use crate::kernel::damped::{DEFORMING, NONE, RELATIVE};
use crate::kernel::rotation::{self, Arctangent, Matrix, Moments, Optimum, Solver, axial, cross, turned_back};
use crate::kernel::shapes::{Shapes, square};
use crate::kernel::{Compiled, Conditions, Rotation, Stepper};
use crate::lanes::{Lanes, MOST, each};
use crate::law::{Breaking, ByLaw, Corners, Element, Law, Rigid, Strained};
use crate::model::continuum::{cofactors, dot, product};
use glam::DMat3;
use std::sync::Arc;

/// The code of a model by the law of its elements, or with a faster stepper, if there is one.
pub(super) fn compile(
    model: &ShapeBased,
    rotation: Rotation,
    body: &Arc<Body>,
    conditions: &Conditions,
    faster: Option<Box<dyn Stepper>>,
) -> Compiled {
    /// With a solver of rotations in space, without maps. Energies do not depend on damping.
    fn in_space<S: Solver>(
        solver: S,
        of: Common,
        body: &Arc<Body>,
        conditions: &Conditions,
        faster: Option<Box<dyn Stepper>>,
    ) -> Compiled {
        let energy = ByLaw::with(conditions.set, InSpace::<S, false, ANY> { of: of.clone(), solver }, body);
        let stepper = faster.unwrap_or_else(|| match of.damped {
            NONE => Compiled::full(InSpace::<S, false, NONE> { of, solver }, body, conditions),
            RELATIVE => Compiled::full(InSpace::<S, false, RELATIVE> { of, solver }, body, conditions),
            _ => Compiled::filled(InSpace::<S, false, DEFORMING> { of, solver }, body, conditions),
        });
        Compiled { stepper, energy: Box::new(energy) }
    }
    let of = Common::new(model, body.dimension);
    match (body.dimension, rotation, model.fits_maps()) {
        (Dimension::Plane, _, false) if of.damped != DEFORMING => {
            let energy = ByLaw::with(conditions.set, InPlane::<false, ANY> { of: of.clone() }, body);
            let stepper = faster.unwrap_or_else(|| match of.damped {
                NONE => Compiled::full(InPlane::<false, NONE> { of }, body, conditions),
                _ => Compiled::full(InPlane::<false, RELATIVE> { of }, body, conditions),
            });
            Compiled { stepper, energy: Box::new(energy) }
        }
        (Dimension::Plane, ..) => Compiled::once(InPlane::<true, ANY> { of }, body, conditions),
        (_, Rotation::Optimum, false) => in_space(Optimum, of, body, conditions, faster),
        (_, Rotation::Arctangent { passes }, false) => in_space(Arctangent { passes }, of, body, conditions, faster),
        // Whoever asks for maps has exact rotations, or the reference code.
        (.., true) => {
            let law = InSpace::<Optimum, true, ANY> { of, solver: Optimum };
            let energy = ByLaw::with(conditions.set, law.clone(), body);
            let stepper = faster.unwrap_or_else(|| Compiled::filled(law, body, conditions));
            Compiled { stepper, energy: Box::new(energy) }
        }
    }
}

/// Any of the velocities that are damped: it costs a test, and is one law instead of three.
const ANY: u8 = 3;
/// The same in elements that break, which know their rotation after all passes.
const BREAKING: u8 = 4;

/// The code of a model whose elements break at a strain. Laws with maps are about all of them.
pub(super) fn compile_breaking(model: &ShapeBased, limit: f64, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
    let of = Common::new(model, body.dimension);
    if body.dimension == Dimension::Plane {
        let law = InPlane::<true, ANY> { of };
        return Compiled::once(Breaking { law, limit }, body, conditions);
    }
    let law = InSpace::<Optimum, true, BREAKING> { of, solver: Optimum };
    Compiled::once(Breaking { law, limit }, body, conditions)
}

/// The numbers of a model.
#[derive(Clone)]
pub(super) struct Common {
    /// `k` (N/m).
    stiffness: f64,
    /// `D` (N s/m).
    damping: f64,
    /// `β`.
    bending: f64,
    /// `λ/μ`.
    volume: f64,
    /// The velocity that is damped.
    damped: u8,
    /// Decides the relative stiffness of elements.
    model: Arc<ShapeBased>,
}

impl Common {
    fn new(model: &ShapeBased, dimension: Dimension) -> Self {
        let &ShapeBased { stiffness, damping, bending, .. } = model;
        let (volume, damped) = (model.volume(dimension), model.damped());
        Self { stiffness, damping, bending, volume, damped, model: Arc::new(model.clone()) }
    }

    /// Whether a law damps this velocity.
    #[inline(always)]
    fn damps<const DAMPING: u8>(&self, velocity: u8) -> bool {
        DAMPING == velocity || DAMPING >= ANY && self.damped == velocity
    }

    /// `k` and `D` of the forces of a node.
    #[inline(always)]
    fn of_node<const MAPS: bool, const DAMPING: u8>(&self) -> [f64; 2] {
        [
            if MAPS { self.bending * self.stiffness } else { self.stiffness },
            if self.damps::<DAMPING>(NONE) { 0.0 } else { self.damping },
        ]
    }
}

/// Elements in space. With `MAPS` forces depend on the linear map of an element, too.
#[derive(Clone)]
pub(super) struct InSpace<S, const MAPS: bool, const DAMPING: u8> {
    of: Common,
    solver: S,
}

/// Elements in the plane, with the rotation of Eq. (9).
#[derive(Clone)]
pub(super) struct InPlane<const MAPS: bool, const DAMPING: u8> {
    of: Common,
}

/// What an element in space knows.
#[derive(Clone, Copy)]
pub(super) struct Fit<L> {
    /// `w̄` (N).
    mean: [L; 3],
    /// `Σ r R0ᵀ` (m²), and after all passes `k M` (N/m).
    matrix: Matrix<L>,
    /// `D ω` (N/m), if damping leaves rotation alone.
    spin: [L; 3],
    /// The rotation before a pass, if there are several; of elements that break, after all passes that of the element.
    turn: [L; 4],
    /// The lanes that take part in the next pass.
    open: u32,
}

impl<S: Solver, const MAPS: bool, const DAMPING: u8> Law for InSpace<S, MAPS, DAMPING> {
    /// `1 / Σ |R0|²` (1/m²). With maps, also `M⁻¹` (1/m²): xx, yy, zz, xy, xz, yz; and the elastic constant of the volume (J).
    const OF_ELEMENT: usize = if MAPS { 8 } else { 1 };
    /// `R0` (m).
    const OF_CORNER: usize = 3;
    /// The rotation, a quaternion.
    const MEMORY: usize = 4;
    const HAS_RESIDUAL: bool = true;
    type Whole<L: Lanes> = Fit<L>;

    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        self.of.model.relative_stiffness(body)
    }

    fn is_damped(&self) -> bool {
        !self.of.damps::<DAMPING>(NONE)
    }

    fn of_node(&self) -> [f64; 2] {
        self.of.of_node::<MAPS, DAMPING>()
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
        if MAPS {
            let mut moment = [zero; 6];
            for corner in 0..rest.count() {
                let [x, y, z] = each!(3, axis => of_corner[3 * corner + axis]);
                let products = [x * x, y * y, z * z, x * y, x * z, y * z];
                for entry in 0..6 {
                    moment[entry] = moment[entry] + products[entry];
                }
            }
            self.of.maps(Dimension::Space, moment, &mut of_element[1..]);
        }
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> Fit<L> {
        let corners = element.corners() as f64;
        let [k, d] = self.of.of_node::<MAPS, DAMPING>();
        let (zero, (k, k_mean, d_mean)) = (L::splat(0.0), (L::splat(k), L::splat(k / corners), L::splat(d / corners)));
        let (mut position, mut velocity, mut a) = ([zero; 3], [zero; 3], [[zero; 3]; 3]);
        let (mut first, mut slow, mut rigid) = ([zero; 3], [zero; 3], Rigid::new());
        for corner in 0..element.corners() {
            let (p, v) = element.corner(corner);
            if corner == 0 {
                (first, slow) = (p, v);
            }
            // Relative to the first corner, so that an element with all corners at one point gives exactly zero.
            let p = each!(3, axis => p[axis] - first[axis]);
            if self.of.damps::<DAMPING>(DEFORMING) {
                rigid.add(p, each!(3, axis => v[axis] - slow[axis]));
            }
            for axis in 0..3 {
                position[axis] = position[axis] + p[axis];
                if self.of.damps::<DAMPING>(RELATIVE) {
                    velocity[axis] = velocity[axis] + v[axis];
                }
                let rest = element.of_corner(corner, axis);
                a[axis] = each!(3, row => p[row].mul_add(rest, a[axis][row]));
            }
        }
        let mut mean = each!(3, axis => position[axis].mul_add(k_mean, first[axis] * k));
        let mut spin = [zero; 3];
        if self.of.damps::<DAMPING>(RELATIVE) {
            mean = each!(3, axis => velocity[axis].mul_add(d_mean, mean[axis]));
        }
        if self.of.damps::<DAMPING>(DEFORMING) {
            let ([middle, drift, turning], d) = (rigid.motion(element.corners()), L::splat(d));
            let still = cross(&turning, &each!(3, axis => middle[axis] + first[axis]));
            mean = each!(3, axis => (drift[axis] + slow[axis] - still[axis]).mul_add(d, mean[axis]));
            spin = each!(3, axis => turning[axis] * d);
        }
        let (turn, open) = if S::ITERATES { (element.memory(), element.live()) } else { ([zero; 4], 0) };
        Fit { mean, matrix: a, spin, turn, open }
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
            fit.matrix = rotation::matrix(turn, L::splat(self.of.stiffness));
            if DAMPING == BREAKING {
                fit.turn = turn;
            }
            if MAPS {
                let (map, pressure, _) = self.of.stretch(&a, &each!(8, at => element.of_element(at)));
                let rest = L::splat((self.of.bending - 1.0) * self.of.stiffness);
                fit.matrix = each!(3, column => each!(3, row => {
                    map[column][row].mul_add(rest, fit.matrix[column][row] - pressure[column][row])
                }));
            }
        } else {
            (fit.turn, fit.open) = (turn, open);
        }
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, fit: &Fit<L>) -> [L; 3] {
        let Fit { mean, matrix: m, spin, .. } = fit;
        let [x, y, z] = each!(3, axis => element.of_corner(corner, axis));
        let force = each!(3, axis => z.mul_add(m[2][axis], y.mul_add(m[1][axis], x.mul_add(m[0][axis], mean[axis]))));
        if !self.of.damps::<DAMPING>(DEFORMING) {
            return force;
        }
        let (p, _) = element.corner(corner);
        let turning = cross(spin, &p);
        each!(3, axis => force[axis] + turning[axis])
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let shapes = Shapes::new(element.corners, *rest);
        let m = shapes.in_space(self.solver, element.memory());
        let residual = energy(&shapes, &m, self.of.stiffness, shares);
        if MAPS {
            let (map, _, volume) = self.of.stretch(&shapes.a, &each!(8, at => element.of_element(at)));
            self.of.bent(&shapes, &m, &map, volume, shares);
        }
        residual
    }
}

impl<const MAPS: bool, const DAMPING: u8> Law for InPlane<MAPS, DAMPING> {
    /// With maps as in space, with an entry before them that is not used.
    const OF_ELEMENT: usize = if MAPS { 8 } else { 0 };
    /// `R0` (m).
    const OF_CORNER: usize = 2;
    /// The rotation, (cos θ, sin θ).
    const MEMORY: usize = 2;
    const HAS_RESIDUAL: bool = true;
    type Whole<L: Lanes> = FitInPlane<L>;

    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        self.of.model.relative_stiffness(body)
    }

    fn is_damped(&self) -> bool {
        !self.of.damps::<DAMPING>(NONE)
    }

    fn of_node(&self) -> [f64; 2] {
        self.of.of_node::<MAPS, DAMPING>()
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        relative_to_mean::<L, 2>(rest, of_corner);
        if MAPS {
            let mut moment = [L::splat(0.0); 6];
            for corner in 0..rest.count() {
                let [x, y] = each!(2, axis => of_corner[2 * corner + axis]);
                moment[0] = moment[0] + x * x;
                moment[1] = moment[1] + y * y;
                moment[3] = moment[3] + x * y;
            }
            of_element[0] = L::splat(0.0);
            self.of.maps(Dimension::Plane, moment, &mut of_element[1..]);
        }
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> FitInPlane<L> {
        let corners = element.corners() as f64;
        let [k, d] = self.of.of_node::<MAPS, DAMPING>();
        let (zero, (k, k_mean, d_mean)) = (L::splat(0.0), (L::splat(k), L::splat(k / corners), L::splat(d / corners)));
        let (mut position, mut velocity, mut turn) = ([zero; 2], [zero; 2], [zero; 2]);
        let (mut first, mut slow, mut rigid) = ([zero; 2], [zero; 2], Rigid::new());
        // Out of the plane the map is 1.
        let mut a = [[zero; 3], [zero; 3], [zero, zero, L::splat(1.0)]];
        for corner in 0..element.corners() {
            let (p, v) = element.corner_in_plane(corner);
            let [x, y] = each!(2, axis => element.of_corner(corner, axis));
            if corner == 0 {
                (first, slow) = (p, v);
            }
            let [px, py] = each!(2, axis => p[axis] - first[axis]);
            position = [position[0] + px, position[1] + py];
            if self.of.damps::<DAMPING>(RELATIVE) {
                velocity = [velocity[0] + v[0], velocity[1] + v[1]];
            }
            if self.of.damps::<DAMPING>(DEFORMING) {
                rigid.add([px, py, zero], [v[0] - slow[0], v[1] - slow[1], zero]);
            }
            if MAPS {
                a[0] = [px.mul_add(x, a[0][0]), py.mul_add(x, a[0][1]), zero];
                a[1] = [px.mul_add(y, a[1][0]), py.mul_add(y, a[1][1]), zero];
            }
            turn[0] = y.mul_add(py, x.mul_add(px, turn[0]));
            turn[1] = y.neg_mul_add(px, x.mul_add(py, turn[1]));
        }
        let turn = rotation::in_plane(turn, element.memory());
        element.remember(turn);
        let mut mean = each!(2, axis => position[axis].mul_add(k_mean, first[axis] * k));
        if self.of.damps::<DAMPING>(RELATIVE) {
            mean = each!(2, axis => velocity[axis].mul_add(d_mean, mean[axis]));
        }
        let mut spin = zero;
        if self.of.damps::<DAMPING>(DEFORMING) {
            let ([middle, drift, [_, _, turning]], d) = (rigid.motion(element.corners()), L::splat(d));
            let [x, y] = each!(2, axis => middle[axis] + first[axis]);
            let still = [-(turning * y), turning * x];
            mean = each!(2, axis => (drift[axis] + slow[axis] - still[axis]).mul_add(d, mean[axis]));
            spin = turning * d;
        }
        let k = L::splat(self.of.stiffness);
        let [cosine, sine] = each!(2, axis => turn[axis] * k);
        let mut matrix = [[cosine, sine], [-sine, cosine]];
        if MAPS {
            let (map, pressure, _) = self.of.stretch(&a, &each!(8, at => element.of_element(at)));
            let rest = L::splat((self.of.bending - 1.0) * self.of.stiffness);
            matrix = each!(2, column => each!(2, row => {
                map[column][row].mul_add(rest, matrix[column][row] - pressure[column][row])
            }));
        }
        FitInPlane { mean, matrix, spin }
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, fit: &FitInPlane<L>) -> [L; 3] {
        let FitInPlane { mean: [wx, wy], matrix: [[cosine, sine], [other_sine, other_cosine]], spin } = *fit;
        let [x, y] = each!(2, axis => element.of_corner(corner, axis));
        let mut fx = y.mul_add(other_sine, x.mul_add(cosine, wx));
        let mut fy = y.mul_add(other_cosine, x.mul_add(sine, wy));
        if self.of.damps::<DAMPING>(DEFORMING) {
            let ([px, py], _) = element.corner_in_plane(corner);
            (fx, fy) = (spin.neg_mul_add(py, fx), spin.mul_add(px, fy));
        }
        [fx, fy, L::splat(0.0)]
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let shapes = Shapes::new(element.corners, *rest);
        let m = shapes.in_plane(element.memory());
        let residual = energy(&shapes, &m, self.of.stiffness, shares);
        if MAPS {
            let [x, y, _] = shapes.a;
            let a = [x, y, [L::splat(0.0), L::splat(0.0), L::splat(1.0)]];
            let (map, _, volume) = self.of.stretch(&a, &each!(8, at => element.of_element(at)));
            self.of.bent(&shapes, &m, &map, volume, shares);
        }
        residual
    }
}

impl<S: Solver> Strained for InSpace<S, true, BREAKING> {
    #[inline(always)]
    fn strain<L: Lanes>(&self, element: &Element<'_, L>, fit: &Fit<L>) -> L {
        strain::<L, 3>(element, &rotation::matrix(fit.turn, L::splat(1.0)))
    }
}

impl<const DAMPING: u8> Strained for InPlane<true, DAMPING> {
    #[inline(always)]
    fn strain<L: Lanes>(&self, element: &Element<'_, L>, _: &FitInPlane<L>) -> L {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let ((first, _), mut turn) = (element.corner_in_plane(0), [zero; 2]);
        for corner in 1..element.corners() {
            let (p, _) = element.corner_in_plane(corner);
            let ([px, py], [x, y]) =
                (each!(2, axis => p[axis] - first[axis]), each!(2, axis => element.of_corner(corner, axis)));
            turn[0] = y.mul_add(py, x.mul_add(px, turn[0]));
            turn[1] = y.neg_mul_add(px, x.mul_add(py, turn[1]));
        }
        let [cosine, sine] = rotation::in_plane(turn, element.memory());
        strain::<L, 2>(element, &[[cosine, sine, zero], [-sine, cosine, zero], [zero, zero, one]])
    }
}

/// `√(Σ |r − M R0|² / Σ |R0|²)` with rotations `m`.
#[inline(always)]
fn strain<L: Lanes, const AXES: usize>(element: &Element<'_, L>, m: &Matrix<L>) -> L {
    let (zero, part, (first, _)) = (L::splat(0.0), L::splat(1.0 / element.corners() as f64), element.corner(0));
    let (mut middle, mut off, mut squares) = ([zero; 3], zero, zero);
    for corner in 1..element.corners() {
        let (p, _) = element.corner(corner);
        middle = each!(3, axis => (p[axis] - first[axis]).mul_add(part, middle[axis]));
    }
    for corner in 0..element.corners() {
        let (p, _) = element.corner(corner);
        let [x, y] = each!(2, axis => element.of_corner(corner, axis));
        let z = if AXES == 3 { element.of_corner(corner, 2) } else { zero };
        let displacement = each!(3, row => {
            p[row] - first[row] - middle[row] - z.mul_add(m[2][row], y.mul_add(m[1][row], x * m[0][row]))
        });
        (off, squares) = (off + square(displacement), squares + square([x, y, z]));
    }
    (off / squares).sqrt()
}

/// What an element in the plane knows.
#[derive(Clone, Copy)]
pub(super) struct FitInPlane<L> {
    /// `w̄` (N).
    mean: [L; 2],
    /// `k` times the rotation (N/m), its columns.
    matrix: [[L; 2]; 2],
    /// `D ω` (N/m), if damping leaves rotation alone.
    spin: L,
}

impl Common {
    /// The constants of maps, from `M` (m²): xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    fn maps<L: Lanes>(&self, dimension: Dimension, moment: [L; 6], constants: &mut [L]) {
        let moment = each!([0, 1, 2, 3, 4, 5], entry => moment[entry].to_array());
        let mut rows = [[0.0; MOST]; 7];
        for lane in 0..MOST {
            let [xx, yy, zz, xy, xz, yz] = each!([0, 1, 2, 3, 4, 5], entry => moment[entry][lane]);
            let matrix = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
            let AtRest { inverse: m, size, .. } = AtRest::of_moment(matrix, dimension);
            let plane = if dimension == Dimension::Plane { 1.0 } else { 0.0 };
            let energy = self.volume * size * self.stiffness;
            let of_lane = [m.x_axis.x, m.y_axis.y, m.z_axis.z + plane, m.x_axis.y, m.x_axis.z, m.y_axis.z, energy];
            rows.iter_mut().zip(of_lane).for_each(|(row, value)| row[lane] = value);
        }
        for (constant, row) in constants.iter_mut().zip(rows) {
            *constant = L::from_array(row);
        }
    }

    /// The linear map of elements with `A = Σ r R0ᵀ` (m²) and the constants of maps; the matrix that gives the force of the volume on a corner as `−matrix · R0` (N/m), and the
    /// energy of the volume (J).
    #[inline(always)]
    fn stretch<L: Lanes>(&self, a: &Matrix<L>, constants: &[L; 8]) -> (Matrix<L>, Matrix<L>, L) {
        let [_, xx, yy, zz, xy, xz, yz, weight] = *constants;
        let inverse = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let map = product(a, &inverse);
        if self.volume == 0.0 {
            let zero = L::splat(0.0);
            return (map, [[zero; 3]; 3], zero);
        }
        let cofactors = cofactors(&map);
        let excess = dot(&map[0], &cofactors[0]) - L::splat(1.0);
        let pressure = weight * excess;
        let force = product(&each!(3, column => each!(3, row => cofactors[column][row] * pressure)), &inverse);
        (map, force, L::splat(0.5) * pressure * excess)
    }

    /// Replaces the energies of corners (J) by those with this model's bending, and adds that of the volume.
    #[inline(always)]
    fn bent<L: Lanes>(&self, shapes: &Shapes<'_, L>, m: &Matrix<L>, map: &Matrix<L>, volume: L, shares: &mut [L]) {
        let half_k = L::splat(0.5 * self.stiffness);
        let (bending, each_volume) = (L::splat(self.bending), volume / L::splat(shares.len() as f64));
        for (corner, share) in shares.iter_mut().enumerate() {
            let (off, whole) = (shapes.displacement(corner, map), shapes.displacement(corner, m));
            let affine = square(each!(3, axis => whole[axis] - off[axis]));
            *share = half_k.mul_add(bending.mul_add(square(off), affine), each_volume);
        }
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
