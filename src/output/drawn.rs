//! Frames in folders, and compressed pixels for other files: for drawing only.

use super::frame_name::frame_number;
use super::png::{file, header, pixel_dims, texts_of};
use super::{
    Compression, DiagnosticsWriter, FrameFolder, OutputError, Tags, encode_print, frame_file_name, write_whole,
};
use crate::reading::beside::{entries, name_of};
use crate::runner::Frame;
use std::io;
use std::path::{Path, PathBuf};

impl FrameFolder<'_> {
    /// Writes a drawn picture of a frame, with its metadata, and returns the path of the file, such as
    /// `frame_00030.png`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_picture<'b>(
        &self,
        frame: &Frame,
        image: &image::RgbImage,
        gpu: impl Into<Option<&'b crate::gpu::Gpu>>,
    ) -> io::Result<PathBuf> {
        let DiagnosticsWriter { scene, path, .. } = &self.diagnostics;
        let path = path.with_file_name(frame_file_name(frame.index));
        let texts = Tags::of_frame(scene, frame, &crate::gpu::adapter_name(gpu.into())).texts();
        let dpi = scene.view.print.as_ref().map(|print| print.dpi);
        let file = encode_print(image.dimensions().into(), image.as_raw(), &texts, Compression::Fast, dpi);
        write_whole(&path, &file).map_err(io::Error::other)?;
        Ok(path)
    }
}

/// The numbers and paths of all frames in a folder, by their names, sorted.
pub(crate) fn frame_files(folder: &Path) -> Result<Vec<(u64, PathBuf)>, OutputError> {
    let files = entries(folder).map_err(OutputError::reading(folder))?.into_iter();
    let mut frames: Vec<_> = files.filter_map(|path| Some((frame_number(&name_of(&path))?, path))).collect();
    frames.sort_unstable();
    Ok(frames)
}

/// Reads width and height of a picture (px), whatever program wrote it; `None` if the file is not a PNG file.
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn picture_size(path: &Path) -> Result<Option<[u32; 2]>, OutputError> {
    Ok(header(path)?.map(|reader| [reader.info().width, reader.info().height]))
}

/// Pixels, filtered and packed with the settings of `set`, as the contents of `IDAT` chunks.
pub(crate) fn packed(
    size: [u32; 2],
    kind: png::ColorType,
    pixels: &[u8],
    set: impl FnOnce(&mut png::Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    image_chunks(&file(size, kind, pixels, set)).collect::<Vec<_>>().concat()
}

/// The contents of the `IDAT` chunks of a PNG file.
fn image_chunks(file: &[u8]) -> impl Iterator<Item = &[u8]> {
    // After the signature: length, name, data and checksum of each chunk.
    let mut rest = &file[8..];
    let chunks = std::iter::from_fn(move || {
        let (head, tail) = rest.split_first_chunk::<8>()?;
        let (data, end) = tail.split_at(u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize);
        rest = &end[4..];
        Some((head[4..] == png::chunk::IDAT.0, data))
    });
    chunks.filter_map(|(is_image, data)| is_image.then_some(data))
}

/// Whether a file is the picture that would be written with this size (px), these texts and this resolution (px per
/// inch), and all its checksums are right; `false` if there is no such file.
pub(crate) fn is_drawn(
    path: &Path,
    size: [u32; 2],
    texts: &[(&'static str, String)],
    dpi: Option<f64>,
) -> Result<bool, OutputError> {
    let Some(mut reader) = header(path)? else { return Ok(false) };
    let is_whole = reader.finish().is_ok();
    let info = reader.info();
    let has = |(name, text): &(&'static str, String)| texts_of(info, name) == [Some(text.clone())];
    let of_metre = |dims: png::PixelDimensions| dims.xppu;
    let is_for_print = info.pixel_dims.map(of_metre) == dpi.map(pixel_dims).map(of_metre);
    Ok(is_whole && [info.width, info.height] == size && is_for_print && texts.iter().all(has))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_picture_with_one_wrong_bit_or_a_lost_end_is_not_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.png");
        let (size, texts) = ([20, 10], [("frame", "8".to_owned()), ("adapter", "Ω".to_owned())]);
        let pixels: Vec<u8> = (0..20 * 10 * 3).map(|at: u32| (at * at / 7) as u8).collect();
        let file = encode_print(size, &pixels, &texts, Compression::Fast, Some(300.0));
        let is_kept = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            is_drawn(&path, size, &texts, Some(300.0)).unwrap()
        };
        assert!(is_kept(&file));
        for at in 0..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 1 << (at % 8);
            assert!(!is_kept(&damaged), "byte {at} of {}", file.len());
            assert!(!is_kept(&file[..at]), "{at} of {} bytes", file.len());
        }
    }
}
