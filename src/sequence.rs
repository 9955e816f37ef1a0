//! The frames of a scene, one after the other: all runs asked for, advanced side by side.

use crate::scene::Scene;
use crate::sim::snapshot::{Frame, RunFrame};
use crate::sim::world::{Stepping, Surroundings, World};
use glam::DVec3;
use rayon::prelude::*;

/// Simulates runs of a scene and hands out frames in rising order.
///
/// It works on the rayon pool it is called from; the frames have the same bits for any number of threads.
pub struct Sequence<'a> {
    scene: &'a Scene,
    worlds: Vec<(usize, World)>,
}

impl<'a> Sequence<'a> {
    /// The given runs of a scene at their start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &'a Scene, runs: &[usize]) -> Self {
        Self { scene, worlds: runs.iter().map(|&run| (run, scene.world(run))).collect() }
    }

    /// The same without the field that the scene colours its bodies by, for those who draw nothing.
    pub fn without_field(mut self) -> Self {
        self.worlds.iter_mut().for_each(|(_, world)| world.show(None));
        self
    }

    /// Goes on towards a frame, each run by `most_steps` at most, and returns whether all runs are there. However the
    /// way is cut up, the states have the same bits.
    ///
    /// # Panics
    /// If the frame lies before one already taken.
    pub fn advance_towards(&mut self, index: u64, most_steps: u64) -> bool {
        let scene = self.scene;
        let arrived = self.worlds.par_iter_mut().map(|(run, world)| {
            let left =
                scene.frame_step(*run, index).checked_sub(world.steps()).expect("frames are taken in rising order");
            world.advance(left.min(most_steps));
            left <= most_steps
        });
        arrived.reduce(|| true, |one, other| one && other)
    }

    /// Steps taken so far, of all runs together.
    pub fn steps(&self) -> u64 {
        self.worlds.iter().fold(0, |sum, (_, world)| sum.saturating_add(world.steps()))
    }

    /// Steps that all runs together have taken when a frame is reached.
    pub fn steps_at(&self, index: u64) -> u64 {
        self.worlds.iter().fold(0, |sum, (run, _)| sum.saturating_add(self.scene.frame_step(*run, index)))
    }

    /// Goes on to a frame, which must not lie before the last one, and takes it.
    ///
    /// # Panics
    /// If the frame lies before one already taken.
    pub fn frame(&mut self, index: u64) -> Frame {
        self.advance_towards(index, u64::MAX);
        let runs = self.worlds.par_iter_mut().map(|(run, world)| RunFrame { run: *run, snapshot: world.snapshot() });
        let runs: Vec<RunFrame> = runs.collect();
        let time = runs.first().map_or_else(|| self.scene.frame_time(index), |run| run.snapshot.time);
        Frame { index, time, runs }
    }
}

impl Scene {
    /// The internal forces of a run on each node at its start (N), after Eq. (1) or Eq. (4) of the paper, without gravity.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn forces(&self, run: usize) -> Vec<DVec3> {
        self.runs[run].model.forces_at_start(&self.body, &self.initial)
    }

    /// The world of one run, at its start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn world(&self, run: usize) -> World {
        let run = &self.runs[run];
        let surroundings =
            Surroundings { gravity: self.gravity, obstacles: self.obstacles.clone(), grips: self.grips.clone() };
        let stepping = Stepping { integrator: run.integrator, step: run.step };
        let mut world = World::new(&self.body, self.initial.clone(), run.model.as_ref(), surroundings, stepping);
        world.show(self.view.colour.map(|scale| scale.field));
        world
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;

    /// Two runs with steps of their own.
    const SCENE: &str = "
        gravity = [0, -9.8, 0]
        time = { duration = 0.1, frames_per_second = 20 }
        body.lattice = { cells = [2, 1, 1], side = 0.1 }
        body.velocity = [0, -2, 0]
        obstacle = [{ kind = 'floor', restitution = 0.5 }]
        [[run]]
        name = 'shape'
        model = { kind = 'shape-based', stiffness = 1e4 }
        [[run]]
        name = 'springs'
        model = { kind = 'mass-spring', stiffness = 1e4 }
        step = 'T/70'
    ";

    #[test]
    fn the_way_to_a_frame_may_be_cut_up() {
        let scene = Scene::parse(SCENE, "small.toml", &Limits::default()).unwrap();
        let mut whole = Sequence::new(&scene, &[0, 1]);
        let whole: Vec<Frame> = (0..=2).map(|index| whole.frame(index)).collect();
        for slice in [1, 3, 1000] {
            let mut sequence = Sequence::new(&scene, &[0, 1]);
            for frame in &whole {
                let mut slices = 1;
                while !sequence.advance_towards(frame.index, slice) {
                    slices += 1;
                }
                assert_eq!(sequence.steps(), sequence.steps_at(frame.index));
                let last = if frame.index > 0 { whole[frame.index as usize - 1].runs[1].snapshot.step } else { 0 };
                assert_eq!(slices, (frame.runs[1].snapshot.step - last).div_ceil(slice).max(1));
                // A run without rotations has no residual, and NaN equals nothing: compared as text.
                assert_eq!(format!("{:?}", sequence.frame(frame.index)), format!("{frame:?}"));
            }
        }
    }
}
