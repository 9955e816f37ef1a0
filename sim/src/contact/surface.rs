//! The surface with which a body or an obstacle meets others: points, facets and edges.
//!
//! Points are nodes, middles of faces with more than three corners, or points of a carried surface. Facets are triangles in space, the
//! ends of bars, and sides in the plane. A face of more corners is a fan of triangles around its middle.

use super::spread::Spread;
use crate::body::Body;
use crate::carried::{Carried, Weights};
use crate::element::{Dimension, ElementKind, around, ordered};
use crate::lists::IndexLists;
use glam::DVec3;
use std::collections::HashMap;
use std::ops::Range;

/// The features of a surface. Edges are those along which faces meet, without bars in the plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// The nodes of each point, of all bodies in the world, and their weights.
    pub(super) points: Weights,
    /// The corners of facets: points.
    pub(super) facets: Vec<Facet>,
    /// The ends of edges: points.
    pub(super) edges: Vec<[u32; 2]>,
    /// The corners that face each edge: one of each triangle with it.
    pub(super) wings: IndexLists,
    /// The points to which edges lead from each point, also within faces.
    pub(super) rings: IndexLists,
    /// The nodes, each once.
    pub(super) nodes: Vec<u32>,
    /// The greatest sum of magnitudes of the weights of a point. Above 1, points may stand outside of all nodes, and move so many times as far as these.
    pub(super) lever: f64,
    /// How facets and edges follow the nodes, in surfaces that are [ready](Self::ready).
    pub(super) of_facets: Spread,
    pub(super) of_edges: Spread,
    /// The facets that bound an inside, with their normals out of it: not those of cloths and bars.
    pub(super) bounding: Vec<u32>,
    /// Half of the distance (m) that is kept from a surface of the same thickness.
    pub(super) thickness: f64,
    /// Whether the thickness is the radius of an obstacle.
    pub(super) is_round: bool,
}

/// A surface with the places of its points (m).
#[derive(Clone, Copy)]
pub(super) struct Placed<'a> {
    pub(super) surface: &'a Surface,
    pub(super) at: &'a [DVec3],
}

impl Placed<'_> {
    /// The corners of a facet that count.
    pub(super) fn used(&self, facet: u32) -> &[u32] {
        self.surface.facets[facet as usize].used()
    }

    pub(super) fn point(&self, point: u32) -> DVec3 {
        self.at[point as usize]
    }
}

/// A point, segment or triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Its corners; the first `count` count.
    pub(super) corners: [u32; 3],
    pub(super) count: u32,
    /// Of a triangle, the edge from each corner to the next.
    pub(super) sides: [u32; 3],
    /// Whether contact on a side is counted by this facet, the first one with it; then the same of corners.
    pub(super) owns_sides: [bool; 3],
    pub(super) owns_corners: [bool; 3],
}

impl Facet {
    /// The corners that count.
    pub(super) fn used(&self) -> &[u32] {
        &self.corners[..self.count as usize]
    }
}

impl Surface {
    /// The surface of a body, with the usual thickness.
    pub(crate) fn of(body: &Body) -> Self {
        /// The distance that two bodies of equal cells keep, as a share of a cell.
        const GAP: f64 = 0.05;
        let made = match (&body.carried, body.dimension) {
            (Some(carried), Dimension::Space) => Self::carried(carried),
            (_, Dimension::Space) => Self::in_space(body),
            (_, Dimension::Plane) => Self::in_plane(body),
        };
        let place = |point: u32| match made.points.of(point as usize) {
            (&[node], _) => body.rest[node as usize],
            _ => made.points.place(point as usize, &body.rest),
        };
        Self { thickness: 0.5 * GAP * made.cell(place), ..made }
    }

    fn carried(carried: &Carried) -> Self {
        let facets = carried.triangles.iter().map(|&corners| (corners, 3)).collect();
        let made = Self::new(carried.weights.clone(), facets, &[]);
        let is_closed = made.wings.iter().all(|wings| wings.len() % 2 == 0);
        let bounding = if is_closed { (0..made.facets.len() as u32).collect() } else { Vec::new() };
        Self { bounding, ..made }
    }

    /// The outer faces of elements, triangles and bars.
    fn in_space(body: &Body) -> Self {
        let mut made = Making::default();
        let faces = body.topology().shared_faces();
        for (face, nodes) in faces.nodes.iter().enumerate() {
            if faces.outer[face].is_none() {
                let before = made.facets.len() as u32;
                made.face(nodes);
                if faces.inner[face].is_some_and(|element| !body.topology().is_flat(element as usize)) {
                    made.bounding.extend(before..made.facets.len() as u32);
                }
            }
        }
        made.bars(body);
        Self { bounding: made.bounding, ..Self::new(made.points, made.facets, &made.bars) }
    }

    /// The sides of polygons that belong to one polygon only, and bars.
    fn in_plane(body: &Body) -> Self {
        let mut made = Making::default();
        let polygons = || body.elements.iter().zip(&body.kinds).filter(|(_, kind)| **kind == ElementKind::Polygon);
        let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
        for side in polygons().flat_map(|(nodes, _)| around(nodes)) {
            *uses.entry(ordered(side)).or_default() += 1;
        }
        for side in polygons().flat_map(|(nodes, _)| around(nodes)).filter(|&side| uses[&ordered(side)] == 1) {
            let [a, b] = side.map(|node| made.node(node));
            made.facets.push(([a, b, b], 2));
        }
        let bounding = (0..made.facets.len() as u32).collect();
        made.bars(body);
        let all = Self::new(made.points, made.facets, &[]);
        Self { edges: Vec::new(), wings: IndexLists::default(), bounding, ..all }
    }

    /// A surface of points and facets with so many corners; `bars` are edges without a triangle.
    pub(super) fn new(points: Weights, corners: Vec<([u32; 3], u32)>, bars: &[[u32; 2]]) -> Self {
        /// Round-off of sums of weights.
        const ROUND: f64 = 1e-9;
        let mut found: HashMap<[u32; 2], usize> = HashMap::new();
        let (mut edges, mut wings): (Vec<[u32; 2]>, Vec<Vec<u32>>) = Default::default();
        let mut rings = vec![Vec::new(); points.len()];
        let mut owned = vec![false; points.len()];
        let mut facets = Vec::with_capacity(corners.len());
        for (corners, count) in corners {
            let mut facet = Facet { corners, count, sides: [0; 3], owns_sides: [false; 3], owns_corners: [false; 3] };
            for at in 0..count as usize {
                let corner = corners[at] as usize;
                facet.owns_corners[at] = !std::mem::replace(&mut owned[corner], true);
                let others = (0..count as usize).filter(|&other| other != at);
                rings[corner].extend(others.map(|other| corners[other]));
                if count == 3 {
                    let ends = ordered([corners[at], corners[(at + 1) % 3]]);
                    let edge = *found.entry(ends).or_insert_with(|| {
                        facet.owns_sides[at] = true;
                        edges.push(ends);
                        wings.push(Vec::new());
                        edges.len() - 1
                    });
                    wings[edge].push(corners[(at + 2) % 3]);
                    facet.sides[at] = edge as u32;
                }
            }
            facets.push(facet);
        }
        for &bar in bars {
            found.entry(ordered(bar)).or_insert_with(|| {
                edges.push(ordered(bar));
                wings.push(Vec::new());
                edges.len() - 1
            });
        }
        for ring in &mut rings {
            ring.sort_unstable();
            ring.dedup();
        }
        let mut nodes: Vec<u32> = (0..points.len()).flat_map(|point| points.of(point).0.iter().copied()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let sums = (0..points.len()).map(|point| points.of(point).1.iter().map(|weight| weight.abs()).sum::<f64>());
        let lever = sums.filter(|&sum| sum > 1.0 + ROUND).fold(1.0, f64::max);
        let lists = |lists: &[Vec<u32>]| lists.iter().map(Vec::as_slice).collect();
        Self {
            points,
            facets,
            edges,
            wings: lists(&wings),
            rings: lists(&rings),
            nodes,
            lever,
            of_facets: Spread::default(),
            of_edges: Spread::default(),
            bounding: Vec::new(),
            thickness: 0.0,
            is_round: false,
        }
    }

    /// The radius of a round obstacle (m); zero of other surfaces.
    pub(super) fn radius(&self) -> f64 {
        if self.is_round { self.thickness } else { 0.0 }
    }

    /// The places of its points (m), from those of nodes.
    pub(super) fn places(&self, nodes: &[DVec3]) -> impl Iterator<Item = DVec3> {
        (0..self.points.len()).map(|point| self.points.place(point, nodes))
    }

    /// The same surface with its nodes numbered from `first` on, without gaps.
    pub(super) fn numbered(self, first: u32) -> Self {
        let number = |node: &u32| first + self.nodes.partition_point(|other| other < node) as u32;
        let mut points = Weights::default();
        for point in 0..self.points.len() {
            let (nodes, weights) = self.points.of(point);
            points.push(&nodes.iter().map(number).collect::<Vec<_>>(), weights);
        }
        let nodes = (first..).take(self.nodes.len()).collect();
        Self { points, nodes, ..self }
    }

    /// The same surface with all that steps of contact need.
    pub(super) fn ready(self) -> Self {
        let of_facets = Spread::new(&self.points, self.facets.iter().map(Facet::used));
        let of_edges = Spread::new(&self.points, self.edges.iter().map(<[u32; 2]>::as_slice));
        Self { of_facets, of_edges, ..self }
    }

    /// Its nodes among those that are numbered without gaps.
    pub(super) fn range(&self) -> Range<usize> {
        let first = self.nodes.first().map_or(0, |&node| node as usize);
        first..first + self.nodes.len()
    }

    /// The mean length of its edges, or of its facets where it has none (m), with points at the given places.
    pub(crate) fn cell(&self, place: impl Fn(u32) -> DVec3) -> f64 {
        let of_segments =
            || self.facets.iter().filter(|facet| facet.count == 2).map(|facet| [0, 1].map(|at| facet.corners[at]));
        let ends: Vec<[u32; 2]> = if self.edges.is_empty() { of_segments().collect() } else { self.edges.clone() };
        let sum: f64 = ends.iter().map(|&[a, b]| place(a).distance(place(b))).sum();
        sum / ends.len().max(1) as f64
    }
}

/// A surface in the making.
#[derive(Default)]
struct Making {
    points: Weights,
    /// The point of each node.
    known: HashMap<u32, u32>,
    facets: Vec<([u32; 3], u32)>,
    bounding: Vec<u32>,
    bars: Vec<[u32; 2]>,
}

impl Making {
    /// The point of a node of the body.
    fn node(&mut self, node: u32) -> u32 {
        let Self { points, known, .. } = self;
        *known.entry(node).or_insert_with(|| {
            points.push(&[node], &[1.0]);
            points.len() as u32 - 1
        })
    }

    /// A face as triangles: itself, or a fan around its middle.
    fn face(&mut self, nodes: &[u32]) {
        let corners: Vec<u32> = nodes.iter().map(|&node| self.node(node)).collect();
        if let &[a, b, c] = &corners[..] {
            self.facets.push(([a, b, c], 3));
            return;
        }
        self.points.push(nodes, &vec![1.0 / nodes.len() as f64; nodes.len()]);
        let middle = self.points.len() as u32 - 1;
        self.facets.extend(around(&corners).map(|[a, b]| ([a, b, middle], 3)));
    }

    /// Elements of two nodes, as facets and as edges.
    fn bars(&mut self, body: &Body) {
        let bars = body.elements.iter().zip(&body.kinds).filter(|(_, kind)| **kind == ElementKind::Segment);
        for (nodes, _) in bars {
            let [a, b] = [nodes[0], nodes[1]].map(|node| self.node(node));
            self.facets.push(([a, b, b], 2));
            self.bars.push([a, b]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Body {
        let corner = |at: u32| DVec3::from_array([0, 1, 2].map(|axis| f64::from(at >> axis & 1)));
        let nodes: Vec<u32> = (0..8).collect();
        Body::builder((0..8).map(corner).collect())
            .elements([&nodes[..]].into_iter().collect())
            .build()
            .expect("a cube")
    }

    #[test]
    fn a_cube_has_middles_and_diagonals() {
        let surface = Surface::of(&cube()).numbered(5);
        assert_eq!((surface.points.len(), surface.facets.len(), surface.edges.len()), (14, 24, 12 + 24));
        assert!(surface.wings.iter().all(|wings| wings.len() == 2));
        assert_eq!(surface.nodes, (5..13).collect::<Vec<_>>());
        // Each corner belongs to three faces with two triangles each: three edges and three diagonals.
        let rings = surface.rings.iter().map(<[u32]>::len);
        assert_eq!(rings.filter(|&len| len == 6).count(), 8);
        let owned = |of: fn(&Facet) -> [bool; 3]| surface.facets.iter().flat_map(of).filter(|&owns| owns).count();
        assert_eq!((owned(|facet| facet.owns_sides), owned(|facet| facet.owns_corners)), (36, 14));
    }

    #[test]
    fn squares_in_the_plane_have_their_outer_sides() {
        let rest = (0..6).map(|at| DVec3::new(f64::from(at % 3), f64::from(at / 3), 0.0)).collect();
        let elements = [&[0, 1, 4, 3][..], &[1, 2, 5, 4]].into_iter().collect();
        let body = Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("two squares");
        let surface = Surface::of(&body);
        assert_eq!((surface.points.len(), surface.facets.len(), surface.edges.len()), (6, 6, 0));
        let place = |point: u32| body.rest[surface.points.of(point as usize).0[0] as usize];
        assert_eq!(surface.cell(place), 1.0);
    }

    #[test]
    fn bars_and_triangles_in_space() {
        let rest = (0..5).map(|at| DVec3::new(f64::from(at), f64::from(at * at), 0.0)).collect();
        let elements = [&[0, 1, 2][..], &[1, 2, 3], &[3, 4]].into_iter().collect();
        let body = Body::builder(rest).elements(elements).build().expect("a mixed body");
        let surface = Surface::of(&body);
        assert_eq!((surface.facets.len(), surface.edges.len()), (3, 6));
        assert_eq!(surface.wings.iter().map(<[u32]>::len).collect::<Vec<_>>(), [1, 2, 1, 1, 1, 0]);
    }
}
