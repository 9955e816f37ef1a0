//! Animations: frames, one after the other with their durations, as one file.
//!
//! A [`Reel`] hands out frames by number, a [`Timeline`] says which of them is shown how long, and [`Animation::write`]
//! makes a file of them in one of several [`Format`]s. Frames are decoded and compressed on threads a few ahead of where
//! the file is, and forgotten behind it: memory is bounded however long the animation is. The file has the same bytes for
//! any number of threads, and is there whole or not at all.

mod apng;
mod error;
mod ffmpeg;
mod format;
mod gif;
mod order;
mod palette;
mod resize;
mod sheet;
mod spool;
mod timeline;
mod y4m;

pub use error::AnimationError;
pub use format::Format;
pub(crate) use resize::resized;
pub use sheet::Sheet;
pub(crate) use spool::Spool;
pub use timeline::{Shot, Timeline};

use crate::colour::Colour;
use crate::golden::Pixels;
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

impl Image {
    /// A picture of one colour.
    pub(crate) fn plain([width, height]: [u32; 2], colour: Colour) -> Self {
        Self { size: [width, height], pixels: colour.repeat(width as usize * height as usize) }
    }

    /// The colour of the top left corner.
    pub(crate) fn corner(&self) -> Colour {
        [self.pixels[0], self.pixels[1], self.pixels[2]]
    }

    /// Puts another picture, which must fit, in front of this one, with its top left corner at `x`, `y` (px).
    pub(crate) fn paste(&mut self, other: &Self, [x, y]: [u32; 2]) {
        let row = 3 * other.size[0] as usize;
        for (line, source) in other.pixels.chunks_exact(row).enumerate() {
            let start = 3 * ((y as usize + line) * self.size[0] as usize + x as usize);
            self.pixels[start..start + row].copy_from_slice(source);
        }
    }
}

/// What is clear is put in front of white.
impl From<Pixels> for Image {
    fn from(picture: Pixels) -> Self {
        let over = |byte: u8, opacity: u8| {
            let [byte, opacity] = [byte, opacity].map(u32::from);
            ((byte * opacity + 255 * (255 - opacity) + 127) / 255) as u8
        };
        let opaque = |pixel: &[u8]| [0, 1, 2].map(|channel| over(pixel[channel], pixel[3]));
        let Pixels { size, channels, bytes, .. } = picture;
        let pixels = if channels == 4 { bytes.chunks_exact(4).flat_map(opaque).collect() } else { bytes };
        Self { size, pixels }
    }
}

/// Frames of one size, to be had in any order and more than once.
pub trait Reel: Sync {
    /// Width and height of every frame (px).
    fn size(&self) -> [u32; 2];

    /// A frame by its number, from 0. May wait until it is there.
    ///
    /// # Errors
    /// If it cannot be had.
    fn image(&self, frame: usize) -> Result<Image, AnimationError>;
}

/// All that a file is made of.
pub struct Animation<'a> {
    /// The frames.
    pub reel: &'a dyn Reel,
    /// Which of them is shown how long. It has at least one shot.
    pub timeline: &'a Timeline,
    /// How many times it is to be played; 0 for ever. Only APNG and GIF can say so.
    pub plays: u16,
    /// How frames stand on a still picture.
    pub sheet: &'a Sheet,
    /// What the file says about itself, where the format has a place for it.
    pub comment: &'a str,
    /// Threads to work with, at least one.
    pub threads: usize,
    /// Told how much of the work is done, from 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// Says whether to go on. Asked often, and on other threads, too.
    pub go_on: &'a (dyn Fn() -> bool + Sync),
}

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    /// Pictures in the file. Formats of a fixed rate repeat some; others leave out what would be shown too shortly.
    pub pictures: usize,
    /// How long it plays once (s); 0 for a still picture.
    pub duration: f64,
    /// Width and height (px). Films have even sides; a sheet has a size of its own.
    pub size: [u32; 2],
}

impl Animation<'_> {
    /// Makes the file `path`, whose folder exists, in place of what is there.
    ///
    /// # Errors
    /// If a frame cannot be had, the file cannot be written, or `ffmpeg`, where the format needs it, is missing or fails.
    pub fn write(&self, format: Format, path: &Path) -> Result<Written, AnimationError> {
        self.write_into(format, path).map_err(|error| error.in_file(path))
    }

    fn write_into(&self, format: Format, path: &Path) -> Result<Written, AnimationError> {
        let mut file = AtomicFile::create(path)?;
        let written = match format {
            Format::Mp4 | Format::WebM => ffmpeg::write(self, format, &file)?,
            Format::Apng => buffered(&mut file, |out| apng::write(self, out))?,
            Format::Gif => buffered(&mut file, |out| gif::write(self, out))?,
            Format::Y4m => buffered(&mut file, |out| y4m::write(self, out))?,
            Format::Sheet => {
                let (bytes, written) = self.sheet.encode(self)?;
                file.append(&bytes)?;
                written
            }
        };
        file.commit()?;
        Ok(written)
    }

    /// Writes y4m, for a pipe to another program.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_y4m(&self, mut out: impl Write) -> Result<Written, AnimationError> {
        let written = y4m::write(self, &mut out)?;
        out.flush().map_err(AnimationError::Out)?;
        Ok(written)
    }

    /// Tells that so much is done, from 0 to 1, and ends the work if it is not wanted any more.
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
    // What is left in the buffer of a failed file is not worth another try.
    drop(out.into_parts());
    written
}

/// Left, top, width and height (px) of the smallest rectangle that holds all pixels for which `differ` is true of their
/// place in the picture; one pixel if there are none.
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
    // The first row that differs does so somewhere.
    let (left, right) = (left.min(right), right.max(left));
    [left, top, right - left + 1, bottom - top + 1].map(|number| number as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_changed_rectangle_is_the_smallest() {
        let all = |places: &'static [usize]| changed([5, 4], move |at| places.contains(&at));
        assert_eq!(all(&[]), [0, 0, 1, 1]);
        assert_eq!(all(&[0]), [0, 0, 1, 1]);
        assert_eq!(all(&[19]), [4, 3, 1, 1]);
        assert_eq!(all(&[7, 11]), [1, 1, 2, 2]);
        assert_eq!(all(&[4, 15]), [0, 0, 5, 4]);
        assert_eq!(all(&[6, 8]), [1, 1, 3, 1]);
    }
}
