//! What is simulated: a [`Body`], which never changes, and its [`State`], which does.

pub use super::lists::IndexLists;
use super::topology;
pub use super::topology::{Dimension, ElementKind, Faces};
use glam::DVec3;

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
}
