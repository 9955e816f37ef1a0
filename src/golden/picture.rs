//! Reads pictures for comparison: 8-bit red, green and blue, and nothing else.

use crate::output::Tags;
use std::fs::File;
use std::io::{self, BufRead, Cursor, Read, Seek};
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
    /// It has another pixel format than the pictures of this crate.
    #[error("the picture {0}; expected 8 bits of red, green and blue, not interlaced")]
    Kind(String),
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
    /// Three bytes for each pixel, row after row from the top left.
    pub bytes: Vec<u8>,
    /// Its metadata, if it has any.
    pub label: Option<Tags>,
}

impl Pixels {
    /// Reads a PNG file.
    ///
    /// # Errors
    /// A file that cannot be read, is not a complete PNG file, or has another pixel format than frames.
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
        let mut decoder = decoder(Cursor::new(file));
        let [width, height] = decoder.read_header_info().map(|info| [info.width, info.height]).map_err(broken)?;
        if width.max(height) > LONGEST_SIDE || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(PictureError::Size(width, height));
        }
        let mut reader = decoder.read_info().map_err(broken)?;
        check(reader.info()).map_err(PictureError::Kind)?;
        let label = Tags::of(reader.info()).map_err(PictureError::Label)?;
        let row = 3 * width as usize;
        let mut bytes = vec![0; row * height as usize];
        for row in bytes.chunks_exact_mut(row) {
            let read = reader.read_row(row).map_err(broken)?;
            read.ok_or_else(|| PictureError::Broken("rows are missing".to_owned()))?;
        }
        reader.finish().map_err(broken)?;
        if Tags::of(reader.info()).map_err(PictureError::Label)? != label {
            return Err(PictureError::Late);
        }
        Ok(Self { size: [width, height], bytes, label })
    }
}

/// The bytes of a PNG file.
pub(super) fn file(path: &Path) -> Result<Vec<u8>, PictureError> {
    let mut file = open(path)?;
    let length = file.metadata()?.len();
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

fn open(path: &Path) -> Result<File, PictureError> {
    let found = path.metadata()?;
    if found.is_dir() {
        return Err(io::Error::from(io::ErrorKind::IsADirectory).into());
    }
    // Opening a pipe would block.
    if !found.is_file() {
        return Err(PictureError::Foreign);
    }
    Ok(File::open(path)?)
}

/// A decoder that verifies every checksum: a damaged text chunk must not count as a missing one.
fn decoder<R: BufRead + Seek>(file: R) -> png::Decoder<R> {
    let mut options = png::DecodeOptions::default();
    options.set_ignore_adler32(false);
    options.set_skip_ancillary_crc_failures(false);
    let mut decoder = png::Decoder::new_with_options(file, options);
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

/// A message for pixel formats that are not compared.
fn check(info: &png::Info<'_>) -> Result<(), String> {
    if info.bit_depth != png::BitDepth::Eight {
        return Err(format!("has {} bits a channel", info.bit_depth as u8));
    }
    let kind = match info.color_type {
        _ if info.interlaced => "is interlaced",
        _ if info.animation_control.is_some() => "is an animation",
        png::ColorType::Rgb if info.trns.is_some() => "calls one colour transparent",
        png::ColorType::Rgb => return Ok(()),
        png::ColorType::Rgba => "has opacities",
        png::ColorType::Indexed => "has a palette",
        png::ColorType::Grayscale | png::ColorType::GrayscaleAlpha => "is grey",
    };
    Err(kind.to_owned())
}
