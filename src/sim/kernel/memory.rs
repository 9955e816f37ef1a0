//! Memory for lanes.

#![expect(unsafe_code, reason = "cache lines are read as the doubles of which they consist, and threads share them")]

use std::cell::UnsafeCell;

/// Doubles that begin at a cache line, so that vectors of any set do, too.
pub(in crate::sim) struct Aligned {
    lines: Box<[UnsafeCell<Line>]>,
}

#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([f64; Aligned::LINE]);

// SAFETY: a shared one gives away nothing but a pointer, which it is unsafe to use.
unsafe impl Sync for Aligned {}

impl Aligned {
    /// Doubles in a cache line.
    pub(in crate::sim) const LINE: usize = 8;

    /// At least `count` zeros.
    pub(in crate::sim) fn zeros(count: usize) -> Self {
        Self { lines: (0..count.div_ceil(Self::LINE)).map(|_| UnsafeCell::new(Line([0.0; Self::LINE]))).collect() }
    }

    /// The first of them. Who writes there makes sure that nobody else has to do with the same place.
    pub(in crate::sim) fn pointer(&self) -> *mut f64 {
        UnsafeCell::raw_get(self.lines.as_ptr()).cast()
    }

    /// All of them. Even reading takes the only reference, for those who share one may write.
    pub(in crate::sim) fn as_mut_slice(&mut self) -> &mut [f64] {
        // SAFETY: a line is its eight doubles and nothing else, and nobody else holds them.
        unsafe { std::slice::from_raw_parts_mut(self.pointer(), self.lines.len() * Self::LINE) }
    }

    /// All of them, copied from others of the same number.
    pub(in crate::sim) fn copy_from(&mut self, other: &mut Self) {
        self.as_mut_slice().copy_from_slice(other.as_mut_slice());
    }
}
