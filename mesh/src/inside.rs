//! Whether points are inside a surface.
//!
//! The winding number of a point counts how often the surface goes around it; inside it is above ½. For a surface whose edges
//! are passed as often in one direction as in the other it is a whole number: the sum of signs of the triangles that a ray
//! crosses. Exact predicates (J. Shewchuk, 1997) decide what is crossed; a point on a line or in a plane of the surface counts as
//! moved by infinitely little, and by least along x (H. Edelsbrunner and E. Mücke, 1990).
//!
//! Other surfaces have a fractional winding number (A. Jacobson et al., 2013). They are closed by fans of triangles over their open
//! edges, and the parts of the sphere that the fans hide from the point are taken off again: cheap, for most surfaces have few open
//! edges. Fans far away are lumped together (G. Barill et al., 2018).

use super::Surface;
use super::boxes::Boxes;
use super::edges::{EdgeUse, Sets, net, pieces};
use glam::{DVec2, DVec3};
use localshape_sim::geometry::bounds;
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};
use std::collections::HashMap;

/// A surface that is asked for its inside.
pub(crate) struct Inside {
    columns: Columns,
    /// The triangles that close the surface; none for most.
    caps: Vec<[DVec3; 3]>,
    /// The same ones, or fewer that hide the same from each point.
    hiding: Caps,
}

/// Points in rows along x.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    pub(crate) first: DVec3,
    /// The distance between neighbours.
    pub(crate) side: f64,
    /// The number of points along each axis.
    pub(crate) counts: [usize; 3],
}

impl Grid {
    fn at(&self, axis: usize, index: usize) -> f64 {
        self.first[axis] + self.side * index as f64
    }
}

impl Inside {
    pub(crate) fn new(surface: &Surface) -> Self {
        let (points, mut caps) = caps(surface);
        let mut all = surface.triangles.clone();
        let hiding;
        if caps.len() > all.len() {
            // Triangles that hardly hang together are closed with less by each other's backs, which leaves nothing to cross.
            caps = all.iter().map(|&[a, b, c]| [a, c, b]).collect();
            hiding = caps.clone();
            all.clear();
        } else {
            hiding = simple(&points, &caps);
            all.extend(&caps);
            if !caps.is_empty() {
                all = without_sheets(&points, &all);
            }
        }
        let corners =
            |caps: Vec<[u32; 3]>| caps.into_iter().map(|cap| cap.map(|point| points[point as usize])).collect();
        Self { columns: Columns::new(&points, &all), caps: corners(caps), hiding: Caps::new(corners(hiding)) }
    }

    /// About how many triangles are looked at to tell whether a point is inside, beside those that a line crosses.
    pub(crate) fn effort(&self) -> f64 {
        let all = self.hiding.triangles.len() as f64;
        all.min(64.0 * libm::log2(all.max(1.0)))
    }

    /// How many triangles are looked at on average to tell which a line crosses.
    pub(crate) fn crossed(&self) -> f64 {
        self.columns.crowd()
    }

    /// The triangles that were added to close the surface.
    pub(crate) fn caps(&self) -> &[[DVec3; 3]] {
        &self.caps
    }

    pub(crate) fn contains(&self, point: DVec3) -> bool {
        self.is_inside(self.around(point), point)
    }

    /// The winding number of a point about the surface with its caps.
    pub(crate) fn around(&self, point: DVec3) -> i32 {
        let mut around = 0;
        self.columns.crossings(point.y, point.z, |crossing| {
            if crossing.is_after(point.x) {
                around += crossing.sign;
            }
        });
        around
    }

    /// Whether a point is inside, from its winding number about the closed surface.
    fn is_inside(&self, around: i32, point: DVec3) -> bool {
        match self.caps.is_empty() {
            true => around > 0,
            false => f64::from(around) - self.hiding.winding(point) > 0.5,
        }
    }

    /// Whether each point is inside, with x fastest, then y, then z.
    pub(crate) fn grid(&self, grid: &Grid) -> Vec<bool> {
        let rows = (0..grid.counts[1] * grid.counts[2]).into_par_iter();
        rows.flat_map_iter(|row| {
            let mut out = Vec::new();
            self.row(grid, row, &mut out);
            out.into_iter().map(|(_, inside)| inside)
        })
        .collect()
    }

    /// The points of a row that are inside: for each point its winding number about the surface with its caps, and
    /// whether it is inside the surface. The numbers replace those in `out`.
    pub(crate) fn row(&self, grid: &Grid, row: usize, out: &mut Vec<(i32, bool)>) {
        let [along, wide, _] = grid.counts;
        out.clear();
        out.resize(along, (0, false));
        let (y, z) = (grid.at(1, row % wide), grid.at(2, row / wide));
        self.columns.crossings(y, z, |crossing| {
            // The number of points before the crossing: about as many as this.
            let guess = ((crossing.x() - grid.first.x) / grid.side).ceil().clamp(0.0, along as f64);
            let mut before = guess as usize;
            while before < along && crossing.is_after(grid.at(0, before)) {
                before += 1;
            }
            while before > 0 && !crossing.is_after(grid.at(0, before - 1)) {
                before -= 1;
            }
            if before > 0 {
                out[before - 1].0 += crossing.sign;
            }
        });
        let mut around = 0;
        for (at, (winding, inside)) in out.iter_mut().enumerate().rev() {
            around += *winding;
            *winding = around;
            *inside = self.is_inside(around, DVec3::new(grid.at(0, at), y, z));
        }
    }
}

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
        // As many cells as triangles, or fewer if these are large.
        let extent = ends.1 - ends.0;
        let squares: f64 = boxes.iter().map(|(low, high)| low.distance_squared(*high)).sum();
        let square = squares.max(extent.y * extent.z) / corners.len().max(1) as f64;
        let boxes = Boxes::new(boxes, ends, libm::sqrt(square).max(f64::MIN_POSITIVE));
        Self { corners, boxes }
    }

    /// How many triangles are in a cell on average.
    fn crowd(&self) -> f64 {
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
    fn x(&self) -> f64 {
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

/// Triangles that close a surface: for each group of edges that meet and are not passed as often in one direction as in
/// the other, a fan over the middle of their points. Returns the surface's points with the middles, and the triangles.
fn caps(surface: &Surface) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let uses = EdgeUse::all(&surface.triangles);
    let open =
        || uses.chunk_by(EdgeUse::same).map(|edge| (edge[0].low, edge[0].high, net(edge))).filter(|edge| edge.2 != 0);
    let mut points = surface.points.clone();
    if open().next().is_none() {
        return (points, Vec::new());
    }
    let mut groups = Sets::new(points.len());
    open().for_each(|(low, high, _)| groups.join(low, high));
    let (group_of, count) = groups.numbered();
    let mut middles = vec![(DVec3::ZERO, 0u32); count];
    for (low, high, _) in open() {
        let (sum, number) = &mut middles[group_of[low as usize] as usize];
        *sum += points[low as usize] + points[high as usize];
        *number += 2;
    }
    let mut middle_of = vec![0; count];
    for (middle, &(sum, number)) in middle_of.iter_mut().zip(&middles) {
        if number > 0 {
            *middle = points.len() as u32;
            points.push(sum / f64::from(number));
        }
    }
    let mut caps = Vec::new();
    for (low, high, net) in open() {
        let middle = middle_of[group_of[low as usize] as usize];
        let cap = if net > 0 { [middle, high, low] } else { [middle, low, high] };
        caps.extend(std::iter::repeat_n(cap, net.unsigned_abs() as usize));
    }
    (points, caps)
}

/// The triangles of those pieces of a closed surface that are not flat. A line crosses a flat one twice at one place, or not at all.
fn without_sheets(points: &[DVec3], all: &[[u32; 3]]) -> Vec<[u32; 3]> {
    /// Flat means so flat, as a part of the area.
    const FLAT: f64 = 1e-12;
    let (piece_of, count) = pieces(points.len(), all);
    let piece = |of: &[u32; 3]| piece_of[of[0] as usize] as usize;
    let area = |of: &[u32; 3]| {
        let [a, b, c] = of.map(|point| points[point as usize]);
        (b - a).cross(c - a)
    };
    // The area of the largest triangle of each piece, and that of all, whole and seen along the normal of the largest.
    let mut largest = vec![DVec3::ZERO; count];
    for (piece, area) in all.iter().map(|of| (piece(of), area(of))) {
        if area.length_squared() > largest[piece].length_squared() {
            largest[piece] = area;
        }
    }
    let mut areas = vec![[0.0; 2]; count];
    for (piece, area) in all.iter().map(|of| (piece(of), area(of))) {
        areas[piece][0] += area.length();
        areas[piece][1] += area.dot(largest[piece].normalize_or_zero()).abs();
    }
    let is_kept = |of: &&[u32; 3]| areas[piece(of)][1] < (1.0 - FLAT) * areas[piece(of)][0];
    all.iter().filter(is_kept).copied().collect()
}

/// Fans with one triangle in place of those whose open edges are a straight line, as the parts of an edge are that was divided, and in
/// place of three that are a triangle.
fn simple(points: &[DVec3], caps: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut fans = straightened(points, caps);
    // What began in the midst of a line is now before what begins at its start.
    fans.reverse();
    fans = straightened(points, &fans);
    fans.sort_by_key(|fan| fan[0]);
    let whole = |fan: &[[u32; 3]]| match *fan {
        [[_, a, b], [_, c, d], [_, e, f]] if b == c && d == e && f == a => vec![[a, c, e]],
        [[_, a, b], [_, c, d], [_, e, f]] if b == e && f == c && d == a => vec![[a, e, c]],
        _ => fan.to_vec(),
    };
    fans.chunk_by(|one, other| one[0] == other[0]).flat_map(whole).collect()
}

/// Fans in which open edges that go on straight are one.
fn straightened(points: &[DVec3], caps: &[[u32; 3]]) -> Vec<[u32; 3]> {
    /// How far, as a part of its distance from the start of a line, a point on the line may be beside it.
    const BESIDE: f64 = 1e-4;
    let mut next = HashMap::new();
    for (at, &[middle, from, _]) in caps.iter().enumerate() {
        // A point from which several edges start ends lines.
        next.entry((middle, from)).and_modify(|next| *next = None).or_insert(Some(at));
    }
    let mut is_done = vec![false; caps.len()];
    let mut fewer = Vec::new();
    for (at, &[middle, from, mut to]) in caps.iter().enumerate() {
        if std::mem::replace(&mut is_done[at], true) {
            continue;
        }
        let start = points[from as usize];
        let along = (points[to as usize] - start).normalize_or_zero();
        while let Some(&Some(beyond)) = next.get(&(middle, to)) {
            let way = points[caps[beyond][2] as usize] - start;
            let is_straight = way.cross(along).length() <= BESIDE * way.dot(along);
            if !is_straight || std::mem::replace(&mut is_done[beyond], true) {
                break;
            }
            to = caps[beyond][2];
        }
        fewer.push([middle, from, to]);
    }
    fewer
}

/// Triangles, and the parts of a sphere that they hide.
struct Caps {
    triangles: Vec<[DVec3; 3]>,
    /// A binary tree in depth-first order; empty without triangles.
    nodes: Vec<Lump>,
}

/// Neighbouring triangles.
struct Lump {
    range: std::ops::Range<usize>,
    /// The mean of their middles, by area, and the greatest distance of a corner from it.
    middle: DVec3,
    radius: f64,
    /// The sum of their normals with the length of their area.
    area: DVec3,
    /// The node after this one and those below it.
    next: usize,
}

impl Caps {
    fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let mut caps = Self { nodes: Vec::new(), triangles };
        if !caps.triangles.is_empty() {
            caps.build(0..caps.triangles.len());
        }
        caps
    }

    fn build(&mut self, range: std::ops::Range<usize>) {
        let triangles = &mut self.triangles[range.clone()];
        let middle = |[a, b, c]: &[DVec3; 3]| (*a + *b + *c) / 3.0;
        let (mut sum, mut weight, mut area) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for triangle in &*triangles {
            let [a, b, c] = *triangle;
            let own = 0.5 * (b - a).cross(c - a);
            // Triangles without area count a little, lest the sum be empty.
            let size = own.length() + f64::MIN_POSITIVE;
            sum += middle(triangle) * size;
            weight += size;
            area += own;
        }
        let mean = sum / weight;
        let radius = triangles.as_flattened().iter().map(|corner| corner.distance(mean)).fold(0.0, f64::max);
        let at = self.nodes.len();
        let many = triangles.len() > 4;
        if many {
            let low = triangles.iter().map(middle).reduce(DVec3::min).unwrap_or(DVec3::ZERO);
            let high = triangles.iter().map(middle).reduce(DVec3::max).unwrap_or(DVec3::ZERO);
            let axis = (high - low).max_position();
            triangles.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        }
        self.nodes.push(Lump { range: range.clone(), middle: mean, radius, area, next: 0 });
        if many {
            let half = range.start.midpoint(range.end);
            self.build(range.start..half);
            self.build(half..range.end);
        }
        self.nodes[at].next = self.nodes.len();
    }

    /// The part of the sphere about a point that the triangles hide.
    fn winding(&self, point: DVec3) -> f64 {
        let (mut sum, mut at, mut near) = (0.0, 0, HalfAngle::default());
        while let Some(lump) = self.nodes.get(at) {
            let to = lump.middle - point;
            let distance = to.length();
            // At this distance the errors of all lumps are together one or two hundredths, far less than matters to what is above ½.
            if distance > 3.0 * lump.radius {
                sum += to.dot(lump.area) / (distance * distance * distance);
                at = lump.next;
            } else if lump.next == at + 1 {
                near.add(&self.triangles[lump.range.clone()], point);
                at = lump.next;
            } else {
                at += 1;
            }
        }
        (sum + near.solid_angle()) / (4.0 * std::f64::consts::PI)
    }
}

/// Half the solid angle of triangles seen from a point, positive from behind: a vector in a plane that each triangle turns by its own, so
/// that one arc tangent is enough, and its whole turns.
struct HalfAngle {
    vector: DVec2,
    turns: f64,
}

impl Default for HalfAngle {
    fn default() -> Self {
        Self { vector: DVec2::X, turns: 0.0 }
    }
}

impl HalfAngle {
    /// Adds a few triangles, whose vectors are lengths to the third power.
    fn add(&mut self, triangles: &[[DVec3; 3]], point: DVec3) {
        for half in triangles.iter().filter_map(|triangle| half_angle(triangle, point)) {
            let next = self.vector.rotate(half);
            let [was_left, turns_left, is_left] = [self.vector, half, next].map(|vector| vector.y >= 0.0);
            if was_left == turns_left && is_left != was_left {
                self.turns += if turns_left { 1.0 } else { -1.0 };
            }
            self.vector = next;
        }
        self.vector = self.vector.normalize_or(DVec2::X);
    }

    fn solid_angle(&self) -> f64 {
        2.0 * (libm::atan2(self.vector.y, self.vector.x) + std::f64::consts::TAU * self.turns)
    }
}

/// A vector at the angle of half the solid angle of a triangle (A. van Oosterom and J. Strackee, 1983). There is none on the plane of the
/// triangle: on the triangle itself, half of the sphere is hidden from one side and half from the other.
fn half_angle(triangle: &[DVec3; 3], point: DVec3) -> Option<DVec2> {
    let [a, b, c] = triangle.map(|corner| corner - point);
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let volume = a.dot(b.cross(c));
    (volume != 0.0).then(|| DVec2::new(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, volume))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.next(), self.next(), self.next())
        }
    }

    fn cube() -> Surface {
        let points = (0..8u32).map(|n| DVec3::from_array([n & 1, n >> 1 & 1, n >> 2].map(f64::from))).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Surface { points, triangles, ..Surface::default() }
    }

    /// The triangles of a surface as caps, for their winding number.
    fn all(surface: &Surface) -> Caps {
        Caps::new(surface.triangles.iter().map(|&of| surface.corners(of)).collect())
    }

    #[test]
    fn the_winding_number_of_a_cube_is_the_part_of_the_sphere_that_it_hides() {
        let caps = all(&cube());
        for (point, expected) in [
            ([0.5, 0.5, 0.5], 1.0),
            ([0.1, 0.9, 0.01], 1.0),
            ([0.5, 0.25, 0.0], 0.5),
            ([0.5, 0.0, 1.0], 0.25),
            ([0.0, 1.0, 1.0], 0.125),
            ([1.5, 0.5, 0.5], 0.0),
            ([2.0, 2.0, 1.0], 0.0),
        ] {
            let found = caps.winding(DVec3::from_array(point));
            assert!((found - expected).abs() < 1e-12, "{point:?}: {found}");
        }
    }

    /// Points on faces, edges and corners are inside or outside, but never both for two cubes that share a face.
    #[test]
    fn each_point_is_inside_one_of_the_blocks_that_fill_space() {
        let blocks: Vec<_> = (0..27u32)
            .map(|n| {
                let shift = DVec3::from_array([n % 3, n / 3 % 3, n / 9].map(f64::from));
                let cube = cube();
                Inside::new(&Surface { points: cube.points.iter().map(|point| point + shift).collect(), ..cube })
            })
            .collect();
        let grid = Grid { first: DVec3::splat(0.5), side: 0.25, counts: [9; 3] };
        let all: Vec<Vec<bool>> = blocks.iter().map(|block| block.grid(&grid)).collect();
        for at in 0..729 {
            assert_eq!(all.iter().filter(|inside| inside[at]).count(), 1, "{at}");
            let point = grid.first + grid.side * DVec3::from_array([at % 9, at / 9 % 9, at / 81].map(|at| at as f64));
            assert!(blocks.iter().zip(&all).all(|(block, inside)| block.contains(point) == inside[at]));
        }
    }

    /// A point in a slanted face counts as moved along y, and along z only if that leaves it in the face.
    #[test]
    fn points_in_faces_are_moved_along_y_before_z() {
        for [a, b] in [[0.5, 0.25], [0.5, -0.25], [-0.5, 0.25], [-0.5, -0.25], [0.0, 0.25], [0.0, -0.25]] {
            // All numbers are exact.
            let slanted = |at: DVec3| DVec3::new(at.x + a * at.y + b * at.z, at.y, at.z);
            let cube = cube();
            let inside = Inside::new(&Surface { points: cube.points.iter().map(|&at| slanted(at)).collect(), ..cube });
            let is_inside = if a == 0.0 { b > 0.0 } else { a > 0.0 };
            for [y, z] in [[0.25, 0.5], [0.75, 0.25]] {
                assert_eq!(inside.contains(slanted(DVec3::new(1.0, y, z))), is_inside, "{a} {b}");
                assert_eq!(inside.contains(slanted(DVec3::new(0.0, y, z))), !is_inside, "{a} {b}");
            }
        }
    }

    #[test]
    fn open_edges_that_are_divided_are_closed_by_few_triangles() {
        let mut surface = cube();
        surface.triangles.truncate(10);
        assert_eq!(Inside::new(&surface).hiding.triangles.len(), 4);
        surface.refine(0.05, 100_000);
        let inside = Inside::new(&surface);
        assert!(inside.caps().len() > 80 && inside.hiding.triangles.len() == 4);
        // A triangle by itself is closed by its back.
        surface = Surface { triangles: vec![[0, 1, 2]], ..cube() };
        surface.refine(0.05, 100_000);
        assert_eq!(Inside::new(&surface).hiding.triangles.len(), 1);
    }

    fn solid_angle(triangle: [DVec3; 3], point: DVec3) -> f64 {
        let mut half = HalfAngle::default();
        half.add(&[triangle], point);
        half.solid_angle()
    }

    #[test]
    fn points_are_inside_where_the_winding_number_says_so() {
        let mut noise = Noise(7);
        // A cube whose corners are shaken, divided into small triangles, and the same with holes.
        let mut surface = cube();
        surface.points.iter_mut().for_each(|point| *point += (noise.vector() - 0.5) * 0.4);
        surface.refine(0.1, 100_000);
        let whole = surface.triangles.len();
        for kept in [whole, whole - 1, whole * 9 / 10, whole / 2] {
            surface.triangles.truncate(kept);
            let (inside, caps) = (Inside::new(&surface), all(&surface));
            assert_eq!(inside.caps().is_empty(), kept == whole);
            let mut unclear = 0;
            for _ in 0..2000 {
                let point = noise.vector() * 2.0 - 0.5;
                let direct: f64 = caps.triangles.iter().map(|&triangle| solid_angle(triangle, point)).sum();
                let direct = direct / (4.0 * std::f64::consts::PI);
                let lumped = caps.winding(point);
                assert!((lumped - direct).abs() < 0.03, "{lumped} {direct}");
                match (direct - 0.5).abs() < 0.03 {
                    true => unclear += 1,
                    false => assert_eq!(inside.contains(point), direct > 0.5, "{point}: {direct}"),
                }
            }
            assert!(unclear < 200, "{unclear}");
        }
    }
}
