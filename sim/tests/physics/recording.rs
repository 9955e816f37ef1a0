//! Runs that were computed elsewhere.

use super::support::{lattice, shape_based};
use glam::DVec3;
use localshape_sim::{Divergence, Field, Integrator, Moment, Recording, State, Status, Stepping, Surroundings, World};
use std::sync::Arc;

/// The states of another world, one for each step up to the last.
struct Played(Vec<State>);

impl Recording for Played {
    fn end(&self) -> Divergence {
        let step = self.0.len() as u64;
        Divergence { time: (step - 1) as f64 * 1e-3, step, part: 0, element: None, is_end: true }
    }

    fn show(&mut self, steps: u64, state: &mut State) {
        let Self(states) = self;
        state.position.clone_from(&states[steps as usize].position);
        state.velocity.clone_from(&states[steps as usize].velocity);
    }
}

#[test]
fn a_recording_shows_the_states_of_its_run_and_all_diagnostics_that_need_no_model() {
    let (body, model) = (lattice(2, 0.1), shape_based(1e4, 0.0));
    let start = State::new(body.rest().iter().map(|&at| at * 1.1).collect(), vec![DVec3::X; body.len()]);
    let gravity = DVec3::Y * -9.8;
    let around = Surroundings { gravity, ..Surroundings::default() };
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-3);
    let mut own = World::new(&body, start.clone(), &model, around, stepping);
    let mut states = vec![own.state().clone()];
    for _ in 0..20 {
        own.advance(1);
        states.push(own.state().clone());
    }
    let mut played = World::recorded(&[Arc::clone(&body)], start, gravity, 1e-3, Box::new(Played(states.clone())));
    for steps in [0, 3, 4, 13] {
        while !played.advance_towards(Moment { count: steps as f64, rate: 1e3 }, 2) {}
        assert_eq!(played.state().position, states[steps].position, "step {steps}");
    }
    played.advance(7);
    for world in [&mut own, &mut played] {
        world.show(Some(Field::ElasticEnergy));
    }
    let [own, shown] = [own.snapshot(), played.snapshot()];
    assert_eq!((shown.step, shown.status, &shown.velocity), (20, Status::Ok, &own.velocity));
    let [ours, theirs] = [own.diagnostics, shown.diagnostics];
    let known = |one: localshape_sim::Diagnostics| {
        (one.kinetic, one.gravitational, one.momentum, one.turned_over, one.volume_ratio, one.shape_error)
    };
    assert_eq!(known(ours), known(theirs));
    assert!(
        ours.elastic > 0.0
            && [theirs.elastic, theirs.energy, theirs.residual, theirs.global_rotations].iter().all(|no| no.is_nan())
    );
    assert!(own.field.iter().all(|energy| *energy > 0.0) && shown.field.iter().all(|energy| energy.is_nan()));
    // It ends with its last state: the next step, exactly there, has none.
    let mut beyond = played.clone();
    beyond.advance(1);
    assert!(matches!(beyond.status(), Status::Diverged(end) if end.step == 21), "{:?}", beyond.status());
    // It ends like a run that diverges: only the clock goes on.
    played.advance(5);
    assert_eq!((played.steps(), &played.state().position), (25, &states[20].position));
    let Status::Diverged(end) = played.status() else { panic!("it ended") };
    assert_eq!((end.step, end.time), (21, 0.02));
    // It continues from a state like any other world.
    let again = State { steps: 5, ..State::new(states[5].position.clone(), states[5].velocity.clone()) };
    // A moment that it showed before is shown again.
    for _ in 0..2 {
        played.set_state(again.clone());
        played.advance(2);
        assert_eq!((played.status(), &played.state().position), (Status::Ok, &states[7].position));
    }
}
