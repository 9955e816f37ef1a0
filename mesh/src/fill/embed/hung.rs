//! How elements hang together.

use super::super::draft::Nodes;
use super::GENTLE;
use super::fan::{Fan, Place};
use crate::Cage;
use crate::edges::Sets;
use localshape_sim::{Body, IndexLists, Weights};
use rayon::prelude::*;

const NONE: u32 = u32::MAX;

/// How elements hang together.
pub(super) struct Hung {
    /// The part to which each element belongs. Its elements hang together by faces.
    parts: Vec<u32>,
    /// The part that carries most points of each piece of the surface, the first of several; [`NONE`] if there is none.
    carriers: Vec<u32>,
}

impl Hung {
    pub(super) fn new(body: &Body, pieces: &[u32], found: &[Option<Place>]) -> Self {
        let mut sets = Sets::new(body.elements().len());
        for sides in body.faces().inner.iter().zip(&body.faces().outer) {
            if let (Some(one), Some(other)) = sides {
                sets.join(*one, *other);
            }
        }
        let (parts, _) = sets.numbered();
        let part = |place: &Place| parts[place.simplex.element as usize];
        let mut all: Vec<[u32; 2]> =
            pieces.iter().zip(found).filter_map(|(&piece, place)| Some([piece, part(place.as_ref()?)])).collect();
        all.sort_unstable();
        let mut carriers = vec![NONE; pieces.len()];
        for of_piece in all.chunk_by(|one, other| one[0] == other[0]) {
            let of_parts = of_piece.chunk_by(|one, other| one == other);
            let most = of_parts.reduce(|best, other| if other.len() > best.len() { other } else { best });
            most.into_iter().for_each(|most| carriers[most[0][0] as usize] = most[0][1]);
        }
        Self { parts, carriers }
    }

    /// Whether a place belongs to the part that carries a piece of the surface.
    pub(super) fn carries(&self, place: &Place, piece: u32) -> bool {
        self.carriers[piece as usize] == self.parts[place.simplex.element as usize]
    }

    /// The elements of the parts that carry something, and the weights.
    pub(super) fn finished(
        &self,
        cage: Cage,
        filled: Option<Vec<f64>>,
        fan: &Fan,
        found: &[Option<Place>],
    ) -> (Cage, Weights) {
        let mut is_kept = vec![false; self.parts.len()];
        self.carriers.iter().filter(|&&part| part != NONE).for_each(|&part| is_kept[part as usize] = true);
        let kept: Vec<usize> = (0..self.parts.len()).filter(|&element| is_kept[self.parts[element] as usize]).collect();
        let mut nodes = Nodes::new(cage.nodes.len());
        let mut renamed = |all: &[u32]| -> Vec<u32> {
            all.iter().map(|&node| nodes.of(node as usize, || cage.nodes[node as usize])).collect()
        };
        let mut elements = IndexLists::default();
        kept.iter().for_each(|&element| elements.push(&renamed(&cage.elements[element])));
        let filled = filled.map(|filled| kept.iter().map(|&element| filled[element]).collect());
        let spread = |place: &Place| {
            let is_gentle = place.weights.iter().all(|weight| weight.abs() < GENTLE);
            let is_simple = fan.of(place.simplex.element as usize).len() == 1;
            if is_gentle || is_simple { fan.spread(place) } else { fan.affine(place) }
        };
        let mut weights = Weights::default();
        for (nodes, own) in found.par_iter().flatten().map(spread).collect::<Vec<_>>() {
            weights.push(&renamed(&nodes), &own);
        }
        (Cage { nodes: nodes.places, elements, filled, convex: cage.convex, ..Cage::default() }, weights)
    }
}
