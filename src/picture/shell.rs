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
/// A face bounds a set if exactly one of its two sides belongs to it. A side without an element, or with a broken one, is outside of every
/// set; a face that never had an element bounds the first set.
pub(super) fn boundaries(body: &Body, turned_over: &[bool], broken: &[bool]) -> [Vec<Side>; 2] {
    let whole = |side: Option<u32>| side.filter(|&element| !is_broken(broken, element));
    let set = |element: u32| usize::from(turned_over.get(element as usize).copied().unwrap_or(false));
    let mut sets = [Vec::new(), Vec::new()];
    for (face, (&inner, &outer)) in (0..).zip(body.faces().inner.iter().zip(&body.faces().outer)) {
        if inner.is_none() && outer.is_none() {
            sets[0].push(Side { face, reversed: false, element: None });
            continue;
        }
        let (inner, outer) = (whole(inner), whole(outer));
        if inner.map(set) != outer.map(set) {
            for (element, reversed) in [(inner, false), (outer, true)] {
                sets[element.map_or(0, set)].extend(element.map(|_| Side { face, reversed, element }));
            }
        }
    }
    sets
}

/// The triangles of faces, as nodes.
pub(super) fn triangles(body: &Body, sides: &[Side]) -> Vec<[u32; 3]> {
    let of_side = |side: &Side| {
        let (nodes, reversed) = (&body.faces().nodes[side.face as usize], side.reversed);
        (2..nodes.len()).map(move |at| {
            let [a, b, c] = [nodes[0], nodes[at - 1], nodes[at]];
            if reversed { [a, c, b] } else { [a, b, c] }
        })
    };
    sides.iter().flat_map(of_side).collect()
}

/// Whether an element is among the broken ones.
pub(super) fn is_broken(broken: &[bool], element: u32) -> bool {
    broken.get(element as usize).copied().unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn broken_elements_uncover_the_faces_of_their_neighbours() {
        // Three cubes in a row.
        let corner = |at: usize| DVec3::new((at / 4) as f64, (at / 2 % 2) as f64, (at % 2) as f64);
        let cube = |at: u32| [0, 4, 2, 6, 1, 5, 3, 7].map(|corner| 4 * at + corner);
        let (rest, cubes) = ((0..16).map(corner).collect(), [0, 1, 2].map(cube));
        let elements = cubes.iter().map(|cube| &cube[..]).collect();
        let body = Body::builder(rest).elements(elements).build().expect("a body");
        let count = |turned_over: &[bool], broken: &[bool]| boundaries(&body, turned_over, broken).map(|set| set.len());
        assert_eq!(count(&[], &[]), [14, 0]);
        assert_eq!(count(&[], &[false, true, false]), [12, 0]);
        assert_eq!(count(&[], &[true, false, false]), [10, 0]);
        assert_eq!(count(&[], &[true; 3]), [0, 0]);
        // A broken element belongs to no set, turned over or not.
        assert_eq!(count(&[true, true, false], &[false, true, false]), [6, 6]);
        let uncovered = &boundaries(&body, &[], &[false, true, true])[0];
        assert_eq!(uncovered.iter().filter(|side| side.element != Some(0)).count(), 0);
    }
}
