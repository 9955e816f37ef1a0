//! Kinematic constraints: nodes that are held, or gripped, dragged along a path and released (the manipulation in the
//! title of the paper).

use super::motion::{Interval, Motion, Pose};
use super::state::State;
use glam::DVec3;

/// A kinematic constraint: from one time to another its nodes follow a path, whatever forces act on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// When the nodes are gripped (s).
    pub from: f64,
    /// When they are released (s); infinite for never.
    pub until: f64,
    /// How they move. Only the displacement since `from` matters. It rotates about the mean of the gripped positions.
    pub motion: Motion,
}

impl Grip {
    /// The displacement at a time (s), about the mean of the nodes when they were gripped.
    pub fn pose(&self, time: f64) -> Pose {
        let (first, now) = (self.motion.pose(self.from), self.motion.pose(time));
        Pose { shift: now.shift - first.shift, rotation: now.rotation * first.rotation.conjugate() }
    }

    /// The time (s) after which it does not change: it holds nodes still, or has released them.
    pub fn end(&self) -> f64 {
        if self.until.is_finite() { self.until } else { self.from.max(self.motion.end()) }
    }

    /// Whether the nodes follow the path at a time (s).
    pub fn holds(&self, time: f64) -> bool {
        self.from <= time && time <= self.until
    }
}

/// How gripped nodes move in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    middle: DVec3,
    /// The displacement at the end of the step.
    to: Pose,
    /// That at its start; `None` in the step in which they are gripped.
    from: Option<Pose>,
    step: f64,
}

impl Way {
    /// The position (m) at the end of the step of a node that was gripped at a place (m), and its velocity (m/s), which is its
    /// displacement in the step divided by the step. With that velocity it moves on when it is released.
    pub(super) fn of(&self, gripped: DVec3) -> (DVec3, DVec3) {
        let to = self.to.apply(self.middle, gripped);
        let from = self.from.map_or(gripped, |before| before.apply(self.middle, gripped));
        (to, (to - from) / self.step)
    }
}

/// The memory of a grip: whether it is active (0 or 1), then the position of each node when it was gripped (m).
impl Grip {
    /// Length of the memory.
    pub(super) fn width(&self) -> usize {
        1 + 3 * self.nodes.len()
    }

    /// The initial memory. Nodes that are held from the start get zero velocity.
    pub(super) fn start(&self, state: &mut State) -> Vec<f64> {
        let mut memory = vec![0.0; self.width()];
        if self.holds(0.0) {
            self.nodes.iter().for_each(|&node| state.velocity[node as usize] = DVec3::ZERO);
            self.take(&mut memory, |node| state.position[node as usize]);
        }
        memory
    }

    /// Grips the nodes at their positions at the start of a step, if they are to be held at its end (s).
    pub(super) fn reach(&self, end: f64, memory: &mut [f64], position: impl FnMut(u32) -> DVec3) {
        if self.takes(end, memory) {
            self.take(memory, position);
        }
    }

    /// Whether the nodes are gripped at the start of a step that ends at a time (s).
    pub(super) fn takes(&self, end: f64, memory: &[f64]) -> bool {
        memory[0] == 0.0 && self.moves(end)
    }

    /// Whether the grip moves nodes in a step that ends at a time (s): not in a step that ends exactly when they are
    /// gripped.
    pub(super) fn moves(&self, end: f64) -> bool {
        self.from < end && end <= self.until
    }

    fn take(&self, memory: &mut [f64], mut position: impl FnMut(u32) -> DVec3) {
        memory[0] = 1.0;
        for (&node, gripped) in self.nodes.iter().zip(memory[1..].as_chunks_mut::<3>().0) {
            *gripped = position(node).to_array();
        }
    }

    /// Where the nodes were when they were gripped (m).
    pub(super) fn gripped(memory: &[f64]) -> impl Iterator<Item = DVec3> + Clone {
        memory[1..].as_chunks::<3>().0.iter().map(|&at| DVec3::from_array(at))
    }

    /// The way of its nodes in a step, about the middle of where they were gripped (m).
    pub(super) fn way(&self, Interval { begin, end, step }: Interval, middle: DVec3) -> Way {
        Way { middle, to: self.pose(end), from: self.moves(begin).then(|| self.pose(begin)), step }
    }

    /// The middle of where its nodes were gripped (m).
    pub(super) fn middle(&self, memory: &[f64]) -> DVec3 {
        Self::gripped(memory).sum::<DVec3>() / self.nodes.len().max(1) as f64
    }

    /// For each node that is held at the end of a step: its position then (m), and its velocity (m/s).
    pub(super) fn moved(&self, interval: Interval, memory: &[f64]) -> impl Iterator<Item = (usize, DVec3, DVec3)> {
        let is_held = self.moves(interval.end) && memory[0] == 1.0;
        let way = self.way(interval, self.middle(memory));
        let nodes = self.nodes.iter().zip(Self::gripped(memory)).take(if is_held { usize::MAX } else { 0 });
        nodes.map(move |(&node, gripped)| {
            let (to, speed) = way.of(gripped);
            (node as usize, to, speed)
        })
    }
}
