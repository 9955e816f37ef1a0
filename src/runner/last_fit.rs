//! The drawn state of a run that diverged: the last one that is not much wider than the body.

use crate::scene::{Run, Scene};
use crate::sim::{Crew, Divergence, Snapshot, State, Status, World};
use glam::DVec3;

/// A state fits if the nodes of each body lie within this many times the radius of the body at rest or at the start,
/// whichever is larger. Sound motions seldom stretch a body so far, and diverging ones have hardly begun to.
const FITS: f64 = 1.5;
/// The number of steps between tests of a state. From the last fitting one on, each step is tested.
const STRIDE: u64 = 64;

/// The last fitting state of a run that diverges, and the drawn snapshot.
#[derive(Clone, Debug)]
pub(crate) struct Fitting {
    /// The state. Its status has the divergence.
    pub(crate) state: State,
    /// The drawn snapshot.
    pub(crate) shown: Snapshot,
}

impl Fitting {
    /// The last fit with a state, in the world of its run, which takes the state.
    pub(crate) fn new(world: &mut World, state: State) -> Self {
        let present = world.state().clone();
        world.set_state(state.clone());
        let snapshot = world.snapshot();
        world.set_state(present);
        Self { state, shown: snapshot }
    }
}

/// Whether a state of a run with nodes at `position` (m) fits.
pub(crate) fn fits(run: &Run, position: &[DVec3]) -> bool {
    let at_rest = run.bodies.bodies().iter().map(|body| radius(body.rest()));
    let usual = at_rest.zip(radii(run, &run.initial.position));
    radii(run, position).zip(usual).all(|(now, (at_rest, at_start))| now <= FITS * at_rest.max(at_start))
}

/// The radius of each body of a run with nodes at `position` (m).
fn radii<'a>(run: &'a Run, position: &'a [DVec3]) -> impl Iterator<Item = f64> + 'a {
    (0..run.of.len()).map(|body| radius(&position[run.bodies.nodes(body)]))
}

/// The search for the last fitting state of a run that diverges. It simulates the run again. So only runs pay for it
/// that diverge or have a state that does not fit.
pub(crate) struct Search {
    run: usize,
    world: World,
    /// The last tested step.
    last: u64,
    stride: u64,
    /// The last state that fits so far.
    fitting: State,
    /// The divergence.
    end: Option<Divergence>,
}

impl Search {
    /// The search in a run of a scene, with its own threads.
    pub(crate) fn new(scene: &Scene, run: usize, threads: usize) -> Self {
        let mut world = scene.world(run);
        world.set_crew(Crew::new(threads));
        let last = world.steps_at(scene.moment(scene.last_frame()));
        let fitting = world.state().clone();
        Self { run, world, last, stride: STRIDE, fitting, end: None }
    }

    /// Searches through about this many steps, and returns the result at the end: the inner `None` means that the run
    /// does not diverge.
    pub(crate) fn advance(&mut self, scene: &Scene, most_steps: u64) -> Option<Option<Fitting>> {
        let (mut left, run) = (most_steps, &scene.runs[self.run]);
        loop {
            let Self { world, last, stride, fitting, end, .. } = self;
            if world.steps() < *last {
                if left == 0 {
                    return None;
                }
                let steps = (*stride).min(*last - world.steps());
                left = left.saturating_sub(steps);
                world.advance(steps);
                if let Status::Diverged(divergence) = world.status() {
                    *last = divergence.step - 1;
                    *end = Some(divergence);
                } else if fits(run, &world.state().position) {
                    fitting.clone_from(world.state());
                }
                continue;
            }
            let Some(divergence) = end else { return Some(None) };
            if *stride == 1 {
                fitting.status = Status::Diverged(*divergence);
                let fitting = fitting.clone();
                return Some(Some(Fitting::new(world, fitting)));
            }
            *stride = 1;
            world.set_state(fitting.clone());
        }
    }
}

/// The distance of the farthest point from the mean of all (m), which rotations do not change.
fn radius(points: &[DVec3]) -> f64 {
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max)
}

#[cfg(test)]
#[path = "../../tests/inside/last_fit.rs"]
mod tests;
