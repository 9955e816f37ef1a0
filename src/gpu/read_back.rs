//! Reading back pixels of a texture.

use super::{Gpu, GpuError, Work, lost};
use std::sync::mpsc;

/// Bytes per pixel of the textures that are read back.
const PIXEL: u32 = 4;

/// The length of a row of `width` pixels in the buffer that a texture is copied to (bytes). Rows begin at multiples of
/// 256 bytes.
pub(crate) fn padded_row(width: u32) -> u32 {
    (width * PIXEL).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// The pixels of padded rows.
fn without_padding(rows: &[u8], width: u32) -> Vec<u8> {
    let rows = rows.chunks_exact(padded_row(width) as usize);
    let rows: Vec<_> = rows.map(|row| &row[..(width * PIXEL) as usize]).collect();
    rows.concat()
}

/// A buffer for reading back one texture after the other.
#[derive(Debug)]
pub(crate) struct ReadBack {
    buffer: wgpu::Buffer,
    width: u32,
    height: u32,
}

/// A copy in progress, which [`ReadBack::collect`] completes.
#[derive(Debug)]
pub(crate) struct Pending {
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
    submission: wgpu::SubmissionIndex,
}

impl ReadBack {
    /// A buffer for textures of one size (px).
    pub(crate) fn new(gpu: &Gpu, width: u32, height: u32) -> Self {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: u64::from(padded_row(width)) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, width, height }
    }

    /// Adds the copy of a texture to the commands, submits them and returns at once.
    pub(crate) fn submit(&self, gpu: &Gpu, mut commands: wgpu::CommandEncoder, texture: &wgpu::Texture) -> Pending {
        commands.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row(self.width)),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d { width: self.width, height: self.height, depth_or_array_layers: 1 },
        );
        gpu.note(Work::Picture);
        let (sender, mapped) = mpsc::channel();
        commands.map_buffer_on_submit(&self.buffer, wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone when a frame was abandoned.
            let _ = sender.send(result);
        });
        Pending { mapped, submission: gpu.queue().submit([commands.finish()]) }
    }

    /// Waits for the copy and returns its pixels: red, green, blue and opacity of each, in rows from the top left.
    ///
    /// # Errors
    /// The device was lost or refused a command.
    pub(crate) fn collect(&self, gpu: &Gpu, pending: Pending) -> Result<Vec<u8>, GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: Some(pending.submission), timeout: None };
        let waited = gpu.device().poll(wait);
        gpu.check()?;
        waited.map_err(|error| lost(&error.to_string()))?;
        pending.mapped.recv().map_err(|error| lost(&error.to_string()))?.map_err(|error| lost(&error.to_string()))?;
        let colours = {
            let rows = self.buffer.get_mapped_range(..).map_err(|error| lost(&error.to_string()))?;
            without_padding(&rows, self.width)
        };
        self.buffer.unmap();
        Ok(colours)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_begin_at_multiples_of_256_bytes() {
        assert_eq!([1, 63, 64, 65, 127, 1280, 1281].map(padded_row), [256, 256, 256, 512, 512, 5120, 5376]);
    }

    #[test]
    fn padding_stays_behind_at_odd_widths() {
        let (width, height) = (65, 3);
        let mut rows = vec![0xee; (padded_row(width) * height) as usize];
        for y in 0..height {
            for x in 0..width {
                let at = (y * padded_row(width) + x * 4) as usize;
                rows[at..at + 4].copy_from_slice(&[x as u8, y as u8, 7, 255]);
            }
        }
        let pixels = without_padding(&rows, width);
        assert_eq!(pixels.len(), 65 * 3 * 4);
        assert!(pixels.chunks(4).enumerate().all(|(at, pixel)| pixel == [(at % 65) as u8, (at / 65) as u8, 7, 255]));
    }
}
