//! What holds and drags nodes.

use super::body::ResolvedBody;
use super::{motion, vector};
use crate::scene::file::{GrabFile, HoldFile, NodesFile, RegionFile};
use crate::scene::report::{Report, Way, written};
use crate::scene::summary::corners;
use crate::scene::words::{count, short};
use crate::sim::body::{Dimension, bounds};
use crate::sim::grip::Grip;
use crate::sim::motion::Motion;
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

/// The grips, holds first, or `None` after reporting every mistake in them.
pub(super) fn resolve(
    holds: &[Option<HoldFile>],
    grabs: &[Option<GrabFile>],
    body: &ResolvedBody,
    report: &mut Report<'_>,
) -> Option<Vec<Grip>> {
    let mut named: Vec<(String, Vec<Way<'_>>, Grip)> = Vec::new();
    for (at, typed) in holds.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let path = vec![Way::Key("hold"), Way::Index(at)];
        let until = typed.until.unwrap_or(f64::INFINITY);
        let nodes = nodes(&typed.nodes, body, &path, report);
        if until <= typed.from {
            let message = format!("`hold[{at}]` ends at {until} s, not later than it begins at {} s", typed.from);
            report.at(&[&path[..], &[Way::Key("until")]].concat(), message, None);
        } else if let Some(nodes) = nodes {
            let grip = Grip { nodes, from: typed.from, until, motion: Motion::Still };
            named.push((format!("held by `hold[{at}]`"), path, grip));
        }
    }
    for (at, typed) in grabs.iter().enumerate() {
        let Some(typed) = typed else { continue };
        let path = vec![Way::Key("grab"), Way::Index(at)];
        let nodes = nodes(&typed.nodes, body, &path, report);
        let way = [&path[..], &[Way::Key("path")]].concat();
        if typed.path.repeat {
            let message = format!("`grab[{at}].path` repeats, so the nodes would never be let go");
            report.at_key(&[&way[..], &[Way::Key("repeat")]].concat(), message, "take `repeat` out".to_owned());
            continue;
        }
        let motion = motion::keys(&typed.path, body.body.dimension, &way, report);
        let [from, until] =
            [typed.path.keys.first(), typed.path.keys.last()].map(|key| key.map_or(0.0, |key| key.time));
        if typed.path.keys.len() == 1 {
            let message =
                format!("`grab[{at}].path` has a single key: nodes grabbed at {from} s would be let go at once");
            report.at(&way, message, "add a key, or write [[hold]] for nodes that stay where they are".to_owned());
        } else if let (Some(nodes), Some(motion)) = (nodes, motion) {
            named.push((format!("grabbed by `grab[{at}]`"), path, Grip { nodes, from, until, motion }));
        }
    }
    check_overlaps(&named, report);
    (named.len() == holds.len() + grabs.len()).then(|| named.into_iter().map(|(_, _, grip)| grip).collect())
}

/// Reports grips that end before a time step (s) has passed, so that they would hold nothing.
pub(super) fn check_steps(holds: &[Option<HoldFile>], grabs: &[Option<GrabFile>], step: f64, report: &mut Report<'_>) {
    for (at, hold) in holds.iter().enumerate() {
        let until = hold.as_ref().and_then(|hold| Some((hold.until?, hold.from)));
        if let Some((until, from)) = until.filter(|(until, from)| (0.0..step).contains(&(until - from))) {
            let message = format!("`hold[{at}]` lasts {:.3e} s, but a time step takes {step:.3e} s", until - from);
            let help = "it would hold nothing: let it last longer".to_owned();
            report.at(&[Way::Key("hold"), Way::Index(at), Way::Key("until")], message, help);
        }
    }
    for (at, grab) in grabs.iter().enumerate() {
        let path = [Way::Key("grab"), Way::Index(at), Way::Key("path")];
        grab.iter().for_each(|grab| motion::check_steps(&grab.path, step, &path, report));
    }
}

/// Reports nodes that two hands have at the same time.
fn check_overlaps(named: &[(String, Vec<Way<'_>>, Grip)], report: &mut Report<'_>) {
    let mut holders: HashMap<u32, Vec<usize>> = HashMap::new();
    for (at, (_, _, grip)) in named.iter().enumerate() {
        for &node in &grip.nodes {
            holders.entry(node).or_default().push(at);
        }
    }
    for (second, (words, path, grip)) in named.iter().enumerate() {
        // One node says it all: others of the same two hands follow from the same mistake.
        let mut clashes: BTreeMap<usize, u32> = BTreeMap::new();
        for &node in &grip.nodes {
            for &first in holders[&node].iter().take_while(|&&first| first < second) {
                let other = &named[first].2;
                if grip.from.max(other.from) < grip.until.min(other.until) {
                    clashes.entry(first).or_insert(node);
                }
            }
        }
        for (first, node) in clashes {
            let other = &named[first].2;
            let (from, until) = (grip.from.max(other.from), grip.until.min(other.until));
            let until = if until.is_finite() { format!("until {until} s") } else { "for good".into() };
            let message = format!("node {node} is {} and {words} at once, from {from} s {until}", named[first].0);
            report.at(
                &[&path[..], &[Way::Key("nodes")]].concat(),
                message,
                "leave each node to one of them at a time".to_owned(),
            );
        }
    }
}

/// The nodes that are meant, in rising order.
fn nodes(typed: &NodesFile, body: &ResolvedBody, path: &[Way<'_>], report: &mut Report<'_>) -> Option<Vec<u32>> {
    let path = [path, &[Way::Key("nodes")]].concat();
    match typed {
        NodesFile::List(list) => listed(list, body.body.len(), &path, report),
        NodesFile::Region(region) => within(region, body, &path, report),
    }
}

fn listed(list: &[u32], count: usize, path: &[Way<'_>], report: &mut Report<'_>) -> Option<Vec<u32>> {
    let before = report.total();
    let mut first = HashMap::new();
    for (place, &node) in list.iter().enumerate() {
        let at = [path, &[Way::Index(place)]].concat();
        if node as usize >= count {
            report.at(&at, format!("there is no node {node}; the body has nodes 0 to {}", count - 1), None);
        } else if first.insert(node, place).is_some() {
            report.at(&at, format!("node {node} stands twice in `{}`", written(path)), None);
        }
    }
    let mut nodes = list.to_vec();
    nodes.sort_unstable();
    (report.total() == before).then_some(nodes)
}

fn within(region: &RegionFile, body: &ResolvedBody, path: &[Way<'_>], report: &mut Report<'_>) -> Option<Vec<u32>> {
    let dimension = body.body.dimension;
    let mut point = |typed, key| vector(typed, dimension, &[path, &[Way::Key(key)]].concat(), report);
    let position = &body.initial.position;
    let nodes: Vec<u32> = match region {
        RegionFile { of: Some(of), within: Some(within), .. } => {
            let middle = point(of, "of")?;
            (0..).zip(position).filter(|(_, at)| at.distance(middle) <= *within).map(|(node, _)| node).collect()
        }
        RegionFile { low: Some(low), high: Some(high), .. } => {
            let (low, high) = (point(low, "low"), point(high, "high"));
            let (low, high) = (low?, high?);
            if low.cmpgt(high).any() {
                let message = format!("`{}.low` does not lie below `high` along every axis", written(path));
                report.at(&[path, &[Way::Key("low")]].concat(), message, None);
                return None;
            }
            let is_inside = |at: &DVec3| at.cmpge(low).all() && at.cmple(high).all();
            let nodes: Vec<u32> = (0..).zip(position).filter(|(_, at)| is_inside(at)).map(|(node, _)| node).collect();
            warn_of_rest(&nodes, position, dimension, path, report);
            nodes
        }
        // The structure of the file has been checked.
        _ => return None,
    };
    if nodes.is_empty() {
        let message = format!("`{}` is a region without nodes at the start", written(path));
        let help = format!("the body starts {}", between(position, dimension));
        report.at(path, message, help);
        return None;
    }
    Some(nodes)
}

/// Warns of a box that takes some nodes of a plane layer and leaves others, as one does that was typed for a body that
/// stands elsewhere. Nodes in a row are not meant as a layer.
fn warn_of_rest(nodes: &[u32], position: &[DVec3], dimension: Dimension, path: &[Way<'_>], report: &mut Report<'_>) {
    let axes = if dimension == Dimension::Plane { 2 } else { 3 };
    let (low, high) = bounds(position);
    let close = 1e-9 * (high - low).max_element();
    let taken: Vec<DVec3> = nodes.iter().map(|&node| position[node as usize]).collect();
    let (first, last) = bounds(&taken);
    let mut flat = (0..axes).filter(|&axis| last[axis] - first[axis] <= close);
    let (Some(axis), None) = (flat.next(), flat.next()) else { return };
    let in_layer = |at: &&DVec3| (at[axis] - first[axis]).abs() <= close;
    let layer: Vec<DVec3> = position.iter().filter(in_layer).copied().collect();
    if taken.len() < layer.len() {
        let message = format!(
            "`{}` takes {} of the {} nodes at {} = {} m",
            written(path),
            count(taken.len() as u128),
            count(layer.len() as u128),
            ["x", "y", "z"][axis],
            short(first[axis])
        );
        report.warn(path, message, format!("this layer of the body starts {}", between(&layer, dimension)));
    }
}

/// The box around points in words.
fn between(points: &[DVec3], dimension: Dimension) -> String {
    let words = |corner: Vec<f64>| corner.into_iter().map(short).collect::<Vec<_>>().join(", ");
    let [low, high] = corners(points, dimension).map(words);
    format!("between [{low}] and [{high}] m")
}
