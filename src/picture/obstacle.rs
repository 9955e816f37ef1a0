//! Obstacles in space. Balls, rods and boxes are solids with light on them; plates and all floors but the ground are
//! transparent slabs, so that body and alarm stay visible behind them.

use super::camera::Lens;
use super::narrow::{narrow, narrow_point};
use super::palette::Palette;
use super::pointer::{Going, Pointers};
use super::shadow::Plane;
use super::{Line, LineKind, Mark, Mesh, Obstacles, Pane, PaneCorner, Slab, Solid, Vertex};
use crate::sim::contact::{Motion, Obstacle, Pose, Shape};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A round outline is nowhere farther from its polygon than this (px).
const FLATNESS: f64 = 0.12;
/// Into how many segments something round is cut: at least and at most, and where it only throws a shadow.
const SEGMENTS: [usize; 2] = [16, 128];
const SHADOW_SEGMENTS: usize = 20;
/// Balls larger than this (body sizes) are cut finely where the body is, and coarsely elsewhere.
const LARGE_BALL: f64 = 3.0;
/// Half the side of a plate, and its thickness (body sizes).
const PLATE: f64 = 0.85;
const THICKNESS: f64 = 0.042;
/// A plate reaches over where the body starts by this much, unless that is farther away than `FARTHEST_EDGE`, and over
/// nodes near it (body sizes).
const START_MARGIN: f64 = 0.25;
const MARGIN: f64 = 0.12;
const NEAR_PLATE: f64 = 0.6;
const FARTHEST_EDGE: f64 = 4.0;
/// Opacity of the faces of a plate: those of its two sides, and the small ones around it.
const PLATE_ALPHA: [f32; 2] = [0.50, 0.80];
/// How far walls and slopes are drawn around the point looked at (body sizes).
const WALL: f64 = 2.1;
/// Opacity of a wall, seen from the side of the body and through what is solid.
const WALL_ALPHA: [f32; 2] = [0.75, 0.38];
/// Above so many slabs they are sorted by distance alone.
const MANY_SLABS: usize = 64;

/// A half-space: the unit normal out of it and its distance from the origin along that (m).
pub(super) type HalfSpace = (DVec3, f64);

/// What is needed to draw the obstacles of one panel in space.
pub(super) struct Staging<'a> {
    pub(super) obstacles: &'a [Obstacle],
    /// The time of the panel's state (s).
    pub(super) time: f64,
    /// The time between two frames (s).
    pub(super) frame: f64,
    pub(super) lens: &'a Lens,
    /// The panel's origin (m).
    pub(super) origin: DVec3,
    /// The panel's unit of length (m).
    pub(super) side: f64,
    /// The size of the body (m).
    pub(super) extent: f64,
    /// How many times wider than usual the floor is drawn.
    pub(super) widening: f64,
    /// Distance of the grid's lines (sides).
    pub(super) cell: f64,
    pub(super) palette: &'a Palette,
    /// The floor that is drawn as ground.
    pub(super) ground: Option<HalfSpace>,
    /// The nodes now (m).
    pub(super) position: &'a [DVec3],
    /// The box around the nodes at the start (m).
    pub(super) start: [DVec3; 2],
}

/// What the rest of the picture has to know of solids.
#[derive(Debug, Default)]
pub(super) struct Staged {
    /// Points around them (m), for the part of the panel that they may touch.
    pub(super) outermost: Vec<DVec3>,
    /// What throws shadows: corners (m) and triangles.
    pub(super) shadow_points: Vec<DVec3>,
    pub(super) shadow_triangles: Vec<[u32; 3]>,
}

/// A surface of quadrilaterals, flat each, in a grid that is closed in one direction.
struct Lathe {
    /// Corners and normals, ring by ring.
    rings: Vec<Vec<(DVec3, DVec3)>>,
}

/// A slab that has not been put in order yet.
struct Loose {
    slab: Slab,
    /// The plane of its surface (m).
    plane: HalfSpace,
    /// All its corners (m).
    corners: Vec<DVec3>,
}

impl Staging<'_> {
    /// All obstacles but the ground.
    pub(super) fn draw(&self, lines: &mut Vec<Line>) -> (Obstacles, Staged) {
        let (mut solids, mut staged, mut slabs) = (Vec::new(), Staged::default(), Vec::new());
        let floors: Vec<_> = self.obstacles.iter().map(|obstacle| obstacle.floor(self.time)).collect();
        for (at, obstacle) in self.obstacles.iter().enumerate() {
            let pose = obstacle.pose(self.time);
            match obstacle.shape {
                Shape::Floor { normal, .. } => {
                    let Some(floor) = floors[at] else { continue };
                    if self.ground == Some(floor) {
                        continue;
                    }
                    let others = floors.iter().enumerate().filter(|&(other, _)| other != at);
                    let others: Vec<_> = others.filter_map(|(_, floor)| *floor).collect();
                    slabs.extend(self.wall(obstacle, normal, floor, &others));
                }
                Shape::Plate { normal, .. } => {
                    let floors: Vec<_> = floors.iter().flatten().copied().collect();
                    slabs.extend(self.plate(obstacle, &pose, normal, &floors));
                }
                Shape::Sphere { centre, radius } => {
                    let centre = pose.apply(centre, centre);
                    let shape = |segments| self.ball(centre, radius, segments);
                    self.round(shape, radius, centre, &mut solids, lines, &mut staged);
                }
                Shape::Capsule { from, to, radius } => {
                    let ends = [from, to].map(|end| pose.apply(obstacle.shape.pivot(), end));
                    let shape = |segments| rod(ends, radius, segments);
                    let middle = ends[0].midpoint(ends[1]);
                    self.round(shape, radius, middle, &mut solids, lines, &mut staged);
                }
                Shape::Box { centre, half, turn } => {
                    let axes = DVec3::AXES.map(|axis| pose.turn * (turn * axis));
                    let corners = corners(pose.apply(centre, centre), axes, half);
                    self.block(&corners, axes, &mut solids, lines, &mut staged);
                }
            }
        }
        (Obstacles { solids, slabs: self.in_order(slabs) }, staged)
    }

    /// The arrows of plates that move.
    pub(super) fn arrows(&self, pointers: &Pointers<'_>, marks: &mut Vec<Mark>) {
        for obstacle in self.obstacles {
            let Shape::Plate { normal, .. } = obstacle.shape else { continue };
            if obstacle.motion == Motion::Still {
                continue;
            }
            let pose = obstacle.pose(self.time);
            let out = pose.turn * normal;
            let (middle, half) = self.span(obstacle, &pose, normal);
            let going = going(obstacle, middle, self.time, self.frame, half.max_element());
            // Always on the side that is not the body's.
            let arriving = going.velocity.dot(out) > 0.0;
            pointers.draw(middle - THICKNESS * self.extent * out, going, arriving, 3.0, marks);
        }
    }

    /// The lines in which surfaces of the body go into solid obstacles: only nodes bounce off, faces may be pierced.
    pub(super) fn pierced(&self, meshes: &[&Mesh], lines: &mut Vec<Line>) {
        for obstacle in self.obstacles {
            let (pose, pivot, reach) = (obstacle.pose(self.time), obstacle.shape.pivot(), obstacle.shape.reach());
            if !reach.is_finite() {
                continue;
            }
            let inside = |point: DVec3| -height(&obstacle.shape, pose.undo(pivot, point));
            let middle = pose.apply(pivot, pivot);
            for mesh in meshes {
                let points: Vec<_> = mesh
                    .vertices
                    .iter()
                    .map(|vertex| self.origin + self.side * DVec3::from(vertex.position.map(f64::from)))
                    .collect();
                for triangle in &mesh.triangles {
                    let [a, b, c] = triangle.map(|at| points[at as usize]);
                    let centroid = (a + b + c) / 3.0;
                    let size = [a, b, c].iter().map(|at| at.distance(centroid)).fold(0.0, f64::max);
                    if middle.distance(centroid) < reach + size && inside(centroid) > -size {
                        self.pierce([a, b, c], inside, lines);
                    }
                }
            }
        }
    }

    /// The lines in a triangle along which something changes its sign.
    fn pierce(&self, [a, b, c]: [DVec3; 3], inside: impl Fn(DVec3) -> f64, lines: &mut Vec<Line>) {
        const CUT: usize = 10;
        let part = |at: usize| at as f64 / CUT as f64;
        let point = |i: usize, j: usize| a + part(i) * (b - a) + part(j) * (c - a);
        let rows: Vec<Vec<_>> =
            (0..=CUT).map(|i| (0..=CUT - i).map(|j| (point(i, j), inside(point(i, j)))).collect()).collect();
        let mut cut = |corners: [(DVec3, f64); 3]| {
            let sides = [(0, 1), (1, 2), (2, 0)].map(|(one, other)| (corners[one], corners[other]));
            let crossed = sides.into_iter().filter(|((_, x), (_, y))| (*x < 0.0) != (*y < 0.0));
            let crossed: Vec<_> = crossed.map(|((a, x), (b, y))| a.lerp(b, x / (x - y))).collect();
            if let [from, to] = crossed[..] {
                self.line([from, to], LineKind::ObstacleEdge, lines);
            }
        };
        for i in 0..CUT {
            for j in 0..CUT - i {
                cut([rows[i][j], rows[i + 1][j], rows[i][j + 1]]);
                if i + j + 1 < CUT {
                    cut([rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]]);
                }
            }
        }
    }

    fn relative(&self, point: DVec3) -> [f32; 3] {
        narrow_point((point - self.origin) / self.side).to_array()
    }

    /// Adds a line, cut off where it goes below the ground.
    fn line(&self, [from, to]: [DVec3; 2], kind: LineKind, lines: &mut Vec<Line>) {
        let ground = self.ground.as_slice();
        if let Some([from, to]) = clipped_line([from, to], ground) {
            lines.push(Line { from: self.relative(from), to: self.relative(to), kind });
        }
    }

    fn round(
        &self,
        shape: impl Fn(usize) -> Lathe,
        radius: f64,
        middle: DVec3,
        solids: &mut Vec<Solid>,
        lines: &mut Vec<Line>,
        staged: &mut Staged,
    ) {
        let distance = (middle - self.lens.eye).dot(self.lens.forward) - radius;
        let pixels = self.lens.focal * radius / distance.max(self.lens.near);
        let needed = (PI / (2.0 * FLATNESS / pixels.max(1e-3)).sqrt()).ceil();
        let segments = needed.clamp(SEGMENTS[0] as f64, SEGMENTS[1] as f64) as usize;
        let lathe = shape(segments.next_multiple_of(4));
        let mesh = self.turned(&lathe);
        self.outline(&lathe, lines);
        staged.outermost.extend(lathe.rings.iter().flatten().map(|(at, _)| *at));
        solids.push(Solid { mesh, colour: self.palette.obstacle });
        let coarse = shape(SHADOW_SEGMENTS);
        staged.add(&coarse.points(), &coarse.triangles());
    }

    fn turned(&self, lathe: &Lathe) -> Mesh {
        let vertex = |&(at, normal): &(DVec3, DVec3)| Vertex {
            position: self.relative(at),
            normal: narrow_point(normal).to_array(),
            hatch: 0.0,
        };
        Mesh {
            vertices: lathe.rings.iter().flatten().map(vertex).collect(),
            triangles: lathe.triangles(),
            shades: Vec::new(),
        }
    }

    /// Where a round surface turns away from the viewer, and where it goes through the ground.
    fn outline(&self, lathe: &Lathe, lines: &mut Vec<Line>) {
        let count = lathe.rings.first().map_or(0, Vec::len);
        let at = |ring: usize, segment: usize| lathe.rings[ring][segment % count].0;
        let seen: Vec<Vec<bool>> = (1..lathe.rings.len())
            .map(|ring| {
                let quad = |segment| {
                    let [a, b] = [at(ring - 1, segment), at(ring - 1, segment + 1)];
                    let [c, d] = [at(ring, segment + 1), at(ring, segment)];
                    self.lens.sees(a.midpoint(c), (c - a).cross(d - b))
                };
                (0..count).map(quad).collect()
            })
            .collect();
        for ring in 0..seen.len() {
            for segment in 0..count {
                if seen[ring][segment] != seen[ring][(segment + 1) % count] {
                    let two = [at(ring, segment + 1), at(ring + 1, segment + 1)];
                    self.line(two, LineKind::ObstacleContour, lines);
                }
                if ring > 0 && seen[ring][segment] != seen[ring - 1][segment] {
                    let two = [at(ring, segment), at(ring, segment + 1)];
                    self.line(two, LineKind::ObstacleContour, lines);
                }
            }
        }
        for ring in 1..lathe.rings.len() {
            for segment in (0..count).filter(|&segment| seen[ring - 1][segment]) {
                let quad = [at(ring - 1, segment), at(ring - 1, segment + 1), at(ring, segment + 1), at(ring, segment)];
                self.ground_line(&quad, lines);
            }
        }
    }

    /// The line in which a polygon goes through the ground.
    fn ground_line(&self, polygon: &[DVec3], lines: &mut Vec<Line>) {
        let Some((normal, height)) = self.ground else { return };
        let above = |point: DVec3| normal.dot(point) - height;
        let next = polygon.iter().cycle().skip(1);
        let through: Vec<_> = polygon
            .iter()
            .zip(next)
            .filter_map(|(&a, &b)| {
                let (x, y) = (above(a), above(b));
                ((x < 0.0) != (y < 0.0)).then(|| a.lerp(b, x / (x - y)))
            })
            .collect();
        if let [from, to] = through[..] {
            let kind = LineKind::ObstacleContour;
            lines.push(Line { from: self.relative(from), to: self.relative(to), kind });
        }
    }

    fn ball(&self, centre: DVec3, radius: f64, segments: usize) -> Lathe {
        let rings = segments / 2;
        if radius <= LARGE_BALL * self.extent {
            let profile = (0..=rings).map(|ring| (PI * ring as f64 / rings as f64 - FRAC_PI_2, 0.0));
            return lathe(centre, DVec3::Y, radius, profile, segments);
        }
        // Rings ever closer together towards the body.
        let axis = (self.origin - centre).try_normalize().unwrap_or(DVec3::Y);
        let growth = 1.2 * libm::log(1.0 + radius / self.extent);
        let profile = (0..=rings).rev().map(|ring| {
            let share = libm::expm1(growth * ring as f64 / rings as f64) / libm::expm1(growth);
            (FRAC_PI_2 - PI * share, 0.0)
        });
        lathe(centre, axis, radius, profile, segments)
    }

    fn block(
        &self,
        corners: &[DVec3; 8],
        axes: [DVec3; 3],
        solids: &mut Vec<Solid>,
        lines: &mut Vec<Line>,
        staged: &mut Staged,
    ) {
        let mut mesh = Mesh::default();
        let mut seen = [false; 6];
        for (face, nodes) in FACES.iter().enumerate() {
            let normal = axes[face / 2] * if face % 2 == 0 { -1.0 } else { 1.0 };
            let base = mesh.vertices.len() as u32;
            let polygon = nodes.map(|node| corners[node]);
            mesh.vertices.extend(polygon.map(|at| Vertex {
                position: self.relative(at),
                normal: narrow_point(normal).to_array(),
                hatch: 0.0,
            }));
            mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle: [u32; 3]| triangle.map(|at| base + at)));
            seen[face] = self.lens.sees(polygon[0], normal);
            if seen[face] {
                self.ground_line(&polygon, lines);
            }
        }
        for ([a, b], [one, other]) in edges() {
            let line = [corners[a], corners[b]];
            match (seen[one], seen[other]) {
                (true, true) => self.line(line, LineKind::ObstacleEdge, lines),
                (false, false) => {}
                _ => self.line(line, LineKind::ObstacleContour, lines),
            }
        }
        staged.outermost.extend(corners);
        let triangles: Vec<_> = FACES
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|three| three.map(|at| at as u32))
            .collect();
        staged.add(corners, &triangles);
        solids.push(Solid { mesh, colour: self.palette.obstacle });
    }

    /// The middle of the drawn part of a plate's surface (m), and half its sides (m).
    fn span(&self, obstacle: &Obstacle, pose: &Pose, normal: DVec3) -> (DVec3, DVec2) {
        let pivot = obstacle.shape.pivot();
        let [first, second] = Plane::new(normal, 0.0).axes;
        let farthest = FARTHEST_EDGE * self.extent;
        let (mut low, mut high) = (DVec2::splat(-PLATE * self.extent), DVec2::splat(PLATE * self.extent));
        // Over where the body starts.
        let before = obstacle.pose(0.0);
        let place = |pose: &Pose, point: DVec3| {
            let own = pose.undo(pivot, point) - pivot;
            (DVec2::new(own.dot(first), own.dot(second)), own.dot(normal))
        };
        let [from, to] = self.start;
        let start = corners(from.midpoint(to), DVec3::AXES, 0.5 * (to - from)).map(|corner| place(&before, corner).0);
        let (from, to) = (
            start.iter().copied().fold(DVec2::INFINITY, DVec2::min),
            start.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max),
        );
        if from.max_element() < farthest && to.min_element() > -farthest {
            let margin = START_MARGIN * self.extent;
            low = low.min(from - margin).max(DVec2::splat(-farthest));
            high = high.max(to + margin).min(DVec2::splat(farthest));
        }
        // Over nodes near it, the more the nearer they are.
        let (still_low, still_high) = (low, high);
        for &node in self.position {
            let (at, above) = place(pose, node);
            let share = (above / (NEAR_PLATE * self.extent)).clamp(0.0, 1.0);
            let weight = 1.0 - share * share * (3.0 - 2.0 * share);
            if weight > 0.0 && at.abs().max_element() < farthest {
                let margin = MARGIN * self.extent;
                low = low.min(still_low.lerp(still_low.min(at - margin), weight));
                high = high.max(still_high.lerp(still_high.max(at + margin), weight));
            }
        }
        let middle = low.midpoint(high);
        (pose.apply(pivot, pivot + middle.x * first + middle.y * second), 0.5 * (high - low))
    }

    fn plate(&self, obstacle: &Obstacle, pose: &Pose, normal: DVec3, floors: &[HalfSpace]) -> Option<Loose> {
        let (middle, half) = self.span(obstacle, pose, normal);
        let [first, second] = Plane::new(normal, 0.0).axes.map(|axis| pose.turn * axis);
        let out = pose.turn * normal;
        let thickness = THICKNESS * self.extent;
        // Right-handed, so that faces are turned as those of a box.
        let axes = [second, first, out];
        let behind = middle - 0.5 * thickness * out;
        let corners = corners(behind, axes, DVec3::new(half.y, half.x, 0.5 * thickness));
        let mut slab = Slab::default();
        let mut seen = [false; 6];
        let mut kept = Vec::new();
        for (face, nodes) in FACES.iter().enumerate() {
            let normal = axes[face / 2] * if face % 2 == 0 { -1.0 } else { 1.0 };
            let polygon = nodes.map(|node| corners[node]);
            seen[face] = self.lens.sees(polygon[0], normal);
            let polygon = clipped_polygon(&polygon, floors);
            if seen[face] && polygon.len() > 2 {
                // Thin faces around it stand out, as the edges of glass do.
                let alpha = PLATE_ALPHA[usize::from(face < 4)];
                let colour = if face < 4 { self.palette.plate_side } else { self.palette.plate };
                let corner = |&at: &DVec3| PaneCorner { position: self.relative(at), ..PaneCorner::default() };
                slab.panes.push(Pane { corners: polygon.iter().map(corner).collect(), colour, alpha, grid: false });
            }
            if seen[face] {
                // Where it stands on a floor it has an edge, too.
                let on = |point: DVec3, (out, height): HalfSpace| {
                    (out.dot(point) - height).abs() < 1e-9 * (self.extent + height.abs())
                };
                let next = polygon.iter().cycle().skip(1);
                let cut = polygon.iter().zip(next).filter(|&(&a, &b)| floors.iter().any(|&at| on(a, at) && on(b, at)));
                slab.edges.extend(cut.map(|(&a, &b)| [a, b].map(|end| self.relative(end))));
            }
            kept.extend(polygon);
        }
        for ([a, b], [one, other]) in edges() {
            if seen[one] || seen[other] {
                let edge = clipped_line([corners[a], corners[b]], floors);
                slab.edges.extend(edge.map(|ends| ends.map(|end| self.relative(end))));
            }
        }
        (!slab.panes.is_empty()).then(|| Loose { slab, plane: (out, out.dot(middle)), corners: kept })
    }

    /// A floor that is not the ground: a piece of it around the point looked at, with a grid.
    fn wall(&self, obstacle: &Obstacle, normal: DVec3, floor: HalfSpace, others: &[HalfSpace]) -> Option<Loose> {
        const CORNERS: usize = 16;
        let (out, height) = floor;
        let pose = obstacle.pose(self.time);
        let mut middle = self.origin + (height - out.dot(self.origin)) * out;
        // Along the slope up to where it comes out of the others.
        for &(other, level) in others {
            let depth = level - other.dot(middle);
            let along = other - other.dot(out) * out;
            if depth > 0.0 && along.length_squared() > 0.01 {
                middle += depth / along.length_squared() * along;
            }
        }
        let axes = Plane::new(normal, 0.0).axes.map(|axis| pose.turn * axis);
        let reach = WALL * self.extent * self.widening;
        // Circumscribed: the circle in which it fades lies within.
        let around = (0..CORNERS).map(|at| {
            let (sine, cosine) = libm::sincos(TAU * at as f64 / CORNERS as f64);
            middle + reach / libm::cos(PI / CORNERS as f64) * (cosine * axes[0] + sine * axes[1])
        });
        let polygon = clipped_polygon(&around.collect::<Vec<_>>(), others);
        if polygon.len() < 3 {
            return None;
        }
        let seen = self.lens.sees(middle, out);
        let anchor = pose.apply(obstacle.shape.pivot(), DVec3::ZERO);
        let shift = axes.map(|axis| {
            // The grid's lines go through the origin of the world, or where the floor has brought it.
            ((middle - anchor) / self.side).dot(axis).rem_euclid(self.cell) / self.cell
        });
        let corner = |&at: &DVec3| {
            let from_middle = axes.map(|axis| (at - middle).dot(axis));
            let grid = [0, 1].map(|axis| from_middle[axis] / (self.side * self.cell) + shift[axis]);
            PaneCorner {
                position: self.relative(at),
                grid: grid.map(narrow),
                from_middle: from_middle.map(|at| narrow(at / reach)),
            }
        };
        let pane = Pane {
            corners: polygon.iter().map(corner).collect(),
            colour: self.palette.wall,
            alpha: WALL_ALPHA[usize::from(!seen)],
            grid: true,
        };
        let slab = Slab { panes: vec![pane], edges: Vec::new() };
        Some(Loose { slab, plane: floor, corners: polygon })
    }

    /// Slabs from the farthest to the nearest.
    fn in_order(&self, mut slabs: Vec<Loose>) -> Vec<Slab> {
        let distance = |loose: &Loose| {
            let count = loose.corners.len().max(1) as f64;
            (loose.corners.iter().sum::<DVec3>() / count - self.lens.eye).length()
        };
        slabs.sort_by(|one, other| distance(other).total_cmp(&distance(one)));
        if slabs.len() > MANY_SLABS {
            return slabs.into_iter().map(|loose| loose.slab).collect();
        }
        // One is drawn when nothing that is left lies behind it; where they cross, the farthest goes first.
        let mut ordered = Vec::with_capacity(slabs.len());
        while !slabs.is_empty() {
            let covers_none = |at: &usize| {
                slabs.iter().enumerate().all(|(other, loose)| other == *at || !self.covers(&slabs[*at], loose))
            };
            let next = (0..slabs.len()).find(covers_none).unwrap_or(0);
            ordered.push(slabs.remove(next).slab);
        }
        ordered
    }

    /// Whether one slab lies before another, and cannot just as well be said to lie behind it.
    fn covers(&self, front: &Loose, back: &Loose) -> bool {
        self.is_before(front, back) && !self.is_before(back, front)
    }

    /// Whether one slab lies wholly on the eye's side of another's plane, or has the other wholly behind its own.
    fn is_before(&self, front: &Loose, back: &Loose) -> bool {
        let room = 1e-6 * self.extent;
        let on_eyes_side = |(normal, height): HalfSpace, point: DVec3| {
            (normal.dot(point) - height) * (normal.dot(self.lens.eye) - height).signum()
        };
        front.corners.iter().all(|&at| on_eyes_side(back.plane, at) >= -room)
            || back.corners.iter().all(|&at| on_eyes_side(front.plane, at) <= room)
    }
}

impl Staged {
    fn add(&mut self, points: &[DVec3], triangles: &[[u32; 3]]) {
        let base = self.shadow_points.len() as u32;
        self.shadow_points.extend(points);
        self.shadow_triangles.extend(triangles.iter().map(|triangle| triangle.map(|at| base + at)));
    }
}

impl Lathe {
    fn points(&self) -> Vec<DVec3> {
        self.rings.iter().flatten().map(|(at, _)| *at).collect()
    }

    /// Triangles, counter-clockwise from outside, without those that are only a line at a pole.
    fn triangles(&self) -> Vec<[u32; 3]> {
        let count = self.rings.first().map_or(0, Vec::len) as u32;
        let last = self.rings.len() as u32;
        let mut triangles = Vec::with_capacity(2 * (count * last) as usize);
        for ring in 1..last {
            for segment in 0..count {
                let next = (segment + 1) % count;
                let [a, b] = [segment, next].map(|at| (ring - 1) * count + at);
                let [d, c] = [segment, next].map(|at| ring * count + at);
                if ring > 1 {
                    triangles.push([a, b, c]);
                }
                if ring + 1 < last {
                    triangles.push([a, c, d]);
                }
            }
        }
        triangles
    }
}

/// A round surface: rings at angles above the equator, each moved along the axis by a length (m).
fn lathe(middle: DVec3, axis: DVec3, radius: f64, profile: impl Iterator<Item = (f64, f64)>, segments: usize) -> Lathe {
    let [second, first] = Plane::new(axis, 0.0).axes;
    let around: Vec<_> = (0..segments)
        .map(|at| {
            let (sine, cosine) = libm::sincos(TAU * at as f64 / segments as f64);
            cosine * first + sine * second
        })
        .collect();
    let ring = |(angle, shift): (f64, f64)| {
        let (height, width) = libm::sincos(angle);
        // At the poles all corners are the same.
        let width = if width < 1e-12 { 0.0 } else { width };
        let corner = |out: &DVec3| {
            let normal = height * axis + width * *out;
            (middle + shift * axis + radius * normal, normal)
        };
        around.iter().map(corner).collect()
    };
    Lathe { rings: profile.map(ring).collect() }
}

/// A rod with round ends.
fn rod([from, to]: [DVec3; 2], radius: f64, segments: usize) -> Lathe {
    let (axis, half) = ((to - from).try_normalize().unwrap_or(DVec3::Y), 0.5 * from.distance(to));
    let quarter = segments / 4;
    let angle = |ring: usize| FRAC_PI_2 * ring as f64 / quarter as f64;
    let low = (0..=quarter).map(|ring| (angle(ring) - FRAC_PI_2, -half));
    let high = (0..=quarter).map(|ring| (angle(ring), half));
    lathe(from.midpoint(to), axis, radius, low.chain(high), segments)
}

/// How far a point is from a solid shape before it moves (m); negative inside.
fn height(shape: &Shape, point: DVec3) -> f64 {
    match *shape {
        Shape::Floor { normal, height } => normal.dot(point) - height,
        Shape::Plate { point: surface, normal } => normal.dot(point - surface),
        Shape::Sphere { centre, radius } => point.distance(centre) - radius,
        Shape::Capsule { from, to, radius } => {
            let along = to - from;
            let squared = along.length_squared();
            let share = if squared > 0.0 { ((point - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
            point.distance(from + share * along) - radius
        }
        Shape::Box { centre, half, turn } => {
            let beyond = (turn.conjugate() * (point - centre)).abs() - half;
            beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0)
        }
    }
}

/// The nodes of the faces of a box whose corners have a bit for each axis: low and high side of the first axis, and so
/// on; counter-clockwise from outside for right-handed axes.
const FACES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The edges of a box: their ends, and the faces that meet there.
fn edges() -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
    (0..3usize).flat_map(|axis| {
        let [one, other] = [(axis + 1) % 3, (axis + 2) % 3];
        (0..4usize).map(move |at| {
            let (low, high) = (at & 1, at >> 1);
            let from = low << one | high << other;
            ([from, from | 1 << axis], [2 * one + low, 2 * other + high])
        })
    })
}

/// The corners of a box with a bit for each axis.
fn corners(centre: DVec3, axes: [DVec3; 3], half: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|at| {
        (0..3).fold(centre, |point, axis| {
            let sign = if at >> axis & 1 == 1 { 1.0 } else { -1.0 };
            point + sign * half[axis] * axes[axis]
        })
    })
}

/// The part of a convex polygon that lies outside of half-spaces.
pub(super) fn clipped_polygon(polygon: &[DVec3], solid: &[HalfSpace]) -> Vec<DVec3> {
    let mut kept = polygon.to_vec();
    for &(normal, height) in solid {
        let above = |point: DVec3| normal.dot(point) - height;
        let mut next = Vec::with_capacity(kept.len() + 1);
        for (at, &point) in kept.iter().enumerate() {
            let before = kept[(at + kept.len() - 1) % kept.len()];
            let (from, to) = (above(before), above(point));
            if (from < 0.0) != (to < 0.0) {
                next.push(before.lerp(point, from / (from - to)));
            }
            if to >= 0.0 {
                next.push(point);
            }
        }
        kept = next;
    }
    kept
}

/// The part of a line that lies outside of half-spaces.
fn clipped_line([mut from, mut to]: [DVec3; 2], solid: &[HalfSpace]) -> Option<[DVec3; 2]> {
    for &(normal, height) in solid {
        let [a, b] = [from, to].map(|point| normal.dot(point) - height);
        match (a < 0.0, b < 0.0) {
            (true, true) => return None,
            (true, false) => from = from.lerp(to, a / (a - b)),
            (false, true) => to = from.lerp(to, a / (a - b)),
            (false, false) => {}
        }
    }
    Some([from, to])
}

/// How an obstacle moves at a point of it (m) that is at most `reach` (m) away from its pivot, or nearly.
pub(super) fn going(obstacle: &Obstacle, point: DVec3, time: f64, frame: f64, reach: f64) -> Going {
    let pivot = obstacle.shape.pivot();
    let own = obstacle.pose(time).undo(pivot, point);
    let half = 0.25 * frame;
    let [before, after] = [time - half, time + half].map(|time| obstacle.pose(time).apply(pivot, own));
    Going { velocity: (after - before) / (2.0 * half), greatest: obstacle.motion.greatest_speed(reach) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(points: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        triangles.iter().map(|three| three.map(|at| points[at as usize])).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn rods_are_closed_and_look_outward() {
        let rod = rod([DVec3::new(0.3, 0.1, 0.0), DVec3::new(1.0, 0.4, -0.2)], 0.2, 64);
        let exact = PI * 0.04 * (0.49_f64 + 0.09 + 0.04).sqrt() + 4.0 / 3.0 * PI * 0.008;
        let volume = volume(&rod.points(), &rod.triangles());
        assert!((volume / exact - 1.0).abs() < 0.01, "{volume} {exact}");
        let out = |(at, normal): &(DVec3, DVec3)| (*at - DVec3::new(0.65, 0.25, -0.1)).dot(*normal) > 0.0;
        assert!(rod.rings.iter().flatten().all(out));
    }

    #[test]
    fn the_edges_of_a_box_lie_between_its_faces() {
        assert_eq!(edges().count(), 12);
        for (ends, faces) in edges() {
            for face in faces {
                assert!(ends.iter().all(|end| FACES[face].contains(end)), "{ends:?} {face}");
            }
        }
        let all = corners(DVec3::splat(0.3), DVec3::AXES, DVec3::new(0.5, 1.0, 2.0));
        let triangles: Vec<_> = FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let triangles: Vec<_> = triangles.iter().map(|three| three.map(|at| at as u32)).collect();
        assert!((volume(&all, &triangles) - 8.0).abs() < 1e-12);
    }

    #[test]
    fn polygons_and_lines_end_where_floors_begin() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        let half = clipped_polygon(&square, &[(DVec3::Y, 0.5)]);
        assert_eq!(half.len(), 4);
        assert!(half.iter().all(|at| at.y >= 0.5));
        assert!(clipped_polygon(&square, &[(DVec3::Y, 2.0)]).is_empty());
        assert_eq!(clipped_line([DVec3::ZERO, DVec3::Y], &[(DVec3::Y, 0.5)]), Some([0.5 * DVec3::Y, DVec3::Y]));
        assert_eq!(clipped_line([DVec3::ZERO, DVec3::X], &[(DVec3::Y, 0.5)]), None);
    }
}
