//! `render`: frames, diagnostics and a summary.

use super::console;
use super::drawing::{Device, Drawing};
use super::failure::{Failure, Status, note_no_room};
use super::film::replaceable;
use super::frames::{Instants, Shard};
use super::interrupt;
use super::options::{DeviceOptions, RunOptions, SceneOptions, resize, size};
use super::record::{self, Begin};
use super::scenes::{Wish, nearest};
use super::still::{
    Still, StillFormat, check_print, one_frame, replaceable as replaceable_still, size_text, source_of,
};
use crate::animation::Format;
use crate::gpu::adapter_name;
use crate::look::Theme;
use crate::output::shell;
use crate::output::{AtomicFile, FolderLock, OutputError, Tags, folder_of};
use crate::picture::{Composer, left_out};
use crate::reading::beside::similar;
use crate::reading::captions::typed;
use crate::reading::setting::Setting;
use crate::reading::words::short;
use crate::runner::Stored;
use crate::scene::Scene;
use clap::{Args, ValueHint};
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  localshape render scenes/fig4b.toml                      all frames into output/fig4b/
  localshape render scenes/fig4b.toml --frames 0-180x10    every tenth
  localshape render scenes/*.toml -o pictures --size 640x360
  localshape render scenes/fig4b.toml --animate fig4b.gif --no-frames
  localshape render scenes/fig4b.toml --only Mass-spring --frames 30 -o one
  localshape render scenes/fig4b.toml --resume             continues after an interruption
  localshape render scenes/fig4b.toml --set 'run[0].model.stiffness=1e5' -o stiff    with another value in the scene
  localshape render scenes/fig4b.toml --at 0.5s -o frame.pdf     one frame for print, with text that can be searched

With --shard, many processes draw a scene into one folder: docs/clusters.md has a script for them.

The folder then has frame_00000.png and so on, diagnostics.csv (energies, momenta, turned-over elements and more, for \
each run and frame) and run.json (command, outcome and files).

A folder belongs to one scene: results of another one are replaced only with --overwrite. output/NAME follows its scene file, so that \
results of another version of that file are replaced.

Without a GPU, pictures are drawn by a software driver; `localshape info` names it.";

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

    /// The colours: light for papers, dark for talks [default: those of the scene]
    #[arg(long, value_name = "THEME")]
    theme: Option<Theme>,

    /// Moments in place of frames, such as 2s, 500ms or 0.5,1: the nearest frame to each is made
    #[arg(long, value_name = "TIME", conflicts_with = "frames", allow_hyphen_values = true)]
    at: Option<Instants>,

    #[command(flatten)]
    device: DeviceOptions,

    /// Also make an animation of the frames. The extension of FILE chooses the format, as with
    /// `localshape animate`, which has more options. Can be repeated
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    animate: Vec<PathBuf>,

    /// Do not keep the frames of the animation
    #[arg(long, requires = "animate")]
    no_frames: bool,

    /// Draw states.npz, written by `simulate --states` for the same scene, without simulating
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, conflicts_with = "states")]
    from_states: Option<PathBuf>,

    /// Draw only a share of the frames: 2/4 draws the second one and every fourth one after it. Processes with other shares may draw into the
    /// same folder at the same time; `simulate` writes the tables
    #[arg(long, value_name = "I/N", conflicts_with_all = ["animate", "overwrite", "states"])]
    shard: Option<Shard>,

    /// Also print how long each stage took
    #[arg(long)]
    timings: bool,
}

impl Render {
    pub(super) fn run(mut self, words: &[OsString]) -> Result<Status, Failure> {
        self.options.out.as_deref().map_or(Ok(()), StillFormat::check_name)?;
        // The theme is a key of the scene, so frames of two themes belong to two scenes.
        let setting =
            |theme: Theme| -> Setting { format!("view.theme={}", typed(&theme)).parse().expect("a key and a value") };
        self.scenes.set.extend(self.theme.map(setting));
        self.options.threads.start()?;
        let mut scenes = self.scenes.load_all(self.options.printing.quiet)?;
        scenes.iter_mut().for_each(|scene| resize(scene, self.size));
        scenes.iter().try_for_each(|scene| check_print(scene, &self.options.runs(scene)?))?;
        if let Some((path, format)) = self.options.out.as_ref().and_then(|out| Some((out, StillFormat::of(out)?))) {
            for scene in scenes.iter().filter(|_| !self.options.printing.quiet) {
                note_no_room(&source_of(scene), scene.view.size, &left_out(scene));
            }
            return self.still(path, format, &scenes);
        }
        let films = self.films(scenes.len())?;
        if let (Some(file), true) = (&self.from_states, scenes.len() > 1) {
            bail!("{} has the states of one scene; render the scenes one at a time", file.display());
        }
        let of_course = self.options.write.iter().find(|format| format.is_of_course());
        if let (Some(_), Some(_)) = (of_course, self.shard) {
            bail!("--write usd and gltf: a shard has no whole course of a run; write them with `localshape simulate`");
        }
        let from_states = self.from_states.is_some();
        let (keeps, at) = (!self.no_frames, self.at.as_ref());
        let wish = Wish { keeps: Some(keeps), shard: self.shard, from_states, at };
        let mut jobs = self.options.jobs(scenes, wish, words)?;
        jobs.iter().try_for_each(|job| check_compared(&job.scene, &job.runs))?;
        if let (Some(file), [job]) = (&self.from_states, &mut jobs[..]) {
            file.metadata().map_err(|error| missing(file, "npz", error))?;
            let stored = Stored::open(file, &job.scene, &job.runs, &job.frames);
            let refused = |what: String| OutputError::States { path: file.to_owned(), what: what.into() };
            job.stored = Some(stored.map_err(refused)?);
        }
        // The device is opened after all other checks, and before any folder is changed.
        let lit = jobs.iter().map(|job| &job.scene).filter(|scene| scene.is_lit());
        let gpu = self.device.open(lit.map(|scene| scene.view.size))?;
        jobs.iter().try_for_each(|job| self.tell_moments(&job.scene))?;
        for job in &mut jobs {
            job.adapter = Some(adapter_name(gpu.as_ref().filter(|_| job.scene.is_lit())));
        }
        let device = Arc::new(Device {
            gpu,
            threads: self.options.threads.count(),
            keep: keeps,
            resume: self.options.resume,
            films,
            words: words.to_vec(),
        });
        let begin: &Begin<'_> = &|scene, folder, frames| Ok(Box::new(Drawing::begin(&device, scene, folder, frames)?));
        record::run_all(jobs, &self.options, &self.scenes.set, words, self.timings, Some(begin))
    }

    /// Prints the frames of the requested moments.
    fn tell_moments(&self, scene: &Scene) -> Result<(), Failure> {
        let Some(at) = self.at.as_ref().filter(|_| self.options.printing.prints_text()) else { return Ok(()) };
        let line =
            |(time, frame)| format!("{} s: frame {frame}, at {} s\n", short(time), short(scene.frame_time(frame)));
        nearest(at, scene)?.into_iter().map(line).try_for_each(|line| console::print(&line))
    }

    /// Draws one frame into a file of its own.
    fn still(&self, path: &Path, format: StillFormat, scenes: &[Scene]) -> Result<Status, Failure> {
        let name = path.display();
        let [scene] = scenes else {
            bail!("{name} is a file for one frame; render the scenes one at a time, or into a folder");
        };
        let is_part = self.options.resume || self.shard.is_some() || self.from_states.is_some();
        if self.options.states
            || !self.options.write.is_empty()
            || is_part
            || !self.animate.is_empty()
            || self.options.printing.json
        {
            let others = "--states, --write, --from-states, --shard, --resume, --animate or --json";
            bail!("{name} gets one frame and nothing else; with {others} name a folder");
        }
        let (runs, frames) = (self.options.runs(scene)?, self.options.frames(scene, self.at.as_ref())?);
        check_compared(scene, &runs)?;
        let &[frame] = &frames[..] else {
            let count = frames.len();
            bail!(
                "{name} is a file for one frame, but {count} are asked for; choose one, such as --frames 30 or --at 0.5s"
            );
        };
        if !self.options.overwrite {
            replaceable_still(path, format)?;
        }
        self.tell_moments(scene)?;
        let gpu = self.device.open(scene.is_lit().then_some(scene.view.size))?;
        let folder = folder_of(path);
        std::fs::create_dir_all(folder).map_err(OutputError::writing(folder))?;
        let _lock = FolderLock::beside_others(folder);
        let mut file = AtomicFile::create_anew(path)?;
        interrupt::listen();
        let pool = self.options.threads.pool()?;
        let Some((frame, history)) = one_frame(scene, &runs, frame, &pool, &self.options, folder)? else {
            return Ok(Status::Interrupted);
        };
        let picture = Composer::new(scene, &history.unwrap_or_default()).compose(&frame);
        let tags = Tags::of_frame(scene, &frame, &adapter_name(gpu.as_ref())).texts();
        let source = source_of(scene);
        let (print, title) = (scene.view.print.as_ref(), &scene.title);
        let still = Still { picture: &picture, print, source: &source, title, tags: &tags };
        file.append(&still.draw(format, gpu.as_ref())?())?;
        file.commit()?;
        if self.options.printing.prints_text() {
            console::print(&format!("{name}  {}\n", size_text(format, scene.view.size, print)))?;
        }
        Ok(Status::Done)
    }

    /// The requested animations, if they can be made.
    fn films(&self, scenes: usize) -> Result<Vec<(Format, PathBuf)>, Failure> {
        if scenes > 1 && !self.animate.is_empty() {
            bail!("--animate writes one scene to a file; render the scenes one at a time");
        }
        let film = |path: &PathBuf| {
            let format = Format::of(path).map_err(Failure::usage)?;
            format.check_program()?;
            if !self.options.overwrite {
                replaceable(path)?;
            }
            let folder = folder_of(path);
            if folder.is_dir() {
                Ok((format, path.clone()))
            } else {
                bail!("{}: there is no folder {}", path.display(), folder.display())
            }
        };
        let films: Vec<_> = self.animate.iter().map(film).collect::<Result<_, _>>()?;
        let place = |path: &Path| (folder_of(path).canonicalize().ok(), path.file_name().map(ToOwned::to_owned));
        let places: Vec<_> = self.animate.iter().map(|path| place(path)).collect();
        if let Some(at) = (1..places.len()).find(|&at| places[..at].contains(&places[at])) {
            let name = self.animate[at].display();
            bail!("--animate is given {name} twice; expected different files");
        }
        Ok(films)
    }
}

/// Checks that the requested runs include those with which the scene compares others, and a run to compare.
fn check_compared(scene: &Scene, runs: &[usize]) -> Result<(), Failure> {
    if let (Some(to), &[only]) = (scene.view.colour.and_then(|scale| scale.to), runs)
        && to == only
        && scene.runs.len() > 1
    {
        let (title, name) = (&scene.title, &scene.runs[to].name);
        bail!(
            "--only leaves just the run “{name}”, from which `view.colour.to` of “{title}” measures distances of other runs; \
             name another run, too"
        );
    }
    match scene.view.compared().into_iter().flatten().find(|(_, run)| !runs.contains(run)) {
        Some((key, run)) => {
            let (title, name) = (&scene.title, &scene.runs[run].name);
            let message = format!("--only leaves out the run “{name}”, which `view.{key}` of “{title}” needs");
            bail!("{message}; add --only {}", shell::word(name))
        }
        None => Ok(()),
    }
}

/// Why a file on the command line, which should have this ending, cannot be read.
fn missing(file: &Path, ending: &str, error: io::Error) -> Failure {
    if error.kind() != io::ErrorKind::NotFound {
        return OutputError::reading(file)(error).into();
    }
    let near = similar(file, &[ending]).map_or_else(String::new, |name| format!("; did you mean {name}?"));
    Failure::usage(format!("{}: there is no such file{near}", file.display()))
}
