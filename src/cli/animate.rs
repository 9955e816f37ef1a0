//! `animate`: frames of folders as an animation, or as a sheet of still pictures.

use super::console;
use super::failure::{Failure, Status};
use super::film::{comment, replaceable, summary};
use super::frames::FrameRanges;
use super::interrupt;
use super::options::{PrintOptions, ThreadOptions, number_in, size};
use crate::animation::{Animation, AnimationError, Format, Image, Reel, Sheet, Timeline, Written, resized};
use crate::golden::Pixels;
use crate::output::{FolderLock, Shown, Tags, folder_of, frame_file_name, frame_files, read_tags};
use clap::{Args, ValueHint};
use serde_json::json;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  localshape animate output/fig4b -o fig4b.gif --width 800      for chats and READMEs
  localshape animate output/fig4b -o fig4b.mp4 --speed 0.25     slow motion for slides
  localshape animate output/fig4b -o fig4b.apng --frames 0-60   lossless
  localshape animate soft stiff -o both.webm --stack            one above the other
  localshape animate output/fig4b -o sheet.png --frames 0-44x4  stills with their times
  localshape animate output/fig4b -o - | ffplay -               uncompressed, for other programs

The extension of FILE chooses the format: .gif, .apng, .y4m, or .png for a contact sheet; .mp4 (H.264) and .webm (VP9) \
need ffmpeg. Each frame is shown until the time of the next. GIF has a resolution of 1/100 s, and players need 2/100 s for \
each frame: at more than 50 frames a second every second frame is left out. Transparent frames get a white background.";

/// Steps of a progress bar.
const PARTS: u64 = 1000;
/// The name of standard output.
const STANDARD_OUTPUT: &str = "-";

/// Make an animation, or a contact sheet, from frames
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Animate {
    /// Folders of frames made by `render`; several are shown side by side
    #[arg(value_name = "DIR", required = true, value_hint = ValueHint::DirPath)]
    folders: Vec<PathBuf>,

    /// Output file, whose extension chooses the format; - for y4m on standard output
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    out: PathBuf,

    /// Replace a file that was not made by this command
    #[arg(long)]
    overwrite: bool,

    /// Frames to show, inclusive: 0-119, every third as 0-119x3, or 5,9,40-60 [default: all; twelve on a sheet]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    frames: Option<FrameRanges>,

    /// Playback speed: 0.25 for slow motion
    #[arg(long, value_name = "TIMES", value_parser = number_in(0.001, 1000.0), allow_hyphen_values = true)]
    speed: Option<f64>,

    /// Frames per second of the animation [default: every frame is shown]
    #[arg(long, value_name = "RATE", value_parser = number_in(0.1, 1000.0), allow_hyphen_values = true)]
    fps: Option<f64>,

    /// How often it plays; 0 for endless (GIF and APNG) [default: 0]
    #[arg(long = "loop", value_name = "N", value_parser = plays, allow_hyphen_values = true)]
    plays: Option<u16>,

    /// Show the last frame longer by this time (s)
    #[arg(long, value_name = "SECONDS", value_parser = number_in(0.0, 3600.0), allow_hyphen_values = true)]
    hold_last: Option<f64>,

    /// Play forwards, then backwards
    #[arg(long)]
    boomerang: bool,

    /// Show folders one above the other instead of side by side
    #[arg(long)]
    stack: bool,

    /// Scale to this width (px) [default: that of the frames]
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=16384))]
    width: Option<u32>,

    /// Width and height of a sheet (px) [default: 1920x1080]
    #[arg(long, value_name = "WxH", value_parser = size, conflicts_with = "width")]
    size: Option<[u32; 2]>,

    #[command(flatten)]
    threads: ThreadOptions,
    #[command(flatten)]
    printing: PrintOptions,
}

impl Animate {
    pub(super) fn run(self, words: &[OsString]) -> Result<Status, Failure> {
        let to_standard_output = self.out == Path::new(STANDARD_OUTPUT);
        let format = if to_standard_output { Format::Y4m } else { Format::of(&self.out).map_err(Failure::usage)? };
        self.check(format)?;
        if !to_standard_output && !self.overwrite {
            replaceable(&self.out)?;
        }
        let reel = Folders::open(&self)?;
        let mut timeline = Timeline::of(&reel.moments);
        if format == Format::Sheet && self.frames.is_none() {
            timeline = timeline.stills(Sheet::FRAMES);
        }
        if let Some(times) = self.speed {
            timeline = timeline.faster(times);
        }
        if let Some(rate) = self.fps {
            timeline = timeline.at_rate(rate);
        }
        if let Some(time) = self.hold_last {
            timeline = timeline.holding(time);
        }
        if self.boomerang {
            timeline = timeline.there_and_back();
        }
        interrupt::listen();
        let comment = comment(words, &reel.scenes);
        let sheet = Sheet { times: reel.moments.iter().map(|(_, time)| *time).collect(), ..Sheet::default() };
        let sheet = Sheet { size: self.size.unwrap_or(sheet.size), ..sheet };
        let bar = self.printing.progress(&self.out.to_string_lossy(), PARTS);
        bar.set_message(format!("{} frames", reel.moments.len()));
        let progress = |done: f64| bar.set_position((done * PARTS as f64) as u64);
        let animation = Animation {
            reel: &reel,
            timeline: &timeline,
            plays: self.plays.unwrap_or(0),
            sheet: &sheet,
            comment: &comment,
            threads: self.threads.count(),
            progress: &progress,
            go_on: &|| !interrupt::requested(),
        };
        let result = if to_standard_output {
            animation.write_y4m(std::io::BufWriter::new(std::io::stdout().lock()))
        } else {
            let _lock = FolderLock::beside_others(folder_of(&self.out));
            animation.write(format, &self.out)
        };
        bar.finish_and_clear();
        match result {
            Ok(written) => {
                if !to_standard_output {
                    self.report(reel.moments.len(), &written)?;
                }
                Ok(Status::Done)
            }
            Err(AnimationError::Stopped) => Ok(Status::Interrupted),
            // Ctrl-C has ended the reader, too.
            Err(AnimationError::Out(_)) if interrupt::requested() => Ok(Status::Interrupted),
            Err(error) => Err(error.into()),
        }
    }

    /// Rejects options that have no effect in the chosen format; to ignore them silently would surprise.
    fn check(&self, format: Format) -> Result<(), Failure> {
        let is_sheet = format == Format::Sheet;
        let of_time = [
            ("--speed", self.speed.is_some()),
            ("--fps", self.fps.is_some()),
            ("--hold-last", self.hold_last.is_some()),
            ("--boomerang", self.boomerang),
        ];
        let message = if let Some((option, _)) = of_time.iter().find(|(_, is_given)| is_sheet && *is_given) {
            format!("{option} is for animations; choose the frames of a sheet (.png) with --frames")
        } else if self.width.is_some() && is_sheet {
            "--width is for animations; use --size for a sheet (.png), such as --size 1920x1080".to_owned()
        } else if self.size.is_some() && !is_sheet {
            "--size is for sheets (.png); use --width for an animation".to_owned()
        } else if self.plays.is_some() && !matches!(format, Format::Gif | Format::Apng) {
            "--loop is for .gif and .apng; with other formats the player decides how often they play".to_owned()
        } else if self.stack && self.folders.len() == 1 {
            "--stack shows several folders one above the other; expected more than one".to_owned()
        } else if self.printing.json && self.out == Path::new(STANDARD_OUTPUT) {
            "--json describes a file; with -o - standard output is for the pictures".to_owned()
        } else {
            return Ok(());
        };
        Err(Failure::usage(message))
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

/// Frames of one folder, or of several beside each other.
struct Folders {
    /// For each frame its file in each folder.
    paths: Vec<Vec<PathBuf>>,
    /// Number and time of each frame (s).
    moments: Vec<(u64, f64)>,
    /// Digests of the scenes shown, each once.
    scenes: Vec<String>,
    /// Width and height of a frame in its folder (px).
    own: [u32; 2],
    /// Width and height of all together, scaled (px).
    size: [u32; 2],
    stack: bool,
}

/// What the frames of one folder have in common, and when they are.
struct Folder {
    size: [u32; 2],
    scenes: Vec<String>,
    runs: Vec<String>,
    frames: Vec<(u64, f64, PathBuf)>,
}

impl Folders {
    /// Inspects all requested frames.
    fn open(options: &Animate) -> Result<Self, Failure> {
        let folders: Vec<Folder> =
            options.folders.iter().map(|path| Folder::open(path, options.frames.as_ref())).collect::<Result<_, _>>()?;
        let first = &folders[0];
        for (path, folder) in options.folders.iter().zip(&folders).skip(1) {
            let ([one, other], [name, beside]) = ([first, folder], [options.folders[0].display(), path.display()]);
            let [[w, h], [w2, h2]] = [one.size, other.size];
            if one.size != other.size {
                bail!("{name} has frames of {w}×{h} and {beside} of {w2}×{h2}; expected equal sizes");
            }
            let unlike = one.frames.iter().zip(&other.frames).find(|(a, b)| a.0 != b.0).map(|(a, b)| a.0.min(b.0));
            let (a, b) = (one.frames.len(), other.frames.len());
            let unlike = unlike.or_else(|| (a != b).then(|| if a < b { other.frames[a].0 } else { one.frames[b].0 }));
            if let Some(number) = unlike {
                bail!(
                    "frame {number} is in only one of {name} and {beside}; choose frames that both have with --frames"
                );
            }
            // Each takes its frames at the end of a step of its own.
            let between = one.frames.windows(2).map(|pair| pair[1].1 - pair[0].1);
            let from_start = one.frames.iter().filter(|frame| frame.0 > 0).map(|frame| frame.1 / frame.0 as f64);
            let step = between.chain(from_start).fold(f64::INFINITY, f64::min);
            if let Some((a, b)) = one.frames.iter().zip(&other.frames).find(|(a, b)| (a.1 - b.1).abs() > step / 2.0) {
                bail!(
                    "frame {} is at {:.4} s in {name} and at {:.4} s in {beside}; expected equal times",
                    a.0,
                    a.1,
                    b.1
                );
            }
        }
        let files = |at: usize| folders.iter().map(|folder| folder.frames[at].2.clone()).collect();
        let paths = (0..first.frames.len()).map(files).collect();
        let moments = first.frames.iter().map(|(number, time, _)| (*number, *time)).collect();
        let mut scenes: Vec<String> = Vec::new();
        for scene in folders.iter().flat_map(|folder| &folder.scenes) {
            if !scenes.contains(scene) {
                scenes.push(scene.clone());
            }
        }
        let (own, count) = (first.size, folders.len() as u32);
        let whole = if options.stack { [own[0], own[1] * count] } else { [own[0] * count, own[1]] };
        let size = match options.width {
            Some(width) => {
                let height = f64::from(whole[1]) * f64::from(width) / f64::from(whole[0]);
                [width, (height.round() as u32).max(1)]
            }
            None => whole,
        };
        if size.iter().any(|&side| side > 16_384) {
            let [width, height] = size;
            bail!("together the frames have {width}×{height} pixels; expected at most 16384 a side");
        }
        Ok(Self { paths, moments, scenes, own, size, stack: options.stack })
    }

    /// One frame of one folder, which is still what it was when it was looked at.
    fn read(&self, path: &Path, number: u64) -> Result<Image, AnimationError> {
        let picture = |source| AnimationError::Picture { path: path.to_owned(), source };
        let found = Pixels::read(path).map_err(picture)?;
        let shown = found.label.as_ref().and_then(Tags::frame);
        if found.size != self.own || shown != Some(number) {
            let message =
                format!("{} has changed meanwhile; try again when no other process writes there", path.display());
            return Err(AnimationError::Wrong(message));
        }
        Ok(found.into())
    }
}

impl Reel for Folders {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn image(&self, frame: usize) -> Result<Image, AnimationError> {
        let number = self.moments[frame].0;
        let image = match self.paths[frame].as_slice() {
            [path] => self.read(path, number)?,
            paths => {
                let count = paths.len() as u32;
                let [width, height] = self.own;
                let size = if self.stack { [width, height * count] } else { [width * count, height] };
                let mut whole = Image::plain(size, [0; 3]);
                for (at, path) in (0..).zip(paths) {
                    let corner = if self.stack { [0, at * height] } else { [at * width, 0] };
                    whole.paste(&self.read(path, number)?, corner);
                }
                whole
            }
        };
        Ok(if image.size == self.size { image } else { resized(&image, self.size) })
    }
}

impl Folder {
    /// Reads what the frames of a folder say about themselves.
    fn open(path: &Path, asked: Option<&FrameRanges>) -> Result<Self, Failure> {
        let name = path.display();
        match path.metadata() {
            Ok(found) if found.is_dir() => {}
            Ok(_) => {
                bail!("{name} is not a folder; expected one with frames of `localshape render`");
            }
            Err(error) => {
                bail!("{name} cannot be read: {error}; expected a folder with frames of `localshape render`");
            }
        }
        let mut files = frame_files(path)?;
        let Some(&(last, _)) = files.last() else {
            bail!(
                "{name} has no frames, such as {}; make some with `localshape render SCENE -o {name}`",
                frame_file_name(0)
            );
        };
        if let Some(asked) = asked {
            let wanted =
                asked.select(last).map_err(|message| Failure::usage(format!("frames of {name}: {message}")))?;
            if let Some(missing) =
                wanted.iter().find(|number| files.binary_search_by_key(number, |(number, _)| number).is_err())
            {
                bail!("frames of {name}: there is no {}", frame_file_name(*missing));
            }
            files.retain(|(number, _)| wanted.binary_search(number).is_ok());
        } else if let Some(stride) = files.get(1).map(|(second, _)| second - files[0].0)
            && let Some(pair) = files.windows(2).find(|pair| pair[1].0 - pair[0].0 != stride)
        {
            let [before, after] = [&pair[0], &pair[1]].map(|(number, _)| frame_file_name(*number));
            bail!(
                "{name} has a gap: {after} follows {before}, while frames before that are {stride} apart; render the \
                 missing frames, or choose frames with --frames"
            );
        }
        let mut folder: Option<Self> = None;
        for (number, file) in files {
            let found = read_tags(&file)?;
            let Some((size, Tags { shows: Shown::Frame { frame, time }, scenes, states, .. })) = found else {
                bail!(
                    "{} is damaged, or is not a frame of `localshape render`: it does not name its scene",
                    file.display()
                );
            };
            let runs: Vec<String> = states.into_iter().map(|(_, run)| run).collect();
            let first = || Self { size, scenes: scenes.clone(), runs: runs.clone(), frames: Vec::new() };
            let all = folder.get_or_insert_with(first);
            let unlike = |what: String| Failure::usage(format!("{} {what}", file.display()));
            let before = all
                .frames
                .last()
                .map(|(_, _, path)| path.file_name().unwrap_or_default().to_string_lossy().into_owned())
                .unwrap_or_default();
            if frame != number {
                return Err(unlike(format!("shows frame {frame}; was it renamed?")));
            }
            if size != all.size {
                let [[w, h], [w2, h2]] = [size, all.size];
                return Err(unlike(format!("has {w}×{h} pixels, {before} has {w2}×{h2}; render them in one size")));
            }
            if scenes != all.scenes {
                return Err(unlike(format!("shows a different scene than {before}; expected frames of one scene")));
            }
            if runs != all.runs {
                return Err(unlike(format!("shows the runs {}, {before} {}", quoted(&runs), quoted(&all.runs))));
            }
            if all.frames.last().is_some_and(|(_, last, _)| time <= *last) {
                return Err(unlike(format!("is at {time} s, not after {before}")));
            }
            all.frames.push((number, time, file));
        }
        Ok(folder.expect("at least one frame"))
    }
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("“{name}”")).collect::<Vec<_>>().join(", ")
}

fn plays(typed: &str) -> Result<u16, String> {
    typed.trim().parse().map_err(|_| format!("expected a whole number from 1 to {}, or 0 for endless", u16::MAX))
}
