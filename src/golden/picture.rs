//! Pictures as they are read to be compared: 8-bit red, green and blue, with or without opacities, and nothing else.

use crate::output::{Tags, tags_of};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// The longest side of a picture (px): more than any that is drawn, and little enough to be read.
const LONGEST_SIDE: u32 = 16_384;

/// Why a file is no picture that can be compared.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It cannot be opened.
    #[error("cannot read {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no PNG file, or not all of one.
    #[error("{}: this is no whole PNG picture ({reason})", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// It is a PNG file of another kind than those that are written here.
    #[error("{}: the picture {what}; expected 8 bits of red, green and blue, not interlaced", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// What it is or has.
        what: String,
    },
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
    pub tags: Option<Tags>,
}

impl Pixels {
    /// Reads a PNG file.
    ///
    /// # Errors
    /// A file that cannot be read, is no PNG file or only a part of one, or is of another kind than frames are.
    pub fn read(path: &Path) -> Result<Self, PictureError> {
        let broken = |error: png::DecodingError| PictureError::Broken { path: path.into(), reason: error.to_string() };
        let file = File::open(path).map_err(|source| PictureError::Read { path: path.into(), source })?;
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(broken)?;
        let info = reader.info();
        let kind = |what: String| Err(PictureError::Kind { path: path.into(), what });
        if info.width.max(info.height) > LONGEST_SIDE {
            return kind(format!("says that it has {}×{} pixels", info.width, info.height));
        }
        if info.bit_depth != png::BitDepth::Eight {
            return kind(format!("has {} bits a channel", info.bit_depth as u8));
        }
        if info.interlaced {
            return kind("is interlaced".to_owned());
        }
        let channels = match info.color_type {
            png::ColorType::Rgb => 3,
            png::ColorType::Rgba => 4,
            png::ColorType::Indexed => return kind("has a palette".to_owned()),
            png::ColorType::Grayscale | png::ColorType::GrayscaleAlpha => return kind("is grey".to_owned()),
        };
        let (size, tags) = ([info.width, info.height], tags_of(info));
        let mut bytes = vec![0; size[0] as usize * size[1] as usize * channels];
        reader.next_frame(&mut bytes).map_err(broken)?;
        // The checksum of what follows the pixels is a part of the whole, too.
        reader.finish().map_err(broken)?;
        Ok(Self { size, channels, bytes, tags })
    }
}
