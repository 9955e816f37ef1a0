//! The [`State`]: everything that changes in a simulation.

use glam::DVec3;

/// Everything that persists from one step to the next. A run continued from a copy of its state, or from a state that
/// was written and read back, has the same bits as one that never stopped.
///
/// An initial state has only positions and velocities; a [`World`](super::World) adds the rest.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    /// Position of each node (m), part after part.
    pub position: Vec<DVec3>,
    /// Velocity of each node (m/s).
    pub velocity: Vec<DVec3>,
    /// Steps taken. After a divergence the clock keeps counting.
    pub steps: u64,
    /// Whether the run has diverged.
    pub status: Status,
    /// The memory of models, constraints and the integrator.
    pub memory: Memory,
}

/// Where and when a run diverged. This is a result, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub struct Divergence {
    /// Time of the end of the first step that was rejected (s).
    pub time: f64,
    /// Number of that step, counted from 1.
    pub step: u64,
    /// The part of the node that exceeded the speed limit, counted from 0.
    pub part: usize,
    /// The first element of that part that contains the node; `None` if it belongs to no element.
    pub element: Option<usize>,
    /// Whether no node was too fast, but a recording of the run ends here.
    pub is_end: bool,
}

/// A node whose new velocity is NaN or above the limit. The step is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Runaway {
    /// The first such node.
    pub node: usize,
}

/// Steps whose equation an implicit method has not solved to round-off.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub struct Unsolved {
    /// Their number.
    pub steps: u64,
    /// The largest residual of a node (m/s).
    pub residual: f64,
    /// The end of the first of them (s).
    pub first: f64,
}

impl Unsolved {
    /// With one more step that ends at a time (s).
    pub(crate) fn after(known: Option<Self>, time: f64, residual: f64) -> Self {
        let Self { steps, residual: largest, first } = known.unwrap_or(Self { steps: 0, residual, first: time });
        Self { steps: steps + 1, residual: largest.max(residual), first }
    }

    /// As the memory of an integrator.
    pub(crate) fn numbers(&self) -> [f64; 3] {
        [self.steps as f64, self.residual, self.first]
    }

    /// From such a memory.
    pub(crate) fn remembered(memory: &[f64]) -> Option<Self> {
        let &[steps, residual, first] = memory else { return None };
        Some(Self { steps: steps as u64, residual, first })
    }
}

/// Whether a run has diverged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// It has not.
    #[default]
    Ok,
    /// It has; the snapshot has its last finite state.
    Diverged(Divergence),
}

/// What persists from one step to the next besides positions and velocities. The model, the constraint or the
/// integrator that writes its part defines what the numbers mean.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub struct Memory {
    /// Of the elastic models, part after part, such as the last rotation of each element.
    pub model: Vec<f64>,
    /// Of the kinematic constraints, one after the other: whether each is active, and the positions of its nodes when
    /// it became active.
    pub constraints: Vec<f64>,
    /// Of the integrator; empty if it has to start anew.
    pub integrator: Vec<f64>,
    /// Of forces of contact and of constraints, if they are kept ([`World::keep_reactions`](super::World::keep_reactions)): sums and means.
    pub contact: Vec<f64>,
    /// Of forces from outside, if there are any: their work so far (J) on each part, and the time (s) and the positions (m) and velocities (m/s)
    /// of their nodes when it was added up.
    pub loads: Vec<f64>,
}

impl Memory {
    /// All but the memory of the integrator, which a state that is only shown does not need.
    pub fn shown(&self) -> impl Iterator<Item = &f64> {
        self.model.iter().chain(&self.constraints).chain(&self.contact).chain(&self.loads)
    }

    /// The same numbers, to be changed.
    pub fn shown_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.model.iter_mut().chain(&mut self.constraints).chain(&mut self.contact).chain(&mut self.loads)
    }
}

/// Positions and velocities of the nodes of one part.
#[derive(Clone, Copy, Debug)]
pub struct Nodes<'a> {
    /// Position of each node (m).
    pub position: &'a [DVec3],
    /// Velocity of each node (m/s).
    pub velocity: &'a [DVec3],
}

impl State {
    /// An initial state with positions (m) and velocities (m/s).
    pub fn new(position: Vec<DVec3>, velocity: Vec<DVec3>) -> Self {
        Self { position, velocity, ..Self::default() }
    }

    /// An initial state with the nodes at rest at `position` (m).
    pub fn at_rest(position: Vec<DVec3>) -> Self {
        let velocity = vec![DVec3::ZERO; position.len()];
        Self::new(position, velocity)
    }

    /// All nodes.
    pub fn nodes(&self) -> Nodes<'_> {
        Nodes { position: &self.position, velocity: &self.velocity }
    }

    /// The state as bytes, for [`Self::from_bytes`]: a header, then every number as 64 bits, little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Memory { model, constraints, integrator, contact, loads } = &self.memory;
        let (diverged, [time, step, part, element]) = match self.status {
            Status::Ok => (0, [0; 4]),
            Status::Diverged(Divergence { time, step, part, element, is_end }) => (
                if is_end { 2 } else { 1 },
                [time.to_bits(), step, part as u64, element.map_or(0, |element| element as u64 + 1)],
            ),
        };
        let lengths =
            [self.position.len(), model.len(), constraints.len(), integrator.len(), contact.len(), loads.len()];
        let header = [self.steps, diverged, time, step, part, element].into_iter().chain(lengths.map(|len| len as u64));
        let vectors = self.position.iter().chain(&self.velocity).flat_map(|vector| vector.to_array());
        let memory = model.iter().chain(constraints).chain(integrator).chain(contact).chain(loads).copied();
        let words = header.chain(vectors.chain(memory).map(f64::to_bits)).map(u64::to_le_bytes);
        MARK.iter().copied().chain(words.flatten()).collect()
    }

    /// Reads what [`Self::to_bytes`] wrote; `None` if the bytes are anything else.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (words, []) = bytes.strip_prefix(MARK)?.as_chunks::<8>() else { return None };
        let (header, words) = words.split_at_checked(HEADER)?;
        let [steps, diverged, time, step, part, element, lengths @ ..]: [u64; HEADER] =
            std::array::from_fn(|at| u64::from_le_bytes(header[at]));
        let [nodes, model, constraints, integrator, contact, loads] =
            lengths.map(|length| usize::try_from(length).ok());
        let (nodes, memory) = (nodes?.checked_mul(3)?, [model?, constraints?, integrator?, contact?, loads?]);
        // The counts are untrusted: they are checked against the length of the input before anything is allocated.
        let mut rest = words;
        let mut take = |count: usize| -> Option<Vec<f64>> {
            let (taken, others) = rest.split_at_checked(count)?;
            rest = others;
            Some(taken.iter().map(|&word| f64::from_le_bytes(word)).collect())
        };
        let vectors = |numbers: Vec<f64>| numbers.as_chunks::<3>().0.iter().map(|&v| DVec3::from_array(v)).collect();
        let (position, velocity) = (vectors(take(nodes)?), vectors(take(nodes)?));
        let [model, constraints, integrator, contact, loads] = memory.map(&mut take);
        let (constraints, integrator, contact) = (constraints?, integrator?, contact?);
        let memory = Memory { model: model?, constraints, integrator, contact, loads: loads? };
        let status = match diverged {
            0 => Status::Ok,
            1 | 2 => {
                let element = element.checked_sub(1).map(|element| element as usize);
                let (time, part) = (f64::from_bits(time), part as usize);
                Status::Diverged(Divergence { time, step, part, element, is_end: diverged == 2 })
            }
            _ => return None,
        };
        rest.is_empty().then_some(Self { position, velocity, steps, status, memory })
    }
}

/// The first bytes of every state.
const MARK: &[u8] = b"localshape state 7\n";
/// Number of 64-bit words in the header.
const HEADER: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> State {
        let (model, integrator) = (vec![1.0, f64::NAN], vec![-0.0]);
        let memory = Memory { model, constraints: vec![], integrator, contact: vec![0.25], loads: vec![3.0, 0.5] };
        let status = Status::Diverged(Divergence { time: 0.3, step: 7, part: 1, element: Some(0), is_end: false });
        let (position, velocity) = (vec![DVec3::X, DVec3::splat(-0.0)], vec![DVec3::Y, DVec3::splat(1e-310)]);
        State { position, velocity, steps: 9, status, memory }
    }

    #[test]
    fn every_bit_survives_writing_and_reading() {
        for state in [state(), State::at_rest(vec![DVec3::ONE; 3]), State::default()] {
            let bytes = state.to_bytes();
            let read = State::from_bytes(&bytes).expect("what was written");
            assert_eq!(format!("{read:?}"), format!("{state:?}"));
            assert_eq!(read.to_bytes(), bytes);
        }
    }

    #[test]
    fn other_bytes_are_no_state() {
        let bytes = state().to_bytes();
        for cut in 0..bytes.len() {
            assert!(State::from_bytes(&bytes[..cut]).is_none(), "{cut}");
        }
        let changed = |at: usize, to: u8| {
            let mut bytes = bytes.clone();
            bytes[at] = to;
            bytes
        };
        assert!(State::from_bytes(&[&bytes[..], &[0; 8]].concat()).is_none());
        assert!(State::from_bytes(&changed(0, b'L')).is_none());
        // Of an earlier version.
        assert!(State::from_bytes(&changed(MARK.len() - 2, b'6')).is_none());
        // Counts too large for any memory, and a status that does not exist.
        assert!(State::from_bytes(&changed(MARK.len() + 6 * 8 + 7, 0xff)).is_none());
        assert!(State::from_bytes(&changed(MARK.len() + 8, 3)).is_none());
    }
}
