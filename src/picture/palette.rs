//! The colours of a picture, which its scene has resolved.

pub use crate::colour::Colour;
pub(super) use crate::scene::LineStyle;
pub use crate::scene::Palette;
