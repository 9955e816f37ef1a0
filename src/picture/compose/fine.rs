//! Fine surfaces that coarse bodies carry. Data that do not depend on the frame, such as creases and the triangles around each
//! point, is found once.

use crate::bins::Bins;
use crate::carried::append_positions;
use crate::mesh::Sets;
use crate::picture::field::NOWHERE;
use crate::picture::narrow::narrow;
use crate::picture::shadow::{SurfaceCaster, edges};
use crate::sim::{Assembly, Body, Carried};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Triangles whose normals at rest have a smaller cosine meet in a crease: 40°. A prism of eight sides has creases, one of
/// twelve sides is round.
const CREASE: f64 = 0.766;
/// The least cosine between the normal at a corner of a visible triangle and the direction to the viewer. Interpolated normals
/// lean away near outlines, and would be lit from behind.
const LEAST_FACING: f32 = 0.01;
/// The least number of points or triangles for one thread.
pub(super) const OF_THREAD: usize = 2048;
/// Marks a missing entry.
pub(super) const NONE: u32 = u32::MAX;

/// The carried surface of a body.
#[derive(Debug)]
pub(super) struct Fine {
    pub(super) surface: Arc<Carried>,
    pub(super) body: usize,
    /// The nodes, elements and faces of the body.
    nodes: Range<usize>,
    pub(super) elements: Range<usize>,
    pub(super) faces: Range<usize>,
    /// The point of each corner. A point has a corner for each part of the surface around it between creases.
    pub(super) points: Vec<u32>,
    /// The corners of each triangle.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The element of the body that moves each triangle, or [`NONE`].
    pub(super) movers: Vec<u32>,
    /// The triangles in several elements, with that which moves each corner.
    pub(super) crossing: Vec<(usize, [u32; 3])>,
    /// The entries of each corner, each three times a triangle plus the place of the corner in it.
    entries: Bins<u32>,
    /// The points at the ends of each edge, and the triangles beside it, or [`NONE`].
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) beside: Vec<[u32; 2]>,
    /// The edges that are creases.
    pub(super) creases: Vec<u32>,
    /// Whether each edge has triangles on both sides.
    pub(super) is_closed: bool,
    /// The caster of its shadow.
    pub(super) shape: SurfaceCaster,
}

/// A triangle at a moment.
#[derive(Clone, Copy)]
pub(super) struct Face {
    /// Its normal, with twice the length of its area.
    normal: Vec3,
    /// The factors with which it counts in the normals of its corners.
    shares: [f32; 3],
}

impl Fine {
    /// The carried surfaces of bodies.
    pub(super) fn of(bodies: &Assembly) -> Vec<Self> {
        let carried = bodies.bodies().iter().enumerate();
        carried.filter_map(|(at, body)| Some(Self::new(body.carried()?, bodies, at))).collect()
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
        let mut parts = Sets::new(3 * triangles.len());
        let all = edges(triangles);
        let mut creases = Vec::new();
        for (edge, number) in all.iter().zip(0..) {
            let [Some(one), Some(other)] = edge.triangles() else { continue };
            let [first, second] = [one, other].map(|at| normals[at as usize]);
            if first.dot(second) < CREASE && first != DVec3::ZERO && second != DVec3::ZERO {
                creases.push(number);
                continue;
            }
            for end in edge.ends {
                let [first, second] = [one, other].map(|at| {
                    let triangle = &triangles[at as usize];
                    3 * at + triangle.iter().position(|&point| point == end).unwrap_or(0) as u32
                });
                parts.join(first, second);
            }
        }
        let mut corner_of = vec![NONE; 3 * triangles.len()];
        let (mut points, mut corners) = (Vec::with_capacity(surface.rest.len()), Vec::with_capacity(corner_of.len()));
        for entry in 0..corner_of.len() {
            let part = &mut corner_of[parts.of(entry as u32) as usize];
            if *part == NONE {
                *part = points.len() as u32;
                points.push(triangles[entry / 3][entry % 3]);
            }
            corners.push(*part);
        }
        let (movers, crossing) = movers(surface, &bodies.bodies()[body]);
        let entries = Bins::new(points.len(), corners.iter().copied().zip(0..));
        let beside: Vec<_> = all.iter().map(|edge| edge.triangles().map(|at| at.unwrap_or(NONE))).collect();
        Self {
            surface: Arc::clone(surface),
            body,
            nodes: bodies.nodes(body),
            elements: bodies.elements(body),
            faces: bodies.faces(body),
            points,
            triangles: corners.as_chunks().0.to_vec(),
            movers,
            crossing,
            entries,
            edges: all.into_iter().map(|edge| edge.ends).collect(),
            is_closed: !beside.as_flattened().contains(&NONE),
            beside,
            creases,
            shape: SurfaceCaster::new(&surface.rest, triangles),
        }
    }

    /// Appends the positions of its points (m), from those of the nodes of all bodies.
    pub(super) fn place(&self, position: &[DVec3], points: &mut Vec<DVec3>) {
        append_positions(&self.surface, &position[self.nodes.clone()], points);
    }

    /// Marks the elements inside it, among those of all bodies: full ones that move no triangle.
    pub(super) fn mark_inside(&self, bodies: &Assembly, elements: &mut [bool]) {
        let own = &mut elements[self.elements.clone()];
        let fill = bodies.bodies()[self.body].fill();
        own.iter_mut().enumerate().for_each(|(at, inside)| *inside = fill.is_none_or(|fill| fill[at] >= 1.0));
        let movers = self.movers.iter().chain(self.crossing.iter().flat_map(|(_, movers)| movers));
        movers.filter(|&&mover| mover != NONE).for_each(|&mover| own[mover as usize] = false);
    }

    /// Its triangles with its points at places, and whether an eye sees their outsides.
    ///
    /// A triangle counts in the normal of a corner by the squares of the lengths of its two sides there (Max 1999, Weights for
    /// computing vertex normals from facet normals), which is exact on spheres.
    pub(super) fn seen(&self, places: &[Vec3], gone: &[bool], eye: Vec3) -> (Vec<Face>, Vec<bool>) {
        let face = |(triangle, at): (&[u32; 3], usize)| {
            if gone.get(at).is_some_and(|&gone| gone) {
                return (Face { normal: Vec3::ZERO, shares: [0.0; 3] }, false);
            }
            let [a, b, c] = triangle.map(|point| places[point as usize]);
            let normal = (b - a).cross(c - a);
            let squares = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
            let inverse = 1.0 / (squares[0] * squares[1] * squares[2]);
            let shares = if inverse.is_finite() { squares.map(|square| square * inverse) } else { [0.0; 3] };
            (Face { normal, shares }, normal.dot(a - eye) <= 0.0)
        };
        let (mut faces, mut seen) = (Vec::new(), Vec::new());
        let triangles = self.surface.triangles.par_iter().zip(0..self.surface.triangles.len());
        triangles.with_min_len(OF_THREAD).map(face).unzip_into_vecs(&mut faces, &mut seen);
        (faces, seen)
    }

    /// Whether each triangle has a point that broken elements alone carry; empty if no element of its body is broken. An element
    /// carries a point if it has all nodes that the point follows.
    pub(super) fn gone(&self, bodies: &Assembly, broken: &[bool]) -> Vec<bool> {
        let Some(broken) = broken.get(self.elements.clone()).filter(|broken| broken.contains(&true)) else {
            return Vec::new();
        };
        let body = &bodies.bodies()[self.body];
        let around = elements_around(body);
        let is_gone = |point: usize| {
            let (nodes, weights) = self.surface.weights.of(point);
            let followed: Vec<_> =
                nodes.iter().zip(weights).filter(|&(_, &weight)| weight != 0.0).map(|(node, _)| node).collect();
            let Some(&&first) = followed.first() else { return false };
            let carries = |element: u32| followed.iter().all(|node| body.elements()[element as usize].contains(node));
            let mut carriers = around.of(first as usize).iter().filter(|&&element| carries(element)).peekable();
            carriers.peek().is_some() && carriers.all(|&element| broken[element as usize])
        };
        let points: Vec<_> =
            (0..self.surface.rest.len()).into_par_iter().with_min_len(OF_THREAD).map(is_gone).collect();
        let has_gone = |triangle: &[u32; 3]| triangle.iter().any(|&point| points[point as usize]);
        self.surface.triangles.par_iter().with_min_len(OF_THREAD).map(has_gone).collect()
    }

    /// The unit normal at a corner at a place.
    pub(super) fn normal(&self, corner: usize, at: Vec3, (faces, seen): &(Vec<Face>, Vec<bool>), eye: Vec3) -> Vec3 {
        let (mut sum, mut is_seen) = (Vec3::ZERO, false);
        for &entry in self.entries.of(corner) {
            let (triangle, place) = (entry as usize / 3, entry as usize % 3);
            sum += faces[triangle].shares[place] * faces[triangle].normal;
            is_seen |= seen[triangle];
        }
        let (normal, view) = (sum.normalize_or_zero(), (eye - at).normalize_or_zero());
        let facing = normal.dot(view);
        if is_seen && facing < LEAST_FACING {
            return (normal + (LEAST_FACING - facing) * view).normalize_or_zero();
        }
        normal
    }

    /// The places of its points on the scale of a field, from those of the nodes of all bodies.
    pub(super) fn shades(&self, of_nodes: &[f32]) -> Vec<f32> {
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

/// The elements of a body around each node.
fn elements_around(body: &Body) -> Bins<u32> {
    let elements = body.elements().iter().zip(0..);
    Bins::new(body.len(), elements.flat_map(|(nodes, element)| nodes.iter().map(move |&node| (node, element))))
}

/// The element of a body that moves each triangle of a surface: one with all nodes that its points follow or, where the surface
/// passes from one element to another, that of a point. Such triangles are listed with the elements of all three points.
fn movers(surface: &Carried, body: &Body) -> (Vec<u32>, Vec<(usize, [u32; 3])>) {
    let around = elements_around(body);
    let nodes = |point: u32| surface.weights.of(point as usize).0;
    let mover = |points: &[u32]| {
        let first = *nodes(points[0]).first()?;
        let mut around = around.of(first as usize).iter().copied();
        let holds = |element: u32, node| body.elements()[element as usize].contains(node);
        around.find(|&element| points.iter().all(|&point| nodes(point).iter().all(|node| holds(element, node))))
    };
    let of_triangle = |triangle: &[u32; 3]| match mover(triangle) {
        Some(one) => [one; 3],
        None => triangle.map(|point| mover(&[point]).unwrap_or(NONE)),
    };
    let all: Vec<_> = surface.triangles.par_iter().with_min_len(OF_THREAD).map(of_triangle).collect();
    let crossing = all.iter().copied().enumerate().filter(|(_, [a, b, c])| a != b || b != c).collect();
    (all.into_iter().map(|movers| movers[0]).collect(), crossing)
}
