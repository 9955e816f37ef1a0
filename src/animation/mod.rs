//! Animations: frames with their durations, in one file.
//!
//! A function returns frames by number, a [`Timeline`] has the duration of each, and [`Animation::write`] makes a file
//! in one of several [`Format`]s. Threads decode and compress a few frames ahead of the writer and free them
//! afterwards, so memory is bounded for any length. The file has the same bytes for any number of threads, and is
//! written completely or not at all.

mod apng;
mod error;
mod ffmpeg;
mod format;
mod gif;
mod order;
mod palette;
mod resize;
mod timeline;

pub use error::AnimationError;
pub use format::Format;
pub(crate) use resize::resized;
pub use timeline::{Shot, Timeline};

use crate::output::AtomicFile;
use std::io::{BufWriter, Write};
use std::path::Path;

/// A picture as 8-bit sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Red, green and blue of each pixel, in rows from the top left.
    pub pixels: Vec<u8>,
}

/// The contents and options of a file.
pub struct Animation<'a> {
    /// Width and height of every frame (px).
    pub size: [u32; 2],
    /// Returns a frame by its number, from 0. Called on several threads.
    pub image: &'a (dyn Fn(usize) -> Result<Image, AnimationError> + Sync),
    /// The duration of each frame. It has at least one shot.
    pub timeline: &'a Timeline,
    /// How many times it is played; 0 for ever. Only APNG and GIF can store this.
    pub plays: u16,
    /// Metadata of the file, if the format has a place for it.
    pub comment: &'a str,
    /// Threads to work with, at least one.
    pub threads: usize,
    /// Called with the completed fraction of the work.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// Whether to continue. Called often, and on other threads, too.
    pub go_on: &'a (dyn Fn() -> bool + Sync),
}

/// The result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// Number of pictures in the file. Formats with a fixed rate repeat some; others omit frames that would be too short.
    pub pictures: usize,
    /// Duration of one play (s).
    pub duration: f64,
    /// Width and height (px). Films have even sides.
    pub size: [u32; 2],
}

impl Animation<'_> {
    /// Writes the file `path`, whose folder exists, replacing an earlier one.
    ///
    /// # Errors
    /// If a frame cannot be read, the file cannot be written, or `ffmpeg`, where the format needs it, is missing or
    /// fails.
    pub fn write(&self, format: Format, path: &Path) -> Result<Written, AnimationError> {
        self.write_into(format, path).map_err(|error| error.in_file(path))
    }

    fn write_into(&self, format: Format, path: &Path) -> Result<Written, AnimationError> {
        let mut file = AtomicFile::create_anew(path)?;
        let written = match format {
            Format::Mp4 | Format::WebM => ffmpeg::write(self, format, &file)?,
            Format::Apng => buffered(&mut file, |out| apng::write(self, out))?,
            Format::Gif => buffered(&mut file, |out| gif::write(self, out))?,
        };
        file.commit()?;
        Ok(written)
    }

    /// Reports the completed fraction of the work, and returns an error if the work is to stop.
    fn report(&self, done: f64) -> Result<(), AnimationError> {
        (self.progress)(done);
        if (self.go_on)() { Ok(()) } else { Err(AnimationError::Stopped) }
    }
}

/// Writes into a file.
fn buffered(
    file: &mut AtomicFile,
    write: impl FnOnce(&mut BufWriter<&mut std::fs::File>) -> Result<Written, AnimationError>,
) -> Result<Written, AnimationError> {
    let mut out = BufWriter::with_capacity(1 << 16, file.file());
    let written = write(&mut out).and_then(|written| {
        out.flush().map_err(AnimationError::Out)?;
        Ok(written)
    });
    // Dropping the buffer would try to write the rest of it to the failed file.
    drop(out.into_parts());
    written
}

/// Left, top, width and height (px) of the smallest rectangle with all pixels for whose index `differ` is true; one
/// pixel if there are none.
fn changed([width, height]: [u32; 2], differ: impl Fn(usize) -> bool) -> [u32; 4] {
    let (wide, high) = (width as usize, height as usize);
    let row = |y: usize| (0..wide).any(|x| differ(y * wide + x));
    let Some(top) = (0..high).find(|&y| row(y)) else { return [0, 0, 1, 1] };
    let bottom = (top..high).rev().find(|&y| row(y)).unwrap_or(top);
    let (mut left, mut right) = (wide - 1, 0);
    for y in top..=bottom {
        left = (0..left).find(|x| differ(y * wide + x)).unwrap_or(left);
        right = (right..wide).rev().find(|x| differ(y * wide + x)).unwrap_or(right);
    }
    // The first row with a difference has one in some column.
    let (left, right) = (left.min(right), right.max(left));
    [left, top, right - left + 1, bottom - top + 1].map(|number| number as u32)
}

#[cfg(test)]
#[path = "../../tests/inside/animation.rs"]
mod tests;
