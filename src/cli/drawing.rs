//! The pictures of a scene for `render`: composed, drawn while the next frame is simulated, and written.

use super::failure::Failure;
use super::film::{comment, summary as line_of};
use super::results::Pictures;
use super::still::{check_type, source_of};
use super::{animate, interrupt};
use crate::animation::Format;
use crate::gpu::{Gpu, GpuError, adapter_name};
use crate::output::{
    Clock, FrameWriter, OutputError, PixelFrame, Spent, Summary, Tags, Texts, Timings, frame_file_name, is_drawn,
    passing_frames, read_tags,
};
use crate::picture::{Composer, Picture};
use crate::render::{Pending, RenderError, Renderer};
use crate::runner::Frame;
use crate::runner::history::History;
use crate::scene::Scene;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The device and the settings for the pictures of all scenes.
pub(super) struct Device {
    /// The graphics device, if a scene has lit bodies.
    pub(super) gpu: Option<Gpu>,
    /// The number of threads that compress.
    pub(super) threads: usize,
    /// Whether frames are kept after the command.
    pub(super) keep: bool,
    /// Whether frames of an earlier command are kept if they are the same.
    pub(super) resume: bool,
    /// The files of animations, and the command that makes them.
    pub(super) films: Vec<(Format, PathBuf)>,
    pub(super) words: Vec<OsString>,
}

/// The most threads that write frames: a few keep up with any device.
const MOST_WRITERS: usize = 4;

/// The pictures of one scene.
pub(super) struct Drawing<'a> {
    scene: &'a Scene,
    composer: Option<Composer<'a>>,
    renderer: Renderer,
    /// The frame that is drawn while the next one is simulated and composed.
    begun: Option<Begun>,
    /// The last picture and its pixels. An equal picture is not drawn again.
    last: Option<(Picture, Arc<Vec<u8>>)>,
    /// The number of pictures that were not drawn again.
    repeated: usize,
    /// The number of kept frames.
    kept: usize,
    writer: FrameWriter,
    device: Arc<Device>,
    /// The requested frames, and their folder.
    frames: Vec<u64>,
    folder: PathBuf,
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
    picture: Picture,
    pixels: Pixels,
}

/// Pixels, or a drawing that will return them.
enum Pixels {
    Pending(Pending),
    Drawn(Arc<Vec<u8>>),
}

impl<'a> Drawing<'a> {
    /// Begins the pictures of some frames of a scene, in a folder.
    pub(super) fn begin(
        device: &Arc<Device>,
        scene: &'a Scene,
        folder: &Path,
        frames: &[u64],
    ) -> Result<Self, Failure> {
        let folder = if device.keep { folder.to_owned() } else { passing_frames(folder) };
        std::fs::create_dir_all(&folder).map_err(OutputError::writing(&folder))?;
        let writers = device.threads.min(MOST_WRITERS);
        Ok(Self {
            scene,
            composer: None,
            renderer: Renderer::new(device.gpu.as_ref(), scene.view.size)?,
            begun: None,
            last: None,
            repeated: 0,
            kept: 0,
            writer: FrameWriter::new(&folder, writers),
            device: Arc::clone(device),
            frames: frames.to_vec(),
            folder,
            adapter: adapter_name(device.gpu.as_ref().filter(|_| scene.is_lit())),
            compose_time: Spent::default(),
            draw_time: Spent::default(),
            cut: Vec::new(),
        })
    }

    /// Width and height of pictures (px), and pixels per inch for print.
    fn resolution(&self) -> ([u32; 2], Option<f64>) {
        (self.scene.view.size, self.scene.view.print.as_ref().map(|print| print.dpi))
    }

    /// Begins to draw a picture, unless it equals the last one.
    fn submit(&mut self, picture: &Picture) -> Result<Pixels, RenderError> {
        Ok(match self.last.as_ref().filter(|(last, _)| last == picture) {
            Some((_, pixels)) => {
                self.repeated += 1;
                Pixels::Drawn(Arc::clone(pixels))
            }
            None => Pixels::Pending(self.renderer.submit(picture)?),
        })
    }

    /// Waits for the frame that is being drawn, and passes it to the writer.
    fn hand_on(&mut self) -> Result<(), Failure> {
        let Some(Begun { frame, texts, picture, pixels }) = self.begun.take() else { return Ok(()) };
        let clock = Clock::thread();
        let pixels = match pixels {
            Pixels::Pending(pending) => {
                Arc::new(self.renderer.collect(pending, &picture).map_err(|error| stopped(self.device.keep, error))?)
            }
            Pixels::Drawn(pixels) => pixels,
        };
        self.last = Some((picture, Arc::clone(&pixels)));
        self.draw_time += clock.spent();
        let (size, dpi) = self.resolution();
        Ok(self.writer.write(PixelFrame { size, dpi, pixels, frame, texts })?)
    }

    /// Why a frame of an earlier command cannot be kept, and a remedy, in words.
    fn wrong(&self, frame: u64, path: &Path) -> Result<String, Failure> {
        let name = frame_file_name(frame);
        if !path.is_file() {
            return Ok(format!("{name}, which is missing; restore it"));
        }
        let own = &self.adapter;
        Ok(match read_tags(path)? {
            Some((_, tags)) if tags.adapter != *own && self.scene.is_lit() => {
                format!("{name}, which {} has drawn, and this is {own}; choose that with --adapter", tags.adapter)
            }
            Some((_, tags)) if tags.adapter != *own => {
                format!("{name}, which an earlier build has drawn; draw all anew with --overwrite")
            }
            _ => format!("{name}, which is damaged or has been replaced since; restore it"),
        })
    }

    /// Makes the animations, if all frames are there, and returns a line on each.
    fn animate(&self, are_there: bool) -> Result<Vec<String>, Failure> {
        let Device { films, words, threads, .. } = &*self.device;
        let comment = comment(words, &self.scene.digest);
        let line = |film: &(Format, PathBuf)| {
            if are_there && !interrupt::requested() {
                match animate::make(film, &self.folder, &self.frames, &comment, *threads) {
                    Err(_) if interrupt::requested() => {}
                    made => return Ok(line_of(&film.1, self.frames.len(), &made?)),
                }
            }
            let path = film.1.display();
            let (why, of) =
                if are_there { ("it was interrupted", "") } else { ("frames are missing", " from the others") };
            let how = match self.device.keep {
                true => format!("; to make it{of}: localshape animate {} -o {path}", self.folder.display()),
                false => String::new(),
            };
            Ok(format!("{path}  not made, because {why}{how}\n"))
        };
        films.iter().map(line).collect()
    }
}

/// The error of drawing, with a remedy if frames are kept.
fn stopped(keep: bool, error: RenderError) -> Failure {
    let is_lost = matches!(error, RenderError::Gpu(GpuError::Lost(_)));
    let failure = Failure::from(error);
    if keep && is_lost { failure.advise("with --resume it keeps the frames that were drawn") } else { failure }
}

impl Pictures for Drawing<'_> {
    fn take_history(&mut self, history: &History) {
        self.composer = Some(Composer::new(self.scene, history));
    }

    fn draw(&mut self, frame: &Frame) -> Result<(), Failure> {
        let (size, dpi) = self.resolution();
        let texts = Tags::of_frame(self.scene, frame, &self.adapter).texts();
        if self.device.resume {
            let path = self.folder.join(frame_file_name(frame.index));
            if is_drawn(&path, size, &texts, dpi)? {
                self.kept += 1;
                return Ok(());
            }
        }
        let clock = Clock::thread();
        let composer = self.composer.get_or_insert_with(|| Composer::new(self.scene, &History::default()));
        let picture = composer.compose(frame);
        self.compose_time += clock.spent();
        let cut = frame.runs.iter().zip(&picture.panels).filter(|(_, panel)| panel.is_cut);
        self.cut.extend(cut.map(|(run, _)| (run.run, frame.index)));
        check_type(self.scene.view.print.as_ref(), &picture, &source_of(self.scene))?;
        self.hand_on()?;
        let clock = Clock::thread();
        let pixels = self.submit(&picture).map_err(|error| stopped(self.device.keep, error))?;
        self.draw_time += clock.spent();
        self.begun = Some(Begun { frame: frame.index, texts, picture, pixels });
        Ok(())
    }

    fn flush(&mut self) -> Result<(), Failure> {
        self.hand_on()?;
        Ok(self.writer.flush()?)
    }

    fn keep(&mut self, frames: &[u64]) -> Result<Option<String>, Failure> {
        if !self.device.resume {
            return Ok(None);
        }
        let path = |frame: u64| self.folder.join(frame_file_name(frame));
        let (size, dpi) = self.resolution();
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
        Ok(None)
    }

    fn finish(mut self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure> {
        let last = self.hand_on();
        let (written, encode, result) = self.writer.finish();
        let drawn = last.and(result.map_err(Failure::from));
        let filmed = self.animate(drawn.is_ok() && written + self.kept == self.frames.len());
        summary.frames.written = self.device.keep.then_some(written);
        summary.frames.kept = self.kept;
        summary.frames.repeated = self.repeated;
        // Frames that are all kept are not composed.
        let composer = self.composer.get_or_insert_with(|| Composer::new(self.scene, &History::default()));
        summary.frames.azimuth = composer.azimuth();
        summary.frames.left_out = composer.left_out();
        for run in &mut summary.runs {
            let of_run = self.cut.iter().filter(|(at, _)| self.scene.runs[*at].name == run.name);
            run.cut = of_run.map(|(_, frame)| *frame).collect();
        }
        (times.compose, times.draw, times.encode) = (Some(self.compose_time), Some(self.draw_time), Some(encode));
        summary.films = filmed?;
        drawn
    }
}

#[cfg(test)]
mod tests;
