//! How the points of a surface follow the nodes of elements.
//!
//! Tetrahedra carry points by barycentric coordinates. Other elements are divided into tetrahedra between the mean of their nodes, the
//! mean of the nodes of a face, and a side of the face; the weights of means are spread over their nodes. Weights are linear in
//! each tetrahedron, equal on both sides of a shared face, and reproduce affine maps. Elements have to be seen whole from the mean
//! of their nodes, as convex ones are.

mod fan;
mod hung;
mod share;
mod spread;
#[cfg(test)]
mod tests;

use super::cuts::{FAR, Lattice, Within};
use super::draft::Draft;
use crate::edges::pieces;
use crate::{Cage, FillError, Flaws, Surface};
pub(super) use fan::weights;
use fan::{Fan, Place};
use glam::DVec3;
use hung::Hung;
use localshape_sim::{Body, Solids, Weights};

/// Elements farther away than so many sides have nothing to do with a point.
const VERY_FAR: f64 = 2.0;

/// The most times elements are made again with more of the lattice. Scans need two or three, and steps grow from one to the next.
const ROUNDS: u32 = 16;

/// An element is filled at least by this part.
pub(super) const LEAST: f64 = 1e-3;

/// A point outside of all elements whose weights in a tetrahedron were larger than this follows the whole element.
const GENTLE: f64 = 3.0;

/// A weight that is negative by less than this is round-off.
const CLOSE: f64 = 1e-10;

/// Elements that carry a surface, and its weights.
///
/// `build` makes the elements. It is given how often each place of the lattice was marked, at first never, whether it may leave out
/// elements on trial, and the part of each cube that is inside. While points of the surface are far from all
/// elements, or follow elements that do not hang together by faces with those of the rest of their piece of the surface, the lattice
/// is marked there, and has elements that may be filled in part. Where that is not enough marks go on along the surface, twice as
/// far each time. What is lost where the lattice is marked already, and after marks have gone on, stays lost.
///
/// # Errors
/// If nothing is inside, or as `build` says.
pub(super) fn carry(
    surface: &Surface,
    flaws: &Flaws,
    lattice: &Lattice,
    build: impl Fn(&[u8], bool, &[f64]) -> Result<Draft, FillError>,
) -> Result<(Cage, Weights), FillError> {
    let (pieces, _) = pieces(surface.points.len(), &surface.triangles);
    let mut wide = vec![0u8; lattice.len()];
    let Within { cubes: inside, overlap, thin } = lattice.filled(flaws)?;
    let mut touched = Vec::new();
    let (mut round, mut is_bold) = (0, true);
    while round < ROUNDS {
        let draft = build(&wide, is_bold, &inside)?;
        let body = body(&draft.cage);
        let fan = Fan::new(&body);
        let found = fan.locate(&surface.points, lattice.side, VERY_FAR);
        let hung = Hung::new(&body, &pieces, &found);
        let far = if round == 0 { lattice.far() } else { FAR };
        let is_lost = |place: &Option<Place>, piece: u32| {
            place.is_none_or(|place| place.distance > far || !hung.carries(&place, piece))
        };
        let has_lost = |of: &&[u32; 3]| of.iter().any(|&point| is_lost(&found[point as usize], pieces[point as usize]));
        let samples = |of: &[u32; 3]| {
            let piece = pieces[of[0] as usize];
            lattice.samples(*of).map(move |at| (at, piece))
        };
        let (places, of_places): (Vec<DVec3>, Vec<u32>) =
            surface.triangles.iter().filter(has_lost).flat_map(samples).unzip();
        if places.is_empty() {
            let filled = fan.filled(&draft.is_wide, lattice, &inside);
            let (cage, weights) = hung.finished(draft.cage, filled, &fan, &found);
            return Ok((Cage { overlap, thin, ..cage }, weights));
        }
        // What was left out may be missing.
        is_bold = !(draft.is_bold && round > 1);
        if !is_bold {
            continue;
        }
        let before = wide.clone();
        let mut mark = |point: usize| wide[point] = (before[point] + 1).min(lattice.marks());
        let found = fan.locate(&places, lattice.side, far);
        for ((&at, &piece), place) in places.iter().zip(&of_places).zip(&found) {
            if is_lost(place, piece) {
                lattice.touch(at, &mut mark);
            }
        }
        if round > 1 && wide == before {
            break;
        }
        if round > 0 {
            if touched.is_empty() {
                touched = lattice.touched(surface, &inside);
            }
            let most = lattice.marks();
            let mut front: Vec<_> = (0..before.len()).filter(|&point| before[point] == most).collect();
            for _ in 0..1 << (round - 1) {
                let beside = front.iter().flat_map(|&point| lattice.neighbours(point));
                let is_new = |beside: &usize| touched[*beside] && std::mem::replace(&mut wide[*beside], most) < most;
                front = beside.filter(is_new).collect();
            }
        }
        round += 1;
    }
    let message = format!("falls into pieces if it is filled with elements of side {}", lattice.side);
    Err(FillError::new(message, "use a smaller side, or fill it with cubes"))
}

/// The elements of a cage with their faces. Where the first try has found none, it is one node.
pub(super) fn body(cage: &Cage) -> Body {
    let solids = if cage.convex { Solids::Convex } else { Solids::Ordered };
    let nodes = if cage.nodes.is_empty() { vec![DVec3::ZERO] } else { cage.nodes.clone() };
    let body = Body::builder(nodes).elements(cage.elements.clone()).solids(solids).fill(cage.filled.clone()).build();
    body.expect("a cage has sound elements")
}
