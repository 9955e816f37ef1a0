//! The ways of stepping through time (Eqs. 2–3 and their rivals).

mod explicit_euler;
mod semi_implicit_euler;
mod velocity_verlet;

use super::body::State;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How positions and velocities move from one step to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Eq. (2), then Eq. (3) with the new velocity: symplectic, of first order.
    #[default]
    SemiImplicitEuler,
    /// Eqs. (2) and (3) as printed, the second with the old velocity. It gains energy without bound and is here for
    /// study: at ΔT = T/10 an oscillation grows by 18 % a step.
    ExplicitEuler,
    /// Velocity Verlet: symplectic without damping and rebounds, of second order. It evaluates the forces once a step, and
    /// twice with damping.
    VelocityVerlet,
}

/// A node whose new velocity is no number or beyond all reason: the step is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Runaway {
    /// The first such node.
    pub(super) node: usize,
}

/// One step to be taken.
pub(super) struct Step<'a> {
    /// Mass of each node (kg).
    pub(super) mass: &'a [f64],
    /// ΔT (s).
    pub(super) step: f64,
    /// The speed (m/s) beyond which a node is lost.
    pub(super) speed_limit: f64,
}

/// What acts on the nodes in a step.
pub(super) trait Acting {
    /// Writes the forces (N) at a state.
    fn forces(&mut self, state: &State, forces: &mut [DVec3]);

    /// Makes what the last evaluation of the forces found the memory from which the next one starts.
    fn commit(&mut self);

    /// Whether the forces depend on velocities.
    fn is_damped(&self) -> bool;

    /// Collisions and hands at the end of the step. `acceleration` (m/s²) is that with which each node has moved in the
    /// step; `None` if it has moved at constant velocity.
    fn constrain(&mut self, state: &mut State, acceleration: Option<&[DVec3]>);

    /// Gives the nodes that hands hold the velocities of the hands again.
    fn hold(&mut self, state: &mut State);
}

/// An integrator at work, with the memory it needs.
pub(super) enum Stepper {
    /// For both Euler methods: the forces, then the new velocities.
    Euler {
        order: Order,
        scratch: Vec<DVec3>,
    },
    VelocityVerlet(velocity_verlet::Memory),
}

/// Which velocity moves the positions.
#[derive(Clone, Copy)]
pub(super) enum Order {
    NewVelocity,
    OldVelocity,
}

impl Stepper {
    pub(super) fn new(integrator: Integrator, nodes: usize) -> Self {
        let euler = |order| Self::Euler { order, scratch: vec![DVec3::ZERO; nodes] };
        match integrator {
            Integrator::SemiImplicitEuler => euler(Order::NewVelocity),
            Integrator::ExplicitEuler => euler(Order::OldVelocity),
            Integrator::VelocityVerlet => Self::VelocityVerlet(velocity_verlet::Memory::new(nodes)),
        }
    }

    /// Takes a step.
    ///
    /// # Errors
    /// When a node would become faster than the limit; `state` is then as it was.
    pub(super) fn advance(
        &mut self,
        step: &Step<'_>,
        state: &mut State,
        acting: &mut dyn Acting,
    ) -> Result<(), Runaway> {
        match self {
            Self::Euler { order, scratch } => {
                acting.forces(state, scratch);
                acting.commit();
                match order {
                    Order::NewVelocity => semi_implicit_euler::advance(step, state, scratch)?,
                    Order::OldVelocity => explicit_euler::advance(step, state, scratch)?,
                }
                acting.constrain(state, None);
                Ok(())
            }
            Self::VelocityVerlet(memory) => velocity_verlet::advance(step, state, memory, acting),
        }
    }
}

impl Step<'_> {
    /// Eq. (2): turns forces (N) into the velocities (m/s) at the end of the step, `V + F/m ΔT`, in their place.
    ///
    /// # Errors
    /// When a node would become faster than the limit.
    #[doc(alias = "Eq. 2")]
    fn velocities(&self, state: &State, forces: &mut [DVec3]) -> Result<(), Runaway> {
        for ((force, &mass), &velocity) in forces.iter_mut().zip(self.mass).zip(&state.velocity) {
            *force = velocity + *force / mass * self.step;
        }
        self.check(forces)
    }

    fn check(&self, velocities: &[DVec3]) -> Result<(), Runaway> {
        let limit = self.speed_limit * self.speed_limit;
        // NaN is within no bounds.
        let within_bounds = |velocity: &DVec3| velocity.length_squared() <= limit;
        match velocities.iter().position(|velocity| !within_bounds(velocity)) {
            Some(node) => Err(Runaway { node }),
            None => Ok(()),
        }
    }
}
