//! Convex hulls of a few points, with polygonal faces: the faces of elements of any shape.
//!
//! Libraries (`chull`, `parry3d-f64`) return triangles. Merging those that are coplanar to round-off, and removing
//! nodes along edges and inside faces, needs the tolerances that are most of this file. Their order of faces, on which
//! springs and sums depend, may also change between versions.

use super::element::{ElementKind, around, face_table};
use super::lists::IndexLists;
use glam::DVec3;
use std::collections::HashSet;

/// A point is in a plane if its distance, relative to the size of the points' box, is at most this. A millionth is well
/// above the error of single precision or of six typed digits, and well below what a picture shows. The other
/// tolerances are tried if the hull does not close because distances are close to the first one.
const TOLERANCES: [f64; 4] = [1e-6, 1e-5, 1e-8, 1e-10];

/// The faces of elements of kind [`ElementKind::Other`]: the faces of their convex hulls at rest.
///
/// Empty, and without cost, for a body without such elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hulls {
    /// These elements, in rising order.
    elements: Vec<u32>,
    /// Where the faces of each element begin; the last number is where all end.
    starts: Vec<usize>,
    /// The nodes of each face, counter-clockwise from outside.
    faces: IndexLists,
}

impl Hulls {
    /// The hulls of all elements of the kind [`ElementKind::Other`].
    pub fn new(elements: &IndexLists, kinds: &[ElementKind], rest: &[DVec3]) -> Self {
        let mut hulls = Self::default();
        let mut corners = Vec::new();
        for (element, nodes) in (0u32..).zip(elements.iter()) {
            if kinds[element as usize] == ElementKind::Other {
                corners.clear();
                corners.extend(nodes.iter().map(|&node| rest[node as usize]));
                hulls.elements.push(element);
                hulls.starts.push(hulls.faces.len());
                for face in faces(&corners) {
                    hulls.faces.push(&face.iter().map(|&place| nodes[place as usize]).collect::<Vec<_>>());
                }
            }
        }
        hulls.starts.push(hulls.faces.len());
        hulls
    }

    /// Appends the hulls of another body, whose nodes and elements are counted from the given ones.
    pub(crate) fn append(&mut self, others: &Self, node: u32, element: u32) {
        let end = self.faces.len();
        self.elements.extend(others.elements.iter().map(|other| element + other));
        self.starts.pop();
        self.starts.extend(others.starts.iter().map(|start| end + start));
        self.faces.append(&others.faces, node);
    }

    /// The faces of one element: none if it has a table of faces or if all its nodes are on a line; one if they are in
    /// a plane.
    pub(crate) fn of(&self, element: usize) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        let faces = match self.elements.binary_search_by(|&other| (other as usize).cmp(&element)) {
            Ok(at) => self.starts[at]..self.starts[at + 1],
            Err(_) => 0..0,
        };
        faces.map(|face| &self.faces[face])
    }
}

/// The corners of the bounding box of `points`, low and high; zero for no points.
pub fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(&first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((first, first), |(low, high), &point| (low.min(point), high.max(point)))
}

/// The faces of the convex hull of points, as indices of points, sorted. Each is counter-clockwise seen from outside
/// and begins with its lowest index.
///
/// Coplanar faces are merged into one polygon. Points in a plane have one face, oriented as they are listed; points on
/// a line have none. Points inside the hull, inside a face or along an edge are not corners.
///
/// Faces are found one from another by rotating a plane about each edge (gift wrapping), whose cost is proportional to
/// the product of the numbers of points and faces.
pub(crate) fn faces(points: &[DVec3]) -> Vec<Vec<u32>> {
    let (low, high) = bounds(points);
    let size = (high - low).max_element();
    if size <= 0.0 || !size.is_finite() {
        return Vec::new();
    }
    if let Some(faces) = of_box(points, low, high) {
        return faces;
    }
    let middle = low + 0.5 * (high - low);
    let scaled: Vec<_> = points.iter().map(|&point| (point - middle) / size).collect();
    let tries = TOLERANCES.into_iter().find_map(|tolerance| Cloud::new(&scaled, tolerance).faces());
    sorted(tries.unwrap_or_default())
}

/// The faces of points that are the corners of a box along the axes, as most are in bodies cut from a lattice: the same faces, some
/// fifty times as fast.
fn of_box(points: &[DVec3], low: DVec3, high: DVec3) -> Option<Vec<Vec<u32>>> {
    if points.len() != 8 || (high - low).min_element() < 1e-3 * (high - low).max_element() {
        return None;
    }
    let mut corners = [None; 8];
    for (place, point) in (0u32..).zip(points) {
        let (is_low, is_high) = (point.cmpeq(low), point.cmpeq(high));
        if is_low.bitmask() | is_high.bitmask() != 7 {
            return None;
        }
        corners[is_high.bitmask() as usize] = Some(place);
    }
    // As in the table of hexahedra, whose corners are numbered with x fastest, then y, then z.
    let face = |of: &&[u8]| of.iter().map(|&corner| corners[corner as usize]).collect::<Option<Vec<_>>>();
    face_table(ElementKind::Hexahedron).iter().map(face).collect::<Option<Vec<_>>>().map(sorted)
}

/// Faces that each begin with the lowest index, in rising order.
fn sorted(mut faces: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    for face in &mut faces {
        let lowest = (0..face.len()).min_by_key(|&at| face[at]).unwrap_or(0);
        face.rotate_left(lowest);
    }
    faces.sort_unstable();
    faces
}

/// Points in a box of size one, and the greatest distance from a plane at which a point counts as in it.
struct Cloud<'p> {
    points: &'p [DVec3],
    /// Indices of points, without repeated points.
    places: Vec<u32>,
    tolerance: f64,
}

impl<'p> Cloud<'p> {
    fn new(points: &'p [DVec3], tolerance: f64) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_by(|&a, &b| points[a as usize].x.total_cmp(&points[b as usize].x));
        let mut is_double = vec![false; points.len()];
        for (at, &one) in order.iter().enumerate() {
            let point = points[one as usize];
            let near = order[at + 1..].iter().take_while(|&&other| points[other as usize].x - point.x <= tolerance);
            for &other in near.filter(|&&other| points[other as usize].distance(point) <= tolerance) {
                is_double[one.max(other) as usize] = true;
            }
        }
        let places = (0..points.len() as u32).filter(|&place| !is_double[place as usize]).collect();
        Self { points, places, tolerance }
    }

    fn at(&self, place: u32) -> DVec3 {
        self.points[place as usize]
    }

    /// The index for which `distance` is largest, and that distance; the lowest index if there are several.
    fn farthest(&self, places: &[u32], distance: impl Fn(DVec3) -> f64) -> Option<(u32, f64)> {
        let measured = places.iter().map(|&place| (place, distance(self.at(place))));
        measured.reduce(|best, other| if other.1 > best.1 { other } else { best })
    }

    /// The faces, or `None` if they do not close.
    fn faces(&self) -> Option<Vec<Vec<u32>>> {
        let centre = self.places.iter().map(|&place| self.at(place)).sum::<DVec3>() / self.places.len() as f64;
        // The point farthest from the centre is a corner of the hull.
        let (corner, reach) = self.farthest(&self.places, |point| point.distance(centre))?;
        let origin = self.at(corner);
        let (far, length) = self.farthest(&self.places, |point| point.distance(origin))?;
        if length <= self.tolerance {
            return Some(Vec::new());
        }
        let line = (self.at(far) - origin) / length;
        let (aside, width) = self.farthest(&self.places, |point| from_line(point - origin, line).length())?;
        if width <= self.tolerance {
            return Some(Vec::new());
        }
        let normal = line.cross(from_line(self.at(aside) - origin, line) / width);
        if self.places.iter().all(|&place| normal.dot(self.at(place) - origin).abs() <= self.tolerance) {
            return Some(vec![self.as_listed(self.polygon(&self.places, normal, corner, None)?)]);
        }
        let first = self.first_face(corner, (origin - centre) / reach)?;
        self.around(first)
    }

    /// The outline of points in a plane, with the orientation in which they are listed.
    fn as_listed(&self, mut outline: Vec<u32>) -> Vec<u32> {
        let area = |places: &[u32]| {
            let next = places.iter().cycle().skip(1);
            places.iter().zip(next).map(|(&a, &b)| self.at(a).cross(self.at(b))).sum::<DVec3>()
        };
        if area(&outline).dot(area(&self.places)) < 0.0 {
            outline.reverse();
        }
        outline
    }

    /// A face at a corner of the hull. A plane with this normal touches the hull only at that corner.
    fn first_face(&self, corner: u32, normal: DVec3) -> Option<Vec<u32>> {
        // Rotates the plane about any line in it until it touches a second point.
        let line = normal.any_orthonormal_vector();
        let (normal, inside) = self.turned(self.at(corner), line, normal)?;
        let origin = self.at(corner);
        let (far, length) = self.farthest(&inside, |point| point.distance(origin))?;
        let edge = (self.at(far) - origin) / length;
        let (_, width) = self.farthest(&inside, |point| from_line(point - origin, edge).length())?;
        if width > self.tolerance {
            return self.polygon(&inside, normal, corner, None);
        }
        self.beside([corner, far], normal)
    }

    /// The face on the other side of an edge of a face with this outward normal, in which the edge is
    /// counter-clockwise.
    fn beside(&self, [from, to]: [u32; 2], normal: DVec3) -> Option<Vec<u32>> {
        let edge = (self.at(to) - self.at(from)).normalize();
        let (normal, inside) = self.turned(self.at(from), edge, normal)?;
        self.polygon(&inside, normal, to, Some(from))
    }

    /// Rotates a plane that touches the hull at a line about that line, away from the side to the left of the line,
    /// until it touches the hull again. Returns its outward normal and the points in it.
    fn turned(&self, origin: DVec3, line: DVec3, normal: DVec3) -> Option<(DVec3, Vec<u32>)> {
        let right = line.cross(normal);
        // The position of a point seen along the line: to the right of it and below the plane.
        let seen = |place: u32| {
            let relative = self.at(place) - origin;
            let aside = from_line(relative, line).length() > self.tolerance;
            aside.then(|| (relative.dot(right), (-relative.dot(normal)).max(0.0)))
        };
        let mut first: Option<(u32, (f64, f64))> = None;
        for &place in &self.places {
            let Some((x, y)) = seen(place) else { continue };
            let is_before = first.is_none_or(|(_, (other_x, other_y))| {
                let turn = x * other_y - y * other_x;
                turn > 0.0 || (turn == 0.0 && x > 0.0 && other_x < 0.0)
            });
            if is_before {
                first = Some((place, (x, y)));
            }
        }
        // The plane through a point, the points in it, and whether there are points above it.
        let through = |place: u32| {
            let normal = from_line(self.at(place) - origin, line).cross(line).try_normalize()?;
            let (mut inside, mut is_above) = (Vec::new(), false);
            for &place in &self.places {
                let height = normal.dot(self.at(place) - origin);
                is_above |= height > self.tolerance;
                if height.abs() <= self.tolerance {
                    inside.push(place);
                }
            }
            Some((normal, inside, is_above))
        };
        let (first, _) = first?;
        let (mut normal, mut inside, mut is_above) = through(first)?;
        // The point farthest from the line determines the plane most precisely.
        let (far, _) = self.farthest(&inside, |point| from_line(point - origin, line).length())?;
        if far != first {
            (normal, inside, is_above) = through(far)?;
        }
        (!is_above).then_some((normal, inside))
    }

    /// The outline of points in a plane, counter-clockwise about its normal, from a first corner and, if it is given, a
    /// second one.
    fn polygon(&self, inside: &[u32], normal: DVec3, start: u32, second: Option<u32>) -> Option<Vec<u32>> {
        let mut outline = vec![start];
        let mut next = second;
        while outline.len() <= inside.len() {
            let last = *outline.last()?;
            let to = match next.take() {
                Some(to) => to,
                None => self.next_corner(inside, normal, last)?,
            };
            if to == start {
                return (outline.len() > 2).then_some(outline);
            }
            outline.push(to);
        }
        None
    }

    /// The next corner: all points lie to the left of the line to it. The farthest, if several lie on the line.
    fn next_corner(&self, inside: &[u32], normal: DVec3, last: u32) -> Option<u32> {
        let origin = self.at(last);
        let others = || inside.iter().copied().filter(|&place| place != last);
        let rightmost = others().reduce(|best, other| {
            let [a, b] = [best, other].map(|place| self.at(place) - origin);
            if normal.dot(a.cross(b)) < 0.0 { other } else { best }
        })?;
        let along = (self.at(rightmost) - origin).normalize();
        let on_line = others().filter(|&place| {
            let relative = self.at(place) - origin;
            relative.dot(along) > 0.0 && from_line(relative, along).length() <= self.tolerance
        });
        self.farthest(&on_line.collect::<Vec<_>>(), |point| point.distance(origin)).map(|(place, _)| place)
    }

    /// All faces, starting with a first one; `None` if they do not close.
    fn around(&self, first: Vec<u32>) -> Option<Vec<Vec<u32>>> {
        let most = 2 * self.places.len();
        let mut faces = Vec::new();
        let mut edges: HashSet<[u32; 2]> = HashSet::new();
        // Edges whose second face may not have been found yet, with the normal of the first.
        let mut open: Vec<([u32; 2], DVec3)> = Vec::new();
        let mut found = Some(first);
        loop {
            if let Some(face) = found.take() {
                let next = face.iter().cycle().skip(1);
                let area: DVec3 = face
                    .iter()
                    .zip(next)
                    .map(|(&a, &b)| (self.at(a) - self.at(face[0])).cross(self.at(b) - self.at(face[0])))
                    .sum();
                let normal = area.try_normalize()?;
                for edge in around(&face) {
                    if !edges.insert(edge) {
                        return None;
                    }
                    open.push((edge, normal));
                }
                faces.push(face);
            }
            if faces.len() > most {
                return None;
            }
            let Some(([from, to], normal)) = open.pop() else { break };
            if !edges.contains(&[to, from]) {
                found = Some(self.beside([from, to], normal)?);
            }
        }
        let corners: HashSet<u32> = edges.iter().map(|edge| edge[0]).collect();
        let closed = edges.iter().all(|&[from, to]| edges.contains(&[to, from]));
        // Euler: nodes − edges + faces = 2 for any closed surface without holes.
        let is_ball = closed && corners.len() + faces.len() == edges.len() / 2 + 2;
        (is_ball && faces.len() >= 4).then_some(faces)
    }
}

/// The component of a vector perpendicular to a line with a unit direction.
fn from_line(vector: DVec3, line: DVec3) -> DVec3 {
    vector - line * vector.dot(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;
    use glam::DQuat;

    /// A vector with coordinates from 0 to 1.
    fn place(noise: &mut Noise) -> DVec3 {
        0.5 * noise.vector() + 0.5
    }

    fn volume(points: &[DVec3], faces: &[Vec<u32>]) -> f64 {
        let at = |place: u32| points[place as usize] - points[0];
        let fans = faces.iter().flat_map(|face| (2..face.len()).map(move |n| [face[0], face[n - 1], face[n]]));
        fans.map(|[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
    }

    /// Checks that each edge occurs in both directions, Euler's formula, and that no point is outside.
    fn assert_hull(points: &[DVec3], faces: &[Vec<u32>], slack: f64) {
        assert!(faces.len() >= 4, "{faces:?} of {points:?}");
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for face in faces {
            edges.extend(around(face));
            let at = |n: usize| points[face[n] as usize];
            let (low, high) = bounds(points);
            // The largest triangle of the face determines its normal most precisely.
            let normals = (2..face.len()).map(|n| (at(n - 1) - at(0)).cross(at(n) - at(0)));
            let normal = normals.reduce(|a, b| if b.length() > a.length() { b } else { a }).unwrap().normalize();
            let highest = points.iter().map(|&point| normal.dot(point - at(0))).fold(f64::MIN, f64::max);
            assert!(highest <= slack * (high - low).max_element(), "{highest:e}: {face:?} of {points:?}");
        }
        for &[a, b] in &edges {
            assert_eq!(edges.iter().filter(|&&edge| edge == [b, a]).count(), 1, "{a}-{b} of {faces:?}");
        }
        let mut corners: Vec<_> = edges.iter().map(|edge| edge[0]).collect();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(corners.len() + faces.len(), edges.len() / 2 + 2);
    }

    fn sizes(faces: &[Vec<u32>]) -> Vec<usize> {
        let mut sizes: Vec<_> = faces.iter().map(Vec::len).collect();
        sizes.sort_unstable();
        sizes
    }

    fn all_turns(points: &[DVec3], check: impl Fn(&[DVec3])) {
        let mut noise = Noise(5);
        check(points);
        for scale in [1.0, 1e-9, 1e9] {
            for _ in 0..50 {
                let turn = DQuat::from_vec4((0.5 * noise.vector()).extend(noise.share() + 0.01)).normalize();
                let shift = place(&mut noise) * 3.0;
                check(&points.iter().map(|&point| (turn * point + shift) * scale).collect::<Vec<_>>());
            }
        }
    }

    fn golden() -> f64 {
        (1.0 + 5f64.sqrt()) / 2.0
    }

    fn dodecahedron() -> Vec<DVec3> {
        let (a, b) = (golden(), 1.0 / golden());
        let signs = [-1.0, 1.0];
        let mut points = Vec::new();
        for (x, y) in signs.into_iter().flat_map(|x| signs.map(|y| (x, y))) {
            points.extend(signs.map(|z| DVec3::new(x, y, z)));
            points.extend([
                DVec3::new(0.0, x * b, y * a),
                DVec3::new(x * b, y * a, 0.0),
                DVec3::new(y * a, 0.0, x * b),
            ]);
        }
        points
    }

    #[test]
    fn regular_solids_have_their_faces_however_they_are_turned() {
        let grid = |n: u32| {
            (0..n * n * n).map(move |at| DVec3::new(f64::from(at % n), f64::from(at / n % n), f64::from(at / n / n)))
        };
        let prism = |n: u32| {
            let corner = move |at: u32| {
                let angle = std::f64::consts::TAU * f64::from(at % n) / f64::from(n);
                DVec3::new(angle.cos(), angle.sin(), f64::from(at / n))
            };
            (0..2 * n).map(corner)
        };
        for (points, expected) in [
            (dodecahedron(), vec![5; 12]),
            (grid(2).collect(), vec![4; 6]),
            // Nodes inside faces, along edges and in the middle are not corners.
            (grid(3).collect(), vec![4; 6]),
            (grid(5).collect(), vec![4; 6]),
            (prism(5).collect(), vec![4, 4, 4, 4, 4, 5, 5]),
            (prism(40).collect(), [vec![4; 40], vec![40; 2]].concat()),
            (prism(7).chain([DVec3::new(0.0, 0.0, 2.0)]).collect(), [vec![3; 7], vec![4; 7], vec![7]].concat()),
        ] {
            all_turns(&points, |points| {
                let faces = faces(points);
                assert_eq!(sizes(&faces), expected);
                assert_hull(points, &faces, 1e-6);
                assert!(faces.iter().all(|face| face.iter().min() == face.first()) && faces.is_sorted());
            });
        }
    }

    #[test]
    fn boxes_along_the_axes_have_the_faces_that_are_found_for_any_points() {
        let mut noise = Noise(3);
        for _ in 0..200 {
            let (low, size) = (0.5 * noise.vector(), place(&mut noise) + 0.01);
            let corner = |bit: u32| low + size * DVec3::from_array([0, 1, 2].map(|axis| f64::from(bit >> axis & 1)));
            let mut points: Vec<_> = (0..8).map(corner).collect();
            (1..8).for_each(|at| points.swap(at, noise.below(at)));
            let (low, high) = bounds(&points);
            let size = (high - low).max_element();
            let scaled: Vec<_> = points.iter().map(|&point| (point - low) / size).collect();
            let found = TOLERANCES.into_iter().find_map(|tolerance| Cloud::new(&scaled, tolerance).faces()).unwrap();
            assert_eq!(of_box(&points, low, high), Some(sorted(found)));
        }
    }

    #[test]
    fn the_hull_of_anything_closes_and_holds_everything() {
        let mut noise = Noise(1);
        for case in 0..4000 {
            let count = 4 + case % 23;
            // Coarse grids give many coplanar, collinear and equal points; a little noise at and below the tolerance
            // makes it random which of them count as coplanar.
            let grid = [0.0, 2.0, 3.0, 5.0][case / 2 % 4];
            let shake = [0.0, 1e-16, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3][case % 8];
            let squeeze = [1.0, 1e-2, 1e-4, 3e-6][case / 3 % 4];
            let points: Vec<_> = (0..count)
                .map(|_| {
                    let at = place(&mut noise);
                    let at = if grid > 0.0 { (at * grid).floor() / grid } else { at };
                    (at + 0.5 * noise.vector() * shake) * DVec3::new(1.0, 1.0, squeeze)
                })
                .collect();
            let faces = faces(&points);
            if faces.len() > 1 {
                assert_hull(&points, &faces, 3e-5);
                assert!(volume(&points, &faces) > 0.0);
            } else if grid == 0.0 && squeeze > 1e-3 {
                panic!("{points:?} have no hull");
            }
        }
    }

    #[test]
    fn what_is_flat_has_one_face_and_what_is_on_a_line_none() {
        let plane: Vec<_> = [[0, 0], [2, 0], [3, 1], [2, 3], [1, 1], [0, 3], [-1, 1]]
            .map(|[x, y]| DVec3::new(x.into(), y.into(), 0.0))
            .into();
        all_turns(&plane, |points| assert_eq!(faces(points), [[0, 1, 2, 3, 5, 6]]));
        let mut backwards = plane;
        backwards.reverse();
        all_turns(&backwards, |points| assert_eq!(faces(points), [[0, 1, 3, 4, 5, 6]]));
        let line: Vec<_> = (0..9).map(|at| DVec3::new(1.0, 2.0, -0.5) * f64::from(at * 7 % 9)).collect();
        all_turns(&line, |points| assert!(faces(points).is_empty()));
        assert!(faces(&[DVec3::ONE; 8]).is_empty() && faces(&[]).is_empty());
        assert!(faces(&[DVec3::NAN; 8]).is_empty());
    }

    #[test]
    fn volume_is_that_of_the_solid() {
        let edge = 2.0 / golden();
        let expected = (15.0 + 7.0 * 5f64.sqrt()) / 4.0 * edge * edge * edge;
        let points = dodecahedron();
        assert!((volume(&points, &faces(&points)) / expected - 1.0).abs() < 1e-12);
    }
}
