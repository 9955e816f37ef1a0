//! The border of the turned-over part of a carried surface: triangles in several elements are cut where these meet.

use super::fine::Fine;
use crate::picture::Vertex;
use crate::picture::field::NOWHERE;
use crate::picture::narrow::narrow;
use crate::sim::Body;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Whether turned-over elements move a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turned {
    No,
    Yes,
    /// Its parts are in a [`Rim`].
    Partly,
}

/// What cutting adds to a surface.
#[derive(Debug, Default)]
pub(super) struct Rim {
    /// The corners between which each new corner lies, and its share of the way.
    pub(super) corners: Vec<([u32; 2], f32)>,
    /// The parts of cut triangles: the triangle, corners with new ones counted after all others, and whether it is turned over.
    pub(super) parts: Vec<(usize, [u32; 3], bool)>,
    /// The triangle of each line of the border, and the new corners at its ends, counted alone.
    pub(super) lines: Vec<(usize, [u32; 2])>,
}

impl Rim {
    /// Cuts the triangles that turned-over and other elements move. Those that one kind moves get their state in `turned`.
    pub(super) fn new(fine: &Fine, body: &Body, over: &[bool], turned: &mut [Turned]) -> Self {
        let (mut rim, mut known) = (Self::default(), HashMap::new());
        for &(triangle, movers) in &fine.crossing {
            let states = movers.map(|mover| over.get(mover as usize).is_some_and(|&over| over));
            // The corner whose state the others do not have.
            let odd = (0..3).find(|&at| states[at] != states[(at + 1) % 3] && states[at] != states[(at + 2) % 3]);
            turned[triangle] = match odd {
                Some(_) => Turned::Partly,
                None if states[0] => Turned::Yes,
                None => Turned::No,
            };
            let Some(odd) = odd else { continue };
            let corner = |at: usize| fine.triangles[triangle][at % 3];
            let [new, other] = [1, 2].map(|next| {
                let (from, to) = (odd, (odd + next) % 3);
                let (ends, places) = ([corner(from), corner(to)], [from, to]);
                // An edge is cut at one place, whichever of its triangles comes first.
                let (ends, places) = if ends[0] < ends[1] { (ends, places) } else { ([ends[1], ends[0]], [to, from]) };
                *known.entry(ends).or_insert_with(|| {
                    let rest = ends.map(|end| fine.surface.rest[fine.points[end as usize] as usize]);
                    rim.corners.push((ends, narrow(meeting(body, rest, places.map(|at| movers[at])))));
                    rim.corners.len() as u32 - 1
                })
            });
            rim.lines.push((triangle, [new, other]));
            let [a, b] = [new, other].map(|at| fine.points.len() as u32 + at);
            let [p, q] = [corner(odd + 1), corner(odd + 2)];
            let parts = [([corner(odd), a, b], states[odd]), ([a, p, q], !states[odd]), ([a, q, b], !states[odd])];
            rim.parts.extend(parts.map(|(corners, over)| (triangle, corners, over)));
        }
        rim
    }

    /// Appends the new corners to those of the surface, which begin at a place, and their shades, if there are any.
    pub(super) fn add_corners(&self, vertices: &mut Vec<Vertex>, shades: &mut Vec<f32>, base: usize) {
        for &(ends, share) in &self.corners {
            let [from, to] = ends.map(|end| base + end as usize);
            let [one, other] = [vertices[from], vertices[to]];
            let between = |part: fn(&Vertex) -> [f32; 3]| Vec3::from(part(&one)).lerp(part(&other).into(), share);
            let normal = between(|at| at.normal).normalize_or_zero();
            vertices.push(Vertex { position: between(|at| at.position).into(), normal: normal.into(), hatch: 0.0 });
            if let (Some(&one), Some(&other)) = (shades.get(from), shades.get(to)) {
                let is_somewhere = one != NOWHERE && other != NOWHERE;
                shades.push(if is_somewhere { one + (other - one) * share } else { NOWHERE });
            }
        }
    }

    /// The place of a new corner between two places.
    pub(super) fn place(&self, at: u32, place: impl Fn(u32) -> DVec3) -> DVec3 {
        let ([from, to], share) = self.corners[at as usize];
        place(from).lerp(place(to), f64::from(share))
    }
}

/// The share of the way between two points at rest (m) at which it leaves the element of the first one and enters that of the second.
fn meeting(body: &Body, [from, to]: [DVec3; 2], [first, second]: [u32; 2]) -> f64 {
    let left = exit(body, first, from, to - from);
    let entered = 1.0 - exit(body, second, to, from - to);
    left.midpoint(entered).clamp(0.0, 1.0)
}

/// The share of a way (m) from a point in an element at rest, which is convex, at which it leaves the element; at most 1. A point that
/// no single element moves is in none.
fn exit(body: &Body, element: u32, from: DVec3, way: DVec3) -> f64 {
    let mut least = 1.0_f64;
    if element as usize >= body.elements().len() {
        return least;
    }
    body.topology().for_each_face(element as usize, |nodes| {
        let corner = |at: usize| body.rest()[nodes[at % nodes.len()] as usize];
        let normal: DVec3 = (1..nodes.len()).map(|at| (corner(at) - corner(0)).cross(corner(at + 1) - corner(0))).sum();
        let (rate, off) = (normal.dot(way), normal.dot(corner(0) - from));
        if rate > 0.0 {
            least = least.min((off / rate).max(0.0));
        }
    });
    least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Dimension;

    #[test]
    fn ways_are_cut_where_two_elements_meet() {
        let at = |number: usize| DVec3::new((number % 3) as f64, (number / 3 % 2) as f64, (number / 6) as f64);
        let elements: [[u32; 8]; 2] = [[0, 1, 3, 4, 6, 7, 9, 10], [1, 2, 4, 5, 7, 8, 10, 11]];
        let body = Body::builder((0..12).map(at).collect())
            .elements(elements.iter().map(|nodes| &nodes[..]).collect())
            .build()
            .expect("two cubes");
        assert_eq!(body.dimension(), Dimension::Space);
        let way = [DVec3::new(0.4, 0.2, 0.5), DVec3::new(1.2, 0.6, 0.5)];
        assert!((meeting(&body, way, [0, 1]) - 0.75).abs() < 1e-12);
        assert!((meeting(&body, [way[1], way[0]], [1, 0]) - 0.25).abs() < 1e-12);
        assert_eq!(meeting(&body, way, [u32::MAX; 2]), 0.5);
    }
}
