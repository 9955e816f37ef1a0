//! Scaling pictures.

use super::Image;
use crate::colour::{encoded, linear};
use image::imageops::{self, FilterType};
use image::{ImageBuffer, Rgb};
use std::sync::LazyLock;

/// Levels of linear light.
const LEVELS: f64 = 65535.0;

/// Tables from sRGB bytes to linear light and back, with enough steps to distinguish all bytes.
static LINEAR: LazyLock<[u16; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| (linear([byte as u8; 3])[0] * LEVELS).round() as u16));
static ENCODED: LazyLock<Vec<u8>> =
    LazyLock::new(|| (0..=u16::MAX).map(|light| encoded([f64::from(light) / LEVELS; 3])[0]).collect());

/// A picture scaled to another size (px), in linear light, with a Lanczos filter of three lobes.
///
/// # Panics
/// If a side is zero.
pub(crate) fn resized(image: Image, size: [u32; 2]) -> Image {
    if image.size == size {
        return image;
    }
    let [[from, rows], [width, height]] = [image.size, size];
    let light: Vec<u16> = image.pixels.iter().map(|&byte| LINEAR[usize::from(byte)]).collect();
    let light: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_raw(from, rows, light).expect("three bytes for each pixel");
    let scaled = imageops::resize(&light, width, height, FilterType::Lanczos3);
    Image { size, pixels: scaled.as_raw().iter().map(|&light| ENCODED[usize::from(light)]).collect() }
}

#[cfg(test)]
#[path = "../../tests/inside/resize.rs"]
mod tests;
