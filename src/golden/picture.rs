//! Reads pictures for comparison: as 8-bit red, green and blue, whatever their kind of pixels.

use crate::output::Tags;
use std::fs::File;
use std::io::{self, Cursor, Read};
use std::path::Path;

/// The longest side of a picture (px) and its largest number of pixels: both pictures of a pair are held in memory.
const LONGEST_SIDE: u32 = 16_384;
const MOST_PIXELS: u64 = 100_000_000;
/// The largest file (bytes); such pictures need less.
const MOST_BYTES: u64 = 1 << 29;
/// The largest size of data besides pixels (bytes); the text chunks are far smaller.
const MOST_BESIDE: usize = 4 << 20;

/// The signature of PNG files.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Why a file cannot be compared as a picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It cannot be opened.
    #[error("cannot be read")]
    Read(#[from] io::Error),
    /// It is not a PNG file.
    #[error("this is not a PNG picture")]
    Foreign,
    /// The file is too large.
    #[error("this file has {0} bytes; a picture that can be compared has at most {MOST_BYTES}")]
    Large(u64),
    /// It is damaged or incomplete.
    #[error("this PNG picture is damaged or cut short ({0})")]
    Broken(String),
    /// It is no plain picture.
    #[error("the picture {0}; save it as a still picture that is not interlaced")]
    Kind(&'static str),
    /// Its width and height (px) are too large.
    #[error(
        "the picture says that it has {0}×{1} pixels; expected at most {LONGEST_SIDE} a side and {million} million in all",
        million = MOST_PIXELS / 1_000_000
    )]
    Size(u32, u32),
    /// It has too much data besides its pixels.
    #[error("the picture carries more than {} MiB beside its pixels; save it without that", MOST_BESIDE >> 20)]
    Laden,
    /// Its metadata is invalid.
    #[error(
        "the picture was drawn by this program, but its text `localshape:{0}` is missing, damaged or repeated; \
         its pixels alone prove nothing"
    )]
    Label(&'static str),
    /// Its metadata is after the pixels.
    #[error("the picture has its text chunks after its pixels; expected them before, as this program writes them")]
    Late,
}

/// A picture with its metadata.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Three bytes for each pixel, row after row from the top left, with transparent pixels on white.
    pub bytes: Vec<u8>,
    /// The same on black; `None` if all pixels are opaque.
    pub on_black: Option<Vec<u8>>,
    /// Its metadata, if it has any.
    pub label: Option<Tags>,
}

impl Pixels {
    /// Reads a PNG file.
    ///
    /// # Errors
    /// A file that cannot be read, is not a complete PNG file, is interlaced, or has several frames.
    pub fn read(path: &Path) -> Result<Self, PictureError> {
        Self::from_bytes(&file(path)?)
    }

    /// Reads a PNG file from memory, with all its checksums.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(file: &[u8]) -> Result<Self, PictureError> {
        if !file.starts_with(SIGNATURE) {
            return Err(PictureError::Foreign);
        }
        /// Pixels that need no change.
        const PLAIN: Kind = (png::ColorType::Rgb, png::BitDepth::Eight);
        let mut decoder = decoder(file);
        let info = decoder.read_header_info().map_err(broken)?;
        let ([width, height], kind) = ([info.width, info.height], (info.color_type, info.bit_depth));
        if width.max(height) > LONGEST_SIDE || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(PictureError::Size(width, height));
        }
        let (expand, opacities) = (png::Transformations::EXPAND, png::Transformations::ALPHA);
        decoder.set_transformations(if kind == PLAIN { expand } else { expand | opacities });
        let mut reader = decoder.read_info().map_err(broken)?;
        let info = reader.info();
        let kinds = [(info.interlaced, "is interlaced"), (info.animation_control.is_some(), "is an animation")];
        if let Some((_, other)) = kinds.into_iter().find(|(is_other, _)| *is_other) {
            return Err(PictureError::Kind(other));
        }
        let label = Tags::of(reader.info()).map_err(PictureError::Label)?;
        let kind = reader.output_color_type();
        let row = 3 * width as usize;
        let mut bytes = vec![0; row * height as usize];
        let mut on_black = if kind == PLAIN { Vec::new() } else { vec![0; bytes.len()] };
        let mut line = vec![0; reader.output_line_size(width).unwrap_or(0)];
        for (at, white) in bytes.chunks_exact_mut(row).enumerate() {
            let read = reader.read_row(if kind == PLAIN { &mut *white } else { &mut line }).map_err(broken)?;
            read.ok_or_else(|| PictureError::Broken("rows are missing".to_owned()))?;
            if kind != PLAIN {
                show(&line, kind, white, &mut on_black[at * row..(at + 1) * row]);
            }
        }
        reader.finish().map_err(broken)?;
        if Tags::of(reader.info()).map_err(PictureError::Label)? != label {
            return Err(PictureError::Late);
        }
        let on_black = (kind != PLAIN && on_black != bytes).then_some(on_black);
        Ok(Self { size: [width, height], bytes, on_black, label })
    }
}

/// The numbers of a pixel, and their bits.
type Kind = (png::ColorType, png::BitDepth);

/// Writes the colours of a row of pixels with opacities on white and on black, rounded to 8 bits. Opacities act on the numbers as they are,
/// as in browsers.
fn show(line: &[u8], (colour, depth): Kind, white: &mut [u8], black: &mut [u8]) {
    let (samples, most): (Vec<u64>, u64) = match depth {
        png::BitDepth::Sixteen => {
            let samples = line.as_chunks::<2>().0.iter().map(|&two| u16::from_be_bytes(two).into());
            (samples.collect(), u16::MAX.into())
        }
        _ => (line.iter().map(|&byte| byte.into()).collect(), u8::MAX.into()),
    };
    let shown = white.as_chunks_mut::<3>().0.iter_mut().zip(black.as_chunks_mut::<3>().0);
    for (pixel, (white, black)) in samples.chunks_exact(colour.samples()).zip(shown) {
        let (light, opacity) = match *pixel {
            [grey, opacity] => ([grey; 3], opacity),
            _ => ([pixel[0], pixel[1], pixel[2]], pixel[3]),
        };
        let square = most * most;
        let on = |ground: u64| {
            let seen = |light: u64| light * opacity + ground * (most - opacity);
            light.map(|light| ((seen(light) * u64::from(u8::MAX) + square / 2) / square) as u8)
        };
        (*white, *black) = (on(most), on(0));
    }
}

/// The bytes of a PNG file.
pub(super) fn file(path: &Path) -> Result<Vec<u8>, PictureError> {
    let found = path.metadata()?;
    if found.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
    }
    // Opening a pipe would block.
    if !found.is_file() {
        return Err(PictureError::Foreign);
    }
    let (mut file, length) = (File::open(path)?, found.len());
    if length > MOST_BYTES {
        return Err(PictureError::Large(length));
    }
    // One byte more than the file should have, so that the end is detected at once.
    let mut bytes = Vec::with_capacity(length as usize + 1);
    // Other files of such a name may be large, so the signature is checked first.
    file.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut bytes)?;
    if bytes != SIGNATURE {
        return Err(PictureError::Foreign);
    }
    file.take(MOST_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// A decoder that verifies every checksum: a damaged text chunk must not count as a missing one.
fn decoder(file: &[u8]) -> png::Decoder<Cursor<&[u8]>> {
    let mut options = png::DecodeOptions::default();
    options.set_ignore_adler32(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = png::Decoder::new_with_options(Cursor::new(file), options);
    decoder.set_limits(png::Limits { bytes: MOST_BESIDE });
    decoder
}

fn broken(error: png::DecodingError) -> PictureError {
    match error {
        png::DecodingError::IoError(error) if error.kind() != io::ErrorKind::UnexpectedEof => error.into(),
        png::DecodingError::LimitsExceeded => PictureError::Laden,
        error => {
            let told = error.to_string();
            let is_checksum = told.starts_with("CRC error");
            PictureError::Broken(if is_checksum { "a checksum is wrong".to_owned() } else { told })
        }
    }
}
