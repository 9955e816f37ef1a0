//! Fine surfaces that coarse bodies carry. What does not depend on the frame, such as creases and the triangles around each
//! point, is found once.

use super::chart::needed;
use super::field::NOWHERE;
use super::narrow::{narrow, narrow_count, narrow_point};
use super::page::{self, joined};
use super::shadow::{Edge, edges};
use super::shell::Side;
use super::surface::{Border, SurfaceLines, Surroundings, newell};
use super::{LineKind, Mesh, Vertex};
use crate::look::BODIES;
use crate::sim::geometry::{around, ordered};
use crate::sim::{Assembly, Carried};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Triangles whose normals at rest have a smaller cosine meet in a crease: 40°. A prism of eight sides has creases, one of
/// twelve sides is round.
const CREASE: f64 = 0.766;
/// The least cosine between the normal at a corner of a visible triangle and the direction to the viewer. Interpolated normals
/// lean away near outlines, and would be lit from behind.
const LEAST_FACING: f64 = 0.01;
/// Points of contours and creases that lie nearer than this to the straight line between others are left out (px).
const STRAIGHT: f64 = 0.15;
/// The least number of points or triangles for one thread.
const OF_THREAD: usize = 2048;

/// The carried surface of a body.
#[derive(Debug)]
pub(super) struct Fine {
    pub(super) surface: Arc<Carried>,
    body: usize,
    /// The nodes, elements and faces of the body.
    nodes: Range<usize>,
    elements: Range<usize>,
    pub(super) faces: Range<usize>,
    /// The point of each corner. A point has a corner for each part of the surface around it between creases.
    points: Vec<u32>,
    /// The corners of each triangle.
    triangles: Vec<[u32; 3]>,
    /// For each corner the end of its entries, each three times a triangle plus the place of the corner in it.
    ends: Vec<u32>,
    entries: Vec<u32>,
    /// Edges, and whether they are creases.
    seams: Vec<(Edge, bool)>,
    /// Whether each edge has triangles on both sides.
    is_closed: bool,
}

/// A triangle at a moment.
struct Face {
    /// Its normal, with twice the length of its area.
    normal: DVec3,
    /// The factors with which it counts in the normals of its corners.
    shares: [f64; 3],
    /// Whether the viewer sees its outside.
    is_seen: bool,
}

impl Fine {
    /// The carried surfaces of bodies.
    pub(super) fn of(bodies: &Assembly) -> Vec<Self> {
        let carried = bodies.bodies().iter().enumerate();
        carried.filter_map(|(at, body)| Some(Self::new(body.carried.as_ref()?, bodies, at))).collect()
    }

    fn new(surface: &Arc<Carried>, bodies: &Assembly, body: usize) -> Self {
        let triangles = &surface.triangles;
        let place = |point: u32| surface.rest[point as usize];
        let normals: Vec<_> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(place);
                (b - a).cross(c - a).normalize_or_zero()
            })
            .collect();
        let mut parts: Vec<u32> = (0..3 * triangles.len() as u32).collect();
        let mut is_closed = true;
        let seam = |edge: Edge| {
            let [Some(one), Some(other)] = edge.triangles() else {
                is_closed = false;
                return (edge, false);
            };
            let [first, second] = [one, other].map(|at| normals[at as usize]);
            let is_crease = first.dot(second) < CREASE && first != DVec3::ZERO && second != DVec3::ZERO;
            if !is_crease {
                for end in edge.ends {
                    let [first, second] = [one, other].map(|at| {
                        let triangle = &triangles[at as usize];
                        3 * at + triangle.iter().position(|&point| point == end).unwrap_or(0) as u32
                    });
                    join(&mut parts, first, second);
                }
            }
            (edge, is_crease)
        };
        let seams = edges(triangles).into_iter().map(seam).collect();
        let mut corner_of = vec![u32::MAX; parts.len()];
        let (mut points, mut corners) = (Vec::with_capacity(surface.rest.len()), Vec::with_capacity(parts.len()));
        for entry in 0..parts.len() {
            let part = &mut corner_of[root(&mut parts, entry as u32) as usize];
            if *part == u32::MAX {
                *part = points.len() as u32;
                points.push(triangles[entry / 3][entry % 3]);
            }
            corners.push(*part);
        }
        // The entries of each corner, in order.
        let mut ends = vec![0_u32; points.len() + 1];
        corners.iter().for_each(|&corner| ends[corner as usize + 1] += 1);
        (0..points.len()).for_each(|corner| ends[corner + 1] += ends[corner]);
        let mut entries = vec![0; corners.len()];
        for (entry, &corner) in corners.iter().enumerate() {
            let place = &mut ends[corner as usize];
            entries[*place as usize] = entry as u32;
            *place += 1;
        }
        Self {
            surface: Arc::clone(surface),
            body,
            nodes: bodies.nodes(body),
            elements: bodies.elements(body),
            faces: bodies.faces(body),
            points,
            triangles: corners.as_chunks().0.to_vec(),
            ends,
            entries,
            seams,
            is_closed,
        }
    }

    /// Appends the positions of its points (m), from those of the nodes of all bodies.
    pub(super) fn place(&self, position: &[DVec3], points: &mut Vec<DVec3>) {
        self.surface.append_positions(&position[self.nodes.clone()], points);
    }

    /// Its triangles, with its points at positions (m), seen from an eye.
    ///
    /// A triangle counts in the normal of a corner by the squares of the lengths of its two sides there (Max 1999, Weights for
    /// computing vertex normals from facet normals), which is exact on spheres.
    fn seen(&self, points: &[DVec3], eye: DVec3) -> Vec<Face> {
        let face = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|point| points[point as usize]);
            let normal = (b - a).cross(c - a);
            let squares = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
            let inverse = 1.0 / (squares[0] * squares[1] * squares[2]);
            let shares = if inverse.is_finite() { squares.map(|square| square * inverse) } else { [0.0; 3] };
            Face { normal, shares, is_seen: normal.dot(a - eye) <= 0.0 }
        };
        self.surface.triangles.par_iter().with_min_len(OF_THREAD).map(face).collect()
    }

    /// The unit normal at a corner at a position (m).
    fn normal(&self, corner: usize, at: DVec3, faces: &[Face], eye: DVec3) -> DVec3 {
        let start = corner.checked_sub(1).map_or(0, |before| self.ends[before]) as usize;
        let (mut sum, mut is_seen) = (DVec3::ZERO, false);
        for &entry in &self.entries[start..self.ends[corner] as usize] {
            let face = &faces[entry as usize / 3];
            sum += face.shares[entry as usize % 3] * face.normal;
            is_seen |= face.is_seen;
        }
        let (normal, view) = (sum.normalize_or_zero(), (eye - at).normalize_or_zero());
        let facing = normal.dot(view);
        if is_seen && facing < LEAST_FACING {
            return (normal + (LEAST_FACING - facing) * view).normalize_or_zero();
        }
        normal
    }

    /// The places of its points on the scale of a field, from those of the nodes of all bodies.
    fn shades(&self, of_nodes: &[f32]) -> Vec<f32> {
        let of_nodes = &of_nodes[self.nodes.clone()];
        let shade = |point: usize| {
            let (nodes, weights) = self.surface.weights.of(point);
            let places = || nodes.iter().map(|&node| of_nodes[node as usize]);
            let sum: f64 = places().zip(weights).map(|(place, weight)| f64::from(place) * weight).sum();
            // A value needs those of all its nodes.
            if places().any(|place| place == NOWHERE) { NOWHERE } else { narrow(sum.clamp(0.0, 1.0)) }
        };
        (0..self.surface.rest.len()).into_par_iter().with_min_len(OF_THREAD).map(shade).collect()
    }
}

impl Surroundings<'_> {
    /// Adds a carried surface with its points at positions (m) to a mesh, and its lines to the lines. `of_nodes` has the places
    /// of nodes on the scale of a field, if there is one.
    pub(super) fn add_carried(
        &self,
        fine: &Fine,
        points: &[DVec3],
        turned_over: &[bool],
        of_nodes: &[f32],
        mesh: &mut Mesh,
        lines: &mut SurfaceLines,
    ) {
        let eye = self.lens.eye;
        let faces = fine.seen(points, eye);
        let base = mesh.vertices.len() as u32;
        let vertex = |corner: usize| {
            let at = points[fine.points[corner] as usize];
            let normal = narrow_point(fine.normal(corner, at, &faces, eye));
            Vertex { position: self.relative(at), normal: normal.to_array(), hatch: 0.0 }
        };
        mesh.vertices.par_extend((0..fine.points.len()).into_par_iter().with_min_len(OF_THREAD).map(vertex));
        if self.coloured {
            mesh.shades.resize(mesh.vertices.len(), -1.0 - narrow_count(fine.body % BODIES));
        } else if self.shades.is_some() {
            let shades = fine.shades(of_nodes);
            mesh.shades.extend(fine.points.iter().map(|&point| shades[point as usize]));
        }
        // From outside nobody sees the inside of a closed surface of which no part has turned over.
        let has_turned = turned_over.get(fine.elements.clone()).is_some_and(|over| over.contains(&true));
        let sides: &[bool] = if fine.is_closed && !has_turned { &[true] } else { &[true, false] };
        for &is_seen in sides {
            let shown = fine.triangles.iter().zip(&faces).filter(|(_, face)| face.is_seen == is_seen);
            mesh.triangles.extend(shown.map(|(triangle, _)| triangle.map(|corner| base + corner)));
        }
        let (mut contours, mut creases) = (Vec::new(), Vec::new());
        for (edge, is_crease) in &fine.seams {
            let [one, other] = edge.triangles().map(|at| at.map(|at| faces[at as usize].is_seen));
            if one != other {
                contours.push(edge.ends);
            } else if *is_crease && one == Some(true) {
                creases.push(edge.ends);
            }
        }
        for ends in self.long(&contours, points) {
            let line = self.line(ends, LineKind::FineContour, 1.0);
            lines.drawn.push(line);
            lines.borders.push(Border { line, edge: None });
        }
        let of_creases = self.long(&creases, points).into_iter();
        let border = |ends| Border { line: self.line(ends, LineKind::Edge, 1.0), edge: None };
        lines.borders.extend(of_creases.map(border));
    }

    /// Adds the edges of faces that carry a surface to the lines: of sound elements those of faces towards the viewer, of
    /// turned-over elements all.
    pub(super) fn add_cage(&self, faces: &[Side], kind: LineKind, lines: &mut SurfaceLines) {
        let (mut nodes, mut edges) = (Vec::new(), Vec::new());
        for side in faces {
            self.corners(side, &mut nodes);
            let corners: Vec<_> = nodes.iter().map(|&node| self.at(node)).collect();
            if kind.is_alarm() || self.facing(corners[0], newell(&corners)) >= 0.0 {
                edges.extend(around(&nodes).map(ordered));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        lines.drawn.extend(edges.into_iter().map(|ends| self.line(ends.map(|node| self.at(node)), kind, 0.0)));
    }

    /// The ends (m) of lines between pairs of points, joined, and without points that could not be told from straight lines.
    fn long(&self, pairs: &[[u32; 2]], points: &[DVec3]) -> Vec<[DVec3; 2]> {
        let place = |point: u32| points[point as usize];
        let pixel = |point: u32| self.lens.project(place(point)).map_or([f64::NAN; 2], |(pixel, _)| pixel);
        let mut all = Vec::with_capacity(pairs.len());
        for line in joined(pairs, |point| page::point(pixel(point).into())) {
            let needed = needed(&line.iter().map(|&point| pixel(point)).collect::<Vec<_>>(), STRAIGHT);
            let kept: Vec<_> =
                line.into_iter().zip(needed).filter(|&(_, kept)| kept).map(|(at, _)| place(at)).collect();
            all.extend(kept.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        all
    }
}

/// The first of the set of one of many numbers; each has another one of its set, or itself if it is the first.
fn root(sets: &mut [u32], mut of: u32) -> u32 {
    while sets[of as usize] != of {
        // Shorter paths.
        let next = sets[of as usize];
        sets[of as usize] = sets[next as usize];
        of = next;
    }
    of
}

/// Unites two sets.
fn join(sets: &mut [u32], one: u32, other: u32) {
    let (one, other) = (root(sets, one), root(sets, other));
    sets[one.max(other) as usize] = one.min(other);
}
