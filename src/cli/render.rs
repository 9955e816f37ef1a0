//! `render`: frames, diagnostics and a summary.

use super::failure::{Failure, Status};
use super::options::{RunOptions, SceneOptions};
use super::record::{self, Pictures, Studio};
use crate::gpu::{AdapterChoice, Gpu};
use crate::history::History;
use crate::output::{Clock, FrameWriter, PixelFrame, Spent, Summary, Tags, Timings};
use crate::picture::Composer;
use crate::render::{RenderError, Renderer};
use crate::scene::Scene;
use crate::sim::snapshot::Frame;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::ffi::OsString;
use std::path::Path;

const EXAMPLES: &str = "\
Examples:
  localshape render scenes/fig4b.toml                      all frames into output/fig4b/
  localshape render scenes/fig4b.toml --frames 0-180x10    every tenth
  localshape render scenes/*.toml -o pictures --size 640x360 --samples 1
  localshape render scenes/fig4b.toml --only Mass-spring --frames 30 -o one

The folder then holds frame_00000.png and so on, diagnostics.csv (energies, momenta, turned-over elements and more, \
for each run and frame) and run.json (what was run, how it went, and which files it wrote). Frames of another scene \
are never mixed with them, nor frames of another --size or --only; other frames of the same sequence stay.

output/NAME follows its scene file: what an earlier version of that file made there is replaced. A folder named with -o, \
and one with results of another scene, is left as it is unless --overwrite is given.

Without a GPU, pictures are drawn on the processor; `localshape info` tells with what.";

/// Threads that write frames, at most: a few keep up with any device.
const MOST_WRITERS: usize = 4;

/// Simulate scenes and draw them as frames
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Render {
    #[command(flatten)]
    scenes: SceneOptions,
    #[command(flatten)]
    options: RunOptions,

    /// Width and height of the frames (px) [default: that of the scene]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Samples per pixel: 4 for smooth edges, 1 for speed
    #[arg(long, value_name = "N", default_value = "4", value_parser = samples())]
    samples: u32,

    /// Graphics adapter: auto (a GPU if there is one), cpu, gpu, or a part of its name
    #[arg(long, value_name = "ADAPTER", default_value = "auto")]
    adapter: AdapterChoice,

    /// Also tell how long each stage took
    #[arg(long)]
    timings: bool,
}

impl Render {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let mut scenes = self.scenes.load_all(self.options.quiet)?;
        if let Some(size) = self.size {
            scenes.iter_mut().for_each(|scene| scene.view.size = size);
        }
        let jobs = self.options.jobs(scenes, true, words)?;
        // Opened when all else is known to be right, and before the first folder is touched.
        let gpu = Gpu::new(&self.adapter).map_err(|error| Failure::adapter(&error))?;
        for job in &jobs {
            let [width, height] = job.scene.view.size;
            let longest = gpu.longest_side();
            if width.max(height) > longest {
                let adapter = gpu.description();
                let message = format!("{width}×{height} is too large: {adapter} draws up to {longest} pixels a side");
                return Err(Failure::usage(message));
            }
        }
        let writers = self.options.threads().min(MOST_WRITERS);
        let device = Device { gpu, samples: self.samples, writers };
        record::run_all(jobs, &self.options, words, self.timings, Some(&device))
    }
}

/// What all scenes are drawn with.
struct Device {
    gpu: Gpu,
    samples: u32,
    writers: usize,
}

impl Studio for Device {
    fn begin<'s>(&self, scene: &'s Scene, folder: &Path) -> Result<Box<dyn Pictures + 's>, Failure> {
        let transparent = scene.view.look.transparent;
        Ok(Box::new(Drawing {
            scene,
            composer: if transparent { Composer::on_ground(scene, [255; 3]) } else { Composer::new(scene) },
            on_black: transparent.then(|| Composer::on_ground(scene, [0; 3])),
            renderer: Renderer::new(&self.gpu, scene.view.size, self.samples).map_err(failed)?,
            writer: FrameWriter::start(folder, self.writers),
            adapter: self.gpu.description().to_string(),
            samples: self.samples,
            compose: Spent::default(),
            draw: Spent::default(),
        }))
    }
}

/// The pictures of one scene.
struct Drawing<'a> {
    scene: &'a Scene,
    /// On the scene's background, or on white if it has none.
    composer: Composer<'a>,
    /// On black, if the scene has no background.
    on_black: Option<Composer<'a>>,
    renderer: Renderer,
    writer: FrameWriter,
    adapter: String,
    samples: u32,
    compose: Spent,
    draw: Spent,
}

impl Pictures for Drawing<'_> {
    fn describe(&self, summary: &mut Summary) {
        summary.adapter = Some(self.adapter.clone());
        summary.frames.size = Some(self.scene.view.size);
        summary.frames.samples = Some(self.samples);
        summary.frames.written = Some(0);
    }

    fn need_history(&self) -> bool {
        self.scene.view.strip.is_some()
    }

    fn take_history(&mut self, history: &History) {
        let composers = std::iter::once(&mut self.composer).chain(&mut self.on_black);
        composers.for_each(|composer| composer.set_history(history));
    }

    fn draw(&mut self, frame: &Frame) -> Result<(), Failure> {
        let clock = Clock::thread();
        let picture = self.composer.compose(frame);
        let on_black = self.on_black.as_ref().map(|composer| composer.compose(frame));
        self.compose += clock.spent();
        let clock = Clock::thread();
        let pixels = match &on_black {
            None => self.renderer.draw(&picture).map_err(failed)?.into_raw(),
            Some(on_black) => self.renderer.draw_transparent(&picture, on_black).map_err(failed)?.into_raw(),
        };
        self.draw += clock.spent();
        let tags = Tags::new(self.scene, frame, &self.adapter);
        Ok(self.writer.write(PixelFrame { size: self.scene.view.size, pixels, tags })?)
    }

    fn finish(self: Box<Self>, summary: &mut Summary, times: &mut Timings) -> Result<(), Failure> {
        let (written, encode, result) = self.writer.finish();
        summary.frames.written = Some(written);
        (times.compose, times.draw, times.encode) = (Some(self.compose), Some(self.draw), Some(encode));
        Ok(result?)
    }
}

/// The device stopped working or refused.
pub(super) fn failed(error: RenderError) -> Failure {
    Failure::adapter(&error)
}

pub(super) fn samples() -> impl TypedValueParser<Value = u32> {
    PossibleValuesParser::new(["1", "4"]).map(|typed| typed.parse().expect("one of the numbers above"))
}

/// Sides of a picture that a scene may have, too (px).
const SIDES: std::ops::RangeInclusive<u32> = 16..=16384;

pub(super) fn size(typed: &str) -> Result<[u32; 2], String> {
    let sides = typed.split_once(['x', 'X', '×']).and_then(|(width, height)| {
        let side = |digits: &str| digits.trim().parse::<u32>().ok();
        Some([side(width)?, side(height)?])
    });
    let sides = sides.ok_or("expected width x height, such as 1280x720")?;
    if sides.iter().any(|side| !SIDES.contains(side)) {
        return Err(format!("a side has {} to {} pixels", SIDES.start(), SIDES.end()));
    }
    Ok(sides)
}

#[cfg(test)]
mod tests {
    use super::size;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        assert_eq!(size("640×360"), Ok([640, 360]));
        for wrong in ["", "x", "1280", "1280x", "0x5", "-1x4", "20000x100", "1280x720x3"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
