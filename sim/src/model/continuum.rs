//! Finite elements: what the models of a continuum share.
//!
//! The places of an element are a map of its places at rest, with the gradient `F`. Its energy is `Σ w ψ(F)`, the sum of the energy density
//! of a material law over points with weights, and the force on a node `−Σ w P ∇N`, with `P = ∂ψ/∂F` the first stress of Piola and
//! Kirchhoff and `∇N` the gradient at rest of the node's shape function. Triangles and tetrahedra have linear shape functions and one point.
//! Quadrilaterals and hexahedra have bilinear and trilinear ones and the points of Gauss at `±1/√3` in each direction (T. Hughes, "The finite
//! element method", 1987, chapter 3; O. Zienkiewicz, R. Taylor, "The finite element method", 5th ed. 2000, vol. 1, chapters 8 and 9; the
//! forces: E. Sifakis, J. Barbič, "FEM simulation of 3D deformable solids", SIGGRAPH courses 2012, chapter 4). These patterns integrate
//! parallelepipeds of a linear material exactly.
//!
//! Masses are those of the nodes. In the plane a material is a sheet of unit thickness under plane stress, and `λ` is
//! [that of the sheet](Material::lame).
//!
//! A node is damped by `−D` times its velocity without the rigid motion that fits its element best.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::{ByLaw, Corners, ElasticModel, Element, ForceModel, Lanes, Law, Misfit, Vectorised};
use crate::body::Body;
use crate::element::{Dimension, ElementKind};
use crate::kernel::rotation::{self, Moments, Optimum, Solver};
use crate::kernel::{Compiled, Conditions};
use crate::lanes::{MOST, Set, Work, each};
use crate::law::{Reader, Rigid, alike, off};
use crate::material::Material;
use crate::volume::volumes_at_rest;
use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::marker::PhantomData;
use std::sync::Arc;

/// The parameters of a model of finite elements in a scene file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
pub struct Parameters {
    /// Young's modulus of the material (Pa; N/m in the plane). Cycles and damping ratios have the elastic constant `k` of the shape model's
    /// stiffest element for it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio of the material. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// Damping constant of each element (N s/m): of the velocities of its nodes without its rigid motion. Default: 0. Not together with
    /// `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mass of the lightest node, as in `step = "T/50"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
}

/// A square matrix, its columns, in every lane.
pub(super) type Map<L, const D: usize> = [[L; D]; D];

/// The law of a material, in the plane (`D` = 2) and in space (`D` = 3).
pub(super) trait Stress: Clone + Copy + Debug + Send + Sync + 'static {
    /// The name of the model in a scene file.
    const NAME: &'static str;
    /// Whether it depends on the rotation nearest to `F`. Without that, functions have zeros in its place.
    const TURNS: bool;

    /// `P` (Pa) in proportion to `[μ, λ]` (Pa), of `F` and the rotation.
    fn stress<L: Lanes, const D: usize>(moduli: [L; 2], f: &Map<L, D>, r: &Map<L, D>) -> Map<L, D>;

    /// `ψ` (J/m³), 0 at rest.
    fn energy<L: Lanes, const D: usize>(moduli: [L; 2], f: &Map<L, D>, r: &Map<L, D>) -> L;
}

/// A model of finite elements with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FiniteElements<S> {
    material: Material,
    /// The greatest elastic constant of the shape model for it (N/m).
    stiffness: f64,
    /// Damping constant `D` of each element (N s/m).
    damping: f64,
    of: PhantomData<S>,
}

impl<S: Stress> FiniteElements<S> {
    /// The model for a body.
    ///
    /// # Errors
    /// Parameters that contradict each other, and elements that it does not take: of other kinds, without a volume, or that are turned inside
    /// out at rest at one of their points.
    pub(super) fn new(parameters: &Parameters, body: &Body) -> Result<Self, Misfit> {
        let kinds = body.elements.iter().zip(&body.kinds).enumerate();
        for (at, (nodes, &kind)) in kinds {
            let (is_taken, taken) = match body.dimension {
                Dimension::Plane => (matches!(nodes.len(), 3 | 4), "triangles and quadrilaterals"),
                Dimension::Space => {
                    (matches!(kind, ElementKind::Tetrahedron | ElementKind::Hexahedron), "tetrahedra and hexahedra")
                }
            };
            if !is_taken {
                let found = name(kind, nodes.len());
                let message = format!(
                    "`{}` takes {taken}; element {at} is {found}; `shape-based` takes elements of every kind",
                    S::NAME
                );
                return Err(Misfit { key: "kind", message });
            }
        }
        if let Some(element) = volumes_at_rest(body).iter().position(|&volume| volume <= 0.0) {
            let measure = if body.dimension == Dimension::Plane { "area" } else { "volume" };
            let message = format!(
                "element {element} has no {measure} at rest: it is flat, or its nodes are in the wrong order; `{}` cannot do without",
                S::NAME
            );
            return Err(Misfit { key: "kind", message });
        }
        let material = super::material(Some(parameters.young), parameters.poisson, body)?;
        if let Some(element) = body.elements.iter().position(|nodes| is_folded(body, nodes)) {
            let message = format!(
                "element {element} is folded: at rest it is turned inside out near one of its nodes; move its nodes, or divide it"
            );
            return Err(Misfit { key: "kind", message });
        }
        let stiffness = material.stiffness(body).into_iter().fold(0.0, f64::max);
        let damping = super::damping(parameters.damping, parameters.damping_ratio, stiffness, body)?;
        Ok(Self { material, stiffness, damping, of: PhantomData })
    }

    fn law<const D: usize, const CORNERS: usize>(&self, body: &Body) -> Elements<S, D, CORNERS> {
        let (shear, lame) = (self.material.shear(), self.material.lame(body.dimension));
        let is_affine = body.elements.iter().all(|nodes| is_affine(body, nodes));
        Elements { shear, lame, damping: self.damping, is_affine, of: PhantomData }
    }
}

/// An expression of the law of the elements of a body.
macro_rules! by_law {
    ($model:ident, $body:ident, $law:ident => $value:expr) => {
        match ($body.dimension, $body.elements.iter().all(|nodes| nodes.len() == 4)) {
            (Dimension::Plane, _) => {
                let $law = $model.law::<2, 4>($body);
                $value
            }
            (Dimension::Space, true) => {
                let $law = $model.law::<3, 4>($body);
                $value
            }
            (Dimension::Space, false) => {
                let $law = $model.law::<3, 8>($body);
                $value
            }
        }
    };
}

impl<S: Stress> ElasticModel for FiniteElements<S> {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn scaled(&self, stiffness: f64, damping: f64) -> Option<Arc<dyn ElasticModel>> {
        let material = Material { young: self.material.young * stiffness, ..self.material };
        let (stiffness, damping) = (self.stiffness * stiffness, self.damping * damping);
        Some(Arc::new(Self { material, stiffness, damping, of: PhantomData }))
    }

    fn typed_material(&self) -> Option<Material> {
        Some(self.material)
    }

    fn damping(&self) -> f64 {
        self.damping
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    /// The rotations that are optimal for the initial positions.
    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        if !S::TURNS {
            return Vec::new();
        }
        by_law!(self, body, law => Set::best().run(Start { law, body, position }))
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        by_law!(self, body, law => Box::new(ByLaw::new(law, body)))
    }
}

impl<S: Stress> Vectorised for FiniteElements<S> {
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
        by_law!(self, body, law => Compiled::once(law, body, conditions))
    }
}

/// What an element is, in words.
fn name(kind: ElementKind, nodes: usize) -> String {
    match kind {
        ElementKind::Segment => "a segment".into(),
        ElementKind::Polygon => format!("a polygon of {nodes} nodes"),
        ElementKind::Triangle => "a triangle, which has no volume".into(),
        ElementKind::Tetrahedron => "a tetrahedron".into(),
        ElementKind::Pyramid => "a pyramid".into(),
        ElementKind::Wedge => "a wedge".into(),
        ElementKind::Hexahedron => "a hexahedron".into(),
        ElementKind::Other => format!("a polyhedron of {nodes} nodes in any order"),
    }
}

/// `1/√3`: where the points of Gauss are.
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// The coordinates of a corner of a quadrilateral or hexahedron, a bit each: the corners of quadrilaterals are listed around.
#[inline(always)]
fn bits<const D: usize>(corner: usize) -> usize {
    if D == 2 { corner ^ corner >> 1 } else { corner }
}

/// The corners of a quadrilateral or hexahedron by their bits; `None` for other elements.
fn corners_by_bits(body: &Body, nodes: &[u32]) -> Option<Vec<DVec3>> {
    let at = |corner: usize| body.rest[nodes[corner] as usize];
    match (body.dimension, nodes.len()) {
        (Dimension::Plane, 4) => Some((0..4).map(|corner| at(bits::<2>(corner))).collect()),
        (Dimension::Space, 8) => Some((0..8).map(at).collect()),
        _ => None,
    }
}

/// Whether the map of an element from its parent has a gradient without volume, or turned inside out, at one of its points.
fn is_folded(body: &Body, nodes: &[u32]) -> bool {
    let Some(corners) = corners_by_bits(body, nodes) else { return false };
    let sign = |of: usize, axis: usize| if of >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let axes = if body.dimension == Dimension::Plane { 2 } else { 3 };
    let slope = |point: usize, axis: usize| -> DVec3 {
        if axis >= axes {
            return DVec3::Z;
        }
        let others = || (0..axes).filter(|&other| other != axis);
        let factor = |corner: usize| -> f64 {
            others().map(|other| 1.0 + sign(corner, other) * sign(point, other) * GAUSS).product()
        };
        (0..corners.len()).map(|corner| corners[corner] * (sign(corner, axis) * factor(corner))).sum()
    };
    let determinant = |point: usize| DMat3::from_cols(slope(point, 0), slope(point, 1), slope(point, 2)).determinant();
    (0..corners.len()).any(|point| determinant(point) <= 0.0)
}

/// Whether an element is a simplex, a parallelogram or a parallelepiped, to the round-off of its coordinates.
fn is_affine(body: &Body, nodes: &[u32]) -> bool {
    const ROUND_OFF: f64 = 1e-14;
    let Some(corners) = corners_by_bits(body, nodes) else { return true };
    let size = corners.iter().fold(0.0, |size: f64, corner| size.max(corner.abs().max_element()));
    let mode = |of: usize| -> DVec3 {
        let sign = |corner: usize| if (of & !corner).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
        corners.iter().enumerate().map(|(corner, at)| *at * sign(corner)).sum()
    };
    let mut mixed = (0..corners.len()).filter(|of| of.count_ones() > 1);
    mixed.all(|of| mode(of).abs().max_element() <= ROUND_OFF * size)
}

/// The law of elements in `D` dimensions with so many corners at most: four in the plane; in space eight, or four if all are tetrahedra.
#[derive(Clone)]
struct Elements<S, const D: usize, const CORNERS: usize> {
    /// `μ` (Pa).
    shear: f64,
    /// `λ` (Pa).
    lame: f64,
    /// `D` (N s/m).
    damping: f64,
    /// Whether all elements are [affine](is_affine).
    is_affine: bool,
    of: PhantomData<S>,
}

impl<S: Stress, const D: usize, const CORNERS: usize> Elements<S, D, CORNERS> {
    /// Whether some elements are quadrilaterals or hexahedra.
    const HAS_BOXES: bool = CORNERS == 1 << D;
    /// How many numbers describe a rotation: a quaternion, or (cos θ, sin θ).
    const TURN: usize = if D == 3 { 4 } else { 2 };

    /// The inverse of the gradient of an element from its parent, and the weight of a point.
    #[inline(always)]
    fn inverse<L: Lanes>(gradient: &Map<L, D>, size: f64) -> (Map<L, D>, L) {
        let cofactors = cofactors(gradient);
        let determinant = dot(&gradient[0], &cofactors[0]);
        let over = L::splat(1.0) / determinant;
        let mut inverse = [[over; D]; D];
        for column in 0..D {
            for row in 0..D {
                inverse[column][row] = cofactors[row][column] * over;
            }
        }
        (inverse, determinant * L::splat(size))
    }

    /// The inverse and the weight from the constants of affine elements.
    #[inline(always)]
    fn affine<L: Lanes>(element: &Element<'_, L>) -> (Map<L, D>, L) {
        let weight = element.of_element(D * D);
        let mut inverse = [[weight; D]; D];
        for column in 0..D {
            for row in 0..D {
                inverse[column][row] = element.of_element(column * D + row);
            }
        }
        (inverse, weight)
    }

    /// The rotation nearest to `F` at a point, from the last one.
    #[inline(always)]
    fn rotation<L: Lanes>(element: &Element<'_, L>, point: usize, f: &Map<L, D>) -> Map<L, D> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut r = [[zero; D]; D];
        if !S::TURNS {
            return r;
        }
        if D == 2 {
            let last = element.memory_from::<2>(2 * point);
            let turn = rotation::in_plane([f[0][0] + f[1][1], f[0][1] - f[1][0]], last);
            element.remember_from(2 * point, turn);
            (r[0][0], r[0][1], r[1][0], r[1][1]) = (turn[0], turn[1], -turn[1], turn[0]);
        } else {
            let a = each!(3, column => each!(3, row => f[column][row]));
            let of = Moments { a: &a, scale: L::splat(1.0 / 3.0), tally: None };
            let (turn, _) = Optimum.step(of, element.memory_from::<4>(4 * point), element.live(), true);
            element.remember_from(4 * point, turn);
            let matrix = rotation::matrix(turn, one);
            for column in 0..D {
                for row in 0..D {
                    r[column][row] = matrix[column][row];
                }
            }
        }
        r
    }

    /// The position of a corner (m).
    #[inline(always)]
    fn corner<L: Lanes>(element: &Element<'_, L>, corner: usize) -> [L; D] {
        let mut place = [L::splat(0.0); D];
        if D == 2 {
            let (p, _) = element.corner_in_plane(corner);
            (place[0], place[1]) = (p[0], p[1]);
        } else {
            let (p, _) = element.corner(corner);
            (place[0], place[1], place[2]) = (p[0], p[1], p[2]);
        }
        place
    }

    /// The elastic forces on the corners (N), or the energy (J) of the element.
    #[inline(always)]
    fn evaluate<L: Lanes, const ENERGY: bool>(&self, element: &Element<'_, L>) -> ([[L; D]; CORNERS], L) {
        let zero = L::splat(0.0);
        let moduli = [L::splat(self.shear), L::splat(self.lame)];
        let (mut forces, mut energy) = ([[zero; D]; CORNERS], zero);
        if element.corners() == D + 1 {
            let first = Self::corner(element, 0);
            let mut edges = [[zero; D]; D];
            for edge in 0..D {
                let end = Self::corner(element, edge + 1);
                for row in 0..D {
                    edges[edge][row] = end[row] - first[row];
                }
            }
            let (inverse, weight) = Self::affine(element);
            let f = product(&edges, &inverse);
            let r = Self::rotation(element, 0, &f);
            if ENERGY {
                energy = weight * S::energy(moduli, &f, &r);
            } else {
                let of = pulled(&S::stress([moduli[0] * weight, moduli[1] * weight], &f, &r), &inverse);
                for edge in 0..D {
                    for row in 0..D {
                        forces[0][row] = forces[0][row] + of[edge][row];
                        forces[edge + 1][row] = -of[edge][row];
                    }
                }
            }
        } else if Self::HAS_BOXES {
            let mut modes = [[zero; D]; CORNERS];
            for corner in 0..CORNERS {
                modes[bits::<D>(corner)] = Self::corner(element, corner);
            }
            sums_and_differences(&mut modes);
            let now = slopes(&modes);
            let mut rest = [[[zero; D]; 4]; D];
            let mut fixed = ([[zero; D]; D], zero);
            if self.is_affine {
                fixed = Self::affine(element);
            } else {
                let mut modes = [[zero; D]; CORNERS];
                for mode in 1..CORNERS {
                    for row in 0..D {
                        modes[mode][row] = element.of_element((mode - 1) * D + row);
                    }
                }
                rest = slopes(&modes);
            }
            let mut pulls = [[[zero; D]; 4]; D];
            // As many points as corners. Unrolled they are many times as long to compile, and no faster.
            for point in 0..element.corners() {
                let (inverse, weight) =
                    if self.is_affine { fixed } else { Self::inverse(&slope_at(&rest, point), Self::BOX) };
                let f = product(&slope_at(&now, point), &inverse);
                let r = Self::rotation(element, point, &f);
                if ENERGY {
                    energy = weight.mul_add(S::energy(moduli, &f, &r), energy);
                } else {
                    let of = pulled(&S::stress([moduli[0] * weight, moduli[1] * weight], &f, &r), &inverse);
                    for axis in 0..D {
                        let pull = &mut pulls[axis][without(point, axis)];
                        for row in 0..D {
                            pull[row] = pull[row] - of[axis][row];
                        }
                    }
                }
            }
            if !ENERGY {
                let mut of_modes = of_slopes::<L, D, CORNERS>(&pulls);
                sums_and_differences_of_modes(&mut of_modes);
                for corner in 0..CORNERS {
                    forces[corner] = of_modes[bits::<D>(corner)];
                }
            }
        }
        (forces, energy)
    }

    /// The weight of a point over the determinant of the slopes of a box, which are 2ᵈ times the gradient of its map from `[−1, 1]ᵈ`.
    const BOX: f64 = 1.0 / (1_u64 << (D * D)) as f64;
    /// The volume of a simplex over the determinant of its edges.
    const SIMPLEX: f64 = if D == 3 { 1.0 / 6.0 } else { 0.5 };
}

impl<S: Stress, const D: usize, const CORNERS: usize> Law for Elements<S, D, CORNERS> {
    /// Of an affine element the inverse of its gradient and the weight of a point; else its modes at rest, but the first (m).
    const OF_ELEMENT: usize = if Self::HAS_BOXES { (CORNERS - 1) * D } else { D * D + 1 };
    /// The rotation of each point.
    const MEMORY: usize = match (S::TURNS, Self::HAS_BOXES) {
        (false, _) => 0,
        (true, true) => CORNERS * Self::TURN,
        (true, false) => Self::TURN,
    };
    /// The forces on the corners (N).
    type Whole<L: Lanes> = [[L; D]; CORNERS];

    /// The modulus and the measures of an element decide its stiffness.
    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        body.fill.clone()
    }

    fn is_damped(&self) -> bool {
        self.damping > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        let zero = L::splat(0.0);
        let mut gradient = [[zero; D]; D];
        let mut size = Self::SIMPLEX;
        if rest.count() == D + 1 {
            let first = rest.position(0);
            for edge in 0..D {
                let end = rest.position(edge + 1);
                for row in 0..D {
                    gradient[edge][row] = end[row] - first[row];
                }
            }
        } else if Self::HAS_BOXES {
            let mut modes = [[zero; D]; CORNERS];
            for corner in 0..CORNERS {
                let place = rest.position(corner);
                modes[bits::<D>(corner)].copy_from_slice(&place[..D]);
            }
            sums_and_differences(&mut modes);
            if !self.is_affine {
                for mode in 1..CORNERS {
                    for row in 0..D {
                        of_element[(mode - 1) * D + row] = modes[mode][row];
                    }
                }
                return;
            }
            for axis in 0..D {
                gradient[axis] = modes[1 << axis];
            }
            size = Self::BOX;
        }
        let (inverse, weight) = Self::inverse(&gradient, size);
        for column in 0..D {
            for row in 0..D {
                of_element[column * D + row] = inverse[column][row];
            }
        }
        of_element[D * D] = weight;
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> [[L; D]; CORNERS] {
        let (mut forces, _) = self.evaluate::<L, false>(element);
        if self.damping > 0.0 {
            let (rigid, d) = (Rigid::of(element), L::splat(self.damping));
            for corner in 0..element.corners() {
                let (p, v) = element.corner(corner);
                let off = off(rigid, p, v);
                for row in 0..D {
                    forces[corner][row] = d.neg_mul_add(off[row], forces[corner][row]);
                }
            }
        }
        forces
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, forces: &[[L; D]; CORNERS]) -> [L; 3] {
        let (force, zero) = (&forces[corner], L::splat(0.0));
        [force[0], force[1], if D == 3 { force[D - 1] } else { zero }]
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, _: &Corners<'_, L>, shares: &mut [L]) -> L {
        let (_, energy) = self.evaluate::<L, true>(element);
        shares.fill(energy * L::splat(1.0 / element.corners() as f64));
        L::splat(0.0)
    }
}

/// The product of two matrices.
#[inline(always)]
pub(super) fn product<L: Lanes, const D: usize>(a: &Map<L, D>, b: &Map<L, D>) -> Map<L, D> {
    let mut product = [[L::splat(0.0); D]; D];
    for column in 0..D {
        for row in 0..D {
            let mut sum = a[0][row] * b[column][0];
            for at in 1..D {
                sum = a[at][row].mul_add(b[column][at], sum);
            }
            product[column][row] = sum;
        }
    }
    product
}

/// `a bᵀ`.
#[inline(always)]
fn pulled<L: Lanes, const D: usize>(a: &Map<L, D>, b: &Map<L, D>) -> Map<L, D> {
    let mut product = [[L::splat(0.0); D]; D];
    for column in 0..D {
        for row in 0..D {
            let mut sum = a[0][row] * b[0][column];
            for at in 1..D {
                sum = a[at][row].mul_add(b[at][column], sum);
            }
            product[column][row] = sum;
        }
    }
    product
}

#[inline(always)]
pub(super) fn dot<L: Lanes, const D: usize>(a: &[L; D], b: &[L; D]) -> L {
    let mut sum = a[0] * b[0];
    for at in 1..D {
        sum = a[at].mul_add(b[at], sum);
    }
    sum
}

/// The derivatives of the determinant by the entries of a matrix.
#[inline(always)]
pub(super) fn cofactors<L: Lanes, const D: usize>(m: &Map<L, D>) -> Map<L, D> {
    let mut cofactors = [[L::splat(0.0); D]; D];
    if D == 2 {
        (cofactors[0][0], cofactors[0][1]) = (m[1][1], -m[1][0]);
        (cofactors[1][0], cofactors[1][1]) = (-m[0][1], m[0][0]);
    } else {
        for column in 0..D {
            let (a, b) = (&m[(column + 1) % D], &m[(column + 2) % D]);
            for row in 0..D {
                let (j, k) = ((row + 1) % D, (row + 2) % D);
                cofactors[column][row] = a[j].mul_sub(b[k], a[k] * b[j]);
            }
        }
    }
    cofactors
}

/// The bits of a point without that of an axis: at most two, so that no index into [`Slopes`] needs a test.
#[inline(always)]
fn without(point: usize, axis: usize) -> usize {
    let below = (1 << axis) - 1;
    ((point & below) | (point >> 1 & !below)) & 3
}

/// From the corners of a box, by their bits, its modes: the coefficients, times 2ᵈ, of 1, ξ, η, ξη, ζ, ξζ, ηζ, ξηζ.
#[inline(always)]
fn sums_and_differences<L: Lanes, const D: usize, const CORNERS: usize>(values: &mut [[L; D]; CORNERS]) {
    for axis in 0..D {
        for at in 0..CORNERS {
            if at >> axis & 1 == 0 {
                for row in 0..D {
                    let (low, high) = (values[at][row], values[at | 1 << axis][row]);
                    (values[at][row], values[at | 1 << axis][row]) = (low + high, high - low);
                }
            }
        }
    }
}

/// From forces on modes those on corners: the transpose of [`sums_and_differences`].
#[inline(always)]
fn sums_and_differences_of_modes<L: Lanes, const D: usize, const CORNERS: usize>(values: &mut [[L; D]; CORNERS]) {
    for axis in 0..D {
        for at in 0..CORNERS {
            if at >> axis & 1 == 0 {
                for row in 0..D {
                    let (even, odd) = (values[at][row], values[at | 1 << axis][row]);
                    (values[at][row], values[at | 1 << axis][row]) = (even - odd, even + odd);
                }
            }
        }
    }
}

/// The derivative along each axis, which does not depend on that axis, at the points of Gauss of the other axes.
type Slopes<L, const D: usize> = [[[L; D]; 4]; D];

/// The derivatives at a point.
#[inline(always)]
fn slope_at<L: Lanes, const D: usize>(slopes: &Slopes<L, D>, point: usize) -> Map<L, D> {
    let mut map = [[L::splat(0.0); D]; D];
    for axis in 0..D {
        map[axis] = slopes[axis][without(point, axis)];
    }
    map
}

/// The bits of the other axes, the lower first.
#[inline(always)]
fn others(axis: usize) -> [usize; 2] {
    [[2, 4], [1, 4], [1, 2]][axis]
}

/// Derivatives from modes.
#[inline(always)]
fn slopes<L: Lanes, const D: usize, const CORNERS: usize>(modes: &[[L; D]; CORNERS]) -> Slopes<L, D> {
    let g = L::splat(GAUSS);
    let mut slopes = [[[L::splat(0.0); D]; 4]; D];
    for axis in 0..D {
        let (own, [j, k]) = (1 << axis, others(axis));
        for row in 0..D {
            let (a, b) = (modes[own][row], modes[own | j][row]);
            let (low, high) = (g.neg_mul_add(b, a), g.mul_add(b, a));
            if D == 2 {
                (slopes[axis][0][row], slopes[axis][1][row]) = (low, high);
            } else {
                let (a, b) = (modes[own | k][row], modes[own | j | k][row]);
                let (of_low, of_high) = (g.neg_mul_add(b, a), g.mul_add(b, a));
                slopes[axis][0][row] = g.neg_mul_add(of_low, low);
                slopes[axis][1][row] = g.neg_mul_add(of_high, high);
                slopes[axis][2][row] = g.mul_add(of_low, low);
                slopes[axis][3][row] = g.mul_add(of_high, high);
            }
        }
    }
    slopes
}

/// Forces on modes from those on derivatives: the transpose of [`slopes`].
#[inline(always)]
fn of_slopes<L: Lanes, const D: usize, const CORNERS: usize>(pulls: &Slopes<L, D>) -> [[L; D]; CORNERS] {
    let (zero, g) = (L::splat(0.0), L::splat(GAUSS));
    let mut modes = [[zero; D]; CORNERS];
    for axis in 0..D {
        let (own, [j, k]) = (1 << axis, others(axis));
        for row in 0..D {
            let of = [pulls[axis][0][row], pulls[axis][1][row], pulls[axis][2][row], pulls[axis][3][row]];
            if D == 2 {
                modes[own][row] = of[0] + of[1];
                modes[own | j][row] = g.mul_add(of[1] - of[0], modes[own | j][row]);
            } else {
                let (low, high) = (of[0] + of[2], of[1] + of[3]);
                let (of_low, of_high) = (of[2] - of[0], of[3] - of[1]);
                modes[own][row] = low + high;
                modes[own | j][row] = g.mul_add(high - low, modes[own | j][row]);
                modes[own | k][row] = g.mul_add(of_low + of_high, modes[own | k][row]);
                modes[own | j | k][row] = (g * g).mul_add(of_high - of_low, modes[own | j | k][row]);
            }
        }
    }
    modes
}

/// Computes the memory of elements at the start, element by element.
struct Start<'a, W> {
    law: W,
    body: &'a Body,
    position: &'a [DVec3],
}

impl<W: Law> Work for Start<'_, W> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<f64> {
        let Self { law, body, position } = self;
        let identity: &[f64] = if body.dimension == Dimension::Plane { &[1.0, 0.0] } else { &[0.0, 0.0, 0.0, 1.0] };
        let identity: Vec<f64> = identity.iter().copied().cycle().take(W::MEMORY).collect();
        let (mut reader, mut memory) = (Reader::<L>::new(), Vec::with_capacity(body.elements.len() * W::MEMORY));
        while memory.len() < body.elements.len() * W::MEMORY {
            let first = memory.len() / W::MEMORY;
            let (group, count) = alike::<L>(&body.elements, first..body.elements.len());
            reader.read(&group, body, position, None, &[1.0; MOST]);
            reader.prepare(&law);
            reader.recall(&identity, 0, 1, W::MEMORY);
            let (element, _) = reader.elements::<W>(count);
            law.whole(&element);
            for lane in 0..count {
                memory.extend(reader.memory.iter().map(|row| row[lane]));
            }
        }
        memory
    }
}
