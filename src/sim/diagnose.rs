//! What the diagnostics of a state are computed from: volumes of elements, and the best rigid placement.

use super::body::{Body, ElementKind};
use super::diagnostics::{Diagnostic, Diagnostics, Facts, Lazy, Volumes};
use super::model::Report;
use super::rotation::{self, moment};
use super::snapshot::Placement;
use super::state::Nodes;
use super::topology;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Threads measure no fewer elements than this at a time.
const LEAST_ELEMENTS: usize = 1024;

/// What is known of a body beforehand.
pub(crate) struct Diagnose {
    body: Arc<Body>,
    sizes: Vec<ElementSize>,
    /// Total volume at rest (m³, in the plane m²).
    volume_at_rest: f64,
    /// Mean of the rest positions (m).
    rest_centre: DVec3,
    /// Rest positions relative to their mean (m).
    centred: Vec<DVec3>,
}

/// How the signed volume of an element is measured.
enum ElementSize {
    /// By its faces; `at_rest` is its signed volume at rest (m³, in the plane m²).
    Faces { at_rest: f64 },
    /// By the affine map that fits it best: `det(Σ r R0ᵀ (Σ R0 R0ᵀ)⁻¹)` times the rest volume.
    Affine { at_rest: f64, inverse: DMat3, rest: Vec<DVec3> },
    /// A segment, a triangle in space or anything else that is flat there has none and never turns over.
    None,
}

impl Diagnose {
    /// Measures the body at rest.
    pub(crate) fn new(body: &Arc<Body>) -> Self {
        let sizes: Vec<_> = (0..body.elements.len()).map(|element| element_size(body, element)).collect();
        let volume_at_rest = sizes
            .iter()
            .map(|size| match size {
                ElementSize::Faces { at_rest } | ElementSize::Affine { at_rest, .. } => *at_rest,
                ElementSize::None => 0.0,
            })
            .sum();
        let rest_centre = mean(&body.rest);
        let centred = body.rest.iter().map(|&rest| rest - rest_centre).collect();
        Self { body: Arc::clone(body), sizes, volume_at_rest, rest_centre, centred }
    }

    /// The diagnostics of a state, whether each element is turned over, and the best rigid placement of the body.
    pub(crate) fn state(
        &self,
        state: Nodes<'_>,
        gravity: DVec3,
        report: &Report,
    ) -> (Diagnostics, Vec<bool>, Placement) {
        let facts = self.facts(state, gravity, || report.clone());
        let all = Diagnostics::of(&facts, |_| true);
        (all, facts.volumes.turned_over.clone(), *facts.placement)
    }

    /// Some diagnostics of a state; the others are zero. What no one of them needs is not computed.
    pub(crate) fn some(
        &self,
        state: Nodes<'_>,
        gravity: DVec3,
        report: impl FnOnce() -> Report,
        wanted: &[Diagnostic],
    ) -> Diagnostics {
        use Diagnostic::{Elastic, Energy, Gravitational, Kinetic};
        let is_part = |one| wanted.contains(&Energy) && [Kinetic, Elastic, Gravitational].contains(&one);
        Diagnostics::of(&self.facts(state, gravity, report), |one| wanted.contains(&one) || is_part(one))
    }

    fn facts<'a>(&'a self, state: Nodes<'a>, gravity: DVec3, report: impl FnOnce() -> Report + 'a) -> Facts<'a> {
        let volumes = move || {
            let elements = (0..self.sizes.len()).into_par_iter().with_min_len(LEAST_ELEMENTS);
            let volumes: Vec<_> = elements.map(|element| self.volume(element, state.position)).collect();
            Volumes {
                turned_over: volumes.iter().map(|&(now, at_rest)| is_turned_over(now, at_rest)).collect(),
                // In the order of the elements, whoever measured them.
                sum: volumes.iter().fold(0.0, |sum, (now, _)| sum + now),
            }
        };
        Facts {
            mass: &self.body.mass,
            state,
            gravity,
            report: Lazy::new(Box::new(report)),
            volumes: Lazy::new(Box::new(volumes)),
            volume_at_rest: self.volume_at_rest,
            placement: Lazy::new(Box::new(move || self.placement(state.position))),
            centred: &self.centred,
        }
    }

    /// Signed volume of an element now and at rest (m³, in the plane m²).
    fn volume(&self, element: usize, position: &[DVec3]) -> (f64, f64) {
        let nodes = &self.body.elements[element];
        match &self.sizes[element] {
            ElementSize::Faces { at_rest } => (volume_by_faces(self.body.kinds[element], nodes, position), *at_rest),
            ElementSize::Affine { at_rest, inverse, rest } => {
                let corners: Vec<_> = nodes.iter().map(|&node| position[node as usize]).collect();
                let centre = mean(&corners);
                let moments =
                    moment(&corners.iter().map(|&corner| corner - centre).collect::<Vec<_>>(), rest.iter().copied());
                ((moments * *inverse).determinant() * at_rest, *at_rest)
            }
            ElementSize::None => (0.0, 0.0),
        }
    }

    /// The rigid placement of the rest shape that is nearest to the nodes.
    fn placement(&self, position: &[DVec3]) -> Placement {
        let centre = mean(position);
        let at_rest = moment(&self.centred, position.iter().map(|&position| position - centre));
        let turn = rotation::best(self.body.dimension, at_rest);
        Placement { rest_centre: self.rest_centre, centre, turn }
    }
}

/// An element has turned over when its signed volume is below minus this part of that at rest.
///
/// Of one pressed exactly flat, round-off leaves some 1e-16 of either sign, or 1e-12 where the body lies ten thousand times
/// its size away from the origin: it would be told as sound and as turned over by turns. One that truly turns over passes
/// this bound a billionth of its height later.
const ROUND_OFF: f64 = 1e-9;

fn is_turned_over(now: f64, at_rest: f64) -> bool {
    now * at_rest < -ROUND_OFF * at_rest * at_rest
}

/// Corners whose second moments have a determinant below this part of what it would be in a ball lie in a plane.
///
/// Round-off leaves 1e-16 of it for corners in a plane; a plate a thousand times wider than thick has 1e-6.
const FLAT: f64 = 1e-12;

fn element_size(body: &Body, element: usize) -> ElementSize {
    let (nodes, kind) = (&body.elements[element], body.kinds[element]);
    match kind {
        ElementKind::Segment | ElementKind::Triangle => ElementSize::None,
        ElementKind::Other => {
            let corners: Vec<_> = nodes.iter().map(|&node| body.rest[node as usize]).collect();
            let centre = mean(&corners);
            let rest: Vec<_> = corners.iter().map(|&corner| corner - centre).collect();
            let moments = moment(&rest, rest.iter().copied());
            let mean_moment = (moments.x_axis.x + moments.y_axis.y + moments.z_axis.z) / 3.0;
            if moments.determinant() <= FLAT * mean_moment * mean_moment * mean_moment {
                return ElementSize::None;
            }
            let at_rest = hull_volume(body, element);
            ElementSize::Affine { at_rest, inverse: moments.inverse(), rest }
        }
        _ => ElementSize::Faces { at_rest: volume_by_faces(kind, nodes, &body.rest) },
    }
}

/// Signed volume (m³) inside the faces of an element, or signed area (m²) of a polygon.
///
/// A face with more than three corners is the mean of its fans of triangles from every corner. For a quadrilateral
/// that is exactly the bilinear patch, so a hexahedron gets the volume of its trilinear map.
pub(crate) fn volume_by_faces(kind: ElementKind, nodes: &[u32], position: &[DVec3]) -> f64 {
    // Relative to the first node, so that distance from the origin costs no digits.
    let origin = position[nodes[0] as usize];
    let at = |node: u32| position[node as usize] - origin;
    if kind == ElementKind::Polygon {
        return 0.5 * topology::around(nodes).map(|[a, b]| at(a).cross(at(b)).z).sum::<f64>();
    }
    // Elements of a kind have eight corners at most, which their faces share.
    const CORNERS: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut corners = [DVec3::ZERO; 8];
    for (corner, &node) in corners.iter_mut().zip(nodes) {
        *corner = at(node);
    }
    let at = |corner: u32| corners[(corner & 7) as usize];
    let mut volume = 0.0;
    topology::for_each_face(kind, &CORNERS[..nodes.len()], |face| {
        volume += match *face {
            [a, b, c] => triple(at(a), at(b), at(c)) / 6.0,
            // Each of the four triangles of two corners that are next to each other and a third is in two fans.
            [a, b, c, d] => {
                let (a, b, c, d) = (at(a), at(b), at(c), at(d));
                (triple(a, b - d, c) + triple(b, c - a, d)) / 12.0
            }
            _ => unreachable!("elements of a kind have triangles and quadrilaterals"),
        };
    });
    volume
}

/// The triple product, six times the signed volume (m³) between the origin and a triangle.
fn triple(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    a.dot(b.cross(c))
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
    use super::*;
    use crate::sim::body::Dimension;
    use crate::sim::body::IndexLists;
    use crate::sim::body::Solids;
    use crate::sim::state::State;
    use glam::DQuat;

    fn at_rest(rest: Vec<DVec3>) -> Diagnostics {
        let mut elements = IndexLists::default();
        elements.push(&(0..rest.len() as u32).collect::<Vec<_>>());
        let body =
            Arc::new(Body::new(Dimension::Space, rest.clone(), vec![1.0; rest.len()], elements, Solids::Ordered, None));
        Diagnose::new(&body).state(State::at_rest(rest).nodes(), DVec3::ZERO, &Report::default()).0
    }

    /// Seven corners have no faces of their own: the affine estimate stands in.
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
            diagnose.state(now.nodes(), DVec3::ZERO, &Report::default()).0.turned_over
        };
        assert!((0..100).all(|turn| over(0.0, turn) == 0));
        assert!((0..100).all(|turn| over(-1e-6, turn) == 1));
    }

    #[test]
    fn an_element_turns_over_a_billionth_below_zero() {
        for at_rest in [1.0, 2e-6, -3.0] {
            assert!(!is_turned_over(-0.99e-9 * at_rest, at_rest));
            assert!(is_turned_over(-1.01e-9 * at_rest, at_rest));
        }
        assert!(!is_turned_over(-1.0, 0.0), "what has no volume cannot turn over");
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
        let ratio = Diagnose::new(&Arc::new(body))
            .state(State::at_rest(now).nodes(), DVec3::ZERO, &Report::default())
            .0
            .volume_ratio;
        assert!((ratio - (2.0 / 3.0 + 1.0) / (4.0 / 3.0 + 1.0)).abs() < 1e-12, "{ratio}");
    }
}
