//! Making a [`Body`] from nodes and elements, with every mistake told in place.

use super::body::Body;
use super::carried::Carried;
use super::element::{Dimension, Solids, around, kind};
use super::fill;
use super::hull::Hulls;
use super::lists::IndexLists;
use super::topology::{Elements, assign_faces};
use glam::DVec3;
use std::sync::Arc;

/// What a [`Body`] is made from. [`Body::builder`] begins it, [`Self::build`] checks it.
#[derive(Clone, Debug)]
pub struct NewBody {
    dimension: Dimension,
    solids: Solids,
    rest: Vec<DVec3>,
    elements: IndexLists,
    masses: Option<Vec<f64>>,
    faces: Option<IndexLists>,
    fill: Option<Vec<f64>>,
    stiffness: Option<Vec<f64>>,
    carried: Option<Arc<Carried>>,
}

/// A mistake in what a body is made from: what was found where, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct BodyError {
    /// What is wrong: a `node`, an `element`, a `face`, a `point`, a `triangle`, or the `body`.
    pub of: &'static str,
    /// Its number, counted from 0.
    pub at: usize,
    /// The mistake.
    pub message: String,
}

impl BodyError {
    fn new(of: &'static str, at: usize, message: String) -> Self {
        Self { of, at, message }
    }

    /// A number of values that is not that of nodes, elements or points.
    fn count(values: &str, found: usize, of: &str, expected: usize) -> Self {
        Self::new("body", 0, format!("there are {found} {values} for {expected} {of}; give one for each"))
    }

    /// An index that is not there.
    fn missing(of: &'static str, at: usize, what: &str, index: u32, last: usize) -> Self {
        Self::new(of, at, format!("{of} {at} names {what} {index}; the last one is {last}"))
    }
}

impl Body {
    /// Begins a body of nodes with these positions at rest (m).
    pub fn builder(rest: Vec<DVec3>) -> NewBody {
        NewBody::new(rest)
    }
}

impl NewBody {
    pub(super) fn new(rest: Vec<DVec3>) -> Self {
        let (dimension, solids, elements) = (Dimension::Space, Solids::Ordered, IndexLists::default());
        let (masses, faces, fill, stiffness, carried) = (None, None, None, None, None);
        Self { dimension, solids, rest, elements, masses, faces, fill, stiffness, carried }
    }

    /// Whether it is in the plane, with all nodes at z = 0, or in space, the default.
    #[must_use]
    pub fn dimension(self, dimension: Dimension) -> Self {
        Self { dimension, ..self }
    }

    /// The nodes of each element, two or more. The kind of an element follows from their number and from [`Self::solids`]; its faces
    /// follow from its kind, or are those of the convex hull of its nodes.
    #[must_use]
    pub fn elements(self, elements: IndexLists) -> Self {
        Self { elements, ..self }
    }

    /// How elements of four, five, six and eight nodes in space are read. Default: [`Solids::Ordered`].
    #[must_use]
    pub fn solids(self, solids: Solids) -> Self {
        Self { solids, ..self }
    }

    /// The mass of each node (kg), above 0. Default: 1 kg.
    #[must_use]
    pub fn masses(self, masses: Vec<f64>) -> Self {
        Self { masses: Some(masses), ..self }
    }

    /// The corners of faces that replace those of the elements. Each is assigned to the element out of which its normal points and the
    /// one into which it points, among the elements that contain all its nodes.
    #[must_use]
    pub fn faces(self, faces: impl Into<Option<IndexLists>>) -> Self {
        Self { faces: faces.into(), ..self }
    }

    /// See [`Body::with_fill`]. Default: all elements are full.
    #[must_use]
    pub fn fill(self, fill: impl Into<Option<Vec<f64>>>) -> Self {
        Self { fill: fill.into(), ..self }
    }

    /// See [`Body::with_stiffness`]. Default: all elements have the stiffness of their model.
    #[must_use]
    pub fn stiffness(self, stiffness: impl Into<Option<Vec<f64>>>) -> Self {
        Self { stiffness: stiffness.into(), ..self }
    }

    /// See [`Body::with_carried`]. Default: none.
    #[must_use]
    pub fn carried(self, carried: impl Into<Option<Arc<Carried>>>) -> Self {
        Self { carried: carried.into(), ..self }
    }

    /// The body.
    ///
    /// # Errors
    /// The first mistake.
    pub fn build(self) -> Result<Body, BodyError> {
        let Self { dimension, solids, rest, elements, masses, faces, fill, stiffness, carried } = self;
        if rest.is_empty() {
            return Err(BodyError::new("body", 0, "a body needs at least one node".to_owned()));
        }
        if rest.len() >= u32::MAX as usize {
            let message = format!("a body has {} nodes; expected at most {}", rest.len(), u32::MAX - 1);
            return Err(BodyError::new("body", 0, message));
        }
        for (node, &place) in rest.iter().enumerate() {
            if !place.is_finite() {
                let message = format!("node {node} is at {place}; expected finite coordinates (m)");
                return Err(BodyError::new("node", node, message));
            }
            if dimension == Dimension::Plane && place.z != 0.0 {
                let z = place.z;
                let message =
                    format!("node {node} of a body in the plane has z = {z} m; expected 0, or a body in space");
                return Err(BodyError::new("node", node, message));
            }
        }
        check_lists("element", &elements, 2, rest.len())?;
        faces.iter().try_for_each(|faces| check_lists("face", faces, 3, rest.len()))?;
        let kinds: Vec<_> = elements.iter().map(|nodes| kind(dimension, solids, nodes.len())).collect();
        let hulls = Hulls::new(&elements, &kinds, &rest);
        let faces = match faces {
            Some(given) => {
                assign_faces(&given, &elements, |face, element| looks_out(face, &elements[element as usize], &rest))
            }
            None => Elements { nodes: &elements, kinds: &kinds, hulls: &hulls, rest: &rest }.shared_faces(),
        };
        let mass = vec![1.0; rest.len()];
        let body = Body {
            dimension,
            rest,
            mass,
            elements,
            kinds,
            hulls,
            faces,
            fill: None,
            stiffness: None,
            modulus: None,
            carried: None,
        };
        let body = if let Some(masses) = masses { body.with_masses(masses)? } else { body };
        body.with_fill(fill)?.with_stiffness(stiffness)?.with_carried(carried)
    }
}

/// Checks the nodes of elements or faces.
fn check_lists(of: &'static str, lists: &IndexLists, least: usize, nodes: usize) -> Result<(), BodyError> {
    let mut last_use = vec![usize::MAX; nodes];
    for (at, list) in lists.iter().enumerate() {
        if list.len() < least {
            let message = format!("{of} {at} has {} nodes; expected at least {least}", list.len());
            return Err(BodyError::new(of, at, message));
        }
        for &node in list {
            match last_use.get_mut(node as usize) {
                None => return Err(BodyError::missing(of, at, "node", node, nodes - 1)),
                Some(last) if *last == at => {
                    return Err(BodyError::new(of, at, format!("{of} {at} names node {node} twice")));
                }
                Some(last) => *last = at,
            }
        }
    }
    Ok(())
}

/// Checks that there is a value in range for each of `count` nodes or elements.
fn check_values(
    [value, values, of, all]: [&'static str; 4],
    given: &[f64],
    count: usize,
    (expected, is_in_range): (&'static str, fn(f64) -> bool),
) -> Result<(), BodyError> {
    if given.len() != count {
        return Err(BodyError::count(values, given.len(), all, count));
    }
    match given.iter().position(|&given| !is_in_range(given)) {
        Some(at) => {
            let message = format!("the {value} of {of} {at} is {}; expected {expected}", given[at]);
            Err(BodyError::new(of, at, message))
        }
        None => Ok(()),
    }
}

/// The range of masses.
const POSITIVE: (&str, fn(f64) -> bool) = ("a finite number above 0", |value| value > 0.0 && value.is_finite());

impl Body {
    /// The same body with other masses of its nodes (kg).
    ///
    /// # Errors
    /// Not one mass for each node, or one that is not above 0.
    pub fn with_masses(self, mass: Vec<f64>) -> Result<Self, BodyError> {
        check_values(["mass", "masses", "node", "nodes"], &mass, self.len(), POSITIVE)?;
        Ok(Self { mass, ..self })
    }

    /// The same body with its elements filled in part: the filled part of the volume of each, above 0 and at most 1. Its stiffness and its
    /// damping are in proportion; its share in the masses of its nodes has to be, and then it does not shorten the stable step. `None` if
    /// all are full.
    ///
    /// # Errors
    /// Not one part for each element, or one out of range.
    pub fn with_fill(self, fill: impl Into<Option<Vec<f64>>>) -> Result<Self, BodyError> {
        let fill = fill.into();
        if let Some(fill) = &fill {
            let range = ("a part above 0 and up to 1", (|part| part > 0.0 && part <= 1.0) as fn(f64) -> bool);
            check_values(["filled part", "filled parts", "element", "elements"], fill, self.elements.len(), range)?;
        }
        Ok(Self { fill, ..self })
    }

    /// The same body with the stiffness and the damping of each element, if it is full, relative to those of the model; `None` if all are 1.
    /// Elements of one material and different sizes differ in it.
    ///
    /// # Errors
    /// Not one stiffness for each element, or one below 0.
    pub fn with_stiffness(self, stiffness: impl Into<Option<Vec<f64>>>) -> Result<Self, BodyError> {
        let stiffness = stiffness.into();
        if let Some(stiffness) = &stiffness {
            let names = ["relative stiffness", "relative stiffnesses", "element", "elements"];
            let range =
                ("a finite number of 0 or more", (|value| value >= 0.0 && value.is_finite()) as fn(f64) -> bool);
            check_values(names, stiffness, self.elements.len(), range)?;
        }
        Ok(Self { stiffness, ..self })
    }

    /// The same body of several materials: the modulus and the damping of the material of each element, relative to those of the model. The
    /// [relative stiffness](Self::stiffness) is multiplied by it.
    ///
    /// # Errors
    /// Not one modulus for each element, or one that is not above 0.
    pub fn with_modulus(self, modulus: Vec<f64>) -> Result<Self, BodyError> {
        let names = ["relative modulus", "relative moduli", "element", "elements"];
        check_values(names, &modulus, self.elements.len(), POSITIVE)?;
        let stiffness = fill::product(self.stiffness.as_deref(), Some(&modulus));
        Ok(Self { modulus: Some(modulus), stiffness, ..self })
    }

    /// The same body with a fine surface that it carries, or none.
    ///
    /// # Errors
    /// Not one weighted mean for each point, one of nodes that are not there, and triangles of points that are not there.
    pub fn with_carried(self, carried: impl Into<Option<Arc<Carried>>>) -> Result<Self, BodyError> {
        let carried = carried.into();
        if let Some(Carried { rest, triangles, weights }) = carried.as_deref() {
            let (points, last) = (rest.len(), self.len() - 1);
            if weights.len() != points {
                return Err(BodyError::count("weighted means", weights.len(), "points", points));
            }
            for (at, triangle) in triangles.iter().enumerate() {
                if let Some(&index) = triangle.iter().find(|&&point| point as usize >= points) {
                    return Err(BodyError::missing("triangle", at, "point", index, points.saturating_sub(1)));
                }
            }
            for at in 0..points {
                let (nodes, parts) = weights.of(at);
                if let Some(&index) = nodes.iter().find(|&&node| node as usize > last) {
                    return Err(BodyError::missing("point", at, "node", index, last));
                }
                if let Some(part) = parts.iter().find(|part| !part.is_finite()) {
                    let message = format!("a weight of point {at} is {part}; expected a finite number");
                    return Err(BodyError::new("point", at, message));
                }
            }
        }
        Ok(Self { carried, ..self })
    }
}

/// Whether the normal of a face points out of an element at rest. It does for an element in the plane of the face.
fn looks_out(face: &[u32], element: &[u32], rest: &[DVec3]) -> bool {
    let mean = |nodes: &[u32]| nodes.iter().map(|&node| rest[node as usize]).sum::<DVec3>() / nodes.len() as f64;
    let middle = mean(face);
    let at = |node: u32| rest[node as usize] - middle;
    let area: DVec3 = around(face).map(|[a, b]| at(a).cross(at(b))).sum();
    let inwards = mean(element) - middle;
    area.dot(inwards) <= 1e-9 * area.length() * inwards.length()
}
