//! Files of one picture: PNG, or SVG and PDF for print.

use super::failure::{Failure, Status};
use super::options::RunOptions;
use super::{film, interrupt, record};
use crate::gpu::{Gpu, InitError};
use crate::look::Print;
use crate::output::{Compression, OutputError, encode_print, read_tags};
use crate::picture::{Composer, Picture, left_out, type_left_out};
use crate::reading::Mistake;
use crate::reading::collector::{PathPart, mistake};
use crate::reading::words::short;
use crate::render::{RenderError, Renderer};
use crate::runner::Frame;
use crate::runner::growing::Growing;
use crate::runner::history::History;
use crate::runner::{Frames, Next, Runner};
use crate::scene::Scene;
use crate::vector::{self, Page};
use rayon::ThreadPool;
use std::path::Path;

/// The format of a file of one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StillFormat {
    /// Pixels.
    Png,
    Vector(vector::Format),
}

impl StillFormat {
    /// The format for the name of a file; `None` for names of folders.
    pub(super) fn of(path: &Path) -> Option<Self> {
        if path.is_dir() {
            return None;
        }
        let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        if is_png { Some(Self::Png) } else { vector::Format::of(path).map(Self::Vector) }
    }

    /// Refuses names with the endings of other picture formats, which are hardly meant for folders.
    pub(super) fn check_name(path: &Path) -> Result<(), Failure> {
        const OTHERS: [&str; 11] = ["jpg", "jpeg", "gif", "apng", "webp", "tif", "tiff", "bmp", "eps", "mp4", "webm"];
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
        if path.is_dir() || !OTHERS.contains(&&*ending) {
            return Ok(());
        }
        bail!(
            "-o {}: a picture is written as .png, .svg or .pdf; expected one of these, or the name of a folder (films: \
             `localshape animate`)",
            path.display()
        )
    }
}

/// There is no usable graphics adapter.
impl From<InitError> for Failure {
    fn from(error: InitError) -> Self {
        Self::new(Status::Adapter, &error)
    }
}

/// The device stopped working or refused.
impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Self::new(Status::Adapter, &error)
    }
}

/// One frame of some runs of a scene, and the time series of the scene if its pictures need them; `None` if the user
/// interrupts the command. States wait in `folder`.
pub(super) fn one_frame(
    scene: &Scene,
    runs: &[usize],
    frame: u64,
    pool: &ThreadPool,
    options: &RunOptions,
    folder: &Path,
) -> Result<Option<(Frame, Option<History>)>, Failure> {
    let wanted = scene.time_series();
    let waiting = wanted.map(|_| tempfile::tempfile_in(folder).map(Growing::new));
    let waiting = waiting.transpose().map_err(OutputError::writing(folder))?;
    let mut frames = pool.install(|| {
        let runner = Runner::new(scene, runs).with_diagnostics(&scene.frame_diagnostics());
        Frames::new(runner.with_time_series(wanted), &[frame], waiting)
    });
    let bar = options.printing.progress(&scene.title, frames.steps()[1]);
    let (slice, mut history) = (record::slice(runs.iter().map(|&run| &scene.runs[run])), None);
    while !interrupt::requested() {
        let next = pool.install(|| frames.next(slice)).map_err(OutputError::writing(folder))?;
        bar.set_position(frames.steps()[0]);
        match next {
            Next::Working => {}
            Next::TimeSeries(found) => history = Some(found),
            Next::Frame(frame) => {
                bar.finish_and_clear();
                return Ok(Some((frame, history)));
            }
            Next::Done => break,
        }
    }
    bar.finish_and_clear();
    Ok(None)
}

/// The size of a file of one picture, as it is reported: of paper for a vector file with such a size, else in pixels.
pub(super) fn size_text(format: StillFormat, [width, height]: [u32; 2], print: Option<&Print>) -> String {
    match (format, print) {
        (StillFormat::Vector(_), Some(Print { mm: [wide, high], .. })) => {
            format!("{} × {} mm", short(*wide), short(*high))
        }
        _ => format!("{width}×{height}"),
    }
}

/// Refuses to replace a file that is not a figure or single frame of this program.
pub(super) fn replaceable(path: &Path, format: StillFormat) -> Result<(), Failure> {
    match format {
        StillFormat::Png if path.is_file() && read_tags(path)?.is_some() => Ok(()),
        _ => film::replaceable(path),
    }
}

/// Refuses type that is too small to be printed.
pub(super) fn check_type(print: Option<&Print>, picture: &Picture, file: &str) -> Result<(), Failure> {
    refuse(print, print.and_then(|print| print.too_small(f64::from(smallest_type(picture)))), file)
}

/// Why a picture of a scene cannot be printed, and the remedy, in words.
pub fn unprintable(scene: &Scene, picture: &Picture) -> Option<String> {
    let small = scene.view.print.as_ref()?.too_small(f64::from(smallest_type(picture)))?;
    Some(small.join(": "))
}

/// Refuses some runs of a scene that cannot be printed.
pub(super) fn check_print(scene: &Scene, runs: &[usize]) -> Result<(), Failure> {
    refuse(scene.view.print.as_ref(), too_small(scene, runs), &source_of(scene))
}

/// Fails if type of a size in print is too small. `file` has that size.
fn refuse(print: Option<&Print>, small: Option<[String; 2]>, file: &str) -> Result<(), Failure> {
    match print.zip(small) {
        Some((print, words)) => Err(Failure::usage(format!("{}: {}", print.place(file), words.join(": ")))),
        None => Ok(()),
    }
}

/// The size of the smallest type in a picture (px).
fn smallest_type(picture: &Picture) -> f32 {
    picture.words().map(|run| run.size).fold(f32::INFINITY, f32::min)
}

/// Why some runs of a scene cannot be printed, judged by the first frame before anything is simulated, and the remedy.
fn too_small(scene: &Scene, runs: &[usize]) -> Option<[String; 2]> {
    let print = scene.view.print.as_ref()?;
    let smallest = smallest_type(&first_picture(scene, runs));
    print.too_small(type_left_out(scene).unwrap_or(f64::INFINITY).min(smallest.into()))
}

/// The picture of the start of some runs, before anything is simulated.
fn first_picture(scene: &Scene, runs: &[usize]) -> Picture {
    let mut runner = Runner::new(scene, runs).with_diagnostics(&scene.frame_diagnostics());
    Composer::new(scene, &History::default()).compose(&runner.frame(0))
}

/// Warnings of pictures, and the parts that have no room in them. Warned is of a body that leaves its panel at the start, before a
/// camera that stands still, and of type that is too small to be printed.
pub fn doubts(scene: &Scene) -> (Vec<Mistake>, Vec<String>) {
    let runs: Vec<_> = (0..scene.runs.len()).collect();
    let is_cut = || first_picture(scene, &runs).panels.iter().any(|panel| panel.is_cut);
    let cut = (!scene.view.camera.follow && is_cut()).then(|| {
        let help = "move the camera back, or let it follow: leave out `target` and `distance`";
        ("camera", ["the body leaves its panel at the start", help].map(str::to_owned))
    });
    let small = too_small(scene, &runs).map(|words| ("size", words));
    let warning = |(key, [message, help]): (&str, [String; 2])| {
        mistake(None, 0..0, &["view", key].map(PathPart::Key), message, Some(help))
    };
    (cut.into_iter().chain(small).map(warning).collect(), left_out(scene))
}

/// The file of a scene, for messages.
pub(super) fn source_of(scene: &Scene) -> String {
    scene.file.as_ref().map_or_else(|| scene.name.clone(), |file| file.display().to_string())
}

/// One picture, ready to be written.
pub(super) struct Still<'a> {
    pub(super) picture: &'a Picture,
    /// Its size in print.
    pub(super) print: Option<&'a Print>,
    /// The file name of the scene or figure that it shows.
    pub(super) source: &'a str,
    /// Its title; empty for none.
    pub(super) title: &'a str,
    /// The metadata of the file.
    pub(super) tags: &'a [(&'static str, String)],
}

impl Still<'_> {
    /// Draws the picture, with a device if one is needed.
    pub(super) fn draw(&self, format: StillFormat, gpu: Option<&Gpu>) -> Result<StillFile, Failure> {
        let picture = self.picture;
        check_type(self.print, picture, self.source)?;
        match format {
            StillFormat::Png => {
                let pixels = draw(gpu, picture)?;
                let (size, tags, dpi) = (picture.size, self.tags.to_vec(), self.print.map(|print| print.dpi));
                Ok(Box::new(move || encode_print(size, &pixels, &tags, Compression::Small, dpi)))
            }
            StillFormat::Vector(format) => {
                let size_mm = self.print.map(|print| print.mm);
                let bodies = vector::bodies(picture, size_mm).map(|lit| draw(gpu, &lit)).transpose()?;
                let page = Page {
                    picture,
                    bodies: bodies.as_deref(),
                    size_mm,
                    title: self.title,
                    maker: &format!("{}{}", film::MARK, env!("CARGO_PKG_VERSION")),
                    tags: self.tags,
                };
                let file = vector::write(&page, format).map_err(|error| Failure::usage(error.to_string()))?;
                Ok(Box::new(move || file))
            }
        }
    }
}

/// The pixels of a picture: red, green and blue of each, in rows from the top left.
fn draw(gpu: Option<&Gpu>, picture: &Picture) -> Result<Vec<u8>, RenderError> {
    Ok(Renderer::new(gpu, picture.size)?.draw(picture)?.into_raw())
}

/// Makes the file of a drawn picture. Pixels are compressed here, which takes longest.
pub(super) type StillFile = Box<dyn FnOnce() -> Vec<u8> + Send>;
