//! Untrusted sizes are validated here before anything is allocated.

use crate::reading::words::{count, size};
use crate::sim::census::Census;
use crate::sim::model::{ModelParameters, Needs};

/// What a scene may ask for. A scene that asks for more is refused before anything is allocated for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Nodes of the body.
    pub nodes: u64,
    /// Memory for the body and its runs (bytes), estimated.
    pub memory: u64,
    /// Length of the scene file (bytes); a body's own file has as many arrays as `memory` holds.
    pub file: u64,
}

/// One gibibyte (bytes).
const GIB: u64 = 1 << 30;

impl Default for Limits {
    /// Eight million nodes, a lattice of 200 × 200 × 200: some 15 GiB with a run of each model, which a workstation
    /// has, and steps of some seconds. One digit too many in each of three counts exceeds it. A scene file can have
    /// 256 MiB, some four million listed nodes.
    fn default() -> Self {
        Self { nodes: 8_200_000, memory: 16 * GIB, file: GIB / 4 }
    }
}

impl Limits {
    /// No limit but that of 32-bit indices and of the machine.
    pub const NONE: Self = Self { nodes: u64::MAX, memory: u64::MAX, file: u64::MAX };
}

/// What a body and its runs ask for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Demand {
    /// The body.
    pub(super) body: Census,
    /// What the model of each run needs.
    pub(super) runs: Vec<Needs>,
    /// How to make the body smaller.
    pub(super) less: &'static str,
}

/// More than is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Excess {
    /// What is asked for and what is allowed.
    pub(super) message: String,
    /// What to do.
    pub(super) help: String,
    /// The run with the most springs, if without springs the limits would be kept.
    pub(super) run: Option<usize>,
}

impl Demand {
    /// The demand of models on a body.
    pub(super) fn new<'m>(body: Census, less: &'static str, models: impl Iterator<Item = &'m ModelParameters>) -> Self {
        Self { runs: models.map(|model| model.needs(&body)).collect(), body, less }
    }

    /// Memory (bytes), a rough estimate, some tenths above what was measured on a million cubes and a few hundredths on
    /// 200 000 listed heptads and hexahedra: the body with its faces while they are matched; then for a while one model
    /// that is being made, or for each run its state and what its model keeps. Listed bodies are held as they were read
    /// besides, and hulls have faces of their own.
    pub(super) fn bytes(&self) -> u128 {
        const NODE: u128 = 80;
        const CORNER: u128 = 60;
        const NODE_IN_RUN: u128 = 120;
        const LISTED_NODE: u128 = 60;
        const LISTED_CORNER: u128 = 16;
        const HULL_CORNER: u128 = 16;
        let (nodes, corners) = (self.body.nodes, self.body.corners());
        let mut body = nodes.saturating_mul(NODE).saturating_add(corners.saturating_mul(CORNER));
        if !self.body.lattice {
            let lists = nodes.saturating_mul(LISTED_NODE).saturating_add(corners.saturating_mul(LISTED_CORNER));
            let hulls = self.body.hull_corners().saturating_mul(HULL_CORNER);
            body = body.saturating_add(lists).saturating_add(hulls);
        }
        let state = self.body.nodes.saturating_mul(NODE_IN_RUN);
        let making = self.runs.iter().map(|run| run.making).max().unwrap_or(0);
        let working = self.runs.iter().fold(0, |sum: u128, run| sum.saturating_add(run.working.saturating_add(state)));
        body.saturating_add(making.max(working))
    }

    /// Positions and velocities of all runs at one frame (bytes).
    pub(super) fn bytes_per_frame(&self) -> u128 {
        self.body.nodes.saturating_mul(48).saturating_mul(self.runs.len() as u128)
    }

    /// Why this machine has not enough memory, if so: the memory is allocated and freed without being touched. An allocation
    /// that fails later would abort the program without a message.
    pub(super) fn denied(&self) -> Option<Excess> {
        let bytes = usize::try_from(self.bytes()).unwrap_or(usize::MAX);
        Vec::<u8>::new().try_reserve_exact(bytes).err()?;
        let message = format!("this takes about {} of memory, which this machine does not have", size(self.bytes()));
        Some(Excess { message, help: "make the body smaller, or use a larger machine".to_owned(), run: None })
    }

    /// Why this is too much, if it is, and what to do about it.
    pub(super) fn beyond(&self, limits: &Limits) -> Option<Excess> {
        let springs = self.runs.iter().fold(0, |sum: u128, run| sum.saturating_add(run.springs));
        let several =
            |number: u128, one: &str| format!("{} {one}{}", count(number), if number == 1 { "" } else { "s" });
        let (nodes, elements) = (several(self.body.nodes, "node"), several(self.body.count(), "element"));
        let parts = match springs {
            0 => format!("{nodes} and {elements}"),
            _ => format!("{nodes}, {elements} and up to {}", several(springs, "spring")),
        };
        let (memory, frame) = (size(self.bytes()), size(self.bytes_per_frame()));
        let asked = format!("this makes {parts}, about {memory} of memory and {frame} for the states of each frame");
        let indices = self.body.nodes.max(self.body.count()) > u128::from(u32::MAX);
        let message = if indices {
            format!("{asked}: more nodes or elements than 32-bit indices can count")
        } else if self.body.nodes > u128::from(limits.nodes) {
            format!("{asked}; the limit is {} nodes", count(limits.nodes.into()))
        } else if self.bytes() > u128::from(limits.memory) {
            format!("{asked}; the limit is {}", size(limits.memory.into()))
        } else {
            return None;
        };
        let mut other = self.clone();
        other.runs.iter_mut().filter(|run| run.springs > 0).for_each(|run| *run = Needs::default());
        let run = (springs > 0 && other.beyond(limits).is_none())
            .then(|| (0..self.runs.len()).max_by_key(|&run| self.runs[run].springs))
            .flatten();
        let less = match run {
            Some(_) => "put fewer springs on each element, such as springs = \"edges\"",
            None => self.less,
        };
        let help = if indices { less.to_owned() } else { format!("{less}, or allow it with --allow-large") };
        Some(Excess { message, help, run })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::body::Dimension;
    use crate::sim::body::Solids;
    use std::collections::BTreeMap;

    fn model(text: &str) -> ModelParameters {
        toml::from_str(&format!("kind = {text}\nstiffness = 1e4")).unwrap()
    }

    fn block(cells: &[u32], models: &[ModelParameters]) -> Demand {
        Demand::new(Census::of_lattice(cells), "use fewer cells", models.iter())
    }

    /// Listed elements, each with this many nodes.
    fn listed(dimension: Dimension, corners: usize, count: u128, model: ModelParameters) -> Demand {
        let elements = BTreeMap::from([(corners, count)]);
        let solids = Solids::Ordered;
        let body = Census { dimension, nodes: corners as u128, solids, elements, lattice: false, springs: None };
        Demand::new(body, "use fewer nodes", [model].iter())
    }

    #[test]
    fn the_default_allows_a_block_of_two_hundred_cells_a_side_and_not_of_a_thousand() {
        let models = [model("'shape-based'"), model("'mass-spring'")];
        assert_eq!(block(&[200, 200, 200], &models).beyond(&Limits::default()), None);
        let excess = block(&[1000, 1000, 1000], &models[..1]).beyond(&Limits::default()).unwrap();
        let message = excess.message;
        assert!(message.starts_with("this makes 1 003 003 001 nodes and 1 000 000 000 elements"), "{message}");
        assert!(excess.help.contains("fewer cells") && excess.run.is_none(), "{}", excess.help);
    }

    #[test]
    fn springs_are_counted_by_the_topology_asked_for() {
        let polygon = |model| listed(Dimension::Plane, 60_000, 1, model).beyond(&Limits::default());
        let excess = polygon(model("'mass-spring'\nsprings = 'all'")).unwrap();
        assert!(excess.message.contains("up to 1 799 970 000 springs, about 1"), "{}", excess.message);
        assert!(excess.help.contains("springs = \"edges\""), "{}", excess.help);
        assert_eq!(excess.run, Some(0));
        // The default has the diagonals of the polygon, which is its own face.
        assert!(polygon(model("'mass-spring'")).is_some());
        assert_eq!(polygon(model("'mass-spring'\nsprings = 'edges'")), None);
        assert_eq!(polygon(model("'shape-based'")), None);
        let other = listed(Dimension::Space, 60_000, 1, model("'mass-spring'\nsprings = 'edges+body-diagonals'"));
        assert!(other.beyond(&Limits::default()).is_some());
    }

    #[test]
    fn nodes_and_elements_must_be_counted_by_32_bits() {
        let beyond = |corners, count| {
            let demand = listed(Dimension::Space, corners, count, model("'shape-based'"));
            demand.beyond(&Limits::NONE).map(|excess| excess.message)
        };
        assert_eq!(beyond(8, (1 << 32) - 1), None);
        assert!(beyond(8, 1 << 32).unwrap().contains("32-bit"));
        // A thousand cells a side can be counted, if they are allowed.
        assert_eq!(block(&[1000, 1000, 1000], &[model("'shape-based'")]).beyond(&Limits::NONE), None);
    }

    #[test]
    fn what_no_machine_gives_is_said_beforehand() {
        let demand = listed(Dimension::Space, 8, 1 << 60, model("'shape-based'"));
        assert!(demand.denied().unwrap().message.contains("which this machine does not have"));
        assert_eq!(block(&[1, 1, 1], &[model("'shape-based'")]).denied(), None);
    }

    #[test]
    fn no_size_overflows() {
        let models = [model("'shape-based'"), model("'mass-spring'\nsprings = 'all'")];
        assert!(block(&[u32::MAX; 3], &models).beyond(&Limits::NONE).is_some());
        assert!(listed(Dimension::Plane, usize::MAX, u128::MAX, models[1].clone()).beyond(&Limits::NONE).is_some());
        assert!(block(&[100, 100, 100], &models).beyond(&Limits::NONE).is_none());
    }
}
