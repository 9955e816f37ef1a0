//! How the points of a surface follow the nodes of elements.
//!
//! Tetrahedra carry points by barycentric coordinates. Other elements are divided into tetrahedra between the mean of their nodes, the
//! mean of the nodes of a face, and a side of the face; the weights of means are spread over their nodes. Weights are linear in
//! each tetrahedron, equal on both sides of a shared face, and reproduce affine maps. Elements have to be seen whole from the mean
//! of their nodes, as convex ones are.

use super::cubes::no_inside;
use super::cuts::Lattice;
use crate::surface::Sets;
use crate::{Cage, FillError, Flaws, Surface};
use glam::{DVec3, I64Vec3};
use localshape_sim::geometry::{around, bounds};
use localshape_sim::{Body, Dimension, ElementKind, IndexLists, Solids, Weights};
use rayon::prelude::*;

/// A point outside of all elements follows the nearest one if it is at most so many sides away: beyond, it would only show how
/// that element turns.
const FAR: f64 = 0.75;

/// An element is filled at least by this part: samples miss what is thinner than their distance.
const LEAST: f64 = 0.01;

/// A weight that is negative by less than this is round-off.
const CLOSE: f64 = 1e-10;

/// Elements made from a lattice.
pub(super) struct Draft {
    pub(super) cage: Cage,
    /// Whether each element has corners that count as inside because the body is thin there.
    pub(super) is_wide: Vec<bool>,
}

/// Elements that carry a surface, and its weights.
///
/// `build` makes the elements, given the points of the lattice that count as inside wherever they are. At first there are none. While
/// points of the surface are far from all elements, or follow elements that do not hang together by faces with those of the rest of
/// their piece of the surface, the corners of the cells there are added. So thin parts are as wide as cells, and filled in part.
///
/// # Errors
/// If nothing is inside, or as `build` says.
pub(super) fn carry(
    surface: &Surface,
    flaws: &Flaws,
    lattice: &Lattice,
    build: impl Fn(&[bool]) -> Result<Draft, FillError>,
) -> Result<(Cage, Weights), FillError> {
    let pieces = pieces(surface);
    let mut wide = vec![false; lattice.len()];
    let mut touched = Vec::new();
    loop {
        let draft = build(&wide)?;
        let body = body(&draft.cage);
        let fan = Fan::new(&body);
        let found = fan.locate(&surface.points, lattice.side);
        let hung = Hung::new(&body, &pieces, &found);
        let is_lost = |place: &Option<Place>, piece: u32| place.is_none_or(|place| !hung.carries(&place, piece));
        let has_lost = |of: &&[u32; 3]| of.iter().any(|&point| is_lost(&found[point as usize], pieces[point as usize]));
        let samples = |of: &[u32; 3]| {
            let piece = pieces[of[0] as usize];
            lattice.samples(*of).map(move |at| (at, piece))
        };
        let (places, of_places): (Vec<DVec3>, Vec<u32>) =
            surface.triangles.iter().filter(has_lost).flat_map(samples).unzip();
        if places.is_empty() {
            let (cage, weights) = hung.finished(draft, &fan, &found, lattice);
            let is_empty = cage.filled.iter().flatten().all(|&part| part <= LEAST) && cage.filled.is_some();
            return if is_empty { Err(no_inside(flaws)) } else { Ok((cage, weights)) };
        }
        let before = wide.clone();
        let found = fan.locate(&places, lattice.side);
        for ((&at, &piece), place) in places.iter().zip(&of_places).zip(&found) {
            if is_lost(place, piece) {
                lattice.touch(at, &mut wide);
            }
        }
        if before.contains(&true) {
            // That was not enough to reach the rest: a step along the surface.
            if touched.is_empty() {
                touched = vec![false; lattice.len()];
                let all = surface.triangles.iter().flat_map(|&of| lattice.samples(of));
                all.for_each(|at| lattice.touch(at, &mut touched));
            }
            for point in (0..before.len()).filter(|&point| before[point]) {
                lattice.neighbours(point).filter(|&beside| touched[beside]).for_each(|beside| wide[beside] = true);
            }
        }
        if wide == before {
            let message = format!("falls into pieces if it is filled with elements of side {}", lattice.side);
            return Err(FillError { message, help: Some("Use a smaller side, or fill it with cubes.".to_owned()) });
        }
    }
}

/// No number.
const NONE: u32 = u32::MAX;

/// The elements of a cage with their faces.
pub(super) fn body(cage: &Cage) -> Body {
    let solids = if cage.convex { Solids::Convex } else { Solids::Ordered };
    let mass = vec![1.0; cage.nodes.len()];
    Body::new(Dimension::Space, cage.nodes.clone(), mass, cage.elements.clone(), solids, None)
}

/// The piece of the surface to which each point belongs.
fn pieces(surface: &Surface) -> Vec<u32> {
    let mut sets = Sets::new(surface.points.len());
    for &[a, b, c] in &surface.triangles {
        sets.join(a, b);
        sets.join(a, c);
    }
    sets.numbered().0
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
        let mut sets = Sets::new(body.elements.len());
        for sides in body.faces.inner.iter().zip(&body.faces.outer) {
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

    /// The elements of the parts that carry something, how far they are filled, and the weights.
    fn finished(&self, draft: Draft, fan: &Fan, found: &[Option<Place>], lattice: &Lattice) -> (Cage, Weights) {
        let Draft { cage, is_wide } = draft;
        let filled = fan.filled(&is_wide, lattice);
        let mut is_kept = vec![false; self.parts.len()];
        self.carriers.iter().filter(|&&part| part != NONE).for_each(|&part| is_kept[part as usize] = true);
        let mut numbers = vec![NONE; cage.nodes.len()];
        let mut kept = Cage { filled: is_wide.contains(&true).then(Vec::new), convex: cage.convex, ..Cage::default() };
        let elements = cage.elements.iter().enumerate();
        for (element, nodes) in elements.filter(|&(element, _)| is_kept[self.parts[element] as usize]) {
            let number = |&node: &u32| {
                if numbers[node as usize] == NONE {
                    numbers[node as usize] = kept.nodes.len() as u32;
                    kept.nodes.push(cage.nodes[node as usize]);
                }
                numbers[node as usize]
            };
            kept.elements.push(&nodes.iter().map(number).collect::<Vec<_>>());
            kept.filled.iter_mut().for_each(|all| all.push(filled[element]));
        }
        let spread = |place: &Place| {
            let (nodes, weights) = fan.spread(place);
            (nodes.into_iter().map(|node| numbers[node as usize]).collect::<Vec<_>>(), weights)
        };
        let mut weights = Weights::default();
        for (nodes, own) in found.par_iter().flatten().map(spread).collect::<Vec<_>>() {
            weights.push(&nodes, &own);
        }
        (kept, weights)
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
    /// Tetrahedra whose last three corners are on the outside.
    outside: Vec<Simplex>,
}

impl Fan {
    fn new(body: &Body) -> Self {
        let mut fan = Self {
            points: body.rest.clone(),
            means: IndexLists::default(),
            nodes: body.rest.len(),
            simplices: Vec::new(),
            outside: Vec::new(),
        };
        let is_simple = |element: u32| body.kinds[element as usize] == ElementKind::Tetrahedron;
        let mut middles = vec![u32::MAX; body.elements.len()];
        for (element, nodes) in (0u32..).zip(body.elements.iter()) {
            match *nodes {
                [a, b, c, d] if is_simple(element) => fan.simplices.push(Simplex { element, corners: [a, b, c, d] }),
                _ => middles[element as usize] = fan.mean(nodes),
            }
        }
        for (face, nodes) in body.faces.nodes.iter().enumerate() {
            let mut triangles = Vec::new();
            if let [a, b, c] = *nodes {
                triangles.push([a, b, c]);
            } else {
                let mean = fan.mean(nodes);
                triangles.extend(around(nodes).map(|[a, b]| [mean, a, b]));
            }
            let sides = [body.faces.inner[face], body.faces.outer[face]];
            for element in sides.into_iter().flatten() {
                let opposite = match is_simple(element) {
                    true => body.elements[element as usize].iter().copied().find(|node| !nodes.contains(node)),
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
        fan
    }

    /// Adds the mean of nodes.
    fn mean(&mut self, nodes: &[u32]) -> u32 {
        let sum: DVec3 = nodes.iter().map(|&node| self.points[node as usize]).sum();
        self.means.push(nodes);
        self.points.push(sum / nodes.len() as f64);
        self.points.len() as u32 - 1
    }

    fn corners(&self, simplex: &Simplex) -> [DVec3; 4] {
        simplex.corners.map(|corner| self.points[corner as usize])
    }

    /// The simplex that carries each point: the first that contains it, or the first of the nearest on the outside.
    fn locate(&self, points: &[DVec3], side: f64) -> Vec<Option<Place>> {
        let (low, high) = bounds(&self.points);
        let all: Vec<_> = self.simplices.iter().map(|simplex| bounds(&self.corners(simplex))).collect();
        let mut cells = Grid::new(low, high, side);
        cells.mark(points);
        cells.fill(&all);
        let outer: Vec<_> = self.outside.iter().map(|simplex| bounds(&self.corners(simplex)[1..])).collect();
        let mut faces = Grid::new(low, high, side);
        faces.fill(&outer);
        let locate = |&point: &DVec3| {
            let containing = cells.at(cells.cell(point)).iter().find_map(|&at| {
                let simplex = self.simplices[at as usize];
                let weights = weights(self.corners(&simplex), point);
                weights.iter().all(|&weight| weight >= -CLOSE).then_some((simplex, weights))
            });
            let (simplex, weights) = containing.or_else(|| {
                let simplex = self.outside[self.nearest(&faces, point, side)? as usize];
                Some((simplex, weights(self.corners(&simplex), point)))
            })?;
            Some(Place { element: simplex.element, corners: simplex.corners, weights })
        };
        points.par_iter().map(locate).collect()
    }

    /// The simplex with the nearest face on the outside that is not too far.
    fn nearest(&self, faces: &Grid, point: DVec3, side: f64) -> Option<u32> {
        let cell = faces.cell(point);
        let (mut best, mut nearest) = (None, FAR * side);
        for ring in 0.. {
            // Faces in this ring are at least so far away.
            if nearest <= (ring - 1) as f64 * side {
                break;
            }
            for at in faces.ring(cell, ring) {
                for &face in faces.at(at) {
                    let [_, a, b, c] = self.corners(&self.outside[face as usize]);
                    let distance = point.distance(nearest_of([a, b, c], point));
                    if distance < nearest || (distance == nearest && best.is_none_or(|best| face < best)) {
                        (best, nearest) = (Some(face), distance);
                    }
                }
            }
        }
        best
    }

    /// The part of each element that is inside, by samples, or 1 for those that are not wide.
    fn filled(&self, is_wide: &[bool], lattice: &Lattice) -> Vec<f64> {
        let starts: Vec<usize> =
            (0..=is_wide.len() as u32).map(|at| self.simplices.partition_point(|of| of.element < at)).collect();
        let filled = |element: usize| {
            if !is_wide[element] {
                return 1.0;
            }
            let simplices = &self.simplices[starts[element]..starts[element + 1]];
            // 56 samples in a tetrahedron, four in each of many.
            let steps = if simplices.len() == 1 { 5 } else { 1 };
            let (mut full, mut all) = (0.0, 0.0);
            for simplex in simplices {
                let [a, b, c, d] = self.corners(simplex);
                let volume = (b - a).cross(c - a).dot(d - a).abs();
                for (i, j, k) in (0..=steps)
                    .flat_map(|i| (0..=steps - i).flat_map(move |j| (0..=steps - i - j).map(move |k| (i, j, k))))
                {
                    let along = |count: i32| (f64::from(count) + 0.5) / f64::from(steps + 2);
                    all += volume;
                    if lattice.contains(a + (b - a) * along(i) + (c - a) * along(j) + (d - a) * along(k)) {
                        full += volume;
                    }
                }
            }
            (full / all).max(LEAST)
        };
        (0..is_wide.len()).into_par_iter().map(filled).collect()
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
fn weights([a, b, c, d]: [DVec3; 4], point: DVec3) -> [f64; 4] {
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

/// The point of a triangle that is nearest to a point.
fn nearest_of([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let on_line = |from: DVec3, to: DVec3| {
        let along = to - from;
        from + along * (along.dot(point - from) / along.length_squared()).clamp(0.0, 1.0)
    };
    let normal = (b - a).cross(c - a);
    let is_left = |from: DVec3, to: DVec3| normal.dot((to - from).cross(point - from)) >= 0.0;
    if is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return point - normal * (normal.dot(point - a) / normal.length_squared());
    }
    let sides = [on_line(a, b), on_line(b, c), on_line(c, a)];
    let nearer = |one: DVec3, other: DVec3| {
        if other.distance_squared(point) < one.distance_squared(point) { other } else { one }
    };
    nearer(nearer(sides[0], sides[1]), sides[2])
}

/// Cells of space with the boxes that meet each.
struct Grid {
    low: DVec3,
    cell: f64,
    cells: I64Vec3,
    /// Cells that are filled, if not all are.
    marked: Option<Vec<bool>>,
    starts: Vec<usize>,
    items: Vec<u32>,
}

impl Grid {
    fn new(low: DVec3, high: DVec3, cell: f64) -> Self {
        let cells = ((high - low) / cell).floor().as_i64vec3() + 1;
        Self { low, cell, cells, marked: None, starts: Vec::new(), items: Vec::new() }
    }

    /// Fills only cells with a point.
    fn mark(&mut self, points: &[DVec3]) {
        let mut marked = vec![false; self.cells.element_product() as usize];
        for &point in points {
            self.index(self.cell(point)).into_iter().for_each(|cell| marked[cell] = true);
        }
        self.marked = Some(marked);
    }

    /// Lists each box in the cells it meets, in rising order.
    fn fill(&mut self, boxes: &[(DVec3, DVec3)]) {
        let mut starts = vec![0; self.cells.element_product() as usize + 1];
        let each = |visit: &mut dyn FnMut(usize, u32)| {
            for (item, &(low, high)) in (0u32..).zip(boxes) {
                let (first, last) = (self.cell(low), self.cell(high));
                for z in first.z..=last.z {
                    for y in first.y..=last.y {
                        for x in first.x..=last.x {
                            let cell = self.index(I64Vec3::new(x, y, z));
                            let is_marked = |&cell: &usize| self.marked.as_ref().is_none_or(|marked| marked[cell]);
                            cell.filter(is_marked).into_iter().for_each(|cell| visit(cell, item));
                        }
                    }
                }
            }
        };
        each(&mut |cell, _| starts[cell + 1] += 1);
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut ends = starts.clone();
        let mut items = vec![0; starts[starts.len() - 1]];
        each(&mut |cell, item| {
            items[ends[cell]] = item;
            ends[cell] += 1;
        });
        (self.starts, self.items) = (starts, items);
    }

    /// The cell of a point, which may be outside of the grid.
    fn cell(&self, point: DVec3) -> I64Vec3 {
        ((point - self.low) / self.cell).floor().clamp(DVec3::splat(-1e9), DVec3::splat(1e9)).as_i64vec3()
    }

    fn index(&self, cell: I64Vec3) -> Option<usize> {
        let is_in = cell.cmpge(I64Vec3::ZERO).all() && cell.cmplt(self.cells).all();
        is_in.then(|| ((cell.z * self.cells.y + cell.y) * self.cells.x + cell.x) as usize)
    }

    /// What is in a cell.
    fn at(&self, cell: I64Vec3) -> &[u32] {
        self.index(cell).map_or(&[], |cell| &self.items[self.starts[cell]..self.starts[cell + 1]])
    }

    /// The cells that are so many cells away along an axis, and no farther along others.
    fn ring(&self, middle: I64Vec3, ring: i64) -> impl Iterator<Item = I64Vec3> {
        let along = move || -ring..=ring;
        let all = along().flat_map(move |z| along().flat_map(move |y| along().map(move |x| I64Vec3::new(x, y, z))));
        all.filter(move |by| by.abs().max_element() == ring).map(move |by| middle + by)
    }
}
