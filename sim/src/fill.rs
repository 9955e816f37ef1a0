//! How much of elements, springs and nodes is filled, and how stiff they are in proportion.

use super::body::Body;
use super::model::blocks::EntriesOfNode;

/// The stiffness of each element, as far as it is filled, relative to the model's; `None` if all are 1.
pub(crate) fn of_elements(body: &Body) -> Option<Vec<f64>> {
    product(body.fill.as_deref(), body.stiffness.as_deref())
}

/// The filled part of each element times the relative modulus of its material, for models that know its size; `None` if all are 1.
pub(crate) fn of_materials(body: &Body) -> Option<Vec<f64>> {
    product(body.fill.as_deref(), body.modulus.as_deref())
}

/// The products of two factors of each element, either of which is 1 if it is not given; `None` if neither is.
pub(crate) fn product(one: Option<&[f64]>, other: Option<&[f64]>) -> Option<Vec<f64>> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.iter().zip(other).map(|(one, other)| one * other).collect()),
        (one, other) => one.or(other).map(<[f64]>::to_vec),
    }
}

/// The relative stiffness of each of some lists of nodes, such as springs; `None` if all are 1.
///
/// What is not an element of the body belongs in equal parts to the elements that hold all its nodes, so its relative stiffness is the
/// mean of theirs. Then stiffness is a sum over elements, `Σ f K`, as masses in proportion are, `Σ f M`, and no mode has a greater quotient of the
/// two than the stiffest of the elements full and by itself: an element that is hardly filled does not shorten the step. Full
/// neighbours of such an element keep more of what they share than they lose.
///
/// What no element holds has the least part of its nodes.
pub(crate) fn parts<'a>(body: &Body, lists: impl Iterator<Item = &'a [u32]>) -> Option<Vec<f64>> {
    let of_elements = of_elements(body)?;
    let elements_of = elements_of(body);
    let part = |nodes: &[u32]| {
        let (&first, others) = nodes.split_first()?;
        let hold = |&&element: &&usize| others.iter().all(|node| body.elements[element].contains(node));
        mean(elements_of.of(first as usize).iter().filter(hold).map(|&element| of_elements[element]))
    };
    let of_node =
        |&node: &u32| mean(elements_of.of(node as usize).iter().map(|&element| of_elements[element])).unwrap_or(1.0);
    let least = |nodes: &[u32]| nodes.iter().map(of_node).fold(f64::INFINITY, f64::min);
    Some(lists.map(|nodes| part(nodes).unwrap_or_else(|| least(nodes))).collect())
}

/// What is filled of the volumes of elements (m³, in the plane m²): their sum, if the body is full.
pub(crate) fn volume(fill: Option<&[f64]>, volumes: &[f64]) -> f64 {
    match fill {
        Some(fill) => volumes.iter().zip(fill).map(|(volume, part)| volume * part).sum(),
        None => volumes.iter().sum(),
    }
}

/// The elements of each node.
fn elements_of(body: &Body) -> EntriesOfNode {
    let corners = body.elements.iter().enumerate();
    EntriesOfNode::new(body.len(), corners.flat_map(|(element, nodes)| nodes.iter().map(move |&node| (element, node))))
}

/// The mean of numbers, in order; `None` if there is none.
fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Dimension;
    use glam::DVec3;

    #[test]
    fn what_elements_share_is_filled_by_the_mean_of_them() {
        // Two squares side by side, and a node of no element.
        let rest: Vec<_> = (0..7).map(|at| DVec3::new(f64::from(at / 2), f64::from(at % 2), 0.0)).collect();
        let elements = [&[0, 2, 3, 1][..], &[2, 4, 5, 3]].into_iter().collect();
        let full = Body::builder(rest).dimension(Dimension::Plane).elements(elements).build().expect("a body");
        let springs: [&[u32]; 5] = [&[0, 1], &[2, 3], &[5, 4], &[0, 4], &[4, 6]];
        assert_eq!((parts(&full, springs.into_iter()), full.fill_of_nodes()), (None, None));
        let body = Body { fill: Some(vec![1.0, 0.25]), ..full };
        assert_eq!(parts(&body, springs.into_iter()), Some(vec![1.0, 0.625, 0.25, 0.25, 0.25]));
        assert_eq!(body.fill_of_nodes(), Some(vec![1.0, 1.0, 0.625, 0.625, 0.25, 0.25, 1.0]));
    }
}
