//! Elements whose nodes are in another order than expected, in words.

use super::lists::Lists;
use crate::reading::collector::PathPart;
use crate::reading::words::{count, list};
use crate::sim::{Dimension, ElementKind};

/// The order in which other programs list the corners of a hexahedron, around one side and then around the other. It is its
/// own inverse.
pub(super) const AROUND: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// A mistake in the nodes of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrong {
    Flat,
    Around,
    Turned,
}

/// Elements whose nodes are probably in another order than expected.
#[derive(Debug, Default)]
pub(super) struct Disorder {
    /// The number of elements whose order is checked.
    pub(super) ordered: usize,
    /// Index, mistake and kind of each element.
    pub(super) found: Vec<(usize, Wrong, ElementKind)>,
}

impl Disorder {
    /// Reports each kind of mistake in one message.
    pub(super) fn report(self, lists: &Lists<'_>) {
        for wrong in [Wrong::Flat, Wrong::Around, Wrong::Turned] {
            let found: Vec<_> = self.found.iter().filter(|one| one.1 == wrong).map(|one| (one.0, one.2)).collect();
            let (at, (message, help)) = match found[..] {
                [] => continue,
                [(at, kind)] => (vec![at], in_words(lists, at, wrong, kind)),
                [(first, _), ..] => {
                    let is_all = found.len() == self.ordered;
                    (if is_all { vec![] } else { vec![first] }, in_common(lists, wrong, &found, is_all))
                }
            };
            lists.source.report("elements", &at, message, help);
        }
    }
}

/// The mistake of several elements, given by number and kind, and the remedy.
fn in_common(
    lists: &Lists<'_>,
    wrong: Wrong,
    found: &[(usize, ElementKind)],
    is_all: bool,
) -> (String, Option<String>) {
    /// The most elements that are named.
    const NAMED: usize = 5;
    let (what, help) = match (wrong, lists.dimension) {
        (Wrong::Flat, Dimension::Plane) => ("have no area: their nodes are on lines, or their sides cross", None),
        (Wrong::Turned, Dimension::Plane) => {
            ("are clockwise; expected counter-clockwise", Some("list the nodes of each backwards".to_owned()))
        }
        (Wrong::Flat, Dimension::Space) => {
            ("have no volume: their nodes are in planes, or not in their order", convex(lists))
        }
        (Wrong::Around, _) => {
            let order = format!("take the nodes of each in the order {AROUND:?}");
            (
                "list their corners around their sides, as VTK, Gmsh and Abaqus do; expected x fastest, then y, then z",
                Some(convex(lists).map_or(order.clone(), |convex| format!("{order}; or {convex}"))),
            )
        }
        (Wrong::Turned, Dimension::Space) => {
            let mut orders: Vec<String> = Vec::new();
            for &(_, kind) in found {
                let (name, nodes) = match kind {
                    ElementKind::Tetrahedron => ("tetrahedra", 4),
                    ElementKind::Pyramid => ("pyramids", 5),
                    ElementKind::Wedge => ("wedges", 6),
                    _ => ("hexahedra", 8),
                };
                let order = format!("{:?} for {name}", mended(kind, &Vec::from_iter(0..nodes)).1);
                if !orders.contains(&order) {
                    orders.push(order);
                }
            }
            let order = format!("take the nodes of each in the order {}", list(&orders, "and", str::to_owned));
            let help = convex(lists).map_or(order.clone(), |convex| format!("{convex}, or {order}"));
            ("are turned inside out at rest", Some(help))
        }
    };
    let (number, name) = (count(found.len() as u128), lists.source.name("elements", &[]));
    if is_all {
        return (format!("all {number} elements of `{name}` {what}"), help);
    }
    let mut named: Vec<String> = found.iter().take(NAMED).map(|(at, _)| at.to_string()).collect();
    named.extend((found.len() > NAMED).then(|| format!("{} more", count((found.len() - NAMED) as u128))));
    let (named, all) = (list(&named, "and", str::to_owned), count(lists.elements.len() as u128));
    (format!("{number} of {all} elements of `{name}` {what}: {named}"), help)
}

/// The mistake of one element, and the remedy.
fn in_words(lists: &Lists<'_>, at: usize, wrong: Wrong, kind: ElementKind) -> (String, Option<String>) {
    let (name, element) = (lists.source.name("elements", &[at]), &lists.elements[at]);
    match (wrong, kind) {
        (Wrong::Flat, ElementKind::Polygon) => {
            (format!("`{name}` has no area: its nodes are on a line, or its sides cross"), None)
        }
        (Wrong::Flat, _) => {
            let help = match kind {
                ElementKind::Hexahedron => Some("list the corners with x fastest, then y, then z".to_owned()),
                _ => convex(lists),
            };
            (format!("`{name}` has no volume: its nodes are in a plane, or not in their order"), help)
        }
        (Wrong::Around, _) => {
            let expected = "expected x fastest, then y, then z";
            let message = format!("`{name}` lists its corners around its sides; {expected}");
            (message, Some(format!("write {:?}", AROUND.map(|place| element[place]))))
        }
        (Wrong::Turned, _) => {
            let (what, turned) = mended(kind, element);
            let help = if turned.len() <= 12 { format!("write {turned:?}") } else { "list its nodes backwards".into() };
            (format!("`{name}` is {what}"), Some(help))
        }
    }
}

/// The remedy that allows any order; `None` for a body of a recording, which has no such key.
fn convex(lists: &Lists<'_>) -> Option<String> {
    let is_typed = lists.source.body.path().first() == Some(&PathPart::Key("body"));
    is_typed.then(|| "write convex = true in [body] for nodes in any order".to_owned())
}

/// The mistake of an element of negative size, and its nodes in the right order.
pub(super) fn mended(kind: ElementKind, nodes: &[u32]) -> (&'static str, Vec<u32>) {
    let pick = |order: &[usize]| order.iter().map(|&place| nodes[place]).collect();
    match kind {
        ElementKind::Tetrahedron => ("turned inside out at rest", pick(&[0, 2, 1, 3])),
        ElementKind::Pyramid => ("turned inside out at rest", pick(&[0, 3, 2, 1, 4])),
        ElementKind::Wedge => ("turned inside out at rest", pick(&[3, 4, 5, 0, 1, 2])),
        ElementKind::Hexahedron => ("turned inside out at rest", pick(&[4, 5, 6, 7, 0, 1, 2, 3])),
        _ => ("clockwise; expected counter-clockwise", nodes.iter().rev().copied().collect()),
    }
}
