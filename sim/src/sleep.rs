//! Sleep: bodies that have come to rest are not stepped until something touches them.
//!
//! Time is divided into windows of as many steps, counted from the start, so that it makes no difference how steps are divided into
//! calls. In each window all nodes are looked at after every step, until one has moved too far from where the window began: with a
//! body that moves that is one look a window. If none has by its end, the bodies sleep.

use super::body::bounds;
use super::contact::Obstacle;
use super::motion::Interval;
use super::state::State;
use super::system::System;
use glam::DVec3;
use serde::Serialize;

/// When bodies fall asleep: after a time in which no node has moved far, and nothing that moves has touched them.
///
/// What that changes: if the motion that is left is a vibration of at most that period, or settles at least as fast, no node is ever
/// farther than twice the distance from where it would be. A body that drifts is left behind by at most the distance in each such time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sleep {
    /// How far no node moves in the time (m).
    pub distance: f64,
    /// The time (s).
    pub after: f64,
}

/// What [`State::sleep`] says.
enum Phase {
    /// The bodies move.
    Moving,
    /// They have not moved far since the window began.
    Resting,
    Asleep,
}

impl Phase {
    fn of(state: &State) -> Self {
        match state.sleep.len() {
            0 => Self::Moving,
            1 => Self::Asleep,
            _ => Self::Resting,
        }
    }
}

/// What is to be done next in a world that may sleep.
pub(super) enum Next {
    /// To take so many steps.
    Steps(u64),
    /// To take one step, and to look at its end: [`Sleep::look`].
    Look,
    /// No step was needed for a while, or none is.
    Skipped,
    /// Nothing: all steps are taken.
    Done,
}

impl Sleep {
    /// What is to be done after `now` steps, when `end` are wanted. The state has to be settled when a window begins: `settle` does it.
    pub(super) fn next(
        self,
        system: &System,
        state: &mut State,
        now: u64,
        end: u64,
        settle: impl FnOnce(&mut State),
    ) -> Next {
        let window = self.window(system.step);
        match Phase::of(state) {
            _ if now >= end => Next::Done,
            Phase::Asleep => {
                state.steps = now + self.quiet_steps(system, state, now, end);
                if state.steps < end {
                    state.sleep.clear();
                    state.woken = state.steps;
                }
                Next::Skipped
            }
            Phase::Resting => Next::Look,
            Phase::Moving if now.is_multiple_of(window) => {
                settle(state);
                state.sleep = state.position.iter().flat_map(|position| position.to_array()).collect();
                Next::Look
            }
            Phase::Moving => Next::Steps((window - now % window).min(end - now)),
        }
    }

    /// Looks at a settled state after a step, in a window in which no node has moved far before. Returns whether the bodies have
    /// fallen asleep.
    pub(super) fn look(self, system: &System, state: &mut State) -> bool {
        let begun = state.sleep.as_chunks::<3>().0.iter().map(|&at| DVec3::from_array(at));
        let is_near = |(at, begun): (&DVec3, DVec3)| at.distance_squared(begun) <= self.distance * self.distance;
        let is_quiet = state.position.iter().zip(begun).all(is_near)
            && !self.is_disturbed(system, state, ball(&state.position), system.interval(state.steps - 1));
        if !is_quiet {
            state.sleep.clear();
            return false;
        }
        let falls_asleep = state.steps.is_multiple_of(self.window(system.step));
        if falls_asleep {
            state.velocity.fill(DVec3::ZERO);
            // What an integrator knows of earlier steps is of a body that moves.
            state.memory.integrator.clear();
            state.sleep = vec![state.steps as f64];
        }
        falls_asleep
    }

    /// Steps of a window.
    fn window(self, step: f64) -> u64 {
        (self.after / step).ceil().max(1.0) as u64
    }

    /// The number of steps from `now` up to `end` until something touches the bodies.
    fn quiet_steps(self, system: &System, state: &State, now: u64, end: u64) -> u64 {
        let is_still = |obstacles: &[Obstacle]| obstacles.iter().all(Obstacle::is_still);
        if system.grips.is_empty() && system.contact.obstacles().is_some_and(is_still) {
            return end - now;
        }
        let ball = ball(&state.position);
        (now..end).take_while(|&step| !self.is_disturbed(system, state, ball, system.interval(step))).count() as u64
    }

    /// Whether something that moves touches the nodes, which lie in a ball, in a step: an obstacle, or a grip that takes, drags or
    /// releases some. Nodes that rest on an obstacle are within twice the distance of it, as they have met it in the window.
    fn is_disturbed(self, system: &System, state: &State, (centre, radius): (DVec3, f64), interval: Interval) -> bool {
        // Contact of another kind may change at any time.
        let Some(obstacles) = system.contact.obstacles() else { return true };
        let margin = 2.0 * self.distance;
        let touches = |obstacle: &Obstacle| {
            obstacle.moves_in(interval)
                && [interval.begin, interval.end].into_iter().any(|time| {
                    let placed = obstacle.at(time, interval.step);
                    placed.depth(centre) > -(margin + radius)
                        && state.position.iter().any(|&at| placed.depth(at) > -margin)
                })
        };
        system.grips.iter().any(|grip| grip.changes_in(interval)) || obstacles.iter().any(touches)
    }
}

/// A ball around points (m): its centre and its radius.
fn ball(points: &[DVec3]) -> (DVec3, f64) {
    let (low, high) = bounds(points);
    (0.5 * (low + high), 0.5 * low.distance(high))
}
