//! Untrusted sizes are validated here before anything is allocated.

use super::file::ModelFile;
use crate::reading::words::{count, several, size};
use localshape_mesh as mesh;
use std::collections::BTreeMap;

/// The largest accepted scene. Larger scenes are refused before memory is allocated for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Nodes of all bodies.
    pub nodes: u64,
    /// Nodes of all elements, counted once for each run.
    pub corners: u64,
    /// Springs of all runs, if neighbours shared no springs.
    pub springs: u64,
    /// Length of the scene file, and of each mesh file (bytes).
    pub file: u64,
    /// Points in all moments of a recording that is copied, such as files of single moments: up to 48 bytes each.
    pub recorded: u64,
}

impl Default for Limits {
    /// Eight million nodes, a block of 200 × 200 × 200 with three runs: it needs about 20 GB, which a workstation has,
    /// and seconds a step. One more digit in each of three counts exceeds it. A scene file may have 256 MiB, about four
    /// million listed nodes. Copies of recorded moments may have 10 GB on disk.
    fn default() -> Self {
        Self { nodes: 8_200_000, corners: 200_000_000, springs: 700_000_000, file: 256 << 20, recorded: 200_000_000 }
    }
}

impl Limits {
    /// No limits except 32-bit indices and the machine's memory.
    pub const NONE: Self =
        Self { nodes: u64::MAX, corners: u64::MAX, springs: u64::MAX, file: u64::MAX, recorded: u64::MAX };

    /// The limits of a mesh file.
    pub(super) fn of_mesh(&self) -> mesh::Limits {
        let most = |limit: u64| usize::try_from(limit).unwrap_or(usize::MAX).min(u32::MAX as usize);
        mesh::Limits { points: most(self.nodes), corners: most(self.corners) }
    }
}

/// The size of a body before it is made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BodySize {
    pub(super) nodes: u128,
    /// Whether the body may come out smaller.
    pub(super) is_bound: bool,
    /// The number of elements for each number of nodes.
    pub(super) elements: BTreeMap<usize, u128>,
    /// Springs listed by hand.
    pub(super) springs: Option<u128>,
}

/// An excess over a limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Excess {
    /// The request and the limit.
    pub(super) message: String,
    /// The remedy.
    pub(super) help: String,
    /// The part to change.
    pub(super) of: Largest,
}

/// The cause of an excess.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Largest {
    /// The largest body.
    Body(usize),
    /// The model with the most springs: a run, and a place among its models.
    Model(usize, usize),
}

/// The bodies of a run and their models; `None` for models with mistakes, which have no springs.
pub(super) type RunBodies<'a> = Vec<(usize, Option<&'a ModelFile>)>;

impl BodySize {
    /// A body without listed springs: its number of nodes, and its number of elements for each number of nodes.
    pub(super) fn new(nodes: u128, elements: impl IntoIterator<Item = (usize, u128)>) -> Self {
        let elements = elements.into_iter().filter(|&(_, count)| count > 0).collect();
        Self { nodes, is_bound: false, elements, springs: None }
    }

    /// The number of elements.
    pub(super) fn count(&self) -> u128 {
        self.elements.values().copied().fold(0, u128::saturating_add)
    }

    /// Nodes of all elements, summed.
    pub(super) fn corners(&self) -> u128 {
        let each = self.elements.iter().map(|(&nodes, &count)| count.saturating_mul(nodes as u128));
        each.fold(0, u128::saturating_add)
    }

    /// The least memory of the body in one run (bytes), roughly: a block of a million cubes takes some tenths more.
    fn least_memory(&self) -> u128 {
        self.nodes.saturating_add(self.corners()).saturating_mul(100)
    }
}

/// The limit that the bodies with their runs exceed, and the remedy: `less` makes a body smaller.
pub(super) fn excess(
    bodies: &[BodySize],
    runs: &[RunBodies<'_>],
    limits: &Limits,
    less: impl Fn(usize) -> &'static str,
) -> Option<Excess> {
    let all = |of: &dyn Fn(&BodySize) -> u128| bodies.iter().map(of).fold(0, u128::saturating_add);
    let [nodes, elements, own] = [all(&|body| body.nodes), all(&BodySize::count), all(&BodySize::corners)];
    let memory = all(&BodySize::least_memory);
    let parts = || runs.iter().flatten();
    let corners = parts().map(|&(body, _)| bodies[body].corners()).fold(0, u128::saturating_add).max(own);
    let springs_of = |&(body, model): &(usize, Option<&ModelFile>)| {
        let BodySize { elements, springs, .. } = &bodies[body];
        model.map_or(0, |model| model.most_springs(elements, *springs))
    };
    let springs = parts().map(springs_of).fold(0, u128::saturating_add);

    let parts = match springs {
        0 => format!("{} and {}", several(nodes, "node"), several(elements, "element")),
        _ => {
            let [nodes, elements] = [several(nodes, "node"), several(elements, "element")];
            format!("{nodes}, {elements} and up to {}", several(springs, "spring"))
        }
    };
    let makes = match (bodies.len(), bodies.iter().any(|body| body.is_bound)) {
        (1, false) => "this makes",
        (1, true) => "this makes up to",
        (_, false) => "all bodies together make",
        (_, true) => "all bodies together make up to",
    };
    let asked = format!("{makes} {parts}, at least {} of memory", size(memory));
    let allow = |less: &str| format!("{less}, or allow it with --allow-large (in code, `Limits::NONE`)");
    let largest = (0..bodies.len()).max_by_key(|&body| (bodies[body].nodes, bodies[body].corners()))?;
    let less = less(largest);
    let excess = |message, help| Some(Excess { message, help, of: Largest::Body(largest) });
    if nodes.max(elements) > u128::from(u32::MAX) {
        excess(format!("{asked}: more nodes or elements than 32-bit indices can count"), less.to_owned())
    } else if nodes > limits.nodes.into() {
        excess(format!("{asked}; the limit is {} nodes", count(limits.nodes.into())), allow(less))
    } else if corners > limits.corners.into() {
        let [found, limit] = [corners, limits.corners.into()].map(count);
        let message = format!("{asked}; the elements of all runs have {found} nodes, and the limit is {limit}");
        excess(message, allow(less))
    } else if springs > limits.springs.into() {
        let message = format!("{asked}; the limit is {} springs", count(limits.springs.into()));
        let help = allow("put fewer springs on each element, such as springs = \"edges\"");
        let models = (0..).zip(runs).flat_map(|(run, parts)| (0..).zip(parts).map(move |(at, part)| (run, at, part)));
        let (run, at, _) = models.max_by_key(|(_, _, part)| springs_of(part))?;
        Some(Excess { message, help, of: Largest::Model(run, at) })
    } else if !is_given(memory) {
        let help = "make the body smaller, or take a larger machine";
        excess(format!("{asked}, more than this machine has"), help.to_owned())
    } else {
        None
    }
}

/// Whether the machine has this much memory (bytes), tested by reserving and releasing it. An allocation that fails
/// later would abort the program without a message.
fn is_given(memory: u128) -> bool {
    let bytes = usize::try_from(memory).unwrap_or(usize::MAX);
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}

#[cfg(test)]
#[path = "../../tests/inside/limits.rs"]
mod tests;
