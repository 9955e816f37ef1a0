//! Animated PNG: lossless; only the pixels that differ from the previous frame are stored.

use super::order::in_order;
use super::timeline::fraction;
use super::{Animation, AnimationError, Image, Written, changed};
use crate::output::packed;
use std::io::{self, Write};

const ANIMATION_CONTROL: png::chunk::ChunkType = png::chunk::ChunkType(*b"acTL");
const FRAME_CONTROL: png::chunk::ChunkType = png::chunk::ChunkType(*b"fcTL");
const FRAME_DATA: png::chunk::ChunkType = png::chunk::ChunkType(*b"fdAT");

/// The changed part of a frame, compressed.
struct Patch {
    place: [u32; 4],
    data: Vec<u8>,
}

pub(super) fn write(animation: &Animation<'_>, out: &mut impl Write) -> Result<Written, AnimationError> {
    let shots = animation.timeline.shots();
    let [width, height] = animation.size;
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.add_itxt_chunk("Comment".to_owned(), animation.comment.to_owned()).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    let control = [shots.len() as u32, u32::from(animation.plays)].map(u32::to_be_bytes).concat();
    writer.write_chunk(ANIMATION_CONTROL, &control).map_err(failed)?;

    let patch = |at: usize| {
        let image = (animation.image)(shots[at].frame)?;
        // The frame before is read again: a thread has every second frame or fewer, and reading takes a fraction of the
        // time of compressing.
        let before = at.checked_sub(1).map(|before| (animation.image)(shots[before].frame)).transpose()?;
        Ok(Patch::new(&image, before.as_ref()))
    };
    let mut sequence = 0_u32;
    in_order(shots.len(), animation.threads, patch, |at, patch| {
        writer.write_chunk(FRAME_CONTROL, &patch.control(sequence, shots[at].duration)).map_err(failed)?;
        sequence += 1;
        if at == 0 {
            writer.write_chunk(png::chunk::IDAT, &patch.data).map_err(failed)?;
        } else {
            let data = [&sequence.to_be_bytes(), patch.data.as_slice()].concat();
            writer.write_chunk(FRAME_DATA, &data).map_err(failed)?;
            sequence += 1;
        }
        animation.report((at + 1) as f64 / shots.len() as f64)
    })?;
    writer.finish().map_err(failed)?;
    Ok(Written { pictures: shots.len(), duration: animation.timeline.duration(), size: [width, height] })
}

impl Patch {
    /// Unchanged pixels are transparent, which compresses best.
    fn new(image: &Image, before: Option<&Image>) -> Self {
        let [width, height] = image.size;
        let pixel = |image: &Image, at: usize| [0, 1, 2].map(|channel| image.pixels[3 * at + channel]);
        let is_new = |at: usize| before.is_none_or(|before| pixel(image, at) != pixel(before, at));
        let place = if before.is_some() { changed(image.size, is_new) } else { [0, 0, width, height] };
        let [left, top, wide, high] = place.map(|number| number as usize);
        let places = (top..top + high).flat_map(|y| (0..wide).map(move |x| y * width as usize + left + x));
        let mut pixels = Vec::with_capacity(4 * wide * high);
        for at in places {
            let [r, g, b] = pixel(image, at);
            pixels.extend_from_slice(&if is_new(at) { [r, g, b, 255] } else { [0; 4] });
        }
        let data = packed([place[2], place[3]], png::ColorType::Rgba, &pixels, |encoder| {
            // A third smaller than the fastest level, in twice the time.
            encoder.set_deflate_compression(png::DeflateCompression::Level(3));
            encoder.set_filter(png::Filter::Paeth);
        });
        Self { place, data }
    }

    /// The control chunk before the data: the part is not disposed, and is blended over the previous frame.
    fn control(&self, sequence: u32, duration: f64) -> Vec<u8> {
        let [left, top, width, height] = self.place;
        let numbers = [sequence, width, height, left, top].map(u32::to_be_bytes).concat();
        let delay = fraction(duration, u16::MAX.into()).map(|part| (part as u16).to_be_bytes()).concat();
        [numbers.as_slice(), &delay, &[0, 1]].concat()
    }
}

fn failed(error: png::EncodingError) -> AnimationError {
    AnimationError::Out(match error {
        png::EncodingError::IoError(error) => error,
        other => io::Error::other(other.to_string()),
    })
}
