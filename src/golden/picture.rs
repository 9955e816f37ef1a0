//! Pictures as they are read to be compared: 8-bit red, green and blue, with or without opacities, and nothing else.

use crate::output::Label;
use std::io::{BufRead, Cursor, Seek};
use std::path::Path;

/// The longest side of a picture (px), and its most pixels: both sides of a pair are held in memory.
const LONGEST_SIDE: u32 = 16_384;
const MOST_PIXELS: u64 = 100_000_000;

/// Why a file is no picture that can be compared.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It cannot be opened.
    #[error("cannot be read")]
    Read(#[from] std::io::Error),
    /// It is no PNG file.
    #[error("this is no PNG picture")]
    Foreign,
    /// It is a PNG file, but not a whole one.
    #[error("this PNG picture is damaged or cut short ({0})")]
    Broken(String),
    /// It is a PNG file of another kind than those that are written here.
    #[error("the picture {0}; expected 8 bits of red, green and blue, not interlaced")]
    Kind(String),
    /// It says of itself what cannot be.
    #[error(
        "the picture was drawn by this program, but its text `localshape:{0}` is missing or damaged; \
         its pixels alone prove nothing"
    )]
    Label(&'static str),
}

/// A picture with what it says about itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width and height (px).
    pub size: [u32; 2],
    /// Bytes of each pixel: three, or four with opacities.
    pub channels: usize,
    /// Row after row from the top left.
    pub bytes: Vec<u8>,
    /// What it shows, if it says so.
    pub label: Option<Label>,
}

impl Pixels {
    /// Reads a PNG file.
    ///
    /// # Errors
    /// A file that cannot be read, is no PNG file or only a part of one, or is of another kind than frames are.
    pub fn read(path: &Path) -> Result<Self, PictureError> {
        if path.is_dir() {
            return Err(std::io::Error::from(std::io::ErrorKind::IsADirectory).into());
        }
        // In one piece: a pipe is no picture, and files are small.
        if !path.metadata()?.is_file() {
            return Err(PictureError::Foreign);
        }
        Self::decode(std::io::BufReader::new(std::fs::File::open(path)?))
    }

    /// Reads a PNG file from memory.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PictureError> {
        Self::decode(Cursor::new(bytes))
    }

    /// What the header of a PNG file says about itself, without its pixels.
    ///
    /// # Errors
    /// As [`Self::read`], as far as that can be told from the header.
    pub(super) fn read_label(path: &Path) -> Result<Option<Label>, PictureError> {
        if !path.metadata()?.is_file() {
            return Err(PictureError::Foreign);
        }
        let file = std::io::BufReader::new(std::fs::File::open(path)?);
        let reader = png::Decoder::new(file).read_info().map_err(|error| PictureError::Broken(error.to_string()))?;
        Label::of(reader.info()).map_err(PictureError::Label)
    }

    fn decode(mut file: impl BufRead + Seek) -> Result<Self, PictureError> {
        const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
        if !file.fill_buf()?.starts_with(SIGNATURE) {
            return Err(PictureError::Foreign);
        }
        let broken = |error: png::DecodingError| match error {
            png::DecodingError::IoError(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => error.into(),
            error => PictureError::Broken(error.to_string()),
        };
        let mut reader = png::Decoder::new(file).read_info().map_err(broken)?;
        let info = reader.info();
        let kind = |what: String| Err(PictureError::Kind(what));
        let all = u64::from(info.width) * u64::from(info.height);
        if info.width.max(info.height) > LONGEST_SIDE || all > MOST_PIXELS {
            return kind(format!("says that it has {}×{} pixels", info.width, info.height));
        }
        if info.bit_depth != png::BitDepth::Eight {
            return kind(format!("has {} bits a channel", info.bit_depth as u8));
        }
        if info.interlaced {
            return kind("is interlaced".to_owned());
        }
        if info.animation_control.is_some() {
            return kind("is an animation".to_owned());
        }
        let channels = match info.color_type {
            png::ColorType::Rgb if info.trns.is_some() => return kind("calls one colour transparent".to_owned()),
            png::ColorType::Rgb => 3,
            png::ColorType::Rgba => 4,
            png::ColorType::Indexed => return kind("has a palette".to_owned()),
            png::ColorType::Grayscale | png::ColorType::GrayscaleAlpha => return kind("is grey".to_owned()),
        };
        let size = [info.width, info.height];
        let label = Label::of(info).map_err(PictureError::Label)?;
        let mut bytes = vec![0; size[0] as usize * size[1] as usize * channels];
        reader.next_frame(&mut bytes).map_err(broken)?;
        // The checksum of what follows the pixels is a part of the whole, too.
        reader.finish().map_err(broken)?;
        Ok(Self { size, channels, bytes, label })
    }
}
