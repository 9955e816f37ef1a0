//! Cubes of a lattice, cut at the surface into convex polyhedra.
//!
//! An element is the convex hull of the corners of a cube that are inside, of the cuts of its edges, and of a few points in its faces and
//! in itself. The hull meets each face of the cube in the polygon of the nodes there, which is the same for the cube on its other side.
//!
//! Elements would be small around corners that are hardly inside, and need short steps. Cuts near to such a corner are moved: to
//! the corner, which is then on the surface, or to a quarter of the side away from it. So nodes are within an eighth of the side from
//! the surface along their edges, and mostly on it.
//!
//! Where the surface would be far from all elements, at its sharp corners and where the body is thinner than a cube, edges are also cut
//! twice, and faces and cubes have nodes of their own at the farthest points of the surface in a few directions. What is thinner
//! than a quarter of the side there is made so thick, by at most an eighth on each side.
//!
//! The nodes of a cut cube do not spread alike along all axes, so that the shape model, which has one constant for an element, is stiffer
//! along some. No stiffness of elements mends that: the volumes are right, and so is the mean of the moduli along three axes. Of a bar of
//! .26 × 1 × .26 with 10 cubes of .1 they would be .91, 1.18 and .91: its lattice is stretched (`aligned`).

mod inner;

use super::allowed::Allowed;
use super::cuts::{AXES, Cuts, EDGES, Lattice};
use super::draft::Draft;
use super::range;
use super::{FillError, Filled, embed};
use crate::{Flaws, Surface};
use glam::{DVec3, IVec3};
use inner::Inner;
use rayon::prelude::*;

/// The least distance of a cut from a corner inside, and the least thickness of elements where the body is thin, in sides.
const LEAST: f64 = 0.25;

/// A cut nearer than this to a corner outside is moved to it, in sides: faces with shorter sides would be lost in round-off. Nodes
/// in faces and in cubes, and those that make the body thicker, keep this distance from the border.
const CLOSE: f64 = 1.0 / 32.0;

/// Faces and cubes have a node where the surface is farther than this beyond the others in some direction, in sides.
const BEYOND: f64 = 3.0 / 32.0;

/// Elements of thin parts are thicker than this, in sides, and the mean of the squares of the distances of their nodes from
/// the mean is at least that of a corner with edges of [`LEAST`], unless there would be none.
const FLAT: f64 = 1.0 / 16.0;
const SMALL: f64 = 9.0 / 16.0 * LEAST * LEAST;

/// Fills a surface with cubes of this side that are cut at the surface.
pub(super) fn fill(mut surface: Surface, flaws: Flaws, side: f64, allowed: &Allowed) -> Result<Filled, FillError> {
    let lattice = Lattice::around(&mut surface, side, false, allowed)?;
    let is_inside = lattice.inside();
    let mut cuts = lattice.cuts(&is_inside, |_| false);
    let places = places(&lattice, &is_inside, &mut cuts);
    let (cage, weights) = embed::carry(&surface, &flaws, &lattice, |thin, _, inside| {
        Cutting::new(&lattice, &places, &is_inside, &cuts, thin)
            .draft(inside, allowed.most)
            .map_err(|needed| allowed.too_many(side, needed as f64, ""))
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
        let [from, to] = lattice.ends(cuts, cut);
        if is_inside[from] == is_inside[to] {
            continue;
        }
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

/// The corners of a cube or of one of its faces, counted from the lowest with x fastest, then y, then z.
fn corners(across: Option<usize>) -> impl Iterator<Item = usize> + Clone {
    (0..8usize).filter(move |bits| across.is_none_or(|axis| bits >> axis & 1 == 0))
}

/// The point of the lattice at a corner of the cube with this lowest point.
fn corner(low: IVec3, bits: usize) -> IVec3 {
    low + 2 * IVec3::new(bits as i32 & 1, bits as i32 >> 1 & 1, bits as i32 >> 2)
}

/// Cubes that are being cut.
struct Cutting<'l> {
    lattice: &'l Lattice,
    places: &'l [Where],
    is_inside: &'l [bool],
    cuts: &'l Cuts,
    /// How often each cube, by its lowest corner, was found to hold parts of the surface that are far from all elements.
    thin: &'l [u8],
    /// Nodes in faces and cubes, in the order of these.
    inner: Vec<Inner>,
}

impl<'l> Cutting<'l> {
    fn new(lattice: &'l Lattice, places: &'l [Where], is_inside: &'l [bool], cuts: &'l Cuts, thin: &'l [u8]) -> Self {
        let mut cutting = Self { lattice, places, is_inside, cuts, thin, inner: Vec::new() };
        if thin.iter().any(|&thin| thin > 0) {
            let found = cutting.candidates();
            let (faces, cubes): (Vec<_>, Vec<_>) =
                found.chunk_by(|one, other| one.key == other.key).partition(|of| of[0].key % 4 < 3);
            for of in [faces, cubes] {
                let made: Vec<_> = of.into_par_iter().flat_map_iter(|of| cutting.extremes(of)).collect();
                cutting.inner.extend(made);
                cutting.inner.sort_by_key(|inner| inner.key);
            }
        }
        cutting
    }

    /// Appends the nodes of a cube, or of its lower face across an axis: corners, then cuts, then others, counted on.
    fn nodes(&self, low: IVec3, across: Option<usize>, nodes: &mut Vec<usize>) {
        let at = |bits: usize| self.lattice.index(corner(low, bits));
        nodes.extend(corners(across).map(at).filter(|&corner| self.places[corner] != Where::Outside));
        for edge in (0..AXES).filter(|&edge| across != Some(edge)) {
            for bits in corners(across).filter(|bits| bits >> edge & 1 == 0) {
                self.cuts_of(corner(low, bits), edge)
                    .into_iter()
                    .flatten()
                    .for_each(|cut| nodes.push(self.lattice.len() + cut));
            }
        }
        let inner = |node: usize| self.lattice.len() + self.cuts.parts.len() + node;
        let index = self.lattice.index(low);
        match across {
            Some(axis) => nodes.extend(self.inner_of(index, axis).map(inner)),
            None => {
                for (axis, beyond) in EDGES[..AXES].iter().enumerate() {
                    for of in [index, self.lattice.index(low + beyond)] {
                        nodes.extend(self.inner_of(of, axis).map(inner));
                    }
                }
                nodes.extend(self.inner_of(index, 3).map(inner));
            }
        }
    }

    /// The cuts of an edge that are nodes.
    fn cuts_of(&self, from: IVec3, edge: usize) -> [Option<usize>; 2] {
        let ends = [from, from + EDGES[edge]].map(|end| self.lattice.index(end));
        let first = || self.cuts.find(ends[0], edge);
        let is_deep = |cut: usize, end: usize| {
            let depth = if end == 0 { self.cuts.parts[cut] } else { 1.0 - self.cuts.parts[cut] };
            (LEAST..1.0 - CLOSE).contains(&depth)
        };
        match ends.map(|end| self.places[end]) {
            [Where::Inside, Where::Outside] | [Where::Outside, Where::Inside] => [first(), None],
            // From a corner on the surface along the surface, or into the body and out of it.
            [Where::On, Where::Outside] => {
                let cut = if self.is_inside[ends[0]] { first() } else { self.cuts.last(ends[0], edge) };
                [cut.filter(|&cut| is_deep(cut, 0)), None]
            }
            [Where::Outside, Where::On] => [first().filter(|&cut| is_deep(cut, 1)), None],
            [Where::Outside, Where::Outside] if self.is_thin(from, edge) => [first(), self.cuts.last(ends[0], edge)],
            _ => [None; 2],
        }
    }

    /// Whether one of the cubes around an edge is thin.
    fn is_thin(&self, from: IVec3, edge: usize) -> bool {
        let [one, other] = [EDGES[(edge + 1) % AXES], EDGES[(edge + 2) % AXES]];
        let around = [from, from - one, from - other, from - one - other];
        around.into_iter().any(|low| self.lattice.holds(low) && self.thin[self.lattice.index(low)] > 0)
    }

    /// Where a node is, in halves of the side from the origin.
    fn position(&self, node: usize) -> DVec3 {
        let Some(cut) = node.checked_sub(self.lattice.len()) else { return self.lattice.point(node).as_dvec3() };
        let Some(inner) = cut.checked_sub(self.cuts.parts.len()) else {
            return self.lattice.along(self.cuts, cut, self.part(cut));
        };
        self.inner[inner].at
    }

    /// The part of the way along its edge at which a cut is. Two cuts of an edge are moved apart if they are close to each other.
    fn part(&self, cut: usize) -> f64 {
        let part = self.cuts.parts[cut];
        let ((from, edge), ends) = (self.cuts.edge(cut), self.lattice.ends(self.cuts, cut));
        if let [Where::Outside, Where::Outside] = ends.map(|end| self.places[end])
            && let [Some(first), Some(last)] = [self.cuts.find(from, edge), self.cuts.last(from, edge)]
        {
            let apart = 0.5 * (LEAST - (self.cuts.parts[last] - self.cuts.parts[first])).max(0.0);
            return (if cut == first { part - apart } else { part + apart }).clamp(CLOSE, 1.0 - CLOSE);
        }
        part
    }

    /// All cubes with a corner inside and those of thin parts, or their number if there are more than `most`. `filled` is the part of
    /// each cube that is inside.
    fn draft(&self, filled: &[f64], most: usize) -> Result<Draft, usize> {
        let draft = self.elements(filled, most, false)?;
        if draft.is_wide.is_empty() { self.elements(filled, most, true) } else { Ok(draft) }
    }

    /// The elements; if they are alone, those that are small, too.
    fn elements(&self, filled: &[f64], most: usize, is_alone: bool) -> Result<Draft, usize> {
        let mut draft = Draft::new(true, self.lattice.len() + self.cuts.parts.len() + self.inner.len(), most);
        let mut nodes = Vec::new();
        for cube in 0..self.lattice.cubes.element_product() {
            let low = self.lattice.lowest(cube);
            let inside = || {
                let all = corners(None).map(|bits| self.lattice.index(corner(low, bits)));
                all.filter(|&corner| self.places[corner] == Where::Inside)
            };
            let has_inside = inside().next().is_some();
            let thin = self.thin[self.lattice.index(low)];
            let is_filled = || filled[cube as usize] > embed::LEAST * CLOSE;
            // Surfaces laid on each other enclose nothing, and their points are carried all the same.
            if !(has_inside || thin > 1 || thin == 1 && is_filled()) {
                continue;
            }
            nodes.clear();
            self.nodes(low, None, &mut nodes);
            let is_beside = || {
                let mean = nodes.iter().map(|&node| self.position(node)).sum::<DVec3>() / nodes.len() as f64;
                !self.lattice.contains(self.lattice.place(mean))
            };
            // Corners on the surface count as inside or as outside. What is between them may be beside the body.
            let is_doubtful = inside().all(|corner| self.cuts.on.binary_search(&corner).is_ok());
            let is_element = if has_inside { !(is_doubtful && is_beside()) } else { self.is_element(&nodes, is_alone) };
            if is_element {
                draft.push(&nodes, thin > 0, |node| self.lattice.place(self.position(node)));
            }
        }
        draft.finished()
    }

    /// Whether nodes of a thin part are an element, or would be if it were the only one.
    fn is_element(&self, nodes: &[usize], is_alone: bool) -> bool {
        let all: Vec<_> = nodes.iter().map(|&node| self.position(node)).collect();
        let mean = all.iter().sum::<DVec3>() / all.len() as f64;
        let spread = all.iter().map(|at| at.distance_squared(mean)).sum::<f64>() / all.len() as f64;
        let is_flat = |direction: DVec3| {
            let (low, high) = range(all.iter().map(|at| at.dot(direction)));
            high - low < 2.0 * FLAT
        };
        all.len() > 3 && (is_alone || spread >= 4.0 * SMALL) && !directions(None).any(is_flat)
    }
}

/// Directions to all sides, or in the plane across an axis: along axes first, then between two of them, then between three.
pub(super) fn directions(across: Option<usize>) -> impl Iterator<Item = DVec3> {
    let all = (1..=3).flat_map(|length| {
        let some = (0..27).map(|at| IVec3::new(at % 3, at / 3 % 3, at / 9) - 1);
        some.filter(move |direction| direction.length_squared() == length)
    });
    let all = all.filter(move |direction| across.is_none_or(|axis| direction[axis] == 0));
    all.map(|direction| direction.as_dvec3().normalize())
}
