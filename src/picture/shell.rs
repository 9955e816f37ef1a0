//! The faces that bound a set of elements, found without testing all faces.

use crate::sim::Body;

/// The faces sorted once for all frames.
#[derive(Debug, Default)]
pub(super) struct Shell {
    /// The faces that lie on the outside of the body, in rising order.
    outside: Vec<u32>,
    /// The faces between two elements, grouped by element, in rising order.
    between: Vec<u32>,
    /// The index in `between` where the faces of each element begin, and the end of the last ones.
    starts: Vec<u32>,
}

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

impl Shell {
    /// The shell of a body.
    pub(super) fn new(body: &Body) -> Self {
        let sides = || (0u32..).zip(body.faces.inner.iter().zip(&body.faces.outer));
        let outside = sides().filter(|(_, (inner, outer))| inner.is_none() || outer.is_none()).map(|(face, _)| face);
        let pairs = || sides().filter_map(|(face, (&inner, &outer))| Some((face, [inner?, outer?])));
        let mut starts = vec![0; body.elements.len() + 1];
        pairs().for_each(|(_, pair)| pair.iter().for_each(|&element| starts[element as usize + 1] += 1));
        let mut sum = 0;
        starts.iter_mut().for_each(|start| {
            sum += *start;
            *start = sum;
        });
        let (mut between, mut next) = (vec![0; sum as usize], starts.clone());
        for (face, pair) in pairs() {
            for element in pair {
                between[next[element as usize] as usize] = face;
                next[element as usize] += 1;
            }
        }
        Self { outside: outside.collect(), between, starts }
    }

    /// The boundaries of the elements that kept their sign and of the elements that turned over.
    ///
    /// A face bounds a set if exactly one of its two sides belongs to it. A side without an element is outside of every
    /// set; a face without any element bounds the first set.
    pub(super) fn boundaries(&self, body: &Body, turned_over: &[bool]) -> [Vec<Side>; 2] {
        let is_over = |element: u32| turned_over.get(element as usize).copied().unwrap_or(false);
        let elements = (0u32..).zip(turned_over).take(self.starts.len() - 1);
        let mut between: Vec<u32> = Vec::new();
        for (element, _) in elements.filter(|(_, over)| **over) {
            let [from, to] = [element, element + 1].map(|at| self.starts[at as usize] as usize);
            between.extend(self.between[from..to].iter().filter(|&&face| {
                let sides = [body.faces.inner[face as usize], body.faces.outer[face as usize]];
                // Seen from the other side, its element is not turned over.
                !sides.into_iter().flatten().all(is_over)
            }));
        }
        between.sort_unstable();
        let mut sets = [Vec::with_capacity(self.outside.len() + between.len()), Vec::new()];
        let mut between = between.into_iter().peekable();
        let mut outside = self.outside.iter().copied().peekable();
        // Both lists are in the order of the body's faces.
        while let Some(face) = match (outside.peek(), between.peek()) {
            (Some(one), Some(other)) if one < other => outside.next(),
            (Some(_), None) => outside.next(),
            _ => between.next(),
        } {
            let [inner, outer] = [body.faces.inner[face as usize], body.faces.outer[face as usize]];
            if let Some(element) = inner {
                sets[usize::from(is_over(element))].push(Side { face, reversed: false, element: inner });
            }
            if let Some(element) = outer {
                sets[usize::from(is_over(element))].push(Side { face, reversed: true, element: outer });
            }
            if inner.is_none() && outer.is_none() {
                sets[0].push(Side { face, reversed: false, element: None });
            }
        }
        sets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Dimension, IndexLists, Solids};
    use glam::DVec3;

    /// The boundary by its definition, face by face.
    fn by_definition(body: &Body, turned_over: &[bool], over: bool) -> Vec<Side> {
        let inside = |element: Option<u32>| element.is_some_and(|at| turned_over[at as usize] == over);
        let faces = (0u32..).zip(body.faces.inner.iter().zip(&body.faces.outer));
        let bounding = faces.filter_map(|(face, (&inner, &outer))| match (inside(inner), inside(outer)) {
            (true, false) => Some(Side { face, reversed: false, element: inner }),
            (false, true) => Some(Side { face, reversed: true, element: outer }),
            _ if inner.is_none() && outer.is_none() && !over => Some(Side { face, reversed: false, element: None }),
            _ => None,
        });
        bounding.collect()
    }

    #[test]
    fn boundaries_are_those_that_going_through_all_faces_finds() {
        let rest: Vec<_> =
            (0..64u32).map(|at| DVec3::new(f64::from(at % 4), f64::from(at / 4 % 4), f64::from(at / 16))).collect();
        let corner =
            |cell: u32, at: u32| cell % 3 + (at & 1) + 4 * (cell / 3 % 3 + (at >> 1 & 1)) + 16 * (cell / 9 + (at >> 2));
        let lists: Vec<[u32; 8]> = (0..27).map(|cell| std::array::from_fn(|at| corner(cell, at as u32))).collect();
        let elements: IndexLists = lists.iter().map(|list| &list[..]).collect();
        let given: IndexLists = [&[0, 4, 5, 1][..], &[0, 1, 5, 4], &[1, 5, 21, 17], &[0, 1, 63]].into_iter().collect();
        for faces in [None, Some(&given)] {
            let mass = vec![1.0; rest.len()];
            let body = Body::new(Dimension::Space, rest.clone(), mass, elements.clone(), Solids::Ordered, faces);
            let shell = Shell::new(&body);
            for seed in 0..40u64 {
                let over: Vec<_> = (0..27).map(|at| ((seed * seed * 0x9e37_79b9) >> at) & 3 == 1).collect();
                let [sound, turned] = shell.boundaries(&body, &over);
                assert_eq!(sound, by_definition(&body, &over, false), "{seed}");
                assert_eq!(turned, by_definition(&body, &over, true), "{seed}");
            }
            // An unknown element counts as not turned over.
            assert_eq!(shell.boundaries(&body, &[]), shell.boundaries(&body, &[false; 27]));
        }
    }
}
