//! Volumes of elements.

use super::body::Body;
use super::crew::Crew;
use super::element;
use super::element::ElementKind;
use super::gather::Group;
use super::lanes::{Lanes, One, Set, Work, each};
use super::rotation::moment;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// An element without a table of faces. Its volume is that of the affine map that fits it best, `det(Σ r R0ᵀ (Σ R0
/// R0ᵀ)⁻¹)` times its volume at rest.
pub(super) struct Affine {
    pub(super) element: usize,
    /// `(Σ R0 R0ᵀ)⁻¹` (1/m²).
    inverse: DMat3,
    /// `R0` of its corners (m).
    rest: Vec<DVec3>,
}

/// Corners are taken to lie in a plane if the determinant of their second moments, relative to that of a ball, is below
/// this.
///
/// Round-off gives 1e-16 for corners in a plane; a plate a thousand times wider than thick has 1e-6.
const FLAT: f64 = 1e-12;

impl Affine {
    /// All of a body.
    pub(super) fn all(body: &Body) -> Vec<Self> {
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
    pub(super) fn stretch(&self, body: &Body, position: &[DVec3]) -> f64 {
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

/// The part of the volume at rest of each node (m³, in the plane m²): what is filled of each element is shared equally by its
/// nodes.
pub fn node_volumes(body: &Body) -> Vec<f64> {
    let mut shares = vec![0.0; body.len()];
    for (element, (nodes, volume)) in body.elements.iter().zip(volumes_at_rest(body)).enumerate() {
        let filled = body.fill.as_ref().map_or(1.0, |fill| fill[element]);
        let share = volume * filled / nodes.len() as f64;
        nodes.iter().for_each(|&node| shares[node as usize] += share);
    }
    shares
}

/// The same as [`volumes_at_rest`], with the elements without a table of faces.
pub(super) fn at_rest(body: &Body, affine: &[Affine]) -> Vec<f64> {
    let mut volumes = volumes_by_faces(body, &body.rest, &Crew::new(1));
    for Affine { element, .. } in affine {
        volumes[*element] = hull_volume(body, *element);
    }
    volumes
}

/// Signed volume of each element from its faces (m³, in the plane m²); zero for elements without faces of their own.
pub(super) fn volumes_by_faces(body: &Body, position: &[DVec3], crew: &Crew) -> Vec<f64> {
    let set = Set::best();
    crew.map_chunks(body.elements.len(), |range| set.run(Measure { body, position, range })).concat()
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
    let mut corners = [[One::splat(0.0); 3]; 8];
    for (corner, &node) in corners.iter_mut().zip(nodes) {
        *corner = (position[node as usize] - position[nodes[0] as usize]).to_array().map(One::splat);
    }
    inside(kind, &corners).to_array()[0]
}

/// Signed volume (m³) inside the faces of an element with these corners.
#[inline(always)]
fn inside<L: Lanes>(kind: ElementKind, corners: &[[L; 3]; 8]) -> L {
    let mut volume = L::splat(0.0);
    for face in element::face_table(kind) {
        let part = match **face {
            [a, b, c] => triple(at(corners, a), at(corners, b), at(corners, c)) / L::splat(6.0),
            // Each of the four triangles of two adjacent corners and a third one occurs in two fans.
            [a, b, c, d] => {
                let (a, b, c, d) = (at(corners, a), at(corners, b), at(corners, c), at(corners, d));
                (triple(a, minus(b, d), c) + triple(b, minus(c, a), d)) / L::splat(12.0)
            }
            _ => unreachable!("elements of a kind have triangles and quadrilaterals"),
        };
        volume = volume + part;
    }
    volume
}

#[inline(always)]
fn at<L: Lanes>(corners: &[[L; 3]; 8], corner: u8) -> [L; 3] {
    corners[usize::from(corner & 7)]
}

#[inline(always)]
fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The triple product `a · (b × c)`, six times the signed volume (m³) between the origin and a triangle.
#[inline(always)]
fn triple<L: Lanes>(a: [L; 3], b: [L; 3], c: [L; 3]) -> L {
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

/// The mean of points.
pub(super) fn mean(points: &[DVec3]) -> DVec3 {
    points.iter().fold(DVec3::ZERO, |sum, &point| sum + point) / points.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::lists::IndexLists;

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
        let body = Body::builder(rest).elements(elements).build().expect("a body");
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
}
