//! How large a scene may be, asked before anything is allocated.

use super::words::count;

/// What a scene may ask for. A scene that asks for more is refused before anything is allocated for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Nodes of the body.
    pub nodes: u64,
    /// Memory for the body and its runs (bytes), estimated.
    pub memory: u64,
    /// Length of the scene file (bytes).
    pub file: u64,
}

/// One gibibyte (bytes).
const GIB: u64 = 1 << 30;

impl Default for Limits {
    /// Eight million nodes, a block of 200 × 200 × 200: it takes some 14 GiB with two runs, which a workstation has,
    /// and its steps take seconds, which somebody may still want to wait for. A slip of one digit in each of three
    /// counts is beyond it. A scene file may have 256 MiB, some four million listed nodes.
    fn default() -> Self {
        Self { nodes: 8_200_000, memory: 16 * GIB, file: GIB / 4 }
    }
}

impl Limits {
    /// No limit but that of 32-bit indices and of the machine.
    pub const NONE: Self = Self { nodes: u64::MAX, memory: u64::MAX, file: u64::MAX };
}

/// What a body asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Demand {
    /// Nodes.
    pub(super) nodes: u128,
    /// Elements.
    pub(super) elements: u128,
    /// Entries in all element lists together.
    pub(super) corners: u128,
    /// Runs on this body.
    pub(super) runs: u128,
}

impl Demand {
    /// A block of cells, of any size.
    pub(super) fn of_lattice(cells: &[u32], runs: usize) -> Self {
        let product = |extra: u128| cells.iter().fold(1, |all: u128, &n| all.saturating_mul(u128::from(n) + extra));
        let elements = product(0);
        let corners = elements.saturating_mul(1 << cells.len().min(3));
        Self { nodes: product(1), elements, corners, runs: runs as u128 }
    }

    /// Memory (bytes), a rough estimate, some tenths above what was measured on a million cubes: the body with its
    /// faces while they are matched, and for each run its state, its forces and what its model keeps.
    pub(super) fn bytes(&self) -> u128 {
        const NODE: u128 = 80;
        const CORNER: u128 = 60;
        const NODE_IN_RUN: u128 = 120;
        const CORNER_IN_RUN: u128 = 70;
        let body = self.nodes.saturating_mul(NODE).saturating_add(self.corners.saturating_mul(CORNER));
        let run = self.nodes.saturating_mul(NODE_IN_RUN).saturating_add(self.corners.saturating_mul(CORNER_IN_RUN));
        body.saturating_add(run.saturating_mul(self.runs.max(1)))
    }

    /// Positions and velocities of all runs at one frame (bytes).
    pub(super) fn bytes_per_frame(&self) -> u128 {
        self.nodes.saturating_mul(48).saturating_mul(self.runs.max(1))
    }

    /// Why this is too much, if it is, and what to do.
    pub(super) fn beyond(&self, limits: &Limits) -> Option<(String, String)> {
        let asked = format!(
            "this makes {} nodes and {} elements, about {} of memory and {} for the states of each frame",
            count(self.nodes),
            count(self.elements),
            size(self.bytes()),
            size(self.bytes_per_frame()),
        );
        // Indices have 32 bits, and so has the length of all element lists and that of all faces together.
        if self.nodes > u128::from(u32::MAX) || self.corners.saturating_mul(2) > u128::from(u32::MAX) {
            return Some((format!("{asked}: more than 32-bit indices can count"), "use fewer cells".into()));
        }
        let allowed = if self.nodes > u128::from(limits.nodes) {
            format!("{} nodes", count(limits.nodes.into()))
        } else if self.bytes() > u128::from(limits.memory) {
            size(limits.memory.into())
        } else {
            return None;
        };
        Some((format!("{asked}; the limit is {allowed}"), "use fewer cells, or allow it with --allow-large".into()))
    }
}

/// An amount of memory in words.
pub(super) fn size(bytes: u128) -> String {
    match bytes {
        0..1_000_000 => format!("{} kB", bytes.div_ceil(1000)),
        1_000_000..1_073_741_824 => format!("{} MiB", bytes.div_ceil(1 << 20)),
        1_073_741_824..107_374_182_400 => format!("{:.1} GiB", bytes as f64 / GIB as f64),
        _ => format!("{} GiB", count(bytes >> 30)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_allows_a_block_of_two_hundred_cells_a_side_and_not_of_a_thousand() {
        assert_eq!(Demand::of_lattice(&[200, 200, 200], 2).beyond(&Limits::default()), None);
        let (message, help) = Demand::of_lattice(&[1000, 1000, 1000], 2).beyond(&Limits::default()).unwrap();
        assert!(message.starts_with("this makes 1 003 003 001 nodes and 1 000 000 000 elements"), "{message}");
        assert!(help.contains("fewer cells"), "{help}");
    }

    #[test]
    fn no_size_overflows() {
        let demand = Demand::of_lattice(&[u32::MAX; 3], usize::MAX);
        assert!(demand.beyond(&Limits::NONE).is_some());
        assert!(Demand::of_lattice(&[100, 100, 100], 1).beyond(&Limits::NONE).is_none());
    }
}
