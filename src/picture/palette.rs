//! The colours of a picture, which its scene has resolved.

pub use crate::colour::Colour;
pub use crate::scene::Palette;
