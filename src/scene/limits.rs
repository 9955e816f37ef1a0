//! Untrusted sizes are validated here before anything is allocated.

use super::file::RunFile;
use crate::reading::words::{count, size};
use std::collections::BTreeMap;

/// The largest accepted scene. Larger scenes are refused before memory is allocated for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Nodes of the body.
    pub nodes: u64,
    /// Nodes of all elements, counted once for each run.
    pub corners: u64,
    /// Springs of all runs, if neighbours shared no springs.
    pub springs: u64,
    /// Length of the scene file (bytes).
    pub file: u64,
}

impl Default for Limits {
    /// Eight million nodes, a block of 200 × 200 × 200 with three runs: it needs about 20 GB, which a workstation has,
    /// and seconds a step. One more digit in each of three counts exceeds it. A scene file may have 256 MiB, about four
    /// million listed nodes.
    fn default() -> Self {
        Self { nodes: 8_200_000, corners: 200_000_000, springs: 700_000_000, file: 256 << 20 }
    }
}

impl Limits {
    /// No limits except 32-bit indices and the machine's memory.
    pub const NONE: Self = Self { nodes: u64::MAX, corners: u64::MAX, springs: u64::MAX, file: u64::MAX };
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
    /// The run with the most springs, if there are too many.
    pub(super) run: Option<usize>,
}

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

    /// The limit that the body with its runs exceeds, and the remedy: `less` makes the body smaller. A run with a
    /// mistake has no springs.
    pub(super) fn beyond(&self, runs: &[Option<RunFile>], limits: &Limits, less: &str) -> Option<Excess> {
        let of_run = |run: &RunFile| run.model.most_springs(&self.elements, self.springs);
        let springs_of_run: Vec<u128> = runs.iter().map(|run| run.as_ref().map_or(0, of_run)).collect();
        let springs = springs_of_run.iter().copied().fold(0, u128::saturating_add);
        let corners = self.corners().saturating_mul(runs.len().max(1) as u128);
        let memory = self.least_memory();

        let several =
            |number: u128, one: &str| format!("{} {one}{}", count(number), if number == 1 { "" } else { "s" });
        let (nodes, elements) = (several(self.nodes, "node"), several(self.count(), "element"));
        let parts = match springs {
            0 => format!("{nodes} and {elements}"),
            _ => format!("{nodes}, {elements} and up to {}", several(springs, "spring")),
        };
        let makes = if self.is_bound { "makes up to" } else { "makes" };
        let asked = format!("this {makes} {parts}, at least {} of memory", size(memory));
        let allow = |less: &str| format!("{less}, or allow it with --allow-large (in code, `Limits::NONE`)");
        let excess = |message, help| Some(Excess { message, help, run: None });
        if self.nodes.max(self.count()) > u128::from(u32::MAX) {
            excess(format!("{asked}: more nodes or elements than 32-bit indices can count"), less.to_owned())
        } else if self.nodes > limits.nodes.into() {
            excess(format!("{asked}; the limit is {} nodes", count(limits.nodes.into())), allow(less))
        } else if corners > limits.corners.into() {
            let [found, limit] = [corners, limits.corners.into()].map(count);
            let message = format!("{asked}; the elements of all runs have {found} nodes, and the limit is {limit}");
            excess(message, allow(less))
        } else if springs > limits.springs.into() {
            let message = format!("{asked}; the limit is {} springs", count(limits.springs.into()));
            let help = allow("put fewer springs on each element, such as springs = \"edges\"");
            Some(Excess { message, help, run: (0..runs.len()).max_by_key(|&run| springs_of_run[run]) })
        } else if !is_given(memory) {
            let help = "make the body smaller, or take a larger machine";
            excess(format!("{asked}, more than this machine has"), help.to_owned())
        } else {
            None
        }
    }

    /// The least memory of the body with one run (bytes), roughly: a block of a million cubes takes some tenths more.
    fn least_memory(&self) -> u128 {
        self.nodes.saturating_add(self.corners()).saturating_mul(100)
    }
}

/// Whether the machine has this much memory (bytes), tested by reserving and releasing it. An allocation that fails
/// later would abort the program without a message.
fn is_given(memory: u128) -> bool {
    let bytes = usize::try_from(memory).unwrap_or(usize::MAX);
    Vec::<u8>::new().try_reserve_exact(bytes).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs<const N: usize>(models: [&str; N]) -> Vec<Option<RunFile>> {
        let run =
            |model| toml::from_str(&format!("name = 'a'\nmodel = {{ kind = {model}, stiffness = 1e4 }}")).unwrap();
        models.map(|model| Some(run(model))).into()
    }

    fn block(side: u128) -> BodySize {
        BodySize::new((side + 1).pow(3), [(8, side.pow(3))])
    }

    fn beyond(size: &BodySize, runs: &[Option<RunFile>], limits: &Limits) -> Option<Excess> {
        size.beyond(runs, limits, "use fewer cells")
    }

    #[test]
    fn the_default_allows_a_block_of_two_hundred_cells_a_side_and_not_of_a_thousand() {
        let limits = Limits::default();
        assert_eq!(beyond(&block(200), &runs(["'shape-based'", "'mass-spring'"]), &limits), None);
        let Excess { message, help, run } = beyond(&block(1000), &runs(["'shape-based'"]), &limits).unwrap();
        assert!(message.starts_with("this makes 1 003 003 001 nodes and 1 000 000 000 elements"), "{message}");
        assert!(help.contains("fewer cells") && run.is_none(), "{help}");
        let many = runs(["'shape-based'"; 4]);
        assert!(beyond(&block(200), &many, &limits).unwrap().message.contains("of all runs"));
    }

    #[test]
    fn springs_are_counted_by_the_topology_asked_for() {
        let polygon = BodySize::new(60_000, [(60_000, 1)]);
        let excess = |model| beyond(&polygon, &runs(["'shape-based'", model]), &Limits::default());
        let Excess { message, help, run } = excess("'mass-spring', springs = 'all'").unwrap();
        assert!(message.contains("up to 1 799 970 000 springs"), "{message}");
        assert!(help.contains("springs = \"edges\"") && run == Some(1), "{help}");
        // The default topology has the diagonals of the polygon, which is its own face.
        assert!(excess("'mass-spring'").is_some());
        assert_eq!(excess("'mass-spring', springs = 'edges'"), None);
        assert_eq!(excess("'shape-based'"), None);
    }

    #[test]
    fn nodes_and_elements_must_be_counted_by_32_bits() {
        let runs = runs(["'shape-based'"]);
        let message = |count| beyond(&BodySize::new(2, [(2, count)]), &runs, &Limits::NONE).map(|one| one.message);
        assert!(!message((1 << 32) - 1).is_some_and(|message| message.contains("32-bit")));
        assert!(message(1 << 32).unwrap().contains("32-bit"));
    }

    #[test]
    fn what_no_machine_gives_is_said_beforehand() {
        let enormous = BodySize::new(8, [(usize::MAX, 1)]);
        let message = beyond(&enormous, &runs(["'shape-based'"]), &Limits::NONE).unwrap().message;
        assert!(message.contains("more than this machine has"), "{message}");
        assert_eq!(beyond(&block(1), &runs(["'shape-based'"]), &Limits::NONE), None);
    }

    #[test]
    fn no_size_overflows() {
        let all = runs(["'shape-based'", "'mass-spring', springs = 'all'"]);
        let enormous = BodySize::new(u128::MAX, [(usize::MAX, u128::MAX), (3, u128::MAX)]);
        assert!(beyond(&enormous, &all, &Limits::NONE).is_some());
    }
}
