//! Memory for lanes.

#![expect(unsafe_code, reason = "cache lines are read as the doubles of which they consist")]

/// Doubles that begin at a cache line, so that vectors of any set do, too.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Aligned {
    lines: Vec<Line>,
}

#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Line([f64; Aligned::LINE]);

impl Aligned {
    /// Doubles in a cache line.
    pub(in crate::sim) const LINE: usize = 8;

    /// At least `count` zeros.
    pub(in crate::sim) fn zeros(count: usize) -> Self {
        Self { lines: vec![Line([0.0; Self::LINE]); count.div_ceil(Self::LINE)] }
    }

    /// The first of them.
    pub(in crate::sim) fn pointer(&mut self) -> *mut f64 {
        self.lines.as_mut_ptr().cast()
    }

    /// All of them.
    pub(in crate::sim) fn as_mut_slice(&mut self) -> &mut [f64] {
        // SAFETY: as below, and nobody else holds them.
        unsafe { std::slice::from_raw_parts_mut(self.pointer(), self.lines.len() * Self::LINE) }
    }

    /// All of them.
    pub(in crate::sim) fn as_slice(&self) -> &[f64] {
        // SAFETY: a line is its eight doubles and nothing else.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast(), self.lines.len() * Self::LINE) }
    }
}
