//! What the search for [rest](crate::rest) needs of a [`World`]: forces by steps from rest, without time.

use super::World;
use crate::crew::Crew;
use crate::limit::SpeedLimit;
use glam::DVec3;
use std::sync::Arc;

impl World {
    /// Lets nodes have any speed, and uses threads that others use, too.
    pub(crate) fn set_free(&mut self, crew: &Arc<Crew>) {
        self.system.crew = Arc::clone(crew);
        self.limit = SpeedLimit::NONE;
    }

    /// The mass of each node (kg).
    pub(crate) fn masses(&self) -> &[f64] {
        &self.system.mass
    }

    /// Time step ΔT (s).
    pub(crate) fn step(&self) -> f64 {
        self.system.step
    }

    /// Whether surfaces can meet.
    pub(crate) fn has_surfaces(&self) -> bool {
        self.system.contact.is_some()
    }

    /// Whether kinematic constraints hold each node at the start.
    pub(crate) fn held_at_start(&self) -> Vec<bool> {
        let mut held = vec![false; self.state.position.len()];
        let grips = self.system.surroundings.grips.iter().filter(|grip| grip.holds(0.0));
        grips.flat_map(|grip| &grip.nodes).for_each(|&node| held[node as usize] = true);
        held
    }

    /// Gravity and loads on nodes at some positions (m) at the start (N).
    pub(crate) fn loads(&self, position: &[DVec3]) -> Vec<DVec3> {
        let mut forces: Vec<_> = self.system.mass.iter().map(|&mass| self.system.surroundings.gravity * mass).collect();
        self.system.surroundings.push(0.0, position, &mut forces);
        forces
    }

    /// Puts nodes at rest at some positions (m). Models keep their memory.
    pub(crate) fn place(&mut self, position: &[DVec3]) {
        self.state.position.copy_from_slice(position);
        self.state.velocity.fill(DVec3::ZERO);
        self.dynamics.place(&self.state);
    }

    /// Takes a step, after which the state has the positions and velocities of nodes, and the memory of models from before. False if the step was
    /// not taken, as a velocity is not finite.
    pub(crate) fn take_step(&mut self) -> bool {
        let Self { system, dynamics, limit, state, .. } = self;
        let is_taken = dynamics.advance(system, limit, state, 1).is_ok();
        dynamics.read(state);
        is_taken
    }
}
