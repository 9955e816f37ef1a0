//! GIF: one palette for all frames, to avoid flicker, computed in a first pass over them. Of each frame only the part
//! that differs from the previous one is stored.

use super::order::in_order;
use super::palette::Counts;
use super::{Animation, AnimationError, Written, changed};
use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::io::{self, Write};

/// Ticks per second.
const RATE: f64 = 100.0;
/// The shortest delay (ticks) that players respect; they replace shorter ones by a tenth of a second.
const LEAST: u64 = 2;
/// The palette index of transparent pixels, which keep the previous colour.
const SAME: u8 = 255;
/// The extension block for comments.
const COMMENT: AnyExtension = AnyExtension(0xfe);
/// The first pass as a fraction of the work.
const FIRST: f64 = 0.4;

pub(super) fn write(animation: &Animation<'_>, out: &mut impl Write) -> Result<Written, AnimationError> {
    let ticks = animation.timeline.at_most(RATE / LEAST as f64).ticks(RATE, LEAST);
    let size @ [width, height] = animation.size;
    let [Ok(wide), Ok(high)] = [width, height].map(u16::try_from) else {
        return Err(AnimationError::Wrong(format!(
            "{width}×{height} is too large for a GIF: it has 65535 pixels a side"
        )));
    };

    let mut counts = Counts::new();
    let mut frames: Vec<usize> = ticks.iter().map(|(frame, _)| *frame).collect();
    frames.sort_unstable();
    frames.dedup();
    let count = |at: usize| (animation.image)(frames[at]).map(|image| Counts::of(&image));
    in_order(frames.len(), animation.threads, count, |at, more| {
        counts.add(&more);
        animation.report(FIRST * (at + 1) as f64 / frames.len() as f64)
    })?;
    let palette = counts.palette();
    drop(counts);

    let mut encoder = Encoder::new(out, wide, high, &palette.colours.concat()).map_err(failed)?;
    // The file has the number of repetitions, one less than the number of plays.
    match animation.plays {
        0 => encoder.set_repeat(Repeat::Infinite).map_err(failed)?,
        1 => {}
        plays => encoder.set_repeat(Repeat::Finite(plays - 1)).map_err(failed)?,
    }
    encoder.write_raw_extension(COMMENT, &[animation.comment.as_bytes()]).map_err(failed)?;

    let numbers = |at: usize| Ok(palette.numbers(&(animation.image)(ticks[at].0)?));
    let mut shown: Option<Vec<u8>> = None;
    in_order(ticks.len(), animation.threads, numbers, |at, numbers| {
        let mut frame = frame(size, numbers, &mut shown);
        // A duration longer than the greatest delay is divided into several frames.
        let mut left = ticks[at].1;
        while left > 0 {
            frame.delay = left.min(u16::MAX.into()) as u16;
            left -= u64::from(frame.delay);
            encoder.write_lzw_pre_encoded_frame(&frame).map_err(failed)?;
        }
        animation.report(FIRST + (1.0 - FIRST) * (at + 1) as f64 / ticks.len() as f64)
    })?;
    encoder.into_inner().map_err(failed)?;
    let duration = ticks.iter().map(|(_, ticks)| *ticks as f64).sum::<f64>() / RATE;
    Ok(Written { pictures: ticks.len(), duration, size })
}

/// The compressed part of a picture that differs from the shown one.
fn frame(size: [u32; 2], numbers: Vec<u8>, shown: &mut Option<Vec<u8>>) -> Frame<'static> {
    let (place, buffer) = match shown.take() {
        None => ([0, 0, size[0], size[1]], numbers.clone()),
        Some(shown) => {
            let place @ [left, top, width, height] = changed(size, |at| numbers[at] != shown[at]);
            let places =
                (top..top + height).flat_map(|y| (left..left + width).map(move |x| (y * size[0] + x) as usize));
            let number = |at: usize| if numbers[at] == shown[at] { SAME } else { numbers[at] };
            (place, places.map(number).collect())
        }
    };
    *shown = Some(numbers);
    let is_first = place[2..] == size && buffer.iter().all(|&number| number != SAME);
    let [left, top, width, height] = place.map(|number| number as u16);
    let mut frame = Frame {
        left,
        top,
        width,
        height,
        transparent: (!is_first).then_some(SAME),
        dispose: DisposalMethod::Keep,
        buffer: buffer.into(),
        ..Frame::default()
    };
    frame.make_lzw_pre_encoded();
    frame
}

fn failed(error: EncodingError) -> AnimationError {
    AnimationError::Out(match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}
