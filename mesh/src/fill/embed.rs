//! How the points of a surface follow the nodes of elements.
//!
//! Tetrahedra carry points by barycentric coordinates. Other elements are divided into tetrahedra between the mean of their nodes, the
//! mean of the nodes of a face, and a side of the face; the weights of means are spread over their nodes. Weights are linear in
//! each tetrahedron, equal on both sides of a shared face, and reproduce affine maps. Elements have to be seen whole from the mean
//! of their nodes, as convex ones are.

use super::cuts::{FAR, Lattice};
use super::draft::{Draft, Nodes};
use crate::boxes::Boxes;
use crate::edges::{Sets, pieces};
use crate::{Cage, FillError, Flaws, Surface};
use glam::{DMat3, DVec3};
use localshape_sim::geometry::{around, bounds};
use localshape_sim::{Body, ElementKind, IndexLists, Solids, Weights};
use rayon::prelude::*;
use std::collections::BTreeSet;

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
/// elements on trial, and the part of each cube that is inside, if something is marked. While points of the surface are far from all
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
    build: impl Fn(&[u8], bool, Option<&[f64]>) -> Result<Draft, FillError>,
) -> Result<(Cage, Weights), FillError> {
    let (pieces, _) = pieces(surface.points.len(), &surface.triangles);
    let mut wide = vec![0u8; lattice.len()];
    // Shells of a closed surface may lie in each other.
    let mut inside = if lattice.is_closed() { Some(lattice.filled(flaws)?) } else { None };
    let mut touched = Vec::new();
    let (mut round, mut is_bold) = (0, true);
    while round < ROUNDS {
        let draft = build(&wide, is_bold, inside.as_ref().map(|(inside, _)| &inside[..]))?;
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
            let (inside, overlap) = inside.unwrap_or_default();
            let filled = fan.filled(&draft.is_wide, lattice, &inside);
            let (cage, weights) = hung.finished(draft.cage, filled, &fan, &found);
            return Ok((Cage { overlap, ..cage }, weights));
        }
        if inside.is_none() {
            inside = Some(lattice.filled(flaws)?);
        }
        let inside = inside.as_ref().map_or(&[][..], |(inside, _)| &inside[..]);
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
                touched = lattice.touched(surface, inside);
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

const NONE: u32 = u32::MAX;

/// The elements of a cage with their faces. Where the first try has found none, it is one node.
pub(super) fn body(cage: &Cage) -> Body {
    let solids = if cage.convex { Solids::Convex } else { Solids::Ordered };
    let nodes = if cage.nodes.is_empty() { vec![DVec3::ZERO] } else { cage.nodes.clone() };
    let body = Body::builder(nodes).elements(cage.elements.clone()).solids(solids).fill(cage.filled.clone()).build();
    body.expect("a cage has sound elements")
}

/// How elements hang together.
struct Hung {
    /// The part to which each element belongs. Its elements hang together by faces.
    parts: Vec<u32>,
    /// The part that carries most points of each piece of the surface, the first of several; [`NONE`] if there is none.
    carriers: Vec<u32>,
}

impl Hung {
    fn new(body: &Body, pieces: &[u32], found: &[Option<Place>]) -> Self {
        let mut sets = Sets::new(body.elements().len());
        for sides in body.faces().inner.iter().zip(&body.faces().outer) {
            if let (Some(one), Some(other)) = sides {
                sets.join(*one, *other);
            }
        }
        let (parts, _) = sets.numbered();
        let part = |place: &Place| parts[place.element as usize];
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
    fn carries(&self, place: &Place, piece: u32) -> bool {
        self.carriers[piece as usize] == self.parts[place.element as usize]
    }

    /// The elements of the parts that carry something, and the weights.
    fn finished(&self, cage: Cage, filled: Option<Vec<f64>>, fan: &Fan, found: &[Option<Place>]) -> (Cage, Weights) {
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
            let is_simple = fan.of(place.element as usize).len() == 1;
            if is_gentle || is_simple { fan.spread(place) } else { fan.affine(place) }
        };
        let mut weights = Weights::default();
        for (nodes, own) in found.par_iter().flatten().map(spread).collect::<Vec<_>>() {
            weights.push(&renamed(&nodes), &own);
        }
        (Cage { nodes: nodes.places, elements, filled, convex: cage.convex, ..Cage::default() }, weights)
    }
}

/// A tetrahedron of an element, between nodes and means of nodes.
#[derive(Clone, Copy, Debug)]
struct Simplex {
    element: u32,
    /// Indices of [`Fan::points`]. The last three are on a face of the element.
    corners: [u32; 4],
}

/// A simplex that carries a point, and the weights of its corners.
#[derive(Clone, Copy, Debug)]
struct Place {
    element: u32,
    corners: [u32; 4],
    weights: [f64; 4],
    /// The distance of the point from the element, in sides.
    distance: f64,
}

/// Elements divided into tetrahedra.
struct Fan {
    /// The positions of nodes, then of means (m).
    points: Vec<DVec3>,
    /// The nodes of each mean.
    means: IndexLists,
    /// The number of nodes.
    nodes: usize,
    /// All tetrahedra, by element.
    simplices: Vec<Simplex>,
    /// Where those of each element begin; the last number is where all end.
    starts: Vec<usize>,
    /// Tetrahedra whose last three corners are on the outside.
    outside: Vec<Simplex>,
}

impl Fan {
    fn new(body: &Body) -> Self {
        let mut fan = Self {
            points: body.rest().to_vec(),
            means: IndexLists::default(),
            nodes: body.rest().len(),
            simplices: Vec::new(),
            starts: Vec::new(),
            outside: Vec::new(),
        };
        let is_simple = |element: u32| body.kinds()[element as usize] == ElementKind::Tetrahedron;
        let mut middles = vec![u32::MAX; body.elements().len()];
        for (element, nodes) in (0u32..).zip(body.elements().iter()) {
            match *nodes {
                [a, b, c, d] if is_simple(element) => fan.simplices.push(Simplex { element, corners: [a, b, c, d] }),
                _ => middles[element as usize] = fan.mean(nodes),
            }
        }
        for (face, nodes) in body.faces().nodes.iter().enumerate() {
            let mut triangles = Vec::new();
            if let [a, b, c] = *nodes {
                triangles.push([a, b, c]);
            } else {
                let mean = fan.mean(nodes);
                triangles.extend(around(nodes).map(|[a, b]| [mean, a, b]));
            }
            let sides = [body.faces().inner[face], body.faces().outer[face]];
            for element in sides.into_iter().flatten() {
                let opposite = match is_simple(element) {
                    true => body.elements()[element as usize].iter().copied().find(|node| !nodes.contains(node)),
                    false => Some(middles[element as usize]),
                };
                let Some(opposite) = opposite else { continue };
                let simplices = triangles.iter().map(|&[a, b, c]| Simplex { element, corners: [opposite, a, b, c] });
                if !is_simple(element) {
                    fan.simplices.extend(simplices.clone());
                }
                if sides[1].is_none() {
                    fan.outside.extend(simplices);
                }
            }
        }
        fan.simplices.sort_by_key(|simplex| simplex.element);
        fan.outside.sort_by_key(|simplex| simplex.element);
        let count = body.elements().len() as u32;
        fan.starts = (0..=count).map(|at| fan.simplices.partition_point(|of| of.element < at)).collect();
        fan
    }

    fn mean(&mut self, nodes: &[u32]) -> u32 {
        let sum: DVec3 = nodes.iter().map(|&node| self.points[node as usize]).sum();
        self.means.push(nodes);
        self.points.push(sum / nodes.len() as f64);
        self.points.len() as u32 - 1
    }

    fn corners(&self, simplex: &Simplex) -> [DVec3; 4] {
        simplex.corners.map(|corner| self.points[corner as usize])
    }

    /// The tetrahedra of an element.
    fn of(&self, element: usize) -> &[Simplex] {
        &self.simplices[self.starts[element]..self.starts[element + 1]]
    }

    /// What carries each point: the first element that contains it, or the first of the nearest; `None` if all are farther than
    /// so many sides.
    fn locate(&self, points: &[DVec3], side: f64, most: f64) -> Vec<Option<Place>> {
        let box_of = |element: usize| {
            let corners = self.of(element).iter().flat_map(|simplex| self.corners(simplex));
            let (low, high) =
                corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
            (low - CLOSE * side, high + CLOSE * side)
        };
        let ends = bounds(&self.points);
        let elements = Boxes::new((0..self.starts.len() - 1).into_par_iter().map(box_of).collect(), ends, side);
        let outside = self.outside.iter().map(|simplex| bounds(&self.corners(simplex)[1..])).collect();
        let faces = Boxes::new(outside, ends, side);
        let locate = |&point: &DVec3| {
            let containing = elements.around(point).find_map(|element| {
                self.of(element as usize).iter().find_map(|simplex| {
                    let weights = weights(self.corners(simplex), point);
                    weights.iter().all(|&weight| weight >= -CLOSE).then_some((*simplex, weights))
                })
            });
            if let Some((simplex, weights)) = containing {
                return Some(Place { element: simplex.element, corners: simplex.corners, weights, distance: 0.0 });
            }
            let of_face = |face: u32| {
                let [_, a, b, c] = self.corners(&self.outside[face as usize]);
                [a, b, c]
            };
            let (face, distance) = faces.nearest(of_face, point, most * side)?;
            let simplex = self.outside[face as usize];
            let weights = weights(self.corners(&simplex), point);
            Some(Place { element: simplex.element, corners: simplex.corners, weights, distance: distance / side })
        };
        points.par_iter().map(locate).collect()
    }

    /// The part of each element that is filled. What is inside a cube of the lattice, less the elements there that are not wide, fills
    /// its wide ones evenly.
    fn filled(&self, is_wide: &[bool], lattice: &Lattice, inside: &[f64]) -> Option<Vec<f64>> {
        if !is_wide.contains(&true) {
            return None;
        }
        let cube = lattice.side * lattice.side * lattice.side;
        // The cubes in which an element lies, and the volume there, in cubes.
        let shares = |element: usize| {
            let of = self.of(element);
            of.iter().flat_map(move |simplex| {
                let corners = self.corners(simplex);
                let [a, b, c, d] = corners;
                let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0 / cube;
                let mean = 0.25 * (a + b + c + d);
                // Single tetrahedra may lie in several cubes.
                let pull = if of.len() == 1 { 0.4 } else { 0.0 };
                corners.map(|corner| (lattice.cube_at(mean.lerp(corner, pull)), 0.25 * volume))
            })
        };
        let [mut full, mut wide] = [vec![0.0; inside.len()], vec![0.0; inside.len()]];
        for (element, &is_wide) in is_wide.iter().enumerate() {
            let sum = if is_wide { &mut wide } else { &mut full };
            shares(element).for_each(|(cube, volume)| sum[cube] += volume);
        }
        let of_wide = |element: usize| {
            let (mut filled, mut all) = (0.0, 0.0);
            for (cube, volume) in shares(element) {
                filled += volume * ((inside[cube] - full[cube]) / wide[cube]).clamp(0.0, 1.0);
                all += volume;
            }
            [filled, all]
        };
        let parts: Vec<_> =
            is_wide.iter().enumerate().map(|(element, is_wide)| is_wide.then(|| of_wide(element))).collect();
        // What has no room in wide elements of its cube, or no element there, fills the others as well.
        let [filled, room] =
            parts.iter().flatten().fold([0.0; 2], |[filled, room], of| [filled + of[0], room + (of[1] - of[0])]);
        let thin = (0..inside.len()).filter(|&cube| wide[cube] > 0.0 || full[cube] == 0.0);
        let missing = thin.map(|cube| inside[cube] - full[cube]).sum::<f64>() - filled;
        let more = if missing > CLOSE { (missing / room).min(1.0) } else { 0.0 };
        let part = |[filled, all]: [f64; 2]| ((filled + more * (all - filled)) / all).clamp(LEAST, 1.0);
        Some(parts.into_iter().map(|of| of.map_or(1.0, part)).collect())
    }

    /// The nodes of the element of a place and the weight of each: the least that reproduce affine maps. They are gentle also where a
    /// tetrahedron of the element is flat.
    fn affine(&self, place: &Place) -> (Vec<u32>, Vec<f64>) {
        let at: DVec3 =
            place.corners.iter().zip(&place.weights).map(|(&at, weight)| self.points[at as usize] * *weight).sum();
        let corners = self.of(place.element as usize).iter().flat_map(|simplex| simplex.corners);
        let nodes: BTreeSet<u32> = corners.filter(|&corner| (corner as usize) < self.nodes).collect();
        let nodes: Vec<u32> = nodes.into_iter().collect();
        let places = || nodes.iter().map(|&node| self.points[node as usize]);
        let share = 1.0 / nodes.len() as f64;
        let mean = places().sum::<DVec3>() * share;
        let spread = places()
            .map(|node| node - mean)
            .fold(DMat3::ZERO, |sum, from| sum + DMat3::from_cols(from * from.x, from * from.y, from * from.z));
        let way = spread.inverse() * (at - mean);
        let along: Vec<f64> = places().map(|node| way.dot(node - mean)).collect();
        let error = share * along.iter().sum::<f64>();
        (nodes, along.into_iter().map(|along| share + (along - error)).collect())
    }

    /// The nodes of a place and the weight of each.
    fn spread(&self, place: &Place) -> (Vec<u32>, Vec<f64>) {
        let (mut nodes, mut of_nodes): (Vec<u32>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut add = |node: u32, weight: f64| match nodes.iter().position(|&other| other == node) {
            Some(at) => of_nodes[at] += weight,
            None => {
                nodes.push(node);
                of_nodes.push(weight);
            }
        };
        for (&corner, &weight) in place.corners.iter().zip(&place.weights) {
            match (corner as usize).checked_sub(self.nodes) {
                None => add(corner, weight),
                Some(mean) => {
                    let of = &self.means[mean];
                    of.iter().for_each(|&node| add(node, weight / of.len() as f64));
                }
            }
        }
        (nodes, of_nodes)
    }
}

/// The barycentric coordinates of a point.
pub(super) fn weights([a, b, c, d]: [DVec3; 4], point: DVec3) -> [f64; 4] {
    // From the corners to the point: small numbers have small round-off.
    let [to_a, to_b, to_c, to_d] = [a, b, c, d].map(|corner| corner - point);
    let volumes = [
        to_b.cross(to_c).dot(to_d),
        -to_a.cross(to_c).dot(to_d),
        to_a.cross(to_b).dot(to_d),
        -to_a.cross(to_b).dot(to_c),
    ];
    let sum: f64 = volumes.iter().sum();
    volumes.map(|volume| volume / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube, half of the next one, and a prism on the rest of it.
    fn cage() -> Cage {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let square = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 0.1), (1.7, 0.8), (2.3, 1.0)];
        let nodes = [0.0, 1.0].iter().flat_map(|&z| square.map(|(x, y)| at(x, y, z))).collect();
        let elements = [&[0, 1, 2, 3, 7, 8, 9, 10][..], &[1, 3, 4, 5, 8, 10, 11, 12], &[4, 5, 6, 11, 12, 13]];
        Cage { nodes, elements: elements.into_iter().collect(), convex: true, ..Cage::default() }
    }

    /// The weight of each node.
    fn dense(fan: &Fan, simplex: &Simplex, point: DVec3) -> Vec<f64> {
        let weights = weights(fan.corners(simplex), point);
        let place = Place { element: simplex.element, corners: simplex.corners, weights, distance: 0.0 };
        let mut all = vec![0.0; fan.nodes];
        let (nodes, own) = fan.spread(&place);
        nodes.iter().zip(own).for_each(|(&node, weight)| all[node as usize] += weight);
        all
    }

    #[test]
    fn weights_are_continuous_across_faces() {
        let body = body(&cage());
        let fan = Fan::new(&body);
        let shared: Vec<_> = (0..body.faces().nodes.len()).filter(|&face| body.faces().outer[face].is_some()).collect();
        assert_eq!(shared.len(), 2);
        let mut compared = 0;
        for one in &fan.simplices {
            for other in fan
                .simplices
                .iter()
                .filter(|other| other.element > one.element && other.corners[1..] == one.corners[1..])
            {
                let [_, a, b, c] = fan.corners(one);
                for point in [a, b, c, 0.5 * (a + b), 0.2 * a + 0.5 * b + 0.3 * c, (a + b + c) / 3.0] {
                    let [from_one, from_other] = [one, other].map(|simplex| dense(&fan, simplex, point));
                    assert!(from_one.iter().zip(&from_other).all(|(one, other)| (one - other).abs() < 1e-14));
                }
                compared += 1;
            }
        }
        assert_eq!(compared, 8, "four parts of each shared face");
    }

    #[test]
    fn points_follow_the_first_element_that_holds_them_or_the_nearest() {
        let body = body(&cage());
        let fan = Fan::new(&body);
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.5);
        let points = [at(0.5, 0.5), at(1.0, 0.5), at(1.3, 0.5), at(1.3, -0.4), at(1.3, -0.9), at(1.3, -9.0)];
        let found = fan.locate(&points, 1.0, VERY_FAR);
        let elements: Vec<_> =
            found.iter().map(|place| place.map(|place| (place.element, place.distance > FAR))).collect();
        let expected = [(0, false), (0, false), (1, false), (1, false), (1, true)];
        assert_eq!(elements[..5], expected.map(Some));
        assert_eq!(elements[5], None);
    }

    #[test]
    fn the_nearest_face_may_lie_in_a_later_ring() {
        // A tetrahedron in the cell of the point, and a nearer one beyond the side of that cell.
        let near = [[0.0, 0.0, 0.0], [0.3, 0.4, 0.5], [0.3, 0.6, 0.5], [0.3, 0.5, 0.6]];
        let nearer = [[1.05, 0.4, 0.4], [1.05, 0.7, 0.4], [1.05, 0.4, 0.7], [1.5, 0.5, 0.5]];
        let nodes = near.into_iter().chain(nearer).map(DVec3::from_array).collect();
        let elements = [&[0, 1, 2, 3][..], &[4, 5, 6, 7]].into_iter().collect();
        let body = body(&Cage { nodes, elements, convex: true, ..Cage::default() });
        let found = Fan::new(&body).locate(&[DVec3::new(0.95, 0.5, 0.5)], 1.0, VERY_FAR);
        assert_eq!(found[0].map(|place| place.element), Some(1));
    }
}
