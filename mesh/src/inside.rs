//! Whether points are inside a surface.
//!
//! The winding number of a point counts how often the surface goes around it; inside it is above ½. For a surface whose edges
//! are passed as often in one direction as in the other it is a whole number: the sum of signs of the triangles that a ray
//! crosses. Exact predicates (J. Shewchuk, 1997) decide what is crossed; a point on a line or in a plane of the surface counts as
//! moved by infinitely little, and by least along x (H. Edelsbrunner and E. Mücke, 1990).
//!
//! Other surfaces have a fractional winding number (A. Jacobson et al., 2013). They are closed by triangles between their open
//! edges, and the parts of the sphere that these hide from the point are taken off again: cheap, for most surfaces have few open
//! edges. Triangles far away are lumped together (G. Barill et al., 2018).

mod closing;
mod columns;
#[cfg(test)]
mod tests;
mod winding;

use super::Surface;
use closing::{caps, without_sheets};
pub(crate) use columns::Columns;
use glam::DVec3;
use rayon::prelude::*;
use winding::Caps;

/// A surface that is asked for its inside.
pub(crate) struct Inside {
    pub(crate) columns: Columns,
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
        let [mut hiding, straight] = caps(surface);
        let mut all = surface.triangles.clone();
        let mut caps = [&hiding[..], &straight].concat();
        if caps.len() > all.len() {
            // Triangles that hang together at corners alone are closed with less by each other's backs, which leaves nothing to cross.
            caps = all.iter().map(|&[a, b, c]| [a, c, b]).collect();
            hiding.clone_from(&caps);
            all.clear();
        } else if !caps.is_empty() {
            all.extend(&caps);
            all = without_sheets(&surface.points, &all);
        }
        let corners = |caps: &[[u32; 3]]| caps.iter().map(|&cap| surface.corners(cap)).collect();
        let columns = Columns::new(&surface.points, &all);
        Self { columns, caps: corners(&caps), hiding: Caps::new(corners(&hiding)) }
    }

    /// About how many triangles are looked at to tell whether a point is inside, beside those that a line crosses.
    pub(crate) fn effort(&self) -> f64 {
        let all = self.hiding.triangles.len() as f64;
        all.min(64.0 * libm::log2(all.max(1.0)))
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
        rows.flat_map_iter(|row| self.row(grid, row).into_iter().map(|(_, inside)| inside)).collect()
    }

    /// The points of a row that are inside: for each point its winding number about the surface with its caps, and
    /// whether it is inside the surface.
    pub(crate) fn row(&self, grid: &Grid, row: usize) -> Vec<(i32, bool)> {
        let [along, wide, _] = grid.counts;
        let mut out = vec![(0, false); along];
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
        out
    }
}
