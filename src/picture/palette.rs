//! The colours of a picture, which its scene has resolved.

pub(crate) use crate::colour::Colour;
pub(super) use crate::look::LineStyle;
pub(crate) use crate::look::Palette;
