//! Soft shadows on the floor, of the key light and of the sky. The processor computes them, so that they are the same
//! with any graphics device.
//!
//! Bodies are projected along many directions onto a grid of cells. Only the outlines of a projection are drawn, the
//! edges between triangles that turn towards the light and others. Each edge begins or ends a layer, row by row, and a
//! cell with at least one layer is in the shadow. The file is long because of its tests.

use super::narrow::narrow;
use crate::sim::geometry;
use glam::{DVec2, DVec3};

/// Cells of a shadow in each direction.
pub(crate) const CELLS: usize = 128;
/// Half the angle of the cone from which the key light comes (rad).
const KEY_CONE: f64 = 0.12;
/// Azimuth of the key light from straight behind the viewer to the left, and its elevation above the horizon (rad).
const KEY_AZIMUTH: f64 = 62.0 / 180.0 * std::f64::consts::PI;
const KEY_ELEVATION: f64 = 50.0 / 180.0 * std::f64::consts::PI;
/// The numbers of directions for the key light and for the sky.
const DIRECTIONS: [usize; 2] = [48, 96];
/// Bodies of more triangles get fewer directions, or the shadow would take longer than everything else.
const MANY_TRIANGLES: usize = 6000;
/// Carried surfaces of more triangles cast the shadows of coarser ones: shadows have few cells, and are blurred.
const OF_SHAPE: usize = 2000;
/// Cells as large as this share of a surface's extent show nothing of its shape.
const COARSEST: f64 = 0.25;
/// The blur of the edges of both shadows (sides), and the largest reach of a blur (cells).
const BLUR: [f64; 2] = [0.06, 0.14];
const MOST_BLUR: usize = CELLS / 8;
/// The golden angle (rad): steps by it spread directions evenly.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// A square of the floor with a value for each cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shade {
    /// The corner of the first cell on the floor (sides from the panel's origin along the floor's two axes).
    pub corner: [f32; 2],
    /// Length of the whole square (sides).
    pub length: f32,
    /// The share of missing light: 0 none, 255 all; row after row along the second axis. Empty without a shadow.
    pub cells: Vec<u8>,
}

/// The floor's plane with axes in it; lengths in sides from the panel's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) axes: [DVec3; 2],
    pub(super) height: f64,
}

impl Plane {
    /// The plane with a normal through the points `normal · x = height`.
    pub(super) fn new(normal: DVec3, height: f64) -> Self {
        // On a level floor the axes and the grid are those of the world.
        let first = (DVec3::X - normal.x * normal).try_normalize().unwrap_or(DVec3::Z);
        Self { normal, axes: [first, first.cross(normal)], height }
    }

    /// The foot of a point on the plane, and its height. Points below the plane get height 0.
    fn foot(&self, point: DVec3) -> Foot {
        let above = (self.normal.dot(point) - self.height).max(0.0);
        Foot { at: DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1])), above }
    }

    /// The shadow of a point in light from a direction, along both axes. Light level with the plane, or from below it,
    /// gives no shadow: the result stays below the point.
    pub(super) fn shadow(&self, point: DVec3, towards_light: DVec3) -> DVec2 {
        let foot = self.foot(point);
        if self.normal.dot(towards_light) > 0.05 { foot.shadow(self.slant(towards_light)) } else { foot.at }
    }

    /// The shift by light from a direction of the shadow of a point one unit above the plane.
    fn slant(&self, towards_light: DVec3) -> DVec2 {
        let along = DVec2::new(towards_light.dot(self.axes[0]), towards_light.dot(self.axes[1]));
        -along / self.normal.dot(towards_light)
    }
}

/// Unit vector towards the key light, which turns with the camera, whose axis to the right is a unit vector.
pub(super) fn key_light(right: DVec3) -> DVec3 {
    let towards_viewer = right.cross(DVec3::Y);
    let (left, towards) = libm::sincos(KEY_AZIMUTH);
    let level = towards * towards_viewer - left * right;
    let slope = libm::tan(KEY_ELEVATION);
    (level + slope * DVec3::Y).normalize()
}

/// A point by its place over a plane and its height above it.
#[derive(Clone, Copy)]
struct Foot {
    at: DVec2,
    above: f64,
}

impl Foot {
    fn shadow(self, slant: DVec2) -> DVec2 {
        self.at + self.above * slant
    }
}

/// An edge where two triangles of a surface meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    /// The triangle whose side runs from the first end to the second one, and the triangle whose side runs back.
    triangles: [u32; 2],
}

/// Marks a missing triangle.
const NO_TRIANGLE: u32 = u32::MAX;

impl Edge {
    /// Its triangles that are there.
    pub(super) fn triangles(&self) -> [Option<u32>; 2] {
        self.triangles.map(|triangle| (triangle != NO_TRIANGLE).then_some(triangle))
    }
}

/// The edges of surfaces. If more than two triangles meet at one, they are paired.
pub(super) fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let sides = triangles.iter().zip(0..).flat_map(|(&[a, b, c], at)| [[a, b], [b, c], [c, a]].map(|ends| (ends, at)));
    let mut sides: Vec<_> = sides.map(|([from, to], at)| ([from.min(to), from.max(to)], from > to, at)).collect();
    sides.sort_unstable();
    let mut edges = Vec::with_capacity(sides.len() / 2);
    for around in sides.chunk_by(|one, other| one.0 == other.0) {
        let (there, back) = around.split_at(around.partition_point(|&(_, is_back, _)| !is_back));
        let triangle = |sides: &[([u32; 2], bool, u32)], at: usize| sides.get(at).map_or(NO_TRIANGLE, |side| side.2);
        edges.extend(
            (0..there.len().max(back.len()))
                .map(|at| Edge { ends: around[0].0, triangles: [triangle(there, at), triangle(back, at)] }),
        );
    }
    edges
}

/// The caster of a carried surface's shadow: the surface or, if that is fine, a coarser one with some of its points.
#[derive(Debug)]
pub(super) struct SurfaceCaster {
    /// Its points among those of the surface.
    pub(super) points: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    /// The number of triangles of the surface.
    stands_for: usize,
}

impl SurfaceCaster {
    /// The shape of a surface with points at rest (m).
    ///
    /// One point stands for all in a cell of a grid whose normals look the same way, so that thin parts keep both their sides
    /// (Rossignac and Borrel 1993, Multi-resolution 3D approximations). A closed surface stays closed.
    pub(super) fn new(rest: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut normals = vec![DVec3::ZERO; rest.len()];
        let mut area = 0.0;
        for triangle in triangles {
            let [a, b, c] = triangle.map(|at| rest[at as usize]);
            let normal = (b - a).cross(c - a);
            area += normal.length();
            triangle.iter().for_each(|&at| normals[at as usize] += normal);
        }
        // The longest axis and its direction.
        let way = |normal: DVec3| {
            let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
            2 * axis as i64 + i64::from(normal[axis] < 0.0)
        };
        let mut side = (area / OF_SHAPE as f64).sqrt();
        let mut found = (Vec::from_iter(0..rest.len() as u32), triangles.to_vec());
        // The triangles of a surface full of holes stay many in any grid.
        let (low, high) = geometry::bounds(rest);
        let coarsest = COARSEST * (high - low).max_element();
        while found.1.len() > OF_SHAPE && side <= coarsest {
            let key = |at: usize| {
                let [x, y, z] = (rest[at] / side).floor().to_array().map(|cell| cell as i64);
                ([x, y, z, way(normals[at])], at as u32)
            };
            let mut keys: Vec<_> = (0..rest.len()).map(key).collect();
            keys.sort_unstable();
            for alike in keys.chunk_by(|one, other| one.0 == other.0) {
                let place = |&(_, at): &([i64; 4], u32)| rest[at as usize];
                let middle = alike.iter().map(place).sum::<DVec3>() / alike.len() as f64;
                let apart = |one: &([i64; 4], u32)| place(one).distance_squared(middle);
                let nearest = alike.iter().min_by(|one, other| apart(one).total_cmp(&apart(other)));
                alike.iter().for_each(|&(_, at)| found.0[at as usize] = nearest.map_or(at, |nearest| nearest.1));
            }
            let moved = triangles.iter().map(|triangle| triangle.map(|at| found.0[at as usize]));
            found.1 = moved.filter(|[a, b, c]| a != b && b != c && c != a).collect();
            side *= 1.2;
        }
        // Only the points that are left.
        let (stands_for, mut triangles) = (triangles.len(), found.1);
        let mut points: Vec<_> = triangles.as_flattened().to_vec();
        points.sort_unstable();
        points.dedup();
        points.iter().zip(0..).for_each(|(&point, at)| found.0[point as usize] = at);
        triangles.as_flattened_mut().iter_mut().for_each(|at| *at = found.0[*at as usize]);
        Self { points, edges: edges(&triangles), triangles, stands_for }
    }
}

/// The closed surfaces that cast shadows, with triangles counter-clockwise as seen from outside.
#[derive(Default)]
pub(super) struct Casters {
    /// Points (sides from the panel's origin).
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    /// The number of triangles that are seen.
    count: usize,
}

impl Casters {
    /// Adds a surface.
    pub(super) fn add(&mut self, points: impl Iterator<Item = DVec3>, triangles: &[[u32; 3]]) {
        if !triangles.is_empty() {
            self.extend(points, triangles, &edges(triangles), triangles.len());
        }
    }

    /// Adds the shape of a carried surface with its points at places.
    pub(super) fn add_shape(&mut self, points: impl Iterator<Item = DVec3>, shape: &SurfaceCaster) {
        self.extend(points, &shape.triangles, &shape.edges, shape.stands_for);
    }

    /// Adds a surface with its [`edges`], which stands for a number of triangles.
    pub(super) fn extend(
        &mut self,
        points: impl Iterator<Item = DVec3>,
        triangles: &[[u32; 3]],
        edges: &[Edge],
        count: usize,
    ) {
        self.count += count;
        let [point, triangle] = [self.points.len(), self.triangles.len()].map(|count| count as u32);
        self.points.extend(points);
        let moved = |edge: &Edge| Edge {
            ends: edge.ends.map(|end| point + end),
            // A missing triangle stays missing.
            triangles: edge.triangles.map(|at| at.saturating_add(triangle)),
        };
        self.edges.extend(edges.iter().map(moved));
        self.triangles.extend(triangles.iter().map(|triangle| triangle.map(|at| point + at)));
    }

    /// Their shadows in key light and in the light of the sky on a plane, within `reach` of the origin of its axes, with `soft`
    /// as unit of blur.
    pub(super) fn shades(&self, plane: &Plane, key: DVec3, reach: f64, soft: f64) -> [Shade; 2] {
        let Self { points, triangles, edges, count } = self;
        let blur = BLUR.map(|blur| blur * soft);
        let feet: Vec<_> = points.iter().map(|&point| plane.foot(point)).collect();
        let thinning = (count / MANY_TRIANGLES + 1).min(6);
        let [of_key, of_sky] = DIRECTIONS.map(|count| count / thinning);
        let frame = Plane::new(key, 0.0);
        let key_directions: Vec<_> = (0..of_key)
            .map(|at| {
                let radius = KEY_CONE * ((at as f64 + 0.5) / of_key as f64).sqrt();
                let (sine, cosine) = libm::sincos(at as f64 * GOLDEN_ANGLE);
                (key + radius * (cosine * frame.axes[0] + sine * frame.axes[1])).normalize()
            })
            .collect();
        let sky_directions: Vec<_> = (0..of_sky)
            .map(|at| {
                let outward = ((at as f64 + 0.5) / of_sky as f64).sqrt();
                let (sine, cosine) = libm::sincos(at as f64 * GOLDEN_ANGLE);
                let [first, second] = plane.axes;
                outward * (cosine * first + sine * second) + (1.0 - outward * outward).sqrt() * plane.normal
            })
            .collect();
        let turns: Vec<_> = triangles.iter().map(|triangle| turn(triangle.map(|at| feet[at as usize]))).collect();
        let mut outlines = Outlines::default();
        let mut shade = |directions: &[DVec3], blur: f64, low: DVec2, length: f64| {
            let scale = CELLS as f64 / length;
            let mut cover = Cover::new();
            for directions in directions.chunks(AT_ONCE) {
                let slants: Vec<_> = directions.iter().map(|&direction| plane.slant(direction)).collect();
                outlines.find(&turns, edges, &slants);
                for (at, &slant) in slants.iter().enumerate() {
                    for ends in outlines.of(at, edges) {
                        cover.bound(ends.map(|end| (feet[end as usize].shadow(slant) - low) * scale));
                    }
                    cover.count();
                }
            }
            let cells = cover.blurred(directions.len(), blur * scale);
            Shade { corner: [narrow(low.x), narrow(low.y)], length: narrow(length), cells }
        };
        // The key light's shadow has sharp ends, so its grid just contains the shadow.
        let (low, high) = bounds(&feet, &key_directions, plane, reach);
        let [key_low, key_length] = snapped(low, (high - low).max_element() + 6.0 * blur[0]);
        let (sky_low, sky_length) = (DVec2::splat(-reach), 2.0 * reach);
        [
            shade(&key_directions, blur[0], DVec2::new(key_low[0], key_low[1]), key_length[0]),
            shade(&sky_directions, blur[1], sky_low, sky_length),
        ]
    }
}

/// The box around all shadows, within reach.
fn bounds(feet: &[Foot], directions: &[DVec3], plane: &Plane, reach: f64) -> (DVec2, DVec2) {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    // The last directions are the outermost.
    for &direction in directions.iter().rev().take(12) {
        let slant = plane.slant(direction);
        for at in feet.iter().map(|foot| foot.shadow(slant)) {
            (low, high) = (low.min(at), high.max(at));
        }
    }
    let within = |corner: DVec2| corner.clamp(DVec2::splat(-reach), DVec2::splat(reach));
    (within(low), within(high))
}

/// A square around a box, with one of few cell sizes and its corner on the lattice of cells, so that the cells do not
/// creep below a moving body.
fn snapped(low: DVec2, length: f64) -> [[f64; 2]; 2] {
    let steps = (libm::log2(length.max(1.0) * CELLS as f64 / (CELLS - 8) as f64) * 4.0).ceil();
    let length = libm::exp2(steps / 4.0);
    let cell = length / CELLS as f64;
    let corner = (low / cell).floor() * cell - 4.0 * cell;
    [[corner.x, corner.y], [length, cell]]
}

/// The signed area of a triangle's shadow: a constant, and coefficients for both parts of the slant of the light.
fn turn([a, b, c]: [Foot; 3]) -> [f64; 3] {
    let [one, other] = [b.at - a.at, c.at - a.at];
    let by_slant = (c.above - a.above) * one.perp() - (b.above - a.above) * other.perp();
    [one.perp_dot(other), by_slant.x, by_slant.y]
}

/// Directions that are processed together: one for each bit of a word.
const AT_ONCE: usize = 64;

/// The outlines of shadows: the edges between triangles with counter-clockwise shadows and others. The
/// counter-clockwise ones alone cover the whole shadow, as the others bound the same closed surface from behind.
#[derive(Default)]
struct Outlines {
    /// For each triangle, a bit for each direction with a counter-clockwise shadow.
    turned: Vec<u64>,
    /// The edges for each direction.
    edges: Vec<Vec<u32>>,
}

impl Outlines {
    fn find(&mut self, turns: &[[f64; 3]], edges: &[Edge], slants: &[DVec2]) {
        let slants: Vec<_> = slants.iter().zip(0..).map(|(slant, at)| (slant.x, slant.y, 1_u64 << at)).collect();
        self.turned.clear();
        self.turned.extend(turns.iter().map(|&[constant, x, y]| {
            let bit = |&(along_x, along_y, bit)| if constant + x * along_x + y * along_y > 0.0 { bit } else { 0 };
            slants.iter().map(bit).fold(0, |bits, bit| bits | bit)
        }));
        self.edges.resize_with(AT_ONCE, Vec::new);
        self.edges.iter_mut().for_each(Vec::clear);
        for (edge, number) in edges.iter().zip(0..) {
            let [one, other] = edge.triangles.map(|triangle| self.turned(triangle));
            let mut left = one ^ other;
            while left != 0 {
                self.edges[left.trailing_zeros() as usize].push(number);
                left &= left - 1;
            }
        }
    }

    fn turned(&self, triangle: u32) -> u64 {
        self.turned.get(triangle as usize).copied().unwrap_or(0)
    }

    /// The outline for a direction: the ends of each edge, with the covered side on the left.
    fn of(&self, direction: usize, edges: &[Edge]) -> impl Iterator<Item = [u32; 2]> {
        self.edges[direction].iter().map(move |&number| {
            let Edge { ends: [from, to], triangles } = edges[number as usize];
            if self.turned(triangles[0]) >> direction & 1 == 1 { [from, to] } else { [to, from] }
        })
    }
}

/// Rows that are summed up together.
const LANES: usize = 8;
/// Columns of steps: one more than there are cells, for layers that end beyond the grid.
const COLUMNS: usize = CELLS + 1;
/// No range yet.
const NONE: [usize; 2] = [usize::MAX, 0];

/// The number of directions that cover each cell.
struct Cover {
    /// For one direction, the number of layers of a cell minus that of the one before it in its row: groups of rows,
    /// column by column.
    steps: Vec<[i16; LANES]>,
    /// First and last row and column of the steps.
    rows: [usize; 2],
    columns: [usize; 2],
    /// The number of directions that cover a cell, in the same order.
    counts: Vec<[u16; LANES]>,
    /// First and last row of the counts.
    counted: [usize; 2],
}

impl Cover {
    fn new() -> Self {
        let groups = CELLS / LANES;
        let (steps, counts) = (vec![[0; LANES]; groups * COLUMNS], vec![[0; LANES]; groups * COLUMNS]);
        Self { steps, rows: NONE, columns: NONE, counts, counted: NONE }
    }

    /// Begins or ends a layer, which covers the cells whose middles lie on the left of the line between two points.
    fn bound(&mut self, [from, to]: [DVec2; 2]) {
        // From left to right, a layer ends at an upward line and begins at a downward one.
        let (low, high, step) = if to.y < from.y { (to, from, 1) } else { (from, to, -1) };
        let rows = first_middle(low.y)..first_middle(high.y);
        if rows.is_empty() {
            return;
        }
        self.rows = [self.rows[0].min(rows.start), self.rows[1].max(rows.end - 1)];
        let slope = (high.x - low.x) / (high.y - low.y);
        let [mut first, mut last] = self.columns;
        for row in rows {
            let column = first_middle(low.x + (row as f64 + 0.5 - low.y) * slope);
            [first, last] = [first.min(column), last.max(column)];
            let steps = &mut self.steps[row / LANES * COLUMNS + column][row % LANES];
            *steps = steps.wrapping_add(step);
        }
        self.columns = [first, last];
    }

    /// Counts the covered cells, and begins the next direction.
    fn count(&mut self) {
        let ([top, bottom], [first, last]) = (self.rows, self.columns);
        (self.rows, self.columns) = (NONE, NONE);
        if top > bottom {
            return;
        }
        self.counted = [self.counted[0].min(top), self.counted[1].max(bottom)];
        for group in top / LANES..=bottom / LANES {
            let cells = group * COLUMNS + first..=group * COLUMNS + last;
            let mut layers = [0_i16; LANES];
            for (steps, counts) in self.steps[cells.clone()].iter_mut().zip(&mut self.counts[cells]) {
                let more = std::mem::replace(steps, [0; LANES]);
                layers = std::array::from_fn(|lane| layers[lane].wrapping_add(more[lane]));
                *counts = std::array::from_fn(|lane| counts[lane] + u16::from(layers[lane] != 0));
            }
        }
    }

    /// The share of covering directions, 255 for all, blurred by a standard deviation (cells).
    fn blurred(&self, directions: usize, deviation: f64) -> Vec<u8> {
        if self.counts.iter().flatten().all(|&count| count == 0) {
            return Vec::new();
        }
        let radius = ((2.5 * deviation).ceil() as usize).clamp(1, MOST_BLUR);
        let weight = |at: usize| libm::exp(-0.5 * (at as f64 / deviation.max(0.3)).powi(2));
        let total: f64 = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f64>();
        let kernel: Vec<f32> = (0..=radius).map(|at| narrow(weight(at) / total)).collect();
        let shares: Vec<f32> = (0..=directions).map(|count| narrow(count as f64 / directions as f64)).collect();
        let [top, bottom] = self.counted;
        // Zeros around the grid.
        let mut across = vec![[0.0; CELLS]; CELLS + 2 * MOST_BLUR];
        let mut padded = [0.0; CELLS + 2 * MOST_BLUR];
        for row in top..=bottom {
            let counts = &self.counts[row / LANES * COLUMNS..][..CELLS];
            for (share, counts) in padded[MOST_BLUR..].iter_mut().zip(counts) {
                *share = shares[usize::from(counts[row % LANES])];
            }
            let shifted = |by: usize| padded[by..].first_chunk().expect("room for the widest kernel");
            across[MOST_BLUR + row] = blurred(&kernel, shifted);
        }
        let mut cells = vec![0; CELLS * CELLS];
        let (first, last) = (top.saturating_sub(radius), (bottom + radius).min(CELLS - 1));
        for (row, cells) in (first..=last).zip(cells.chunks_exact_mut(CELLS).skip(first)) {
            let shares = blurred(&kernel, |by| &across[row + by]);
            for (cell, share) in cells.iter_mut().zip(shares) {
                *cell = (share * 255.0 + 0.5) as u8;
            }
        }
        cells
    }
}

/// The weighted sum of rows of cells; the middle one has number [`MOST_BLUR`].
fn blurred<'a>(kernel: &[f32], row: impl Fn(usize) -> &'a [f32; CELLS]) -> [f32; CELLS] {
    let mut sum = row(MOST_BLUR).map(|cell| cell * kernel[0]);
    for (at, weight) in kernel.iter().enumerate().skip(1) {
        let (before, after) = (row(MOST_BLUR - at), row(MOST_BLUR + at));
        for (sum, (a, b)) in sum.iter_mut().zip(before.iter().zip(after)) {
            *sum += weight * (a + b);
        }
    }
    sum
}

/// The first cell whose middle is not below a coordinate, limited to the grid.
fn first_middle(at: f64) -> usize {
    // Without SSE 4.1, truncation is many times faster than `round`, and truncation to 32 bits faster than to 64.
    (at + 0.5).clamp(0.0, CELLS as f64) as u32 as usize
}

#[cfg(test)]
#[path = "../../tests/inside/shadow.rs"]
mod tests;
