//! The edges of elements, which are drawn without surfaces.

use crate::picture::shell::is_broken;
use crate::sim::Body;
use std::borrow::Cow;

/// The edges of elements, once for all frames.
#[derive(Debug, Default)]
pub(super) struct Edges {
    /// Each edge once.
    pub(super) all: Vec<[u32; 2]>,
    /// The edges of each element, and the nodes of elements without edges.
    pub(super) of_elements: Vec<Vec<[u32; 2]>>,
}

impl Edges {
    /// The edges of all elements of a body.
    pub(super) fn new(body: &Body) -> Self {
        let of_elements: Vec<_> = (0..body.elements().len()).map(|element| body.topology().edges_of(element)).collect();
        let all = each_once(of_elements.iter());
        Self { all, of_elements }
    }

    /// Each edge of the elements that are not broken once.
    pub(super) fn of_whole(&self, broken: &[bool]) -> Cow<'_, [[u32; 2]]> {
        if !broken.contains(&true) {
            return Cow::Borrowed(&self.all);
        }
        let whole = self.of_elements.iter().zip(0..).filter(|&(_, element)| !is_broken(broken, element));
        Cow::Owned(each_once(whole.map(|(edges, _)| edges)))
    }
}

/// The edges of elements, each once.
fn each_once<'a>(of_elements: impl Iterator<Item = &'a Vec<[u32; 2]>>) -> Vec<[u32; 2]> {
    let mut all: Vec<_> = of_elements.flatten().copied().collect();
    all.iter_mut().for_each(|edge| edge.sort_unstable());
    all.sort_unstable();
    all.dedup();
    all
}
