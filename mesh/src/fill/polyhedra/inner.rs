//! Nodes in faces and in cubes, where the surface is far beyond the others.

use super::super::cuts::{AXES, EDGES};
use super::super::{clip, range};
use super::{BEYOND, CLOSE, Cutting, LEAST, directions};
use glam::{DVec3, IVec3};
use rayon::prelude::*;

/// A node in a face or in a cube, or a place for one.
pub(super) struct Inner {
    /// The place of the lowest corner of the face or cube times 4, and the axis across the face, or 3.
    pub(super) key: usize,
    /// Where the node is, in halves of the side from the origin.
    pub(super) at: DVec3,
}

impl Cutting<'_> {
    /// The places in lists of the nodes of a face or a cube.
    pub(super) fn inner_of(&self, low: usize, which: usize) -> std::ops::Range<usize> {
        let key = 4 * low + which;
        self.inner.partition_point(|other| other.key < key)..self.inner.partition_point(|other| other.key <= key)
    }

    /// Where the surface is cut by the faces of thin cubes, and the corners of its parts in them, with their faces and cubes.
    pub(super) fn candidates(&self) -> Vec<Inner> {
        let (lattice, surface) = self.lattice.in_cubes();
        let of_triangle = |&of: &[u32; 3]| {
            let mut found = Vec::new();
            clip::cut(surface.corners(of), &lattice, |cell, polygon| {
                let low = 2 * (IVec3::from_array(cell.map(|at| at as i32)) + 1);
                let index = self.lattice.index(low);
                if self.thin[index] == 0 {
                    return;
                }
                for &place in polygon.corners() {
                    let at = 2.0 * (place + 1.0);
                    found.push(Inner { key: 4 * index + 3, at });
                    for axis in 0..AXES {
                        if at[axis] == f64::from(low[axis]) {
                            found.push(Inner { key: 4 * index + axis, at });
                        } else if at[axis] == f64::from(low[axis] + 2) {
                            found.push(Inner { key: 4 * self.lattice.index(low + EDGES[axis]) + axis, at });
                        }
                    }
                }
            });
            found
        };
        let mut found: Vec<_> = surface.triangles.par_iter().flat_map_iter(of_triangle).collect();
        found.par_sort_by_key(|inner| inner.key);
        found
    }

    /// The nodes of a face or a cube in directions in which the surface there is far beyond the nodes known.
    pub(super) fn extremes(&self, candidates: &[Inner]) -> Vec<Inner> {
        let key = candidates[0].key;
        let across = Some(key % 4).filter(|&axis| axis < AXES);
        let low = self.lattice.point(key / 4);
        let mut known = Vec::new();
        self.nodes(low, across, &mut known);
        // Where nothing else is inside, elements hold all of the body, and are filled in part.
        let is_free = !known.iter().any(|&node| node < self.lattice.len());
        let least_thicker = if is_free { 2.0 * CLOSE } else { 0.0 };
        let mut known: Vec<DVec3> = known.into_iter().map(|node| self.position(node)).collect();
        let mut margin = DVec3::splat(2.0 * CLOSE);
        let mut size = DVec3::splat(2.0);
        if let Some(axis) = across {
            (margin[axis], size[axis]) = (0.0, 0.0);
        }
        let (least, greatest) = (low.as_dvec3() + margin, low.as_dvec3() + size - margin);
        let mut made = Vec::new();
        for direction in directions(across) {
            let along = |at: DVec3| at.dot(direction);
            let (mut back, reached) = range(known.iter().map(|&at| along(at)));
            let mut farthest = candidates[0].at;
            for &Inner { at, .. } in candidates {
                back = back.min(along(at));
                if along(at) > along(farthest) {
                    farthest = at;
                }
            }
            let thicker = (LEAST - 0.5 * (along(farthest) - back)).max(least_thicker);
            // Both ways together are at most an eighth of the side.
            let moved = farthest.distance_squared(farthest.clamp(least, greatest));
            let thicker = thicker.min(libm::sqrt(LEAST * LEAST - moved));
            let node = (farthest + thicker * direction).clamp(least, greatest);
            if along(node) - reached > 2.0 * BEYOND {
                known.push(node);
                made.push(Inner { key, at: node });
            }
        }
        made
    }
}
