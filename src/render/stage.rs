//! What all passes share.

use super::panel::Panels;
use super::target::Layouts;
use crate::gpu::Gpu;

/// The device, the data of panels, and the layouts of textures.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) gpu: Gpu,
    pub(super) panels: Panels,
    pub(super) layouts: Layouts,
}

impl Stage {
    pub(super) fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), panels: Panels::new(gpu), layouts: Layouts::new(gpu) }
    }
}
