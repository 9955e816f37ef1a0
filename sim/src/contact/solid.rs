//! Obstacles with an extent, as surfaces meet them.

use super::Obstacle;
use crate::motion::Interval;
use glam::DVec3;

/// An obstacle with an extent, and its points at the start (m).
#[derive(Clone, Debug)]
pub(super) struct Solid {
    /// Its number among all obstacles.
    pub(super) number: usize,
    pub(super) obstacle: Obstacle,
    pub(super) points: Vec<DVec3>,
    /// The greatest speed of its points (m/s).
    pub(super) greatest_speed: f64,
}

impl Solid {
    /// The velocity (m/s) of its surface, if it is round, at a way `out` (m) from a point of its axis at the start of a step, beside that of
    /// this point.
    pub(super) fn drag(&self, interval: Interval, at: DVec3, out: DVec3) -> DVec3 {
        let Obstacle { pivot, .. } = self.obstacle;
        let [before, after] = [interval.begin, interval.end].map(|time| self.obstacle.pose(time));
        let way = |point: DVec3| after.apply(pivot, before.undo(pivot, point)) - point;
        (way(at + out) - way(at)) / interval.step
    }
}
