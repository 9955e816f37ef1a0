//! YUV4MPEG2: a header line, then every picture as uncompressed planes of luma and two chroma differences, by ITU-R
//! BT.709 in limited range, with one sample for each pixel.

use super::order::in_order;
use super::{Animation, AnimationError, Image, Written};
use std::io::Write;

pub(super) fn write(animation: &Animation<'_>, out: &mut impl Write) -> Result<Written, AnimationError> {
    let [width, height] = animation.reel.size();
    let [rate, of] = animation.timeline.rate();
    let rate_each = f64::from(rate) / f64::from(of);
    let ticks = animation.timeline.ticks(rate_each, 1);
    // Readers accept headers of about 90 bytes, so only the beginning of the comment is used. Parameters end at a
    // blank.
    let beginning = animation.comment.split(';').next().unwrap_or_default();
    let comment = beginning.replace(|character: char| !character.is_ascii_graphic(), "_");
    let header = format!("YUV4MPEG2 W{width} H{height} F{rate}:{of} Ip C444 XCOLORRANGE=LIMITED X{comment}\n");
    out.write_all(header.as_bytes()).map_err(AnimationError::Out)?;
    let planes = |at: usize| animation.reel.image(ticks[at].0).map(|image| planes(&image));
    let mut pictures = 0;
    in_order(ticks.len(), animation.threads, planes, |at, planes| {
        for _ in 0..ticks[at].1 {
            out.write_all(b"FRAME\n").and_then(|()| out.write_all(&planes)).map_err(AnimationError::Out)?;
            pictures += 1;
        }
        animation.report((at + 1) as f64 / ticks.len() as f64)
    })?;
    Ok(Written { pictures, duration: pictures as f64 / rate_each, size: [width, height] })
}

/// Luma of all pixels, then Cb and Cr, by BT.709.
fn planes(image: &Image) -> Vec<u8> {
    const SHARES: [f32; 3] = [0.2126, 0.7152, 0.0722];
    let all = image.pixels.len() / 3;
    let mut planes = vec![0; 3 * all];
    let (luma, chroma) = planes.split_at_mut(all);
    let (blue, red) = chroma.split_at_mut(all);
    for (at, pixel) in image.pixels.chunks_exact(3).enumerate() {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(f32::from);
        let y = SHARES[0] * r + SHARES[1] * g + SHARES[2] * b;
        let level = |base: f32, number: f32| (base + number + 0.5) as u8;
        luma[at] = level(16.0, y * 219.0 / 255.0);
        blue[at] = level(128.0, (b - y) / (2.0 * (1.0 - SHARES[2])) * 224.0 / 255.0);
        red[at] = level(128.0, (r - y) / (2.0 * (1.0 - SHARES[0])) * 224.0 / 255.0);
    }
    planes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_bt_709() {
        let of = |pixel: [u8; 3]| planes(&Image { size: [1, 1], pixels: pixel.to_vec() });
        for (pixel, expected) in [
            ([0; 3], [16, 128, 128]),
            ([255; 3], [235, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            assert_eq!(of(pixel), expected, "{pixel:?}");
        }
    }
}
