//! Any way of advancing a state: forces with an integrator, or whatever else gives the same steps faster or other ones
//! better.

use super::body::{Body, bounds};
use super::crew::Crew;
use super::state::{Nodes, State};
use super::system::{Surroundings, System};

/// A way of advancing. It takes its own from the state and may hold the nodes itself while it works.
pub(super) trait Dynamics: Send + Sync {
    /// Takes so many steps from where it stands, and counts them. The crew may be put to work.
    ///
    /// # Errors
    /// When a node would become faster than the limit: it then stands before that step.
    fn advance(
        &mut self,
        system: &System,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
        crew: &mut Crew,
    ) -> Result<(), Runaway>;

    /// Writes into the state what it holds itself.
    fn settle(&mut self, _state: &mut State) {}

    /// Steps taken, of which the state may not know yet.
    fn steps(&self, state: &State) -> u64 {
        state.steps
    }

    /// The state was replaced by another one.
    fn restart(&mut self) {}
}

/// A node whose new velocity is no number or beyond all reason: the step is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Runaway {
    /// The first such node.
    pub(super) node: usize,
}

/// Beyond which speed a node is lost, so that a run that blows up stops while its last state can still be drawn.
///
/// Swinging through its whole extent, a body moves at 2π extents per cycle. The factor leaves a wide margin above that,
/// and keeps the last state within some extents. What it had at the start and what gravity, obstacles and kinematic
/// constraints add
/// comes on top.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpeedLimit {
    own: f64,
    gravity: f64,
}

impl SpeedLimit {
    /// For a node of one element; more elements pull harder, and its frequency grows with the root of their number.
    const EXTENTS_PER_CYCLE: f64 = 50.0;
    const MARGIN: f64 = 10.0;

    /// For one part from its start, with the shortest period (s) of its model.
    pub(super) fn new(body: &Body, initial: Nodes<'_>, period: f64, surroundings: &Surroundings, step: f64) -> Self {
        let (low, high) = bounds(initial.position);
        let extent = body.extent().max((high - low).max_element());
        let start = initial.velocity.iter().fold(0.0, |fastest: f64, v| fastest.max(v.length()));
        let mut elements_of_node = vec![0u32; body.len()];
        body.elements.indices().iter().for_each(|&node| elements_of_node[node as usize] += 1);
        let most = f64::from(elements_of_node.into_iter().max().unwrap_or(1).max(1));
        let Surroundings { gravity, obstacles, grips } = surroundings;
        let pushing = obstacles.iter().map(|obstacle| {
            // A half-space turns under a body that is somewhere near.
            let reach = obstacle.shape.reach() + obstacle.shape.middle().distance(obstacle.pivot);
            let near = (low - obstacle.pivot).length().max((high - obstacle.pivot).length());
            (&obstacle.motion, if reach.is_finite() { reach } else { near + extent })
        });
        let dragging = grips.iter().map(|grip| (&grip.motion, extent));
        // What it meets in one step is never faster than its whole way in that step.
        let moving = pushing.chain(dragging).map(|(motion, distance)| {
            let way = motion.longest_way(distance);
            (way, motion.greatest_speed(distance).min(way / step))
        });
        // A kinematic constraint may stretch a body to many times its size.
        let (farthest, fastest) =
            moving.fold((0.0, start), |(far, fast), (way, speed)| (way.max(far), speed.max(fast)));
        let extent = extent + farthest;
        let own = Self::EXTENTS_PER_CYCLE * most.sqrt() * extent / period + Self::MARGIN * fastest;
        Self { own, gravity: Self::MARGIN * gravity.length() }
    }

    /// For all parts together.
    pub(super) fn max(self, other: Self) -> Self {
        Self { own: self.own.max(other.own), gravity: self.gravity.max(other.gravity) }
    }

    /// The limit (m/s) at a time (s).
    pub(super) fn at(&self, time: f64) -> f64 {
        self.own + self.gravity * time
    }
}
