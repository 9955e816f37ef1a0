//! The speed above which a run has diverged.

use super::hull::bounds;
use super::part::Part;
use super::state::Nodes;
use super::surroundings::Surroundings;

/// The greatest speed of a node that counts as a result. Above it the run has diverged; it stops while its last state
/// can still be drawn.
///
/// A body that oscillates through its whole extent moves at 2π extents per cycle. The factor leaves a wide margin above
/// that, and keeps the last state within some extents. Initial speeds and the speeds due to gravity, obstacles and
/// kinematic constraints are added.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SpeedLimit {
    own: f64,
    /// What gravity and forces from outside add in each second (m/s²).
    growth: f64,
    /// The time of the state from which it was computed (s).
    since: f64,
}

impl SpeedLimit {
    /// For a node of one element. The frequency of a node grows with the square root of the number of its elements.
    const EXTENTS_PER_CYCLE: f64 = 50.0;
    const MARGIN: f64 = 10.0;
    /// The greatest limit (m/s): its square is finite. It holds where loads and paths of the caller may make nodes faster than is known.
    const MOST: f64 = 1e150;

    /// Any speed that is finite.
    pub(super) const NONE: Self = Self { own: Self::MOST, growth: 0.0, since: 0.0 };

    /// The limit for one part from its state at a time (s), with the shortest period (s) of its model.
    pub(super) fn new(part: &Part, at: Nodes<'_>, surroundings: &Surroundings, step: f64, since: f64) -> Self {
        let (body, nodes) = (&part.body, part.nodes_of(at));
        let (low, high) = bounds(nodes.position);
        let extent = body.extent().max((high - low).max_element());
        let start = nodes.velocity.iter().fold(0.0, |fastest: f64, v| fastest.max(v.length()));
        let mut elements_of_node = vec![0u32; body.len()];
        body.elements.indices().iter().for_each(|&node| elements_of_node[node as usize] += 1);
        let most = f64::from(elements_of_node.into_iter().max().unwrap_or(1).max(1));
        let Surroundings { gravity, obstacles, grips, .. } = surroundings;
        let pushing = obstacles.iter().map(|obstacle| {
            // A half-space is infinite: only its rotation near the body counts.
            let reach = obstacle.shape.reach() + obstacle.shape.middle().distance(obstacle.pivot);
            let near = (low - obstacle.pivot).length().max((high - obstacle.pivot).length());
            (&obstacle.motion, if reach.is_finite() { reach } else { near + extent })
        });
        let dragging = grips.iter().map(|grip| (&grip.motion, extent));
        // Even a sudden motion moves nodes within one step by no more than its whole path.
        let moving = pushing.chain(dragging).map(|(motion, distance)| {
            let way = motion.longest_way(distance);
            (way, motion.greatest_speed(distance).min(way / step))
        });
        // A kinematic constraint may stretch a body to many times its size.
        let (farthest, fastest) =
            moving.fold((0.0, start), |(far, fast), (way, speed)| (way.max(far), speed.max(fast)));
        let extent = extent + farthest;
        let own = Self::EXTENTS_PER_CYCLE * most.sqrt() * extent / part.period + Self::MARGIN * fastest;
        let greatest = surroundings.greatest(at.position);
        let own = if greatest.is_some() { own } else { Self::MOST };
        let of_nodes = greatest.iter().flat_map(|forces| &forces[part.nodes.clone()]).zip(&body.mass);
        let pushed = of_nodes.map(|(force, mass)| force.length() / mass);
        let growth = Self::MARGIN * (gravity.length() + pushed.fold(0.0, f64::max));
        Self { own, growth, since }
    }

    /// The larger of two limits from the same time, for all parts together.
    pub(super) fn max(self, other: Self) -> Self {
        Self { own: self.own.max(other.own), growth: self.growth.max(other.growth), since: self.since }
    }

    /// The limit (m/s) at a time (s).
    pub(super) fn at(&self, time: f64) -> f64 {
        let limit = self.own + self.growth * (time - self.since);
        if limit > Self::MOST { Self::MOST } else { limit }
    }
}
