//! Cubes of a lattice, cut at the surface into convex polyhedra.
//!
//! An element is the convex hull of the corners of a cube that are inside and of the cuts of its edges. Nodes never leave the edges of
//! cubes: the hull meets each face of the cube in the polygon of the nodes there, which is the same for the cube on its other side.
//!
//! Elements would be small around corners that are hardly inside, and need short steps. Cuts near to such a corner are moved: to
//! the corner, which is then on the surface, or to a quarter of the side away from it. So nodes are within an eighth of the side from
//! the surface along their edges, and mostly on it.

use super::cuts::{AXES, Cuts, EDGES, Lattice};
use super::draft::{Draft, Drafting};
use super::lattice::too_many;
use super::{FillError, Filled, embed};
use crate::{Flaws, Surface};
use glam::IVec3;

/// The least distance of a cut from a corner inside, in sides.
const LEAST: f64 = 0.25;

/// A cut nearer than this to a corner outside is moved to it, in sides: faces with shorter sides would be lost in round-off.
const CLOSE: f64 = 1.0 / 32.0;

/// Fills a surface with cubes of this side that are cut at the surface.
pub(super) fn fill(mut surface: Surface, flaws: Flaws, side: f64, most: usize) -> Result<Filled, FillError> {
    let lattice = Lattice::around(&mut surface, side, false, most)?;
    let truly_inside = lattice.inside();
    let (cage, weights) = embed::carry(&surface, &flaws, &lattice, |wide| {
        let is_inside: Vec<bool> = truly_inside.iter().zip(wide).map(|(inside, wide)| inside | wide).collect();
        let mut cuts = lattice.cuts(&is_inside, wide);
        let places = places(&lattice, &is_inside, &mut cuts);
        draft(&lattice, &places, &cuts, wide, most)
            .map_err(|needed| too_many(&surface.measures(), side, needed as f64, most, ""))
    })?;
    Ok(Filled { cage, surface, weights, flaws })
}

/// On which side of the surface a corner lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Where {
    Inside,
    On,
    Outside,
}

/// Where each corner lies, after cuts have been moved.
fn places(lattice: &Lattice, is_inside: &[bool], cuts: &mut Cuts) -> Vec<Where> {
    let side = |&inside: &bool| if inside { Where::Inside } else { Where::Outside };
    let mut places: Vec<Where> = is_inside.iter().map(side).collect();
    for cut in 0..cuts.parts.len() {
        let (from, edge) = cuts.edge(cut);
        let to = lattice.index(lattice.point(from) + EDGES[edge]);
        let part = cuts.parts[cut];
        let (inside, outside, depth) = if is_inside[from] { (from, to, part) } else { (to, from, 1.0 - part) };
        if depth < 0.5 * LEAST {
            places[inside] = Where::On;
        } else if depth < LEAST {
            cuts.parts[cut] = if is_inside[from] { LEAST } else { 1.0 - LEAST };
        } else if depth > 1.0 - CLOSE {
            places[outside] = Where::On;
        }
    }
    // Corners on an edge of the surface, whose neighbours may all be outside.
    for &corner in &cuts.on {
        if places[corner] == Where::Outside {
            places[corner] = Where::On;
        }
    }
    places
}

/// All cubes with a corner inside, or their number if there are more than `most`.
fn draft(lattice: &Lattice, places: &[Where], cuts: &Cuts, wide: &[bool], most: usize) -> Result<Draft, usize> {
    let mut drafting = Drafting::new(lattice, cuts, wide, true, most);
    let cubes = lattice.cubes;
    let mut nodes = Vec::new();
    for cube in 0..cubes.element_product() {
        let low = 2 * IVec3::new(cube % cubes.x, cube / cubes.x % cubes.y, cube / cubes.x / cubes.y);
        let corner = |bit: i32| low + 2 * IVec3::new(bit & 1, bit >> 1 & 1, bit >> 2);
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|bit| lattice.index(corner(bit)));
        if !corners.iter().any(|&corner| places[corner] == Where::Inside) {
            continue;
        }
        nodes.clear();
        nodes.extend(corners.into_iter().filter(|&corner| places[corner] != Where::Outside));
        for (edge, from) in (0..AXES).flat_map(|edge| (0..8).map(move |from| (edge, from))) {
            if from >> edge & 1 == 0 {
                let ends = [corners[from], corners[from | 1 << edge]].map(|end| places[end]);
                if matches!(ends, [Where::Inside, Where::Outside] | [Where::Outside, Where::Inside]) {
                    nodes.extend(cuts.find(corners[from], edge).map(|cut| lattice.len() + cut));
                }
            }
        }
        drafting.push(&nodes);
    }
    drafting.finished()
}
