//! The nodes that a constraint or a load selects.

use super::{choice, vector};
use crate::reading::captions::typed;
use crate::reading::collector::Here;
use crate::reading::words::{count, fine, list, nearest, quoted};
use crate::scene::SceneBody;
use crate::scene::file::{NodesFile, RegionFile, Side};
use crate::scene::summary::corners;
use crate::sim::{Body, Dimension};
use glam::DVec3;
use std::collections::HashMap;

/// The distance (m) within which places are equal: the end of a lattice may be at -0.30000000000000004 m, but is typed as -0.3.
pub(super) fn round_off(body: &Body) -> f64 {
    /// The same as a part of the body's longest side.
    const ROUND_OFF: f64 = 1e-9;
    ROUND_OFF * body.extent()
}

/// A ball with its centre and radius (m), or a box with its lowest and highest corner (m).
pub(super) enum Place {
    Ball(DVec3, f64),
    Box(DVec3, DVec3),
}

impl Place {
    /// A place as typed; `None` after reporting a mistake.
    pub(super) fn new(region: &RegionFile, dimension: Dimension, here: &Here<'_>) -> Option<Self> {
        let point = |typed, key| vector(typed, dimension, &here.to(key));
        match region {
            RegionFile { of: Some(of), within: Some(within), .. } => Some(Self::Ball(point(of, "of")?, *within)),
            RegionFile { low: Some(low), high: Some(high), .. } => {
                let (low, high) = (point(low, "low"), point(high, "high"));
                let (low, high) = (low?, high?);
                if low.cmpgt(high).any() {
                    here.to("low").wrong(format!("`{here}.low` does not lie below `high` along every axis"), None);
                    return None;
                }
                Some(Self::Box(low, high))
            }
            // The schema rules this out.
            _ => None,
        }
    }

    /// Whether a point is in it, or beside it by no more than a distance (m).
    pub(super) fn has(&self, at: DVec3, close: f64) -> bool {
        match *self {
            Self::Ball(middle, radius) => at.distance(middle) <= radius + close,
            Self::Box(low, high) => at.cmpge(low - close).all() && at.cmple(high + close).all(),
        }
    }
}

/// The elements of a body with a corner on its side of a name at rest, or with all corners in its group of this name; `None` after reporting a mistake.
pub(super) fn named_cells(name: &str, of: &SceneBody, here: &Here<'_>) -> Option<Vec<u32>> {
    let nodes = named(name, std::slice::from_ref(of), here)?.pop()?;
    let is_group = of.groups.iter().any(|group| group.name == name);
    let mut is_chosen = vec![false; of.body.len()];
    nodes.iter().for_each(|&node| is_chosen[node as usize] = true);
    let takes = |corners: &[u32]| {
        let mut chosen = corners.iter().map(|&node| is_chosen[node as usize]);
        if is_group { chosen.all(|is| is) } else { chosen.any(|is| is) }
    };
    Some((0..).zip(of.body.elements().iter()).filter(|(_, corners)| takes(corners)).map(|(at, _)| at).collect())
}

/// The selected nodes of each body, in rising order: those of the body of a `name`, or of all; all nodes unless some are typed, under a key.
/// `None` after reporting a mistake in a constraint or a load.
pub(super) fn select(
    name: Option<&str>,
    typed: Option<&NodesFile>,
    bodies: &[SceneBody],
    (here, key): (&Here<'_>, &str),
) -> Option<Vec<Vec<u32>>> {
    let chosen = match name {
        Some(name) => {
            let names: Vec<_> = bodies.iter().map(|one| one.name.as_str()).collect();
            let body = choice::find(name, &names, &here.to("body"))?;
            body..body + 1
        }
        None => 0..bodies.len(),
    };
    let here = here.to(key);
    let found = match (typed, &bodies[chosen.clone()]) {
        (None, bodies) => bodies.iter().map(|one| (0..one.body.len() as u32).collect()).collect(),
        (Some(NodesFile::List(list)), [only]) => vec![listed(list, only, &here)?],
        (Some(NodesFile::List(_)), several) => {
            let message = format!("`{here}` is a list of nodes, but the scene has {} bodies", several.len());
            let help = several.first().map(|first| format!("name their body, such as body = {}", quoted(&first.name)));
            here.wrong(message, help);
            return None;
        }
        (Some(NodesFile::Named(name)), bodies) => named(name, bodies, &here)?,
        (Some(NodesFile::Region(region)), bodies) => within(region, bodies, &here)?,
    };
    let mut nodes = vec![Vec::new(); bodies.len()];
    nodes.splice(chosen, found);
    Some(nodes)
}

fn listed(list: &[u32], body: &SceneBody, here: &Here<'_>) -> Option<Vec<u32>> {
    let (before, count) = (here.report.total(), body.body.len());
    let mut first = HashMap::new();
    for (place, &node) in list.iter().enumerate() {
        let at = here.to(place);
        if node as usize >= count {
            let message = format!("there is no node {node}; {} has nodes 0 to {}", body.in_words(), count - 1);
            at.wrong(message, None);
        } else if first.insert(node, place).is_some() {
            at.wrong(format!("node {node} occurs twice in `{here}`"), None);
        }
    }
    let mut nodes = list.to_vec();
    nodes.sort_unstable();
    (here.report.total() == before).then_some(nodes)
}

/// The nodes of each body: of its group with this name, or else of its side at rest.
fn named(name: &str, bodies: &[SceneBody], here: &Here<'_>) -> Option<Vec<Vec<u32>>> {
    /// The most groups that are named in a message.
    const NAMED: usize = 20;
    let of_body = |body: &SceneBody| body.groups.iter().find(|group| group.name == name).map(|one| one.points.clone());
    let found: Vec<Option<Vec<u32>>> = bodies.iter().map(of_body).collect();
    if found.contains(&Some(Vec::new())) && found.iter().flatten().all(Vec::is_empty) {
        let message = format!("`{here}` is {}, a group whose points belong to no element of the body", quoted(name));
        here.wrong(message, "give the group elements, or points of theirs, in the program that made the mesh");
        return None;
    }
    let is_flat = bodies[0].body.dimension() == Dimension::Plane;
    let is_there = |side: &Side| !(is_flat && [Side::Front, Side::Back].contains(side));
    let side = Side::ALL.into_iter().find(|side| typed(side) == name);
    let there = side.filter(is_there);
    if there.is_some() || found.iter().any(Option::is_some) {
        let of_side = |body: &SceneBody| there.map(|side| of_side(side, &body.body)).unwrap_or_default();
        let nodes = found.into_iter().zip(bodies).map(|(group, body)| group.unwrap_or_else(|| of_side(body)));
        return Some(nodes.collect());
    }
    if side.is_some() {
        let (side, body) = (quoted(name), bodies[0].in_words());
        let message = format!("`{here}` is {side}, but {body} is in the plane");
        here.wrong(message, "expected \"left\", \"right\", \"bottom\" or \"top\"");
        return None;
    }
    let sides: Vec<String> = Side::ALL.iter().filter(|side| is_there(side)).map(typed).collect();
    let groups = bodies.iter().flat_map(|body| &body.groups).filter(|group| !group.points.is_empty());
    let mut groups: Vec<&str> = groups.map(|group| group.name.as_str()).collect();
    groups.sort_unstable();
    groups.dedup();
    let known: Vec<&str> = groups.iter().copied().chain(sides.iter().map(String::as_str)).collect();
    let expected = match groups.len() {
        0 => format!("expected {}", list(&sides, "or", quoted)),
        more if more > NAMED => format!("expected a side, or one of the {} groups of the mesh", count(more as u128)),
        _ => {
            format!("expected {}, or a group of the mesh: {}", list(&sides, "or", quoted), list(&groups, "or", quoted))
        }
    };
    let help = nearest(name, &known).map(|near| format!("did you mean {}?", quoted(near)));
    here.wrong(format!("`{here}` is {}; {expected}", quoted(name)), help);
    None
}

/// The nodes of a side of a body at rest.
fn of_side(side: Side, body: &Body) -> Vec<u32> {
    let outwards = match side {
        Side::Left => DVec3::NEG_X,
        Side::Right => DVec3::X,
        Side::Bottom => DVec3::NEG_Y,
        Side::Top => DVec3::Y,
        Side::Front => DVec3::Z,
        Side::Back => DVec3::NEG_Z,
    };
    let along = |node: &DVec3| node.dot(outwards);
    let most = body.rest().iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let close = round_off(body);
    (0..).zip(body.rest()).filter(|(_, node)| along(node) >= most - close).map(|(node, _)| node).collect()
}

/// The nodes of each body that start in a region.
fn within(region: &RegionFile, bodies: &[SceneBody], here: &Here<'_>) -> Option<Vec<Vec<u32>>> {
    let dimension = bodies[0].body.dimension();
    let place = Place::new(region, dimension, here)?;
    let inside = |of: &SceneBody| {
        let close = round_off(&of.body);
        (0..).zip(&of.initial.position).filter(|(_, at)| place.has(**at, close)).map(|(node, _)| node).collect()
    };
    let nodes: Vec<Vec<u32>> = bodies.iter().map(inside).collect();
    if matches!(place, Place::Box(..)) {
        bodies.iter().zip(&nodes).for_each(|(body, nodes)| warn_of_rest(nodes, body, here));
    }
    if nodes.iter().all(Vec::is_empty) {
        let all: Vec<DVec3> = bodies.iter().flat_map(|one| &one.initial.position).copied().collect();
        let start = match bodies {
            [only] => format!("{} starts", only.in_words()),
            _ => "the bodies start".to_owned(),
        };
        let message = format!("`{here}` is a region without nodes at the start");
        here.wrong(message, format!("{start} {}", between(&all, dimension)));
        return None;
    }
    Some(nodes)
}

/// Nodes with equal coordinates along one axis at rest, such as the layers of a lattice.
struct Layers {
    /// The layer of each node.
    of: Vec<u32>,
    /// The number of nodes in each layer.
    sizes: Vec<usize>,
}

/// The layers of a body along each axis.
fn layers_of(body: &Body) -> Vec<Layers> {
    let close = round_off(body);
    let along = |axis: usize| {
        let at = |node: usize| body.rest()[node][axis];
        let mut order: Vec<usize> = (0..body.len()).collect();
        order.sort_by(|&a, &b| at(a).total_cmp(&at(b)));
        let (mut of, mut sizes) = (vec![0; order.len()], Vec::new());
        for layer in order.chunk_by(|&a, &b| at(b) - at(a) <= close) {
            layer.iter().for_each(|&node| of[node] = sizes.len() as u32);
            sizes.push(layer.len());
        }
        Layers { of, sizes }
    };
    (0..if body.dimension() == Dimension::Plane { 2 } else { 3 }).map(along).collect()
}

/// Warns of a box that includes the same part of each layer at one end of the body, probably typed for a body at
/// another place. Such a box is thin along one axis, with less than half of the layers, and has at least half of them
/// along the others. Boxes around rows and corners are thin along several axes.
fn warn_of_rest(nodes: &[u32], body: &SceneBody, here: &Here<'_>) {
    if nodes.is_empty() || nodes.len() == body.body.len() {
        return;
    }
    let layers = layers_of(&body.body);
    let (position, dimension) = (&body.initial.position, body.body.dimension());
    let taken = layers.iter().map(|layers| {
        let mut taken = vec![0; layers.sizes.len()];
        nodes.iter().for_each(|&node| taken[layers.of[node as usize] as usize] += 1);
        taken
    });
    let used = |taken: &[usize]| taken.iter().filter(|&&nodes| nodes > 0).count();
    let is_thin = |taken: &[usize]| taken.len() > 1 && (used(taken) == 1 || 2 * used(taken) < taken.len());
    let mut thin = layers.iter().zip(taken).filter(|(_, taken): &(_, Vec<usize>)| is_thin(taken));
    let (Some((layers, taken)), None) = (thin.next(), thin.next()) else { return };
    let is_used = |node: usize| taken[layers.of[node] as usize] > 0;
    let whole: Vec<DVec3> = (0..position.len()).filter(|&node| is_used(node)).map(|node| position[node]).collect();
    let mut parts = taken.iter().filter(|&&nodes| nodes > 0);
    let first = parts.next();
    if nodes.len() < whole.len() && parts.all(|part| Some(part) == first) {
        let (what, these) = match used(&taken) {
            1 => ("a layer".to_owned(), "this layer starts"),
            several => (format!("{} layers", count(several as u128)), "these layers start"),
        };
        let message = format!(
            "`{here}` takes {} of the {} nodes of {what} of {}",
            count(nodes.len() as u128),
            count(whole.len() as u128),
            body.in_words(),
        );
        here.warn(message, format!("{these} {}", between(&whole, dimension)));
    }
}

/// The bounding box of points in words.
fn between(points: &[DVec3], dimension: Dimension) -> String {
    let words = |corner: Vec<f64>| corner.into_iter().map(fine).collect::<Vec<_>>().join(", ");
    let [low, high] = corners(points, dimension).map(words);
    format!("between [{low}] and [{high}] m")
}
