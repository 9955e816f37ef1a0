//! Deformable bodies that keep their local shapes, simulated and drawn beside mass-spring models.

pub mod scene;
pub mod sequence;
pub mod sim;
