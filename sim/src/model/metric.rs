//! Elastically deformable models (the paper's Ref. 1): the energy of a changed metric.
//!
//! At each corner of an element the edges that meet there, in the plane two, in space three, are differences along the lattice of its
//! nodes, `e_i ≈ ∂_i x`. Their metric tensor `G_ij = e_i · e_j` is compared with the one at rest, `G⁰`:
//!
//! `E = Σ v (μ/4 tr U² + λ/8 (tr U)²)`, with `U = G (G⁰)⁻¹ − 1`,
//!
//! over the corners of all elements, with `v` an eighth of the volume that the edges span at rest, in the plane a quarter of their area.
//! Forces are the exact negative gradient of this sum. A metric sees lengths and angles only: no rigid motion changes it, and no reflection.
//! A mirrored body is at rest.
//!
//! D. Terzopoulos, J. Platt, A. Barr, K. Fleischer, Elastically Deformable Models, SIGGRAPH 87, 205 (1987), have for solids the density
//! `Σ_ij η_ij (G_ij − G⁰_ij)²` in the coordinates of the lattice (M. Kelager, A. Fleron, K. Erleben, Electronic Letters on Computer Vision and
//! Image Analysis 5(3), 32 (2005), whose OpenTissue has the tension `η_ij (G_ij − G⁰_ij)`, too). Here indices are raised by `G⁰`, which is
//! the same in orthonormal coordinates of the rest shape and does not depend on the lattice. With all `η_ij = μ/4` and the second term it is
//! an isotropic material, that of St. Venant and Kirchhoff: `U/2` has the invariants of Green's strain (E. Sifakis, J. Barbič, FEM Simulation
//! of 3D Deformable Solids, SIGGRAPH 2012 courses, section 3.3; J. Bonet, R. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis,
//! 2008, chapter 6).
//! Terzopoulos et al. derive the equation of motion from the continuous energy first and then replace its derivatives by forward and backward
//! differences, with one metric at each node, and forces that need not be the gradient of an energy of nodes. They also have curves and
//! surfaces, whose bending and twist are further tensors.
//!
//! It is the same as finite elements with one quadrature point at each corner. So in the plane uniform strain has the energy of the material
//! and no forces on inner nodes, however irregular the body. In space that holds for parallelepipeds; in lattices whose nodes are moved by up
//! to 0.3 sides the energy is 0.02 % too small.
//!
//! The material softens under compression: squeezed to less than `1/√3` of its length, it pushes back less and less.

#![expect(clippy::needless_range_loop, reason = "loops over the coordinates of several arrays, without closures")]

use super::continuum::{cofactors, dot, of_material};
use super::{ElasticModel, ForceModel, Misfit, Properties, Setting, Vectorised};
use crate::body::Body;
use crate::element::{Dimension, ElementKind};
use crate::fill;
use crate::lanes::{Lanes, each};
use crate::law::{ByLaw, Corners, Element, Law, Rigid, off};
use crate::material::{Damping, Material};
use glam::DVec3;
use std::sync::Arc;

of_material!(|body, material, damping| Metric::new(body, material, damping));

/// The model for a body, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    material: Material,
    /// `D` of each element.
    damping: Damping,
    /// `k` of the stiffest element of the shape model of this material (N/m).
    stiffness: f64,
    /// `μ/4` and `λ/8` (Pa).
    moduli: [f64; 2],
}

impl Metric {
    /// The model of a material with the damping constant of the stiffest element (N s/m).
    ///
    /// # Errors
    /// A body with elements that are no cells of a lattice: others than quadrilaterals in the plane and hexahedra in space, or with a
    /// corner whose edges span no volume.
    pub fn new(body: &Body, material: Material, damping: f64) -> Result<Self, Misfit> {
        for (element, nodes) in body.elements.iter().enumerate() {
            let fits = match body.dimension {
                Dimension::Plane => nodes.len() == 4,
                Dimension::Space => body.kinds[element] == ElementKind::Hexahedron,
            };
            if !fits {
                let cells = match body.dimension {
                    Dimension::Plane => "quadrilaterals",
                    Dimension::Space => "hexahedra, 8 nodes with x fastest",
                };
                let message = format!(
                    "element {element} has {} nodes and is no cell of a lattice, along which a metric is measured; `metric` takes \
                     {cells}; `shape-based` takes elements of every kind",
                    nodes.len()
                );
                return Err(Misfit { key: "kind", message });
            }
            if let Some(corner) = (0..nodes.len()).find(|&corner| spanned(body, nodes, corner) <= 0.0) {
                let node = nodes[corner];
                let message = format!(
                    "the edges of element {element} at node {node} span no volume at rest, or one that is turned over, so that no \
                     metric is measured there; move the node, or take `shape-based`"
                );
                return Err(Misfit { key: "kind", message });
            }
        }
        super::check(material, body)?;
        let stiffness = material.stiffness(body).into_iter().fold(0.0, f64::max);
        let moduli = [0.25 * material.shear(), 0.125 * material.lame(body.dimension)];
        Ok(Self { material, damping: Damping::new(damping, body), stiffness, moduli })
    }
}

/// The signed volume that the edges at a corner of a cell span at rest (m³, in the plane m²).
fn spanned(body: &Body, nodes: &[u32], corner: usize) -> f64 {
    let at = |corner: usize| body.rest[nodes[corner] as usize];
    let edge = |axis: usize| at(neighbour(nodes.len(), corner, axis)) - at(corner);
    let third = if body.dimension == Dimension::Plane { DVec3::Z } else { edge(2) };
    let volume = edge(0).cross(edge(1)).dot(third);
    // Each step along an edge of a hexahedron mirrors the edges.
    if corner.count_ones() % 2 == 1 && body.dimension == Dimension::Space { -volume } else { volume }
}

impl ElasticModel for Metric {
    fn properties(&self, body: &Body) -> Properties {
        let undamped = Properties::new("metric", self.stiffness).of_material(Some(self.material), body.dimension);
        undamped.damped(self.damping.most).fixed("damping_of", Setting::Choice("deformation"))
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(ByLaw::new(self.clone(), body))
    }
}

/// The numbers of corners of the elements that the model takes.
const QUADRILATERAL: usize = 4;
const HEXAHEDRON: usize = 8;

/// The corner at the other end of an edge of a quadrilateral or a hexahedron.
#[inline(always)]
fn neighbour(corners: usize, corner: usize, axis: usize) -> usize {
    if corners == QUADRILATERAL { (corner + [1, 3][axis]) % QUADRILATERAL } else { corner ^ (1 << axis) }
}

/// The edges at a corner (m). In the plane the third is a unit vector across it, which never changes.
#[inline(always)]
fn edges<L: Lanes>(corners: &Corners<'_, L>, corner: usize) -> [[L; 3]; 3] {
    let from = corners.position(corner);
    let mut edges = [[L::splat(0.0), L::splat(0.0), L::splat(1.0)]; 3];
    for axis in 0..axes(corners.count()) {
        let to = corners.position(neighbour(corners.count(), corner, axis));
        edges[axis] = each!(3, entry => to[entry] - from[entry]);
    }
    edges
}

/// The number of edges at a corner.
#[inline(always)]
fn axes(corners: usize) -> usize {
    if corners == QUADRILATERAL { 2 } else { 3 }
}

/// The metric of edges: xx, yy, zz, xy, xz, yz.
#[inline(always)]
fn metric<L: Lanes>([a, b, c]: &[[L; 3]; 3]) -> [L; 6] {
    [dot(a, a), dot(b, b), dot(c, c), dot(a, b), dot(a, c), dot(b, c)]
}

/// The rows of a symmetric matrix.
#[inline(always)]
fn rows<L: Lanes>([xx, yy, zz, xy, xz, yz]: [L; 6]) -> [[L; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// The numbers of a corner at rest: the inverse of its metric (1/m²), and its volume `v` (m³).
#[inline(always)]
fn of_corner<L: Lanes>(element: &Element<'_, L>, corner: usize) -> ([[L; 3]; 3], L) {
    let inverse = each!([0, 1, 2, 3, 4, 5], at => element.of_corner(corner, at));
    (rows(inverse), element.of_corner(corner, 6))
}

/// The columns of `U = G (G⁰)⁻¹ − 1`, and its trace.
#[inline(always)]
fn change<L: Lanes>(edges: &[[L; 3]; 3], inverse: &[[L; 3]; 3]) -> ([[L; 3]; 3], L) {
    let (g, one) = (rows(metric(edges)), L::splat(1.0));
    let mut u = each!(3, column => each!(3, row => dot(&g[row], &inverse[column])));
    for at in 0..3 {
        u[at][at] = u[at][at] - one;
    }
    (u, u[0][0] + u[1][1] + u[2][2])
}

impl Law for Metric {
    /// `D` (N s/m).
    const OF_ELEMENT: usize = 1;
    /// The inverse of the metric at rest (1/m²): xx, yy, zz, xy, xz, yz. Then the volume of the corner (m³).
    const OF_CORNER: usize = 7;
    /// The force on each corner (N).
    type Whole<L: Lanes> = [[L; 3]; HEXAHEDRON];

    /// The moduli of a material do not depend on the elements.
    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        fill::of_materials(body)
    }

    fn is_damped(&self) -> bool {
        self.damping.most > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        let (part, mut whole) = (L::splat(1.0 / rest.count() as f64), L::splat(0.0));
        for corner in 0..rest.count() {
            let edges = edges(rest, corner);
            // The inverse of the matrix of edges has these rows, over the volume.
            let rows = cofactors(&edges);
            let volume = dot(&rows[0], &edges[0]);
            let inverse = L::splat(1.0) / (volume * volume);
            let numbers = &mut of_corner[7 * corner..][..7];
            let squares = metric(&rows);
            for at in 0..6 {
                numbers[at] = squares[at] * inverse;
            }
            numbers[6] = volume.abs() * part;
            whole = whole + numbers[6];
        }
        of_element[0] = self.damping.of(rest, whole, axes(rest.count()) as f64);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> [[L; 3]; HEXAHEDRON] {
        let corners = element.corners();
        let mut forces = [[L::splat(0.0); 3]; HEXAHEDRON];
        for corner in 0..corners {
            let (edges, (inverse, volume)) = (edges(&element.corners, corner), of_corner(element, corner));
            let (u, trace) = change(&edges, &inverse);
            let [shear, spread] = each!(2, at => L::splat(4.0 * self.moduli[at]) * volume);
            // ∂E/∂e_i = Σ_j t_ij e_j, with a symmetric t: so no torque.
            let spread = spread * trace;
            let mut t = [[spread; 3]; 3];
            for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
                let entry = spread.mul_add(inverse[row][column], shear * dot(&inverse[row], &u[column]));
                (t[row][column], t[column][row]) = (entry, entry);
            }
            for axis in 0..axes(corners) {
                let end = neighbour(corners, corner, axis);
                for entry in 0..3 {
                    let column = [edges[0][entry], edges[1][entry], edges[2][entry]];
                    let pull = dot(&t[axis], &column);
                    forces[corner][entry] = forces[corner][entry] + pull;
                    forces[end][entry] = forces[end][entry] - pull;
                }
            }
        }
        if self.damping.most > 0.0 {
            let (motion, damping) = (Rigid::of(element), element.of_element(0));
            for corner in 0..corners {
                let (p, v) = element.corner(corner);
                let off = off(motion, p, v);
                forces[corner] = each!(3, axis => off[axis].neg_mul_add(damping, forces[corner][axis]));
            }
        }
        forces
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, forces: &[[L; 3]; HEXAHEDRON]) -> [L; 3] {
        forces[corner]
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, _: &Corners<'_, L>, shares: &mut [L]) -> L {
        let [shear, spread] = each!(2, at => L::splat(self.moduli[at]));
        for corner in 0..element.corners() {
            let (inverse, volume) = of_corner(element, corner);
            let (u, trace) = change(&edges(&element.corners, corner), &inverse);
            let u_rows = each!(3, row => each!(3, column => u[column][row]));
            let squares = dot(&u[0], &u_rows[0]) + dot(&u[1], &u_rows[1]) + dot(&u[2], &u_rows[2]);
            shares[corner] = volume * squares.mul_add(shear, spread * trace * trace);
        }
        L::splat(0.0)
    }
}
