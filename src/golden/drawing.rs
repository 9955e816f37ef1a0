//! The pictures and states of a scene for its golden, frame by frame.

use super::folder::{Drawn, Golden};
use super::keys::Key;
use super::record::{DIGITS, Record};
use super::source::{Pictures, Source};
use super::states::{State, States};
use crate::gpu::{Gpu, adapter_name};
use crate::output::{Compression, Tags, encode, frame_file_name, recorded, state_digest};
use crate::picture::Picture;
use crate::render::{RenderError, Renderer};
use crate::runner::Frame;
use crate::scene::Scene;
use crate::sim::{Divergence, Snapshot, Status};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Spaces between the frames whose positions are recorded.
const SPACES: u64 = 10;
/// Approximate maximum size of the digests of a golden (bytes).
const ROOM_FOR_DIGESTS: usize = 24 << 10;
/// Width of new goldens (px), unless their scene is smaller: small pictures detect as much and keep repositories small.
const WIDTH: u32 = 320;
/// Number of pictures in new goldens, unless there are fewer frames.
pub(crate) const PICTURES: u64 = 3;

/// The pictures and states of a scene so far.
pub(super) struct Drawing<'s> {
    /// In the size of the golden.
    scene: &'s Scene,
    /// The frames that are drawn, and those whose positions are recorded.
    drawn: BTreeSet<u64>,
    with_positions: BTreeSet<u64>,
    /// `None` for lit bodies without a device.
    renderer: Option<Renderer>,
    adapter: String,
    states: States,
    files: Pictures,
    /// Why runs ended early.
    stopped: BTreeMap<usize, String>,
}

impl<'s> Drawing<'s> {
    /// A scene in the size of its golden, with the frames of the golden, or `pictures` of a new one.
    pub(super) fn new(
        scene: &'s Scene,
        golden: &Golden,
        pictures: u64,
        gpu: Option<&Gpu>,
    ) -> Result<Self, RenderError> {
        let last = scene.last_frame();
        let old: BTreeSet<u64> = golden.frames().into_iter().filter(|&frame| frame <= last).collect();
        let evenly = |at: u64| (u128::from(last) * u128::from(at) / u128::from(pictures.max(1))) as u64;
        let is_drawn = gpu.is_some() || !scene.is_lit();
        let (states, files, stopped) = Default::default();
        Ok(Self {
            scene,
            drawn: if old.is_empty() { (1..=pictures.max(1)).map(evenly).collect() } else { old },
            with_positions: frames_with_positions(last),
            renderer: is_drawn.then(|| Renderer::new(gpu, scene.view.size)).transpose()?,
            adapter: adapter_name(gpu.filter(|_| scene.is_lit())),
            states,
            files,
            stopped,
        })
    }

    /// Whether it has pictures.
    pub(super) fn is_drawn(&self) -> bool {
        self.renderer.is_some()
    }

    /// The frames that it needs, rising.
    pub(super) fn frames(&self) -> Vec<u64> {
        let digests = self.scene.runs.iter().map(|run| run.of.len()).sum();
        frames_with_digests(self.scene.last_frame(), digests, &self.drawn).into_iter().collect()
    }

    /// Adds the states of a frame, and draws its picture if it is wanted.
    pub(super) fn add(&mut self, frame: &Frame, compose: impl FnOnce() -> Picture) -> Result<(), RenderError> {
        let Self { scene, .. } = self;
        let index = frame.index;
        for run in &frame.runs {
            let name = &scene.runs[run.run].name;
            let with_positions = self.with_positions.contains(&index);
            add(&mut self.states, name, (scene, run.run), index, &run.snapshot, with_positions);
            if let Status::Diverged(divergence) = run.snapshot.status {
                self.stopped.entry(run.run).or_insert_with(|| stopped(scene, run.run, divergence));
            }
        }
        if let (Some(renderer), true) = (&mut self.renderer, self.drawn.contains(&index)) {
            let pixels = renderer.draw(&compose())?.into_raw();
            let texts = Tags::of_frame(scene, frame, &self.adapter).texts();
            let file = encode(scene.view.size, &pixels, &texts, Compression::Small);
            self.files.insert(frame_file_name(index), Source::Memory(file));
        }
        Ok(())
    }

    /// The scene as drawn, from its file, with its name in records and its keys.
    pub(super) fn finish(self, origin: &Path, subject: String, keys: Vec<Key>) -> Drawn {
        let is_drawn = self.is_drawn();
        let Self { scene, drawn, states, files, stopped, .. } = self;
        let record = Record { subject, size: scene.view.size, frames: drawn, keys, states };
        let (pictures, notes) = (is_drawn.then_some(files), stopped.into_values().collect());
        Drawn { origin: origin.to_owned(), record, pictures, notes }
    }
}

/// Why a run ended early, in words.
fn stopped(scene: &Scene, run: usize, Divergence { time, step, part, is_end, .. }: Divergence) -> String {
    if is_end {
        return format!("the recording of {} ends at {time:.3e} s", scene.runs[run].name);
    }
    let (name, _) = recorded(&scene.runs[run].name, scene, run).swap_remove(part);
    format!("{name} diverged at {time:.3e} s (step {step}) and is not advanced from there on")
}

/// Adds the states of a run's snapshot under a name, with their positions on request.
pub(super) fn add(
    states: &mut States,
    name: &str,
    (scene, run): (&Scene, usize),
    frame: u64,
    snapshot: &Snapshot,
    with_positions: bool,
) {
    for (name, nodes) in recorded(name, scene, run) {
        let run = states.run_mut(&name);
        run.nodes = nodes.len();
        let positions = with_positions.then(|| snapshot.position[nodes.clone()].to_vec());
        run.states.insert(frame, State { digest: state_digest(snapshot, nodes), positions });
    }
}

/// The size to draw in (px): that of the golden, or a small one for a new golden.
pub(super) fn size([width, height]: [u32; 2], golden: &Golden) -> [u32; 2] {
    golden.size().unwrap_or_else(|| {
        let small = WIDTH.min(width);
        [small, (u64::from(height) * u64::from(small) / u64::from(width.max(1))).max(16) as u32]
    })
}

/// The frames of a scene whose digests a record has, so many of each frame: as many as fit, and all of `others`.
fn frames_with_digests(last: u64, digests: usize, others: &BTreeSet<u64>) -> BTreeSet<u64> {
    let row = 5 + (DIGITS + 1) * digests;
    // With powers of two, a scene that becomes longer still has frames in common with its golden.
    let stride = ((last as usize + 1) * row).div_ceil(ROOM_FOR_DIGESTS).next_power_of_two();
    (0..=last).step_by(stride).chain(others.iter().copied()).chain(frames_with_positions(last)).collect()
}

/// The frames of a scene whose positions a record has: evenly spaced, independent of the drawn frames.
fn frames_with_positions(last: u64) -> BTreeSet<u64> {
    (0..=SPACES).map(|at| (u128::from(last) * u128::from(at) / u128::from(SPACES)) as u64).collect()
}

#[cfg(test)]
#[path = "../../tests/inside/drawing.rs"]
mod tests;
