//! Films that `ffmpeg` makes: pictures go to it through a pipe.

use super::order::in_order;
use super::{Animation, AnimationError, Format, Image, Written};
use crate::output::AtomicFile;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::thread::JoinHandle;

/// Lines of what it says that are told when it fails.
const LINES: usize = 5;

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
    // Both look ahead less far than usual, which takes a third of the memory away and no quality.
    command.args(match format {
        Format::WebM => {
            &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-cpu-used", "4", "-lag-in-frames", "12"]
                [..]
        }
        _ => &["-c:v", "libx264", "-crf", "18", "-rc-lookahead", "10", "-movflags", "+faststart"],
    });
    command.args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv"]);
    command.args(["-metadata", &format!("comment={}", animation.comment)]);
    command.args(["-f", if format == Format::WebM { "webm" } else { "mp4" }]).arg(file.hidden_path());
    let mut film = Film::start(&mut command, ending(format))?;
    let mut pictures = 0;
    in_order(
        ticks.len(),
        animation.threads,
        |at| animation.reel.image(ticks[at].0).map(padded),
        |at, image| {
            for _ in 0..ticks[at].1 {
                film.write(&image.pixels)?;
                pictures += 1;
            }
            animation.report(at + 1, ticks.len())
        },
    )?;
    film.finish()?;
    Ok(Written { pictures, duration: pictures as f64 / rate_each })
}

/// A process that pictures are written to. Dropped before its end, it is ended.
struct Film {
    child: Child,
    pipe: Option<ChildStdin>,
    /// Gathers the last lines that it says.
    told: Option<JoinHandle<VecDeque<String>>>,
}

impl Film {
    fn start(command: &mut Command, ending: &'static str) -> Result<Self, AnimationError> {
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
        Ok(Self { child, pipe, told })
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), AnimationError> {
        let written = self.pipe.as_mut().expect("not finished yet").write_all(bytes);
        // Why it takes no more, it says itself.
        written.map_err(|_| {
            self.ended().err().unwrap_or_else(|| AnimationError::Ffmpeg {
                status: "it took only a part of the pictures".to_owned(),
                told: String::new(),
            })
        })
    }

    fn finish(mut self) -> Result<(), AnimationError> {
        self.ended()
    }

    /// Waits for its end.
    fn ended(&mut self) -> Result<(), AnimationError> {
        self.pipe = None;
        let status = self.child.wait();
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

impl Drop for Film {
    fn drop(&mut self) {
        // If it has ended, there is nothing to be done.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
