//! Closed surfaces of sets of elements: their triangles, edges and contours.

use super::camera::Lens;
use super::ears::Ears;
use super::field::Shades;
use super::narrow::{narrow, narrow_point};
use super::{Line, LineKind, Mesh, Vertex};
use crate::sim::body::Body;
use crate::sim::topology::{around, ordered};
use glam::DVec3;
use std::collections::HashMap;

/// Stripes of the hatch have this period along `X + Y + Z` of the body at rest (units of soft distances).
const HATCH_PERIOD: f64 = 0.30;
/// A patch is cut so finely that its flat pieces are nowhere farther from it than this (px).
const FLATNESS: f64 = 0.35;
/// Between faces that are seen at a smaller cosine than this and others contours come and go gently.
const GRAZING: f64 = 0.02;
/// The finest cut of a patch in each direction.
const FINEST_CUT: usize = 6;

/// A face that bounds a set of elements.
pub(super) struct Side {
    /// Its corners, seen from outside of the set counter-clockwise.
    nodes: Vec<u32>,
    /// The element of the set that it belongs to.
    element: Option<u32>,
}

/// Faces that bound a set of elements, seen from outside of it counter-clockwise.
///
/// A face bounds a set when exactly one of its two sides is in it. The side of a face that belongs to no element counts
/// as outside of every set; a face that bounds no element at all belongs to the sound ones.
pub(super) fn boundary(body: &Body, turned_over: &[bool], over: bool) -> Vec<Side> {
    let inside =
        |element: Option<u32>| element.is_some_and(|at| turned_over.get(at as usize).copied().unwrap_or(false) == over);
    let faces = &body.faces;
    let sides = faces.inner.iter().zip(&faces.outer);
    let bounding =
        faces.nodes.iter().zip(sides).filter_map(|(nodes, (&inner, &outer))| match (inside(inner), inside(outer)) {
            (true, false) => Some(Side { nodes: nodes.to_vec(), element: inner }),
            (false, true) => Some(Side { nodes: nodes.iter().rev().copied().collect(), element: outer }),
            _ if inner.is_none() && outer.is_none() && !over => Some(Side { nodes: nodes.to_vec(), element: None }),
            _ => None,
        });
    bounding.collect()
}

/// What is needed to turn faces into what a panel shows.
pub(super) struct Surroundings<'a> {
    pub(super) body: &'a Body,
    pub(super) ears: &'a Ears,
    pub(super) position: &'a [DVec3],
    pub(super) lens: &'a Lens,
    /// The panel's origin (m).
    pub(super) origin: DVec3,
    /// The panel's unit of length (m).
    pub(super) side: f64,
    /// The unit of the hatch (m).
    pub(super) soft: f64,
    /// The field that colours the surfaces.
    pub(super) shades: Option<&'a Shades>,
}

/// Kinds of lines on a surface.
#[derive(Clone, Copy)]
pub(super) struct Lines {
    pub(super) edge: LineKind,
    pub(super) contour: LineKind,
}

/// A grid of points on one face, cut evenly in both directions. Triangles are grids with one side of length zero.
struct Patch {
    /// The corners of the small triangles, as places in `points`.
    triangles: Vec<[u32; 3]>,
    points: Vec<DVec3>,
}

impl Surroundings<'_> {
    fn at(&self, node: u32) -> DVec3 {
        self.position[node as usize]
    }

    /// Adds a surface to a mesh and its lines to the lines.
    pub(super) fn add(&self, faces: &[Side], kinds: Lines, mesh: &mut Mesh, lines: &mut Vec<Line>) {
        let cut = self.cut(faces);
        // For each pair of points, the facing of the triangles beside it: the same as the first, or not.
        let mut borders: HashMap<(u32, u32, usize), Facing> = HashMap::new();
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for side in faces {
            let face = &side.nodes[..];
            let patch = self.patch(face, cut);
            let facing = self.emit(side, &patch, mesh);
            self.inner_contours(&patch, &facing, kinds, lines);
            self.note_borders(face, cut, &facing, &mut borders);
            edges.extend(around(face).map(ordered));
        }
        edges.sort_unstable();
        edges.dedup();
        for &[a, b] in &edges {
            lines.push(self.line(self.at(a), self.at(b), kinds.edge, 1.0));
            let (start, along) = (self.at(a), (self.at(b) - self.at(a)) / cut as f64);
            for piece in 0..cut {
                let strength = borders.get(&(a, b, piece)).map_or(0.0, Facing::contour);
                if strength > 0.0 {
                    let [from, to] = [piece, piece + 1].map(|at| start + at as f64 * along);
                    lines.push(self.line(from, to, kinds.contour, strength));
                }
            }
        }
    }

    fn line(&self, from: DVec3, to: DVec3, kind: LineKind, strength: f64) -> Line {
        let relative = |point: DVec3| narrow_point((point - self.origin) / self.side).to_array();
        Line { from: relative(from), to: relative(to), kind, strength: narrow(strength) }
    }

    /// Into how many cells each quadrilateral is cut in each direction, the same for all, so that neighbours fit.
    fn cut(&self, faces: &[Side]) -> usize {
        let warp = |face: &[u32]| match face[..] {
            [a, b, c, d] if self.ears.of(face).is_none() => {
                (self.at(a) - self.at(b) + self.at(c) - self.at(d)).length()
            }
            _ => 0.0,
        };
        let deviation = |side: &Side| {
            let face = &side.nodes[..];
            let (_, distance) = self.lens.project(self.at(face[0]))?;
            let scale = if self.lens.orthographic { self.lens.focal } else { self.lens.focal / distance };
            // In the middle of a patch its diagonals are half of this apart, each a quarter away from the patch.
            Some(warp(face) / 4.0 * scale)
        };
        let largest = faces.iter().filter_map(deviation).fold(0.0, f64::max);
        let needed = (largest / FLATNESS).sqrt().ceil();
        let affordable = if faces.len() > 3000 { 2 } else { FINEST_CUT };
        if needed >= affordable as f64 { affordable } else { (needed as usize).max(1) }
    }

    fn patch(&self, face: &[u32], cut: usize) -> Patch {
        if let Some(triangles) = self.ears.of(face) {
            return Patch { triangles: triangles.to_vec(), points: face.iter().map(|&node| self.at(node)).collect() };
        }
        match face[..] {
            [a, b, c, d] => bilinear([a, b, c, d].map(|node| self.at(node)), cut),
            _ => {
                // A fan around the middle; for a triangle the middle is not needed.
                let corners: Vec<_> = face.iter().map(|&node| self.at(node)).collect();
                let count = corners.len() as u32;
                if count == 3 {
                    return Patch { triangles: vec![[0, 1, 2]], points: corners };
                }
                let middle = corners.iter().sum::<DVec3>() / f64::from(count);
                let triangles = (0..count).map(|at| [at, (at + 1) % count, count]).collect();
                Patch { triangles, points: corners.into_iter().chain([middle]).collect() }
            }
        }
    }

    /// Adds the triangles of a patch to a mesh and says of each how much it shows its outside, from 0 to 1.
    fn emit(&self, side: &Side, patch: &Patch, mesh: &mut Mesh) -> Vec<f64> {
        let face = &side.nodes[..];
        let base = u32::try_from(mesh.vertices.len()).expect("fewer than 2^32 vertices");
        let corners: Vec<_> = face.iter().map(|&node| self.at(node)).collect();
        let phases: Vec<_> = face
            .iter()
            .map(|&node| self.body.rest[node as usize].dot(DVec3::ONE) / (HATCH_PERIOD * self.soft))
            .collect();
        let is_bilinear = face.len() == 4 && self.ears.of(face).is_none();
        let weights = weights(face.len(), patch.points.len(), is_bilinear);
        for (point, weight) in patch.points.iter().zip(&weights) {
            let normal = match corners[..] {
                [a, b, c, d] if is_bilinear => bilinear_normal([a, b, c, d], weight.place),
                _ => newell(&corners),
            };
            let phase: f64 = weight.of_corner.iter().zip(&phases).map(|(weight, phase)| weight * phase).sum();
            mesh.vertices.push(Vertex {
                position: narrow_point((*point - self.origin) / self.side).to_array(),
                normal: narrow_point(normal / (self.side * self.side)).to_array(),
                hatch: narrow(phase),
            });
        }
        if let Some(shades) = self.shades {
            let corners = shades.corners(face, side.element);
            mesh.shades.extend(weights.iter().map(|weight| {
                let shares = weight.of_corner.iter().zip(&corners);
                narrow(shares.map(|(weight, &corner)| weight * f64::from(corner)).sum())
            }));
        }
        let mut facing = Vec::with_capacity(patch.triangles.len());
        for triangle in &patch.triangles {
            let [a, b, c] = triangle.map(|at| patch.points[at as usize]);
            let cosine = self.lens.facing(a, (b - a).cross(c - a));
            facing.push((0.5 + 0.5 * cosine / GRAZING).clamp(0.0, 1.0));
            mesh.triangles.push(triangle.map(|at| base + at));
        }
        facing
    }

    /// Contours between the triangles of one patch.
    fn inner_contours(&self, patch: &Patch, facing: &[f64], kinds: Lines, lines: &mut Vec<Line>) {
        if facing.windows(2).all(|two| two[0] == two[1]) {
            return;
        }
        let mut sides: HashMap<[u32; 2], f64> = HashMap::new();
        for (triangle, &seen) in patch.triangles.iter().zip(facing) {
            for side in around(triangle) {
                if let Some(other) = sides.insert(ordered(side), seen)
                    && other != seen
                {
                    let [a, b] = side.map(|at| patch.points[at as usize]);
                    lines.push(self.line(a, b, kinds.contour, contour(other, seen)));
                }
            }
        }
    }

    /// Notes how the triangles along the sides of a face are turned.
    fn note_borders(&self, face: &[u32], cut: usize, facing: &[f64], borders: &mut HashMap<(u32, u32, usize), Facing>) {
        let ears = self.ears.of(face);
        for (side, [a, b]) in around(face).enumerate() {
            let two = [side as u32, ((side + 1) % face.len()) as u32];
            // The one triangle that has this side.
            let ear = ears.and_then(|ears| ears.iter().position(|ear| two.iter().all(|corner| ear.contains(corner))));
            for piece in 0..cut {
                let seen = match face.len() {
                    _ if ears.is_some() => ear.map_or(1.0, |at| facing[at]),
                    4 => facing[border_triangle(side, piece, cut)],
                    3 => facing[0],
                    _ => facing[side],
                };
                let key = if a < b { (a, b, piece) } else { (b, a, cut - 1 - piece) };
                borders.entry(key).and_modify(|facing| facing.meet(seen)).or_insert(Facing::new(seen));
            }
        }
    }
}

/// How the triangles that share a line are turned.
struct Facing {
    least: f64,
    most: f64,
    count: u32,
}

impl Facing {
    fn new(seen: f64) -> Self {
        Self { least: seen, most: seen, count: 1 }
    }

    fn meet(&mut self, seen: f64) {
        self.least = self.least.min(seen);
        self.most = self.most.max(seen);
        self.count += 1;
    }

    /// How much of a contour the line is.
    fn contour(&self) -> f64 {
        if self.count == 1 { 1.0 } else { contour(self.least, self.most) }
    }
}

/// How much of a contour lies between two triangles that show their outsides so much. Of the lines around one that is
/// seen from the side, those on one side or those on the other are contours as a whole.
fn contour(one: f64, other: f64) -> f64 {
    (3.0 * (one - other).abs()).min(1.0)
}

/// A bilinear patch cut into `cut` × `cut` cells of two triangles.
fn bilinear([a, b, c, d]: [DVec3; 4], cut: usize) -> Patch {
    let across = (cut + 1) as u32;
    let mut points = Vec::with_capacity((cut + 1) * (cut + 1));
    for row in 0..=cut {
        for column in 0..=cut {
            let [u, v] = [column, row].map(|at| at as f64 / cut as f64);
            points.push(a.lerp(b, u).lerp(d.lerp(c, u), v));
        }
    }
    let mut triangles = Vec::with_capacity(2 * cut * cut);
    for row in 0..cut as u32 {
        for column in 0..cut as u32 {
            let at = row * across + column;
            triangles.push([at, at + 1, at + across + 1]);
            triangles.push([at, at + across + 1, at + across]);
        }
    }
    Patch { triangles, points }
}

/// The triangle of [`bilinear`] that holds a piece of a side of the quadrilateral.
fn border_triangle(side: usize, piece: usize, cut: usize) -> usize {
    let last = cut - 1;
    match side {
        0 => 2 * piece,
        1 => 2 * (piece * cut + last),
        2 => 2 * (last * cut + last - piece) + 1,
        _ => 2 * ((last - piece) * cut) + 1,
    }
}

/// The normal of a bilinear patch, as long as the area it stands for. It is linear in both directions, so that its
/// values at the corners of any triangulation are enough to have it everywhere.
fn bilinear_normal([a, b, c, d]: [DVec3; 4], [u, v]: [f64; 2]) -> DVec3 {
    let along_u = (b - a).lerp(c - d, v);
    let along_v = (d - a).lerp(c - b, u);
    along_u.cross(along_v)
}

/// The mean normal of a polygon, as long as twice its area (Newell's method).
fn newell(corners: &[DVec3]) -> DVec3 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&a, &b)| (a - corners[0]).cross(b - corners[0])).sum()
}

/// Where a point of a patch stands in its face.
struct Weight {
    of_corner: Vec<f64>,
    place: [f64; 2],
}

/// The weights of all points of a patch, in their order.
fn weights(corners: usize, points: usize, is_bilinear: bool) -> Vec<Weight> {
    if is_bilinear {
        let cut = points.isqrt() - 1;
        let place = |at: usize| [at % (cut + 1), at / (cut + 1)].map(|along| along as f64 / cut as f64);
        let weight = |[u, v]: [f64; 2]| {
            let of_corner = vec![(1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v];
            Weight { of_corner, place: [u, v] }
        };
        return (0..points).map(|at| weight(place(at))).collect();
    }
    (0..points)
        .map(|at| {
            let share = |corner: usize| {
                if at == corners {
                    1.0 / corners as f64
                } else if at == corner {
                    1.0
                } else {
                    0.0
                }
            };
            Weight { of_corner: (0..corners).map(share).collect(), place: [0.0; 2] }
        })
        .collect()
}
