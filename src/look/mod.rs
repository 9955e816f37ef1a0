//! What pictures look like: view, colours, fonts, scales, and where cameras stand. A scene keeps a [`View`] that has been
//! made here of its `[view]` table and of the body, the models and the surroundings that it shows; nothing here draws.

mod contrast;
mod eye;
pub(crate) mod file;
pub(crate) mod font;
mod framing;
mod palette;
pub(crate) mod ramp;
mod reach;
mod resolve;
pub(crate) mod typed;
mod view;

pub use crate::colour::Colour;
pub(crate) use contrast::check_runs;
pub(crate) use framing::Around;
pub(crate) use palette::{LineStyle, Palette};
pub(crate) use resolve::resolve;
pub use view::{
    Camera, ColourMap, ColourScale, FloorStyle, Follow, FontFiles, Labels, Light, Look, StrainScale, Theme, View,
    Visible,
};
