//! Pictures as PNG files, with metadata in text chunks.

use super::{OutputError, exact, recorded, state_digest};
use crate::runner::Frame;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::Figure;
use crate::sim::Snapshot;
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;

/// How a picture is compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compression {
    /// In little time: frames.
    Fast,
    /// Into some two thirds of that, in nine times the time: figures and expected pictures.
    Small,
}

impl Compression {
    pub(crate) fn apply<W: Write>(self, encoder: &mut png::Encoder<'_, W>) {
        match self {
            // One filter for all rows: trying all of them takes a third more time for 5 %.
            Self::Fast => {
                encoder.set_compression(png::Compression::Fast);
                encoder.set_filter(png::Filter::Paeth);
            }
            // Mostly flat colours: filters make files larger, and the highest level takes 2.5 times as long for 2 %.
            Self::Small => {
                encoder.set_deflate_compression(png::DeflateCompression::Level(6));
                encoder.set_filter(png::Filter::NoFilter);
            }
        }
    }
}

/// Text chunks of a picture: the last parts of their keywords, and the texts.
pub(crate) type Texts = Vec<(&'static str, String)>;

/// The metadata of a picture, in text chunks. They include no time of day: equal pictures are equal files.
#[derive(Clone, Debug, PartialEq)]
pub struct Tags {
    /// The subject.
    pub shows: Shown,
    /// `localshape:scene`: the digests of its scenes, one line each.
    pub scenes: Vec<String>,
    /// `localshape:state`: digest and name of each state shown, one line each. Runs of several bodies have a state for
    /// each body.
    pub states: Vec<(String, String)>,
    /// `localshape:version`: the version of this crate that drew it.
    pub version: String,
    /// `localshape:adapter`: the graphics adapter that drew it.
    pub adapter: String,
}

/// The subject of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shown {
    /// One moment of a scene.
    Frame {
        /// `localshape:frame`: the frame's number.
        frame: u64,
        /// `localshape:time`: its time (s), 17 significant digits.
        time: f64,
    },
    /// `localshape:figure`: a figure, by its name.
    Figure(String),
}

/// The digest and the name of each recorded state of a run.
fn states(name: &str, scene: &Scene, run: usize, snapshot: &Snapshot) -> Vec<(String, String)> {
    let states = recorded(name, scene, run).into_iter();
    states.map(|(name, nodes)| (state_digest(snapshot, nodes), name)).collect()
}

impl Tags {
    /// The tags of a frame of `scene` drawn by `adapter`.
    pub fn of_frame(scene: &Scene, frame: &Frame, adapter: &str) -> Self {
        let states = frame.runs.iter().flat_map(|of| states(&scene.runs[of.run].name, scene, of.run, &of.snapshot));
        let shows = Shown::Frame { frame: frame.index, time: frame.time };
        Self::new(shows, vec![scene.digest.clone()], states.collect(), adapter)
    }

    /// The tags of a figure that shows `moments`, drawn by `adapter`.
    pub fn of_figure(figure: &Figure, moments: &Moments, adapter: &str) -> Self {
        let scenes = figure.scenes().iter().map(|scene| scene.digest.clone()).collect();
        let shown = moments.runs_and_states(figure).into_iter();
        let states = shown.flat_map(|(name, (scene, run), snapshot)| states(&name, scene, run, snapshot));
        Self::new(Shown::Figure(figure.name.clone()), scenes, states.collect(), adapter)
    }

    fn new(shows: Shown, scenes: Vec<String>, states: Vec<(String, String)>, adapter: &str) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { shows, scenes, states, version, adapter: adapter.to_owned() }
    }

    /// The number of the frame shown; `None` of figures.
    pub fn frame(&self) -> Option<u64> {
        match self.shows {
            Shown::Frame { frame, .. } => Some(frame),
            Shown::Figure(_) => None,
        }
    }

    /// The texts of the chunks, with the last part of their keywords.
    pub fn texts(&self) -> Texts {
        let states: Vec<_> = self.states.iter().map(|(digest, name)| format!("{digest} {name}")).collect();
        let [scene, state] = [("scene", self.scenes.join("\n")), ("state", states.join("\n"))];
        let mut texts = match &self.shows {
            Shown::Frame { frame, time } => vec![scene, state, ("frame", frame.to_string()), ("time", exact(*time))],
            Shown::Figure(name) => vec![("figure", name.clone()), scene, state],
        };
        texts.extend([("version", self.version.clone()), ("adapter", self.adapter.clone())]);
        texts
    }

    /// The metadata in the header of a picture; `None` if another program wrote it.
    ///
    /// # Errors
    /// The name of a text that is missing, occurs twice or is invalid.
    pub(crate) fn of(info: &png::Info<'_>) -> Result<Option<Self>, &'static str> {
        const NAMES: [&str; 7] = ["figure", "scene", "state", "frame", "time", "version", "adapter"];
        let found = NAMES.map(|name| texts_of(info, name));
        if found.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        // A text that occurs twice is not used.
        if let Some(at) = found.iter().position(|texts| texts.len() > 1) {
            return Err(NAMES[at]);
        }
        let found = found.map(|mut texts| texts.pop().flatten());
        let [figure, scene, state, frame, time, version, adapter] = found.each_ref().map(Option::as_deref);
        let shows = match (figure, frame) {
            (Some(_), Some(_)) => return Err("figure"),
            (Some(name), None) => Shown::Figure(name.to_owned()),
            (None, frame) => {
                let frame = frame.and_then(|text| text.parse().ok()).ok_or("frame")?;
                let time = time.and_then(|text| text.parse().ok()).filter(|time: &f64| time.is_finite());
                Shown::Frame { frame, time: time.ok_or("time")? }
            }
        };
        let is_digest = |digest: &str| digest.len() == 64 && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
        // Names are printed on terminals, so control characters are refused.
        let state_of = |line: &str| {
            let (digest, name) = line.split_once(' ')?;
            (is_digest(digest) && !name.contains(char::is_control)).then(|| (digest.to_owned(), name.to_owned()))
        };
        let states: Option<Vec<_>> = state.ok_or("state")?.lines().map(state_of).collect();
        let states = states.filter(|states| (1..=MOST_STATES).contains(&states.len())).ok_or("state")?;
        let scenes = scene.ok_or("scene")?.lines().map(str::to_owned).collect();
        let [version, adapter] = [version.ok_or("version")?, adapter.ok_or("adapter")?].map(str::to_owned);
        Ok(Some(Self { shows, scenes, states, version, adapter }))
    }
}

/// An upper limit, above the number of states of any picture: each state is searched for among those of another
/// picture.
const MOST_STATES: usize = 4096;

/// Encodes a picture of 8-bit red, green and blue as a PNG file in sRGB, with texts such as those of [`Tags::texts`].
///
/// `pixels` has three bytes for each pixel, in rows from the top left.
///
/// # Panics
/// If the length of `pixels` does not match `size`, the width and height (px), or the size is zero.
pub fn encode(size: [u32; 2], pixels: &[u8], texts: &[(&'static str, String)], compression: Compression) -> Vec<u8> {
    encode_print(size, pixels, texts, compression, None)
}

/// Encodes a picture likewise, with its pixels per inch in print if they are known (`pHYs`).
pub fn encode_print(
    size: [u32; 2],
    pixels: &[u8],
    texts: &[(&'static str, String)],
    compression: Compression,
    dpi: Option<f64>,
) -> Vec<u8> {
    let [width, height] = size;
    let all = u64::from(width) * u64::from(height);
    assert!([3 * all, 4 * all].contains(&(pixels.len() as u64)), "{} bytes for {all} pixels", pixels.len());
    let colour = if pixels.len() as u64 == 3 * all { png::ColorType::Rgb } else { png::ColorType::Rgba };
    file(size, colour, pixels, |encoder| {
        compression.apply(encoder);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_pixel_dims(dpi.map(pixel_dims));
        for (name, text) in texts {
            let name = format!("localshape:{name}");
            // A tEXt chunk can have only Latin-1 without control characters.
            let plain =
                text.chars().all(|c| c == '\n' || (' '..='~').contains(&c) || ('\u{a1}'..='\u{ff}').contains(&c));
            let added = if plain {
                encoder.add_text_chunk(name, text.clone())
            } else {
                encoder.add_itxt_chunk(name, text.clone())
            };
            added.expect("the header is not written yet");
        }
    })
}

/// A PNG file of pixels of 8 bits a channel, with the settings of `set`.
pub(super) fn file(
    [width, height]: [u32; 2],
    kind: png::ColorType,
    pixels: &[u8],
    set: impl FnOnce(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(pixels.len() / 8);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(kind);
    encoder.set_depth(png::BitDepth::Eight);
    set(&mut encoder);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    written.expect("a picture of the right length into memory");
    bytes
}

/// Reads width and height of a picture (px) and its metadata, without its pixels; `None` if the file is not a PNG file
/// or was not written by this crate.
///
/// # Errors
/// If the file cannot be read.
pub fn read_tags(path: &Path) -> Result<Option<([u32; 2], Tags)>, OutputError> {
    path.metadata().map_err(OutputError::reading(path))?;
    let reader = header(path)?;
    let info = reader.as_ref().map(png::Reader::info);
    Ok(info.and_then(|info| Some(([info.width, info.height], Tags::of(info).ok()??))))
}

/// A reader after the header of a picture, which compares all checksums; `None` if there is no sound PNG file at the path.
pub(super) fn header(path: &Path) -> Result<Option<png::Reader<BufReader<File>>>, OutputError> {
    // Opening a pipe would block.
    if !path.is_file() {
        return Ok(None);
    }
    let file = File::open(path).map_err(OutputError::reading(path))?;
    // A damaged text must not count as a missing one.
    let mut options = png::DecodeOptions::default();
    options.set_skip_ancillary_crc_failures(false);
    match png::Decoder::new_with_options(BufReader::new(file), options).read_info() {
        Ok(reader) => Ok(Some(reader)),
        Err(png::DecodingError::IoError(error)) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            Err(OutputError::reading(path)(error))
        }
        Err(_) => Ok(None),
    }
}

/// Pixels per metre from pixels per inch.
pub(super) fn pixel_dims(dpi: f64) -> png::PixelDimensions {
    let count = (dpi / 0.0254).round() as u32;
    png::PixelDimensions { xppu: count, yppu: count, unit: png::Unit::Meter }
}

/// The texts with one of our keywords; `None` for each text that cannot be read.
pub(super) fn texts_of(info: &png::Info<'_>, name: &str) -> Vec<Option<String>> {
    let is = |keyword: &str| keyword.strip_prefix("localshape:") == Some(name);
    let plain =
        info.uncompressed_latin1_text.iter().filter(|chunk| is(&chunk.keyword)).map(|chunk| Some(chunk.text.clone()));
    let wide = info.utf8_text.iter().filter(|chunk| is(&chunk.keyword)).map(|chunk| chunk.get_text().ok());
    // Other programs may have compressed the text.
    let packed = info.compressed_latin1_text.iter().filter(|chunk| is(&chunk.keyword));
    plain.chain(wide).chain(packed.map(|chunk| chunk.get_text().ok())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags() -> Tags {
        Tags {
            shows: Shown::Frame { frame: 7, time: 0.1 + 0.2 },
            scenes: vec!["0123".to_owned()],
            states: vec![
                ("ab".repeat(32), "Local shape".to_owned()),
                ("cd".repeat(32), "Ressorts à ½ · 弾性".to_owned()),
            ],
            version: "1.2.3".to_owned(),
            adapter: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
        }
    }

    fn made(size: [u32; 2], pixels: &[u8], tags: &Tags) -> Vec<u8> {
        encode(size, pixels, &tags.texts(), Compression::Fast)
    }

    #[test]
    fn pixels_and_tags_survive_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        let scenes = vec!["01".to_owned(), "23".to_owned()];
        let figure = Tags { shows: Shown::Figure("fig1".to_owned()), scenes, ..tags() };
        for tags in [tags(), figure] {
            let pixels: Vec<u8> = (0..5 * 3 * 3).map(|byte| byte * 4).collect();
            let bytes = made([5, 3], &pixels, &tags);
            assert_eq!(bytes, made([5, 3], &pixels, &tags), "equal input, equal bytes");
            std::fs::write(&path, &bytes).unwrap();
            assert_eq!(read_tags(&path).unwrap(), Some(([5, 3], tags)));

            let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            let found = (reader.info().color_type, reader.info().srgb);
            assert_eq!(found, (png::ColorType::Rgb, Some(png::SrgbRenderingIntent::Perceptual)));
            let mut back = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut back).unwrap();
            assert_eq!(back, pixels);
        }
    }

    #[test]
    fn no_file_of_ours_has_no_tags() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(read_tags(&path).unwrap(), None);
        std::fs::write(&path, &made([1, 1], &[0; 3], &tags())[..40]).unwrap();
        assert_eq!(read_tags(&path).unwrap(), None);
        assert!(read_tags(&folder.path().join("absent.png")).is_err());
    }
}
