//! Elastic materials, and the stiffness of elements that are made of them.

use super::body::Body;
use super::element::Dimension;
use super::lanes::{Lanes, each};
use super::law::Corners;
use super::volume::volumes_at_rest;

/// An isotropic elastic material. In the plane, it is a sheet of unit thickness under plane stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus `E` (Pa; N/m in the plane).
    pub young: f64,
    /// Poisson's ratio `ν`.
    pub poisson: f64,
}

impl Material {
    /// The shear modulus `μ = E / 2(1 + ν)` (Pa; N/m in the plane).
    pub fn shear(&self) -> f64 {
        self.young / (2.0 * (1.0 + self.poisson))
    }

    /// `λ/μ`, with Lamé's first parameter `λ = E ν / ((1 + ν)(1 − (d − 1) ν))` in `d` dimensions.
    pub fn lame_over_shear(&self, dimension: Dimension) -> f64 {
        2.0 * self.poisson / (1.0 - (dimensions(dimension) - 1.0) * self.poisson)
    }

    /// Lamé's first parameter `λ` (Pa; N/m in the plane).
    pub fn lame(&self, dimension: Dimension) -> f64 {
        self.lame_over_shear(dimension) * self.shear()
    }

    /// The elastic constant `k` (N/m) with which each element of the shape model has the shear modulus of the material.
    ///
    /// With nodes `R0` about their mean, an element of volume `V` and stiffness `k` has the energy `k/2 Σ |ε R0|²` in a uniform strain
    /// `ε`. If the nodes spread alike in all of `d` directions, that is `μ V |ε|²` with `μ = k Σ |R0|² / 2 d V`.
    pub fn stiffness(&self, body: &Body) -> Vec<f64> {
        per_shear(body).into_iter().map(|per_shear| self.shear() * per_shear).collect()
    }

    /// The material that the shape model with an elastic constant `k` (N/m) of each element is, in uniform strain: `ν = 0`. `None` unless
    /// all elements have nodes that spread alike in all directions, and the same modulus.
    pub fn of_shapes(body: &Body, stiffness: &[f64]) -> Option<Self> {
        /// Relative to the modulus and to the mean spread.
        const ALIKE: f64 = 1e-9;
        let shears = stiffness.iter().zip(per_shear(body)).map(|(stiffness, per_shear)| stiffness / per_shear);
        let (low, high) = shears.fold((f64::INFINITY, 0.0_f64), |(low, high), shear| (low.min(shear), high.max(shear)));
        let is_one = high.is_finite() && high - low <= ALIKE * high;
        let spreads_alike = |nodes: &[u32]| {
            let (spread, [xx, yy, zz, xy, xz, yz]) = spread(body, nodes);
            let mean = spread / dimensions(body.dimension);
            let diagonal = if body.dimension == Dimension::Plane { [xx, yy, mean] } else { [xx, yy, zz] };
            let off = diagonal.iter().map(|entry| (entry - mean).abs()).chain([xy, xz, yz].map(f64::abs));
            off.fold(0.0, f64::max) <= ALIKE * mean
        };
        (is_one && body.elements.iter().all(spreads_alike)).then_some(Self { young: 2.0 * high, poisson: 0.0 })
    }
}

/// Damping `D` of elements in proportion to their elastic constants, as in the shape model. The stiffest one has the constant that is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Damping {
    /// `D` of the stiffest element (N s/m).
    pub(crate) most: f64,
    /// `D` for each metre of [`per_shear`] (N s/m²); 0 if all elements have the same.
    pub(crate) slope: f64,
}

impl Damping {
    /// Of the elements of a body.
    pub(crate) fn new(most: f64, body: &Body) -> Self {
        /// Equal stiffnesses differ by round-off only.
        const EQUAL: f64 = 1e-10;
        let each = per_shear(body);
        let (low, high) = each.iter().fold((f64::INFINITY, 0.0), |(low, high), &one| (one.min(low), one.max(high)));
        Self { most, slope: if high - low > EQUAL * high { most / high } else { 0.0 } }
    }

    /// `D` of elements in lanes, with their volumes (m³, in the plane m²).
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(&self, rest: &Corners<'_, L>, volume: L, dimensions: f64) -> L {
        if self.slope == 0.0 {
            return L::splat(self.most);
        }
        let (zero, first, part) = (L::splat(0.0), rest.position(0), L::splat(1.0 / rest.count() as f64));
        let (mut sum, mut squares) = ([zero; 3], zero);
        for corner in 1..rest.count() {
            let p = rest.position(corner);
            let [x, y, z] = each!(3, axis => p[axis] - first[axis]);
            sum = [sum[0] + x, sum[1] + y, sum[2] + z];
            squares = squares + (x * x + y * y + z * z);
        }
        let spread = squares - (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) * part;
        L::splat(2.0 * dimensions * self.slope) * volume / spread
    }
}

/// `2 d V / Σ |R0|²` of each element (m): its elastic constant for a shear modulus of 1.
pub(crate) fn per_shear(body: &Body) -> Vec<f64> {
    let factor = 2.0 * dimensions(body.dimension);
    let of = |(nodes, volume): (&[u32], f64)| factor * volume / spread(body, nodes).0;
    body.elements.iter().zip(volumes_at_rest(body)).map(of).collect()
}

/// `Σ |R0|²` of an element, and `Σ R0 R0ᵀ` as xx, yy, zz, xy, xz, yz (m²).
pub(crate) fn spread(body: &Body, nodes: &[u32]) -> (f64, [f64; 6]) {
    let rest = || nodes.iter().map(|&node| body.rest[node as usize]);
    let middle = rest().sum::<glam::DVec3>() / nodes.len() as f64;
    let mut sums = [0.0; 6];
    for at in rest().map(|rest| rest - middle) {
        let products = [at.x * at.x, at.y * at.y, at.z * at.z, at.x * at.y, at.x * at.z, at.y * at.z];
        sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
    }
    (sums[0] + sums[1] + sums[2], sums)
}

fn dimensions(dimension: Dimension) -> f64 {
    match dimension {
        Dimension::Plane => 2.0,
        Dimension::Space => 3.0,
    }
}
