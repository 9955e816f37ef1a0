//! The elements and springs of a body that are broken.

use super::body::Body;
use super::model::ElasticModel;
use std::sync::Arc;

/// Where the memory of a model tells which elements or springs are broken.
pub(crate) struct Broken {
    body: Arc<Body>,
    /// Numbers in the memory for each of them, the last of which tells it.
    width: usize,
    /// The springs, if it is these that break.
    springs: Vec<[u32; 2]>,
}

impl Broken {
    /// `None` for a model whose parts never break.
    pub(crate) fn new(model: &dyn ElasticModel, body: &Arc<Body>) -> Option<Self> {
        let width = model.properties(body).breakable?;
        Some(Self { body: Arc::clone(body), width, springs: model.springs().to_vec() })
    }

    /// Whether each spring is broken, or each element of a model without springs.
    pub(crate) fn of(&self, memory: &[f64]) -> impl Iterator<Item = bool> {
        let count = if self.springs.is_empty() { self.body.elements.len() } else { self.springs.len() };
        memory.chunks_exact(self.width).take(count).map(|numbers| numbers.last() == Some(&1.0))
    }

    /// Whether each spring is broken; none for a model without springs.
    pub(crate) fn springs(&self, memory: &[f64]) -> Vec<bool> {
        if self.springs.is_empty() { Vec::new() } else { self.of(memory).collect() }
    }

    /// Whether each element is broken. An element of springs is if those between its nodes no longer hold all its nodes together, and some of
    /// them are broken.
    pub(crate) fn elements(&self, memory: &[f64]) -> Vec<bool> {
        if self.springs.is_empty() {
            return self.of(memory).collect();
        }
        let broken: Vec<_> = self.of(memory).collect();
        let mut apart = vec![false; self.body.elements.len()];
        if !broken.contains(&true) {
            return apart;
        }
        let ends = self.springs.iter().map(|ends| ends.map(|node| node as usize));
        let mut of_node = vec![Vec::new(); self.body.len()];
        ends.zip(broken).for_each(|([one, other], broken)| of_node[one].push((other, broken)));
        for (nodes, apart) in self.body.elements.iter().zip(&mut apart) {
            let place = |node: usize| nodes.iter().position(|&own| own as usize == node);
            // The first of the nodes that are held together with each.
            let mut first: Vec<usize> = (0..nodes.len()).collect();
            let mut has_broken = false;
            for (one, &node) in nodes.iter().enumerate() {
                for &(other, broken) in &of_node[node as usize] {
                    let Some(other) = place(other) else { continue };
                    has_broken |= broken;
                    let [low, high] = [first[one].min(first[other]), first[one].max(first[other])];
                    if !broken {
                        first.iter_mut().filter(|first| **first == high).for_each(|first| *first = low);
                    }
                }
            }
            *apart = has_broken && first.iter().any(|&first| first != 0);
        }
        apart
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Dimension;
    use crate::model::mass_spring::MassSpring;
    use glam::DVec3;

    #[test]
    fn an_element_is_broken_once_its_springs_do_not_hold_it_together() {
        // Two squares side by side.
        let rest = (0..6).map(|at| DVec3::new(f64::from(at / 2), f64::from(at % 2), 0.0)).collect();
        let elements = [&[0, 2, 3, 1][..], &[2, 4, 5, 3]].into_iter().collect();
        let body =
            Arc::new(Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a body"));
        let springs = [[0, 1], [0, 2], [1, 3], [2, 3], [2, 4], [3, 5], [4, 5]].into();
        let model = MassSpring { stiffness: 1.0, damping: 0.0, springs, breaks_at: Some(0.1) };
        let broken = Broken::new(&model, &body).expect("springs that break");
        let after = |gone: &[usize]| {
            let memory: Vec<_> = (0..7).map(|at| f64::from(u8::from(gone.contains(&at)))).collect();
            assert_eq!(broken.springs(&memory).iter().filter(|&&broken| broken).count(), gone.len());
            broken.elements(&memory)
        };
        assert_eq!(after(&[]), [false, false]);
        assert_eq!(after(&[1]), [false, false]);
        assert_eq!(after(&[1, 2]), [true, false]);
        assert_eq!(after(&[3, 4, 5]), [false, true]);
        assert_eq!(after(&[0, 1, 3]), [true, false]);
        // Springs that never joined the second square do not leave it broken.
        let some = MassSpring { springs: [[0, 1], [0, 2], [1, 3], [2, 3]].into(), ..model };
        let broken = Broken::new(&some, &body).expect("springs that break");
        assert_eq!(broken.elements(&[0.0, 1.0, 1.0, 0.0]), [true, false]);
    }
}
