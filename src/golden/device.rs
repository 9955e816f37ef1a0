//! The device that draws scenes for their goldens.

use super::folder::Golden;
use crate::gpu::{AdapterChoice, Gpu, InitError};

/// The device for a golden: the kind of adapter that drew it if this machine has it, else a software driver.
pub(crate) fn usual_gpu(golden: &Golden) -> Result<Gpu, InitError> {
    // Versions follow in brackets.
    let kind = golden.adapter().map(|adapter| adapter.split(" (").next().unwrap_or_default().to_owned());
    let same = kind.filter(|kind| !kind.is_empty()).and_then(|kind| Gpu::new(&AdapterChoice::Named(kind)).ok());
    same.map_or_else(|| Gpu::new(&AdapterChoice::Cpu), Ok)
}

/// The device for tests: that of the first golden, else any other one. It is opened once, as soon as lit bodies are drawn.
#[derive(Debug, Default)]
pub struct TestDevice {
    /// A requested adapter instead of the usual one.
    pub(super) adapter: Option<AdapterChoice>,
    opened: Option<Option<Gpu>>,
}

impl TestDevice {
    /// The device, or `None` without any adapter: then states alone are compared, which standard error tells once.
    ///
    /// # Errors
    /// There is no adapter, and `LOCALSHAPE_REQUIRE_GPU=1` demands one.
    pub(super) fn of(&mut self, golden: &Golden) -> Result<Option<&Gpu>, String> {
        if self.opened.is_none() {
            let opened = match &self.adapter {
                None => usual_gpu(golden).or_else(|_| Gpu::new(&AdapterChoice::Auto)),
                Some(asked) => Gpu::new(asked),
            };
            self.opened = Some(match opened {
                Ok(gpu) => Some(gpu),
                Err(error) if std::env::var("LOCALSHAPE_REQUIRE_GPU").as_deref() == Ok("1") => {
                    return Err(error.to_string());
                }
                Err(error) => {
                    eprintln!("states are compared, but no pictures: {error}");
                    None
                }
            });
        }
        Ok(self.opened.as_ref().and_then(Option::as_ref))
    }
}
