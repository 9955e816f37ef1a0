//! Pieces of the surface in cells, and where they meet.

use super::clip::Polygon;
use super::range;
use crate::inside::Inside;
use glam::DVec3;
use localshape_sim::geometry::bounds;

/// The distance from a facet to the points on its sides that are asked whether they are inside, in sides of the cell.
const BESIDE: f64 = 1e-7;

/// Whether boxes meet.
pub(super) fn overlap(one: (DVec3, DVec3), other: (DVec3, DVec3)) -> bool {
    (one.0 - BESIDE).cmple(other.1).all() && (other.0 - BESIDE).cmple(one.1).all()
}

/// A piece of the surface in a cell.
pub(super) struct Facet {
    /// The corners of its triangle, and their normal with any length.
    pub(super) corners: [DVec3; 3],
    pub(super) normal: DVec3,
    pub(super) piece: Polygon,
    /// A point in the middle of the piece, and the piece's area.
    pub(super) middle: DVec3,
    pub(super) area: f64,
}

impl Facet {
    pub(super) fn new(corners: [DVec3; 3], low: DVec3) -> Self {
        let piece = Polygon::new(corners).within(low);
        let all = piece.corners();
        let middle = match all.len() {
            0 => corners[0].clamp(low, low + 1.0),
            count => all.iter().sum::<DVec3>() / count as f64,
        };
        let area = if all.len() < 3 { 0.0 } else { piece.area().length() };
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        Self { corners, normal, piece, middle, area }
    }

    /// How far along a line the triangle is hit, in lengths of `along`.
    pub(super) fn hit(&self, from: DVec3, along: DVec3) -> Option<f64> {
        // T. Möller and B. Trumbore, 1997.
        let across = self.normal.dot(along);
        let [a, b, c] = self.corners.map(|corner| corner - from);
        let [u, v, w] = [along.dot(b.cross(c)), along.dot(c.cross(a)), along.dot(a.cross(b))];
        let is_in = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        (is_in && across != 0.0).then(|| self.normal.dot(a) / across)
    }

    /// How far a point is in front of the facet's plane.
    fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.corners[0]) / self.normal.length()
    }

    /// The least and the greatest height of points.
    fn heights(&self, points: &[DVec3]) -> (f64, f64) {
        range(points.iter().map(|&point| self.height(point)))
    }

    /// Whether each of two facets meets the plane of the other.
    pub(super) fn meets(&self, other: &Self) -> bool {
        [(self, other), (other, self)].into_iter().all(|(one, other)| {
            let (low, high) = one.heights(other.piece.corners());
            low <= BESIDE && high >= -BESIDE
        })
    }

    /// Whether two facets cross: a side of one passes the other.
    pub(super) fn crosses(&self, other: &Self) -> bool {
        [(self, other), (other, self)].into_iter().any(|(one, other)| {
            let all = one.piece.corners();
            (0..all.len()).any(|at| {
                let along = all[(at + 1) % all.len()] - all[at];
                other.hit(all[at], along).is_some_and(|hit| (0.0..=1.0).contains(&hit))
            })
        })
    }

    /// The two parts of a polygon in front of the facet's plane and behind it, or all of it if it does not reach this facet in its box.
    pub(super) fn divide(&self, polygon: Vec<DVec3>, own: (DVec3, DVec3)) -> Vec<Vec<DVec3>> {
        let (low, high) = self.heights(&polygon);
        if low > -BESIDE || high < BESIDE || !overlap(bounds(&polygon), own) {
            return vec![polygon];
        }
        let mut sides = vec![Vec::new(), Vec::new()];
        for (at, &from) in polygon.iter().enumerate() {
            let to = polygon[(at + 1) % polygon.len()];
            let [below, above] = [from, to].map(|point| self.height(point));
            sides[usize::from(below < 0.0)].push(from);
            if below * above < 0.0 {
                let cut = from + (to - from) * (below / (below - above));
                sides.iter_mut().for_each(|side| side.push(cut));
            } else if below == 0.0 {
                sides[1].push(from);
            }
        }
        sides
    }

    /// Whether the facet bounds the inside in its middle.
    pub(super) fn bounds(&self, inside: &Inside) -> bool {
        self.area == 0.0 || self.bounding(inside, self.middle) != 0.0
    }

    /// How much of the facet bounds the inside at a point of it.
    pub(super) fn bounding(&self, inside: &Inside, at: DVec3) -> f64 {
        let out = self.normal * (BESIDE / self.normal.length());
        let [front, behind] = [at + out, at - out].map(|point| inside.around(point));
        match behind - front {
            // A wall between two parts bounds both.
            0 => 1.0,
            several => f64::from(i32::from(behind > 0) - i32::from(front > 0)) / f64::from(several),
        }
    }
}
