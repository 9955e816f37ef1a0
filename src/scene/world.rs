//! The simulation of a run.

use super::Scene;
use crate::sim::{Integrator, Moment, Stepping, World};
use std::sync::Arc;

impl Scene {
    /// The world of one run, at its start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn world(&self, number: usize) -> World {
        let run = &self.runs[number];
        let surroundings = run.surroundings((self.gravity, self.mass_damping), &self.obstacles, self.contacts.as_ref());
        let tolerance = run.tolerance.unwrap_or(Integrator::TOLERANCE);
        let stepping = Stepping { integrator: run.integrator, step: run.step, tolerance, kernel: run.kernel };
        let bodies = run.bodies.bodies();
        let mut world = match &run.recording {
            Some(recording) => {
                let player = Box::new(recording.player(run.step));
                World::recorded(bodies, run.initial.clone(), self.gravity, run.step, player)
            }
            None => {
                let parts: Vec<_> = run.models_and_bodies().map(|(model, body)| (Arc::clone(body), model)).collect();
                World::of_parts(&parts, run.initial.clone(), surroundings, stepping)
            }
        };
        world.show(self.view.colour.map(|scale| scale.field));
        if self.keeps_forces() {
            self.keep_contact(number, &mut world);
        }
        world
    }

    /// Keeps the forces of contact of a run, over the intervals between rows of `diagnostics.csv`, or else between frames.
    pub(crate) fn keep_contact(&self, run: usize, world: &mut World) {
        let every = self.every.map_or(self.moment(1), Moment::at);
        if self.runs[run].rest.is_some() {
            world.keep_reactions_from_rest(every);
        } else {
            world.keep_reactions(every);
        }
    }
}
