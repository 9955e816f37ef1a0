//! The faces and edges of a body's elements, and the springs made from them.

use super::alike::Alike;
use super::element::{ElementKind, around, edge_table, for_each_face, ordered};
use super::hull::Hulls;
use super::lists::IndexLists;
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::HashMap;

/// The faces of a body, each stored once, whether inside it or on its surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faces {
    /// The corners of each face, counter-clockwise seen from outside its [`Self::inner`] element.
    pub nodes: IndexLists,
    /// The element that the face bounds, with the face normal pointing out of it; `None` for a listed face without one.
    pub inner: Vec<Option<u32>>,
    /// The element on the other side, into which the normal points; `None` on the surface of the body.
    pub outer: Vec<Option<u32>>,
}

impl Faces {
    /// Appends the faces of another body, whose nodes and elements are counted from the given ones.
    pub(crate) fn append(&mut self, others: &Self, node: u32, element: u32) {
        self.nodes.append(&others.nodes, node);
        let moved = |side: &Option<u32>| side.map(|other| element + other);
        self.inner.extend(others.inner.iter().map(moved));
        self.outer.extend(others.outer.iter().map(moved));
    }
}

/// The elements of a body with the faces of each.
#[derive(Clone, Copy, Debug)]
pub struct Elements<'a> {
    /// The nodes of each element.
    pub nodes: &'a IndexLists,
    /// The kind of each element.
    pub kinds: &'a [ElementKind],
    /// The faces of the elements of kind [`ElementKind::Other`].
    pub hulls: &'a Hulls,
    /// Rest position of each node (m).
    pub rest: &'a [DVec3],
}

impl Elements<'_> {
    /// Calls `visit` with the nodes of each face of one element, counter-clockwise seen from outside.
    pub fn for_each_face(&self, element: usize, visit: impl FnMut(&[u32])) {
        match self.kinds[element] {
            ElementKind::Other => self.hulls.of(element).for_each(visit),
            kind => for_each_face(kind, &self.nodes[element], visit),
        }
    }

    /// The edges of one element as pairs of nodes, smaller node first, in rising order.
    pub fn edges_of(&self, element: usize) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        self.for_each_edge(element, |edge| edges.push(edge));
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Calls `visit` with each edge of one element, smaller node first; some edges of a hull are visited twice.
    fn for_each_edge(&self, element: usize, mut visit: impl FnMut([u32; 2])) {
        let nodes = &self.nodes[element];
        match self.kinds[element] {
            ElementKind::Polygon | ElementKind::Other => {
                self.for_each_face(element, |face| around(face).map(ordered).for_each(&mut visit));
            }
            kind => edge_table(kind).iter().for_each(|edge| visit(ordered(edge.map(|at| nodes[at as usize])))),
        }
    }

    /// Whether an element is a single face, which bounds no volume.
    pub fn is_flat(&self, element: usize) -> bool {
        match self.kinds[element] {
            ElementKind::Polygon | ElementKind::Triangle => true,
            ElementKind::Other => self.hulls.of(element).len() == 1,
            _ => false,
        }
    }

    /// Every face of the elements once, with the elements on its two sides. Sorted by element, then as in the table of
    /// its kind.
    pub fn shared_faces(&self) -> Faces {
        let mut faces = Faces::default();
        // Faces without an element on their other side so far. An element that is a single face shares it with no other
        // element.
        let mut waiting = Alike::new(self.rest.len());
        for (owner, element) in (0u32..).zip(0..self.nodes.len()) {
            let is_flat = self.is_flat(element);
            self.for_each_face(element, |face| {
                if !is_flat {
                    if let Some(first) = waiting.take(face, |first| &faces.nodes[first]) {
                        faces.outer[first] = Some(owner);
                        return;
                    }
                    waiting.put(faces.nodes.len(), face);
                }
                faces.nodes.push(face);
                faces.inner.push(Some(owner));
                faces.outer.push(None);
            });
        }
        faces
    }

    /// The springs of a named topology on all elements: each pair once, smaller node first, in rising order.
    pub fn springs(&self, topology: Springs) -> Vec<[u32; 2]> {
        // Counting sort by the first node; the few springs of each node are then sorted by the second one.
        let mut ends = vec![0; self.rest.len() + 1];
        self.for_each_spring(topology, |[first, _]| ends[first as usize + 1] += 1);
        for node in 0..self.rest.len() {
            ends[node + 1] += ends[node];
        }
        let mut seconds = vec![0; ends[self.rest.len()]];
        // Where the next spring of each first node is stored; after the loop, where the springs of the node end.
        self.for_each_spring(topology, |[first, second]| {
            let next = &mut ends[first as usize];
            seconds[*next] = second;
            *next += 1;
        });
        let mut pairs = Vec::new();
        let mut start = 0;
        for (first, &end) in (0u32..).zip(&ends[..self.rest.len()]) {
            let own = &mut seconds[start..end];
            own.sort_unstable();
            pairs.extend(own.chunk_by(u32::eq).map(|equal| [first, equal[0]]));
            start = end;
        }
        pairs
    }

    /// The diagonals of a polygon from one corner: one for a quadrilateral, none for a triangle.
    ///
    /// The corner is the one with the least coordinates at rest (x, then y, then z), so that the springs do not depend
    /// on the numbering of nodes.
    fn fan<'f>(&self, face: &'f [u32]) -> impl Iterator<Item = [u32; 2]> + 'f {
        let least = |&one: &usize, &other: &usize| {
            let [one, other] = [face[one], face[other]].map(|node| (self.rest[node as usize].to_array(), node));
            one.partial_cmp(&other).unwrap_or(Ordering::Equal)
        };
        let hub = (0..face.len()).min_by(least).unwrap_or(0);
        (2..face.len().saturating_sub(1)).map(move |step| ordered([face[hub], face[(hub + step) % face.len()]]))
    }

    /// Calls `visit` with the springs of all elements, some of them more than once.
    fn for_each_spring(&self, topology: Springs, mut visit: impl FnMut([u32; 2])) {
        (0..self.nodes.len()).for_each(|element| self.for_each_spring_of(topology, element, &mut visit));
    }

    /// Calls `visit` with the springs of one element, some of them more than once.
    fn for_each_spring_of(&self, topology: Springs, element: usize, mut visit: impl FnMut([u32; 2])) {
        let (nodes, kind) = (&self.nodes[element], self.kinds[element]);
        if topology == Springs::All {
            return every_pair(nodes).for_each(visit);
        }
        self.for_each_edge(element, &mut visit);
        match topology {
            Springs::Edges | Springs::All => {}
            Springs::EdgesOneDiagonal if kind == ElementKind::Hexahedron => {
                // Section 3.6 of the paper does not state which diagonals Fig. 4(b) has; this choice reproduces its
                // result.
                every_pair(&[0, 3, 5, 6].map(|at: usize| nodes[at])).for_each(visit);
            }
            Springs::EdgesOneDiagonal => self.for_each_face(element, |face| self.fan(face).for_each(&mut visit)),
            Springs::EdgesFaceDiagonals => self.for_each_face(element, |face| diagonals(face).for_each(&mut visit)),
            // All corners of a polygon share its only face.
            Springs::EdgesBodyDiagonals if kind == ElementKind::Polygon => {}
            Springs::EdgesBodyDiagonals => {
                let mut in_faces = Vec::new();
                self.for_each_face(element, |face| in_faces.extend(every_pair(face)));
                in_faces.sort_unstable();
                every_pair(nodes).filter(|pair| in_faces.binary_search(pair).is_err()).for_each(visit);
            }
        }
    }
}

/// The diagonals of a polygon: every pair of corners that are not neighbours around it.
fn diagonals(face: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let last = face.len() - 1;
    (2..face.len()).flat_map(move |a| (0..a - 1).map(move |b| [a, b])).filter_map(move |[a, b]| {
        let are_neighbours = a == last && b == 0;
        (!are_neighbours).then(|| ordered([face[a], face[b]]))
    })
}

/// Every pair of a list, smaller node first.
fn every_pair(nodes: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..nodes.len()).flat_map(move |a| (0..a).map(move |b| ordered([nodes[a], nodes[b]])))
}

/// Listed faces, each with the elements that contain all its nodes: the first element out of which its normal points,
/// and the first one into which it points. `looks_out` returns whether the normal points out of an element.
pub(crate) fn assign_faces(
    given: &IndexLists,
    elements: &IndexLists,
    looks_out: impl Fn(&[u32], u32) -> bool,
) -> Faces {
    let mut elements_of_node: HashMap<u32, Vec<u32>> = HashMap::new();
    for (element, nodes) in (0u32..).zip(elements.iter()) {
        for &node in nodes {
            elements_of_node.entry(node).or_default().push(element);
        }
    }
    let mut faces = Faces { nodes: given.clone(), ..Faces::default() };
    for face in given.iter() {
        let (mut inner, mut outer) = (None, None);
        let candidates = face.first().and_then(|node| elements_of_node.get(node)).into_iter().flatten();
        for &element in candidates.filter(|&&e| face.iter().all(|node| elements[e as usize].contains(node))) {
            let side = if looks_out(face, element) { &mut inner } else { &mut outer };
            side.get_or_insert(element);
        }
        faces.inner.push(inner);
        faces.outer.push(outer);
    }
    faces
}

/// Which springs a named topology puts on an element (paper, sections 2 and 3; Fig. 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
pub enum Springs {
    /// One spring on each edge.
    #[cfg_attr(feature = "scene", serde(rename = "edges"))]
    Edges,
    /// Edges and one diagonal of each face, as drawn in Fig. 4(b). On a hexahedron the diagonals are the six edges of
    /// the tetrahedron on corners 0, 3, 5, 6, so that faces between elements have both. On another quadrilateral the
    /// diagonal starts at the corner with the least coordinates at rest (x, then y, then z). A face of more corners has
    /// all diagonals from that corner.
    #[cfg_attr(feature = "scene", serde(rename = "edges+one-diagonal"))]
    EdgesOneDiagonal,
    /// Edges and both diagonals of each face.
    #[cfg_attr(feature = "scene", serde(rename = "edges+face-diagonals"))]
    EdgesFaceDiagonals,
    /// Edges and the diagonals through the element: pairs of nodes that share no face.
    #[cfg_attr(feature = "scene", serde(rename = "edges+body-diagonals"))]
    EdgesBodyDiagonals,
    /// Every pair of nodes of an element.
    #[cfg_attr(feature = "scene", serde(rename = "all"))]
    All,
}

impl Springs {
    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Edges => "edges",
            Self::EdgesOneDiagonal => "edges+one-diagonal",
            Self::EdgesFaceDiagonals => "edges+face-diagonals",
            Self::EdgesBodyDiagonals => "edges+body-diagonals",
            Self::All => "all",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::LazyLock;

    /// Elements whose kinds have tables of faces.
    fn elements<'a>(nodes: &'a IndexLists, kinds: &'a [ElementKind]) -> Elements<'a> {
        static NONE: LazyLock<Hulls> = LazyLock::new(Hulls::default);
        Elements { nodes, kinds, hulls: &NONE, rest: &[DVec3::ZERO; 16] }
    }

    #[test]
    fn a_cube_has_the_springs_that_each_name_says() {
        let nodes: IndexLists = [&[0, 1, 2, 3, 4, 5, 6, 7][..]].into_iter().collect();
        let count = |topology| elements(&nodes, &[ElementKind::Hexahedron]).springs(topology).len();
        assert_eq!(count(Springs::Edges), 12);
        assert_eq!(count(Springs::EdgesOneDiagonal), 12 + 6);
        assert_eq!(count(Springs::EdgesFaceDiagonals), 12 + 12);
        assert_eq!(count(Springs::EdgesBodyDiagonals), 12 + 4);
        assert_eq!(count(Springs::All), 28);
    }

    #[test]
    fn closed_elements_have_each_edge_in_both_directions() {
        for (kind, nodes) in [
            (ElementKind::Tetrahedron, 4),
            (ElementKind::Pyramid, 5),
            (ElementKind::Wedge, 6),
            (ElementKind::Hexahedron, 8),
        ] {
            let own: Vec<u32> = (0..nodes).collect();
            let lists = [own.as_slice()].into_iter().collect();
            let kinds = [kind];
            let element = elements(&lists, &kinds);
            let mut faces: Vec<Vec<u32>> = Vec::new();
            element.for_each_face(0, |face| faces.push(face.to_vec()));
            let directed: Vec<_> = faces.iter().flat_map(|face| around(face)).collect();
            for &[a, b] in &directed {
                assert_eq!(directed.iter().filter(|&&edge| edge == [b, a]).count(), 1, "{kind:?} {a}-{b}");
            }
            let mut sides: Vec<_> = directed.iter().map(|&side| ordered(side)).collect();
            sides.sort_unstable();
            sides.dedup();
            assert_eq!(element.edges_of(0), sides, "{kind:?}");
            // Euler: nodes − edges + faces = 2 for any closed surface without holes.
            assert_eq!(own.len() + faces.len(), element.edges_of(0).len() + 2, "{kind:?}");
        }
    }

    #[test]
    fn neighbours_share_one_face() {
        let two = [&[0, 1, 3, 4, 6, 7, 9, 10][..], &[1, 2, 4, 5, 7, 8, 10, 11]].into_iter().collect();
        let faces = elements(&two, &[ElementKind::Hexahedron; 2]).shared_faces();
        assert_eq!(faces.nodes.len(), 11);
        assert_eq!(faces.outer.iter().flatten().collect::<Vec<_>>(), [&1]);
    }
}
