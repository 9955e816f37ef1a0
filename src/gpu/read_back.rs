//! Reading back textures.

use super::{Gpu, GpuError, lost};
use std::sync::mpsc;

/// Bytes per pixel of the textures that are read back.
const PIXEL: u32 = 4;

/// The length of a row of `width` pixels in the buffer that textures are copied to (bytes). Rows begin at multiples of
/// 256 bytes.
fn padded_row(width: u32) -> u32 {
    (width * PIXEL).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

/// The size of the buffer for a texture (bytes).
fn bytes([width, height]: [u32; 2]) -> u64 {
    u64::from(padded_row(width)) * u64::from(height)
}

/// The longest side of pictures that a buffer can hold (px), for a size that is too large for it.
pub(super) fn longest_side(size: [u32; 2], buffer: u64) -> Option<u32> {
    let square = (buffer / u64::from(PIXEL)).isqrt();
    // A row of this length has no padding.
    (bytes(size) > buffer).then(|| u32::try_from(square).unwrap_or(u32::MAX) / 64 * 64)
}

/// Buffers for reading back textures of one size, time and again: one for each, because they may be as large as a buffer
/// may be.
#[derive(Debug)]
pub(crate) struct ReadBack {
    buffers: Vec<wgpu::Buffer>,
    size: [u32; 2],
}

/// A copy in progress, which [`ReadBack::collect`] completes.
#[derive(Debug)]
pub(crate) struct Pending {
    /// One message for each texture.
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
    submission: wgpu::SubmissionIndex,
}

/// Textures that were read back.
#[derive(Clone, Copy)]
pub(crate) struct Layers<'a> {
    /// Their rows with padding.
    bytes: &'a [wgpu::BufferView],
    width: u32,
}

impl<'a> Layers<'a> {
    /// The pixels of a texture in rows that are this much longer than the texture is wide: [`Self::stride`].
    pub(crate) fn of<T: bytemuck::Pod>(self, layer: usize) -> &'a [T] {
        bytemuck::cast_slice(&self.bytes[layer])
    }

    /// The distance between two rows (px).
    pub(crate) fn stride(self) -> usize {
        (padded_row(self.width) / PIXEL) as usize
    }
}

impl ReadBack {
    /// For textures of one size (px).
    pub(crate) fn new(size: [u32; 2]) -> Self {
        Self { buffers: Vec::new(), size }
    }

    /// Adds the copies of textures to the commands, submits them and returns at once. There are never fewer textures than
    /// before.
    pub(crate) fn submit(
        &mut self,
        gpu: &Gpu,
        mut commands: wgpu::CommandEncoder,
        textures: &[&wgpu::Texture],
    ) -> Pending {
        let new = || {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("read back"),
                size: bytes(self.size),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        };
        let missing = textures.len().saturating_sub(self.buffers.len());
        self.buffers.extend(std::iter::repeat_with(new).take(missing));
        let [width, height] = self.size;
        let (sender, mapped) = mpsc::channel();
        for (texture, buffer) in textures.iter().zip(&self.buffers) {
            let layout =
                wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded_row(width)), rows_per_image: None };
            commands.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer, layout },
                wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            );
            let sender = sender.clone();
            commands.map_buffer_on_submit(buffer, wgpu::MapMode::Read, .., move |result| {
                // The receiver is gone when a frame was abandoned.
                let _ = sender.send(result);
            });
        }
        Pending { mapped, submission: gpu.queue().submit([commands.finish()]) }
    }

    /// Waits for the copies, and returns the result of reading them.
    ///
    /// # Errors
    /// The device was lost or refused a command.
    pub(crate) fn collect<T>(
        &self,
        gpu: &Gpu,
        pending: Pending,
        read: impl FnOnce(Layers<'_>) -> T,
    ) -> Result<T, GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: Some(pending.submission), timeout: None };
        let waited = gpu.device().poll(wait);
        gpu.check()?;
        waited.map_err(|error| lost(&error.to_string()))?;
        let lost = |error: &dyn std::fmt::Display| lost(&error.to_string());
        for _ in &self.buffers {
            pending.mapped.recv().map_err(|error| lost(&error))?.map_err(|error| lost(&error))?;
        }
        let result = {
            let bytes: Result<Vec<_>, _> = self.buffers.iter().map(|buffer| buffer.get_mapped_range(..)).collect();
            read(Layers { bytes: &bytes.map_err(|error| lost(&error))?, width: self.size[0] })
        };
        self.buffers.iter().for_each(wgpu::Buffer::unmap);
        Ok(result)
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
    fn buffers_limit_the_size_of_pictures() {
        assert_eq!([[16384, 16384], [16384, 4096]].map(|size| longest_side(size, 1 << 28)), [Some(8192), None]);
    }
}
