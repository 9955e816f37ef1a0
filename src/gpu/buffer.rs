//! A typed device buffer that grows.

use super::Gpu;
use std::marker::PhantomData;

/// A device buffer of elements of one type, which is rewritten for each frame and grows as needed.
#[derive(Debug)]
pub(crate) struct GrowingBuffer<T> {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
    length: usize,
    element: PhantomData<T>,
}

impl<T: bytemuck::NoUninit> GrowingBuffer<T> {
    /// An empty buffer for `usage`, with room for some elements.
    pub(crate) fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages, room: usize) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let buffer = create(gpu, label, usage, bytes::<T>(room.max(1)));
        Self { label, usage, buffer, length: 0, element: PhantomData }
    }

    /// Replaces the contents. Returns whether the device buffer was too small and was replaced by a larger one, so that
    /// bindings to it must be made anew.
    pub(crate) fn write(&mut self, gpu: &Gpu, elements: &[T]) -> bool {
        self.length = elements.len();
        let is_replaced = self.buffer.size() < bytes::<T>(elements.len());
        if is_replaced {
            self.buffer = create(gpu, self.label, self.usage, bytes::<T>(elements.len().next_power_of_two()));
        }
        if elements.is_empty() {
            return is_replaced;
        }
        let contents: &[u8] = bytemuck::cast_slice(elements);
        let whole = contents.len() & !(wgpu::COPY_BUFFER_ALIGNMENT as usize - 1);
        gpu.queue().write_buffer(&self.buffer, 0, &contents[..whole]);
        if whole < contents.len() {
            // The device copies multiples of four bytes only.
            let mut rest = [0; wgpu::COPY_BUFFER_ALIGNMENT as usize];
            rest[..contents.len() - whole].copy_from_slice(&contents[whole..]);
            gpu.queue().write_buffer(&self.buffer, whole as u64, &rest);
        }
        is_replaced
    }

    /// The device buffer behind it.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// How many elements were written last.
    pub(crate) fn len(&self) -> usize {
        self.length
    }
}

fn bytes<T>(length: usize) -> u64 {
    ((length * size_of::<T>()) as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
}

fn create(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
    gpu.device().create_buffer(&descriptor)
}
