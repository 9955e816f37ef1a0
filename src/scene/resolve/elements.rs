//! Checks of elements, springs and faces that a scene lists.

use crate::scene::report::{Report, Way};
use crate::sim::body::{Body, Dimension, ElementKind, bounds};
use crate::sim::topology::{self, around, faces_of};
use glam::DVec3;
use std::collections::HashMap;

/// Below this part of the size of an element's box (to the power of the dimension) its area or volume counts as
/// none: rounding of coordinates leaves some 1e-16, and a needle a millionth as thick as long still has 1e-6.
const FLAT: f64 = 1e-12;

/// Reports every wrong index, repeated node, repeated element, element without extent or inside out, and every node
/// that nothing holds.
pub(super) fn check(
    elements: &[Vec<u32>],
    springs: Option<&[[u32; 2]]>,
    faces: Option<&[Vec<u32>]>,
    nodes: &[DVec3],
    dimension: Dimension,
    report: &mut Report<'_>,
) {
    let mut held = vec![false; nodes.len()];
    let mut known: HashMap<Vec<u32>, usize> = HashMap::new();
    let mut sound = true;
    for (at, element) in elements.iter().enumerate() {
        if !check_indices("elements", at, element, nodes.len(), report) {
            sound = false;
            continue;
        }
        element.iter().for_each(|&node| held[node as usize] = true);
        if !repeated("elements", at, element, &mut known, report) {
            check_extent(at, element, nodes, dimension, report);
        }
    }
    known.clear();
    for (at, spring) in springs.unwrap_or_default().iter().enumerate() {
        if check_indices("springs", at, spring, nodes.len(), report) {
            spring.iter().for_each(|&node| held[node as usize] = true);
            repeated("springs", at, spring, &mut known, report);
        } else {
            sound = false;
        }
    }
    for (at, face) in faces.unwrap_or_default().iter().enumerate() {
        check_indices("faces", at, face, nodes.len(), report);
    }
    // A wrong index leaves the node that was meant without an element: said once is enough.
    for (node, _) in held.iter().enumerate().filter(|&(_, &held)| sound && !held) {
        let message = format!("node {node} belongs to no element and no spring, so nothing would hold it");
        let help = "take it out, or list it in an element".to_owned();
        report.at(&[Way::Key("body"), Way::Key("nodes"), Way::Index(node)], message, help);
    }
}

/// Reports indices that do not exist and nodes that stand twice in one list. Whether there are none.
fn check_indices(key: &str, at: usize, list: &[u32], nodes: usize, report: &mut Report<'_>) -> bool {
    let mut sound = true;
    // Positions in order of their node, so that long lists are compared quickly.
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by_key(|&place| (list[place], place));
    for pair in order.windows(2).filter(|pair| list[pair[0]] == list[pair[1]]) {
        let message = format!("node {} stands twice in `body.{key}[{at}]`", list[pair[1]]);
        report.at(&[Way::Key("body"), Way::Key(key), Way::Index(at), Way::Index(pair[1])], message, None);
        sound = false;
    }
    for (place, &node) in list.iter().enumerate().filter(|&(_, &node)| node as usize >= nodes) {
        let message = match nodes {
            1 => format!("there is no node {node}; the body has only node 0"),
            _ => format!("there is no node {node}; the body has nodes 0 to {}", nodes - 1),
        };
        report.at(&[Way::Key("body"), Way::Key(key), Way::Index(at), Way::Index(place)], message, None);
        sound = false;
    }
    sound
}

/// Reports a list with the same nodes as an earlier one, in whatever order. Whether it is one.
fn repeated(key: &str, at: usize, list: &[u32], known: &mut HashMap<Vec<u32>, usize>, report: &mut Report<'_>) -> bool {
    let mut sorted = list.to_vec();
    sorted.sort_unstable();
    let first = *known.entry(sorted).or_insert(at);
    if first != at {
        let message = format!("`body.{key}[{at}]` has the same nodes as `body.{key}[{first}]`");
        report.at(&[Way::Key("body"), Way::Key(key), Way::Index(at)], message, "take one of them out".to_owned());
    }
    first != at
}

/// Reports an element without extent, inside out or clockwise.
fn check_extent(at: usize, element: &[u32], nodes: &[DVec3], dimension: Dimension, report: &mut Report<'_>) {
    let corners: Vec<DVec3> = element.iter().map(|&node| nodes[node as usize]).collect();
    let (low, high) = bounds(&corners);
    let size = (high - low).max_element();
    let path = [Way::Key("body"), Way::Key("elements"), Way::Index(at)];
    if size == 0.0 {
        let message =
            format!("`body.elements[{at}]` has no extent: all its nodes are at {}", point(corners[0], dimension));
        return report.at(&path, message, None);
    }
    let kind = topology::kind(dimension, element.len());
    let (measure, whole, flat) = match kind {
        // A length is not zero where the box is not, and other elements may be flat: they are no solids.
        ElementKind::Segment | ElementKind::Other => return,
        ElementKind::Polygon => (area(&corners), size * size, "no area: its nodes are on a line, or its sides cross"),
        ElementKind::Hexahedron => (
            volume(kind, &corners),
            size * size * size,
            "no volume: its nodes are in a plane, or its corners are not in bit order",
        ),
        _ => (volume(kind, &corners), size * size * size, "no volume: its nodes are in a plane, or not in order"),
    };
    if measure.abs() <= FLAT * whole {
        let message = format!("`body.elements[{at}]` has {flat}");
        let help = match kind {
            ElementKind::Hexahedron => Some("list the corners with x fastest, then y, then z".to_owned()),
            _ => None,
        };
        report.at(&path, message, help);
    } else if measure < 0.0 {
        let (what, turned) = mended(kind, element);
        let turned = if turned.len() <= 12 { format!("write {turned:?}") } else { "list its nodes backwards".into() };
        report.at(&path, format!("`body.elements[{at}]` is {what}"), turned);
    }
}

/// What is wrong with an element of negative size, and its nodes in the right order.
fn mended(kind: ElementKind, nodes: &[u32]) -> (&'static str, Vec<u32>) {
    let pick = |order: &[usize]| order.iter().map(|&place| nodes[place]).collect();
    match kind {
        ElementKind::Tetrahedron => ("turned inside out at rest", pick(&[0, 2, 1, 3])),
        ElementKind::Pyramid => ("turned inside out at rest", pick(&[0, 3, 2, 1, 4])),
        ElementKind::Wedge => ("turned inside out at rest", pick(&[3, 4, 5, 0, 1, 2])),
        ElementKind::Hexahedron => ("turned inside out at rest", pick(&[4, 5, 6, 7, 0, 1, 2, 3])),
        _ => ("clockwise; expected counter-clockwise", nodes.iter().rev().copied().collect()),
    }
}

/// Signed area of a polygon in the plane (m²), positive counter-clockwise.
fn area(corners: &[DVec3]) -> f64 {
    // From the first corner: far from the origin the products would cancel.
    let [first, rest @ ..] = corners else { return 0.0 };
    rest.windows(2).map(|pair| (pair[0] - first).truncate().perp_dot((pair[1] - first).truncate())).sum::<f64>() / 2.0
}

/// Signed volume of an element in space (m³), with each face as a fan about its middle.
fn volume(kind: ElementKind, corners: &[DVec3]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    let places: Vec<u32> = (0..).take(corners.len()).collect();
    let mut six = 0.0;
    for face in faces_of(kind, &places) {
        let corner = |place: u32| corners[place as usize] - first;
        let middle = face.iter().map(|&place| corner(place)).sum::<DVec3>() / face.len() as f64;
        six += around(&face).map(|[a, b]| middle.dot(corner(a).cross(corner(b)))).sum::<f64>();
    }
    six / 6.0
}

/// Mean length of all elements' edges at rest (m); the size of the body if they have none.
pub(super) fn mean_edge(body: &Body) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (nodes, &kind) in body.elements.iter().zip(&body.kinds) {
        for [a, b] in topology::edges_of(kind, nodes) {
            sum += body.rest[a as usize].distance(body.rest[b as usize]);
            count += 1.0;
        }
    }
    if sum > 0.0 { sum / count } else { body.extent() }
}

/// A point as it is typed.
fn point(point: DVec3, dimension: Dimension) -> String {
    match dimension {
        Dimension::Plane => format!("[{}, {}]", point.x, point.y),
        Dimension::Space => format!("[{}, {}, {}]", point.x, point.y, point.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_has_its_volume_and_the_mended_order_the_opposite() {
        let corner = |x: i32, y: i32, z: i32| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 100.0;
        let (o, x, y, z) = (corner(0, 0, 0), corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1));
        let cube: Vec<_> = (0..8).map(|bits| corner(bits & 1, bits >> 1 & 1, bits >> 2)).collect();
        for (kind, corners, expected) in [
            (ElementKind::Tetrahedron, vec![o, x, y, z], 1.0 / 6.0),
            (ElementKind::Pyramid, vec![o, x, corner(1, 1, 0), y, z], 1.0 / 3.0),
            (ElementKind::Wedge, vec![o, x, y, z, corner(1, 0, 1), corner(0, 1, 1)], 0.5),
            (ElementKind::Hexahedron, cube, 1.0),
        ] {
            assert!((volume(kind, &corners) - expected).abs() < 1e-12, "{kind:?}");
            let places: Vec<u32> = (0..).take(corners.len()).collect();
            let turned: Vec<_> = mended(kind, &places).1.iter().map(|&place| corners[place as usize]).collect();
            assert!((volume(kind, &turned) + expected).abs() < 1e-12, "{kind:?}");
        }
        assert_eq!(area(&[o, x, y]), 0.5);
        assert_eq!(area(&[y, x, o]), -0.5);
    }
}
