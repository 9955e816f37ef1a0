//! A method of integration from another crate.

use glam::DVec3;
use localshape_sim::integrate::{ByComposition, Composition, Evaluation, Method, Runaway, Step};
use localshape_sim::model::mass_spring::MassSpring;
use localshape_sim::{Body, Integrator, Kernel, State, Stepping, Surroundings, World};
use std::sync::Arc;

/// Two nodes with a spring, which is stretched at first.
fn world(integrator: Integrator) -> World {
    let rest = vec![DVec3::ZERO, DVec3::X];
    let elements = [&[0, 1][..]].into_iter().collect();
    let body = Arc::new(Body::builder(rest).elements(elements).masses(vec![1.0, 2.0]).build().expect("a body"));
    let spring = MassSpring { stiffness: 10.0, damping: 0.0, springs: [[0, 1]].into(), breaks_at: None };
    let start = State::at_rest(vec![DVec3::ZERO, DVec3::new(1.2, 0.1, 0.0)]);
    let around = Surroundings { gravity: DVec3::NEG_Y, ..Surroundings::default() };
    let stepping = Stepping { kernel: Kernel::Reference, ..Stepping::new(integrator, 0.02) };
    World::new(&body, start, &spring, around, stepping)
}

#[derive(Default)]
struct Euler(Evaluation);

impl Method for Euler {
    fn step(&mut self, step: &Step<'_>, state: &State, next: &mut State) -> Result<(), Runaway> {
        let time = step.interval().step;
        step.evaluate(0.0, state.nodes(), &state.memory.model, &mut self.0);
        next.memory.model.copy_from_slice(&self.0.memory);
        next.memory.integrator.clear();
        for (node, &acceleration) in self.0.acceleration.iter().enumerate() {
            next.velocity[node] = state.velocity[node] + acceleration * time;
            next.position[node] = state.position[node] + next.velocity[node] * time;
        }
        step.check(next)?;
        step.constrain(state, next, None);
        Ok(())
    }

    fn copy(&self) -> Box<dyn Method> {
        Box::<Self>::default()
    }
}

#[test]
fn a_method_of_ones_own_steps_like_the_same_method_of_the_crate() {
    let pefrl = Composition {
        drifts: &[
            0.178_617_895_844_809_1,
            -0.066_264_582_669_818_5,
            1.0 - 2.0 * (-0.066_264_582_669_818_5 + 0.178_617_895_844_809_1),
        ],
        kicks: &[0.5 - -0.212_341_831_062_605_4, -0.212_341_831_062_605_4],
    };
    let methods: [(Integrator, Box<dyn Method>); 2] = [
        (Integrator::SemiImplicitEuler, Box::<Euler>::default()),
        (Integrator::Pefrl, Box::new(ByComposition::new(pefrl))),
    ];
    for (integrator, method) in methods {
        let mut known = world(integrator);
        let mut own = world(Integrator::default());
        own.set_method(method);
        for _ in 0..50 {
            known.advance(1);
            own.advance(1);
            assert!(own.state().position.iter().zip(&known.state().position).all(|(a, b)| a.distance(*b) < 1e-14));
        }
    }
}
