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

/// The largest number of textures that are read back.
const MOST: usize = 3;

/// The size of the buffer for a number of textures of one size (bytes).
fn bytes([width, height]: [u32; 2], count: usize) -> u64 {
    u64::from(padded_row(width)) * u64::from(height) * count as u64
}

/// The longest side of pictures whose textures a buffer can hold (px), for a size that is too large for it.
pub(super) fn longest_side(size: [u32; 2], buffer: u64) -> Option<u32> {
    let square = (buffer / (u64::from(PIXEL) * MOST as u64)).isqrt();
    // A row of this length has no padding.
    (bytes(size, MOST) > buffer).then(|| u32::try_from(square).unwrap_or(u32::MAX) / 64 * 64)
}

/// A buffer for reading back some textures of one size, time and again.
#[derive(Debug)]
pub(crate) struct ReadBack {
    buffer: wgpu::Buffer,
    size: [u32; 2],
}

/// A copy in progress, which [`ReadBack::collect`] completes.
#[derive(Debug)]
pub(crate) struct Pending {
    mapped: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
    submission: wgpu::SubmissionIndex,
}

/// Textures that were read back.
#[derive(Clone, Copy)]
pub(crate) struct Layers<'a> {
    /// Their rows with padding, one texture after the other.
    bytes: &'a [u8],
    size: [usize; 2],
}

impl<'a> Layers<'a> {
    /// The pixels of a texture in rows that are this much longer than the texture is wide: [`Self::stride`].
    pub(crate) fn of<T: bytemuck::Pod>(self, layer: usize) -> &'a [T] {
        let length = self.stride() * self.size[1] * PIXEL as usize;
        bytemuck::cast_slice(&self.bytes[layer * length..][..length])
    }

    /// The distance between two rows (px).
    pub(crate) fn stride(self) -> usize {
        (padded_row(self.size[0] as u32) / PIXEL) as usize
    }
}

impl ReadBack {
    /// A buffer for a number of textures of one size (px).
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2], count: usize) -> Self {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("read back"),
            size: bytes(size, count),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, size }
    }

    /// Makes room for a number of textures. The old buffer goes first, because there may be no memory for both.
    pub(crate) fn grow(&mut self, gpu: &Gpu, count: usize) {
        self.buffer.destroy();
        *self = Self::new(gpu, self.size, count);
    }

    /// Adds the copies of textures to the commands, submits them and returns at once.
    pub(crate) fn submit(&self, gpu: &Gpu, mut commands: wgpu::CommandEncoder, textures: &[&wgpu::Texture]) -> Pending {
        let [width, height] = self.size;
        let row = padded_row(width);
        for (at, texture) in (0..).zip(textures) {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: at * u64::from(row) * u64::from(height),
                bytes_per_row: Some(row),
                rows_per_image: None,
            };
            commands.copy_texture_to_buffer(
                texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout },
                wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            );
        }
        let (sender, mapped) = mpsc::channel();
        commands.map_buffer_on_submit(&self.buffer, wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone when a frame was abandoned.
            let _ = sender.send(result);
        });
        Pending { mapped, submission: gpu.queue().submit([commands.finish()]) }
    }

    /// Waits for the copies, and returns what is read from them.
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
        pending.mapped.recv().map_err(|error| lost(&error.to_string()))?.map_err(|error| lost(&error.to_string()))?;
        let result = {
            let bytes = self.buffer.get_mapped_range(..).map_err(|error| lost(&error.to_string()))?;
            read(Layers { bytes: &bytes, size: self.size.map(|length| length as usize) })
        };
        self.buffer.unmap();
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
        assert_eq!([[16384, 16384], [16384, 10922]].map(|size| longest_side(size, 1 << 31)), [Some(13376), None]);
    }
}
