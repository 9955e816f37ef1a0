//! `animate`: frames of a folder as an animation.

use super::console;
use super::failure::{Failure, Status};
use super::film::{comment, replaceable, summary};
use super::frames::FrameRanges;
use super::interrupt;
use super::options::{PrintOptions, ThreadOptions, number_in};
use crate::animation::{Animation, AnimationError, Format, Image, Timeline, Written, resized};
use crate::golden::Pixels;
use crate::output::{FolderLock, Shown, Tags, folder_of, frame_file_name, frame_files, picture_size, read_tags};
use crate::reading::beside::{self, name_of};
use clap::{Args, Parser, ValueHint};
use serde_json::json;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape animate output/fig4b -o fig4b.gif --width 800      for chats and READMEs
  localshape animate output/fig4b -o fig4b.mp4 --speed 0.25     slow motion for slides
  localshape animate output/fig4b -o fig4b.apng --frames 0-60   lossless
  localshape animate other -o other.mp4 --fps 30                numbered PNG files of another program

The extension of FILE chooses the format: .gif, .apng, .mp4 (H.264) or .webm (VP9); the latter two need ffmpeg. Each frame is \
shown until the time of the next. GIF has a resolution of 1/100 s, and players need 2/100 s for each frame: at more than 50 \
frames a second every second frame is left out.";

/// Steps of a progress bar.
const PARTS: u64 = 1000;

/// Make an animation from frames
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Animate {
    /// Folder of frames made by `render`, or of numbered PNG files of another program
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    folder: PathBuf,

    /// Output file, whose extension chooses the format
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    out: PathBuf,

    /// Replace a file that was not made by this command
    #[arg(long)]
    overwrite: bool,

    /// Frames to show, inclusive: 0-119, every third as 0-119x3, or 5,9,40-60 [default: all]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<FrameRanges>,

    /// Playback speed: 0.25 for slow motion
    #[arg(long, value_name = "TIMES", value_parser = number_in(0.001, 1000.0), allow_hyphen_values = true)]
    speed: Option<f64>,

    /// Frames per second of the animation; frames of other programs need it [default: every frame is shown]
    #[arg(long, value_name = "RATE", value_parser = number_in(0.1, 1000.0), allow_hyphen_values = true)]
    fps: Option<f64>,

    /// Number of plays; 0 for endless (GIF and APNG) [default: 0]
    #[arg(long = "loop", value_name = "N", value_parser = plays, allow_hyphen_values = true)]
    plays: Option<u16>,

    /// Show the last frame longer by this time (s)
    #[arg(long, value_name = "SECONDS", value_parser = number_in(0.0, 3600.0), allow_hyphen_values = true)]
    hold_last: Option<f64>,

    /// Scale to this width (px) [default: that of the frames]
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=16384))]
    width: Option<u32>,

    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    printing: PrintOptions,
}

impl Animate {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let (format, reel, timeline) = self.prepare()?;
        interrupt::listen();
        let comment = comment(words, &reel.scenes.join(", "));
        let bar = self.printing.progress(&self.out.to_string_lossy(), PARTS);
        bar.set_message(format!("{} frames", reel.moments.len()));
        let progress = |done| bar.set_position((done * PARTS as f64) as u64);
        let result = self.write(format, (&reel, &timeline), &comment, &progress, &|| !interrupt::requested());
        bar.finish_and_clear();
        match result {
            Ok(written) => self.report(reel.moments.len(), &written).map(|()| Status::Done),
            Err(AnimationError::Stopped) => Ok(Status::Interrupted),
            Err(error) => Err(error.into()),
        }
    }

    /// The format, if the file can be made.
    fn check(&self) -> Result<Format, Failure> {
        let format = Format::of(&self.out).map_err(Failure::usage)?;
        if self.plays.is_some() && !matches!(format, Format::Gif | Format::Apng) {
            bail!("--loop is for .gif and .apng; with other formats the player decides how often they play");
        }
        if !self.overwrite {
            replaceable(&self.out)?;
        }
        Ok(format)
    }

    /// The format, and the frames and when they are shown.
    fn prepare(&self) -> Result<(Format, Folder, Timeline), Failure> {
        let format = self.check()?;
        let asked = |last| self.frames.as_ref().map(|frames| frames.select(last));
        let reel = Folder::open(&self.folder, asked, self.width, self.fps)?;
        let mut timeline = Timeline::of(&reel.moments);
        if let Some(times) = self.speed {
            timeline = timeline.faster(times);
        }
        if let Some(rate) = self.fps {
            timeline = timeline.at_rate(rate);
        }
        if let Some(time) = self.hold_last {
            timeline = timeline.holding(time);
        }
        Ok((format, reel, timeline))
    }

    /// Writes the file, with a comment.
    fn write(
        &self,
        format: Format,
        (reel, timeline): (&Folder, &Timeline),
        comment: &str,
        progress: &(dyn Fn(f64) + Sync),
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Written, AnimationError> {
        let (plays, threads) = (self.plays.unwrap_or(0), self.threads.count());
        let _lock = FolderLock::beside_others(folder_of(&self.out));
        let (size, image) = (reel.size, &|frame| reel.image(frame));
        Animation { size, image, timeline, plays, comment, threads, progress, go_on }.write(format, &self.out)
    }

    fn report(&self, frames: usize, written: &Written) -> Result<(), Failure> {
        if self.printing.json {
            let bytes = self.out.metadata().map_or(0, |found| found.len());
            let Written { pictures, duration, size } = *written;
            let file = self.out.to_string_lossy();
            return console::print_json(&json!({
                "file": file, "size": size, "frames": frames, "pictures": pictures, "duration": duration, "bytes": bytes,
            }));
        }
        if self.printing.quiet { Ok(()) } else { console::print(&summary(&self.out, frames, written)) }
    }
}

/// The command with its words, for programs in other languages.
#[derive(Debug, Parser)]
struct Alone {
    #[command(flatten)]
    animate: Animate,
}

impl Alone {
    /// The command with these words, the program's name first, if its file can be made.
    fn of(words: &[OsString]) -> Result<Animate, Failure> {
        let wrong = |error: clap::Error| {
            let text = error.to_string();
            Failure::usage(text.lines().next().unwrap_or_default().trim_start_matches("error: "))
        };
        let Self { animate } = Self::try_parse_from(words).map_err(wrong)?;
        animate.check()?.check_program()?;
        Ok(animate)
    }
}

/// Checks the words of a command before there are frames.
///
/// # Errors
/// Those of the command.
pub fn check_animation(words: &[OsString]) -> Result<(), Failure> {
    Alone::of(words).map(drop)
}

/// Makes an animation as the command does whose words these are. Its comment tells what was called instead. Progress is a completed
/// fraction of the work, which ends early once `go_on` is false.
///
/// # Errors
/// Those of the command, and an interruption.
pub fn animate(
    words: &[OsString],
    called: &str,
    progress: &(dyn Fn(f64) + Sync),
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<(), Failure> {
    let animate = Alone::of(words)?;
    let (format, reel, timeline) = animate.prepare()?;
    let comment = comment(&[called.into()], &reel.scenes.join(", "));
    animate.write(format, (&reel, &timeline), &comment, progress, go_on).map(drop).map_err(Failure::from)
}

/// Makes an animation of frames in a folder, with a comment.
pub(super) fn make(
    (format, path): &(Format, PathBuf),
    folder: &Path,
    frames: &[u64],
    comment: &str,
    threads: usize,
) -> Result<Written, Failure> {
    let reel = Folder::open(folder, |_| Some(Ok(frames.to_vec())), None, None)?;
    let timeline = Timeline::of(&reel.moments);
    let (size, image, go_on) = (reel.size, &|frame| reel.image(frame), &|| !interrupt::requested());
    let animation =
        Animation { size, image, timeline: &timeline, plays: 0, comment, threads, progress: &|_| {}, go_on };
    Ok(animation.write(*format, path)?)
}

/// The frames of a folder.
struct Folder {
    /// Number and time (s) of each frame.
    moments: Vec<(u64, f64)>,
    /// Their files.
    paths: Vec<PathBuf>,
    /// Digests of the scenes shown; none for frames of another program.
    scenes: Vec<String>,
    /// Width and height of a frame, and after scaling (px).
    own: [u32; 2],
    size: [u32; 2],
}

impl Folder {
    /// A frame by its number, from 0.
    fn image(&self, frame: usize) -> Result<Image, AnimationError> {
        let path = &self.paths[frame];
        let picture = |source| AnimationError::Picture { path: path.clone(), source };
        let found = Pixels::read(path).map_err(picture)?;
        let shown = found.label.as_ref().and_then(Tags::frame);
        if found.size != self.own || !self.scenes.is_empty() && shown != Some(self.moments[frame].0) {
            let message =
                format!("{} has changed meanwhile; try again when no other process writes there", path.display());
            return Err(AnimationError::Wrong(message));
        }
        Ok(resized(Image { size: found.size, pixels: found.bytes }, self.size))
    }

    /// Reads the labels of frames in a folder: of the requested ones up to the last one there, or of all. Frames are
    /// scaled to a width (px), if it is given. Frames of another program follow each other at a rate (1/s).
    fn open(
        path: &Path,
        asked: impl FnOnce(u64) -> Option<Result<Vec<u64>, String>>,
        width: Option<u32>,
        rate: Option<f64>,
    ) -> Result<Self, Failure> {
        let (files, rate) = chosen(path, asked, rate)?;
        let (mut moments, mut first): (Vec<(u64, f64)>, _) = (Vec::new(), None);
        for (place, (number, file)) in files.iter().enumerate() {
            let label = Label::read(file, (*number, place), rate)?;
            let last = moments.last().map(|(_, time)| *time);
            let before = name_of(&files[place.saturating_sub(1)].1);
            if let Some(misfit) = label.misfit(*number, (first.as_ref().unwrap_or(&label), last), &before) {
                bail!("{} {misfit}", file.display());
            }
            moments.push((rate.map_or(*number, |_| place as u64), label.time));
            first.get_or_insert(label);
        }
        let Label { size: own, scenes, .. } = first.expect("at least one frame");
        let height = |width: u32| (f64::from(own[1]) * f64::from(width) / f64::from(own[0])).round().max(1.0) as u32;
        let size = width.map_or(own, |width| [width, height(width)]);
        if size[1] > 16_384 {
            bail!("the animation would have {}×{} pixels; expected at most 16384 a side", size[0], size[1]);
        }
        Ok(Self { moments, paths: files.into_iter().map(|(_, file)| file).collect(), scenes, own, size })
    }
}

/// Files with their numbers.
type Numbered = Vec<(u64, PathBuf)>;

/// The metadata in the file of a frame.
struct Label {
    size: [u32; 2],
    frame: u64,
    /// Time (s).
    time: f64,
    scenes: Vec<String>,
    runs: Vec<String>,
}

impl Label {
    /// Reads the file with a number and a place among others. Frames of another program follow each other at a rate (1/s).
    fn read(file: &Path, (frame, place): (u64, usize), rate: Option<f64>) -> Result<Self, Failure> {
        let (found, what) = match rate {
            Some(rate) => {
                let (time, scenes, runs) = (place as f64 / rate, Vec::new(), Vec::new());
                (picture_size(file)?.map(|size| Self { size, frame, time, scenes, runs }), "PNG picture")
            }
            None => {
                let label = |(size, tags): (_, Tags)| match tags.shows {
                    Shown::Frame { frame, time } => {
                        let runs = tags.states.into_iter().map(|(_, run)| run).collect();
                        Some(Self { size, frame, time, scenes: tags.scenes, runs })
                    }
                    Shown::Figure(_) => None,
                };
                (read_tags(file)?.and_then(label), "frame of `localshape render`: it does not name its scene")
            }
        };
        found.ok_or_else(|| Failure::usage(format!("{} is damaged, or is not a {what}", file.display())))
    }

    /// Why the file with a number does not continue the first frame and the last time (s) so far, in words; the file before
    /// has a name.
    fn misfit(&self, number: u64, (first, last): (&Self, Option<f64>), before: &str) -> Option<String> {
        let [[w, h], [w2, h2]] = [self.size, first.size];
        Some(match () {
            () if self.frame != number => format!("shows frame {}; was it renamed?", self.frame),
            () if self.size != first.size => {
                format!("has {w}×{h} pixels, {before} has {w2}×{h2}; make them in one size")
            }
            () if self.scenes != first.scenes => {
                format!("shows a different scene than {before}; expected frames of one scene")
            }
            () if self.runs != first.runs => {
                format!("shows the runs {}, {before} {}", quoted(&self.runs), quoted(&first.runs))
            }
            () if last.is_some_and(|last| self.time <= last) => format!("is at {} s, not after {before}", self.time),
            () => return None,
        })
    }
}

/// The frames to show among those in a folder, by their numbers, and the rate (1/s) of those of another program.
fn chosen(
    path: &Path,
    asked: impl FnOnce(u64) -> Option<Result<Vec<u64>, String>>,
    rate: Option<f64>,
) -> Result<(Numbered, Option<f64>), Failure> {
    let name = path.display();
    match path.metadata() {
        Ok(found) if found.is_dir() => {}
        Ok(_) => bail!("{name} is not a folder; expected one with frames of `localshape render`"),
        Err(error) => bail!("{name} cannot be read: {error}; expected a folder with frames of `localshape render`"),
    }
    let own = frame_files(path)?;
    let (mut files, rate) = match own.is_empty() {
        false => (own, None),
        true => others(path, rate).map(|(files, rate)| (files, Some(rate)))?,
    };
    if let Some(wanted) = asked(files.last().map_or(0, |(last, _)| *last)) {
        let wanted = wanted.map_err(|message| Failure::usage(format!("frames of {name}: {message}")))?;
        let is_missing = |number: &&u64| files.binary_search_by_key(*number, |(number, _)| *number).is_err();
        if let Some(&missing) = wanted.iter().find(is_missing) {
            let missing = if rate.is_none() { frame_file_name(missing) } else { format!("frame {missing}") };
            bail!("frames of {name}: there is no {missing}");
        }
        files.retain(|(number, _)| wanted.binary_search(number).is_ok());
    } else if let Some(stride) = files.get(1).map(|(second, _)| second - files[0].0)
        && let Some(pair) = files.windows(2).find(|pair| pair[1].0 - pair[0].0 != stride)
    {
        let [before, after] = [&pair[0], &pair[1]].map(|(_, file)| name_of(file));
        bail!(
            "{name} has a gap: {after} follows {before}, while frames before that are {stride} apart; make the missing \
             frames, or choose frames with --frames"
        );
    }
    Ok((files, rate))
}

/// The numbered PNG files of another program in a folder, and their rate (1/s), which is to be given.
fn others(path: &Path, rate: Option<f64>) -> Result<(Numbered, f64), Failure> {
    let name = path.display();
    let found = beside::numbered(path, "", ".png").map_err(|(message, help)| {
        let help = help.unwrap_or_else(|| "move the others to another folder".to_owned());
        Failure::usage(format!("{name} {message}; {help}"))
    })?;
    let Some((first, file)) = found.first() else {
        let like = frame_file_name(0);
        bail!(
            "{name} has no frames, such as {like}, and no PNG files with a number at the end of their names; make some with \
             `localshape render SCENE -o {name}`, or number those of another program"
        );
    };
    let file = name_of(file);
    if *first < 0 {
        bail!("{name} has a frame before 0, {file}; number frames from 0");
    }
    let Some(rate) = rate else {
        bail!(
            "{name} has frames of another program, such as {file}, which carry no times; add --fps, such as --fps 30"
        );
    };
    Ok((found.into_iter().map(|(number, file)| (number.unsigned_abs(), file)).collect(), rate))
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(", ")
}

fn plays(typed: &str) -> Result<u16, String> {
    typed.trim().parse().map_err(|_| format!("expected a whole number from 1 to {}, or 0 for endless", u16::MAX))
}
