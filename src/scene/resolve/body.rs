//! The body and how it starts.

use super::motion::axis;
use super::{elements, lattice, vector};
use crate::scene::file::{BodyFile, Coordinates, Positive, RunFile};
use crate::scene::limits::{Demand, Excess, Limits};
use crate::scene::report::{Report, Way};
use crate::sim::body::{Body, Dimension, IndexLists, State};
use crate::sim::census::Census;
use glam::DVec3;
use std::collections::BTreeMap;

/// A body, how it starts, and what else was said of it.
#[derive(Debug)]
pub(super) struct ResolvedBody {
    /// The body.
    pub(super) body: Body,
    /// Its start.
    pub(super) initial: State,
    /// Springs listed by hand.
    pub(super) springs: Option<Vec<[u32; 2]>>,
    /// Mean length of the elements' edges (m).
    pub(super) side: f64,
}

/// Whether a body is meant to be in the plane or in space, from the first coordinates that say so.
pub(super) fn dimension(file: &BodyFile) -> Option<Dimension> {
    let count = match (&file.lattice, &file.nodes) {
        (Some(lattice), _) => lattice.cells.len(),
        (None, nodes) => nodes.as_ref()?.first()?.0.len(),
    };
    Some(if count == 2 { Dimension::Plane } else { Dimension::Space })
}

/// The body, or `None` after reporting every mistake in it. `flawed`: keys with mistakes have been left out.
pub(super) fn resolve(
    file: &BodyFile,
    flawed: bool,
    runs: &[Option<RunFile>],
    limits: &Limits,
    report: &mut Report<'_>,
) -> Option<ResolvedBody> {
    let before = report.total();
    let dimension = dimension(file)?;
    let at = |key| [Way::Key("body"), Way::Key(key)];
    let (rest, elements) = match (&file.lattice, &file.nodes) {
        (Some(typed), _) => {
            if let Some(excess) = beyond(Census::of_lattice(&typed.cells), runs, limits) {
                let Excess { message, help, run } = excess;
                match run {
                    Some(run) => report.at(&springs_of(run), message, help),
                    None => report.at(&[at("lattice")[0], at("lattice")[1], Way::Key("cells")], message, help),
                }
                check_start(file, dimension, report);
                return None;
            }
            (lattice::nodes(&typed.cells, typed.side), lattice::elements(&typed.cells))
        }
        (None, Some(typed)) => {
            let lists = file.elements.as_deref().unwrap_or_default();
            let mut elements = BTreeMap::new();
            lists.iter().for_each(|list| *elements.entry(list.len()).or_default() += 1);
            let springs = file.springs.as_ref().map(|springs| springs.len() as u128);
            let census = Census { dimension, nodes: typed.len() as u128, elements, lattice: false, springs };
            if let Some(excess) = beyond(census, runs, limits) {
                let Excess { message, help, run } = excess;
                match run {
                    Some(run) => report.at(&springs_of(run), message, help),
                    None => report.at_key(&at("nodes"), message, help),
                }
                return None;
            }
            let nodes = points(typed, "nodes", dimension, report);
            let body = elements::Listed { dimension, nodes: &nodes, flawed: flawed || report.total() > before };
            body.check(lists, file.springs.as_deref(), file.faces.as_deref(), report);
            (nodes, lists.iter().map(Vec::as_slice).collect())
        }
        (None, None) => return None,
    };
    let mass = masses(file, rest.len(), report);
    let initial = start(file, &rest, dimension, report);
    if report.total() > before || elements.is_empty() {
        return None;
    }
    let faces: Option<IndexLists> = file.faces.as_ref().map(|faces| faces.iter().map(Vec::as_slice).collect());
    let body = Body::new(dimension, rest, mass, elements, faces.as_ref());
    let side = file.lattice.as_ref().map_or_else(|| elements::mean_edge(&body), |lattice| lattice.side);
    Some(ResolvedBody { body, initial, springs: file.springs.clone(), side })
}

/// Whether a body and its runs are too large. A run with a mistake counts as none.
fn beyond(body: Census, runs: &[Option<RunFile>], limits: &Limits) -> Option<Excess> {
    let mut models: Vec<usize> = Vec::new();
    let known = runs.iter().enumerate().filter_map(|(at, run)| Some((at, &run.as_ref()?.model)));
    let demand = Demand::new(body, known.map(|(at, model)| (models.push(at), model).1));
    let mut excess = demand.beyond(limits).or_else(|| demand.denied())?;
    excess.run = excess.run.map(|run| models[run]);
    Some(excess)
}

/// The place of a run's springs.
fn springs_of(run: usize) -> [Way<'static>; 4] {
    [Way::Key("run"), Way::Index(run), Way::Key("model"), Way::Key("springs")]
}

/// Listed points as vectors, after reporting those with another number of coordinates.
fn points(typed: &[Coordinates], key: &str, dimension: Dimension, report: &mut Report<'_>) -> Vec<DVec3> {
    let mut points = Vec::with_capacity(typed.len());
    for (at, coordinates) in typed.iter().enumerate() {
        let path = [Way::Key("body"), Way::Key(key), Way::Index(at)];
        points.push(vector(coordinates, dimension, &path, report).unwrap_or_default());
    }
    points
}

/// Reports a list that has not one entry for each node.
fn check_count(key: &str, length: usize, nodes: usize, report: &mut Report<'_>) {
    if length != nodes {
        let entries = if length == 1 { "entry" } else { "entries" };
        let message =
            format!("`body.{key}` has {length} {entries}, and the body has {nodes} nodes; expected one for each");
        report.at_key(&[Way::Key("body"), Way::Key(key)], message, None);
    }
}

fn masses(file: &BodyFile, nodes: usize, report: &mut Report<'_>) -> Vec<f64> {
    let Some(listed) = &file.masses else { return vec![file.mass.unwrap_or(1.0); nodes] };
    check_count("masses", listed.len(), nodes, report);
    listed.iter().map(|&Positive(mass)| mass).collect()
}

/// Where and how fast the body starts.
fn start(file: &BodyFile, rest: &[DVec3], dimension: Dimension, report: &mut Report<'_>) -> State {
    let (turn, spin, offset, velocity) = check_start(file, dimension, report);
    let mut listed = |typed: &Option<Vec<Coordinates>>, key| {
        let typed = typed.as_ref()?;
        check_count(key, typed.len(), rest.len(), report);
        Some(points(typed, key, dimension, report))
    };
    let mut position = listed(&file.positions, "positions").unwrap_or_else(|| rest.to_vec());
    let mut velocity = listed(&file.velocities, "velocities").unwrap_or_else(|| vec![velocity; rest.len()]);
    if let Some((axis, angle)) = turn {
        let centre = position.iter().sum::<DVec3>() / position.len() as f64;
        position.iter_mut().for_each(|point| *point = centre + turned(*point - centre, axis, angle));
    }
    position.iter_mut().for_each(|point| *point += offset);
    if let Some(spin) = spin {
        let centre = position.iter().sum::<DVec3>() / position.len() as f64;
        velocity.iter_mut().zip(&position).for_each(|(velocity, &point)| *velocity += spin.cross(point - centre));
    }
    if let Some(height) = file.lowest {
        let lowest = position.iter().fold(f64::INFINITY, |lowest, point| lowest.min(point.y));
        // In this order the lowest node stands at the very height that was typed.
        position.iter_mut().for_each(|point| point.y = height + (point.y - lowest));
    }
    State { position, velocity }
}

/// A turn (unit axis, angle), a spin (rad/s), a shift and a velocity, each with its mistakes reported and then left out.
fn check_start(
    file: &BodyFile,
    dimension: Dimension,
    report: &mut Report<'_>,
) -> (Option<(DVec3, f64)>, Option<DVec3>, DVec3, DVec3) {
    let turn = file.rotation.as_ref().and_then(|typed| {
        let path = [Way::Key("body"), Way::Key("rotation")];
        Some((axis(typed.axis.as_ref(), dimension, &path, report)?, typed.angle))
    });
    let spin = file.spin.as_ref().and_then(|typed| {
        let path = [Way::Key("body"), Way::Key("spin")];
        Some(axis(typed.axis.as_ref(), dimension, &path, report)? * typed.rate)
    });
    let mut optional = |typed: &Option<Coordinates>, key| match typed {
        Some(typed) => vector(typed, dimension, &[Way::Key("body"), Way::Key(key)], report).unwrap_or_default(),
        None => DVec3::ZERO,
    };
    (turn, spin, optional(&file.offset, "offset"), optional(&file.velocity, "velocity"))
}

/// A vector turned about a unit axis (Rodrigues' formula), to the same bits on every machine.
fn turned(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sine, cosine) = libm::sincos(angle);
    v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_y_takes_z_to_x() {
        let turned = turned(DVec3::new(0.0, 2.0, 1.0), DVec3::Y, std::f64::consts::FRAC_PI_2);
        assert!(turned.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-15, "{turned}");
    }
}
