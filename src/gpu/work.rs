//! The commands given to a device, noted for tests that prove which ones are skipped.

use super::Gpu;

/// A command, by its label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Work {
    /// A pipeline was made.
    Pipeline(&'static str),
    /// A number of bytes was uploaded.
    Upload(&'static str, usize),
    /// A pipeline was run.
    Draw(&'static str),
    /// A picture was submitted and is read back.
    Picture,
}

impl Gpu {
    /// Notes a command, in tests.
    pub(crate) fn note(&self, work: Work) {
        if cfg!(test) {
            self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(work);
        }
    }

    /// The commands since the last call.
    #[cfg(test)]
    pub(crate) fn take_work(&self) -> Vec<Work> {
        std::mem::take(&mut self.work.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
}
