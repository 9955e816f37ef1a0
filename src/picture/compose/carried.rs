//! Fine surfaces that coarse bodies carry. Data that do not depend on the frame, such as creases and the triangles around each
//! point, is found once.

use crate::bins::Bins;
use crate::carried::append_positions;
use crate::look::BODIES;
use crate::mesh::Sets;
use crate::picture::chart::needed;
use crate::picture::compose::rim::{Rim, Turned};
use crate::picture::compose::surface::{Border, SurfaceLines, Surfaces};
use crate::picture::ears::newell;
use crate::picture::field::NOWHERE;
use crate::picture::narrow::{narrow, narrow_count, narrow_point};
use crate::picture::page::{self, joined};
use crate::picture::shadow::{SurfaceCaster, edges};
use crate::picture::shell::Side;
use crate::picture::{LineKind, Mesh, Vertex};
use crate::sim::geometry::{around, ordered};
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
/// Points of contours and creases that lie nearer than this to the straight line between others are left out (px).
const STRAIGHT: f64 = 0.15;
/// The least number of points or triangles for one thread.
const OF_THREAD: usize = 2048;
/// Marks a missing entry.
const NONE: u32 = u32::MAX;

/// The carried surface of a body.
#[derive(Debug)]
pub(super) struct Fine {
    pub(super) surface: Arc<Carried>,
    pub(super) body: usize,
    /// The nodes, elements and faces of the body.
    nodes: Range<usize>,
    elements: Range<usize>,
    pub(super) faces: Range<usize>,
    /// The point of each corner. A point has a corner for each part of the surface around it between creases.
    pub(super) points: Vec<u32>,
    /// The corners of each triangle.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The element of the body that moves each triangle, or [`NONE`].
    movers: Vec<u32>,
    /// The triangles in several elements, with that which moves each corner.
    pub(super) crossing: Vec<(usize, [u32; 3])>,
    /// The entries of each corner, each three times a triangle plus the place of the corner in it.
    entries: Bins<u32>,
    /// The points at the ends of each edge, and the triangles beside it, or [`NONE`].
    edges: Vec<[u32; 2]>,
    beside: Vec<[u32; 2]>,
    /// The edges that are creases.
    creases: Vec<u32>,
    /// Whether each edge has triangles on both sides.
    is_closed: bool,
    /// The caster of its shadow.
    pub(super) shape: SurfaceCaster,
}

/// A triangle at a moment.
#[derive(Clone, Copy)]
struct Face {
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
    fn seen(&self, places: &[Vec3], gone: &[bool], eye: Vec3) -> (Vec<Face>, Vec<bool>) {
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
    fn normal(&self, corner: usize, at: Vec3, (faces, seen): &(Vec<Face>, Vec<bool>), eye: Vec3) -> Vec3 {
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

impl Surfaces<'_> {
    /// Adds a carried surface with its points at positions (m) to the meshes of sound and of turned-over elements, and its
    /// lines to the lines. `of_nodes` has the places of nodes on the scale of a field, if there is one.
    pub(super) fn add_carried(
        &self,
        fine: &Fine,
        points: &[DVec3],
        [over, broken]: [&[bool]; 2],
        of_nodes: &[f32],
        [sound, turned_over]: [&mut Mesh; 2],
        lines: &mut SurfaceLines,
    ) {
        let (origin, per_side) = (self.draft.origin, 1.0 / self.draft.side);
        let place = |at: &DVec3| narrow_point((at - origin) * per_side);
        let (eye, mut places) = (place(&self.draft.lens.eye), Vec::new());
        points.par_iter().with_min_len(OF_THREAD).map(place).collect_into_vec(&mut places);
        let gone = fine.gone(self.draft.bodies.assembly, broken);
        let faces = fine.seen(&places, &gone, eye);
        let vertex = |corner: usize| {
            let at = places[fine.points[corner] as usize];
            Vertex { position: at.to_array(), normal: fine.normal(corner, at, &faces, eye).to_array(), hatch: 0.0 }
        };
        let base = sound.vertices.len();
        sound.vertices.par_extend((0..fine.points.len()).into_par_iter().with_min_len(OF_THREAD).map(vertex));
        if !self.colours().is_empty() {
            sound.shades.resize(sound.vertices.len(), -1.0 - narrow_count(fine.body % BODIES));
        } else if self.draft.shades.is_some() {
            let shades = fine.shades(of_nodes);
            sound.shades.extend(fine.points.iter().map(|&point| shades[point as usize]));
        }
        let seen = faces.1;
        let is_whole = |at: usize| gone.get(at).is_none_or(|gone| !gone);
        let side = |at: usize| seen.get(at).filter(|_| is_whole(at));
        let over = over.get(fine.elements.clone()).filter(|over| over.contains(&true)).unwrap_or_default();
        let turned =
            |&mover: &u32| if over.get(mover as usize).is_some_and(|&over| over) { Turned::Yes } else { Turned::No };
        let mut turned: Vec<_> = if over.is_empty() { Vec::new() } else { fine.movers.iter().map(turned).collect() };
        let mut rim = Rim::default();
        if !over.is_empty() {
            rim = Rim::new(fine, &self.draft.bodies.assembly.bodies()[fine.body], over, &mut turned);
            rim.add_corners(&mut sound.vertices, &mut sound.shades, base);
        }
        // From outside nobody sees the inside of a closed surface of which no part has turned over or is gone.
        let is_shut = fine.is_closed && turned.is_empty() && gone.is_empty();
        let sides: &[bool] = if is_shut { &[true] } else { &[true, false] };
        let is_sound = |at: usize| is_whole(at) && turned.get(at).is_none_or(|&turned| turned == Turned::No);
        let parts = |over: bool| rim.parts.iter().filter(move |part| part.2 == over && is_whole(part.0));
        for &side in sides {
            let shown = fine.triangles.iter().enumerate().filter(|&(at, _)| seen[at] == side && is_sound(at));
            let cut = parts(false).filter(|part| seen[part.0] == side).map(|part| part.1);
            let corners = shown.map(|(_, triangle)| *triangle).chain(cut);
            sound.triangles.extend(corners.map(|triangle| triangle.map(|corner| base as u32 + corner)));
        }
        if is_shut {
            let unseen = fine.triangles.iter().zip(&seen).filter(|(_, seen)| !**seen).map(|(triangle, _)| triangle);
            sound.unseen.extend(unseen.map(|triangle| triangle.map(|corner| base as u32 + corner)));
        }
        let is_over = |&(at, _): &(usize, &[u32; 3])| is_whole(at) && turned.get(at) == Some(&Turned::Yes);
        if !turned.is_empty() {
            let over = fine.triangles.iter().enumerate().filter(is_over).map(|(_, triangle)| *triangle);
            self.add_turned_over(fine, over.chain(parts(true).map(|part| part.1)), &rim, sound, turned_over, base);
        }
        let ends = |edge: usize| fine.edges[edge];
        let edges_where = |holds: &(dyn Fn([usize; 2]) -> bool + Sync)| -> Vec<_> {
            let holds = |beside: &[u32; 2]| holds(beside.map(|at| at as usize));
            let beside = fine.beside.par_iter().with_min_len(OF_THREAD).enumerate();
            beside.filter(|(_, beside)| holds(beside)).map(|(edge, _)| ends(edge)).collect()
        };
        for ends in self.long(&edges_where(&|[one, other]| side(one) != side(other)), points) {
            let line = self.draft.line(ends, LineKind::FineContour, 1.0);
            lines.drawn.push(line);
            lines.borders.push(Border { line, edge: None });
        }
        let are_seen = |&edge: &usize| fine.beside[edge].iter().all(|&at| seen[at as usize]);
        let creases: Vec<_> = fine.creases.iter().map(|&edge| edge as usize).filter(are_seen).map(ends).collect();
        let border = |ends| Border { line: self.draft.line(ends, LineKind::Edge, 1.0), edge: None };
        lines.borders.extend(self.long(&creases, points).into_iter().map(border));
        if turned.is_empty() {
            return;
        }
        // The colours change where turned-over elements begin.
        let state = |at: usize| turned.get(at).filter(|_| is_whole(at));
        let differ = |beside: [usize; 2]| {
            let states = beside.map(state);
            states[0] != states[1] && states.contains(&Some(&Turned::Yes)) && !states.contains(&Some(&Turned::Partly))
        };
        let new = |at: u32| points.len() as u32 + at;
        let cut = rim.lines.iter().filter(|(at, _)| is_whole(*at)).map(|(_, ends)| ends.map(new));
        let rims: Vec<_> = edges_where(&differ).into_iter().chain(cut).collect();
        let place = |corner: u32| points[fine.points[corner as usize] as usize];
        let more = (0..rim.corners.len() as u32).map(|at| rim.place(at, place));
        let points: Vec<_> = points.iter().copied().chain(more).collect();
        for ends in self.long(&rims, &points) {
            lines.borders.push(border(ends));
            lines.drawn.push(self.draft.line(ends, LineKind::AlarmContour, 1.0));
        }
    }

    /// Adds triangles of a carried surface that turned-over elements move. Their corners are in the mesh of sound elements, from a place
    /// on.
    fn add_turned_over(
        &self,
        fine: &Fine,
        triangles: impl Iterator<Item = [u32; 3]>,
        rim: &Rim,
        sound: &Mesh,
        turned_over: &mut Mesh,
        base: usize,
    ) {
        let period = self.hatches[fine.body].period;
        let mut places = vec![NONE; fine.points.len() + rim.corners.len()];
        let rest = |corner: u32| fine.surface.rest[fine.points[corner as usize] as usize];
        for triangle in triangles {
            let corner = |corner: u32| {
                let place = &mut places[corner as usize];
                if *place == NONE {
                    *place = turned_over.vertices.len() as u32;
                    let at = base + corner as usize;
                    let new = corner.checked_sub(fine.points.len() as u32);
                    let rest = new.map_or_else(|| rest(corner), |new| rim.place(new, rest));
                    let hatch = narrow(rest.dot(DVec3::ONE) / period);
                    turned_over.vertices.push(Vertex { hatch, ..sound.vertices[at] });
                    turned_over.shades.extend(sound.shades.get(at));
                }
                *place
            };
            let triangle = triangle.map(corner);
            turned_over.triangles.push(triangle);
        }
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
        lines.drawn.extend(edges.into_iter().map(|ends| self.draft.line(ends.map(|node| self.at(node)), kind, 0.0)));
    }

    /// The ends (m) of lines between pairs of points, joined, and without points that could not be told from straight lines.
    fn long(&self, pairs: &[[u32; 2]], points: &[DVec3]) -> Vec<[DVec3; 2]> {
        let place = |point: u32| points[point as usize];
        let pixel = |point: u32| self.draft.lens.project(place(point)).map_or([f64::NAN; 2], |(pixel, _)| pixel);
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
