//! Bodies that go through each other: no contact keeps them apart.

use super::assembly::Assembly;
use super::body::Body;
use super::element::Dimension;
use super::geometry::{solid_angle, winds_around};
use super::hull::bounds;
use glam::DVec3;
use std::f64::consts::PI;

/// The share of its size by which an element is shrunk before it is compared with those of other bodies, so that bodies
/// that touch do not overlap.
const SHRUNK: f64 = 0.02;

/// The most pairs of elements of two bodies whose boxes are compared: some tens of milliseconds. If there are more,
/// elements that come late in both bodies are not compared.
const MOST_COMPARED: usize = 10_000_000;

/// The pairs of bodies, among the `wanted` ones, of which an element of one lies partly in an element of the other, at
/// given positions of all nodes (m). Each has the lower number first; they are in rising order, and compared as the
/// iterator goes on. Bodies that only touch do not overlap.
pub fn overlaps<'a>(
    bodies: &'a Assembly,
    position: &'a [DVec3],
    wanted: impl Fn([usize; 2]) -> bool + 'a,
) -> impl Iterator<Item = [usize; 2]> + 'a {
    let count = if bodies.bodies().len() > 1 { bodies.bodies().len() } else { 0 };
    let placed = move |body: usize| Placed { body: &bodies.bodies()[body], position: &position[bodies.nodes(body)] };
    let boxes: Vec<Extent> = (0..count).map(|body| Extent::of(placed(body).position)).collect();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&one, &other| boxes[one].low.x.total_cmp(&boxes[other].low.x));
    let mut pairs = Vec::new();
    for (at, &one) in order.iter().enumerate() {
        let near = order[at + 1..].iter().take_while(|&&other| boxes[other].low.x < boxes[one].high.x);
        let near = near.filter(|&&other| boxes[one].meets(&boxes[other], bodies.whole().dimension));
        pairs.extend(near.map(|&other| [one.min(other), one.max(other)]));
    }
    pairs.sort_unstable();
    let is_wanted = move |pair: &[usize; 2]| wanted(*pair);
    pairs.into_iter().filter(is_wanted).filter(move |&[one, other]| placed(one).overlaps(placed(other)))
}

/// A box.
#[derive(Clone, Copy)]
struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    /// The box around points.
    fn of(points: &[DVec3]) -> Self {
        let (low, high) = bounds(points);
        Self { low, high }
    }

    /// Whether two boxes have a common inside. Boxes may be flat.
    fn meets(&self, other: &Self, dimension: Dimension) -> bool {
        let axes = if dimension == Dimension::Plane { 2 } else { 3 };
        (0..axes).all(|axis| {
            let [low, high] = [self.low[axis].max(other.low[axis]), self.high[axis].min(other.high[axis])];
            low <= high
        })
    }

    /// The common part of two boxes that meet.
    fn common(&self, other: &Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }
}

/// A body with the positions of its nodes (m).
#[derive(Clone, Copy)]
struct Placed<'a> {
    body: &'a Body,
    position: &'a [DVec3],
}

impl Placed<'_> {
    /// Whether an element lies partly in one of another body.
    fn overlaps(self, other: Placed<'_>) -> bool {
        let dimension = self.body.dimension;
        let common = Extent::of(self.position).common(&Extent::of(other.position));
        let size = common.high - common.low;
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let (mine, theirs) = (self.near(&common, axis), other.near(&common, axis));
        let widest = theirs.iter().map(|(_, extent)| extent.high[axis] - extent.low[axis]).fold(0.0, f64::max);
        let mut left = MOST_COMPARED;
        for (one, extent) in mine {
            // An element that begins farther before this one ends before it.
            let first = theirs.partition_point(|(_, other)| other.low[axis] < extent.low[axis] - widest);
            let beside = theirs[first..].iter().take_while(|(_, other)| other.low[axis] <= extent.high[axis]);
            let mut shrunk = None;
            for (two, _) in beside.take(left).inspect(|_| left -= 1).filter(|(_, other)| extent.meets(other, dimension))
            {
                let shrunk = shrunk.get_or_insert_with(|| Shape::of(self, one).shrunk());
                if shrunk.overlaps(&Shape::of(other, *two)) {
                    return true;
                }
            }
        }
        false
    }

    /// The elements whose boxes meet a box, in the order of their beginnings along an axis.
    fn near(&self, common: &Extent, axis: usize) -> Vec<(usize, Extent)> {
        let extent = |element: usize| {
            let corners = self.body.elements[element].iter().map(|&node| self.position[node as usize]);
            let first = self.position[self.body.elements[element][0] as usize];
            let grow = |Extent { low, high }: Extent, point| Extent { low: low.min(point), high: high.max(point) };
            corners.fold(Extent { low: first, high: first }, grow)
        };
        let all = (0..self.body.elements.len()).map(|element| (element, extent(element)));
        let mut near: Vec<_> = all.filter(|(_, extent)| extent.meets(common, self.body.dimension)).collect();
        near.sort_by(|one, other| one.1.low[axis].total_cmp(&other.1.low[axis]));
        near
    }
}

/// The edges and faces of an element.
struct Shape {
    dimension: Dimension,
    middle: DVec3,
    edges: Vec<[DVec3; 2]>,
    faces: Vec<Vec<DVec3>>,
}

impl Shape {
    fn of(placed: Placed<'_>, element: usize) -> Self {
        let Placed { body, position } = placed;
        let at = |node: u32| position[node as usize];
        let nodes = &body.elements[element];
        let (elements, mut faces) = (body.topology(), Vec::new());
        elements.for_each_face(element, |face| faces.push(face.iter().map(|&node| at(node)).collect()));
        Self {
            dimension: body.dimension,
            middle: nodes.iter().map(|&node| at(node)).sum::<DVec3>() / nodes.len() as f64,
            edges: elements.edges_of(element).into_iter().map(|edge| edge.map(at)).collect(),
            faces,
        }
    }

    /// The same, slightly smaller.
    fn shrunk(mut self) -> Self {
        let middle = self.middle;
        let points = self.edges.iter_mut().flatten().chain(self.faces.iter_mut().flatten());
        points.for_each(|point| *point = point.lerp(middle, SHRUNK));
        self
    }

    /// Whether edges of one cross faces of the other, in the plane edges, or one lies in the other.
    fn overlaps(&self, other: &Self) -> bool {
        let cross = match self.dimension {
            Dimension::Plane => self
                .edges
                .iter()
                .any(|&one| other.edges.iter().any(|&two| is_crossed(one, two) && is_crossed(two, one))),
            Dimension::Space => self.is_pierced(other) || other.is_pierced(self),
        };
        cross || self.contains(other.middle) || other.contains(self.middle)
    }

    /// Whether an edge of another element crosses a face.
    fn is_pierced(&self, other: &Self) -> bool {
        self.triangles().any(|triangle| other.edges.iter().any(|&edge| pierces(edge, triangle)))
    }

    /// Whether a point is inside.
    fn contains(&self, point: DVec3) -> bool {
        match self.dimension {
            Dimension::Plane => self.faces.iter().any(|face| winds_around(face.iter().map(|&corner| corner - point))),
            Dimension::Space => {
                let sky: f64 =
                    self.triangles().map(|triangle| solid_angle(triangle.map(|corner| corner - point))).sum();
                sky.abs() > 2.0 * PI
            }
        }
    }

    fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.faces.iter().flat_map(|face| (2..face.len()).map(move |at| [face[0], face[at - 1], face[at]]))
    }
}

/// Whether the ends of a segment in the plane lie on different sides of the line through another.
fn is_crossed([from, to]: [DVec3; 2], [a, b]: [DVec3; 2]) -> bool {
    let turn = |point: DVec3| (b - a).cross(point - a).z;
    turn(from) * turn(to) < 0.0
}

/// Whether a segment crosses a triangle.
fn pierces([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    if normal.dot(from - a) * normal.dot(to - a) >= 0.0 {
        return false;
    }
    // The segment passes all sides of the triangle on the same hand.
    let along = to - from;
    let [a, b, c] = [a, b, c].map(|corner| corner - from);
    let hands = [a.cross(b), b.cross(c), c.cross(a)].map(|side| along.dot(side));
    hands.iter().all(|&hand| hand >= 0.0) || hands.iter().all(|&hand| hand <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    use std::sync::Arc;

    /// A body of one row of boxes along x with a corner at the origin.
    fn row(cells: u32, [x, y, z]: [f64; 3]) -> Arc<Body> {
        let corner = |at: u32| {
            let (along, aside) = (at / 4, at % 4);
            DVec3::new(x * f64::from(along), y * f64::from(aside & 1), z * f64::from(aside >> 1))
        };
        let cell = |at: u32| [0, 4, 1, 5, 2, 6, 3, 7].map(|node| 4 * at + node);
        let cells_of: Vec<_> = (0..cells).map(cell).collect();
        let rest: Vec<_> = (0..4 * (cells + 1)).map(corner).collect();
        made(Dimension::Space, rest, cells_of.iter().map(|cell| &cell[..]))
    }

    fn made<'a>(dimension: Dimension, rest: Vec<DVec3>, elements: impl Iterator<Item = &'a [u32]>) -> Arc<Body> {
        let mass = vec![1.0; rest.len()];
        Arc::new(
            Body::builder(rest).dimension(dimension).elements(elements.collect()).masses(mass).build().expect("a body"),
        )
    }

    /// Whether two bodies overlap when the second is moved (m), in either order.
    #[track_caller]
    fn meet(one: &Arc<Body>, other: &Arc<Body>, by: [f64; 3]) -> bool {
        let moved: Vec<_> = other.rest.iter().map(|&at| at + DVec3::from_array(by)).collect();
        let all = |bodies: [&Arc<Body>; 2], position: [&[DVec3]; 2]| {
            let bodies = Assembly::new(bodies.map(Arc::clone).to_vec());
            overlaps(&bodies, &position.concat(), |_| true).collect::<Vec<_>>()
        };
        let found = all([one, other], [&one.rest, &moved]);
        assert_eq!(found, all([other, one], [&moved, &one.rest]));
        assert!(found.is_empty() || found == [[0, 1]]);
        !found.is_empty()
    }

    /// Blocks of equal cells have all corners on the faces of each other.
    #[test]
    fn blocks_overlap_once_they_reach_into_each_other() {
        let block = row(3, [1.0; 3]);
        for axis in 0..3 {
            let by = |distance: f64| [0, 1, 2].map(|other| if other == axis { distance } else { 0.0 });
            let size = if axis == 0 { 3.0 } else { 1.0 };
            for (distance, expected) in [(1.5 * size, false), (size, false), (0.95 * size, true), (0.0, true)] {
                assert_eq!(meet(&block, &block, by(distance)), expected, "axis {axis}: {distance}");
                assert_eq!(meet(&block, &block, by(-distance)), expected, "axis {axis}: {}", -distance);
            }
        }
        assert!(!meet(&block, &block, [0.1, 1.0, 0.2]));
        assert!(meet(&block, &block, [0.1, 0.95, 0.2]));
    }

    #[test]
    fn bodies_overlap_without_a_node_of_one_in_the_other() {
        // Two rods cross between their ends.
        let (rod, upright) = (row(1, [9.0, 1.0, 1.0]), row(1, [1.0, 9.0, 1.0]));
        assert!(meet(&rod, &upright, [4.0, -4.0, 0.3]));
        assert!(!meet(&rod, &upright, [4.0, -4.0, 1.1]));
        // One lies in an element of the other.
        assert!(meet(&row(1, [9.0; 3]), &row(1, [1.0; 3]), [4.0, 4.0, 4.0]));
        // A cloth and a chain have no inside.
        let triangle = vec![DVec3::ZERO, DVec3::new(9.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 9.0)];
        let cloth = made(Dimension::Space, triangle, [&[0, 1, 2][..]].into_iter());
        let chain = made(Dimension::Space, vec![DVec3::ZERO, DVec3::Y], [&[0, 1][..]].into_iter());
        assert!(meet(&cloth, &chain, [2.0, -0.5, 2.0]));
        assert!(!meet(&cloth, &chain, [5.0, -0.5, 5.0]));
        assert!(meet(&cloth, &row(1, [1.0; 3]), [2.0, -0.5, 2.0]));
    }

    /// A thing in a hollow of another, in its box but not in its elements.
    #[test]
    fn a_hollow_is_outside() {
        let corners = (0..4u32).flat_map(|ring| {
            let at = |x: f64, y: f64| DVec3::new(x, y, 3.0 * f64::from(ring >> 1));
            let out = if ring & 1 == 0 { 1.0 } else { 2.0 };
            [at(-out, -out), at(out, -out), at(out, out), at(-out, out)]
        });
        let rest: Vec<_> = corners.collect();
        let wall = |at: u32| {
            let next = (at + 1) % 4;
            [at, next, 4 + at, 4 + next].into_iter().flat_map(|node| [node, 8 + node]).collect::<Vec<u32>>()
        };
        let walls: Vec<_> = (0..4).map(wall).collect();
        let tube = made(Dimension::Space, rest, walls.iter().map(Vec::as_slice));
        let cube = row(1, [1.0; 3]);
        assert!(!meet(&tube, &cube, [-0.5, -0.5, 1.0]));
        assert!(meet(&tube, &cube, [0.5, -0.5, 1.0]));
    }

    #[test]
    fn bodies_in_the_plane() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let square = |size: f64| {
            let rest = square.iter().map(|&at| size * at).collect();
            made(Dimension::Plane, rest, [&[0, 1, 2, 3][..]].into_iter())
        };
        let one = square(1.0);
        for (by, expected) in [([0.0, 1.0], false), ([0.0, 0.95], true), ([0.5, 0.95], true), ([1.0, 0.0], false)] {
            assert_eq!(meet(&one, &one, [by[0], by[1], 0.0]), expected, "{by:?}");
        }
        assert!(meet(&one, &one, [0.0; 3]));
        assert!(meet(&square(9.0), &one, [4.0, 4.0, 0.0]));
        let bar = made(Dimension::Plane, vec![DVec3::ZERO, 9.0 * DVec3::X], [&[0, 1][..]].into_iter());
        assert!(meet(&one, &bar, [-4.0, 0.3, 0.0]));
        assert!(!meet(&one, &bar, [-4.0, 1.3, 0.0]));
    }

    /// Positions of a run that diverges are no numbers.
    #[test]
    fn pairs_are_in_order_and_only_the_wanted_ones_are_compared() {
        let cube = row(1, [1.0; 3]);
        let bodies = Assembly::new(vec![Arc::clone(&cube); 4]);
        let at = [0.0, 2.5, 0.5, 3.0].map(|x| cube.rest.iter().map(move |&at| at + DVec3::X * x));
        let mut position: Vec<_> = at.into_iter().flatten().collect();
        assert_eq!(overlaps(&bodies, &position, |_| true).collect::<Vec<_>>(), [[0, 2], [1, 3]]);
        assert_eq!(overlaps(&bodies, &position, |pair| pair != [0, 2]).collect::<Vec<_>>(), [[1, 3]]);
        position[..8].fill(DVec3::NAN);
        assert_eq!(overlaps(&bodies, &position, |_| true).collect::<Vec<_>>(), [[1, 3]]);
    }
}
