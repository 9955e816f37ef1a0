//! Deformable bodies that keep their local shapes, simulated and drawn beside mass-spring models.

pub mod cli;
#[cfg(feature = "render")]
pub mod gpu;
pub mod output;
#[cfg(feature = "render")]
pub mod picture;
#[cfg(feature = "render")]
pub mod render;
pub mod scene;
pub mod sequence;
pub mod sim;
