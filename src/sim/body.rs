//! What is simulated: a [`Body`], which never changes, and its [`State`], which does.

use super::topology;
use glam::DVec3;

/// Whether a body lives in the plane or in space.
///
/// A body in the plane is stored with `z = 0`, moves in the xy-plane only and is drawn flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Two coordinates; elements are polygons, listed counter-clockwise.
    Plane,
    /// Three coordinates.
    Space,
}

/// What an element is, which decides its faces, its edges and how its volume is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// Two nodes.
    Segment,
    /// Three or more nodes in the plane, counter-clockwise.
    Polygon,
    /// Four nodes in space; node 3 lies on the side to which the triangle 0, 1, 2 turns counter-clockwise.
    Tetrahedron,
    /// Five nodes in space: a quadrilateral 0, 1, 2, 3 in order around, and the apex 4.
    Pyramid,
    /// Six nodes in space: a triangle 0, 1, 2 and the opposite one 3, 4, 5.
    Wedge,
    /// Eight nodes in space in bit order: x fastest, then y, then z.
    Hexahedron,
    /// Any other number of nodes in space. It has elasticity, but no faces and no edges of its own.
    Other,
}

/// Lists of indices of varying length, stored one behind the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexLists {
    offsets: Vec<u32>,
    indices: Vec<u32>,
}

impl Default for IndexLists {
    fn default() -> Self {
        Self { offsets: vec![0], indices: Vec::new() }
    }
}

impl IndexLists {
    /// Appends one list.
    pub fn push(&mut self, list: &[u32]) {
        self.indices.extend_from_slice(list);
        self.offsets.push(u32::try_from(self.indices.len()).expect("fewer than 2^32 indices"));
    }

    /// The number of lists.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no list at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where list `at` stands in [`Self::indices`].
    pub fn range(&self, at: usize) -> std::ops::Range<usize> {
        self.offsets[at] as usize..self.offsets[at + 1] as usize
    }

    /// All indices, list after list.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// The lists in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.len()).map(|at| &self[at])
    }
}

impl std::ops::Index<usize> for IndexLists {
    type Output = [u32];
    fn index(&self, at: usize) -> &[u32] {
        &self.indices[self.range(at)]
    }
}

impl<'a> FromIterator<&'a [u32]> for IndexLists {
    fn from_iter<I: IntoIterator<Item = &'a [u32]>>(lists: I) -> Self {
        let mut all = Self::default();
        for list in lists {
            all.push(list);
        }
        all
    }
}

/// The faces of a body, each stored once, whether inside it or on its surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faces {
    /// The corners of each face, counter-clockwise seen from outside the element it is [`Self::inner`] of.
    pub nodes: IndexLists,
    /// The element that the face bounds and looks out of; `None` for a face given without one.
    pub inner: Vec<Option<u32>>,
    /// The element on the other side, into which the face looks; `None` on the surface of the body.
    pub outer: Vec<Option<u32>>,
}

/// A deformable body as it is at rest. It never changes during a simulation and all runs of a scene share it.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// In the plane or in space.
    pub dimension: Dimension,
    /// Rest position of each node (m).
    pub rest: Vec<DVec3>,
    /// Mass of each node (kg), positive.
    pub mass: Vec<f64>,
    /// The nodes of each element, two or more.
    pub elements: IndexLists,
    /// What each element is.
    pub kinds: Vec<ElementKind>,
    /// What can be drawn.
    pub faces: Faces,
}

impl Body {
    /// Builds a body from its nodes and elements; kinds and faces follow from the number of nodes of each element.
    ///
    /// `faces`, when given, are drawn instead of the elements' own; each belongs to the first element that
    /// holds all its nodes.
    ///
    /// # Panics
    /// If an index is out of range or the lengths of `rest` and `mass` differ: the caller has checked its input.
    pub fn new(
        dimension: Dimension,
        rest: Vec<DVec3>,
        mass: Vec<f64>,
        elements: IndexLists,
        faces: Option<&IndexLists>,
    ) -> Self {
        assert_eq!(rest.len(), mass.len(), "one mass per node");
        assert!(elements.indices().iter().all(|&node| (node as usize) < rest.len()), "node indices in range");
        let kinds: Vec<_> = elements.iter().map(|nodes| topology::kind(dimension, nodes.len())).collect();
        let faces = match faces {
            Some(given) => topology::assign_faces(given, &elements),
            None => topology::shared_faces(&elements, &kinds),
        };
        Self { dimension, rest, mass, elements, kinds, faces }
    }

    /// The number of nodes.
    pub fn len(&self) -> usize {
        self.rest.len()
    }

    /// Whether the body has no node.
    pub fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// The largest side of the box around the body at rest (m).
    pub fn extent(&self) -> f64 {
        let (low, high) = bounds(&self.rest);
        (high - low).max_element()
    }
}

/// The corners of the box around `points`, low and high; zero for no points.
pub fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let Some(&first) = points.first() else { return (DVec3::ZERO, DVec3::ZERO) };
    points.iter().fold((first, first), |(low, high), &point| (low.min(point), high.max(point)))
}

/// The positions (m) and velocities (m/s) of a body's nodes at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Position of each node (m).
    pub position: Vec<DVec3>,
    /// Velocity of each node (m/s).
    pub velocity: Vec<DVec3>,
}

impl State {
    /// The nodes at `position`, at rest.
    pub fn at_rest(position: Vec<DVec3>) -> Self {
        let velocity = vec![DVec3::ZERO; position.len()];
        Self { position, velocity }
    }

    /// Whether every coordinate of every position and velocity is a finite number.
    pub fn is_finite(&self) -> bool {
        self.position.iter().chain(&self.velocity).all(|v| v.is_finite())
    }
}
