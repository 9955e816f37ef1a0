//! A device buffer that grows.

use super::Gpu;

/// A device buffer that grows as needed.
#[derive(Debug)]
pub(crate) struct GrowingBuffer {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
}

impl GrowingBuffer {
    /// An empty buffer for `usage`, with room for a number of bytes.
    pub(crate) fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages, size: usize) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self { label, usage, buffer: create(gpu, label, usage, size as u64) }
    }

    /// Replaces the contents, elements of a multiple of four bytes. Returns true if the device buffer was replaced by a
    /// larger one, whose bindings must be made anew.
    pub(crate) fn write<T: bytemuck::NoUninit>(&mut self, gpu: &Gpu, elements: &[T]) -> bool {
        let contents: &[u8] = bytemuck::cast_slice(elements);
        let is_replaced = self.buffer.size() < contents.len() as u64;
        if is_replaced {
            self.buffer = create(gpu, self.label, self.usage, contents.len().next_power_of_two() as u64);
        }
        gpu.queue().write_buffer(&self.buffer, 0, contents);
        is_replaced
    }

    /// The device buffer.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

fn create(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
    gpu.device().create_buffer(&descriptor)
}
