//! The colours of a picture, which its scene has resolved.

pub use crate::colour::Colour;
pub(super) use crate::look::LineStyle;
pub use crate::look::Palette;
