//! Films made by `ffmpeg`, which reads pictures through a pipe.

use super::order::in_order;
use super::{Animation, AnimationError, Format, Image, Written};
use crate::colour::Colour;
use crate::output::AtomicFile;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Number of lines of its standard error that are reported if it fails.
const LINES: usize = 5;
/// Greatest number of threads that read pictures: they keep up with `ffmpeg`, and each holds pictures in memory.
const READERS: usize = 2;
/// Interval at which its exit is polled.
const BETWEEN: Duration = Duration::from_millis(10);
/// Interval at which interruption is polled while it accepts no pictures.
const LISTEN: Duration = Duration::from_millis(100);

impl Format {
    /// Tests whether the program that the format needs exists.
    ///
    /// # Errors
    /// If it needs `ffmpeg`, which is missing.
    pub(crate) fn check_program(self) -> Result<(), AnimationError> {
        if !matches!(self, Self::Mp4 | Self::WebM) {
            return Ok(());
        }
        let mut command = Command::new("ffmpeg");
        let status = command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
        match status {
            Err(error) if error.kind() == ErrorKind::NotFound => Err(AnimationError::NoFfmpeg(ending(self))),
            _ => Ok(()),
        }
    }
}

fn ending(format: Format) -> &'static str {
    if format == Format::WebM { ".webm" } else { ".mp4" }
}

pub(super) fn write(animation: &Animation<'_>, format: Format, file: &AtomicFile) -> Result<Written, AnimationError> {
    let timeline = animation.timeline.for_screens();
    let [rate, of] = timeline.rate();
    let rate_each = f64::from(rate) / f64::from(of);
    let ticks = timeline.ticks(rate_each, 1);
    // H.264 and VP9 have one colour sample for four pixels, so sides are made even by extending the background.
    let even @ [width, height] = animation.size.map(|side| side.next_multiple_of(2));
    let first = (animation.image)(ticks[0].0)?;
    let ground = [first.pixels[0], first.pixels[1], first.pixels[2]];
    let mut command = Command::new("ffmpeg");
    command.args(["-hide_banner", "-loglevel", "error", "-xerror", "-nostdin", "-y"]);
    command.args(["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &format!("{width}x{height}")]);
    command.args(["-framerate", &format!("{rate}/{of}"), "-i", "pipe:0", "-an"]);
    command.args(["-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd,format=yuv420p"]);
    // Both encoders get less lookahead than by default and a fixed number of threads: half the memory, the same on any
    // machine, and the same bytes for the same encoder.
    command.args(["-threads", "2"]);
    command.args(match format {
        Format::WebM => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-cpu-used", "4", "-lag-in-frames", "4"][..],
        _ => &["-c:v", "libx264", "-crf", "18", "-rc-lookahead", "10", "-x264-params", "sync-lookahead=0"],
    });
    if format == Format::Mp4 {
        command.args(["-movflags", "+faststart"]);
    }
    command.args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]);
    // No random values, such as the identifier that Matroska gives a film.
    command.args(["-fflags", "+bitexact", "-metadata", &format!("comment={}", animation.comment)]);
    command.args(["-f", if format == Format::WebM { "webm" } else { "mp4" }]).arg(file.hidden_path());
    let (process, mut film) = start(&mut command, ending(format), animation.go_on)?;
    let mut pictures = 0;
    std::thread::scope(|scope| {
        // If the process accepts no pictures, this thread blocks, so another one polls for interruption.
        let (_end, ended) = channel::<()>();
        let process = &process;
        scope.spawn(move || {
            while ended.recv_timeout(LISTEN) == Err(RecvTimeoutError::Timeout) {
                if !(animation.go_on)() {
                    return process.kill();
                }
            }
        });
        in_order(
            ticks.len(),
            animation.threads.min(READERS),
            |at| (animation.image)(ticks[at].0).map(|image| padded(image, even, ground)),
            |at, pixels| {
                for _ in 0..ticks[at].1 {
                    film.write(process, &pixels)?;
                    pictures += 1;
                }
                animation.report((at + 1) as f64 / ticks.len() as f64)
            },
        )?;
        film.ended(process)
    })?;
    Ok(Written { pictures, duration: pictures as f64 / rate_each, size: even })
}

/// The pixels of a picture with its sides extended by a colour.
fn padded(image: Image, [width, height]: [u32; 2], colour: Colour) -> Vec<u8> {
    if image.size == [width, height] {
        return image.pixels;
    }
    let more = colour.repeat((width - image.size[0]) as usize);
    let rows = image.pixels.chunks_exact(3 * image.size[0] as usize);
    let mut pixels: Vec<u8> = rows.flat_map(|row| row.iter().chain(&more)).copied().collect();
    pixels.extend(colour.iter().cycle().take(3 * (width * (height - image.size[1])) as usize));
    pixels
}

/// Starts the process.
fn start<'a>(
    command: &mut Command,
    ending: &'static str,
    go_on: &'a (dyn Fn() -> bool + Sync),
) -> Result<(Process, Film<'a>), AnimationError> {
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    // Only this program receives Ctrl-C; it then ends the process.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut child = command.spawn().map_err(|error| match error.kind() {
        ErrorKind::NotFound => AnimationError::NoFfmpeg(ending),
        _ => AnimationError::Ffmpeg { status: format!("it does not start: {error}"), told: String::new() },
    })?;
    let pipe = child.stdin.take();
    let told = child.stderr.take().map(|out| {
        std::thread::spawn(move || {
            let mut last = VecDeque::new();
            for line in BufReader::new(out).split(b'\n').map_while(Result::ok) {
                if last.len() == LINES {
                    last.pop_front();
                }
                last.push_back(String::from_utf8_lossy(&line).trim_end().to_owned());
            }
            last
        })
    });
    Ok((Process(Mutex::new(child)), Film { pipe, told, go_on }))
}

/// A process that is killed when this is dropped.
struct Process(Mutex<Child>);

impl Process {
    fn lock(&self) -> MutexGuard<'_, Child> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Kills it together with its child processes, as any of them may hold the pipe open.
    fn kill(&self) {
        let mut child = self.lock();
        // After it has been waited for, its process id may belong to another process.
        if matches!(child.try_wait(), Ok(None)) {
            #[cfg(unix)]
            let _ = rustix::process::kill_process_group(
                rustix::process::Pid::from_child(&child),
                rustix::process::Signal::KILL,
            );
            let _ = child.kill();
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
        // If it has ended already, this does nothing.
        let _ = self.lock().wait();
    }
}

/// The pipe to the process.
struct Film<'a> {
    pipe: Option<ChildStdin>,
    /// Collects the last lines of its standard error.
    told: Option<JoinHandle<VecDeque<String>>>,
    go_on: &'a (dyn Fn() -> bool + Sync),
}

impl Film<'_> {
    fn write(&mut self, process: &Process, bytes: &[u8]) -> Result<(), AnimationError> {
        let written = self.pipe.as_mut().expect("not ended yet").write_all(bytes);
        // The reason is on its standard error.
        written.map_err(|_| {
            self.ended(process).err().unwrap_or_else(|| AnimationError::Ffmpeg {
                status: "it took only a part of the pictures".to_owned(),
                told: String::new(),
            })
        })
    }

    /// Waits for the end of the process.
    fn ended(&mut self, process: &Process) -> Result<(), AnimationError> {
        self.pipe = None;
        let status = loop {
            let ended = process.lock().try_wait();
            if !(self.go_on)() {
                return Err(AnimationError::Stopped);
            }
            match ended.transpose() {
                Some(status) => break status,
                None => std::thread::sleep(BETWEEN),
            }
        };
        let told = self.told.take().and_then(|told| told.join().ok()).unwrap_or_default();
        // On a full disk some versions print this and exit with success, but the film cannot be played.
        let is_cut = |line: &String| ["Error writing trailer", "No space left"].iter().any(|cut| line.contains(cut));
        match status {
            Ok(status) if status.success() && !told.iter().any(is_cut) => Ok(()),
            status => {
                let status = status.map_or_else(|error| error.to_string(), |status| status.to_string());
                let told = told.iter().map(|line| format!("\n  {line}")).collect();
                Err(AnimationError::Ffmpeg { status, told })
            }
        }
    }
}
