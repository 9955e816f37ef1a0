//! Triangulation of polygons that are not convex, by ear clipping.

use super::plane::around;
use crate::sim::Body;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Polygons with more corners than this stay fans: ear clipping takes cubic time.
const MOST_CORNERS: usize = 256;

/// Triangles of the faces of a body that are not convex at rest, as places in their lists of nodes. They follow from
/// the shape at rest, so that they stay the same while the body moves.
#[derive(Debug, Default)]
pub(super) struct Ears(HashMap<Vec<u32>, Vec<[u32; 3]>>);

impl Ears {
    /// Searches all faces that have a single side, or more than four corners.
    pub(super) fn new(body: &Body) -> Self {
        let sides = body.faces().nodes.iter().zip(&body.faces().outer);
        let single = sides.filter(|(nodes, outer)| outer.is_none() && (4..=MOST_CORNERS).contains(&nodes.len()));
        let found = single.filter_map(|(nodes, _)| {
            let corners: Vec<_> = nodes.iter().map(|&node| body.rest()[node as usize]).collect();
            Some((nodes.to_vec(), ears(&flattened(&corners)?)?))
        });
        Self(found.collect())
    }

    /// Whether all faces are convex.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The triangles of a face that is not convex.
    pub(super) fn of(&self, face: &[u32]) -> Option<&[[u32; 3]]> {
        self.0.get(face).map(Vec::as_slice)
    }
}

/// The corners of a polygon in the plane of its mean normal, oriented counter-clockwise.
fn flattened(corners: &[DVec3]) -> Option<Vec<DVec2>> {
    let normal = newell(corners);
    let largest = normal.abs().max_element();
    let normal = (normal / largest).try_normalize()?;
    let first = normal.any_orthonormal_vector();
    let second = normal.cross(first);
    Some(corners.iter().map(|&at| at - corners[0]).map(|at| DVec2::new(at.dot(first), at.dot(second))).collect())
}

/// The mean normal of a polygon, with twice the length of its area (Newell's method).
pub(crate) fn newell(corners: &[DVec3]) -> DVec3 {
    around(corners).map(|(&a, &b)| (a - corners[0]).cross(b - corners[0])).sum()
}

/// The triangles of a polygon that is not convex and does not cross itself, by cutting off its ears; `None` for others.
/// Corners are in the order in which the x-axis turns to the y-axis.
pub(super) fn ears(corners: &[DVec2]) -> Option<Vec<[u32; 3]>> {
    let scale = corners.iter().fold(0.0, |scale: f64, at| scale.max(at.length_squared()));
    let orientation = |a: usize, b: usize, c: usize| (corners[b] - corners[a]).perp_dot(corners[c] - corners[b]);
    let count = corners.len();
    let is_concave = (0..count).any(|at| orientation(at, (at + 1) % count, (at + 2) % count) < -1e-9 * scale);
    if !is_concave {
        return None;
    }
    let mut left: Vec<usize> = (0..count).collect();
    let mut triangles = Vec::with_capacity(count - 2);
    while left.len() > 3 {
        let around = |at: usize| [left[(at + left.len() - 1) % left.len()], left[at], left[(at + 1) % left.len()]];
        let ear = (0..left.len()).find(|&at| {
            let [a, b, c] = around(at);
            let outside = |point: usize| {
                side_of(corners, [a, b], point) < 0.0
                    || side_of(corners, [b, c], point) < 0.0
                    || side_of(corners, [c, a], point) < 0.0
            };
            orientation(a, b, c) > 0.0
                && left.iter().filter(|point| ![a, b, c].contains(point)).all(|&point| outside(point))
        })?;
        triangles.push(around(ear).map(|at| at as u32));
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]].map(|at| at as u32));
    Some(triangles)
}

/// Positive if a point lies to the left of a line.
fn side_of(corners: &[DVec2], [from, to]: [usize; 2], point: usize) -> f64 {
    (corners[to] - corners[from]).perp_dot(corners[point] - corners[from])
}

/// Elements without a face, unless the body lists its drawn faces.
pub(super) fn bare_elements(body: &Body) -> Vec<usize> {
    let mut has_face = vec![false; body.elements().len()];
    let owners = body.faces().inner.iter().chain(&body.faces().outer).flatten();
    owners.for_each(|&element| has_face[element as usize] = true);
    // Listed faces are drawn instead of the elements' own, so elements inside may stay hidden.
    let own = (0..body.elements().len()).all(|element| {
        let mut expected = false;
        body.topology().for_each_face(element, |_| expected = true);
        expected == has_face[element]
    });
    if own || body.faces().nodes.is_empty() {
        return (0..body.elements().len()).filter(|&element| !has_face[element]).collect();
    }
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[DVec2], triangle: [u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|at| corners[at as usize]);
        0.5 * (b - a).perp_dot(c - a)
    }

    #[test]
    fn triangles_of_a_concave_polygon_fill_it_once() {
        let shapes: [&[[f64; 2]]; 4] = [
            &[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.3], [0.0, 2.0]],
            &[[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]],
            &[[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]],
            &[
                [0.0, 0.0],
                [4.0, 0.0],
                [4.0, 4.0],
                [1.0, 4.0],
                [1.0, 2.0],
                [2.0, 2.0],
                [2.0, 3.0],
                [3.0, 3.0],
                [3.0, 1.0],
                [0.0, 1.0],
            ],
        ];
        for shape in shapes {
            for factor in [1e-6, 1.0, 1e6] {
                let corners: Vec<_> = shape.iter().map(|&at| DVec2::from(at) * factor).collect();
                let triangles = ears(&corners).expect("not convex");
                assert_eq!(triangles.len(), corners.len() - 2);
                let areas: Vec<_> = triangles.iter().map(|&triangle| area(&corners, triangle)).collect();
                assert!(areas.iter().all(|&area| area > 0.0), "{shape:?}: {areas:?}");
                let whole: f64 = (2..corners.len() as u32).map(|at| area(&corners, [0, at - 1, at])).sum();
                assert!((areas.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12, "{shape:?}");
            }
        }
    }

    #[test]
    fn convex_and_crossed_polygons_have_none() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert_eq!(ears(&square), None);
        assert_eq!(ears(&[DVec2::ZERO; 5]), None);
        let star: Vec<_> = (0..5).map(|at| DVec2::from_angle(f64::from(at * 2) * 1.256_637)).collect();
        assert_eq!(ears(&star).map_or(0, |triangles| triangles.len() % 3), 0);
    }
}
