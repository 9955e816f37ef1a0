//! How far elements stand out of a closed surface that they fill.

use glam::{DVec3, IVec3};
use localshape_mesh::{Filled, Surface};
use localshape_sim::Body;
use std::collections::HashMap;

/// How far elements stand out of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Outside {
    /// The greatest distance of a node outside, in sides of the lattice; at least 1 if it is infinite.
    pub farthest: f64,
    /// The number of nodes farther outside than an eighth of a side.
    pub far: usize,
    /// The number of elements without a part inside.
    pub empty: usize,
}

/// Triangles by the cells of a grid that they reach into.
struct Near<'s> {
    surface: &'s Surface,
    side: f64,
    cells: HashMap<IVec3, Vec<u32>>,
    /// By y and z only.
    columns: HashMap<[i32; 2], Vec<u32>>,
}

impl<'s> Near<'s> {
    fn new(surface: &'s Surface, side: f64) -> Self {
        let mut near = Self { surface, side, cells: HashMap::new(), columns: HashMap::new() };
        for (number, &of) in (0..).zip(&surface.triangles) {
            let corners = of.map(|point| surface.points[point as usize]);
            let low = near.cell(corners[0].min(corners[1]).min(corners[2]));
            let high = near.cell(corners[0].max(corners[1]).max(corners[2]));
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    near.columns.entry([y, z]).or_default().push(number);
                    for x in low.x..=high.x {
                        near.cells.entry(IVec3::new(x, y, z)).or_default().push(number);
                    }
                }
            }
        }
        near
    }

    fn cell(&self, at: DVec3) -> IVec3 {
        (at / self.side).floor().as_ivec3()
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.surface.triangles[triangle as usize].map(|point| self.surface.points[point as usize])
    }

    fn triangles(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = u32> + '_ {
        let (low, high) = (self.cell(low), self.cell(high));
        let rows = (low.z..=high.z).flat_map(move |z| (low.y..=high.y).map(move |y| [y, z]));
        let cells = rows.flat_map(move |[y, z]| (low.x..=high.x).map(move |x| IVec3::new(x, y, z)));
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().copied()
    }

    /// Whether the surface goes around a point, which is on no plane of the surface.
    fn is_inside(&self, at: DVec3) -> bool {
        let cell = self.cell(at);
        let mut around = 0;
        for &triangle in self.columns.get(&[cell.y, cell.z]).into_iter().flatten() {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - at);
            let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| from.y * to.z - from.z * to.y > 0.0);
            if turns[0] == turns[1] && turns[1] == turns[2] {
                let normal = (b - a).cross(c - a);
                if a.dot(normal) / normal.x > 0.0 {
                    around += if turns[0] { 1 } else { -1 };
                }
            }
        }
        around > 0
    }

    /// The distance of a point from the surface, if it is less than a side.
    fn distance(&self, at: DVec3) -> f64 {
        let near = self.triangles(at - self.side, at + self.side);
        near.map(|triangle| at.distance(nearest(self.corners(triangle), at))).fold(f64::INFINITY, f64::min)
    }
}

/// The point of a triangle that is nearest to a point.
fn nearest([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let on_line = |from: DVec3, to: DVec3| {
        let along = to - from;
        from + along * (along.dot(point - from) / along.length_squared()).clamp(0.0, 1.0)
    };
    let normal = (b - a).cross(c - a);
    let is_left = |from: DVec3, to: DVec3| normal.dot((to - from).cross(point - from)) >= 0.0;
    if is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return point - normal * (normal.dot(point - a) / normal.length_squared());
    }
    let sides = [on_line(a, b), on_line(b, c), on_line(c, a)];
    sides.into_iter().min_by(|one, other| one.distance(point).total_cmp(&other.distance(point))).unwrap()
}

/// Whether more than the border of a convex polygon is behind all planes.
fn reaches_behind(corners: &[DVec3], planes: &[(DVec3, f64)], slack: f64) -> bool {
    let mut polygon = corners.to_vec();
    for &(normal, height) in planes {
        let above = |at: DVec3| at.dot(normal) - height + slack;
        let mut kept = Vec::new();
        for (at, &from) in polygon.iter().enumerate() {
            let to = polygon[(at + 1) % polygon.len()];
            let (here, there) = (above(from), above(to));
            if here <= 0.0 {
                kept.push(from);
            }
            if (here <= 0.0) != (there <= 0.0) {
                kept.push(from.lerp(to, here / (here - there)));
            }
        }
        polygon = kept;
    }
    !polygon.is_empty()
}

/// How far the elements of a lattice stand out of the surface that they fill.
pub(crate) fn outside(filled: &Filled, body: &Body, side: f64) -> Outside {
    let near = Near::new(&filled.surface, side);
    let mut found = Outside::default();
    for &node in body.rest() {
        if !near.is_inside(node + side * 1e-7 * DVec3::new(0.13, 0.37, 0.61)) {
            let distance = near.distance(node) / side;
            found.farthest = found.farthest.max(distance);
            found.far += usize::from(distance > 0.125 + 1e-6);
        }
    }
    let mut planes = vec![Vec::new(); body.elements().len()];
    for (face, nodes) in body.faces().nodes.iter().enumerate() {
        let corners: Vec<_> = nodes.iter().map(|&node| body.rest()[node as usize]).collect();
        let area =
            (1..corners.len()).map(|at| (corners[at - 1] - corners[0]).cross(corners[at] - corners[0])).sum::<DVec3>();
        let normal = area.normalize();
        let sides = [(body.faces().inner[face], normal), (body.faces().outer[face], -normal)];
        for (element, normal) in sides {
            if let Some(element) = element {
                planes[element as usize].push((normal, corners[0].dot(normal)));
            }
        }
    }
    for (element, planes) in planes.iter().enumerate() {
        let corners: Vec<_> = body.elements()[element].iter().map(|&node| body.rest()[node as usize]).collect();
        let (low, high) = localshape_sim::geometry::bounds(&corners);
        let mean = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let passes = |triangle: u32| reaches_behind(&near.corners(triangle), planes, 1e-6 * side);
        let has_inside =
            near.is_inside(mean + side * 1e-7 * DVec3::new(0.13, 0.37, 0.61)) || near.triangles(low, high).any(passes);
        found.empty += usize::from(!has_inside);
    }
    found
}
