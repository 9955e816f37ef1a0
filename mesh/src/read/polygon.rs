//! Polygons divided into triangles.

use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Divides polygons in space, concave ones, too, within a limit of time.
///
/// Every corner of a polygon belongs to a triangle, those on a straight side, too, so that the triangles of neighbours still share their
/// edges. Ears are cut one after the other (G. H. Meisters, “Polygons have ears”, 1975). A polygon that crosses itself has no inside
/// and is divided somehow.
pub(super) struct Triangulation<'p> {
    points: &'p [DVec3],
    /// How many comparisons of a corner with an ear are left.
    left: usize,
    /// The polygon that is divided: its corners in the plane of the largest projection.
    flat: Vec<DVec2>,
    /// The places of the corners that are not cut off yet.
    ring: Vec<usize>,
}

/// The comparisons for all polygons of a file: about a second.
const WORK: usize = 1 << 26;

/// The corners of a polygon, once if they follow each other; none if all are equal.
pub(super) fn outline(corners: &[u32]) -> Vec<u32> {
    let mut outline = corners.to_vec();
    outline.dedup();
    if outline.first() == outline.last() {
        outline.pop();
    }
    outline
}

impl<'p> Triangulation<'p> {
    pub(super) fn new(points: &'p [DVec3]) -> Self {
        Self { points, left: WORK, flat: Vec::new(), ring: Vec::new() }
    }

    /// Appends the triangles of a polygon. Returns false if that takes too long.
    pub(super) fn triangles(&mut self, corners: &[u32], triangles: &mut Vec<[u32; 3]>) -> bool {
        if let &[a, b, c] = corners {
            triangles.push([a, b, c]);
            return true;
        }
        let corners = outline(corners);
        if corners.len() < 3 {
            return true;
        }
        self.project(&corners);
        self.ring.clear();
        self.ring.extend(0..corners.len());
        if self.is_fan() {
            triangles.extend((2..corners.len()).map(|at| [corners[0], corners[at - 1], corners[at]]));
            return true;
        }
        // Where the next ear is looked for, and how many places before it have none.
        let (mut at, mut failures) = (0, 0);
        while self.ring.len() > 3 && failures <= self.ring.len() {
            let count = self.ring.len();
            let [a, b, c] = [at, at + 1, at + 2].map(|at| self.ring[at % count]);
            let is_left = self.turn(a, b, c) > 0.0;
            let Some(left) = self.left.checked_sub(if is_left { count } else { 1 }) else { return false };
            self.left = left;
            if is_left && self.is_free(a, b, c) {
                triangles.push([a, b, c].map(|place| corners[place]));
                let removed = (at + 1) % count;
                self.ring.remove(removed);
                // Beyond the cut, so that triangles do not all meet in one corner.
                at = (if removed <= at { at - 1 } else { at + 1 }) % (count - 1);
                failures = 0;
            } else {
                at = (at + 1) % count;
                failures += 1;
            }
        }
        // One triangle, or a polygon that crosses itself.
        let ring = &self.ring;
        triangles.extend((2..ring.len()).map(|at| [ring[0], ring[at - 1], ring[at]].map(|place| corners[place])));
        true
    }

    /// Drops the coordinate along which the polygon has the largest area, so that it runs counter-clockwise.
    fn project(&mut self, corners: &[u32]) {
        let point = |at: usize| self.points[corners[at % corners.len()] as usize];
        let origin = point(0);
        let normal: DVec3 = (0..corners.len()).map(|at| (point(at) - origin).cross(point(at + 1) - origin)).sum();
        let size = normal.abs();
        let drop = |point: DVec3| match size {
            _ if size.x >= size.y && size.x >= size.z => DVec2::new(point.y, point.z * sign(normal.x)),
            _ if size.y >= size.z => DVec2::new(point.z, point.x * sign(normal.y)),
            _ => DVec2::new(point.x, point.y * sign(normal.z)),
        };
        let flat: Vec<DVec2> = (0..corners.len()).map(|at| drop(point(at))).collect();
        self.flat = flat;
    }

    /// Positive if three corners turn left.
    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        let [a, b, c] = [a, b, c].map(|at| Coord { x: self.flat[at].x, y: self.flat[at].y });
        orient2d(a, b, c)
    }

    /// Whether the triangles from the first corner to all sides divide the polygon: each turns left, and the polygon turns around once.
    fn is_fan(&self) -> bool {
        let count = self.flat.len();
        (2..count).all(|at| self.turn(0, at - 1, at) > 0.0)
            && (count <= 4 || (0..count).all(|at| self.turn(at, (at + 1) % count, (at + 2) % count) > 0.0))
    }

    /// Whether no other corner lies in a triangle or on its border, except at the places of its corners.
    fn is_free(&self, a: usize, b: usize, c: usize) -> bool {
        self.ring.iter().all(|&place| {
            let point = self.flat[place];
            [a, b, c].iter().any(|&corner| self.flat[corner] == point)
                || [(a, b), (b, c), (c, a)].iter().any(|&(from, to)| self.turn(from, to, place) < 0.0)
        })
    }
}

/// −1 for negative numbers, else 1.
fn sign(value: f64) -> f64 {
    if value < 0.0 { -1.0 } else { 1.0 }
}
