//! A typed device buffer that grows.

use super::{Gpu, Work};
use std::ops::Range;

/// A device buffer of elements of one type, which grows as needed. Only blocks that differ from the last frame are
/// uploaded.
#[derive(Debug)]
pub(crate) struct GrowingBuffer<T> {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
    contents: Vec<T>,
}

/// The length of compared blocks (bytes), a multiple of what the device copies.
const BLOCK: usize = 4096;

impl<T: bytemuck::NoUninit> GrowingBuffer<T> {
    /// An empty buffer for `usage`, with room for some elements.
    pub(crate) fn new(gpu: &Gpu, label: &'static str, usage: wgpu::BufferUsages, room: usize) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let buffer = create(gpu, label, usage, bytes::<T>(room.max(1)));
        Self { label, usage, buffer, contents: Vec::new() }
    }

    /// Replaces the contents. Returns true if the device buffer was replaced by a larger one, whose bindings must be
    /// made anew.
    pub(crate) fn write(&mut self, gpu: &Gpu, elements: Vec<T>) -> bool {
        let is_replaced = self.buffer.size() < bytes::<T>(elements.len());
        if is_replaced {
            self.buffer = create(gpu, self.label, self.usage, bytes::<T>(elements.len().next_power_of_two()));
            self.contents.clear();
        }
        let contents: &[u8] = bytemuck::cast_slice(&elements);
        let changed = changed(bytemuck::cast_slice(&self.contents), contents);
        if !changed.is_empty() {
            gpu.note(Work::Upload(self.label, changed.len()));
            let whole = changed.len() & !(wgpu::COPY_BUFFER_ALIGNMENT as usize - 1);
            let (start, contents) = (changed.start as u64, &contents[changed]);
            gpu.queue().write_buffer(&self.buffer, start, &contents[..whole]);
            if whole < contents.len() {
                // The device copies multiples of four bytes only.
                let mut rest = [0; wgpu::COPY_BUFFER_ALIGNMENT as usize];
                rest[..contents.len() - whole].copy_from_slice(&contents[whole..]);
                gpu.queue().write_buffer(&self.buffer, start + whole as u64, &rest);
            }
        }
        self.contents = elements;
        is_replaced
    }

    /// The device buffer.
    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// The last contents.
    pub(crate) fn contents(&self) -> &[T] {
        &self.contents
    }
}

/// The part of new contents that differs from the old ones, in whole blocks.
fn changed(old: &[u8], new: &[u8]) -> Range<usize> {
    let differs = |at: &usize| {
        let block = at * BLOCK..new.len().min((at + 1) * BLOCK);
        old.get(block.clone()) != Some(&new[block])
    };
    let blocks = new.len().div_ceil(BLOCK);
    match ((0..blocks).find(differs), (0..blocks).rfind(differs)) {
        (Some(first), Some(last)) => first * BLOCK..new.len().min((last + 1) * BLOCK),
        _ => 0..0,
    }
}

fn bytes<T>(length: usize) -> u64 {
    ((length * size_of::<T>()) as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
}

fn create(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
    gpu.device().create_buffer(&descriptor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changed_is_found_in_whole_blocks() {
        let old: Vec<u8> = (0..3 * BLOCK + 10).map(|at| (at % 251) as u8).collect();
        let with = |places: &[usize]| {
            let mut new = old.clone();
            places.iter().for_each(|&at| new[at] ^= 1);
            changed(&old, &new)
        };
        assert_eq!(with(&[]), 0..0);
        assert_eq!(with(&[BLOCK]), BLOCK..2 * BLOCK);
        assert_eq!(with(&[BLOCK - 1, 2 * BLOCK]), 0..3 * BLOCK);
        assert_eq!(with(&[3 * BLOCK + 9]), 3 * BLOCK..3 * BLOCK + 10);
        // Longer ones than before, and shorter ones.
        assert_eq!(changed(&old[..BLOCK], &old), BLOCK..3 * BLOCK + 10);
        assert_eq!(changed(&old, &old[..BLOCK + 3]), 0..0);
        assert_eq!(changed(&[], &old), 0..old.len());
        assert_eq!(changed(&old, &[]), 0..0);
    }
}
