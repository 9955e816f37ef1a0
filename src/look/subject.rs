//! The subject of a view: bodies, its runs and its surroundings.

use crate::sim::Body;

use crate::sim::geometry::{self, bounds};
use crate::sim::model::ElasticModel;
use crate::sim::{Field, Obstacle, State};
use glam::DVec3;
use std::f64::consts::TAU;

/// The data on which default values of a view depend.
pub(crate) struct Subject<'a> {
    /// All bodies of the scene as one.
    pub(crate) body: &'a Body,
    /// The initial state of all bodies.
    pub(crate) initial: &'a State,
    /// Mean length of the elements' edges (m).
    pub(crate) side: f64,
    /// Whether `side` is the side of a lattice's cells.
    pub(crate) has_cells: bool,
    pub(crate) gravity: DVec3,
    pub(crate) obstacles: &'a [Obstacle],
    /// Whether nodes are held or dragged.
    pub(crate) is_gripped: bool,
    /// The name and the time step (s) of each run.
    pub(crate) runs: Vec<(&'a str, f64)>,
    /// Each model of all runs with its body.
    pub(crate) parts: Vec<(&'a dyn ElasticModel, &'a Body)>,
}

impl Subject<'_> {
    /// The largest expected value of a field in the scene.
    pub(super) fn largest(&self, field: Field) -> f64 {
        /// The strain, and the displacement in edges of an element, that count as large.
        const LARGE: f64 = 0.5;
        let side = self.side;
        match field {
            Field::Strain => LARGE,
            Field::Displacement => LARGE * side,
            Field::Distance => LARGE * self.body.extent(),
            Field::ElasticEnergy => {
                let stiffness = self.parts.iter().fold(0.0, |most: f64, (model, _)| most.max(model.stiffness()));
                0.5 * stiffness * (LARGE * side) * (LARGE * side)
            }
            Field::Speed => {
                let start = self.initial.velocity.iter().fold(0.0, |most: f64, v| most.max(v.length()));
                let (_, high) = bounds(&self.initial.position);
                let drop = geometry::ground(self.obstacles, 0.0).map_or(0.0, |(_, ground)| (high.y - ground).max(0.0));
                let fall = (2.0 * self.gravity.length() * drop).sqrt();
                let pushed = self.obstacles.iter().map(|obstacle| obstacle.motion.greatest_speed(side));
                let fastest = pushed.fold((start * start + fall * fall).sqrt(), f64::max);
                // A body that nothing else moves oscillates at its own frequency.
                let periods = self.parts.iter().map(|(model, body)| model.shortest_period(body));
                let swing = LARGE * side * TAU / periods.fold(f64::INFINITY, f64::min);
                if fastest > 0.0 { fastest } else { swing }
            }
        }
    }
}
