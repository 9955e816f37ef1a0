//! Springs and a pressure that keeps the volume of each element (Ref. 3 of the paper: Terasawa and Kimura 1992).
//!
//! Beside the springs of Eq. (1) each element of volume `V0` at rest has the energy `½ κ (V − V0)² / V0`, with the bulk modulus `κ`: a pressure
//! `−κ (V − V0) / V0`, times `∂V/∂x` on each corner. A penalty of that kind keeps the volumes of Teschner and others 2004 ("A versatile and
//! robust model for geometrically complex deformable solids", Computer Graphics International, 312), on tetrahedra; Hong and others 2006 ("Fast
//! volume preservation for a mass-spring system", IEEE Computer Graphics and Applications) project on the volume inside the whole closed
//! surface instead, along the same `∂V/∂x`.
//!
//! **Our reading** is one volume for each element, because a body of many elements can keep its whole volume while some of them are pressed
//! flat, because elements that are filled in part or differ in size then have theirs, and because forces stay local. `V` is `V0 det F` with `F` the
//! linear map that fits the corners best: the volume inside the faces for triangles and tetrahedra, and for any element that is mapped affinely. In other elements
//! it leaves out the warping, which springs resist.
//!
//! The paper's objection is that a volume is "merely a necessary condition for the shape restoration". A square that is pressed
//! to half of its height and twice its width has its volume: nothing but the springs pulls it back. One that is pressed flat to a line
//! may fold on the way back, with all its volumes, and stay so: `scenes/volume-kept.toml`.
//!
//! The model is a sum of two laws in one: its elements are the springs, which have two nodes, and those of the body.

use super::continuum::{Map, cofactors, dot};
#[cfg(feature = "scene")]
use super::mass_spring;
use super::mass_spring::{MassSpring, natural_length};
use super::{
    ByLaw, Corners, ElasticModel, Element, ForceModel, Lanes, Law, Properties, Setting, Vectorised, volumes_at_rest,
};
use crate::body::Body;
use crate::element::Dimension;
use crate::fill;
use crate::lanes::each;
use crate::lists::IndexLists;
use crate::material;
use glam::DMat3;
#[cfg(feature = "scene")]
use std::collections::BTreeMap;
use std::sync::Arc;

#[cfg(feature = "scene")]
mass_spring::parameters! {
    /// Bulk modulus `κ`, by which each element resists changes of its volume (Pa; N/m in the plane). Of a cube of side `a` that counts in the
    /// cycle T as a stiffness of `3κa/2`, of a square as `2κ`, if it is greater than `stiffness`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    bulk: f64,
}

/// The model with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeSprings {
    /// The springs.
    pub springs: MassSpring,
    /// Bulk modulus `κ` of the elements (Pa; N/m in the plane).
    pub bulk: f64,
}

#[cfg(feature = "scene")]
impl Parameters {
    /// A model with this elastic constant (N/m) and this bulk modulus (Pa); the other parameters have their defaults.
    pub fn new(stiffness: f64, bulk: f64) -> Self {
        Self { stiffness, bulk, damping: None, damping_ratio: None, springs: None }
    }
}

#[cfg(feature = "scene")]
impl super::TypedModel for Parameters {
    fn resolve(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, super::Misfit> {
        // The schema has the same bound; scenes made in code pass it by.
        if !(self.bulk > 0.0 && self.bulk.is_finite()) {
            let message = format!("`bulk` is {}; expected a modulus above 0 (Pa)", self.bulk);
            return Err(super::Misfit { key: "bulk", message });
        }
        if !volumes_at_rest(body).iter().any(|&volume| volume > 0.0) {
            let measure = if body.dimension == Dimension::Plane { "area" } else { "volume" };
            let message =
                format!("no element has {measure} that `bulk` could keep; take `kind = \"mass-spring\"` without it");
            return Err(super::Misfit { key: "bulk", message });
        }
        Ok(Arc::new(VolumeSprings { springs: self.of_springs().model(body, listed)?, bulk: self.bulk }))
    }

    fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.of_springs().most(elements, listed)
    }
}

impl ElasticModel for VolumeSprings {
    /// The stiffness of an element against changes of its volume may be greater than that of a spring. At rest it is `κ V0 Σ |b|²` with
    /// the gradient `V0 b` of the volume at each corner.
    fn properties(&self, body: &Body) -> Properties {
        let of_volumes = body.elements.iter().zip(volumes_at_rest(body)).filter(|&(_, volume)| volume > 0.0);
        let stiffness = of_volumes.map(|(nodes, volume)| self.bulk * volume * spread(body, nodes));
        let stiffest = stiffness.fold(self.springs.stiffness, f64::max);
        let unit = if body.dimension == Dimension::Plane { "N/m" } else { "Pa" };
        let own = self.springs.of_springs("volume-springs").with("bulk", Setting::Number(self.bulk, unit));
        Properties { stiffest, ..own }
    }

    fn springs(&self) -> &[[u32; 2]] {
        &self.springs.springs
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(ByLaw::new(Sum::new(self, body), body))
    }
}

impl Vectorised for VolumeSprings {
    fn compile(&self, body: &Arc<Body>, conditions: &crate::kernel::Conditions) -> crate::kernel::Compiled {
        Sum::new(self, body).compile(body, conditions)
    }
}

/// `Σ |b|²` of an element (1/m²): the trace of `M⁻¹`.
fn spread(body: &Body, nodes: &[u32]) -> f64 {
    let (_, [xx, yy, zz, xy, xz, yz]) = material::spread(body, nodes);
    let flat = body.dimension == Dimension::Plane;
    let zz = if flat { 1.0 } else { zz };
    let inverse = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]).inverse();
    inverse.x_axis.x + inverse.y_axis.y + if flat { 0.0 } else { inverse.z_axis.z }
}

/// Springs and elements with a volume, in lanes. The relative stiffness of an element is its filled volume at rest.
#[derive(Clone)]
struct Sum {
    springs: MassSpring,
    /// `κ` (Pa).
    bulk: f64,
    is_plane: bool,
}

impl Sum {
    fn new(model: &VolumeSprings, body: &Body) -> Self {
        Self { springs: model.springs.clone(), bulk: model.bulk, is_plane: body.dimension == Dimension::Plane }
    }

    /// `F` of elements, column by column.
    #[inline(always)]
    fn map<L: Lanes>(&self, element: &Element<'_, L>) -> Map<L, 3> {
        let (zero, (first, _)) = (L::splat(0.0), element.corner(0));
        let mut map = [[zero; 3]; 3];
        for corner in 1..element.corners() {
            let (p, _) = element.corner(corner);
            let r = each!(3, axis => p[axis] - first[axis]);
            map = each!(3, column => each!(3, row => r[row].mul_add(element.of_corner(corner, column), map[column][row])));
        }
        if self.is_plane {
            map[2][2] = L::splat(1.0);
        }
        map
    }
}

impl Law for Sum {
    /// `k L` of a spring (N).
    const OF_ELEMENT: usize = 1;
    /// `b = M⁻¹ R0` of a corner of an element (1/m), so that `F = Σ r bᵀ`.
    const OF_CORNER: usize = 3;
    /// First the force on the first node of a spring; or `κ (det F − 1)` times the cofactors of `F`.
    type Whole<L: Lanes> = Map<L, 3>;

    fn elements(&self, body: &Body) -> Option<IndexLists> {
        let with_volume = body.elements.iter().zip(volumes_at_rest(body)).filter(|&(_, volume)| volume > 0.0);
        let springs = self.springs.springs.iter().map(|ends| &ends[..]);
        Some(springs.chain(with_volume.map(|(nodes, _)| nodes)).collect())
    }

    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        let of_springs = self.springs.parts(body).unwrap_or_else(|| vec![1.0; self.springs.springs.len()]);
        let of_elements = fill::product(Some(&volumes_at_rest(body)), fill::of_materials(body).as_deref());
        Some(of_springs.into_iter().chain(of_elements.into_iter().flatten().filter(|&volume| volume > 0.0)).collect())
    }

    fn is_damped(&self) -> bool {
        self.springs.damping > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        if rest.count() == 2 {
            of_element[0] = L::splat(self.springs.stiffness) * natural_length(rest);
            return;
        }
        let (first, part) = (rest.position(0), L::splat(1.0 / rest.count() as f64));
        let (mut middle, mut squares) = ([zero; 3], [zero; 6]);
        for corner in 0..rest.count() {
            let p = rest.position(corner);
            middle = each!(3, axis => middle[axis] + (p[axis] - first[axis]) * part);
        }
        for corner in 0..rest.count() {
            let p = rest.position(corner);
            let r = each!(3, axis => p[axis] - first[axis] - middle[axis]);
            each!(3, axis => of_corner[3 * corner + axis] = r[axis]);
            let products = [r[0] * r[0], r[1] * r[1], r[2] * r[2], r[0] * r[1], r[0] * r[2], r[1] * r[2]];
            for entry in 0..6 {
                squares[entry] = squares[entry] + products[entry];
            }
        }
        let [xx, yy, zz, xy, xz, yz] = squares;
        // In the plane R0 has no third coordinate, and the third column counts nowhere.
        let zz = if self.is_plane { one } else { zz };
        let moment = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let inverse = cofactors(&moment);
        let determinant = dot(&moment[0], &inverse[0]);
        for corner in 0..rest.count() {
            let r = each!(3, axis => of_corner[3 * corner + axis]);
            each!(3, axis => of_corner[3 * corner + axis] = dot(&inverse[axis], &r) / determinant);
        }
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> Map<L, 3> {
        if element.corners() == 2 {
            return [self.springs.force::<L, true>(element), [L::splat(0.0); 3], [L::splat(0.0); 3]];
        }
        let map = self.map(element);
        let cofactors = cofactors(&map);
        let pressure = L::splat(self.bulk) * (dot(&map[0], &cofactors[0]) - L::splat(1.0));
        each!(3, column => each!(3, row => pressure * cofactors[column][row]))
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, whole: &Map<L, 3>) -> [L; 3] {
        let [x, y, z] = whole;
        if element.corners() == 2 {
            return if corner == 0 { *x } else { each!(3, axis => -x[axis]) };
        }
        let b = each!(3, axis => element.of_corner(corner, axis));
        each!(3, row => -z[row].mul_add(b[2], y[row].mul_add(b[1], x[row] * b[0])))
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let energy = if element.corners() == 2 {
            self.springs.energy(element, rest)
        } else {
            let map = self.map(element);
            let excess = dot(&map[0], &cofactors(&map)[0]) - L::splat(1.0);
            L::splat(0.5 * self.bulk) * excess * excess
        };
        shares.fill(energy * L::splat(1.0 / element.corners() as f64));
        L::splat(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::integrate::Integrator;
    use crate::state::State;
    use crate::surroundings::Surroundings;
    use crate::topology::Springs;
    use crate::world::{Stepping, World};
    use glam::DVec3;

    /// A square of 1 m with springs at its sides and diagonals, and a node of 1 kg at each corner.
    fn square() -> (Arc<Body>, MassSpring) {
        let rest = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let elements = [&[0, 1, 2, 3][..]].into_iter().collect();
        let body = Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a body");
        let springs = body.topology().springs(Springs::EdgesFaceDiagonals).into();
        (Arc::new(body), MassSpring { stiffness: 10.0, damping: 1.0, springs, breaks_at: None })
    }

    fn world(model: &dyn ElasticModel, map: impl Fn(DVec3) -> DVec3) -> World {
        let (body, _) = square();
        let start = State::at_rest(body.rest.iter().copied().map(map).collect());
        let stepping = Stepping::new(Integrator::VelocityVerlet, 0.01);
        World::new(&body, start, model, Surroundings::default(), stepping)
    }

    #[test]
    fn a_flattened_square_that_has_its_volume_feels_springs_alone() {
        let (_, springs) = square();
        let flattened = |rest: DVec3| DVec3::new(4.0 * rest.x, 0.25 * rest.y, 0.0);
        let without = world(&springs, flattened).forces();
        let with = world(&VolumeSprings { springs, bulk: 1e6 }, flattened).forces();
        let far = with.iter().zip(&without).fold(0.0, |far: f64, (a, b)| far.max(a.distance(*b)));
        assert!(without[0].length() > 10.0 && far < 1e-8, "{far:e} of {without:?}");
    }

    /// A square that has turned over is smaller by a factor `α` with `8 k (1 − α) = 2 κ α (α² + 1)`, and stays so if `α > ¾`.
    #[test]
    fn a_square_that_has_turned_over_stays_so() {
        let (_, springs) = square();
        let bulk = 0.5 * springs.stiffness;
        let mut world = world(&VolumeSprings { springs, bulk }, |rest| DVec3::new(-0.9 * rest.x, 0.85 * rest.y, 0.0));
        world.advance(20_000);
        let side = |a: usize, b: usize| world.state().position[a].distance(world.state().position[b]);
        let root = 0.826_220_9;
        assert!(
            [side(0, 1), side(1, 2)].iter().all(|side| (side - root).abs() < 1e-5),
            "{} {}",
            side(0, 1),
            side(1, 2)
        );
        assert_eq!(world.diagnostics().turned_over, 1);
    }

    #[test]
    fn the_shortest_period_is_that_of_the_stiffer_of_both() {
        let (body, springs) = square();
        // Two sides of unit length: M = I.
        let period = |bulk| VolumeSprings { springs: springs.clone(), bulk }.properties(&body).shortest_period(&body);
        assert_eq!(period(0.1), springs.properties(&body).shortest_period(&body));
        assert!((period(50.0) - std::f64::consts::TAU / 10.0).abs() < 1e-12);
    }
}
