//! The faces that bound a set of elements.

use crate::sim::Body;

/// A face that bounds a set of elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Side {
    /// Its place among the faces of the body.
    pub(super) face: u32,
    /// Whether its corners are in reverse order when it is seen from outside of the set.
    pub(super) reversed: bool,
    /// Its element in the set.
    pub(super) element: Option<u32>,
}

/// The boundaries of the elements that kept their sign and of the elements that turned over.
///
/// A face bounds a set if exactly one of its two sides belongs to it. A side without an element is outside of every
/// set; a face without any element bounds the first set.
pub(super) fn boundaries(body: &Body, turned_over: &[bool]) -> [Vec<Side>; 2] {
    let set = |element: u32| usize::from(turned_over.get(element as usize).copied().unwrap_or(false));
    let mut sets = [Vec::new(), Vec::new()];
    for (face, (&inner, &outer)) in (0..).zip(body.faces.inner.iter().zip(&body.faces.outer)) {
        if inner.is_none() && outer.is_none() {
            sets[0].push(Side { face, reversed: false, element: None });
        } else if inner.map(set) != outer.map(set) {
            for (element, reversed) in [(inner, false), (outer, true)] {
                sets[element.map_or(0, set)].extend(element.map(|_| Side { face, reversed, element }));
            }
        }
    }
    sets
}
