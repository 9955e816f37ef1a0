//! The pictures of a scene as `render` makes them: composed, drawn while the next frame is simulated, and written.

use super::failure::Failure;
use super::film::{Films, Shared};
use super::results::Pictures;
use super::still::{check_type, source_of};
use crate::animation::Spool;
use crate::gpu::{Gpu, GpuError, Pending};
use crate::output::{
    Clock, FrameWriter, OutputError, PixelFrame, Shard, Spent, Summary, Tags, Tap, Texts, Timings, frame_file_name,
    is_drawn, read_tags,
};
use crate::picture::{Composer, Picture};
use crate::render::{RenderError, Renderer};
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::diagnostics::Diagnostic;
use crate::sim::snapshot::{Frame, RunFrame, Snapshot};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// What all scenes are drawn with.
pub(super) struct Device {
    pub(super) gpu: Gpu,
    /// The most threads that write frames.
    pub(super) writers: usize,
    /// Whether frames stay.
    pub(super) keep: bool,
    /// Whether frames that are there already are kept.
    pub(super) resume: bool,
    /// The share of the frames, if it is not all.
    pub(super) shard: Option<Shard>,
    /// What animations are made of, if any are.
    pub(super) shared: Option<Shared>,
    /// Lines to print about animations at the end.
    pub(super) made: Arc<Mutex<Vec<String>>>,
}

/// The pictures of one scene.
pub(super) struct Drawing<'a> {
    scene: &'a Scene,
    /// The time series of the scene, until the first frame is composed.
    history: History,
    composer: Option<Composer<'a>>,
    /// The last frame that was composed, and its picture, if only states change pictures. The same states are not composed
    /// again.
    still: Option<(Frame, Arc<Picture>)>,
    renderer: Renderer,
    /// The frame that is being drawn while the next one is simulated and composed.
    begun: Option<Begun>,
    /// The last picture and its pixels. One that is the same is not drawn again.
    last: Option<(Arc<Picture>, Arc<Vec<u8>>)>,
    /// The number of pictures that were not.
    repeated: usize,
    /// The folder with frames that were drawn before and are kept if they are the same.
    drawn_before: Option<PathBuf>,
    /// The number of these.
    kept: usize,
    writer: FrameWriter,
    /// What gets all frames besides the folder.
    tap: Option<Tap>,
    films: Option<Films>,
    /// Whether frames stay.
    keep: bool,
    adapter: String,
    compose_time: Spent,
    draw_time: Spent,
    /// Runs and frames in which their bodies leave their panels.
    cut: Vec<(usize, u64)>,
}

/// A frame that is being drawn.
struct Begun {
    frame: u64,
    texts: Texts,
    picture: Arc<Picture>,
    pixels: Pixels,
}

/// Pixels, or what becomes of them.
enum Pixels {
    Pending(Pending),
    Drawn(Arc<Vec<u8>>),
}

impl<'a> Drawing<'a> {
    /// Begins the pictures of some frames of a scene, in a folder.
    pub(super) fn begin(device: &Device, scene: &'a Scene, folder: &Path, frames: &[u64]) -> Result<Self, Failure> {
        let films = match &device.shared {
            Some(shared) => {
                let (spool, kept) = (Spool::new(folder, scene.view.size)?, device.keep.then(|| folder.to_owned()));
                Some(Films::start(shared, Arc::clone(&device.made), spool, kept, scene, frames))
            }
            None => None,
        };
        let tap = films.as_ref().map(|films| -> Tap {
            let (spool, frames) = (Arc::clone(&films.spool), frames.to_vec());
            // Animations count the frames that there are.
            Arc::new(move |frame, bytes| frames.binary_search(&frame).map_or(Ok(()), |at| spool.put(at, bytes)))
        });
        Ok(Self {
            scene,
            history: History::default(),
            composer: None,
            still: None,
            renderer: Renderer::new(&device.gpu, scene.view.size)?,
            begun: None,
            last: None,
            repeated: 0,
            drawn_before: device.resume.then(|| folder.to_owned()),
            kept: 0,
            writer: FrameWriter::new(device.keep.then_some(folder), device.shard, device.writers, tap.clone()),
            tap,
            films,
            keep: device.keep,
            adapter: device.gpu.description().to_string(),
            compose_time: Spent::default(),
            draw_time: Spent::default(),
            cut: Vec::new(),
        })
    }

    /// The picture of a frame.
    fn compose(&mut self, frame: &Frame) -> Arc<Picture> {
        if let Some((_, picture)) = self.still.as_ref().filter(|(before, _)| have_same_states(before, frame)) {
            return Arc::clone(picture);
        }
        let history = std::mem::take(&mut self.history);
        let composer = self.composer.get_or_insert_with(|| Composer::new(self.scene, &history));
        let picture = Arc::new(composer.compose(frame));
        self.still = (!self.scene.shows_time()).then(|| (frame.clone(), Arc::clone(&picture)));
        picture
    }

    /// Begins to draw a picture, unless it is that of the last frame.
    fn submit(&mut self, picture: &Arc<Picture>) -> Result<Pixels, RenderError> {
        let is_same = |last: &Arc<Picture>| Arc::ptr_eq(last, picture) || last == picture;
        Ok(match self.last.as_ref().filter(|(last, _)| is_same(last)) {
            Some((_, pixels)) => {
                self.repeated += 1;
                Pixels::Drawn(Arc::clone(pixels))
            }
            None => Pixels::Pending(self.renderer.submit(picture)?),
        })
    }

    /// Waits for the frame that is being drawn, and sees to it that it is written.
    fn hand_on(&mut self) -> Result<(), Failure> {
        let Some(Begun { frame, texts, picture, pixels }) = self.begun.take() else { return Ok(()) };
        let clock = Clock::thread();
        let pixels = match pixels {
            Pixels::Pending(pending) => {
                Arc::new(self.renderer.collect(pending).map_err(|error| stopped(self.keep, error))?)
            }
            Pixels::Drawn(pixels) => pixels,
        };
        self.last = Some((picture, Arc::clone(&pixels)));
        self.draw_time += clock.spent();
        let (size, dpi) = (self.scene.view.size, self.scene.view.print.as_ref().map(|print| print.dpi));
        Ok(self.writer.write(PixelFrame { size, dpi, pixels, frame, texts })?)
    }

    /// What is wrong with a frame that was drawn before, and what to do, in words.
    fn wrong(&self, frame: u64, path: &Path) -> Result<String, Failure> {
        let name = frame_file_name(frame);
        if !path.is_file() {
            return Ok(format!("{name}, which is missing; restore it"));
        }
        let own = &self.adapter;
        Ok(match read_tags(path)? {
            Some((_, tags)) if tags.adapter != *own => {
                format!("{name}, which {} has drawn, and this is {own}; choose that with --adapter", tags.adapter)
            }
            _ => format!("{name}, which has been replaced since; restore it"),
        })
    }

    /// Passes on a frame that was drawn before.
    fn pass(&self, frame: u64, path: &Path) -> Result<(), Failure> {
        let pass = |tap: &Tap| tap(frame, &std::fs::read(path).map_err(OutputError::reading(path))?);
        Ok(self.tap.as_ref().map_or(Ok(()), pass)?)
    }
}

/// Why drawing stopped on the way, where frames are kept or not.
fn stopped(keep: bool, error: RenderError) -> Failure {
    let is_lost = matches!(error, RenderError::Gpu(GpuError::Lost(_)));
    let failure = Failure::from(error);
    if keep && is_lost { failure.advise("with --resume it keeps the frames that were drawn") } else { failure }
}

impl Pictures for Drawing<'_> {
    fn time_series(&self) -> Option<&[Diagnostic]> {
        self.scene.time_series()
    }

    fn take_history(&mut self, history: &History) {
        self.history = history.clone();
    }

    fn draw(&mut self, frame: &Frame) -> Result<(), Failure> {
        let (size, dpi) = (self.scene.view.size, self.scene.view.print.as_ref().map(|print| print.dpi));
        let texts = Tags::of_frame(self.scene, frame, &self.adapter).texts();
        if let Some(folder) = &self.drawn_before {
            let path = folder.join(frame_file_name(frame.index));
            if is_drawn(&path, size, &texts, dpi)? {
                self.kept += 1;
                return self.pass(frame.index, &path);
            }
        }
        let clock = Clock::thread();
        let picture = self.compose(frame);
        self.compose_time += clock.spent();
        let cut = frame.runs.iter().zip(&picture.panels).filter(|(_, panel)| panel.is_cut);
        self.cut.extend(cut.map(|(run, _)| (run.run, frame.index)));
        check_type(self.scene.view.print.as_ref(), &picture, &source_of(self.scene))?;
        self.hand_on()?;
        let clock = Clock::thread();
        let pixels = self.submit(&picture).map_err(|error| stopped(self.keep, error))?;
        self.draw_time += clock.spent();
        self.begun = Some(Begun { frame: frame.index, texts, picture, pixels });
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Failure> {
        self.hand_on()?;
        Ok(self.writer.flush()?)
    }

    fn keep(&mut self, frames: &[u64]) -> Result<Option<String>, Failure> {
        let Some(folder) = self.drawn_before.clone() else { return Ok(None) };
        let path = |frame: u64| folder.join(frame_file_name(frame));
        let (size, dpi) = (self.scene.view.size, self.scene.view.print.as_ref().map(|print| print.dpi));
        for &frame in frames {
            let texts = [
                ("scene", self.scene.digest.clone()),
                ("frame", frame.to_string()),
                ("version", env!("CARGO_PKG_VERSION").to_owned()),
                ("adapter", self.adapter.clone()),
            ];
            if !is_drawn(&path(frame), size, &texts, dpi)? {
                return Ok(Some(self.wrong(frame, &path(frame))?));
            }
        }
        self.kept += frames.len();
        frames.iter().try_for_each(|&frame| self.pass(frame, &path(frame)))?;
        Ok(None)
    }

    fn finish(mut self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure> {
        let last = self.hand_on();
        let (written, encode, result) = self.writer.finish();
        let filmed = self.films.map_or(Ok(()), |films| films.finish());
        summary.frames.written = self.keep.then_some(written);
        summary.frames.kept = self.kept;
        summary.frames.repeated = self.repeated;
        for run in &mut summary.runs {
            let of_run = self.cut.iter().filter(|(at, _)| self.scene.runs[*at].name == run.name);
            run.cut = of_run.map(|(_, frame)| *frame).collect();
        }
        (times.compose, times.draw, times.encode) = (Some(self.compose_time), Some(self.draw_time), Some(encode));
        last.and(result.map_err(Failure::from)).and(filmed)
    }
}

/// Whether two frames show the same runs in the same states, at any times.
fn have_same_states(one: &Frame, other: &Frame) -> bool {
    // By their bits: what is not a number is not equal to itself. Directions follow from the nodes.
    let values = |run: &RunFrame| -> Vec<_> {
        Diagnostic::ALL.iter().map(|one| one.value(&run.snapshot.diagnostics).size().to_bits()).collect()
    };
    let nodes = |run: &RunFrame| {
        let (step, time, diagnostics) = Default::default();
        Snapshot { step, time, diagnostics, ..run.snapshot.clone() }
    };
    let same = |(one, other): (&RunFrame, &RunFrame)| {
        (one.run, &one.last_fit) == (other.run, &other.last_fit)
            && values(one) == values(other)
            && nodes(one) == nodes(other)
    };
    one.runs.len() == other.runs.len() && one.runs.iter().zip(&other.runs).all(same)
}

#[cfg(test)]
mod tests;
