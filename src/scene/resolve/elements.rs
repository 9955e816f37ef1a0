//! Checks of elements, springs and faces that a body lists.

use super::disorder::{AROUND, Disorder, Wrong};
use super::lists::{ListSource, Lists};
use crate::reading::words::count;
use crate::scene::mesh::crossing;
use crate::sim::geometry::{Alike, bounds, kind, volume_by_faces};
use crate::sim::{Body, Dimension, ElementKind, Solids};
use glam::DVec3;

/// An area or volume below this part of the element's bounding cube counts as zero. Rounded coordinates leave some
/// 1e-16; a needle a million times as long as thick still has 1e-6.
const FLAT: f64 = 1e-12;

/// Reports every wrong index, repeated node, repeated element or spring, degenerate or inverted element, and every node
/// without element or spring. If there were mistakes before (`flawed`), their consequences are not reported.
pub(super) fn check(lists: &Lists<'_>, solids: Solids, flawed: bool) {
    let Lists { source, nodes, elements, springs, faces, .. } = lists;
    let node_count = nodes.len();
    let mut held = vec![false; node_count];
    let mut are_valid = !flawed;
    let mut distinct = Vec::new();
    let mut known = Alike::new(elements.len());
    for (at, element) in elements.iter().enumerate() {
        if !check_indices(source, "elements", at, element, node_count) {
            are_valid = false;
            continue;
        }
        element.iter().for_each(|&node| held[node as usize] = true);
        if !repeated(source, "elements", at, |at| &elements[at], &mut known) {
            distinct.push(at);
        }
    }
    // With some wrong indices, others may be wrong too.
    if are_valid {
        let mut disorder = Disorder::default();
        distinct.iter().for_each(|&at| lists.check_extent(at, &elements[at], solids, &mut disorder));
        disorder.report(lists);
    }
    let springs = springs.as_deref().unwrap_or_default();
    let mut known = Alike::new(springs.len());
    for (at, spring) in springs.iter().enumerate() {
        if check_indices(source, "springs", at, spring, node_count) {
            spring.iter().for_each(|&node| held[node as usize] = true);
            repeated(source, "springs", at, |at| &springs[at], &mut known);
        } else {
            are_valid = false;
        }
    }
    for (at, face) in faces.iter().flat_map(|faces| faces.iter()).enumerate() {
        check_indices(source, "faces", at, face, node_count);
    }
    // A wrong index leaves the right node without an element. That is one mistake.
    for (node, _) in held.iter().enumerate().filter(|&(_, &held)| are_valid && !held) {
        let message = format!("node {node} belongs to no element and no spring, so nothing would hold it");
        source.report("nodes", &[node], message, "remove it, or list it in an element");
    }
}

impl Lists<'_> {
    /// Reports an element that has no extent, or is inside out or clockwise.
    fn check_extent(&self, at: usize, element: &[u32], solids: Solids, disorder: &mut Disorder) {
        let corners: Vec<DVec3> = element.iter().map(|&node| self.nodes[node as usize]).collect();
        let (low, high) = bounds(&corners);
        let size = (high - low).max_element();
        let name = || self.source.name("elements", &[at]);
        let mistake = |message, help| self.source.report("elements", &[at], message, help);
        if size == 0.0 {
            let point = point(low, self.dimension);
            return mistake(format!("`{}` has no extent: all its nodes are at {point}", name()), None);
        }
        let kind = kind(self.dimension, solids, element.len());
        let whole = match kind {
            // Elements of two nodes have a length if their box has one. Others that are not solids may be flat or rods.
            ElementKind::Segment => return,
            ElementKind::Triangle | ElementKind::Other => {
                if element.len() > MOST_IN_HULL {
                    let message = format!(
                        "`{}` has {} nodes; the faces of a solid are found for up to {}",
                        name(),
                        count(element.len() as u128),
                        count(MOST_IN_HULL as u128)
                    );
                    mistake(message, Some("divide it into smaller elements".into()));
                } else if kind == ElementKind::Triangle && is_on_a_line(&corners, size) {
                    mistake(format!("`{}` has no area: its nodes are on a line", name()), None);
                }
                return;
            }
            ElementKind::Polygon => size * size,
            _ => size * size * size,
        };
        let measure = volume_by_faces(kind, element, &self.nodes);
        disorder.ordered += 1;
        let around = || volume_by_faces(kind, &AROUND.map(|place| element[place]), &self.nodes);
        // A valid hexahedron read in the other order intersects itself. Its volume is nearly zero, with either sign.
        if kind == ElementKind::Hexahedron && around().abs() > (2.0 * measure.abs()).max(FLAT * whole) {
            disorder.found.push((at, Wrong::Around, kind));
        } else if measure.abs() <= FLAT * whole {
            disorder.found.push((at, Wrong::Flat, kind));
        } else if let Some([one, other]) = crossing(kind, &corners) {
            let side = |at: usize| format!("{}–{}", element[at], element[(at + 1) % element.len()]);
            let message = format!("the sides {} and {} of `{}` cross", side(one), side(other), name());
            mistake(message, Some("list its nodes in order around it, counter-clockwise".into()));
        } else if measure < 0.0 {
            disorder.found.push((at, Wrong::Turned, kind));
        }
    }
}

/// The most nodes of an element whose faces are found from its convex hull: more take seconds.
const MOST_IN_HULL: usize = 10_000;

/// Whether points lie on a line, to round-off in a box of this size around them.
fn is_on_a_line(points: &[DVec3], size: f64) -> bool {
    let from = |point: &DVec3| *point - points[0];
    let along =
        points.iter().map(from).fold(DVec3::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    points.iter().all(|point| along.cross(from(point)).length() <= FLAT.sqrt() * size * size)
}

/// Reports missing and repeated nodes. Returns true if there are none.
fn check_indices(source: &ListSource<'_>, key: &str, at: usize, list: &[u32], nodes: usize) -> bool {
    /// Up to this length, comparing all pairs is faster than sorting.
    const FEW: usize = 16;
    let is_new = |entry: usize| (list[entry] as usize) < nodes && !list[..entry].contains(&list[entry]);
    if list.len() <= FEW && (0..list.len()).all(is_new) {
        return true;
    }
    let mut are_valid = true;
    // Positions are sorted by node, so that long lists are compared quickly.
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by_key(|&entry| (list[entry], entry));
    for pair in order.windows(2).filter(|pair| list[pair[0]] == list[pair[1]]) {
        let message = format!("node {} occurs twice in `{}`", list[pair[1]], source.name(key, &[at]));
        source.report(key, &[at, pair[1]], message, None);
        are_valid = false;
    }
    for (entry, &node) in list.iter().enumerate().filter(|&(_, &node)| node as usize >= nodes) {
        let message = match nodes {
            1 => format!("there is no node {node}; the body has only node 0"),
            _ => format!("there is no node {node}; the body has nodes 0 to {}", nodes - 1),
        };
        source.report(key, &[at, entry], message, "nodes are counted from 0");
        are_valid = false;
    }
    are_valid
}

/// Reports a list with the same nodes as an earlier one, in any order. Returns true if there is one.
fn repeated<'l>(
    source: &ListSource<'_>,
    key: &str,
    at: usize,
    list: impl Fn(usize) -> &'l [u32],
    known: &mut Alike,
) -> bool {
    let first = known.find(list(at), &list).unwrap_or(at);
    if first == at {
        known.put(at, list(at));
    } else {
        let [this, other] = [at, first].map(|at| source.name(key, &[at]));
        let message = format!("`{this}` has the same nodes as `{other}`");
        source.report(key, &[at], message, "remove one of them");
    }
    first != at
}

/// Mean length of all elements' edges at rest (m); the size of the body if they have none.
pub(in crate::scene) fn mean_edge(body: &Body) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let topology = body.topology();
    for element in 0..body.elements().len() {
        for [a, b] in topology.edges_of(element) {
            sum += body.rest()[a as usize].distance(body.rest()[b as usize]);
            count += 1.0;
        }
    }
    if sum > 0.0 { sum / count } else { body.extent() }
}

/// A point as typed.
pub(super) fn point(point: DVec3, dimension: Dimension) -> String {
    match dimension {
        Dimension::Plane => format!("[{}, {}]", point.x, point.y),
        Dimension::Space => format!("[{}, {}, {}]", point.x, point.y, point.z),
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/elements.rs"]
mod tests;
