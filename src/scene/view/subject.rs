//! What default values of a view depend on: bodies, runs and their surroundings.

use crate::scene::{Scene, SceneBody};
use crate::sim::Field;
use crate::sim::geometry::{self, bounds};
use crate::sim::model::ElasticModel;
use glam::DVec3;
use std::f64::consts::TAU;

impl Scene {
    /// The mean of the bodies' sides (m).
    pub(super) fn mean_side(&self) -> f64 {
        // In rising order, so that the order of bodies changes no bit.
        let mut sides: Vec<_> = self.bodies.iter().map(|one| one.side).collect();
        sides.sort_by(f64::total_cmp);
        sides.iter().sum::<f64>() / sides.len() as f64
    }

    /// Whether all bodies have cells of one side.
    pub(super) fn has_cells(&self) -> bool {
        self.bodies.iter().all(|one| one.has_cells && one.side == self.bodies[0].side)
    }

    /// The corners of the box around all bodies at the start (m).
    pub(super) fn box_at_start(&self) -> (DVec3, DVec3) {
        let starts = self.bodies.iter().map(|one| &one.initial).chain(self.runs.iter().map(|run| &run.initial));
        let boxes = starts.map(|start| bounds(&start.position));
        let around = boxes.reduce(|(low, high), (from, to)| (low.min(from), high.max(to)));
        around.expect("at least one body")
    }

    /// The size of the largest body at rest (m).
    pub(super) fn largest_extent(&self) -> f64 {
        self.bodies.iter().map(|one| one.body.extent()).fold(0.0, f64::max)
    }

    /// The number of nodes of each run; if no run is known, that of all bodies.
    pub(super) fn nodes_of_runs(&self) -> Vec<usize> {
        match self.runs.is_empty() {
            true => vec![self.bodies.iter().map(|one| one.body.len()).sum()],
            false => self.runs.iter().map(|run| run.bodies.whole().len()).collect(),
        }
    }

    /// The largest expected value of a field in the scene.
    pub(super) fn largest_value(&self, field: Field) -> f64 {
        /// The strain, and the displacement in edges of an element, that count as large.
        const LARGE: f64 = 0.5;
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let parts = || self.runs.iter().flat_map(|run| run.parts(self));
        match field {
            Field::Strain => LARGE,
            Field::Displacement => {
                // From the start of a path: half of its longest way, there and back.
                let grips = self.runs.iter().flat_map(|run| &run.grips);
                let ways =
                    grips.map(|grip| 0.5 * grip.motion.longest_way(self.mean_side())).filter(|way| way.is_finite());
                LARGE * most(&mut self.bodies.iter().map(|one| one.side).chain(ways))
            }
            Field::Distance => LARGE * self.largest_extent(),
            Field::ElasticEnergy => {
                let energy = |(model, of): (&dyn ElasticModel, &SceneBody)| {
                    0.5 * model.properties(&of.body).stiffness * (LARGE * of.side) * (LARGE * of.side)
                };
                most(&mut parts().map(energy))
            }
            Field::Speed => {
                let velocities = self.bodies.iter().flat_map(|one| &one.initial.velocity);
                let start = most(&mut velocities.map(|velocity| velocity.length()));
                let (_, high) = self.box_at_start();
                let drop = geometry::ground(&self.obstacles, 0.0).map_or(0.0, |(_, ground)| (high.y - ground).max(0.0));
                let fall = (2.0 * self.gravity.length() * drop).sqrt();
                let pushed = self.obstacles.iter().map(|obstacle| obstacle.motion.greatest_speed(self.mean_side()));
                let fastest = pushed.fold((start * start + fall * fall).sqrt(), f64::max);
                // Bodies that nothing else moves oscillate at their own frequencies.
                let swing = |(model, of): (&dyn ElasticModel, &SceneBody)| {
                    LARGE * of.side * TAU / model.properties(&of.body).shortest_period(&of.body)
                };
                if fastest > 0.0 { fastest } else { most(&mut parts().map(swing)) }
            }
        }
    }
}
