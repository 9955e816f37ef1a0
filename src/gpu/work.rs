//! What a device is told to do, noted for tests that prove what is skipped.

use super::Gpu;

/// One thing that a device was told to do, by its label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Work {
    /// A pipeline was made.
    Pipeline(&'static str),
    /// So many bytes were uploaded.
    Upload(&'static str, usize),
    /// A pipeline was run.
    Draw(&'static str),
    /// A picture was submitted and is read back.
    Picture,
}

impl Gpu {
    /// Notes work, in tests.
    pub(crate) fn note(&self, work: Work) {
        if cfg!(test) {
            self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(work);
        }
    }

    /// The work since this was asked last.
    #[cfg(test)]
    pub(crate) fn take_work(&self) -> Vec<Work> {
        std::mem::take(&mut self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
}
