//! Tetrahedra whose outer nodes lie on the surface.
//!
//! Isosurface stuffing (F. Labelle, J. R. Shewchuk, “Isosurface stuffing: fast tetrahedral meshes with good dihedral angles”, ACM
//! Transactions on Graphics 26(3), 2007): the tetrahedra of a body-centred lattice are cut at the surface, after points of the lattice
//! close to a cut have been moved to it. Dihedral angles are between 10.7° and 164.8°.

use super::allowed::Allowed;
use super::cuts::{AXES, Cuts, EDGES, Lattice};
use super::draft::Draft;
use super::tighten::{Near, cosines};
use super::{FillError, Filled, embed};
use crate::{Flaws, Surface};
use glam::{DVec3, IVec3};
use std::cell::{Cell, OnceCell};

/// A point of the lattice is moved to a cut of one of its edges that is nearer than this part of the edge: for edges along the axes
/// and for the shorter others. Angles are bounded as stated for any cuts and moves of the corners of a tetrahedron, as a search
/// through all showed. The paper has 0.24999 and 0.41189: scans were met where those leave less than 10.6°.
const NEAR: [f64; 2] = [0.285, 0.399];

/// A part that is too small or too thin for its elements is tried again with sides shorter by this factor, down to the least one.
const SHORTER: f64 = 0.8;
const SHORTEST: f64 = 0.5;

/// Fills a surface with tetrahedra of a lattice with this side, or a shorter one if nodes would stay far outside.
pub(super) fn fill(surface: Surface, flaws: Flaws, side: f64, allowed: &Allowed) -> Result<Filled, FillError> {
    let mut shorter = side;
    while shorter >= SHORTEST * side {
        if let Some(mut filled) = of_lattice(surface.clone(), flaws, shorter, allowed)? {
            filled.cage.thin.filled *= shorter / side;
            return Ok(filled);
        }
        shorter *= SHORTER;
    }
    let message = format!("is so thin that tetrahedra of side {side} would stand far outside of it");
    Err(FillError::new(message, "use a smaller side, or fill it with cubes"))
}

/// The elements of a lattice with this side; `None` if nodes of them stay far outside.
fn of_lattice(mut surface: Surface, flaws: Flaws, side: f64, allowed: &Allowed) -> Result<Option<Filled>, FillError> {
    let lattice = Lattice::around(&mut surface, side, true, allowed)?;
    let truly_inside = lattice.inside();
    let (is_far, near) = (Cell::new(false), OnceCell::new());
    let (cage, weights) = embed::carry(&surface, &flaws, &lattice, |wide, is_bold, _| {
        let is_inside: Vec<bool> = truly_inside.iter().zip(wide).map(|(inside, wide)| *inside || *wide > 0).collect();
        let cuts = lattice.cuts(&is_inside, |point| wide[point] > 0 && !truly_inside[point]);
        let found = Stuffing::new(&lattice, &is_inside, cuts).draft(wide, allowed.most);
        let mut draft = found.map_err(|needed| allowed.too_many(side, needed as f64, ""))?;
        let near = || near.get_or_init(|| Near::new(&surface, &lattice));
        is_far.set(draft.is_wide.contains(&true) && near().tighten(&mut draft, is_bold));
        Ok(draft)
    })?;
    drop(near);
    Ok((!is_far.get()).then_some(Filled { cage, surface, weights, flaws }))
}

/// On which side of the surface a point of the lattice lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Where {
    Inside,
    /// It was moved to this cut.
    On(u32),
    Outside,
}

/// A corner of a tetrahedron: a point of the lattice, or a cut.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// The point by its place in lists, or the cut, counted on from the last point.
    node: usize,
    /// Twice its place before points were moved, with cuts in the middles of edges, from which the order of corners follows.
    place: IVec3,
}

struct Stuffing<'l> {
    lattice: &'l Lattice,
    cuts: Cuts,
    places: Vec<Where>,
}

impl<'l> Stuffing<'l> {
    /// Moves points of the lattice that are near to cuts, one after the other, each to its nearest cut. Its other edges are then
    /// no longer cut.
    fn new(lattice: &'l Lattice, is_inside: &[bool], cuts: Cuts) -> Self {
        let side = |&inside: &bool| if inside { Where::Inside } else { Where::Outside };
        let mut places: Vec<Where> = is_inside.iter().map(side).collect();
        // The cuts near to each point: its place in lists, the cut, and the distance in halves of the side.
        let mut near = Vec::new();
        for cut in 0..cuts.parts.len() {
            let ([from, to], (_, edge)) = (lattice.ends(&cuts, cut), cuts.edge(cut));
            let length = EDGES[edge].as_dvec3().length();
            for (end, other, part) in [(from, to, cuts.parts[cut]), (to, from, 1.0 - cuts.parts[cut])] {
                if part < NEAR[usize::from(edge >= AXES)] {
                    near.push((end, part * length, cut as u32, other));
                }
            }
        }
        near.sort_unstable_by(|one, other| {
            one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)).then(one.2.cmp(&other.2))
        });
        for (point, _, cut, other) in near {
            let is_whole = |end: usize| !matches!(places[end], Where::On(_));
            if is_whole(point) && is_whole(other) {
                places[point] = Where::On(cut);
            }
        }
        Self { lattice, cuts, places }
    }

    /// All tetrahedra, or their number if there are more than `most`.
    fn draft(&self, wide: &[u8], most: usize) -> Result<Draft, usize> {
        let mut draft = Draft::new(false, self.lattice.len() + self.cuts.parts.len(), most);
        for cube in 0..self.lattice.cubes.element_product() {
            let middle = self.lattice.lowest(cube) + 1;
            for axis in 0..AXES {
                let beside = middle + EDGES[axis];
                if !self.lattice.holds(beside) {
                    continue;
                }
                let [along, u, v] = [0, 1, 2].map(|turn| EDGES[(axis + turn) % AXES] / 2);
                let ring = [-u - v, u - v, u + v, v - u].map(|corner| middle + along + corner);
                for start in 0..4 {
                    self.cut([middle, beside, ring[start], ring[(start + 1) % 4]], wide, &mut draft);
                }
            }
        }
        draft.finished()
    }

    /// Appends the tetrahedra of the part inside of a tetrahedron of the lattice.
    fn cut(&self, corners: [IVec3; 4], wide: &[u8], draft: &mut Draft) {
        let place = |corner: IVec3| self.places[self.lattice.index(corner)];
        let count = |side| corners.iter().filter(|&&corner| place(corner) == side).count();
        let (ins, outs) = (count(Where::Inside), count(Where::Outside));
        if ins == 0 {
            return;
        }
        let mut sorted = corners;
        sorted.sort_by_key(|&corner| match place(corner) {
            Where::Inside => 0,
            Where::On(_) => 1,
            Where::Outside => 2,
        });
        let [a, b, c, d] = sorted;
        let mut add = |corners: [Corner; 4]| {
            let is_wide = corners.iter().any(|&corner| self.ends(corner).into_iter().any(|end| wide[end] > 0));
            draft.push(&ordered(corners), is_wide, |node| self.lattice.place(self.position(node)));
        };
        let (whole, cut) = (|point| self.whole(point), |inside, outside| self.cut_of(inside, outside));
        match [ins, outs] {
            [_, 0] => add(sorted.map(whole)),
            // A corner is cut off.
            [1, _] => {
                add(sorted.map(|point| if place(point) == Where::Outside { cut(a, point) } else { whole(point) }))
            }
            // A pyramid, with its base in a face of the lattice.
            [2, 1] => {
                let (a, b) = if meets_first(a, b, d) { (a, b) } else { (b, a) };
                add([whole(a), whole(b), cut(b, d), whole(c)]);
                add([whole(a), cut(a, d), cut(b, d), whole(c)]);
            }
            // A prism between three corners and three cuts.
            [3, _] => {
                let columns = [a, b, c];
                let precedes = |one: usize, other: usize| !meets_first(columns[one], columns[other], d);
                prism(columns.map(whole), columns.map(|corner| cut(corner, d)), precedes).into_iter().for_each(add);
            }
            // A prism between two triangles, each with a corner and its cuts.
            _ => {
                let [tops, bottoms] = [a, b].map(|corner| [whole(corner), cut(corner, c), cut(corner, d)]);
                // A diagonal from the bottom, `b`, ends at the cut of `a`.
                let [to_c, to_d] = [c, d].map(|out| meets_first(b, a, out));
                let cut_along = |is_second: bool| {
                    prism(tops, bottoms, |one, other| match [one, other] {
                        [0, 1] => to_c,
                        [1, 2] if to_c == to_d => is_second,
                        _ => to_d,
                    })
                };
                // Either diagonal of the surface fits if the other two start at one corner: the one with blunter angles.
                let [first, second] = [false, true].map(cut_along);
                let sharpest = |all: &[[Corner; 4]; 3]| all.iter().map(|of| self.sharpest(*of)).fold(-1.0, f64::max);
                let chosen = if sharpest(&second) <= sharpest(&first) { second } else { first };
                chosen.into_iter().for_each(add);
            }
        }
    }

    fn whole(&self, point: IVec3) -> Corner {
        let index = self.lattice.index(point);
        let node = match self.places[index] {
            Where::On(cut) => self.places.len() + cut as usize,
            _ => index,
        };
        Corner { node, place: 2 * point }
    }

    /// The point of the lattice that a corner is, or the ends of the edge of its cut.
    fn ends(&self, corner: Corner) -> [usize; 2] {
        match corner.node.checked_sub(self.places.len()) {
            None => [corner.node; 2],
            Some(cut) => self.lattice.ends(&self.cuts, cut),
        }
    }

    /// Where a node is, in halves of the side from the origin.
    fn position(&self, node: usize) -> DVec3 {
        match node.checked_sub(self.places.len()) {
            None => self.lattice.point(node).as_dvec3(),
            Some(cut) => self.lattice.along(&self.cuts, cut, self.cuts.parts[cut]),
        }
    }

    /// The cosine of the smallest dihedral angle of a tetrahedron.
    fn sharpest(&self, corners: [Corner; 4]) -> f64 {
        cosines(corners.map(|corner| self.position(corner.node))).into_iter().fold(-1.0, f64::max)
    }

    fn cut_of(&self, inside: IVec3, outside: IVec3) -> Corner {
        let between = outside - inside;
        let is_forth = EDGES.contains(&between);
        let (from, along) = if is_forth { (inside, between) } else { (outside, -between) };
        let edge = EDGES.iter().position(|&edge| edge == along).unwrap_or_default();
        let cut = self.cuts.find(self.lattice.index(from), edge).unwrap_or_default();
        Corner { node: self.places.len() + cut, place: inside + outside }
    }
}

/// Whether the diagonal of the quadrilateral that remains of a face of the lattice, with `out` outside, meets its corner `a` and not
/// its corner `b`. It depends on the face only, so that both of its tetrahedra agree.
fn meets_first(a: IVec3, b: IVec3, out: IVec3) -> bool {
    let is_along = |edge: IVec3| edge.abs().element_sum() == 2;
    if is_along(a - b) {
        // The paper's rule of parity: points beside each other on an axis take turns.
        (a / 2).element_sum() % 2 == 0
    } else {
        // The diagonal ends at the cut of the longer edge.
        is_along(b - out)
    }
}

/// The tetrahedra of a prism. For columns `one < other`, `precedes(one, other)` says whether the diagonal between them is from the
/// bottom of `one` to the top of `other`; there must be an order of columns.
fn prism(tops: [Corner; 3], bottoms: [Corner; 3], precedes: impl Fn(usize, usize) -> bool) -> [[Corner; 4]; 3] {
    let mut before = [0; 3];
    for [one, other] in [[0, 1], [0, 2], [1, 2]] {
        before[if precedes(one, other) { other } else { one }] += 1;
    }
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&column| before[column]);
    let [i, j, k] = order;
    [
        [tops[i], tops[j], tops[k], bottoms[i]],
        [bottoms[i], tops[j], tops[k], bottoms[j]],
        [bottoms[i], bottoms[j], tops[k], bottoms[k]],
    ]
}

/// The nodes of a tetrahedron in the order in which its volume is positive.
fn ordered(corners: [Corner; 4]) -> [usize; 4] {
    let [_, b, c, d] = corners.map(|corner| corner.place - corners[0].place);
    let [first, second, third, last] = corners.map(|corner| corner.node);
    if b.cross(c).dot(d) > 0 { [first, second, third, last] } else { [first, third, second, last] }
}
