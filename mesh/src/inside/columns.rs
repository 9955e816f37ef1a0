//! Which triangles lines along x cross.

use crate::boxes::Boxes;
use glam::DVec3;
use localshape_sim::geometry::bounds;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Triangles, and the boxes of their projections along x.
pub(crate) struct Columns {
    corners: Vec<[DVec3; 3]>,
    boxes: Boxes,
}

/// A triangle that a line along x crosses.
pub(crate) struct Crossing<'t> {
    /// The triangle's place in the list.
    pub(crate) triangle: u32,
    /// 1 where the line leaves the inside of the surface, −1 where it enters it.
    pub(crate) sign: i32,
    corners: &'t [DVec3; 3],
    y: f64,
    z: f64,
}

impl Columns {
    pub(crate) fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let corners: Vec<_> = triangles.iter().map(|of| of.map(|point| points[point as usize])).collect();
        let flat = |corners: &[DVec3]| {
            let (low, high) = bounds(corners);
            (DVec3 { x: 0.0, ..low }, DVec3 { x: 0.0, ..high })
        };
        let (boxes, ends): (Vec<_>, _) = (corners.iter().map(|of| flat(of)).collect(), flat(corners.as_flattened()));
        // As many cells as triangles, or fewer if these are large, so that each is in a few.
        let (extent, count) = (ends.1 - ends.0, corners.len().max(1) as f64);
        let mean = |of: fn(DVec3) -> f64| boxes.iter().map(|(low, high)| of(*high - *low)).sum::<f64>() / count;
        let square = mean(|size| 0.25 * size.y * size.z).max(extent.y * extent.z / count);
        let side = libm::sqrt(square).max(mean(|size| 0.25 * (size.y + size.z)));
        let boxes = Boxes::new(boxes, ends, side.max(f64::MIN_POSITIVE));
        Self { corners, boxes }
    }

    /// How many triangles are in a cell on average.
    pub(crate) fn crowd(&self) -> f64 {
        let (sum, count) = self.boxes.in_cells().fold((0, 0), |(sum, count), all| (sum + all.len(), count + 1));
        sum as f64 / f64::from(count)
    }

    /// Calls `visit` with the triangles that a line along x crosses, in their order.
    pub(crate) fn crossings<'t>(&'t self, y: f64, z: f64, mut visit: impl FnMut(Crossing<'t>)) {
        for triangle in self.boxes.around(DVec3::new(0.0, y, z)) {
            let corners = &self.corners[triangle as usize];
            let [a, b, c] = corners;
            let sign = side(a, b, y, z);
            if sign != 0 && side(b, c, y, z) == sign && side(c, a, y, z) == sign {
                visit(Crossing { triangle, sign, corners, y, z });
            }
        }
    }
}

/// On which side of a line, seen along x, a point is that was moved by infinitely little along y and by less along z; 0
/// if there is no line.
fn side(from: &DVec3, to: &DVec3, y: f64, z: f64) -> i32 {
    let seen = |point: &DVec3| Coord { x: point.y, y: point.z };
    let side = orient2d(seen(from), seen(to), Coord { x: y, y: z });
    sign([side, from.z - to.z, to.y - from.y])
}

/// The sign of the first number that is not zero.
fn sign<const N: usize>(numbers: [f64; N]) -> i32 {
    let first = numbers.into_iter().find(|&number| number != 0.0);
    first.map_or(0, |number| if number > 0.0 { 1 } else { -1 })
}

impl Crossing<'_> {
    /// About where the line crosses the triangle.
    pub(super) fn x(&self) -> f64 {
        let [a, b, c] = *self.corners;
        let normal = (b - a).cross(c - a);
        a.x - ((self.y - a.y) * normal.y + (self.z - a.z) * normal.z) / normal.x
    }

    /// Whether a point of the line is before the crossing.
    pub(crate) fn is_after(&self, x: f64) -> bool {
        let [a, b, c] = *self.corners;
        let coordinates = |point: DVec3| Coord3D { x: point.x, y: point.y, z: point.z };
        // Positive behind the triangle.
        let behind =
            orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(DVec3::new(x, self.y, self.z)));
        if behind != 0.0 {
            return (behind > 0.0) == (self.sign > 0);
        }
        // The point moves along y first: away from where the normal points is behind.
        let seen = |first: usize, second: usize| {
            let of = |point: DVec3| Coord { x: point[first], y: point[second] };
            orient2d(of(a), of(b), of(c))
        };
        sign([-seen(2, 0), -seen(0, 1), -f64::from(self.sign)]) == self.sign
    }
}
