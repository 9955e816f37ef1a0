//! Changes of a [`World`] between steps: of what acts on its bodies, and of their nodes.

use super::World;
use crate::contact::Obstacle;
use crate::grip::Grip;
use crate::load::Load;
use crate::state::Status;
use crate::surroundings::{Surroundings, WrongSurroundings, check_vectors};
use crate::system::System;
use glam::DVec3;
use std::sync::Arc;

impl World {
    /// What acts on the bodies.
    pub fn surroundings(&self) -> &Surroundings {
        &self.system.surroundings
    }

    /// Sets the acceleration of gravity (m/s²) from now on.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn set_gravity(&mut self, gravity: DVec3) -> Result<(), WrongSurroundings> {
        self.change(|around| around.gravity = gravity)
    }

    /// Sets the damping in proportion to masses (1/s) from now on.
    ///
    /// # Errors
    /// A number below 0, or one that is not finite.
    pub fn set_mass_damping(&mut self, damping: f64) -> Result<(), WrongSurroundings> {
        self.change(|around| around.mass_damping = damping)
    }

    /// Sets the forces on nodes from now on, such as [`Loading::dead`](crate::Loading::dead). [Steady](Load::is_steady) ones cost a fast step
    /// little. Before it evaluates others it reads the positions of [their nodes](Load::nodes).
    ///
    /// # Errors
    /// A node that is not there, or a force that is not finite now.
    pub fn set_loads(&mut self, loads: Vec<Arc<dyn Load>>) -> Result<(), WrongSurroundings> {
        self.settle();
        let (position, now) = (&self.state.position, self.system.interval(self.state.steps).begin);
        let around = Surroundings { loads, ..self.system.surroundings.clone() };
        around.check(position.len())?;
        let mut forces = vec![DVec3::ZERO; position.len()];
        around.push(now, position, &mut forces);
        check_vectors("force", "forces", &forces, position.len())?;
        let work = self.pause();
        self.system.surroundings = around;
        self.go_on(work);
        Ok(())
    }

    /// Sets the obstacles from now on. Their motions are functions of the time of the world, which goes on.
    ///
    /// # Errors
    /// A value of an obstacle that is out of range.
    pub fn set_obstacles(&mut self, obstacles: Vec<Obstacle>) -> Result<(), WrongSurroundings> {
        self.change(|around| around.obstacles = obstacles)
    }

    /// Adds a kinematic constraint, after those that are there, and returns its number. From its start, or from now on if that has passed, it
    /// holds its nodes where they are then.
    ///
    /// # Errors
    /// A node that is not there, or a value that is out of range.
    pub fn add_grip(&mut self, mut grip: Grip) -> Result<usize, WrongSurroundings> {
        grip.from = grip.from.max(self.system.interval(self.steps()).begin);
        let (number, width) = (self.system.surroundings.grips.len(), grip.width());
        self.change(|around| around.grips.push(grip))?;
        let memory = &mut self.state.memory.constraints;
        memory.resize(memory.len() + width, 0.0);
        Ok(number)
    }

    /// Takes a kinematic constraint away and returns it; those after it move up by one number. Its nodes go on with their velocities. `None`
    /// if there is no such constraint.
    pub fn remove_grip(&mut self, number: usize) -> Option<Grip> {
        if number >= self.system.surroundings.grips.len() {
            return None;
        }
        let work = self.pause();
        let grip = self.system.surroundings.grips.remove(number);
        let first: usize = self.system.surroundings.grips[..number].iter().map(Grip::width).sum();
        self.state.memory.constraints.drain(first..first + grip.width());
        self.go_on(work);
        Some(grip)
    }

    /// Sets the positions (m) and velocities (m/s) of all nodes. Nodes that are held go back to where they are held in the next step. A world
    /// that has diverged stays so: see [`Self::set_state`].
    ///
    /// # Errors
    /// Not one position and one velocity for each node, or one that is not finite.
    pub fn set_nodes(&mut self, position: Vec<DVec3>, velocity: Vec<DVec3>) -> Result<(), WrongSurroundings> {
        let count = self.state.position.len();
        check_vectors("position", "positions", &position, count)?;
        check_vectors("velocity", "velocities", &velocity, count)?;
        let work = self.pause();
        (self.state.position, self.state.velocity) = (position, velocity);
        self.go_on(work);
        Ok(())
    }

    /// Changes the surroundings, unless there is a mistake in them.
    fn change(&mut self, change: impl FnOnce(&mut Surroundings)) -> Result<(), WrongSurroundings> {
        let mut changed = self.system.surroundings.clone();
        change(&mut changed);
        changed.check(self.state.position.len())?;
        let work = self.pause();
        self.system.surroundings = changed;
        self.system.renew_contact();
        self.go_on(work);
        Ok(())
    }

    /// The work of forces from outside so far on each part (J); `None` without them.
    pub(super) fn work(&self) -> Option<Vec<f64>> {
        let System { work, surroundings, .. } = &self.system;
        let (work, state) = (work.as_ref()?, &self.state);
        if self.dynamics.is_recorded() && !work.load(surroundings, &state.memory.loads, state.position.len()) {
            return None;
        }
        Some(work.sums(surroundings, self.system.interval(state.steps).begin, state.nodes()))
    }

    /// Takes the state out of the code that advances it. Returns the work of forces from outside until now on each part (J).
    pub(super) fn pause(&mut self) -> Vec<f64> {
        self.settle();
        self.dynamics.restart();
        self.work().unwrap_or_else(|| vec![0.0; self.system.parts.len()])
    }

    /// Forgets what follows from the surroundings before, but the work until now.
    fn go_on(&mut self, work: Vec<f64>) {
        self.system.renew_work(work, &self.state);
        let Surroundings { obstacles, grips, .. } = &self.system.surroundings;
        let (around, steps) = ([obstacles.len(), grips.len()], self.state.steps);
        for impulses in self.system.impulses.iter_mut().filter(|kept| kept.surroundings() != around) {
            *impulses = impulses.among(around, steps);
        }
        self.settle();
        // What an implicit method has told stays true.
        if self.dynamics.unsolved(&self.state).is_none() {
            self.state.memory.integrator.clear();
        }
        if self.state.status == Status::Ok {
            self.limit = self.system.speed_limit(&self.state);
        }
    }
}
