//! The quantities from which diagnostics are computed: volumes of elements, and the best rigid placement.

use super::body::Body;

use super::crew::Crew;
use super::diagnostics::{BodyFacts, Lazy};
use super::element;
use super::element::ElementKind;
use super::fill;
use super::gather::Group;
use super::lanes::{Lanes, Set, Work, each};
use super::model::Report;
use super::placement::Placement;
use super::rotation::{self, moment};
use super::state::Nodes;
use glam::{DMat3, DVec3};
use std::ops::{Add, Mul, Range, Sub};
use std::sync::Arc;

/// Elements in one task of a thread.
const CHUNK: usize = 1024;

/// The precomputed part of the diagnostics of a body.
pub(crate) struct Diagnose {
    body: Arc<Body>,
    /// Signed volume of each element at rest (m³, in the plane m²). It is zero for segments, triangles in space and all
    /// elements that are flat at rest, which therefore never count as turned over.
    volumes_at_rest: Vec<f64>,
    /// The sum of what is filled of them.
    volume_at_rest: f64,
    /// The elements without a volume from faces.
    affine: Vec<Affine>,
    /// Mean of the rest positions (m).
    rest_centre: DVec3,
    /// Rest positions relative to their mean (m).
    centred: Vec<DVec3>,
}

/// An element without a table of faces. Its volume is that of the affine map that fits it best, `det(Σ r R0ᵀ (Σ R0
/// R0ᵀ)⁻¹)` times its volume at rest.
struct Affine {
    element: usize,
    /// `(Σ R0 R0ᵀ)⁻¹` (1/m²).
    inverse: DMat3,
    /// `R0` of its corners (m).
    rest: Vec<DVec3>,
}

impl Diagnose {
    /// Precomputes the quantities of the body at rest.
    pub(crate) fn new(body: &Arc<Body>) -> Self {
        let affine = Affine::all(body);
        let volumes_at_rest = at_rest(body, &affine);
        let volume_at_rest = fill::volume(body.fill.as_deref(), &volumes_at_rest);
        let rest_centre = mean(&body.rest);
        let centred = body.rest.iter().map(|&rest| rest - rest_centre).collect();
        Self { body: Arc::clone(body), volumes_at_rest, volume_at_rest, affine, rest_centre, centred }
    }

    /// The quantities that the diagnostics of a state need, each computed at its first use. `report` gives energy and residuals.
    pub(super) fn facts<'a>(
        &'a self,
        state: Nodes<'a>,
        global_rotations: f64,
        report: impl FnOnce() -> Report + 'a,
        crew: &'a Crew,
    ) -> BodyFacts<'a> {
        BodyFacts {
            mass: &self.body.mass,
            state,
            global_rotations,
            report: Lazy::new(Box::new(report)),
            volumes: Lazy::new(Box::new(move || self.volumes(state.position, crew))),
            volumes_at_rest: &self.volumes_at_rest,
            fill: self.body.fill.as_deref(),
            volume_at_rest: self.volume_at_rest,
            placement: Lazy::new(Box::new(move || self.placement(state.position))),
            centred: &self.centred,
        }
    }

    /// Signed volume of each element (m³, in the plane m²).
    fn volumes(&self, position: &[DVec3], crew: &Crew) -> Vec<f64> {
        let mut volumes = volumes_by_faces(&self.body, position, crew);
        let measured = crew.map(self.affine.len(), |at| self.affine[at].stretch(&self.body, position));
        for (affine, stretch) in self.affine.iter().zip(measured) {
            volumes[affine.element] = stretch * self.volumes_at_rest[affine.element];
        }
        volumes
    }

    /// The rigid placement of the rest shape that is nearest to the nodes.
    fn placement(&self, position: &[DVec3]) -> Placement {
        let centre = mean(position);
        let at_rest = moment(&self.centred, position.iter().map(|&position| position - centre));
        let turn = rotation::best(self.body.dimension, at_rest);
        Placement { rest_centre: self.rest_centre, centre, turn }
    }
}

/// Corners are taken to lie in a plane if the determinant of their second moments, relative to that of a ball, is below
/// this.
///
/// Round-off gives 1e-16 for corners in a plane; a plate a thousand times wider than thick has 1e-6.
const FLAT: f64 = 1e-12;

impl Affine {
    /// All of a body.
    fn all(body: &Body) -> Vec<Self> {
        (0..body.elements.len()).filter_map(|element| Self::new(body, element)).collect()
    }

    /// `None` for a flat element, and for an element with a volume from its faces.
    fn new(body: &Body, element: usize) -> Option<Self> {
        if body.kinds[element] != ElementKind::Other {
            return None;
        }
        let corners: Vec<_> = body.elements[element].iter().map(|&node| body.rest[node as usize]).collect();
        let centre = mean(&corners);
        let rest: Vec<_> = corners.iter().map(|&corner| corner - centre).collect();
        let moments = moment(&rest, rest.iter().copied());
        let mean_moment = (moments.x_axis.x + moments.y_axis.y + moments.z_axis.z) / 3.0;
        let is_flat = moments.determinant() <= FLAT * mean_moment * mean_moment * mean_moment;
        (!is_flat).then(|| Self { element, inverse: moments.inverse(), rest })
    }

    /// The volume divided by the volume at rest.
    fn stretch(&self, body: &Body, position: &[DVec3]) -> f64 {
        let corners: Vec<_> = body.elements[self.element].iter().map(|&node| position[node as usize]).collect();
        let centre = mean(&corners);
        let relative: Vec<_> = corners.iter().map(|&corner| corner - centre).collect();
        (moment(&relative, self.rest.iter().copied()) * self.inverse).determinant()
    }
}

/// Signed volume of each element at rest (m³, in the plane m²); zero for segments, triangles in space and all elements
/// that are flat at rest.
pub fn volumes_at_rest(body: &Body) -> Vec<f64> {
    at_rest(body, &Affine::all(body))
}

/// The same, with the elements without a table of faces.
fn at_rest(body: &Body, affine: &[Affine]) -> Vec<f64> {
    let mut volumes = volumes_by_faces(body, &body.rest, &Crew::new(1));
    for Affine { element, .. } in affine {
        volumes[*element] = hull_volume(body, *element);
    }
    volumes
}

/// Signed volume of each element from its faces (m³, in the plane m²); zero for elements without faces of their own.
fn volumes_by_faces(body: &Body, position: &[DVec3], crew: &Crew) -> Vec<f64> {
    let (set, count) = (Set::best(), body.elements.len());
    let of_chunk =
        |chunk: usize| set.run(Measure { body, position, range: chunk * CHUNK..count.min((chunk + 1) * CHUNK) });
    crew.map(count.div_ceil(CHUNK), of_chunk).concat()
}

/// Computes the volumes of consecutive elements from their faces.
struct Measure<'a> {
    body: &'a Body,
    position: &'a [DVec3],
    range: Range<usize>,
}

impl Work for Measure<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<f64> {
        let Self { body, position, range: Range { start: first, end } } = self;
        let mut volumes = vec![0.0; end - first];
        let mut at = first;
        while at < end {
            let kind = body.kinds[at];
            let (group, count) =
                Group::take::<L>(at..end, |element| &body.elements[element], |element| body.kinds[element] == kind);
            let volumes = &mut volumes[at - first..][..count];
            match kind {
                ElementKind::Segment | ElementKind::Triangle | ElementKind::Other => {}
                ElementKind::Polygon => {
                    for (volume, element) in volumes.iter_mut().zip(at..) {
                        *volume = volume_by_faces(kind, &body.elements[element], position);
                    }
                }
                _ => {
                    let origin = group.vector::<L>(0, position);
                    let mut corners = [[L::splat(0.0); 3]; 8];
                    for (corner, relative) in corners[..group.corners()].iter_mut().enumerate() {
                        let vector = group.vector::<L>(corner, position);
                        *relative = each!(3, axis => vector[axis] - origin[axis]);
                    }
                    volumes.copy_from_slice(&inside(kind, &corners).to_array()[..count]);
                }
            }
            at += count;
        }
        volumes
    }
}

/// Signed volume (m³) inside the faces of an element, or signed area (m²) of a polygon.
///
/// A face with more than three corners is the mean of its fans of triangles from every corner. For a quadrilateral
/// that is exactly the bilinear patch, so a hexahedron gets the volume of its trilinear map.
pub fn volume_by_faces(kind: ElementKind, nodes: &[u32], position: &[DVec3]) -> f64 {
    if kind == ElementKind::Polygon {
        // Relative to the first node, to keep precision far from the origin.
        let origin = position[nodes[0] as usize];
        let at = |node: u32| position[node as usize] - origin;
        return 0.5 * element::around(nodes).map(|[a, b]| at(a).cross(at(b)).z).sum::<f64>();
    }
    // Relative to the first corner, for the same reason. An element with a table of faces has at most eight corners.
    let mut corners = [[0.0; 3]; 8];
    for (corner, &node) in corners.iter_mut().zip(nodes) {
        *corner = (position[node as usize] - position[nodes[0] as usize]).to_array();
    }
    inside(kind, &corners)
}

/// A scalar, or a vector of lanes.
trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    fn new(value: f64) -> Self;
    fn over(self, divisor: f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn new(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn over(self, divisor: f64) -> Self {
        self / divisor
    }
}

impl<L: Lanes> Number for L {
    #[inline(always)]
    fn new(value: f64) -> Self {
        L::splat(value)
    }

    #[inline(always)]
    fn over(self, divisor: f64) -> Self {
        self.div(L::splat(divisor))
    }
}

/// Signed volume (m³) inside the faces of an element with these corners.
#[inline(always)]
fn inside<T: Number>(kind: ElementKind, corners: &[[T; 3]; 8]) -> T {
    let mut volume = T::new(0.0);
    for face in element::face_table(kind) {
        let part = match **face {
            [a, b, c] => triple(at(corners, a), at(corners, b), at(corners, c)).over(6.0),
            // Each of the four triangles of two adjacent corners and a third one occurs in two fans.
            [a, b, c, d] => {
                let (a, b, c, d) = (at(corners, a), at(corners, b), at(corners, c), at(corners, d));
                (triple(a, minus(b, d), c) + triple(b, minus(c, a), d)).over(12.0)
            }
            _ => unreachable!("elements of a kind have triangles and quadrilaterals"),
        };
        volume = volume + part;
    }
    volume
}

#[inline(always)]
fn at<T: Number>(corners: &[[T; 3]; 8], corner: u8) -> [T; 3] {
    corners[usize::from(corner & 7)]
}

#[inline(always)]
fn minus<T: Number>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The triple product `a · (b × c)`, six times the signed volume (m³) between the origin and a triangle.
#[inline(always)]
fn triple<T: Number>(a: [T; 3], b: [T; 3], c: [T; 3]) -> T {
    let cross = [b[1] * c[2] - c[1] * b[2], b[2] * c[0] - c[2] * b[0], b[0] * c[1] - c[0] * b[1]];
    a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]
}

/// The volume inside the hull of an element at rest (m³).
fn hull_volume(body: &Body, element: usize) -> f64 {
    let origin = body.rest[body.elements[element][0] as usize];
    let at = |node: u32| body.rest[node as usize] - origin;
    let of_face = |face: &[u32]| -> f64 {
        (2..face.len()).map(|step| at(face[0]).dot(at(face[step - 1]).cross(at(face[step])))).sum()
    };
    body.hulls.of(element).map(of_face).sum::<f64>() / 6.0
}

fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().fold(DVec3::ZERO, |sum, &point| sum + point) / points.len() as f64
}

#[cfg(test)]
mod tests {
    use super::super::diagnostics::{Diagnostic, Diagnostics, Facts, is_flat, is_turned_over};
    use super::*;
    use crate::element::{Dimension, Solids};
    use crate::lists::IndexLists;
    use crate::state::State;
    use glam::DQuat;

    fn at_rest(rest: Vec<DVec3>) -> Diagnostics {
        let mut elements = IndexLists::default();
        elements.push(&(0..rest.len() as u32).collect::<Vec<_>>());
        let body =
            Arc::new(Body::new(Dimension::Space, rest.clone(), vec![1.0; rest.len()], elements, Solids::Ordered, None));
        diagnostics(&Diagnose::new(&body), &State::at_rest(rest))
    }

    fn diagnostics(diagnose: &Diagnose, state: &State) -> Diagnostics {
        let crew = Crew::new(1);
        let bodies = [diagnose.facts(state.nodes(), 0.0, Report::default, &crew)];
        Diagnostics::of(Facts { bodies: &bodies, gravity: DVec3::ZERO }, Diagnostic::ALL)
    }

    /// An element with seven corners has no table of faces: its volume is the affine estimate.
    fn heptad(thickness: f64) -> Vec<DVec3> {
        let tilt = DQuat::from_xyzw(0.1, -0.2, 0.3, 0.9).normalize();
        let corner = |at: u32| {
            DVec3::new(f64::from(at % 3), f64::from(at / 3), thickness * f64::from(at * at % 5)) * 0.1 + DVec3::ONE
        };
        (0..7).map(|at| tilt * corner(at)).collect()
    }

    #[test]
    fn what_is_flat_in_space_has_no_volume_and_cannot_turn_over() {
        for flat in [heptad(0.0), heptad(0.0)[..3].to_vec(), heptad(0.0)[..2].to_vec()] {
            let diagnostics = at_rest(flat);
            assert!(diagnostics.volume_ratio.is_nan());
            assert_eq!(diagnostics.turned_over, 0);
            assert!(diagnostics.shape_error < 1e-15);
        }
    }

    #[test]
    fn a_thin_element_without_faces_has_a_volume() {
        for thickness in [1.0, 1e-3] {
            assert!((at_rest(heptad(thickness)).volume_ratio - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn what_is_pressed_flat_has_not_turned_over_however_it_lies() {
        let corner = |bit: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1)));
        let rest: Vec<_> = (0..8).map(corner).collect();
        let elements = [&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter().collect();
        let body = Body::new(Dimension::Space, rest.clone(), vec![1.0; 8], elements, Solids::Ordered, None);
        let diagnose = Diagnose::new(&Arc::new(body));
        let over = |height: f64, turn: u32| {
            let tilt = DQuat::from_xyzw(0.1, -0.2, 0.01 * f64::from(turn), 0.9).normalize();
            let place = |at: &DVec3| tilt * (*at * DVec3::new(1.0, 1.0, height)) + DVec3::new(3.0, -2.0, 1.0);
            let now = State::at_rest(rest.iter().map(place).collect());
            diagnostics(&diagnose, &now).turned_over
        };
        assert!((0..100).all(|turn| over(0.0, turn) == 0));
        assert!((0..100).all(|turn| over(-0.9e-3, turn) == 0));
        assert!((0..100).all(|turn| over(-1.1e-3, turn) == 1));
    }

    /// Elements of every kind, one by one and in runs longer and shorter than the lanes of any vector set.
    #[test]
    fn every_set_measures_the_same_volumes() {
        let place = |at: u32| (at.wrapping_mul(2_654_435_761) >> 8) as f64 / f64::from(1u32 << 24);
        let node = |node: u32| DVec3::new(place(3 * node), place(3 * node + 1), place(3 * node + 2));
        let counts = [8, 4, 5, 6, 8, 8, 6, 7, 3, 2].into_iter().chain([8; 21]).chain([4; 13]).chain([6; 9]);
        let mut elements = IndexLists::default();
        for (first, count) in (0..).zip(counts) {
            elements.push(&(0..count).map(|corner| first + 3 * corner).collect::<Vec<u32>>());
        }
        let rest: Vec<_> = (0..100).map(node).collect();
        let body = Body::new(Dimension::Space, rest, vec![1.0; 100], elements, Solids::Ordered, None);
        let alone = |element: usize| match body.kinds[element] {
            ElementKind::Segment | ElementKind::Triangle | ElementKind::Other => 0.0,
            kind => volume_by_faces(kind, &body.elements[element], &body.rest),
        };
        let alone: Vec<_> = (0..body.elements.len()).map(alone).collect();
        assert!(alone.iter().filter(|&&volume| volume != 0.0).count() > 40);
        for set in Set::all() {
            let volumes = set.run(Measure { body: &body, position: &body.rest, range: 0..alone.len() });
            assert_eq!(
                volumes.iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
                alone.iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
                "{set:?}"
            );
        }
    }

    #[test]
    fn an_element_is_flat_below_a_hundredth_of_its_volume_and_turned_over_below_minus_a_thousandth() {
        let cases = [(0.011, [false; 2]), (0.009, [true, false]), (0.0, [true, false]), (-0.9e-3, [true, false])];
        for (part, expected) in cases.into_iter().chain([(-1.1e-3, [false, true]), (-0.5, [false, true])]) {
            for at_rest in [1.0, 2e-6, -3.0] {
                let now = part * at_rest;
                assert_eq!([is_flat(now, at_rest), is_turned_over(now, at_rest)], expected, "{part} of {at_rest}");
            }
        }
        assert!(!is_turned_over(-1.0, 0.0), "what has no volume cannot turn over");
        assert!(!is_flat(0.0, 0.0), "what has no volume cannot lose it");
    }

    #[test]
    fn hulls_count_with_their_own_volume() {
        // An octahedron of volume 4/3, squashed to a half, above a cube of volume 1 that keeps its shape.
        let octahedron = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
        let cube =
            (0..8u32).map(|bit| DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1))) - DVec3::Y * 3.0);
        let rest: Vec<_> = octahedron.into_iter().chain(cube).collect();
        let elements = [&[0, 1, 2, 3, 4, 5][..], &[6, 7, 8, 9, 10, 11, 12, 13]].into_iter().collect();
        let body = Body::new(Dimension::Space, rest.clone(), vec![1.0; 14], elements, Solids::Convex, None);
        let mut now = rest;
        now[..6].iter_mut().for_each(|corner| corner.y *= 0.5);
        let ratio = diagnostics(&Diagnose::new(&Arc::new(body)), &State::at_rest(now)).volume_ratio;
        assert!((ratio - (2.0 / 3.0 + 1.0) / (4.0 / 3.0 + 1.0)).abs() < 1e-12, "{ratio}");
    }
}
