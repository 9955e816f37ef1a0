//! From a [`Picture`] to an image: the device draws lit bodies (`lit`), and `vector` paints flat items over them. A picture
//! without lit bodies needs no device.

mod border;
mod ground;
mod key;
mod line;
mod lit;
mod pane;
mod panel;
mod pipeline;
#[cfg(test)]
mod shader_tests;
mod surface;
mod target;

use crate::gpu::{Gpu, GpuError};
use crate::picture::{Panel, Picture};
use crate::vector::Painter;
use image::RgbImage;
use lit::Lit;

const PANEL_SHADER: &str = include_str!("../../shaders/panel.wgsl");
const KEY_SHADER: &str = include_str!("../../shaders/key.wgsl");

/// A reason why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The picture is larger than the device can draw, or empty.
    #[error("pictures of {width}×{height} pixels cannot be drawn: each side may have 1 to {longest} pixels here")]
    Size {
        /// Requested width (px).
        width: u32,
        /// Requested height (px).
        height: u32,
        /// The longest side that can be drawn here (px).
        longest: u32,
    },
    /// A picture has another size than the renderer was made for.
    #[error("a picture of {} × {} pixels was given to a renderer for {} × {}", found[0], found[1], expected[0], expected[1])]
    OtherSize {
        /// Size of the picture (px).
        found: [u32; 2],
        /// Size that the renderer was made for (px).
        expected: [u32; 2],
    },
    /// There is no device for lit bodies.
    #[error("bodies in space are drawn with light, which needs a graphics device; none was given")]
    NoDevice,
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// Draws pictures of one size. The same picture gives the same bytes, independent of pictures before it.
#[derive(Debug)]
pub struct Renderer {
    size: [u32; 2],
    painter: Painter,
    /// The last picture: four bytes a pixel.
    pixels: Vec<u8>,
    gpu: Option<Gpu>,
    /// Made when the first lit body is drawn.
    lit: Option<Lit>,
}

/// The lit bodies of a picture that is being drawn, if it has any.
pub(crate) type Pending = Option<crate::gpu::Pending>;

impl Renderer {
    /// Prepares to draw pictures of a width and height (px). Lit bodies need a device.
    ///
    /// # Errors
    /// Pictures of this size cannot be drawn.
    pub fn new<'a>(gpu: impl Into<Option<&'a Gpu>>, size: [u32; 2]) -> Result<Self, RenderError> {
        let gpu = gpu.into();
        let [width, height] = size;
        if size.contains(&0) || width.max(height) > LONGEST {
            return Err(RenderError::Size { width, height, longest: LONGEST });
        }
        let painter = Painter::new(size.map(|length| length as u16));
        Ok(Self { size, painter, pixels: Vec::new(), gpu: gpu.cloned(), lit: None })
    }

    /// Draws a picture.
    ///
    /// # Errors
    /// The picture has another size, or it has lit bodies and there is no device, or the device fails.
    pub fn draw(&mut self, picture: &Picture) -> Result<RgbImage, RenderError> {
        let pending = self.submit(picture)?;
        let pixels = self.collect(pending, picture)?;
        let [width, height] = self.size;
        Ok(RgbImage::from_raw(width, height, pixels).expect("three bytes a pixel"))
    }

    /// Submits a picture and returns at once. Collect it before the next one is submitted: there is one buffer for
    /// reading back.
    pub(crate) fn submit(&mut self, picture: &Picture) -> Result<Pending, RenderError> {
        if picture.size != self.size {
            return Err(RenderError::OtherSize { found: picture.size, expected: self.size });
        }
        let is_lit = |panel: &Panel| !panel.sight.flat;
        let pending = if picture.panels.iter().any(is_lit) {
            let gpu = self.gpu.as_ref().ok_or(RenderError::NoDevice)?;
            if self.lit.is_none() {
                self.lit = Some(Lit::new(gpu, self.size)?);
            }
            let lit = self.lit.as_mut().expect("made above");
            Some(if picture.panels.iter().all(is_lit) {
                lit.submit(picture)
            } else {
                let mut bodies = picture.clone();
                bodies.panels.retain(is_lit);
                lit.submit(&bodies)
            })
        } else {
            None
        };
        Ok(pending)
    }

    /// Waits for a submitted picture, and returns its pixels: three bytes each, in rows from the top left.
    ///
    /// # Errors
    /// The device fails.
    pub(crate) fn collect(&mut self, pending: Pending, picture: &Picture) -> Result<Vec<u8>, RenderError> {
        self.pixels.clear();
        let lines = match pending {
            None => {
                let [red, green, blue] = picture.palette.background;
                let count = self.size.iter().product::<u32>() as usize;
                self.pixels.extend(std::iter::repeat_n([red, green, blue, u8::MAX], count).flatten());
                Vec::new()
            }
            Some(pending) => self.lit.as_ref().expect("it is drawing").collect(pending, picture, &mut self.pixels)?,
        };
        self.painter.paint(picture, &lines, &mut self.pixels);
        Ok(without_opacity(&self.pixels))
    }
}

/// The longest side of a picture (px).
const LONGEST: u32 = 16384;

/// The colours of pixels of four bytes.
fn without_opacity(pixels: &[u8]) -> Vec<u8> {
    let mut colours = vec![0; pixels.len() / 4 * 3];
    // Arrays of known length, which compile to whole words.
    for (&[red, green, blue, _], colour) in pixels.as_chunks::<4>().0.iter().zip(colours.as_chunks_mut::<3>().0) {
        *colour = [red, green, blue];
    }
    colours
}
