//! Kinematic constraints: nodes held and dragged.

use super::{choice, motion, vector};
use crate::reading::captions::typed;
use crate::reading::collector::{Collector, PathPart, key_path, written};
use crate::reading::words::{count, fine, list, nearest, quoted};
use crate::scene::SceneBody;
use crate::scene::file::{GrabFile, HoldFile, NodesFile, RegionFile, Side};
use crate::scene::summary::corners;
use crate::sim::{Assembly, Body, Dimension, Grip, Motion};
use glam::DVec3;
use std::cell::OnceCell;
use std::collections::{BTreeMap, HashMap};

/// A constraint: nodes of bodies of the scene, when they are held, and how they move.
#[derive(Debug)]
pub(super) struct SceneGrip {
    /// The nodes of each body of the scene, in rising order.
    nodes: Vec<Vec<u32>>,
    /// Start (s).
    from: f64,
    /// End (s).
    until: f64,
    motion: Motion,
}

impl SceneGrip {
    /// The constraints in a run of some of the bodies: one for each body that has nodes in it. So bodies do not depend on each
    /// other: gripped nodes turn about their own centre, and a body moves as it does alone, to the last bit.
    pub(super) fn in_run<'a>(&'a self, of: &'a [usize], bodies: &'a Assembly) -> impl Iterator<Item = Grip> {
        of.iter().enumerate().filter_map(|(at, &body)| {
            let first = bodies.nodes(at).start as u32;
            let nodes: Vec<u32> = self.nodes[body].iter().map(|node| first + node).collect();
            let Self { from, until, ref motion, .. } = *self;
            (!nodes.is_empty()).then(|| Grip { nodes, from, until, motion: motion.clone() })
        })
    }
}

/// The constraints, `hold` first, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    holds: &[Option<HoldFile>],
    grabs: &[Option<GrabFile>],
    bodies: &[SceneBody],
    report: &mut Collector<'_>,
) -> Option<Vec<SceneGrip>> {
    let mut named: Vec<(String, Vec<PathPart<'_>>, SceneGrip)> = Vec::new();
    let layers = vec![OnceCell::new(); bodies.len()];
    let dimension = bodies.first()?.body.dimension;
    for (at, typed) in holds.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let path = key_path!["hold", at].to_vec();
        let until = typed.until.unwrap_or(f64::INFINITY);
        let nodes = nodes(typed.body.as_deref(), &typed.nodes, bodies, &layers, &path, report);
        if until <= typed.from {
            let message = format!("`hold[{at}]` ends at {until} s, not later than it begins at {} s", typed.from);
            report.at(&key_path![path; "until"], message, None);
        } else if let Some(nodes) = nodes {
            let grip = SceneGrip { nodes, from: typed.from, until, motion: Motion::Still };
            named.push((format!("held by `hold[{at}]`"), path, grip));
        }
    }
    for (at, typed) in grabs.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let grab = key_path!["grab", at].to_vec();
        let nodes = nodes(typed.body.as_deref(), &typed.nodes, bodies, &layers, &grab, report);
        let path = key_path![grab; "path"];
        if typed.path.repeat {
            let message = format!("`grab[{at}].path` repeats, so the nodes would never be released");
            report.at_key(&key_path![path; "repeat"], message, "remove `repeat`".to_owned());
            continue;
        }
        let motion = motion::keys(&typed.path, dimension, &path, report);
        let [from, until] =
            [typed.path.keys.first(), typed.path.keys.last()].map(|key| key.map_or(0.0, |key| key.time));
        if typed.path.keys.len() == 1 {
            let message =
                format!("`grab[{at}].path` has a single key: nodes grabbed at {from} s would be released at once");
            report.at(&path, message, "add a key, or write [[hold]] for nodes that stay where they are");
        } else if let (Some(nodes), Some(motion)) = (nodes, motion) {
            named.push((format!("grabbed by `grab[{at}]`"), grab, SceneGrip { nodes, from, until, motion }));
        }
    }
    check_overlaps(&named, bodies, report);
    (named.len() == holds.len() + grabs.len()).then(|| named.into_iter().map(|(_, _, grip)| grip).collect())
}

/// Reports constraints that are shorter than a time step (s), which would have no effect.
pub(super) fn check_steps(
    holds: &[Option<HoldFile>],
    grabs: &[Option<GrabFile>],
    step: f64,
    report: &mut Collector<'_>,
) {
    for (at, hold) in holds.iter().enumerate() {
        let until = hold.as_ref().and_then(|hold| Some((hold.until?, hold.from)));
        if let Some((until, from)) = until.filter(|(until, from)| (0.0..step).contains(&(until - from))) {
            let message = format!("`hold[{at}]` lasts {:.3e} s, but a time step takes {step:.3e} s", until - from);
            let help = "make it longer, or it holds nothing".to_owned();
            report.at(&key_path!["hold", at, "until"], message, help);
        }
    }
    for (at, grab) in grabs.iter().enumerate() {
        let path = key_path!["grab", at, "path"];
        grab.iter().for_each(|grab| motion::check_steps(&grab.path, step, &path, report));
    }
}

/// Reports nodes in two constraints at the same time.
fn check_overlaps(named: &[(String, Vec<PathPart<'_>>, SceneGrip)], bodies: &[SceneBody], report: &mut Collector<'_>) {
    let mut holders: BTreeMap<(usize, u32), Vec<usize>> = BTreeMap::new();
    for (at, (_, _, grip)) in named.iter().enumerate() {
        let nodes = grip.nodes.iter().enumerate().flat_map(|(body, nodes)| nodes.iter().map(move |&node| (body, node)));
        nodes.for_each(|node| holders.entry(node).or_default().push(at));
    }
    // One node is enough: others of the same two constraints have the same cause.
    let mut clashes: BTreeMap<[usize; 2], (usize, u32)> = BTreeMap::new();
    for (node, mut grips) in holders {
        let time = |grip: usize| (named[grip].2.from, named[grip].2.until);
        grips.sort_by(|&a, &b| time(a).0.total_cmp(&time(b).0));
        // A constraint that begins before another ends, begins before the last one ends.
        let mut last = grips[0];
        for &grip in &grips[1..] {
            if time(grip).0 < time(last).1 {
                clashes.entry([grip.max(last), grip.min(last)]).or_insert(node);
            }
            if time(grip).1 > time(last).1 {
                last = grip;
            }
        }
    }
    for ([second, first], (body, node)) in clashes {
        let ((other, _, one), (words, path, two)) = (&named[first], &named[second]);
        let (from, until) = (one.from.max(two.from), one.until.min(two.until));
        let until = if until.is_finite() { format!("until {until} s") } else { "on".into() };
        let message = format!("node {node}{} is {other} and {words} at once, from {from} s {until}", of(body, bodies));
        let help = "assign each node to one of them at a time".to_owned();
        report.at(&key_path![path; "nodes"], message, help);
    }
}

/// The owner of a node in messages, which only one of several bodies needs.
fn of(body: usize, bodies: &[SceneBody]) -> String {
    if bodies.len() == 1 { String::new() } else { format!(" of {}", bodies[body].in_words()) }
}

/// The selected nodes of each body, in rising order: those of the body of a `name`, or of all.
fn nodes(
    name: Option<&str>,
    typed: &NodesFile,
    bodies: &[SceneBody],
    layers: &[OnceCell<Vec<Layers>>],
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<Vec<Vec<u32>>> {
    let chosen = match name {
        Some(name) => {
            let names: Vec<_> = bodies.iter().map(|body| body.name.as_str()).collect();
            let body = choice::find(name, &names, &key_path![path; "body"], report)?;
            body..body + 1
        }
        None => 0..bodies.len(),
    };
    let mut nodes = vec![Vec::new(); bodies.len()];
    let path = key_path![path; "nodes"];
    let found = nodes_of_each(typed, &bodies[chosen.clone()], &layers[chosen.clone()], &path, report)?;
    nodes.splice(chosen, found);
    Some(nodes)
}

/// The selected nodes of each of some bodies, in rising order.
fn nodes_of_each(
    typed: &NodesFile,
    bodies: &[SceneBody],
    layers: &[OnceCell<Vec<Layers>>],
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<Vec<Vec<u32>>> {
    match typed {
        NodesFile::List(list) => match bodies {
            [only] => Some(vec![listed(list, only, path, report)?]),
            [first, ..] => {
                let message =
                    format!("`{}` is a list of nodes, but the scene has {} bodies", written(path), bodies.len());
                let help = format!("name their body, such as body = {}", quoted(&first.name));
                report.at(path, message, help);
                None
            }
            [] => None,
        },
        NodesFile::Named(name) => named(name, bodies, path, report),
        NodesFile::Region(region) => within(region, bodies, layers, path, report),
    }
}

fn listed(list: &[u32], body: &SceneBody, path: &[PathPart<'_>], report: &mut Collector<'_>) -> Option<Vec<u32>> {
    let (before, count) = (report.total(), body.body.len());
    let mut first = HashMap::new();
    for (place, &node) in list.iter().enumerate() {
        let at = key_path![path; place];
        if node as usize >= count {
            let message = format!("there is no node {node}; {} has nodes 0 to {}", body.in_words(), count - 1);
            report.at(&at, message, None);
        } else if first.insert(node, place).is_some() {
            report.at(&at, format!("node {node} occurs twice in `{}`", written(path)), None);
        }
    }
    let mut nodes = list.to_vec();
    nodes.sort_unstable();
    (report.total() == before).then_some(nodes)
}

/// The nodes of each body: of its group with this name, or else of its side at rest.
fn named(name: &str, bodies: &[SceneBody], path: &[PathPart<'_>], report: &mut Collector<'_>) -> Option<Vec<Vec<u32>>> {
    /// The most groups that are named in a message.
    const NAMED: usize = 20;
    let of_body = |body: &SceneBody| body.groups.iter().find(|group| group.name == name).map(|one| one.points.clone());
    let found: Vec<Option<Vec<u32>>> = bodies.iter().map(of_body).collect();
    let is_flat = bodies[0].body.dimension == Dimension::Plane;
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
        let message = format!("`{}` is {side}, but {body} is in the plane", written(path));
        report.at(path, message, "expected \"left\", \"right\", \"bottom\" or \"top\"");
        return None;
    }
    let sides: Vec<String> = Side::ALL.iter().filter(|side| is_there(side)).map(typed).collect();
    let mut groups: Vec<&str> = bodies.iter().flat_map(|body| &body.groups).map(|group| group.name.as_str()).collect();
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
    report.at(path, format!("`{}` is {}; {expected}", written(path), quoted(name)), help);
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
    let most = body.rest.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let close = ROUND_OFF * body.extent();
    (0..).zip(&body.rest).filter(|(_, node)| along(node) >= most - close).map(|(node, _)| node).collect()
}

fn within(
    region: &RegionFile,
    bodies: &[SceneBody],
    layers: &[OnceCell<Vec<Layers>>],
    path: &[PathPart<'_>],
    report: &mut Collector<'_>,
) -> Option<Vec<Vec<u32>>> {
    let dimension = bodies[0].body.dimension;
    let mut point = |typed, key| vector(typed, dimension, &key_path![path; key], report);
    // The end of a lattice may be at -0.30000000000000004 m, but is typed as -0.3.
    let close = |body: &SceneBody| ROUND_OFF * body.body.extent();
    let inside = |body: &SceneBody, is_inside: &dyn Fn(DVec3, f64) -> bool| -> Vec<u32> {
        let position = (0..).zip(&body.initial.position);
        position.filter(|(_, at)| is_inside(**at, close(body))).map(|(node, _)| node).collect()
    };
    let nodes: Vec<Vec<u32>> = match region {
        RegionFile { of: Some(of), within: Some(within), .. } => {
            let middle = point(of, "of")?;
            let is_inside = |at: DVec3, close: f64| at.distance(middle) <= *within + close;
            bodies.iter().map(|body| inside(body, &is_inside)).collect()
        }
        RegionFile { low: Some(low), high: Some(high), .. } => {
            let (low, high) = (point(low, "low"), point(high, "high"));
            let (low, high) = (low?, high?);
            if low.cmpgt(high).any() {
                let message = format!("`{}.low` does not lie below `high` along every axis", written(path));
                report.at(&key_path![path; "low"], message, None);
                return None;
            }
            let is_inside = |at: DVec3, close: f64| at.cmpge(low - close).all() && at.cmple(high + close).all();
            let nodes: Vec<Vec<u32>> = bodies.iter().map(|body| inside(body, &is_inside)).collect();
            for ((body, nodes), layers) in bodies.iter().zip(&nodes).zip(layers) {
                warn_of_rest(nodes, layers.get_or_init(|| layers_of(&body.body)), body, path, report);
            }
            nodes
        }
        // The schema rules this out.
        _ => return None,
    };
    if nodes.iter().all(Vec::is_empty) {
        let message = format!("`{}` is a region without nodes at the start", written(path));
        let all: Vec<DVec3> = bodies.iter().flat_map(|body| &body.initial.position).copied().collect();
        let start = match bodies {
            [only] => format!("{} starts", only.in_words()),
            _ => "the bodies start".to_owned(),
        };
        report.at(path, message, format!("{start} {}", between(&all, dimension)));
        return None;
    }
    Some(nodes)
}

/// Coordinates that are closer than this part of the body's longest side are equal.
const ROUND_OFF: f64 = 1e-9;

/// Nodes with equal coordinates along one axis at rest, such as the layers of a lattice.
#[derive(Clone)]
struct Layers {
    /// The layer of each node.
    of: Vec<u32>,
    /// The number of nodes in each layer.
    sizes: Vec<usize>,
}

/// The layers of a body along each axis.
fn layers_of(body: &Body) -> Vec<Layers> {
    let close = ROUND_OFF * body.extent();
    let along = |axis: usize| {
        let at = |node: usize| body.rest[node][axis];
        let mut order: Vec<usize> = (0..body.len()).collect();
        order.sort_by(|&a, &b| at(a).total_cmp(&at(b)));
        let (mut of, mut sizes) = (vec![0; order.len()], Vec::new());
        for layer in order.chunk_by(|&a, &b| at(b) - at(a) <= close) {
            layer.iter().for_each(|&node| of[node] = sizes.len() as u32);
            sizes.push(layer.len());
        }
        Layers { of, sizes }
    };
    (0..if body.dimension == Dimension::Plane { 2 } else { 3 }).map(along).collect()
}

/// Warns of a box that includes the same part of each layer at one end of the body, probably typed for a body at
/// another place. Such a box is thin along one axis, with less than half of the layers, and has at least half of them
/// along the others. Boxes around rows and corners are thin along several axes.
fn warn_of_rest(nodes: &[u32], layers: &[Layers], body: &SceneBody, path: &[PathPart<'_>], report: &mut Collector<'_>) {
    let (position, dimension) = (&body.initial.position, body.body.dimension);
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
            "`{}` takes {} of the {} nodes of {what} of {}",
            written(path),
            count(nodes.len() as u128),
            count(whole.len() as u128),
            body.in_words(),
        );
        report.warn(path, message, format!("{these} {}", between(&whole, dimension)));
    }
}

/// The bounding box of points in words.
fn between(points: &[DVec3], dimension: Dimension) -> String {
    let words = |corner: Vec<f64>| corner.into_iter().map(fine).collect::<Vec<_>>().join(", ");
    let [low, high] = corners(points, dimension).map(words);
    format!("between [{low}] and [{high}] m")
}
