//! Reads pictures for comparison: 8-bit red, green and blue, with or without alpha, and nothing else.

use crate::output::Label;
use std::fs::File;
use std::io::{self, BufRead, Cursor, Read, Seek};
use std::path::Path;

/// The longest side of a picture (px), and its most pixels: for a report both sides of a pair are held in memory.
const LONGEST_SIDE: u32 = 16_384;
const MOST_PIXELS: u64 = 100_000_000;
/// The largest file (bytes): more than those pixels take. Both files of a pair are held in memory.
const MOST_BYTES: u64 = 1 << 29;
/// The most data beside the pixels (bytes); the text chunks are far smaller.
const MOST_BESIDE: usize = 4 << 20;

/// The signature of PNG files.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Why a file is no picture that can be compared.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It cannot be opened.
    #[error("cannot be read")]
    Read(#[from] io::Error),
    /// It is no PNG file.
    #[error("this is not a PNG picture")]
    Foreign,
    /// It is larger than any picture that is compared.
    #[error("this file has {0} bytes; a picture that can be compared has at most {MOST_BYTES}")]
    Large(u64),
    /// It is a PNG file, but not a whole one.
    #[error("this PNG picture is damaged or cut short ({0})")]
    Broken(String),
    /// It is a PNG file of another kind than those that are written here.
    #[error("the picture {0}; expected 8 bits of red, green and blue, not interlaced")]
    Kind(String),
    /// It is larger than any that is compared, width and height (px).
    #[error(
        "the picture says that it has {0}×{1} pixels; expected at most {LONGEST_SIDE} a side and {million} million in all",
        million = MOST_PIXELS / 1_000_000
    )]
    Size(u32, u32),
    /// It carries more beside its pixels than any picture needs.
    #[error("the picture carries more than {} MiB beside its pixels; save it without that", MOST_BESIDE >> 20)]
    Laden,
    /// It says of itself what cannot be.
    #[error(
        "the picture was drawn by this program, but its text `localshape:{0}` is missing, damaged or there twice; \
         its pixels alone prove nothing"
    )]
    Label(&'static str),
    /// It says behind its pixels what belongs before them.
    #[error("the picture has its text chunks after its pixels; expected them before, as this program writes them")]
    Late,
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
        Self::from_bytes(&file(path)?)
    }

    /// Reads a PNG file from memory.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PictureError> {
        let mut rows = Rows::open(bytes)?;
        let mut bytes = vec![0; rows.header.row() * rows.header.rows()];
        rows.read(&mut bytes)?;
        rows.finish()?;
        let Header { size, channels, label } = rows.header;
        Ok(Self { size, channels, bytes, label })
    }

    /// What the header of a PNG file says about itself, without its pixels.
    ///
    /// # Errors
    /// As [`Self::read`], as far as that can be told from the header.
    pub(super) fn read_label(path: &Path) -> Result<Option<Label>, PictureError> {
        let reader = decoder(io::BufReader::new(open(path)?)).read_info().map_err(broken)?;
        Label::of(reader.info()).map_err(PictureError::Label)
    }
}

/// The bytes of what is to be read as a picture.
pub(super) fn file(path: &Path) -> Result<Vec<u8>, PictureError> {
    let mut file = open(path)?;
    let length = file.metadata()?.len();
    if length > MOST_BYTES {
        return Err(PictureError::Large(length));
    }
    // One byte more than the file should have, so that the end is detected at once.
    let mut bytes = Vec::with_capacity(length as usize + 1);
    // Whatever else lies there under such a name may be large.
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

/// What a picture is, without its pixels.
#[derive(Clone, Debug)]
pub(super) struct Header {
    /// Width and height (px).
    pub(super) size: [u32; 2],
    /// Bytes of each pixel.
    pub(super) channels: usize,
    /// What it shows, if it says so.
    pub(super) label: Option<Label>,
}

impl Header {
    /// Bytes of a row.
    pub(super) fn row(&self) -> usize {
        self.size[0] as usize * self.channels
    }

    /// How many rows there are.
    pub(super) fn rows(&self) -> usize {
        self.size[1] as usize
    }
}

/// A picture whose rows are read one after another.
pub(super) struct Rows<'a> {
    reader: png::Reader<Cursor<&'a [u8]>>,
    pub(super) header: Header,
}

impl<'a> Rows<'a> {
    /// Reads the header of a PNG file, and refuses what no frame is.
    pub(super) fn open(file: &'a [u8]) -> Result<Self, PictureError> {
        if !file.starts_with(SIGNATURE) {
            return Err(PictureError::Foreign);
        }
        let mut decoder = decoder(Cursor::new(file));
        let kind = |what: String| Err(PictureError::Kind(what));
        let [width, height] = decoder.read_header_info().map(|info| [info.width, info.height]).map_err(broken)?;
        if width.max(height) > LONGEST_SIDE || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(PictureError::Size(width, height));
        }
        let reader = decoder.read_info().map_err(broken)?;
        let info = reader.info();
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
        let label = Label::of(info).map_err(PictureError::Label)?;
        Ok(Self { header: Header { size: [width, height], channels, label }, reader })
    }

    /// Reads as many rows as there is room for; there must be so many.
    pub(super) fn read(&mut self, rows: &mut [u8]) -> Result<(), PictureError> {
        for row in rows.chunks_exact_mut(self.header.row()) {
            let read = self.reader.read_row(row).map_err(broken)?;
            read.ok_or_else(|| PictureError::Broken("rows are missing".to_owned()))?;
        }
        Ok(())
    }

    /// Reads what follows the pixels up to the end of the picture, with its checksums.
    pub(super) fn finish(&mut self) -> Result<(), PictureError> {
        self.reader.finish().map_err(broken)?;
        let label = Label::of(self.reader.info()).map_err(PictureError::Label)?;
        if label == self.header.label { Ok(()) } else { Err(PictureError::Late) }
    }
}
