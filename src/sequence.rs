//! The frames of a scene, one after the other: all runs asked for, advanced side by side.

use crate::scene::Scene;
use crate::sim::snapshot::{Frame, RunFrame};
use crate::sim::world::{Stepping, Surroundings, World};
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

    /// Goes on to a frame, which must not lie before the last one, and takes it.
    ///
    /// # Panics
    /// If the frame lies before one already taken.
    pub fn frame(&mut self, index: u64) -> Frame {
        let scene = self.scene;
        let runs = self.worlds.par_iter_mut().map(|(run, world)| {
            let target = scene.frame_step(*run, index);
            world.advance(target.checked_sub(world.steps()).expect("frames are taken in rising order"));
            RunFrame { run: *run, snapshot: world.snapshot() }
        });
        let runs: Vec<RunFrame> = runs.collect();
        let time = runs.first().map_or_else(|| scene.frame_time(index), |run| run.snapshot.time);
        Frame { index, time, runs }
    }
}

impl Scene {
    /// The world of one run, at its start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn world(&self, run: usize) -> World {
        let run = &self.runs[run];
        let surroundings = Surroundings { gravity: self.gravity, obstacles: self.obstacles.clone() };
        let stepping = Stepping { integrator: run.integrator, step: run.step };
        World::new(&self.body, self.initial.clone(), run.model.as_ref(), surroundings, stepping)
    }
}
