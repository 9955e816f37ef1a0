//! Films that `ffmpeg` makes: pictures go to it through a pipe.

use super::order::in_order;
use super::{Animation, AnimationError, Format, Image, Written};
use crate::output::AtomicFile;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Lines of what it says that are told when it fails.
const LINES: usize = 5;
/// Threads that read pictures for it, at most: these keep up with it, and each holds pictures in memory.
const READERS: usize = 2;
/// It is asked as often as this whether it has ended.
const BETWEEN: Duration = Duration::from_millis(10);
/// While it takes no pictures, the user is listened to as often as this.
const LISTEN: Duration = Duration::from_millis(100);

/// Looks whether it is there.
pub(super) fn look(format: Format) -> Result<(), AnimationError> {
    let mut command = Command::new("ffmpeg");
    let status = command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    match status {
        Err(error) if error.kind() == ErrorKind::NotFound => Err(AnimationError::NoFfmpeg(ending(format))),
        _ => Ok(()),
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
    // H.264 and VP9 keep one sample of colour for four pixels, so sides are even: the background goes on there.
    let even @ [width, height] = animation.reel.size().map(|side| side.next_multiple_of(2));
    let ground = animation.reel.image(ticks[0].0)?.corner();
    let padded = |image: Image| {
        if image.size == even {
            return image;
        }
        let mut padded = Image::plain(even, ground);
        padded.paste(&image, [0, 0]);
        padded
    };
    let mut command = Command::new("ffmpeg");
    command.args(["-hide_banner", "-loglevel", "error", "-xerror", "-nostdin", "-y"]);
    command.args(["-f", "rawvideo", "-pixel_format", "rgb24", "-video_size", &format!("{width}x{height}")]);
    command.args(["-framerate", &format!("{rate}/{of}"), "-i", "pipe:0", "-an"]);
    command.args(["-vf", "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd,format=yuv420p"]);
    // Both look ahead less far than usual, on a fixed number of threads: half the memory, as much on any machine, and for
    // one encoder the same bytes.
    command.args(["-threads", "2"]);
    command.args(match format {
        Format::WebM => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-cpu-used", "4", "-lag-in-frames", "4"][..],
        _ => &["-c:v", "libx264", "-crf", "18", "-rc-lookahead", "10", "-x264-params", "sync-lookahead=0"],
    });
    if format == Format::Mp4 {
        command.args(["-movflags", "+faststart"]);
    }
    command.args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]);
    // Nothing by chance, as the number that Matroska gives a film.
    command.args(["-fflags", "+bitexact", "-metadata", &format!("comment={}", animation.comment)]);
    command.args(["-f", if format == Format::WebM { "webm" } else { "mp4" }]).arg(file.hidden_path());
    let (process, mut film) = start(&mut command, ending(format), animation.go_on)?;
    let mut pictures = 0;
    std::thread::scope(|scope| {
        // A process that takes no pictures keeps this thread waiting; another one then listens to the user.
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
            |at| animation.reel.image(ticks[at].0).map(padded),
            |at, image| {
                for _ in 0..ticks[at].1 {
                    film.write(process, &image.pixels)?;
                    pictures += 1;
                }
                animation.report((at + 1) as f64 / ticks.len() as f64)
            },
        )?;
        film.ended(process)
    })?;
    Ok(Written { pictures, duration: pictures as f64 / rate_each, size: even })
}

/// Starts the process that makes a film.
fn start<'a>(
    command: &mut Command,
    ending: &'static str,
    go_on: &'a (dyn Fn() -> bool + Sync),
) -> Result<(Process, Film<'a>), AnimationError> {
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    // Ctrl-C is for this program, which then ends the other.
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

/// A process that is ended when it is dropped.
struct Process(Mutex<Child>);

impl Process {
    fn lock(&self) -> MutexGuard<'_, Child> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How it has ended, if it has.
    fn ended(&self) -> std::io::Result<Option<ExitStatus>> {
        self.lock().try_wait()
    }

    /// Ends it at once, with those that it has started, for any of them may hold the pipe open.
    fn kill(&self) {
        let mut child = self.lock();
        // Once it is known to have ended, its number may be another's.
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
        // If it has ended, there is nothing to be done.
        let _ = self.lock().wait();
    }
}

/// What pictures are written to.
struct Film<'a> {
    pipe: Option<ChildStdin>,
    /// Gathers the last lines that the process says.
    told: Option<JoinHandle<VecDeque<String>>>,
    go_on: &'a (dyn Fn() -> bool + Sync),
}

impl Film<'_> {
    fn write(&mut self, process: &Process, bytes: &[u8]) -> Result<(), AnimationError> {
        let written = self.pipe.as_mut().expect("not ended yet").write_all(bytes);
        // Why it takes no more, it says itself.
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
            let ended = process.ended();
            if !(self.go_on)() {
                return Err(AnimationError::Stopped);
            }
            match ended.transpose() {
                Some(status) => break status,
                None => std::thread::sleep(BETWEEN),
            }
        };
        let told = self.told.take().and_then(|told| told.join().ok()).unwrap_or_default();
        // On a full disk some versions say so and end well, leaving a film that nothing can play.
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
