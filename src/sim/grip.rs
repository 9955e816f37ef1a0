//! Kinematic constraints: nodes that are held, or grabbed, dragged along a path and let go (the manipulation of the
//! paper's title).

use super::motion::{Interval, Motion, Pose};
use super::state::State;
use glam::DVec3;

/// Nodes that follow a path from one time to another, whatever forces act on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// When they are gripped (s).
    pub from: f64,
    /// When they are let go (s); infinite for never.
    pub until: f64,
    /// How they move. Only the displacement since `from` counts; it rotates about the mean of the nodes as they were gripped.
    pub motion: Motion,
}

impl Grip {
    /// The displacement since the nodes were gripped, at a time (s), about the mean of the nodes then.
    pub(crate) fn way(&self, time: f64) -> Pose {
        let (first, now) = (self.motion.pose(self.from), self.motion.pose(time));
        Pose { shift: now.shift - first.shift, rotation: now.rotation * first.rotation.conjugate() }
    }

    /// Whether the nodes follow the path at a time (s).
    pub(crate) fn holds(&self, time: f64) -> bool {
        self.from <= time && time <= self.until
    }
}

/// What a grip remembers: whether it holds its nodes (0 or 1), then where each was when it was gripped (m).
impl Grip {
    /// How many numbers it remembers.
    pub(super) fn width(&self) -> usize {
        1 + 3 * self.nodes.len()
    }

    /// Its memory at the start. What it holds from the beginning is brought to a stop.
    pub(super) fn start(&self, state: &mut State) -> Vec<f64> {
        let mut memory = vec![0.0; self.width()];
        if self.holds(0.0) {
            self.nodes.iter().for_each(|&node| state.velocity[node as usize] = DVec3::ZERO);
            self.take(&mut memory, |node| state.position[node as usize]);
        }
        memory
    }

    /// Takes the nodes where they are at the start of a step, if it is to hold them at its end (s).
    pub(super) fn reach(&self, end: f64, memory: &mut [f64], position: impl FnMut(u32) -> DVec3) {
        if self.takes(end, memory) {
            self.take(memory, position);
        }
    }

    /// Whether it takes its nodes at the beginning of a step that ends at a time (s).
    pub(super) fn takes(&self, end: f64, memory: &[f64]) -> bool {
        memory[0] == 0.0 && self.moves(end)
    }

    /// Whether it moves nodes in a step that ends at a time (s): not in the one that ends just as it grips them.
    pub(super) fn moves(&self, end: f64) -> bool {
        self.from < end && end <= self.until
    }

    fn take(&self, memory: &mut [f64], mut position: impl FnMut(u32) -> DVec3) {
        memory[0] = 1.0;
        for (&node, gripped) in self.nodes.iter().zip(memory[1..].as_chunks_mut::<3>().0) {
            *gripped = position(node).to_array();
        }
    }

    /// For each node that it holds at the end of a step: where it is then (m), and its velocity (m/s), the way that it has
    /// gone in the step over the step: with that it flies on when it is let go.
    pub(super) fn moved(&self, interval: Interval, memory: &[f64]) -> impl Iterator<Item = (usize, DVec3, DVec3)> {
        let Interval { begin, end, step } = interval;
        let is_held = self.moves(end) && memory[0] == 1.0;
        let gripped = memory[1..].as_chunks::<3>().0.iter().map(|&at| DVec3::from_array(at));
        let middle = gripped.clone().sum::<DVec3>() / self.nodes.len().max(1) as f64;
        let (way, before) = (self.way(end), self.moves(begin).then(|| self.way(begin)));
        let nodes = self.nodes.iter().zip(gripped).take(if is_held { usize::MAX } else { 0 });
        nodes.map(move |(&node, start)| {
            let to = way.apply(middle, start);
            let from = before.map_or(start, |before| before.apply(middle, start));
            (node as usize, to, (to - from) / step)
        })
    }

    /// Moves what it holds at the end of a step.
    pub(super) fn drag(&self, interval: Interval, memory: &[f64], position: &mut [DVec3], velocity: &mut [DVec3]) {
        for (node, to, speed) in self.moved(interval, memory) {
            (position[node], velocity[node]) = (to, speed);
        }
    }

    /// Gives what it holds at the end of a step the grip's velocity again.
    pub(super) fn hold(&self, interval: Interval, memory: &[f64], velocity: &mut [DVec3]) {
        for (node, _, speed) in self.moved(interval, memory) {
            velocity[node] = speed;
        }
    }
}
