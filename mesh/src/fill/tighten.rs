//! Tetrahedra where the body is thinner than they are: drawn to the surface, and none beside it.

use super::cuts::Lattice;
use super::draft::Draft;
use super::embed::weights;
use super::polyhedra::directions;
use crate::Surface;
use crate::boxes::{Boxes, nearest_of};
use glam::DVec3;
use localshape_sim::IndexLists;
use localshape_sim::geometry::bounds;
use rayon::prelude::*;

/// Nodes farther outside than this are drawn to the surface, in sides, up to this distance.
const NEAR: f64 = 0.12;

/// How often all nodes are drawn, and which parts of the way are tried each time.
const SWEEPS: usize = 6;
const PARTS: [f64; 3] = [0.7, 0.4, 0.15];

/// How far beside its place near to the surface a node is tried that finds no room there, in sides.
const BESIDE: [f64; 3] = [0.15, 0.3, 0.45];

/// The cosines of the greatest and the least dihedral angle that drawn nodes may leave: 164.5° and 11°.
const COSINES: [f64; 2] = [-0.9636, 0.9816];

/// The least mean of the squares of the distances of four nodes from their mean, in sides, that drawn nodes may leave: an eighth
/// of that of tetrahedra of the lattice, and a little more.
const SMALL: f64 = 0.04;

/// What reaches into a tetrahedron by less than this part of its heights does not count.
const SLIGHT: f64 = 1e-3;

/// Triangles of a surface by their place.
pub(super) struct Near<'s> {
    surface: &'s Surface,
    lattice: &'s Lattice,
    boxes: Boxes,
}

impl<'s> Near<'s> {
    pub(super) fn new(surface: &'s Surface, lattice: &'s Lattice) -> Self {
        let boxes = surface.triangles.iter().map(|&of| bounds(&surface.corners(of))).collect();
        Self { surface, lattice, boxes: Boxes::new(boxes, bounds(&surface.points), lattice.side) }
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.surface.corners(self.surface.triangles[triangle as usize])
    }

    /// The nearest point of the surface within a distance.
    fn nearest(&self, point: DVec3, most: f64) -> Option<DVec3> {
        let (triangle, _) = self.boxes.nearest(|triangle| self.corners(triangle), point, most)?;
        Some(nearest_of(self.corners(triangle), point))
    }

    /// Whether the surface passes a tetrahedron.
    fn passes(&self, corners: [DVec3; 4]) -> bool {
        let (low, high) = bounds(&corners);
        let reaches_in = |triangle: u32| {
            let all = self.corners(triangle).map(|corner| weights(corners, corner));
            if (0..4).any(|side| all.iter().all(|at| at[side] < 0.5 * SLIGHT)) {
                return false;
            }
            let mut polygon = all.to_vec();
            for side in 0..4 {
                let above = |at: &[f64; 4]| at[side] - SLIGHT;
                let mut kept = Vec::with_capacity(polygon.len() + 1);
                for (at, from) in polygon.iter().enumerate() {
                    let to = &polygon[(at + 1) % polygon.len()];
                    let (here, there) = (above(from), above(to));
                    if here > 0.0 {
                        kept.push(*from);
                    }
                    if (here > 0.0) != (there > 0.0) {
                        let part = here / (here - there);
                        kept.push([0, 1, 2, 3].map(|of| from[of] + part * (to[of] - from[of])));
                    }
                }
                polygon = kept;
            }
            !polygon.is_empty()
        };
        self.boxes.within(low, high).any(reaches_in)
    }
}

impl Near<'_> {
    /// Draws the nodes of wide tetrahedra to the surface as far as angles allow, and leaves out those that are beside it. If `is_bold`,
    /// those whose nodes stay far from it are left out, too. Returns whether some are left.
    pub(super) fn tighten(&self, draft: &mut Draft, is_bold: bool) -> bool {
        self.leave_out(draft, &[], &[]);
        let before = draft.cage.nodes.clone();
        let far = self.draw(draft);
        draft.is_bold = is_bold && !far.is_empty();
        self.leave_out(draft, if is_bold { &far } else { &[] }, &before);
        draft.cage.elements.indices().iter().any(|&node| far.binary_search(&(node as usize)).is_ok())
    }

    /// Leaves out wide elements without a part inside, and those with one of some nodes, in rising order. Those whose nodes are where
    /// they were `before` are known to have a part inside.
    fn leave_out(&self, draft: &mut Draft, nodes: &[usize], before: &[DVec3]) {
        let Draft { cage, is_wide, .. } = draft;
        let is_moved = |node: u32| before.get(node as usize) != Some(&cage.nodes[node as usize]);
        let is_kept = |element: usize| {
            let of: &[u32] = &cage.elements[element];
            let corners = [0, 1, 2, 3].map(|at| cage.nodes[of[at] as usize]);
            let is_known = || !of.iter().any(|&node| is_moved(node));
            let has_inside =
                || is_known() || self.passes(corners) || self.lattice.contains(0.25 * corners.iter().sum::<DVec3>());
            !is_wide[element] || of.iter().all(|&node| nodes.binary_search(&(node as usize)).is_err()) && has_inside()
        };
        let kept: Vec<bool> = (0..is_wide.len()).into_par_iter().map(is_kept).collect();
        let elements = cage.elements.iter().zip(&kept).filter(|(_, kept)| **kept);
        cage.elements = elements.map(|(element, _)| element).collect::<IndexLists>();
        let mut kept = kept.into_iter();
        is_wide.retain(|_| kept.next() == Some(true));
    }

    /// A place, if it is inside or near to the surface, or one that is on the way there; and whether it is another.
    fn goal(&self, at: DVec3) -> Option<(DVec3, bool)> {
        let nearest = |most: f64| self.nearest(at, most * self.lattice.side);
        // To look for the surface so near takes less time than to tell the side of an open one.
        if nearest(NEAR).is_some() || self.lattice.contains(at) {
            return Some((at, false));
        }
        let surface = nearest(4.0)?;
        let far = at.distance(surface) / self.lattice.side;
        Some((surface + (at - surface) * (NEAR / far), true))
    }

    /// Draws nodes to the surface, one after the other. Returns those that stay far from it.
    fn draw(&self, draft: &mut Draft) -> Vec<usize> {
        let Draft { cage, is_wide, .. } = draft;
        let nodes = &mut cage.nodes;
        let mut elements_of = vec![Vec::new(); nodes.len()];
        let mut may_move = vec![false; nodes.len()];
        for ((number, element), is_wide) in (0..).zip(cage.elements.iter()).zip(is_wide) {
            for &node in element {
                elements_of[node as usize].push(number);
                may_move[node as usize] |= *is_wide;
            }
        }
        let goal = |node: usize| Some((node, self.goal(nodes[node]).filter(|goal| goal.1)?.0));
        let may_move = (0..nodes.len()).into_par_iter().filter(|&node| may_move[node]);
        let mut goals: Vec<_> = may_move.filter_map(goal).collect();
        let side = self.lattice.side;
        let mut moves = |node: usize, to: &dyn Fn(DVec3) -> DVec3| {
            let from = nodes[node];
            nodes[node] = to(from);
            let is_sound = elements_of[node].iter().all(|&element| {
                let element: &[u32] = &cage.elements[element];
                is_sound([0, 1, 2, 3].map(|at| nodes[element[at] as usize]), side)
            });
            if !is_sound {
                nodes[node] = from;
            }
            is_sound
        };
        for sweep in 0..SWEEPS {
            goals.retain(|&(node, goal)| {
                let beside =
                    BESIDE.into_iter().flat_map(|far| directions(None).map(move |way| goal + far * side * way));
                // Beside the goal there may be more room.
                let is_there = moves(node, &|_| goal)
                    || sweep == SWEEPS - 2
                        && beside.filter_map(|at| self.goal(at)).any(|(near, _)| moves(node, &|_| near));
                if !is_there {
                    PARTS.into_iter().any(|part| moves(node, &|from| from.lerp(goal, part)));
                }
                !is_there
            });
        }
        goals.into_iter().map(|(node, _)| node).collect()
    }
}

/// Whether a tetrahedron has the right side out, and neither small angles nor a small size.
fn is_sound(corners: [DVec3; 4], side: f64) -> bool {
    let [a, b, c, d] = corners;
    let mean = 0.25 * (a + b + c + d);
    let spread = 0.25 * corners.iter().map(|corner| corner.distance_squared(mean)).sum::<f64>();
    let cosines = cosines(corners);
    (b - a).cross(c - a).dot(d - a) > 0.0
        && spread > SMALL * side * side
        && cosines.iter().all(|cosine| (COSINES[0]..COSINES[1]).contains(cosine))
}

/// The cosines of the dihedral angles of a tetrahedron.
pub(super) fn cosines([a, b, c, d]: [DVec3; 4]) -> [f64; 6] {
    // All look in, or all out.
    let normals = [(c - b).cross(d - b), (d - a).cross(c - a), (b - a).cross(d - a), (c - a).cross(b - a)];
    let normals = normals.map(DVec3::normalize);
    let pairs = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    pairs.map(|[one, other]| -normals[one].dot(normals[other]))
}
