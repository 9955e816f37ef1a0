//! Facets that cross each other: a side of one passes through the other. Signs are exact, so that no crossing is lost in round-off.

use super::closest;
use super::extent::{Extent, near, sweep};
use super::surface::Placed;
use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The pairs of facets of two surfaces, or of one with itself, that cross at these places, in order. A side that passes through an edge
/// between two triangles crosses both. A facet crosses a round obstacle where it is nearer to its axis than the radius.
pub(crate) fn crossings([one, other]: [Placed<'_>; 2]) -> Vec<[u32; 2]> {
    let radius = one.surface.radius() + other.surface.radius();
    let mut found = near_facets([one, other], radius);
    let is_same = std::ptr::eq(one.surface, other.surface);
    found.retain(|&[first, second]| {
        let (mine, theirs) = (Corners::of(one, first), Corners::of(other, second));
        if is_same && (first >= second || are_joined(one, [first, second])) {
            return false;
        }
        mine.crosses(&theirs) || radius > 0.0 && mine.distance(&theirs) < radius
    });
    found
}

/// Whether two facets of a surface have a corner in common.
pub(super) fn are_joined(of: Placed<'_>, [first, second]: [u32; 2]) -> bool {
    of.used(first).iter().any(|corner| of.used(second).contains(corner))
}

/// The pairs of facets whose boxes are nearer than a reach (m), in order.
pub(super) fn near_facets([one, other]: [Placed<'_>; 2], reach: f64) -> Vec<[u32; 2]> {
    let [mine, theirs] = [one, other].map(|placed| Extent::around(placed.at.iter().copied()));
    let common = mine.grown(reach).common(&theirs.grown(reach));
    let [mine, theirs] = [one, other].map(|placed| {
        let extent = |facet| Extent::around(Corners::of(placed, facet).all().iter().copied());
        near((0..placed.surface.facets.len() as u32).map(|facet| (facet, extent(facet))), &common)
    });
    let mut found = Vec::new();
    sweep([&mine, &theirs], reach, common.longest_axes(), |pair| found.push(pair));
    found.sort_unstable();
    found
}

/// The corners of a facet (m).
#[derive(Clone, Copy)]
pub(super) struct Corners {
    at: [DVec3; 3],
    count: usize,
}

impl Corners {
    pub(super) fn of(placed: Placed<'_>, facet: u32) -> Self {
        let facet = &placed.surface.facets[facet as usize];
        Self { at: facet.corners.map(|corner| placed.at[corner as usize]), count: facet.count as usize }
    }

    pub(super) fn all(&self) -> &[DVec3] {
        &self.at[..self.count]
    }

    pub(super) fn sides(&self) -> impl Iterator<Item = [DVec3; 2]> + Clone + '_ {
        let count = [0, 0, 1, 3][self.count];
        (0..count).map(|side| [self.at[side], self.at[(side + 1) % 3]])
    }

    /// The unit vector out of a triangle, or of a side of a polygon; not a number for other facets.
    pub(super) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.at;
        let across = if self.count == 3 { (b - a).cross(c - a) } else { (b - a).cross(DVec3::Z) };
        across.normalize()
    }

    /// The place under the middle of a triangle, or of a side of a polygon, by a share of the mean length of its sides.
    pub(super) fn under(&self, share: f64) -> DVec3 {
        let size = self.sides().map(|[a, b]| a.distance(b)).sum::<f64>() / self.sides().count() as f64;
        self.all().iter().sum::<DVec3>() / self.count as f64 - self.normal() * (share * size)
    }

    /// Whether a side of one passes through the other. Segments cross in the plane alone.
    pub(super) fn crosses(&self, other: &Self) -> bool {
        match [self.count, other.count] {
            [2, 2] => segments_cross([self.at[0], self.at[1]], [other.at[0], other.at[1]]),
            _ => [[self, other], [other, self]]
                .iter()
                .any(|[one, other]| other.count == 3 && one.sides().any(|side| passes(side, other.at))),
        }
    }

    /// The distance from a point (m).
    pub(super) fn distance_to(&self, point: DVec3) -> f64 {
        let [a, b, _] = self.at;
        let shares = match self.count {
            3 => closest::of_triangle(point, self.at).shares,
            2 => closest::of_segment(point, [a, b]).shares,
            _ => [1.0, 0.0, 0.0],
        };
        self.at.iter().zip(shares).map(|(&corner, share)| corner * share).sum::<DVec3>().distance(point)
    }

    /// The distance from a facet that does not cross this one (m).
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let of_points = self.all().iter().map(|&point| other.distance_to(point));
        let of_others = other.all().iter().map(|&point| self.distance_to(point));
        let of_sides = self.sides().flat_map(|mine| other.sides().map(move |theirs| between(mine, theirs)));
        of_points.chain(of_others).chain(of_sides).fold(f64::INFINITY, f64::min)
    }
}

/// The distance between two segments (m).
fn between(one: [DVec3; 2], other: [DVec3; 2]) -> f64 {
    let [s, t] = closest::of_segments(one, other);
    one[0].lerp(one[1], s).distance(other[0].lerp(other[1], t))
}

/// On which side of a triangle a point is: the sign of the volume of both.
fn side_of([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, point].map(|DVec3 { x, y, z }| Coord3D { x, y, z });
    orient3d(a, b, c, d)
}

/// Whether a segment passes through a triangle, or through its boundary. It has to end on both sides of it.
fn passes([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let [here, there] = [from, to].map(|end| side_of([a, b, c], end));
    if !(here > 0.0 && there < 0.0 || here < 0.0 && there > 0.0) {
        return false;
    }
    let turns = [[a, b], [b, c], [c, a]].map(|[a, b]| side_of([from, to, a], b));
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// Whether two segments in the plane z = 0 cross, or one begins on the other.
fn segments_cross([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> bool {
    if [a, b, c, d].iter().any(|point| point.z != 0.0) {
        return false;
    }
    let turn = |ends: [DVec3; 3]| {
        let [a, b, c] = ends.map(|DVec3 { x, y, .. }| Coord { x, y });
        orient2d(a, b, c)
    };
    let parts = |one: f64, other: f64| one > 0.0 && other < 0.0 || one < 0.0 && other > 0.0;
    let meets = |one: f64, other: f64| one == 0.0 || other == 0.0 || parts(one, other);
    let (mine, theirs) = ([turn([c, d, a]), turn([c, d, b])], [turn([a, b, c]), turn([a, b, d])]);
    parts(mine[0], mine[1]) && meets(theirs[0], theirs[1]) || meets(mine[0], mine[1]) && parts(theirs[0], theirs[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Surface;
    use crate::{Body, Dimension};

    /// A cube of side 1 with its first corner at the origin, or a square.
    fn block(dimension: Dimension) -> Body {
        let (corners, order): (u32, &[u32]) = match dimension {
            Dimension::Space => (8, &[0, 1, 2, 3, 4, 5, 6, 7]),
            Dimension::Plane => (4, &[0, 1, 3, 2]),
        };
        let corner = |at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)));
        let elements = [order].into_iter().collect();
        Body::builder((0..corners).map(corner).collect())
            .dimension(dimension)
            .elements(elements)
            .build()
            .expect("a block")
    }

    /// How many facets of two blocks cross, the second of which is scaled and moved.
    fn count(dimension: Dimension, scale: DVec3, by: DVec3) -> usize {
        let (body, surface) = (block(dimension), Surface::of(&block(dimension)));
        let at: Vec<_> = (0..surface.points.len()).map(|point| surface.points.place(point, &body.rest)).collect();
        let moved: Vec<_> = at.iter().map(|&point| point * scale + by).collect();
        let other = surface.clone();
        crossings([Placed { surface: &surface, at: &at }, Placed { surface: &other, at: &moved }]).len()
    }

    #[test]
    fn a_rod_crosses_the_two_faces_that_it_passes_through() {
        let space = |scale: [f64; 3], by: [f64; 3]| count(Dimension::Space, scale.into(), by.into());
        // Each of its four edges, and the four diagonals of its sides, pass through one triangle or more of each face.
        assert!(space([9.0, 0.1, 0.1], [-4.0, 0.3, 0.6]) >= 16);
        assert_eq!(space([9.0, 0.1, 0.1], [-4.0, 1.0000001, 0.6]), 0);
        // Edges through the middle and the diagonals of a face.
        assert!(space([9.0, 0.5, 0.5], [-4.0, 0.5, 0.5]) > 0);
        // Inside, and side by side.
        assert_eq!(space([0.5; 3], [0.25; 3]), 0);
        assert_eq!(space([1.0; 3], [1.0, 0.0, 0.0]), 0);
        assert!(space([1.0; 3], [0.9, 0.2, 0.3]) > 0);
        assert_eq!(space([1.0; 3], [f64::NAN; 3]), 0);
    }

    #[test]
    fn squares_cross_at_two_sides() {
        let plane = |scale: [f64; 2], by: [f64; 2]| {
            let [scale, by] = [scale, by].map(|[x, y]| DVec3::new(x, y, 0.0));
            count(Dimension::Plane, scale, by)
        };
        assert_eq!(plane([1.0; 2], [0.5, 0.25]), 2);
        assert_eq!(plane([9.0, 0.1], [-4.0, 0.3]), 4);
        assert_eq!(plane([0.5; 2], [0.25; 2]), 0);
        assert_eq!(plane([1.0; 2], [1.0, 0.0]), 0);
    }

    /// A tetrahedron whose tip is pushed through its base: no two facets that share a corner count.
    #[test]
    fn facets_that_are_joined_do_not_cross() {
        let rest = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let body =
            Body::builder(rest).elements([&[0, 1, 2, 3][..]].into_iter().collect()).build().expect("a tetrahedron");
        let surface = Surface::of(&body);
        let at = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.2, 0.2, -0.5)];
        let placed = Placed { surface: &surface, at: &at };
        assert!(crossings([placed; 2]).is_empty());
    }
}
