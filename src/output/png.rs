//! Frames as PNG, with what they show written into them.

use super::{OutputError, exact, state_digest};
use crate::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::Figure;
use crate::sim::snapshot::Frame;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// What a frame says about itself, in text chunks. There is no time of day among them: equal pictures are equal files.
#[derive(Clone, Debug, PartialEq)]
pub struct Tags {
    /// `localshape:scene`: the scene's digest.
    pub scene: String,
    /// `localshape:state`: digest of the state and name of each run drawn, one line each.
    pub states: Vec<(String, String)>,
    /// `localshape:frame`: the frame's number.
    pub frame: u64,
    /// `localshape:time`: the moment shown (s), 17 significant digits.
    pub time: f64,
    /// `localshape:version`: the version of this crate that drew it.
    pub version: String,
    /// `localshape:adapter`: the graphics adapter that drew it.
    pub adapter: String,
}

impl Tags {
    /// The tags of a frame of `scene` drawn by `adapter`.
    pub fn new(scene: &Scene, frame: &Frame, adapter: &str) -> Self {
        let state =
            |run: &crate::sim::snapshot::RunFrame| (state_digest(&run.snapshot), scene.runs[run.run].name.clone());
        Self {
            scene: scene.digest.clone(),
            states: frame.runs.iter().map(state).collect(),
            frame: frame.index,
            time: frame.time,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            adapter: adapter.to_owned(),
        }
    }

    fn chunks(&self) -> [(&'static str, String); 6] {
        [
            ("scene", self.scene.clone()),
            ("state", state_lines(&self.states)),
            ("frame", self.frame.to_string()),
            ("time", exact(self.time)),
            ("version", self.version.clone()),
            ("adapter", self.adapter.clone()),
        ]
    }

    fn parse(text: impl Fn(&str) -> Option<String>) -> Option<Self> {
        Some(Self {
            scene: text("scene")?,
            states: states_of(&text("state")?)?,
            frame: text("frame")?.parse().ok()?,
            time: text("time")?.parse().ok()?,
            version: text("version")?,
            adapter: text("adapter")?,
        })
    }
}

/// Digests and names, one line each.
fn state_lines(states: &[(String, String)]) -> String {
    states.iter().map(|(digest, name)| format!("{digest} {name}")).collect::<Vec<_>>().join("\n")
}

/// The way back from [`state_lines`].
fn states_of(lines: &str) -> Option<Vec<(String, String)>> {
    let line = |line: &str| line.split_once(' ').map(|(digest, name)| (digest.to_owned(), name.to_owned()));
    lines.lines().map(line).collect()
}

/// A picture of 8-bit red, green and blue, or of these and opacity, as a PNG file in sRGB, with its tags.
///
/// `pixels` holds three bytes for each pixel, or four, in rows from the top left. Opacity has not been multiplied into
/// the colours.
///
/// # Panics
/// If `pixels` has neither of the lengths that `size`, width and height (px), asks for, or the size is zero.
pub fn encode(size: [u32; 2], pixels: &[u8], tags: &Tags) -> Vec<u8> {
    encode_with(size, pixels, &tags.chunks(), png::Compression::Fast)
}

/// What a figure says about itself, in text chunks.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureTags {
    /// `localshape:figure`: its name.
    pub figure: String,
    /// `localshape:scene`: the digests of its scenes, one line each.
    pub scenes: Vec<String>,
    /// `localshape:state`: digest and name of each state shown, one line each; see `Moments::states`.
    pub states: Vec<(String, String)>,
    /// `localshape:version`: the version of this crate that drew it.
    pub version: String,
    /// `localshape:adapter`: the graphics adapter that drew it.
    pub adapter: String,
}

impl FigureTags {
    /// The tags of a figure that shows `moments`, drawn by `adapter`.
    pub fn new(figure: &Figure, moments: &Moments, adapter: &str) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let scenes = figure.scenes().iter().map(|scene| scene.digest.clone()).collect();
        let states = moments.states(figure).into_iter();
        let states = states.map(|(name, snapshot)| (state_digest(snapshot), name)).collect();
        Self { figure: figure.name.clone(), scenes, states, version, adapter: adapter.to_owned() }
    }

    fn chunks(&self) -> [(&'static str, String); 5] {
        [
            ("figure", self.figure.clone()),
            ("scene", self.scenes.join("\n")),
            ("state", state_lines(&self.states)),
            ("version", self.version.clone()),
            ("adapter", self.adapter.clone()),
        ]
    }
}

/// A figure of 8-bit red, green and blue as a PNG file in sRGB, with its tags. See [`encode`].
///
/// # Panics
/// As [`encode`].
pub fn encode_figure(size: [u32; 2], pixels: &[u8], tags: &FigureTags) -> Vec<u8> {
    // A single picture may take its time.
    encode_with(size, pixels, &tags.chunks(), png::Compression::High)
}

/// A picture of 8-bit red, green and blue as a PNG file in sRGB that says nothing of itself, as small as can be had.
///
/// # Panics
/// As [`encode`].
pub(crate) fn encode_plain(size: [u32; 2], pixels: &[u8]) -> Vec<u8> {
    encode_with(size, pixels, &[], png::Compression::High)
}

/// A picture of 8-bit red, green and blue as a PNG file in sRGB with a comment, as small as can be had.
///
/// # Panics
/// As [`encode`].
#[cfg(feature = "render")]
pub(crate) fn encode_commented(size: [u32; 2], pixels: &[u8], comment: &str) -> Vec<u8> {
    encode_with(size, pixels, &[("comment", comment.to_owned())], png::Compression::High)
}

/// Whether a file is a figure that this crate drew.
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn is_figure(path: &Path) -> Result<bool, OutputError> {
    Ok(header(path, |info| chunk(info, "figure").is_some())? == Some(true))
}

/// A picture as a PNG file in sRGB with text chunks.
fn encode_with(
    size: [u32; 2],
    pixels: &[u8],
    chunks: &[(&'static str, String)],
    compression: png::Compression,
) -> Vec<u8> {
    let [width, height] = size;
    let all = u64::from(width) * u64::from(height);
    let colour = match pixels.len() as u64 {
        length if length == 3 * all => png::ColorType::Rgb,
        length if length == 4 * all => png::ColorType::Rgba,
        length => panic!("{length} bytes for {all} pixels; expected three for each, or four"),
    };
    let mut bytes = Vec::with_capacity(pixels.len() / 8);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(compression);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    for (name, text) in chunks {
        let name = format!("localshape:{name}");
        // The plain text chunk knows Latin-1 only, without control characters.
        let plain = text.chars().all(|c| c == '\n' || (' '..='~').contains(&c) || ('\u{a1}'..='\u{ff}').contains(&c));
        let added =
            if plain { encoder.add_text_chunk(name, text.clone()) } else { encoder.add_itxt_chunk(name, text.clone()) };
        added.expect("the header is not written yet");
    }
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    written.expect("a picture of the right length into memory");
    bytes
}

/// Reads what a frame says about itself; `None` if the file is no PNG or was not written by this crate.
///
/// # Errors
/// If the file cannot be read.
pub fn read_tags(path: &Path) -> Result<Option<Tags>, OutputError> {
    Ok(read_frame(path)?.map(|(_, tags)| tags))
}

/// Reads width and height of a frame (px) and what it says about itself, without its pixels; see [`read_tags`].
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn read_frame(path: &Path) -> Result<Option<([u32; 2], Tags)>, OutputError> {
    let described = |info: &png::Info<'_>| tags_of(info).map(|tags| ([info.width, info.height], tags));
    Ok(header(path, described)?.flatten())
}

/// What is before the pixels of a picture; `None` if it is no PNG file.
fn header<T>(path: &Path, take: impl FnOnce(&png::Info<'_>) -> T) -> Result<Option<T>, OutputError> {
    // To open a pipe would be to wait for ever.
    if !path.metadata().map_err(OutputError::reading(path))?.is_file() {
        return Ok(None);
    }
    let file = File::open(path).map_err(OutputError::reading(path))?;
    match png::Decoder::new(BufReader::new(file)).read_info() {
        Ok(reader) => Ok(Some(take(reader.info()))),
        Err(png::DecodingError::IoError(error)) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
            Err(OutputError::reading(path)(error))
        }
        Err(_) => Ok(None),
    }
}

/// What the header of a picture says of what it shows, if it was written by this crate.
pub(crate) fn tags_of(info: &png::Info<'_>) -> Option<Tags> {
    Tags::parse(|name| chunk(info, name))
}

/// More states than any picture shows: each is looked for among those of another picture.
const MOST_STATES: usize = 4096;

/// What a picture says of itself, be it a frame or a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Label {
    /// One moment of a scene.
    Frame(Tags),
    /// A figure.
    Figure(FigureTags),
}

impl Label {
    /// What the header of a picture says; `None` of pictures of others.
    ///
    /// # Errors
    /// The name of a chunk of ours that is missing or makes no sense.
    pub(crate) fn of(info: &png::Info<'_>) -> Result<Option<Self>, &'static str> {
        const NAMES: [&str; 7] = ["figure", "scene", "state", "frame", "time", "version", "adapter"];
        let text = |name: &'static str| chunk(info, name).ok_or(name);
        if NAMES.iter().all(|name| chunk(info, name).is_none()) {
            return Ok(None);
        }
        // What is said twice is not known.
        if let Some(&name) = NAMES.iter().find(|name| chunks_of(info, name) > 1) {
            return Err(name);
        }
        if chunk(info, "figure").is_some() && chunk(info, "frame").is_some() {
            return Err("figure");
        }
        let is_digest = |digest: &String| digest.len() == 64 && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
        // Names are told on terminals.
        let is_state = |(digest, name): &(String, String)| is_digest(digest) && !name.contains(char::is_control);
        let are_states =
            |all: &Vec<(String, String)>| (1..=MOST_STATES).contains(&all.len()) && all.iter().all(is_state);
        let states = states_of(&text("state")?).filter(are_states).ok_or("state")?;
        let (version, adapter) = (text("version")?, text("adapter")?);
        if let Some(figure) = chunk(info, "figure") {
            let scenes = text("scene")?.lines().map(str::to_owned).collect();
            return Ok(Some(Self::Figure(FigureTags { figure, scenes, states, version, adapter })));
        }
        let frame = text("frame")?.parse().map_err(|_| "frame")?;
        let time = text("time")?.parse().ok().filter(|time: &f64| time.is_finite()).ok_or("time")?;
        Ok(Some(Self::Frame(Tags { scene: text("scene")?, states, frame, time, version, adapter })))
    }

    /// Digest and name of each state shown.
    pub fn states(&self) -> &[(String, String)] {
        match self {
            Self::Frame(tags) => &tags.states,
            Self::Figure(tags) => &tags.states,
        }
    }

    /// The graphics adapter that drew it.
    pub fn adapter(&self) -> &str {
        match self {
            Self::Frame(tags) => &tags.adapter,
            Self::Figure(tags) => &tags.adapter,
        }
    }

    /// The version of this crate that drew it.
    pub fn version(&self) -> &str {
        match self {
            Self::Frame(tags) => &tags.version,
            Self::Figure(tags) => &tags.version,
        }
    }

    /// Digests of the scenes shown.
    pub fn scenes(&self) -> Vec<&str> {
        match self {
            Self::Frame(tags) => vec![&tags.scene],
            Self::Figure(tags) => tags.scenes.iter().map(String::as_str).collect(),
        }
    }

    /// A picture with this label as a PNG file, as small as can be had; see [`encode`].
    ///
    /// # Panics
    /// As [`encode`].
    pub fn encode(&self, size: [u32; 2], pixels: &[u8]) -> Vec<u8> {
        let compression = png::Compression::High;
        match self {
            Self::Frame(tags) => encode_with(size, pixels, &tags.chunks(), compression),
            Self::Figure(tags) => encode_with(size, pixels, &tags.chunks(), compression),
        }
    }
}

/// How many of our chunks of one name there are.
fn chunks_of(info: &png::Info<'_>, name: &str) -> usize {
    let is = |keyword: &str| keyword.strip_prefix("localshape:") == Some(name);
    let plain = info.uncompressed_latin1_text.iter().filter(|chunk| is(&chunk.keyword));
    let wide = info.utf8_text.iter().filter(|chunk| is(&chunk.keyword));
    let packed = info.compressed_latin1_text.iter().filter(|chunk| is(&chunk.keyword));
    plain.count() + wide.count() + packed.count()
}

/// The text in one of our chunks.
fn chunk(info: &png::Info<'_>, name: &str) -> Option<String> {
    let keyword = format!("localshape:{name}");
    let plain = info.uncompressed_latin1_text.iter().find(|chunk| chunk.keyword == keyword);
    let wide = || info.utf8_text.iter().find(|chunk| chunk.keyword == keyword)?.get_text().ok();
    // Other programs may have packed it.
    let packed = || info.compressed_latin1_text.iter().find(|chunk| chunk.keyword == keyword)?.get_text().ok();
    plain.map(|chunk| chunk.text.clone()).or_else(wide).or_else(packed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags() -> Tags {
        Tags {
            scene: "0123".to_owned(),
            states: vec![
                ("ab".to_owned(), "Local shape".to_owned()),
                ("cd".to_owned(), "Ressorts à ½ · 弾性".to_owned()),
            ],
            frame: 7,
            time: 0.1 + 0.2,
            version: "1.2.3".to_owned(),
            adapter: "llvmpipe (LLVM 15.0.6, 256 bits)".to_owned(),
        }
    }

    #[test]
    fn tags_survive_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        let pixels: Vec<u8> = (0..5 * 3 * 3).map(|byte| byte * 5).collect();
        let bytes = encode([5, 3], &pixels, &tags());
        assert_eq!(bytes, encode([5, 3], &pixels, &tags()), "equal input, equal bytes");
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read_tags(&path).unwrap(), Some(tags()));

        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        assert_eq!(reader.info().srgb, Some(png::SrgbRenderingIntent::Perceptual));
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut back).unwrap();
        assert_eq!(back, pixels);
    }

    #[test]
    fn opacities_survive_the_file() {
        let pixels: Vec<u8> = (0..5 * 3 * 4).map(|byte| byte * 4).collect();
        let bytes = encode([5, 3], &pixels, &tags());
        assert_eq!(bytes, encode([5, 3], &pixels, &tags()), "equal input, equal bytes");
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        assert_eq!(reader.info().color_type, png::ColorType::Rgba);
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut back).unwrap();
        assert_eq!(back, pixels);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read_frame(&path).unwrap(), Some(([5, 3], tags())));
    }

    #[test]
    fn no_file_of_ours_has_no_tags() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(read_tags(&path).unwrap(), None);
        std::fs::write(&path, &encode([1, 1], &[0; 3], &tags())[..40]).unwrap();
        assert_eq!(read_tags(&path).unwrap(), None);
        assert!(read_tags(&folder.path().join("absent.png")).is_err());
    }
}
