//! Arrays that begin at a cache line.

#![expect(unsafe_code, reason = "a slice of cache lines is seen as a slice of doubles")]

use super::lanes::MOST;

/// A cache line of doubles.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([f64; MOST]);

/// Doubles that begin at a cache line and fill whole ones.
#[derive(Clone)]
pub(super) struct Array(Vec<Line>);

impl Array {
    /// At least so many zeros.
    pub(super) fn zeros(len: usize) -> Self {
        Self(vec![Line([0.0; MOST]); len.div_ceil(MOST)])
    }
}

impl std::ops::Deref for Array {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        // SAFETY: a line is MOST doubles and nothing else.
        unsafe { std::slice::from_raw_parts(self.0.as_ptr().cast(), self.0.len() * MOST) }
    }
}

impl std::ops::DerefMut for Array {
    fn deref_mut(&mut self) -> &mut [f64] {
        // SAFETY: as above.
        unsafe { std::slice::from_raw_parts_mut(self.0.as_mut_ptr().cast(), self.0.len() * MOST) }
    }
}
