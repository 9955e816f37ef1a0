//! Bodies that go through each other: nothing keeps them apart.

use crate::reading::words::short;
use crate::scene::Scene;
use crate::sim::geometry::overlaps;
use crate::sim::{Frame, Status};
use glam::DVec3;
use std::collections::BTreeSet;

/// Looks at frames for bodies that go through each other. A scene with one body takes no time.
pub(crate) struct Meetings<'a> {
    scene: &'a Scene,
    /// Each run with the pairs of its bodies that overlapped before; `None` once a pair was found.
    runs: Vec<(usize, Option<BTreeSet<[usize; 2]>>)>,
}

impl<'a> Meetings<'a> {
    /// Begins before the first frame of runs at these positions of their nodes (m). Bodies that overlap then were told of
    /// before.
    pub(crate) fn new<'p>(scene: &'a Scene, runs: &[usize], positions: impl Iterator<Item = &'p [DVec3]>) -> Self {
        let before = |(&run, position): (&usize, &'p [DVec3])| {
            // What recorded bodies do is not known here.
            let simulated = scene.runs[run].recording.is_none();
            (run, simulated.then(|| overlaps(&scene.runs[run].bodies, position, |_| true).collect()))
        };
        Self { scene, runs: runs.iter().zip(positions).map(before).collect() }
    }

    /// The message for each run in which two bodies overlap in a frame, and in none before: the first pair in each run.
    pub(crate) fn look(&mut self, frame: &Frame) -> Vec<String> {
        let mut messages = Vec::new();
        for ((number, before), shown) in self.runs.iter_mut().zip(&frame.runs) {
            let (run, snapshot) = (&self.scene.runs[*number], &shown.snapshot);
            let Some(known) = before.as_ref().filter(|_| snapshot.status == Status::Ok) else { continue };
            let first = overlaps(&run.bodies, &snapshot.position, |pair| !known.contains(&pair)).next();
            if let Some(pair) = first {
                let [one, other] = pair.map(|body| &self.scene.bodies[run.of[body]].name);
                let (time, name) = (short(snapshot.time), &run.name);
                let message = format!("“{one}” and “{other}” go through each other from {time} s on in “{name}”");
                messages.push(format!("{message}: bodies do not collide"));
                *before = None;
            }
        }
        messages
    }
}
