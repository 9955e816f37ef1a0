//! Memory aligned for vectors.

#![expect(unsafe_code, reason = "cache lines are read as doubles, and threads share them")]

use std::cell::UnsafeCell;

/// Doubles that begin at a cache line, and so are aligned for vectors of every set.
pub(crate) struct Aligned {
    lines: Box<[UnsafeCell<Line>]>,
}

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([f64; Aligned::LINE]);

// SAFETY: through a shared reference only a pointer can be obtained, and using that is unsafe.
unsafe impl Sync for Aligned {}

/// Threads write through pointers while a kernel runs, which takes it uniquely. Copies are made between its runs.
impl Clone for Aligned {
    fn clone(&self) -> Self {
        // SAFETY: no thread writes between runs.
        let line = |line: &UnsafeCell<Line>| UnsafeCell::new(unsafe { *line.get() });
        Self { lines: self.lines.iter().map(line).collect() }
    }
}

impl Aligned {
    /// Doubles in a cache line.
    pub(crate) const LINE: usize = 8;

    /// At least `count` zeros.
    pub(crate) fn zeros(count: usize) -> Self {
        Self { lines: (0..count.div_ceil(Self::LINE)).map(|_| UnsafeCell::new(Line([0.0; Self::LINE]))).collect() }
    }

    /// A pointer to the first. A thread that writes through it has to ensure that no other thread accesses the same
    /// place.
    pub(crate) fn pointer(&self) -> *mut f64 {
        UnsafeCell::raw_get(self.lines.as_ptr()).cast()
    }

    /// All of them. Reading needs a unique reference, too, as others could write through a shared one.
    pub(crate) fn as_mut_slice(&mut self) -> &mut [f64] {
        // SAFETY: a line consists of eight doubles, and the reference is unique.
        unsafe { std::slice::from_raw_parts_mut(self.pointer(), self.lines.len() * Self::LINE) }
    }

    /// Copies all values from memory of the same size.
    pub(crate) fn copy_from(&mut self, other: &mut Self) {
        self.as_mut_slice().copy_from_slice(other.as_mut_slice());
    }
}
