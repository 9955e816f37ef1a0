//! Hands: nodes that are held, or grabbed, dragged along a path and let go (the manipulation of the paper's title).

use super::body::State;
use super::motion::{Motion, Pose};
use glam::DVec3;

/// Nodes that follow a hand from one time to another, whatever forces act on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// When they are gripped (s).
    pub from: f64,
    /// When they are let go (s); infinite for never.
    pub until: f64,
    /// How the hand moves. Only the way since `from` counts; it turns about the mean of the nodes as they were gripped.
    pub motion: Motion,
}

impl Grip {
    /// How far the hand has gone since it gripped, at a time (s), turning about the mean of the nodes then.
    pub fn way(&self, time: f64) -> Pose {
        let (first, now) = (self.motion.pose(self.from), self.motion.pose(time));
        Pose { shift: now.shift - first.shift, turn: now.turn * first.turn.conjugate() }
    }

    /// Whether the nodes follow the hand at a time (s).
    pub fn holds(&self, time: f64) -> bool {
        self.from <= time && time <= self.until
    }
}

/// A hand at work.
#[derive(Clone, Debug)]
pub(super) struct Hand {
    grip: Grip,
    held: Option<Held>,
}

/// What a hand holds.
#[derive(Clone, Debug)]
struct Held {
    /// The nodes as they were gripped (m).
    gripped: Vec<DVec3>,
    /// The mean of them (m).
    middle: DVec3,
    /// Where they are (m).
    now: Vec<DVec3>,
    /// How fast the last step has moved them (m/s).
    velocity: Vec<DVec3>,
}

impl Hand {
    pub(super) fn new(grip: Grip) -> Self {
        Self { grip, held: None }
    }

    /// Brings to a stop what it holds from the beginning.
    pub(super) fn start(&mut self, state: &mut State) {
        if self.grip.holds(0.0) {
            self.grip.nodes.iter().for_each(|&node| state.velocity[node as usize] = DVec3::ZERO);
            self.take(&state.position);
        }
    }

    /// Takes the nodes where they are at the start of a step, if it is to hold them at the step's end (s).
    pub(super) fn reach(&mut self, time: f64, state: &State) {
        if self.held.is_none() && self.moves(time) {
            self.take(&state.position);
        }
    }

    /// Whether it moves nodes in a step that ends at a time (s): not in the one that ends just as it grips them.
    fn moves(&self, time: f64) -> bool {
        self.grip.from < time && time <= self.grip.until
    }

    fn take(&mut self, position: &[DVec3]) {
        let gripped: Vec<_> = self.grip.nodes.iter().map(|&node| position[node as usize]).collect();
        let middle = gripped.iter().sum::<DVec3>() / gripped.len().max(1) as f64;
        let velocity = vec![DVec3::ZERO; gripped.len()];
        self.held = Some(Held { now: gripped.clone(), velocity, gripped, middle });
    }

    /// Moves what it holds at the end of a step (s) that ends at a time (s).
    ///
    /// A node's velocity is the way it has gone in the step, over the step: with that it flies on when it is let go.
    pub(super) fn drag(&mut self, time: f64, step: f64, state: &mut State) {
        if !self.moves(time) {
            return;
        }
        let Some(Held { gripped, middle, now, velocity }) = &mut self.held else { return };
        let way = self.grip.way(time);
        for (((&node, &start), now), velocity) in self.grip.nodes.iter().zip(&*gripped).zip(now).zip(velocity) {
            let to = way.apply(*middle, start);
            *velocity = (to - *now) / step;
            *now = to;
            state.position[node as usize] = to;
            state.velocity[node as usize] = *velocity;
        }
    }

    /// Gives what it holds at the end of a step that ends at a time (s) the hand's velocity again.
    pub(super) fn hold(&self, time: f64, state: &mut State) {
        if let Some(Held { velocity, .. }) = self.held.as_ref().filter(|_| self.moves(time)) {
            for (&node, &velocity) in self.grip.nodes.iter().zip(velocity) {
                state.velocity[node as usize] = velocity;
            }
        }
    }
}
